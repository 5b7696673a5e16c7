/* registration.h: a registration: the structs of its stages in the order of an iteration, and its state. The struct
 * lies at the start of the caller's arena; the stages' arrays follow. A stage gets its own struct, which holds const
 * pointers to what the stage reads.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_REGISTRATION_H
#define SMR_REGISTRATION_H

#include "registration/evolve/evolve_positions.h"
#include "options/contact/contact.h"
#include "registration/folds/folds.h"
#include "registration/goals/external_forces.h"
#include "log/record/log_format.h"

#define SMR_STATE_MAGIC 0x736d7254u
#define SMR_STEPS_MAX 46u /* largest number of steps of an iteration */

/* Measured costs of steps, and decisions of the time budget (time_budget.c). */
typedef struct smr_time_budget {
    float rate[SMR_STEPS_MAX]; /* cost of each step, ns a unit of work; negative: unknown */
    uint64_t spent;            /* time spent in the current step, ns */
    uint32_t work;             /* work done since the last reading of the clock, instructions at most */
    float pace;                /* ns an instruction of work; negative: unknown */
    float sum;                 /* time spent in the current iteration, ns */
    float whole;               /* mean time of an iteration, ns */
    uint32_t count;            /* number of active vertices when the costs of the cluster sums were learnt */
    uint32_t uncut;            /* 1: the current iteration spans several ticks and leaves no vertex out */
    uint32_t late;             /* 1: the iteration was planned for one tick and needed another */
    uint32_t cut;              /* 1: n_active was reduced for lack of time */
    uint32_t repairing;        /* 1: the last iteration repaired folds */
    float margin;              /* factor on the predicted time of the iteration's later steps, kept in reserve */
    uint32_t look;             /* number of searched vertices at which the time in reserve is checked next */
    uint32_t odd;              /* 1: the clock ran backwards in the current step */
} smr_time_budget;

struct smr {
    uint32_t magic;           /* SMR_STATE_MAGIC marks a registration */
    uint32_t step, next_task; /* position of the tick: current step of the iteration; number of its complete tasks */
    uint32_t n_dealt, block;  /* number of the step's tasks that workers have got; number in a block */
    uint32_t n_shares;  /* number of workers among which the step's tasks are divided; 0: the step has not begun */
    uint32_t ticking;   /* 1: a tick is running, perhaps in this thread: inputs are refused */
    uint32_t refused;   /* 1: the port left out a task or used an illegal worker. Setting positions clears it */
    uint32_t n_awaited; /* number of inputs that must be set again after a restore */
    /* sets an awaited input of this kind (SMR_LOG_...) and number; the pointer is set by smr_restore() */
    smr_status (*await)(smr *s, uint32_t kind, uint32_t number, const void *what);
    const struct smr *placed; /* address given by smr_init(): a copy would share the original's arrays */
    smr_port port;
    smr_shared shared;
    smr_schedule schedule;
    smr_overlay overlay;
    smr_shape shape;
    smr_forces forces;
    smr_sums sums;
    smr_reference reference;
    smr_match match;
    smr_evolve evolve;
    smr_volumes volumes;
    smr_folds folds;
    smr_time_budget budget;
    smr_log log;
    uint32_t n_measured; /* number of measures begun, which use the memory of records and sums */
    smr_tick_report report;
};

/* Goes back to the start of an iteration. */
static inline void smr_place_reset(smr *s)
{
    s->step = s->next_task = s->n_shares = s->n_dealt = 0;
    for (uint32_t k = 0; k < s->shared.config.basic.n_workers; k++)
        smr_worker_start(&s->shared.worker[k]);
}

/* Returns 1 for a registration at the address that smr_init() gave it. */
static inline int smr_valid(const smr *s) { return s != NULL && s->magic == SMR_STATE_MAGIC && s->placed == s; }

/* Returns 1 when the registration may be changed: no tick is running. */
static inline int smr_changeable(const smr *s) { return smr_valid(s) && !s->ticking; }

/* Returns 1 when the registration may run: no tick is running, and no input is awaited. */
static inline int smr_ready(const smr *s) { return smr_changeable(s) && s->n_awaited == 0u; }

/* Checks the arguments of a function that reads a structure into `out`. Errors: E_NULL, E_STATE, E_INPUT. */
static inline smr_status smr_readable(const smr *s, uint32_t structure, const void *out)
{
    if (s == NULL || out == NULL)
        return SMR_E_NULL;
    if (!smr_valid(s))
        return SMR_E_STATE;
    return structure < s->shared.n_structures ? SMR_OK : SMR_E_INPUT;
}

/* Copies an array [n][3] of stored vertices plus `shift` to xyz in the caller's order. Errors: as smr_readable(). */
smr_status smr_copy_out(const smr *s, uint32_t structure, float *array, smr_vec shift, float *xyz);

#endif
