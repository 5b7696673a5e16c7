/* expected_error.c: the expected error of each vertex: the field's standard deviation, given the visible vertices,
 * and the residual.
 * Bounds: those of the field.
 * SPDX-License-Identifier: MIT */
#include "verdict/verdict_measures.h"

void smr_measure_expected(const smr *s, uint32_t structure, smr_evidence *e)
{
    const smr_shape_structure *one = &s->shape.structure[structure];
    float *const expected = smr_vertex_expected(s);
    const float residual = smr_mean_of(e->residual, 0.0f);
    smr_normal_field field;
    if (smr_follows_landmarks(s, structure)) {
        smr_measure_by_landmarks(s, structure, e);
        return;
    }
    smr_normal_field_solve(&field, s, structure);
    if (field.n > 0u)
        smr_mean_add(&e->bend, SMR_SQRT(field.size2), (float)one->n_vertices);
    for (uint32_t i = 0; i < one->n_vertices; i++) {
        const uint32_t v = smr_model_position(s->shared.model, one->first_vertex + i);
        expected[v] = -1.0f;
        if (field.n == 0u)
            continue;
        const float error = smr_normal_field_error(&field, v);
        expected[v] = SMR_SQRT(error * error + residual * residual);
        smr_mean_add(&e->expected, expected[v], 1.0f);
    }
}
