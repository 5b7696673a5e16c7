/* caller_goals.h: goals and forces that the caller supplies. In: the arguments of smr_set_goals() and
 * smr_set_force(), positions. Out: displacements and weights, averaged with those of targets.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_CALLER_GOALS_H
#define SMR_CALLER_GOALS_H

#include "registration/shape/deformed_shape.h"

#define SMR_CALLER_CHUNK 32u      /* number of vertices in one call of the caller's force */
#define SMR_CALLER_WEIGHT 1000.0f /* largest legal weight of a caller's goal */

struct smr_caller_goals;

/* Functions for the caller's goals in an iteration. Programs without the setters, which name them, link none. */
typedef struct smr_caller_calls {
    void (*ask)(struct smr_caller_goals *g, uint32_t task); /* calls the caller's force for a chunk of vertices */
    /* averages v's *displacement, which has this weight, with the caller's displacements; returns the sum of weights */
    float (*blend)(const struct smr_caller_goals *g, uint32_t v, smr_vec *displacement, float weight);
    void (*stand)(struct smr_caller_goals *g); /* stores the checksum of the force's output in `sum` */
} smr_caller_calls;

extern const smr_caller_calls smr_caller_all;

typedef struct smr_caller_goals {
    const smr_caller_calls *calls; /* functions for the caller's goals; NULL: neither goals nor a force were set */
    const smr_shared *shared;
    const smr_schedule *schedule;
    const smr_shape *shape;
    /* members set by smr_set_goals() and smr_set_force() */
    smr_goals *goals;      /* [n_structures] goals of each structure; NULL: config.caller.goals is 0 */
    smr_force force;       /* the caller's function; NULL: none */
    void *ctx;             /* first argument of `force` */
    float *force_output;   /* [n][4] output of the force: displacement, mm, and weight; NULL: caller.force is off */
    uint32_t broken;       /* 1: the force returned illegal or varying values. Any thread sets it, atomically */
    uint32_t summed;       /* 1: the current forces are complete, and `sum` is their checksum */
    uint64_t sum;          /* checksum of the force's output for active vertices */
    uint64_t reported_sum; /* checksum of the last completed iteration's output; 0: none. Written by the tick */
} smr_caller_goals;

/* Returns 1 when the caller may give goals to vertices of the structure. */
static inline int smr_caller_has_goals(const smr_caller_goals *g, uint32_t structure)
{
    return g->force != NULL || (g->goals != NULL && g->goals[structure].xyz != NULL);
}

/* Returns the number of tasks that call the caller's force, each for SMR_CALLER_CHUNK vertices. */
static inline uint32_t smr_caller_tasks(const void *goals)
{
    const smr_caller_goals *g = goals;
    return g->force != NULL ? smr_ceil_div(g->schedule->n_active, SMR_CALLER_CHUNK) : 0u;
}

static inline void smr_caller_step(void *goals, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_caller_goals *g = goals;
    g->calls->ask(g, task);
}

/* Adds a displacement to a weighted mean. The first displacement becomes the mean unchanged. */
static inline void smr_blend(smr_vec *displacement, float *weight, smr_vec more, float more_weight)
{
    if (!(more_weight > 0.0f))
        return;
    if (*weight > 0.0f) {
        const float share = more_weight / (*weight + more_weight);
        more = smr_add(*displacement, smr_scale(smr_sub(more, *displacement), share));
    }
    *displacement = more;
    *weight += more_weight;
}

#endif
