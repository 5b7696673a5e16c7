/* parallel.h: the parallel loop that the port lends. The partition into tasks follows the model, never the number
 * of workers, so that results do not depend on it.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_PARALLEL_H
#define SMR_PARALLEL_H

#include "base/base.h"

/* Runs run(arg, t, worker) for t in 0..n_tasks-1 and returns when all are done. */
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
