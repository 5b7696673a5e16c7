/* surface_distance.c: closest points on a target surface, and signed distances to a surface of triangles. The sign
 * follows from the normals of all triangles that share the closest point, weighted by their angles there (Baerentzen
 * and Aanaes, "Signed distance computation using the angle weighted pseudonormal", 2005). The direction is a mean over
 * triangles nearly as close, with weights that fall to 0. Near the surface the direction becomes the interpolated
 * vertex normal, so it is continuous across edges. Bounds: those of smr_tree_near.
 * SPDX-License-Identifier: MIT */
#include "geometry/surface/surface.h"
#include "geometry/box_tree/triangle.h"

#define SMR_SIDE_NEAR 0.1f    /* mm: distance below which the direction is about the interpolated vertex normal */
#define SMR_SIDE_TIE 1.00001f /* triangles with squared distances within this factor share the closest edge or corner */
#define SMR_SIDE_ZERO 1.0e-10f   /* mm^2: smaller squared distances count as 0 */
#define SMR_WORK_SIDE 800u       /* instructions at most for a triangle nearly as close as the closest one */
#define SMR_STRAIGHT 3.14159265f /* rad: 180 degrees */

/* Returns the arc cosine, rad, to 7e-5 (Abramowitz and Stegun, 4.4.45). */
static float angle_of(float cosine)
{
    const float c = smr_min(smr_abs(cosine), 1.0f);
    const float angle = SMR_SQRT(1.0f - c) * (1.5707288f + c * (-0.2121144f + c * (0.0742610f - 0.0187293f * c)));
    return cosine < 0.0f ? SMR_STRAIGHT - angle : angle;
}

/* Returns a triangle's angle, rad, at the corner nearest to the closest point. */
static float angle_at(const smr_box_tree *f, const smr_near *near)
{
    const uint32_t *t = smr_triangle_of(f->triangle, near->triangle, f->n_vertices);
    const float *w = near->weight;
    const uint32_t c = w[0] >= w[1] && w[0] >= w[2] ? 0u : w[1] >= w[2] ? 1u : 2u;
    const smr_vec at = smr_get3(f->xyz, t[c]);
    const smr_vec a = smr_unit(smr_sub(smr_get3(f->xyz, t[(c + 1u) % 3u]), at)),
                  b = smr_unit(smr_sub(smr_get3(f->xyz, t[(c + 2u) % 3u]), at));
    return angle_of(smr_dot(a, b));
}

int smr_signed_distance(const smr_box_tree *f, const float *normal, const smr_query *q, float most, smr_pause *pause,
                        smr_side *side)
{
    smr_certainty known = {-1.0f, 0.0f, 0, pause};
    smr_hit hit = {most * most, SMR_NONE, {0, 0, 0}};
    smr_near_list list;
    smr_vec from = smr_v(0, 0, 0), along = from;
    float height = 0.0f; /* weighted height of the point above the triangles at the closest point, positive outside */
    uint32_t n_ties = 0;
    if (!smr_tree_near(f, q, &hit, &list, &known) || hit.triangle == SMR_NONE)
        return 0;
    const float tie = hit.d2 * SMR_SIDE_TIE + SMR_SIDE_ZERO, distance = SMR_SQRT(hit.d2);
    for (uint32_t i = 0; i < list.n; i++)
        n_ties += list.item[i].d2 <= tie;
    for (uint32_t i = 0; i < list.n; i++) {
        const smr_near *near = &list.item[i];
        const smr_vec r = smr_sub(q->point, smr_triangle_point(f, near->triangle, near->weight));
        from = smr_add(from, smr_scale(r, near->share));
        const smr_corner_values at =
            smr_corners_of(normal, smr_triangle_of(f->triangle, near->triangle, f->n_vertices));
        along = smr_add(along, smr_scale(smr_corners_mean(at, near->weight), near->share));
        if (near->d2 <= tie) /* two triangles share an edge and weigh alike; more share a corner and weigh by angles */
            height += smr_dot(r, smr_get3(f->normal, near->triangle)) * (n_ties > 2u ? angle_at(f, near) : 1.0f);
    }
    const float sign = height < 0.0f ? -1.0f : 1.0f;
    const smr_vec direction = smr_add(smr_scale(from, sign), smr_scale(along, SMR_SIDE_NEAR));
    if (pause != NULL)
        smr_work(pause, list.n * SMR_WORK_SIDE);
    side->mm = sign * distance;
    side->out = smr_scale(direction, 1.0f / smr_max(smr_length(direction), 0.25f * (SMR_SIDE_NEAR + distance)));
    side->triangle = hit.triangle;
    memcpy(side->weight, hit.weight, sizeof side->weight);
    return 1;
}

uint32_t smr_surface_on_border(const smr_surface *s, uint32_t triangle, const float weight[3])
{
    const uint32_t bits = s->border[triangle];
    for (uint32_t c = 0; c < 3u; c++) {
        const uint32_t next = (c + 1u) % 3u, opposite = (c + 2u) % 3u;
        const int at_corner = weight[next] == 0.0f && (bits >> (3u + c) & 1u), on_edge = bits >> c & 1u;
        if (weight[opposite] == 0.0f && (at_corner || on_edge))
            return 1u;
    }
    return 0u;
}

smr_status smr_surface_closest(const smr_surface *surface, const float *point, const float *normal, float min_cos,
                               float max_mm, smr_closest *hit)
{
    if (surface == NULL || point == NULL || hit == NULL)
        return SMR_E_NULL;
    if (!smr_surface_valid(surface))
        return SMR_E_STATE;
    if (!smr_all_within(point, 3, SMR_COORD_MAX) || !(max_mm >= 0.0f) ||
        (normal != NULL && !(smr_all_within(normal, 3, 2.0f) && smr_within(min_cos, 2.0f))))
        return SMR_E_INPUT;
    max_mm = smr_min(max_mm, 8.0f * SMR_COORD_MAX);
    const smr_vec direction = normal != NULL ? smr_load(normal) : smr_v(0, 0, 0);
    const smr_query q = {smr_sub(smr_load(point), surface->origin), direction, normal != NULL ? min_cos : -2.0f,
                         UINT32_MAX, SMR_NONE};
    smr_hit h = {max_mm * max_mm, SMR_NONE, {0, 0, 0}};
    smr_tree_closest(&surface->tree, &q, &h);
    memset(hit, 0, sizeof *hit);
    hit->triangle = SMR_NONE;
    if (h.triangle == SMR_NONE)
        return SMR_OK;
    smr_store(hit->point, smr_add(smr_triangle_point(&surface->tree, h.triangle, h.weight), surface->origin));
    memcpy(hit->normal, surface->tree.normal + 3u * (size_t)h.triangle, sizeof hit->normal);
    memcpy(hit->weight, h.weight, sizeof hit->weight);
    hit->distance = SMR_SQRT(h.d2);
    hit->triangle = surface->original[h.triangle];
    hit->on_border = smr_surface_on_border(surface, h.triangle, h.weight);
    return SMR_OK;
}
