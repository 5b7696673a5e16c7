/* rigid_pose.c: the present rigid pose of a structure or of the model, and how far the target is from it.
 * Bounds: two passes over the vertices.
 * SPDX-License-Identifier: MIT */
#include "verdict/verdict_measures.h"

#define SMR_POSE_LEAST 3.0f /* fewest visible vertices that give a pose */

/* Adds the vertices of a structure to the fit from rest to present positions; all 1: also occluded ones. */
static void add_vertices(const smr *s, const smr_shape_structure *one, int all, smr_fit *fit)
{
    for (uint32_t i = 0; i < one->n_vertices; i++) {
        const uint32_t v = smr_model_position(s->shared.model, one->first_vertex + i);
        if (all || smr_vertex_visible(s, v))
            smr_fit_add(fit, smr_rest(&s->shared, v), smr_get3(s->shape.x, v), 1.0f);
    }
}

/* Adds the distances of a structure's visible vertices in the pose to the planes through their goals. A goal lies at
 * the residual along the force from the position before, which x_next holds between iterations. Without a force (on the
 * target, within its noise, in a repair of folds, at the end in an image) it lies there, off by at most that. */
static void add_distances(const smr *s, const smr_shape_structure *one, const smr_pose *pose, smr_mean *mean)
{
    for (uint32_t i = 0; i < one->n_vertices; i++) {
        const uint32_t v = smr_model_position(s->shared.model, one->first_vertex + i);
        const smr_vec force = smr_get3(s->forces.force, v);
        const float length = smr_length(force), residual = s->forces.residual[v];
        if (s->forces.found_last[v] != SMR_FOUND_GOAL || !smr_vertex_visible(s, v) || residual < 0.0f)
            continue;
        const smr_vec moved = smr_sub(smr_pose_apply(pose, smr_rest(&s->shared, v)), smr_get3(s->shape.x_next, v));
        const float by_normal = smr_abs(smr_dot(moved, smr_get3(s->shape.normal, v)));
        smr_mean_add(mean,
                     length > 0.0f ? smr_abs(residual - smr_dot(moved, force) / length) : smr_max(residual, by_normal),
                     1.0f);
    }
}

smr_status smr_get_pose(const smr *s, uint32_t structure, smr_pose *pose, float *residual_mm)
{
    const smr_status status = smr_readable(s, structure == SMR_ALL ? 0u : structure, pose);
    if (status != SMR_OK || residual_mm == NULL)
        return status != SMR_OK ? status : SMR_E_NULL;
    if (s->n_awaited > 0u)
        return SMR_E_STATE;
    const uint32_t first = structure == SMR_ALL ? 0u : structure,
                   last = structure == SMR_ALL ? s->shared.n_structures : first + 1u;
    smr_mean mean = {0, 0};
    smr_fit fit = {.weight = 0.0f};
    for (int all = 0; all < 2 && fit.weight < SMR_POSE_LEAST; all++) {
        smr_fit_start(&fit, smr_v(0, 0, 0), smr_get3(s->shape.x, 0));
        for (uint32_t i = first; i < last; i++)
            add_vertices(s, &s->shape.structure[i], all, &fit);
    }
    const smr_pose fitted = smr_fit_solve(&fit, 0);
    const int measured = s->step == 0u && s->next_task == 0u && !s->forces.unmeasured &&
                         s->forces.totals.n_forces > 0u; /* 0 after a restore */
    for (uint32_t i = first; i < last && measured; i++)
        add_distances(s, &s->shape.structure[i], &fitted, &mean);
    *residual_mm = smr_mean_of(mean, -1.0f);
    *pose = fitted;
    pose->m[0][3] = pose->m[1][3] = pose->m[2][3] = 0.0f;
    const smr_vec centre =
        smr_pose_apply(&fitted, smr_v(0, 0, 0)); /* place of the model's centre, the origin of rest shapes */
    smr_pose_onto(pose, smr_model_centre(s->shared.model), smr_add(centre, s->shape.origin));
    return SMR_OK;
}
