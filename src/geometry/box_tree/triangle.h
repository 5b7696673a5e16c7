/* triangle.h: closest point on a triangle, and its normal and area.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_TRIANGLE_H
#define SMR_TRIANGLE_H

#include "base/vec.h"

/* Returns the squared distance from p to the triangle a b c, mm^2; weight[3]: barycentric weights of the closest
 * point.
 * Zero-area triangles count as line segments or points. */
float smr_triangle_closest(smr_vec p, smr_vec a, smr_vec b, smr_vec c, float weight[3]);

/* The vector along the triangle's normal whose length is twice its area. */
static inline smr_vec smr_triangle_cross(smr_vec a, smr_vec b, smr_vec c)
{
    return smr_cross(smr_sub(b, a), smr_sub(c, a));
}

#endif
