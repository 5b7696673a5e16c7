/* landmark_evidence.c: what landmarks, or goals of the caller's own, alone say of a structure: how far its points are
 * from their places, and how far each vertex is expected from its own, by the field that it follows
 * (forces/unseen_field.c).
 * Bounds: SMR_LANDMARKS_MAX^3 / 6 multiplications once, SMR_LANDMARKS_MAX^2 / 2 for each vertex.
 * SPDX-License-Identifier: MIT */
#include "verdict/landmark_evidence.h"

void smr_measure_landmarks(const smr *s, uint32_t structure, smr_evidence *e)
{
    const smr_landmark_goals *g = &s->forces.landmarks;
    const smr_shape_structure *one = &s->shape.structure[structure];
    uint32_t own = 0, seen = 0;
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
        seen += (uint32_t)smr_vertex_seen(s, smr_model_position(s->shared.model, one->first_vertex + i));
    smr_mean_add(&e->seen, (float)seen / (float)one->n_vertices, (float)one->n_vertices);
}

/* Goals of the caller's own: who has one, and how far off it is. */
void smr_measure_caller(const smr *s, uint32_t structure, smr_evidence *e)
{
    const smr_shape_structure *one = &s->shape.structure[structure];
    for (uint32_t i = 0; i < one->n_vertices; i++) {
        const uint32_t v = smr_model_position(s->shared.model, one->first_vertex + i);
        const int seen = smr_vertex_seen(s, v);
        smr_mean_add(&e->seen, (float)seen, 1.0f);
        if (seen)
            smr_mean_add(&e->residual, s->forces.residual[v], 1.0f);
    }
}

void smr_measure_by_landmarks(const smr *s, uint32_t structure, smr_evidence *e)
{
    const smr_shape_structure *one = &s->shape.structure[structure];
    const float residual = smr_mean_of(e->residual, 0.0f);
    float *const expected = smr_vertex_expected(s);
    smr_unseen_field field = s->forces.unseen; /* a copy: its memory is free, the iteration's field stays as it is */
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
