/* dynamics_memory.c: the memory of velocities and masses.
 * Bounds: one pass over the vertices.
 * SPDX-License-Identifier: MIT */
#include "options/dynamics/dynamics.h"

void smr_dynamics_layout(smr_arena *a, smr_dynamics **dynamics, const smr_shared *shared)
{
    const size_t n = shared->n;
    smr_dynamics none, *d = &none;
    memset(&none, 0, sizeof none);
    if (!shared->config.dynamics.mode)
        return;
    *dynamics = smr_slot_scratch(a, *dynamics, 1, sizeof **dynamics);
    if (*dynamics != NULL)
        d = *dynamics;
    d->begin = smr_slot_floats(a, d->begin, 3u * n, SMR_KEPT_MM);
    d->velocity = smr_slot_floats(a, d->velocity, 3u * n, SMR_SPEED_MOST);
    d->mass = smr_slot_floats(a, d->mass, n, SMR_MASS_MOST);
    d->members = smr_slot_scratch(a, d->members, n, sizeof(float));
    d->group = smr_slot_scratch(a, d->group, shared->n_structures, sizeof *d->group);
    d->sums = smr_slot_scratch(a, d->sums, shared->n_structures, sizeof *d->sums);
    d->bent = smr_slot_floats(a, d->bent, shared->n_structures, SMR_STORED_MOST);
    d->spare = smr_slot_floats(a, d->spare, shared->n_structures, SMR_STORED_MOST);
    d->weight = smr_slot_scratch(a, d->weight, n, sizeof(float));
    smr_keep_floats(a, &d->stored.elastic, 1, 0.0f, SMR_STORED_MOST);
    smr_keep_floats(a, &d->stored.goals, 1, 0.0f, SMR_STORED_MOST);
    smr_keep_words(a, &d->weighed, 1, 1);
}

void smr_dynamics_wire(smr_dynamics *d, const smr_shared *shared)
{
    const smr_config *c = &shared->config;
    d->shared = shared;
    d->step_s = 0.001f * c->dynamics.step_ms;
    d->springs = c->dynamics.elastic * d->step_s * d->step_s;
    d->keeps = 1.0f / (1.0f + c->dynamics.damping * d->step_s);
    d->fall = smr_scale(smr_load(c->dynamics.gravity), d->step_s * d->step_s);
    for (uint32_t v = 0; v < shared->n; v++)
        d->mass[v] = smr_mass(shared, v);
}
