/* caller_goals.h: goals and forces of the caller's own. In: what smr_set_goals() and smr_set_force() were given,
 * positions. Out: ways and their weights, blended with those to targets.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_CALLER_GOALS_H
#define SMR_CALLER_GOALS_H

#include "runtime/deformed/shape.h"

#define SMR_CALLER_CHUNK 32u      /* vertices of a call */
#define SMR_CALLER_WEIGHT 1000.0f /* largest */

typedef struct smr_caller_goals {
    const smr_shared *shared;
    const smr_pace *pace;
    const smr_shape *shape;
    /* written by setup/caller.c */
    smr_goals *goals; /* [n_structures]; NULL: config.caller.goals is 0 */
    smr_force force;  /* NULL: none */
    void *ctx;
    float *gave;     /* [n][4] what the force gave: way, mm, and weight; NULL: config.caller.force is off */
    uint32_t broken; /* 1: the force broke its contract. Any thread sets it, atomically */
    uint32_t summed; /* 1: `sum` is of the forces under way, which are complete */
    uint64_t sum;    /* checksum of what it gave to active vertices */
    uint64_t told;   /* the same, of the iteration that the last tick completed; 0: none. Written by tick/tick.c */
} smr_caller_goals;

void smr_caller_goals_layout(smr_arena *a, smr_caller_goals *g, const smr_shared *shared);
void smr_caller_goals_wire(smr_caller_goals *g, const smr_shared *shared, const smr_pace *pace, const smr_shape *shape);
void smr_caller_goals_stand(smr_caller_goals *g); /* the forces under way are complete */

/* 1: the caller may draw vertices of the structure. */
static inline int smr_caller_draws(const smr_caller_goals *g, uint32_t structure)
{
    return g->force != NULL || (g->goals != NULL && g->goals[structure].xyz != NULL);
}

/* Steps: asks the force about SMR_CALLER_CHUNK vertices. */
uint32_t smr_caller_tasks(const void *goals);
void smr_caller_ask(void *goals, uint32_t task, uint32_t worker);

/* Adds a further way to an average by weight. The first one is taken as it is. */
static inline void smr_blend(smr_vec *way, float *weight, smr_vec more, float more_weight)
{
    if (!(more_weight > 0.0f))
        return;
    if (*weight > 0.0f) {
        const float share = more_weight / (*weight + more_weight);
        more = smr_add(*way, smr_scale(smr_sub(more, *way), share));
    }
    *way = more;
    *weight += more_weight;
}

/* Blends the way of vertex v, which has a weight (0: it is no goal), with what the caller wants of it. Returns the
 * weight then. */
float smr_caller_blend(const smr_caller_goals *g, uint32_t v, smr_vec *way, float weight);

#endif
