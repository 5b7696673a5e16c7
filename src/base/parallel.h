/* parallel.h: the parallel loop over tasks, run by the caller's smr_port. The number of tasks follows from the model,
 * never from the number of workers, so results do not depend on the workers.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_PARALLEL_H
#define SMR_PARALLEL_H

#include "base/base.h"

/* Calls run(arg, t, worker) once for each task t in 0 .. n_tasks-1 and returns when all are done. Without a parallel
 * port, or with one task, the calling thread runs them in order. */
static inline void smr_fork(const smr_port *port, smr_task run, void *arg, uint32_t n_tasks)
{
    if (port->parallel != NULL && n_tasks > 1u) {
        port->parallel(port->ctx, run, arg, n_tasks);
        return;
    }
    for (uint32_t t = 0; t < n_tasks; t++)
        run(arg, t, 0u);
}

#endif
