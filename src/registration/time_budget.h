/* time_budget.h: fits an iteration into a budget.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_TIME_BUDGET_H
#define SMR_TIME_BUDGET_H

#include "base/keep.h"

#define SMR_STEPS_MAX 44u /* of an iteration */

/* What is known of the time that an iteration takes. */
typedef struct smr_time_budget {
    float rate[SMR_STEPS_MAX]; /* ns a unit of work, by step; negative: not known yet */
    uint64_t spent;            /* ns, in the step under way */
    float sum;                 /* ns, of the iteration under way so far */
    float whole;               /* ns, of iterations in the mean */
    uint64_t budget;           /* ns, of the tick that began the iteration */
    uint32_t count;            /* active vertices when the sums' rates were learnt */
    uint32_t uncut;            /* 1: the iteration under way takes several ticks, and leaves nothing out */
    uint32_t late;             /* 1: it was meant to end in one tick, and has not */
    uint32_t cut;              /* 1: n_active is less than the configuration asks for, for want of time */
    uint32_t repairing;        /* 1: the last iteration was a repair */
    float margin;              /* factor on the reserve */
    uint32_t look;             /* vertices' forces at which it is asked again whether the time is up */
    uint32_t odd;              /* 1: the clock ran backwards in the step under way */
} smr_time_budget;

void smr_budget_start(smr *s);                                       /* nothing is known */
void smr_budget_plan(smr *s, uint64_t budget_ns);                    /* before an iteration */
void smr_budget_resume(smr *s);                                      /* a tick goes on with an iteration */
void smr_budget_done(smr *s);                                        /* an iteration is complete */
int smr_budget_reached(smr *s, uint64_t left_ns, uint32_t group);    /* 1: the time is for the rest of the iteration */
uint32_t smr_budget_group(smr *s, uint32_t n_tasks);                 /* tasks between two readings of the clock */
uint64_t smr_budget_ahead(smr *s, uint32_t n_tasks, uint32_t group); /* ns that so many will take; 0: not known */
void smr_budget_spend(smr *s, uint64_t ns, uint64_t budget_ns);      /* between two readings */
void smr_budget_learn(smr *s, uint32_t n_tasks);                     /* the step under way is complete */

#endif
