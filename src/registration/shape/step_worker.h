/* step_worker.h: where each worker is in the current step. With a budget a worker stops after a number of instructions,
 * also within a task, and continues there after a reading of the clock.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_STEP_WORKER_H
#define SMR_STEP_WORKER_H

#include "geometry/surface/surface.h"
#include "registration/shape/schedule_state.h"

typedef struct smr_worker {
    smr_pause pause; /* limit of the worker's work; a search that stopped there */
    uint32_t next;   /* the worker's next task, or the one that is not complete */
    uint32_t end;    /* task behind the last one of the worker's share */
    uint32_t done;   /* work done before the worker last stopped, instructions at most */
    uint32_t at;     /* number of complete items of that task */
    uint32_t index;  /* cluster sums: number of the block's indexes before entry `at` */
    uint32_t within; /* cluster sums: number of indexes of entry `at` that its sum contains */
    union {
        struct {
            uint32_t at, found, n; /* next search; structure with the closest point; number of searches */
            smr_hit hit;           /* that point */
            smr_near_list near;    /* places nearly as near on the same structure */
        } pull;
        struct {
            uint32_t body, leaves;  /* next body; 1: `side` is known, and the exit is searched for */
            uint32_t inside;        /* 1: some body so far contains the point */
            float nearest, deepest; /* mm: least distance and largest depth so far */
            smr_side side;
        } contact;
    } task;
} smr_worker;

#define SMR_WORK_MOST 76000u /* least work between two readings of the clock: about a millisecond of a Cortex-M7 */

/* Takes all tasks from a worker. */
static inline void smr_worker_start(smr_worker *w)
{
    w->next = w->end = 0;
    w->at = w->index = w->within = w->pause.kept = w->pause.in_search = 0;
    w->pause.left = SMR_ENDLESS;
}

/* Sets the work that an item takes, its search on a surface left out. More than that share would not let it begin. */
static inline void smr_worker_needs(smr_worker *w, uint32_t work)
{
    w->pause.after = smr_min_u32(work, SMR_WORK_MOST / 4u * 3u);
}

/* Stores that a worker has stopped before or in item `at` of its task. Returns 1. */
static inline int smr_worker_stop(smr_worker *w, uint32_t at)
{
    w->pause.kept = 1;
    w->at = at;
    return 1;
}

/* Returns 1 when a worker must stop before item `at`. */
static inline int smr_worker_stops(smr_worker *w, uint32_t at)
{
    return w->pause.left < w->pause.after && smr_worker_stop(w, at);
}

/* Counts the work of item `at`. Returns 1 when a search stopped in the item. */
static inline int smr_worker_kept(smr_worker *w, uint32_t at, uint32_t work)
{
    if (w->pause.left == SMR_ENDLESS)
        return 0;
    smr_work(&w->pause, work);
    return w->pause.kept && smr_worker_stop(w, at);
}

#endif
