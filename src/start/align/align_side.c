/* align_side.c: samples of a surface, its principal axes, and the sign of its volume.
 * SPDX-License-Identifier: MIT */
#include "start/align/align.h"
#include "geometry/box_tree/triangle.h"
#include "geometry/linear_solve/eigen_jacobi.h"

/* Chooses the signs of a side's axes so that third moments along the first two are positive. Eigenvectors have no
 * sign; without a choice the order of equally good poses would depend on the surface's orientation. */
static void turn_axes(smr_align_side *side, const smr_surface *s)
{
    float *a = side->axes, skew[2] = {0.0f, 0.0f};
    for (uint32_t i = 0; i < s->n_vertices; i++) {
        const smr_vec d = smr_sub(smr_get3(s->xyz, i), side->centre);
        for (uint32_t k = 0; k < 2u; k++) {
            const float along = d.x * a[k] + d.y * a[3u + k] + d.z * a[6u + k];
            skew[k] += s->area[i] * along * along * along;
        }
    }
    for (uint32_t k = 0; k < 2u; k++)
        for (uint32_t r = 0; r < 3u && skew[k] < 0.0f; r++) {
            a[3u * r + k] = -a[3u * r + k];
            a[3u * r + 2u] = -a[3u * r + 2u];
        }
}

/* Computes the side's area-weighted centroid, principal axes and spread. */
static void describe(smr_align_side *side, const smr_surface *s)
{
    const smr_vec origin = smr_load(s->xyz);
    smr_vec sum = smr_v(0, 0, 0);
    float weight = 0.0f, c[6] = {0}, value[3];
    for (uint32_t i = 0; i < s->n_vertices; i++) {
        sum = smr_add(sum, smr_scale(smr_sub(smr_get3(s->xyz, i), origin), s->area[i]));
        weight += s->area[i];
    }
    const float inverse = weight > 0.0f ? 1.0f / weight : 0.0f;
    side->centre = smr_add(origin, smr_scale(sum, inverse));
    for (uint32_t i = 0; i < s->n_vertices; i++)
        smr_add_square(c, s->area[i] * inverse, smr_sub(smr_get3(s->xyz, i), side->centre));
    side->spread = SMR_SQRT(c[SMR_XX] + c[SMR_YY] + c[SMR_ZZ]);
    smr_eigen(c, value, side->axes);
    turn_axes(side, s);
}

/* Returns 1 for a closed surface with a negative volume. */
static int inside_out(const smr_surface *s, smr_vec centre)
{
    float volume = 0.0f;
    if (s->open)
        return 0;
    for (uint32_t i = 0; i < s->tree.n_triangles; i++) {
        const uint32_t *t = s->triangle + 3u * (size_t)i;
        if (smr_surface_fragment(s, t[0]))
            continue;
        const smr_corner_values v = smr_corners_of(s->xyz, t);
        volume += smr_dot(smr_sub(v.a, centre), smr_cross(smr_sub(v.b, centre), smr_sub(v.c, centre)));
    }
    return volume < 0.0f;
}

/* Returns the vertex with `wanted` vertices outside fragments before it. at, in and out: vertex; number before it. */
static uint32_t vertex_of(const smr_surface *s, uint32_t wanted, uint32_t at[2])
{
    for (; at[1] < wanted || smr_surface_fragment(s, at[0]); at[0]++)
        at[1] += !smr_surface_fragment(s, at[0]);
    return at[0];
}

void smr_align_side_make(smr_align_side *side, const smr_surface *s, uint32_t n)
{
    const float inverse = s->area_mean > 0.0f ? 1.0f / s->area_mean : 0.0f;
    const uint32_t kept = s->n_vertices - s->n_fragment_vertices;
    uint32_t at[2] = {0, 0};
    side->surface = s;
    side->n = n;
    side->bare = smr_is_cloud(s) && smr_all_within(s->normal, 3u * (size_t)s->n_vertices, 0.0f);
    describe(side, s);
    side->outward = inside_out(s, side->centre) ? -1.0f : 1.0f;
    for (uint32_t k = 0; k < n; k++) {
        const uint32_t i = vertex_of(s, (uint32_t)(((uint64_t)2u * k + 1u) * kept / (2u * (uint64_t)n)), at);
        side->point[k] = smr_get3(s->xyz, i);
        side->normal[k] = smr_scale(smr_get3(s->normal, i), side->outward);
        side->weight[k] = s->area[i] * inverse;
        side->pair[k].triangle = SMR_NONE;
    }
}
