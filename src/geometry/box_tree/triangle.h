/* triangle.h: closest point, normal and area of a triangle, and values interpolated between its corners.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_TRIANGLE_H
#define SMR_TRIANGLE_H

#include "base/vec.h"

/* Returns the squared distance, mm^2, from p to triangle a b c (area 0: legal). Writes the nearest point's weight[]. */
float smr_triangle_closest(smr_vec p, smr_vec a, smr_vec b, smr_vec c, float weight[3]);

/* Returns smr_triangle_closest() for the vertices t[3] at xyz. Pointers cost a sixth fewer instructions. */
float smr_triangle_closest_of(const smr_vec *p, const float *xyz, const uint32_t *t, float weight[3]);

/* Returns the vector along the normal of triangle a b c whose length is twice the area, mm^2. */
static inline smr_vec smr_triangle_cross(smr_vec a, smr_vec b, smr_vec c)
{
    return smr_cross(smr_sub(b, a), smr_sub(c, a));
}

/* Returns the three vertices of triangle k, each < n_vertices; vertex 0 thrice where a fault has changed one. */
static inline const uint32_t *smr_triangle_at(const uint32_t *triangle, uint32_t k, uint32_t n_vertices)
{
    static const uint32_t none[3] = {0, 0, 0};
    const uint32_t *const t = triangle + 3u * (size_t)k;
    return t[0] < n_vertices && t[1] < n_vertices && t[2] < n_vertices ? t : none;
}

/* Returns smr_triangle_at(), not inline, for code that seldom runs. */
const uint32_t *smr_triangle_of(const uint32_t *triangle, uint32_t k, uint32_t n_vertices);

/* Vectors (positions, normals) at the three corners of a triangle. */
typedef struct smr_corner_values {
    smr_vec a, b, c;
} smr_corner_values;

/* Returns the rows of value [number of vertices][3] that belong to the vertices t[3] of a triangle. */
static inline smr_corner_values smr_corners_of(const float *value, const uint32_t *t)
{
    return (smr_corner_values){smr_get3(value, t[0]), smr_get3(value, t[1]), smr_get3(value, t[2])};
}

/* Returns the corner values interpolated at the point with these barycentric weights. */
static inline smr_vec smr_corners_mean(smr_corner_values v, const float weight[3])
{
    return smr_add(smr_add(smr_scale(v.a, weight[0]), smr_scale(v.b, weight[1])), smr_scale(v.c, weight[2]));
}

/* Returns smr_triangle_cross() of the triangle with the vertices t[3]. */
static inline smr_vec smr_corners_cross(const float *xyz, const uint32_t *t)
{
    const smr_corner_values v = smr_corners_of(xyz, t);
    return smr_triangle_cross(v.a, v.b, v.c);
}

#endif
