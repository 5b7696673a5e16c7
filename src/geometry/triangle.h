/* triangle.h: closest point on one triangle.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_TRIANGLE_H
#define SMR_TRIANGLE_H

#include "base/vec.h"

/* Squared distance from p to the triangle a b c and the barycentric weights of the closest point. Zero-area
 * triangles count as the segments they are. */
float smr_triangle_closest(smr_vec p, smr_vec a, smr_vec b, smr_vec c, float weight[3]);

/* Twice the triangle's area times its unit normal. */
static inline smr_vec smr_triangle_cross(smr_vec a, smr_vec b, smr_vec c)
{
    return smr_cross(smr_sub(b, a), smr_sub(c, a));
}

#endif
