/* get_results.c: reads positions, normals, reports and the state of the log.
 * SPDX-License-Identifier: MIT */
#include "options/references/references.h"
#include "registration/schedule_radius.h"
#include "registration/tick/iteration_steps.h"

smr_status smr_copy_out(const smr *s, uint32_t structure, float *array, smr_vec shift, float *xyz)
{
    SMR_TRY(smr_positions_readable(s, structure, xyz));
    const smr_shape_structure *one = &s->shape.structure[structure];
    for (uint32_t i = 0; i < one->n_vertices; i++) {
        const uint32_t v = smr_model_position(s->shared.model, one->first_vertex + i);
        smr_put3(xyz, i, smr_add(smr_get3(array, v), shift));
    }
    return SMR_OK;
}

smr_status smr_get_positions(const smr *s, uint32_t structure, float *xyz)
{
    return smr_copy_out(s, structure, s == NULL ? NULL : s->shape.x, s == NULL ? smr_v(0, 0, 0) : s->shape.origin, xyz);
}

smr_status smr_get_normals(const smr *s, uint32_t structure, float *xyz)
{
    SMR_TRY(smr_copy_out(s, structure, s == NULL ? NULL : s->shape.normal, smr_v(0, 0, 0), xyz));
    const smr_shape_structure *one = &s->shape.structure[structure];
    const uint32_t n = smr_exchanged(s);
    for (uint32_t i = 0; i < one->n_vertices && n > 0u; i++) {
        const uint32_t v = smr_model_position(s->shared.model, one->first_vertex + i);
        if (v < n)
            smr_put3(xyz, i, smr_next_normal(s->sums.sum, v));
    }
    return SMR_OK;
}

smr_status smr_get_reference_weights(const smr *s, float *weights, uint32_t *n)
{
    SMR_TRY(weights == NULL || n == NULL ? SMR_E_NULL : smr_readable(s, 0, n));
    *n = smr_max_u32(s->shared.n_references, 1u);
    for (uint32_t i = 0; i < *n; i++)
        weights[i] = 1.0f / (float)*n + (smr_blends(&s->shape) ? s->shape.references->more[i] : 0.0f);
    return SMR_OK;
}

/* Fills in the results of a structure's last complete forces. */
static void report_forces(const smr *s, const smr_shape_structure *one, smr_structure_report *report)
{
    float sum = 0.0f, most = 0.0f, n = 0.0f;
    for (uint32_t i = 0; i < one->n_vertices; i++) {
        const uint32_t v = smr_model_position(s->shared.model, one->first_vertex + i);
        report->n_rejected += smr_found(&s->forces, v) >= SMR_FOUND_NONE;
        if (smr_found(&s->forces, v) != SMR_FOUND_GOAL)
            continue;
        report->n_forces++;
        if (s->forces.residual[v] < 0.0f)
            continue;
        n += 1.0f;
        sum += s->forces.residual[v];
        most = smr_max(most, s->forces.residual[v]);
    }
    if (!(n > 0.0f))
        return;
    report->residual_mean_mm = sum / n;
    report->residual_max_mm = most;
}

static int has_landmark(const smr *s, uint32_t structure)
{
    const smr_landmark_goals *g = &s->forces.landmarks;
    int has = 0;
    for (uint32_t k = 0; k < g->n; k++)
        has |= smr_model_owner(s->shared.model, g->landmark[k].corner[0]) == structure;
    return has;
}

smr_status smr_get_structure_report(const smr *s, uint32_t structure, smr_structure_report *report)
{
    SMR_TRY(smr_readable(s, structure, report));
    if (s->n_awaited > 0u)
        return SMR_E_STATE; /* awaited inputs are not set: the structure's target is unknown */
    const smr_shape_structure *one = &s->shape.structure[structure];
    const smr_target *target = &s->forces.surface.target[structure];
    float moved_sum = 0.0f;
    memset(report, 0, sizeof *report);
    report->has_target = target->surface != NULL || smr_image_on(&s->forces.image) || has_landmark(s, structure) ||
                         smr_caller_has_goals(&s->forces.caller, structure);
    report->matched_share = smr_forces_matched(&s->forces, structure);
    report->residual_mean_mm = report->residual_max_mm = -1.0f;
    if (target->measured)
        report_forces(s, one, report);
    for (uint32_t i = 0; i < one->n_vertices; i++) {
        const uint32_t v = smr_model_position(s->shared.model, one->first_vertex + i);
        const float moved = smr_length(smr_sub(smr_get3(s->shape.x, v), smr_get3(s->shape.start, v)));
        moved_sum += moved;
        report->moved_max_mm = smr_max(report->moved_max_mm, moved);
    }
    if (one->n_vertices > 0u)
        report->moved_mean_mm = moved_sum / (float)one->n_vertices;
    return SMR_OK;
}

uint64_t smr_state_hash(const smr *s)
{
    if (smr_sound(s) != SMR_OK || s->ticking == SMR_STARTING)
        return 0;
    float *const x_ref = smr_plastic_follows(s) ? s->shape.x : s->shape.x_ref;
    uint64_t hash = smr_hash_positions(s->shape.x, s->shared.n) + 3u * smr_hash_positions(x_ref, s->shared.n);
    for (uint32_t v = smr_plastic_follows(s) || s->evolve.ref_next == SMR_REF_STAYS ? 0u : smr_exchanged(s);
         v-- > 0u;) {
        const smr_vec former = smr_sum_vec(s->sums.sum, v, SMR_FORMER_REF);
        hash += 3u * (smr_hash_point(v, &former.x) - smr_hash_point(v, smr_at3(x_ref, v)));
    }
    return hash;
}

smr_status smr_get_log(const smr *s, smr_log_state *state)
{
    SMR_TRY(smr_readable(s, 0, state));
    *state = (smr_log_state){s->log.used, s->log.n_ticks, s->log.full};
    return SMR_OK;
}
