/* caller.c: goals and forces of the caller's own, as they are set.
 * Bounds: one pass over a structure's goals.
 * SPDX-License-Identifier: MIT */
#include "registration/api/restart.h"
#include "registration/api/setup.h"

static int legal(const float *xyz, const float *weights, uint32_t n)
{
    int good = 1;
    for (size_t i = 0; i < 3u * (size_t)n; i++)
        good &= smr_within(xyz[i], SMR_COORD_MAX);
    for (uint32_t i = 0; weights != NULL && i < n; i++)
        good &= weights[i] >= 0.0f && weights[i] <= SMR_CALLER_WEIGHT;
    return good;
}

smr_status smr_set_goals(smr *s, uint32_t structure, const float *xyz, const float *weights)
{
    if (s == NULL)
        return SMR_E_NULL;
    if (!smr_changeable(s))
        return SMR_E_STATE;
    if (s->forces.caller.goals == NULL)
        return SMR_E_ARENA;
    if (structure >= s->shared.n_structures)
        return SMR_E_INPUT;
    const uint32_t n = s->shape.structure[structure].n_vertices;
    if (xyz != NULL && !legal(xyz, weights, n))
        return SMR_E_INPUT;
    if (s->n_awaited > 0u)
        return smr_await_goals(s, structure, &(smr_goals){xyz, xyz != NULL ? weights : NULL});
    s->forces.caller.goals[structure] = (smr_goals){xyz, xyz != NULL ? weights : NULL};
    smr_restart_forces(s, SMR_CALLED_MOVED);
    smr_log_goals(&s->log, structure, &s->forces.caller.goals[structure], n);
    return SMR_OK;
}

smr_status smr_set_force(smr *s, smr_force force, void *ctx)
{
    if (s == NULL)
        return SMR_E_NULL;
    if (!smr_changeable(s))
        return SMR_E_STATE;
    if (s->forces.caller.gave == NULL)
        return SMR_E_ARENA;
    if (s->n_awaited > 0u)
        return smr_await_force(s, force, ctx);
    s->forces.caller.force = force;
    s->forces.caller.ctx = force != NULL ? ctx : NULL;
    s->forces.caller.broken = 0;
    smr_restart_forces(s, SMR_CALLED);
    smr_log_force(&s->log, force != NULL);
    return SMR_OK;
}
