/* iteration.h: the steps of an iteration, in their order.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_ITERATION_H
#define SMR_ITERATION_H

#include "options/dynamics/dynamics.h"
#include "options/track/track.h"

/* What a step's time is in proportion to: its number of tasks, active vertices, what the chain along the order L reads,
 * or nothing that is known beforehand. */
enum { SMR_WORK_TASKS = 0, SMR_WORK_ACTIVE, SMR_WORK_LISTS, SMR_WORK_FOLDS };

/* How a step's tasks follow each other: in any order, or one after the other in their order. */
enum { SMR_ANY_ORDER = 0, SMR_SERIAL };

/* n_tasks tasks (0: the step is skipped), then one serial end. The functions but `end` get the stage's own struct,
 * which lies `stage` bytes from the registration's start. Where tasks are pieces of something that is one task
 * without a budget, `abreast` pieces are independent and the next so many need them. */
typedef struct smr_step {
    uint16_t part;        /* SMR_PART_...: the step is in iterations that have one of them */
    uint16_t phase;       /* SMR_PHASE_... */
    uint16_t work, order; /* SMR_WORK_..., SMR_ANY_ORDER ... */
    uint32_t stage;
    uint32_t (*n_tasks)(const void *stage);
    smr_task run;
    void (*end)(smr *s);
    void (*pieces)(void *stage, int cut); /* before the first task: whether to cut. NULL: never */
    uint32_t (*abreast)(const void *stage);
} smr_step;

extern const smr_step smr_steps[];
extern const uint32_t smr_n_steps;

/* Parts that this build has. A step of another one has no functions. */
#define SMR_HAS_PLAIN 1
#define SMR_HAS_CALLER 1
#define SMR_HAS_HELD (SMR_HAS_TRACK || SMR_HAS_DYNAMICS)

/* 1: the step is in the iterations of s. */
static inline int smr_step_on(const smr *s, const smr_step *step) { return (step->part & s->shared.parts) != 0u; }

static inline void *smr_stage_of(smr *s, const smr_step *step) { return (char *)s + step->stage; }

/* A step may have more tasks when those so far are done. */
static inline uint32_t smr_step_tasks(smr *s, const smr_step *step)
{
    return smr_step_on(s, step) ? step->n_tasks(smr_stage_of(s, step)) : 0u;
}

/* The facets' step where folds moved anything; the stage is the registration itself. */
void smr_refit_again(void *s, uint32_t task, uint32_t worker);

int smr_forces_pending(const smr *s);       /* 1 until the iteration under way has its forces */
int smr_seeks_forces(const smr_step *step); /* 1: the step that looks for the ways to the goals */

/* Vertices whose forces were looked for so far in the iteration under way. */
uint32_t smr_forces_evaluated(const smr *s);

#endif
