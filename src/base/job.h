/* job.h: a call in pieces, smr_job of smr.h. A job is a table of stages, as an iteration is one of steps. A stage is a
 * number of independent tasks, whose results are taken in the order of the tasks. Tasks follow from the call's
 * arguments alone, so threads and limits change no bit.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_BASE_JOB_H
#define SMR_BASE_JOB_H

#include "base/base.h"

/* A stage of tasks of at most about 100,000 instructions each. All functions get the job. */
typedef struct smr_stage {
    smr_count_tasks *n_tasks; /* returns the number of tasks, 0: the stage is skipped; NULL: one task */
    smr_run_task *run;
    smr_count_tasks
        *abreast; /* returns n: task t keeps its result in place t % n until `end`; NULL: as many as tasks */
    void (*end)(void *job, uint32_t first, uint32_t last); /* takes the results of tasks first .. last-1; NULL: none */
} smr_stage;

uint32_t smr_in_order(const void *job); /* returns 1: as `abreast`, tasks run one after the other */

/* The first member of each kind of job. */
typedef struct smr_job_head {
    uint32_t magic;    /* SMR_JOB_MAGIC of a job that has begun */
    smr_status status; /* SMR_PARTIAL while work is left, then the call's result. A task that fails sets an error */
    const smr_stage *stages;
    uint32_t n_stages, stage, next_task; /* number of stages; current stage, and number of its tasks done */
    uint32_t next_stage;                 /* stage after the current one; a task may choose another one */
    uint32_t most_workers;               /* largest number of workers for which the job has memory */
    smr_port port;                       /* threads and clock of steps without a port */
    /* enter 1, before a step: returns 0 when the inputs have changed; 0: after the step. NULL: inputs do not change */
    int (*guard)(void *job, int enter);
} smr_job_head;

#define SMR_JOB_MAGIC 0x736d724au

/* Returns the head of a new job. port NULL, or empty: one worker, no clock. */
smr_job_head smr_job_begin(const smr_stage *stages, uint32_t n_stages, const smr_port *port);

extern const smr_port smr_alone; /* one worker, no clock */

/* Runs the job of a call whole, if `begun`, the status of the call's begin, is OK. Returns the call's status. */
smr_status smr_job_whole(smr_status begun, smr_job *job, const smr_port *port);

/* Runs the current stage once more, or goes on with other stages, when the stage is over. */
static inline void smr_job_again(smr_job_head *h) { h->next_stage = h->stage; }
static inline void smr_job_go(smr_job_head *h, const smr_stage *stages, uint32_t n_stages)
{
    h->stages = stages;
    h->n_stages = n_stages;
    h->next_stage = 0;
}

/* Returns the items of piece `task`, when n items are divided into pieces of `size` items. */
static inline smr_piece smr_piece_of(uint32_t task, uint32_t size, uint32_t n)
{
    return (smr_piece){task * size, smr_min_u32(n, (task + 1u) * size)};
}

#endif
