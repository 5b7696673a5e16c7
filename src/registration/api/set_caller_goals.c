/* set_caller_goals.c: sets goals and the force that the caller supplies.
 * Bounds: one pass over a structure's goals.
 * SPDX-License-Identifier: MIT */
#include "options/track/track.h"
#include "registration/api/setup.h"

static int legal(const float *xyz, const float *weights, uint32_t n)
{
    int good = smr_all_within(xyz, 3u * (size_t)n, SMR_COORD_MAX);
    for (uint32_t i = 0; weights != NULL && i < n; i++)
        good &= weights[i] >= 0.0f && weights[i] <= SMR_CALLER_WEIGHT;
    return good;
}

smr_status smr_set_goals(smr *s, uint32_t structure, const float *xyz, const float *weights)
{
    const smr_goals goals = {xyz, xyz != NULL ? weights : NULL};
    SMR_TRY(smr_settable(s, 1, 1));
    if (s->forces.caller.goals == NULL)
        return SMR_E_ARENA;
    if (structure >= s->shared.n_structures)
        return SMR_E_INPUT;
    const uint32_t n = s->shape.structure[structure].n_vertices;
    if (xyz != NULL && !legal(xyz, weights, n))
        return SMR_E_INPUT;
    if (s->n_awaited > 0u)
        return s->await(s, SMR_LOG_GOALS, structure, &goals);
    s->forces.caller.calls = &smr_caller_all;
    s->forces.caller.goals[structure] = goals;
    s->schedule.n_set++;
    smr_restart_forces(s, SMR_CHANGED_MOVED);
    smr_changed(s, SMR_LOG_GOALS, structure, &goals, n);
    return SMR_OK;
}

smr_status smr_set_force(smr *s, smr_force force, void *ctx)
{
    SMR_TRY(smr_settable(s, 1, 1));
    if (s->forces.caller.force_output == NULL)
        return SMR_E_ARENA;
    if (s->n_awaited > 0u)
        return s->await(s, SMR_LOG_FORCE, 0, &(smr_caller_force){force, ctx});
    s->forces.caller.calls = &smr_caller_all;
    s->forces.caller.force = force;
    s->forces.caller.ctx = force != NULL ? ctx : NULL;
    s->forces.caller.broken = 0;
    smr_restart_forces(s, SMR_CHANGED);
    smr_changed(s, SMR_LOG_FORCE, force != NULL, NULL, 0);
    return SMR_OK;
}
