/* surface.c: finds closest points on a target surface.
 * SPDX-License-Identifier: MIT */
#include "geometry/surface/surface.h"

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
    for (uint32_t i = 0; i < 3u; i++)
        if (!smr_within(point[i], SMR_COORD_MAX) || (normal != NULL && !smr_within(normal[i], 2.0f)))
            return SMR_E_INPUT;
    if (!(max_mm >= 0.0f) || (normal != NULL && !smr_within(min_cos, 2.0f)))
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
