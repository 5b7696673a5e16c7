/* time_steps.h: dynamics: time steps of implicit Euler, each of SMR_SWEEPS iterations.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_TIME_STEPS_H
#define SMR_TIME_STEPS_H

#include "registration/registration.h"

void smr_time_steps_start(smr *s); /* x is at rest, and the shape that the model is elastic about */
void smr_time_steps_begin(smr *s); /* before an iteration */
void smr_time_steps_next(smr *s);  /* after an iteration */
void smr_time_steps_weigh(smr *s); /* masses are new: weights of the clusters' fits */

/* Mass of a vertex as it counts, g. 0: it keeps its velocity. */
static inline float smr_counted_mass(const smr_dynamics *d, uint32_t v)
{
    return d->mass[v] > 0.0f ? d->weight[v] * d->members[v] * d->gram : 0.0f;
}

/* A structure's vertex i in the caller's order. */
static inline uint32_t smr_vertex_of(const smr *s, uint32_t structure, uint32_t i)
{
    return smr_model_position(s->shared.model, s->shape.structure[structure].first_vertex + i);
}

#endif
