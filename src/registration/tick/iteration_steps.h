/* iteration_steps.h: the steps of an iteration in their order, the schedule between iterations and the time budget.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_ITERATION_STEPS_H
#define SMR_ITERATION_STEPS_H

#include "options/dynamics/dynamics.h"
#include "options/track/track.h"

/* What a step's time is proportional to: tasks, active vertices, entries of the order L. FOLDS: unknown beforehand. */
enum { SMR_WORK_TASKS = 0, SMR_WORK_ACTIVE, SMR_WORK_LISTS, SMR_WORK_FOLDS };

/* Order of a step's tasks: any, or one after the other. */
enum { SMR_ANY_ORDER = 0, SMR_SERIAL };

/* Parts of an iteration, as bits: the configuration decides which are in use (parts_of() in init.c). PLAIN always is;
 * steps of REFERENCE have tasks only in iterations with a new reference shape or other active vertices. */
enum {
    SMR_PART_PLAIN = 1,
    SMR_PART_IMAGE = 2,
    SMR_PART_PARTIAL = 4,
    SMR_PART_TRACK = 8,
    SMR_PART_CONTACT = 16,
    SMR_PART_DYNAMICS = 32,
    SMR_PART_CALLER = 64,
    SMR_PART_REFERENCE = 128,
    SMR_PART_HELD = SMR_PART_TRACK | SMR_PART_DYNAMICS
};

/* A step: n_tasks tasks (0: no step), then one serial call of `end`. Other functions get the stage's own struct. */
typedef struct smr_step {
    uint16_t part;        /* SMR_PART_...: the step runs where one of these parts is in use */
    uint16_t phase;       /* SMR_PHASE_...: phase to which the step's time counts */
    uint16_t work, order; /* SMR_WORK_...: what the step's time is proportional to; order of tasks, SMR_SERIAL or any */
    uint32_t stage;       /* offset of the stage's struct in the registration, bytes */
    uint32_t cost;        /* instructions of a task at most, on a Cortex-M7; 0: tasks count their work, and may stop */
    smr_count_tasks *n_tasks;
    smr_task run;
    void (*end)(smr *s);
} smr_step;

extern const smr_step smr_steps[];
extern const uint32_t smr_n_steps;

/* 1: this build has the part. A step of any other part has no functions. */
#define SMR_HAS_PLAIN 1
#define SMR_HAS_REFERENCE 1
#define SMR_HAS_CALLER 1
#define SMR_HAS_HELD (SMR_HAS_TRACK || SMR_HAS_DYNAMICS)

static inline int smr_step_on(const smr *s, const smr_step *step) { return (step->part & s->shared.parts) != 0u; }
static inline void *smr_stage_of(smr *s, const smr_step *step) { return (char *)s + step->stage; }

/* Returns the number of the step's tasks, which may grow while tasks run. */
static inline uint32_t smr_step_tasks(smr *s, const smr_step *step)
{
    const int due = step->part != SMR_PART_REFERENCE || smr_reference_due(&s->reference);
    return due && smr_step_on(s, step) ? step->n_tasks(smr_stage_of(s, step)) : 0u;
}

/* smr_tick() without a budget that ends, with SMR_PARTIAL, before the step whose tasks `run` does. The next tick
 * resumes there. */
smr_status smr_tick_until(smr *s, smr_run_task *run);

smr_run_task smr_refit_again;                /* step: updates triangles after fold steps */
smr_run_task smr_commit;                     /* last step: makes new positions current */
int smr_forces_pending(const smr *s);        /* 1: the forces of the current iteration are not yet complete */
void smr_forces_settle(smr *s);              /* completes smr_sources_keep() where it is next, for a new input */
int smr_seeks_forces(const smr_step *step);  /* 1: the step searches for goals */
uint32_t smr_forces_evaluated(const smr *s); /* number of vertices searched for goals in the current iteration */

/* Returns the number of vertices with the next normals, and the next x^r if evolve.ref_next is not SMR_REF_STAYS; then
 * smr_sums.sum has the former ones. */
uint32_t smr_exchanged(const smr *s);

/* Abandons the current iteration: x stays; all results are discarded, since a replay does not know which existed. */
void smr_abandon_iteration(smr *s);
/* Discards the results of an iteration in part `part` of `parts` of all arrays but positions and normals. */
void smr_iteration_reset(smr *s, uint32_t part, uint32_t parts);

/* coarse_to_fine_schedule.c: work between iterations. */
void smr_place_reset(smr *s);    /* goes back to the start of an iteration */
void smr_schedule_start(smr *s); /* starts at the first radius, from the present positions */
void smr_schedule_begin(smr *s); /* before an iteration: chooses active vertices, search distances and momentum */
void smr_schedule_next(smr *s);  /* after an iteration: plasticity, the next radius, or the end */

/* time_budget.c: fits an iteration into a time budget. */
void smr_budget_start(smr *s);                    /* sets the costs of all steps to unknown */
void smr_budget_plan(smr *s, uint64_t budget_ns); /* before an iteration: decides whether vertices may be left out */
void smr_budget_resume(smr *s);                   /* when a tick continues an iteration: marks the iteration as late */
void smr_budget_done(smr *s);                     /* after an iteration: stores its time; adapts the margin */
/* Returns 1 when the remaining time, left_ns, is needed for the rest of the iteration. reached: vertices searched. */
int smr_budget_reached(smr *s, uint64_t left_ns, uint32_t reached);
uint32_t smr_budget_stretch(const smr *s,
                            uint64_t left_ns); /* work of each worker until the next reading of the clock */
uint64_t smr_budget_ahead(smr *s, uint32_t n_tasks, uint32_t stretch); /* predicted ns of that work; 0: unknown */
void smr_budget_spend(smr *s, uint64_t ns, uint64_t budget_ns);        /* adds ns to the step's time */
void smr_budget_learn(smr *s, uint32_t n_tasks);                       /* after a step: stores its cost */

#endif
