/* time_budget.h: fits an iteration into a time budget.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_TIME_BUDGET_H
#define SMR_TIME_BUDGET_H

#include "base/save_fields.h"

#define SMR_STEPS_MAX 44u /* most steps of an iteration */

typedef struct smr_time_budget {
    float rate[SMR_STEPS_MAX]; /* cost of each step, ns a unit of work; negative: unknown */
    uint64_t spent;            /* time spent in the current step, ns */
    float sum;                 /* time spent in the current iteration, ns */
    float whole;               /* mean time of an iteration, ns */
    uint64_t budget;           /* budget of the tick that began the iteration, ns */
    uint32_t count;            /* active vertices when the costs of the sums were learnt */
    uint32_t uncut;            /* 1: the current iteration spans several ticks and leaves no vertex out */
    uint32_t late;             /* 1: the iteration did not end in its tick, as it should have */
    uint32_t cut;              /* 1: n_active was reduced for lack of time */
    uint32_t repairing;        /* 1: the last iteration repaired folds */
    float margin;              /* factor on the reserve */
    uint32_t look;             /* number of searched vertices at which the reserve is checked next */
    uint32_t odd;              /* 1: the clock ran backwards in the current step */
} smr_time_budget;

void smr_budget_start(smr *s);                    /* sets all costs to unknown */
void smr_budget_plan(smr *s, uint64_t budget_ns); /* called before an iteration */
void smr_budget_resume(smr *s);                   /* called when a tick continues an iteration */
void smr_budget_done(smr *s);                     /* called when an iteration is complete */
/* 1: the remaining time is needed for the rest of the iteration */
int smr_budget_reached(smr *s, uint64_t left_ns, uint32_t group);
uint32_t smr_budget_group(smr *s, uint32_t n_tasks); /* number of tasks between two readings of the clock */
uint64_t smr_budget_ahead(smr *s, uint32_t n_tasks, uint32_t group); /* predicted time of these tasks, ns; 0: unknown */
void smr_budget_spend(smr *s, uint64_t ns, uint64_t budget_ns);      /* adds the time between two readings */
void smr_budget_learn(smr *s, uint32_t n_tasks);                     /* called when the current step is complete */

#endif
