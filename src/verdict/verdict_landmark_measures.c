/* verdict_landmark_measures.c: measures of a structure that only landmarks or the caller's goals determine: residuals,
 * and expected errors by the field through the landmarks.
 * Bounds: SMR_LANDMARKS_MAX^3 / 6 multiplications once, SMR_LANDMARKS_MAX^2 / 2 for each vertex.
 * SPDX-License-Identifier: MIT */
#include "verdict/verdict_measures.h"

void smr_measure_landmarks(const smr *s, uint32_t structure, smr_evidence *e)
{
    const smr_landmark_goals *g = &s->forces.landmarks;
    const smr_shape_structure *one = &s->shape.structure[structure];
    uint32_t own = 0, visible = 0;
    for (uint32_t k = 0; k < g->n; k++) {
        if (smr_model_owner(s->shared.model, g->landmark[k].corner[0]) != structure)
            continue;
        const smr_vec foot = smr_landmark_foot(g, k, s->shape.x);
        smr_mean_add(&e->residual, smr_length(smr_sub(smr_landmark_goal(g, k), foot)), 1.0f);
        own++;
    }
    if (own == 0u)
        return;
    for (uint32_t i = 0; i < one->n_vertices; i++)
        visible += (uint32_t)smr_vertex_visible(s, smr_model_position(s->shared.model, one->first_vertex + i));
    smr_mean_add(&e->visible, (float)visible / (float)one->n_vertices, (float)one->n_vertices);
}

void smr_measure_caller(const smr *s, uint32_t structure, smr_evidence *e)
{
    const smr_shape_structure *one = &s->shape.structure[structure];
    for (uint32_t i = 0; i < one->n_vertices; i++) {
        const uint32_t v = smr_model_position(s->shared.model, one->first_vertex + i);
        const int visible = smr_vertex_visible(s, v);
        smr_mean_add(&e->visible, (float)visible, 1.0f);
        if (visible)
            smr_mean_add(&e->residual, s->forces.residual[v], 1.0f);
    }
}

void smr_measure_by_landmarks(const smr *s, uint32_t structure, smr_evidence *e)
{
    const smr_shape_structure *one = &s->shape.structure[structure];
    const float residual = smr_mean_of(e->residual, 0.0f);
    float *const expected = smr_vertex_expected(s);
    /* a copy: the memory is free, and the iteration's field stays */
    smr_occluded_field field = s->forces.occluded;
    const float size2 = smr_landmark_field_solve(&field);
    if (size2 >= 0.0f)
        smr_mean_add(&e->bend, SMR_SQRT(size2), (float)one->n_vertices);
    for (uint32_t i = 0; i < one->n_vertices; i++) {
        const uint32_t v = smr_model_position(s->shared.model, one->first_vertex + i);
        expected[v] = -1.0f;
        if (size2 < 0.0f)
            continue;
        expected[v] = SMR_SQRT(3.0f * size2 * smr_landmark_field_left(&field, v) + residual * residual);
        smr_mean_add(&e->expected, expected[v], 1.0f);
    }
}
