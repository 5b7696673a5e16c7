/* iteration_steps.h: the steps of an iteration in their order.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_ITERATION_STEPS_H
#define SMR_ITERATION_STEPS_H

#include "options/dynamics/dynamics.h"
#include "options/track/track.h"

/* What a step's time is proportional to: its tasks, active vertices, entries of the order L, or nothing known
 * beforehand. */
enum { SMR_WORK_TASKS = 0, SMR_WORK_ACTIVE, SMR_WORK_LISTS, SMR_WORK_FOLDS };

/* Whether a step's tasks run in any order or one after the other. */
enum { SMR_ANY_ORDER = 0, SMR_SERIAL };

/* Parts of an iteration, as bits: a configuration asks for some (parts_of() in layout.c). PLAIN is in every one. A step
 * of a part may still have no tasks in an iteration. */
enum {
    SMR_PART_PLAIN = 1,
    SMR_PART_IMAGE = 2,
    SMR_PART_PARTIAL = 4,
    SMR_PART_TRACK = 8,
    SMR_PART_CONTACT = 16,
    SMR_PART_DYNAMICS = 32,
    SMR_PART_CALLER = 64,
    SMR_PART_HELD = SMR_PART_TRACK | SMR_PART_DYNAMICS
};

/* A step: n_tasks tasks (0: skipped), then one serial call of `end`. All functions but `end` get the stage's own
 * struct, which lies `stage` bytes from the registration's start. Where tasks are pieces of a larger task, `abreast`
 * of them are independent, and the next ones need their results. */
typedef struct smr_step {
    uint16_t part;        /* SMR_PART_...: the step is in iterations that have one of them */
    uint16_t phase;       /* SMR_PHASE_... */
    uint16_t work, order; /* SMR_WORK_..., SMR_ANY_ORDER ... */
    uint32_t stage;
    uint32_t (*n_tasks)(const void *stage);
    smr_task run;
    void (*end)(smr *s);
    /* called before the first task: whether to cut into pieces. NULL: never cut */
    void (*pieces)(void *stage, int cut);
    uint32_t (*abreast)(const void *stage);
} smr_step;

extern const smr_step smr_steps[];
extern const uint32_t smr_n_steps;

/* Parts that this build has. A step of another one has no functions. */
#define SMR_HAS_PLAIN 1
#define SMR_HAS_CALLER 1
#define SMR_HAS_HELD (SMR_HAS_TRACK || SMR_HAS_DYNAMICS)

static inline int smr_step_on(const smr *s, const smr_step *step) { return (step->part & s->shared.parts) != 0u; }

static inline void *smr_stage_of(smr *s, const smr_step *step) { return (char *)s + step->stage; }

/* The number of the step's tasks, which may grow while they run. */
static inline uint32_t smr_step_tasks(smr *s, const smr_step *step)
{
    return smr_step_on(s, step) ? step->n_tasks(smr_stage_of(s, step)) : 0u;
}

void smr_refit_again(void *s, uint32_t task, uint32_t worker);

int smr_forces_pending(const smr *s);       /* 1: the forces of the current iteration are not yet complete */
int smr_seeks_forces(const smr_step *step); /* 1: the step that searches for goals */

/* Vertices whose goals were searched for so far in the current iteration. */
uint32_t smr_forces_evaluated(const smr *s);

#endif
