/* triangle.c: closest point on a triangle, by the seven Voronoi regions of its corners, edges and interior.
 * Source: C. Ericson, "Real-Time Collision Detection" (2005), 5.1.5. Exact up to rounding.
 * SPDX-License-Identifier: MIT */
#include "geometry/box_tree/triangle.h"

#define SMR_DIVISOR_LEAST 1.0e-20f /* least divisor: compilers also divide unused lanes of vectors, where 0 traps */
#define SMR_SLIVER 1.0e-5f         /* largest squared area of a sliver / products of lengths whose difference it is */

/* Sets weight[] to a, b, c. Returns the squared length, mm^2, of to_p, the vector from the closest point to p. */
static float set(float weight[3], float a, float b, float c, smr_vec to_p)
{
    weight[0] = a;
    weight[1] = b;
    weight[2] = c;
    return smr_dot(to_p, to_p);
}

/* Writes the weights of the closest point on the triangle's edges. Returns the squared distance from p to it, mm^2. */
static float closest_edge(const smr_vec *p, const float *xyz, const uint32_t *corner, float weight[3])
{
    const smr_corner_values v = smr_corners_of(xyz, corner);
    const smr_vec ap = smr_sub(*p, v.a), ab = smr_sub(v.b, v.a), ac = smr_sub(v.c, v.a);
    const smr_vec from[3] = {smr_v(0, 0, 0), smr_v(0, 0, 0), ab};
    const smr_vec along[3] = {ab, ac, smr_sub(ac, ab)};
    static const int start[3] = {0, 0, 1}, end[3] = {1, 2, 2};
    float best = FLT_MAX;
    for (int e = 0; e < 3; e++) {
        smr_vec q = smr_sub(ap, from[e]);
        float l2 = smr_dot(along[e], along[e]);
        float t = l2 > 0.0f ? smr_clamp(smr_dot(q, along[e]) / l2, 0.0f, 1.0f) : 0.0f;
        q = smr_sub(q, smr_scale(along[e], t));
        float d2 = smr_dot(q, q);
        if (d2 < best) {
            best = d2;
            weight[0] = weight[1] = weight[2] = 0.0f;
            weight[start[e]] = 1.0f - t;
            weight[end[e]] = t;
        }
    }
    return best;
}

float smr_triangle_closest_of(const smr_vec *point, const float *xyz, const uint32_t *corner, float weight[3])
{
    const smr_vec p = *point, a = smr_get3(xyz, corner[0]), b = smr_get3(xyz, corner[1]), c = smr_get3(xyz, corner[2]);
    smr_vec ab = smr_sub(b, a), ac = smr_sub(c, a), ap = smr_sub(p, a);
    float d1 = smr_dot(ab, ap), d2 = smr_dot(ac, ap);
    if (d1 <= 0.0f && d2 <= 0.0f)
        return set(weight, 1, 0, 0, ap);
    smr_vec bp = smr_sub(p, b);
    float d3 = smr_dot(ab, bp), d4 = smr_dot(ac, bp);
    if (d3 >= 0.0f && d4 <= d3)
        return set(weight, 0, 1, 0, bp);
    smr_vec cp = smr_sub(p, c);
    float d5 = smr_dot(ab, cp), d6 = smr_dot(ac, cp);
    if (d6 >= 0.0f && d5 <= d6)
        return set(weight, 0, 0, 1, cp);
    float vc = d1 * d4 - d3 * d2;
    if (vc <= 0.0f && d1 >= 0.0f && d3 <= 0.0f && d1 - d3 > 0.0f) {
        float t = d1 / smr_max(d1 - d3, SMR_DIVISOR_LEAST);
        return set(weight, 1.0f - t, t, 0, smr_sub(ap, smr_scale(ab, t)));
    }
    float vb = d5 * d2 - d1 * d6;
    if (vb <= 0.0f && d2 >= 0.0f && d6 <= 0.0f && d2 - d6 > 0.0f) {
        float t = d2 / smr_max(d2 - d6, SMR_DIVISOR_LEAST);
        return set(weight, 1.0f - t, 0, t, smr_sub(ap, smr_scale(ac, t)));
    }
    float va = d3 * d6 - d5 * d4, e1 = d4 - d3, e2 = d5 - d6;
    if (va <= 0.0f && e1 >= 0.0f && e2 >= 0.0f && e1 + e2 > 0.0f) {
        float t = e1 / smr_max(e1 + e2, SMR_DIVISOR_LEAST);
        return set(weight, 0, 1.0f - t, t, smr_sub(bp, smr_scale(smr_sub(c, b), t)));
    }
    float sum = va + vb + vc;
    if (!(va > 0.0f && vb > 0.0f && vc > 0.0f && sum > 1.0e-30f))
        return closest_edge(point, xyz, corner, weight);
    float v = vb / sum, w = vc / sum;
    const float inside = set(weight, 1.0f - v - w, v, w, smr_sub(ap, smr_add(smr_scale(ab, v), smr_scale(ac, w))));
    const float sides = smr_dot(ab, ab) + smr_dot(ac, ac);
    if (sum > SMR_SLIVER * sides * (sides + smr_dot(ap, ap)))
        return inside;
    /* rounding dominates the weights in a sliver, so a point on an edge may be closer */
    float on_edge[3];
    const float edge = closest_edge(point, xyz, corner, on_edge);
    if (edge < inside)
        memcpy(weight, on_edge, sizeof on_edge);
    return smr_min(edge, inside);
}

float smr_triangle_closest(smr_vec p, smr_vec a, smr_vec b, smr_vec c, float weight[3])
{
    static const uint32_t corner[3] = {0, 1, 2};
    const float xyz[9] = {a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z};
    return smr_triangle_closest_of(&p, xyz, corner, weight);
}

const uint32_t *smr_triangle_of(const uint32_t *triangle, uint32_t k, uint32_t n_vertices)
{
    return smr_triangle_at(triangle, k, n_vertices);
}
