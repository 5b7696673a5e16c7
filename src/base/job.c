/* job.c: runs the stages of a job: all of them, or as far as a number of tasks or a time budget allows.
 * Bounds: one task, on each worker, between two readings of the clock.
 * SPDX-License-Identifier: MIT */
#include "base/job.h"

/* A parallel loop run by the caller's port. Sums of task numbers, one a worker, reveal a task that did not run. */
typedef struct loop {
    smr_task run;
    void *arg;
    uint32_t n_workers, n_tasks;
    uint32_t done[SMR_WORKERS_MAX]; /* sum of 2 task + 1 over the worker's tasks, modulo 2^32 */
} loop;

static void loop_task(void *arg, uint32_t task, uint32_t worker)
{
    loop *l = arg;
    if (worker >= l->n_workers)
        return; /* the port gave a worker number out of range, for which there is no memory */
    if (task < l->n_tasks)
        l->run(l->arg, task, worker);
    l->done[worker] += 2u * task + 1u;
}

int smr_fork(const smr_port *port, smr_task run, void *arg, uint32_t n_tasks)
{
    if (port->parallel != NULL && n_tasks > 1u) {
        loop all = {run, arg, port->n_workers, n_tasks, {0}};
        uint32_t left = n_tasks * n_tasks; /* sum of 2 task + 1 over all tasks, less those done */
        port->parallel(port->ctx, loop_task, &all, n_tasks);
        for (uint32_t w = 0; w < all.n_workers; w++)
            left -= all.done[w];
        return left == 0u;
    }
    for (uint32_t t = 0; t < n_tasks; t++)
        run(arg, t, 0u);
    return 1;
}

/* A parallel loop over tasks from `first` on. */
typedef struct part {
    void *job;
    smr_run_task *run;
    uint32_t first;
} part;

static void run_task(void *arg, uint32_t task, uint32_t worker)
{
    const part *p = arg;
    p->run(p->job, p->first + task, worker);
}

const smr_port smr_alone = {NULL, 1, NULL, NULL};

smr_job_head smr_job_begin(const smr_stage *stages, uint32_t n_stages, const smr_port *port)
{
    return (smr_job_head){.magic = SMR_JOB_MAGIC,
                          .status = SMR_PARTIAL,
                          .stages = stages,
                          .n_stages = n_stages,
                          .most_workers = SMR_WORKERS_MAX,
                          .port = port != NULL && port->n_workers > 0u ? *port : smr_alone};
}

uint32_t smr_in_order(const void *job) { return (void)job, 1u; }

/* Runs at most `most` tasks of the current stage and takes their results. Returns the number of tasks. */
static uint32_t run_some(smr_job_head *h, const smr_port *port, uint32_t most)
{
    const smr_stage *stage = &h->stages[h->stage];
    const uint32_t n = stage->n_tasks != NULL ? stage->n_tasks(h) : 1u, first = h->next_task;
    const uint32_t abreast = smr_max_u32(stage->abreast != NULL ? stage->abreast(h) : n, 1u);
    const uint32_t count = smr_min_u32(smr_min_u32(most, n - first), abreast - first % abreast);
    part p = {h, stage->run, first};
    if (first == 0u)
        h->next_stage = h->stage + 1u;
    if (!smr_fork(port, run_task, &p, count))
        h->status = SMR_E_STATE;
    else if (stage->end != NULL && count > 0u)
        stage->end(h, first, first + count);
    h->next_task += count;
    if (h->next_task < n)
        return count;
    h->next_task = 0;
    h->stage = h->next_stage;
    if (h->stage == h->n_stages && h->status == SMR_PARTIAL)
        h->status = SMR_OK;
    return count;
}

smr_status smr_job_step(smr_job *job, uint32_t units, const smr_port *port, uint64_t budget_ns)
{
    smr_job_head *const h = (smr_job_head *)(void *)job;
    if (job == NULL)
        return SMR_E_NULL;
    if (h->magic != SMR_JOB_MAGIC)
        return SMR_E_STATE;
    if (h->status != SMR_PARTIAL)
        return h->status;
    const smr_port used = port != NULL ? *port : h->port;
    if (used.n_workers < 1u || used.n_workers > h->most_workers)
        return SMR_E_CONFIG;
    const int timed = budget_ns > 0u && used.now_ns != NULL;
    const uint64_t begin = timed ? used.now_ns(used.ctx) : 0u;
    if (h->guard != NULL && !h->guard(h, 1))
        return h->status = h->status == SMR_PARTIAL ? SMR_E_STATE : h->status;
    for (uint32_t left = units > 0u ? units : UINT32_MAX; h->status == SMR_PARTIAL && left > 0u;) {
        left -= run_some(h, &used, timed ? smr_min_u32(left, used.n_workers) : left);
        left += units == 0u ? UINT32_MAX - left : 0u;
        if (timed && used.now_ns(used.ctx) - begin >= budget_ns)
            break;
    }
    if (h->guard != NULL)
        (void)h->guard(h, 0);
    return h->status;
}

smr_status smr_job_whole(smr_status begun, smr_job *job, const smr_port *port)
{
    return begun == SMR_OK ? smr_job_step(job, 0, port, 0) : begun;
}
