/* verdict_image_measures.c: how well intensity profiles match in their places, compared with chance in this image.
 * Bounds: SMR_LOOKED comparisons a structure, and one pass over its vertices.
 * SPDX-License-Identifier: MIT */
#include "verdict/verdict_measures.h"

#define SMR_LOOKED 400u /* most compared vertices of a structure, evenly spaced */

int smr_vertex_visible(const smr *s, uint32_t v)
{
    const smr_surface_goals *g = &s->forces.surface;
    const uint32_t owner = smr_model_owner(s->shared.model, v);
    int32_t wins = 0;
    uint32_t n = 0;
    if (g->target[owner].surface != NULL && g->visibility != NULL && g->target[owner].n_judged > 0u)
        return g->visibility[v] > SMR_VISIBLE_ONE / 2u;
    if (g->target[owner].surface != NULL || !s->forces.image.has_image || !s->forces.image.structure[owner].idle ||
        smr_field_of_past(&s->forces.occluded))
        return s->forces.found_last[v] == SMR_FOUND_GOAL;
    (void)smr_image_compare(&s->forces.image, v, &wins, &n); /* the search has ended: goals are no longer known */
    return wins > 0;
}

void smr_measure_image(const smr *s, uint32_t structure, smr_evidence *e)
{
    const smr_shape_structure *one = &s->shape.structure[structure];
    const uint32_t looked = smr_min_u32(one->n_vertices, SMR_LOOKED);
    for (uint32_t k = 0; k < looked && !smr_field_of_past(&s->forces.occluded); k++) {
        const uint32_t i = (uint32_t)((uint64_t)k * one->n_vertices / looked);
        int32_t wins;
        uint32_t n;
        (void)smr_image_compare(&s->forces.image, smr_model_position(s->shared.model, one->first_vertex + i), &wins,
                                &n);
        if (n == 0u)
            continue;
        smr_mean_add(&e->similarity, (float)wins / (float)n, (float)n);
    }
    if (!(e->similarity.weight > 0.0f) && !smr_field_of_past(&s->forces.occluded))
        smr_mean_add(&e->similarity, 0.0f, 1.0f); /* nothing to compare: as good as chance */
    const float matched = smr_forces_matched(&s->forces, structure);
    if (matched >= 0.0f) {
        smr_mean_add(&e->goals, matched, (float)one->n_vertices);
        smr_mean_add(&e->visible, matched, (float)one->n_vertices);
    }
    for (uint32_t i = 0; i < one->n_vertices; i++) {
        const uint32_t v = smr_model_position(s->shared.model, one->first_vertex + i);
        if (s->forces.found_last[v] == SMR_FOUND_GOAL)
            smr_mean_add(&e->residual, s->forces.residual[v], 1.0f);
    }
}
