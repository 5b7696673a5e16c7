/* threads.h: threads and the clock for the command line.
 * SPDX-License-Identifier: MIT */
#ifndef THREADS_H
#define THREADS_H

#include "smr_pthread.h"
#include "base/error_line.h"

typedef struct host_port {
    smr_port port;
    smr_pthread *pool; /* owned */
    void *memory;      /* the pool's; owned */
} host_port;

/* Starts the threads; 0: one per processor. 0, or -1 with the error filled. */
int host_port_open(host_port *port, uint32_t threads, host_error *error);
void host_port_close(host_port *port);

/* Calls run(arg, t, worker) for each t < n_tasks, on the port's workers. */
void host_parallel(const smr_port *port, smr_task run, void *arg, uint32_t n_tasks);

/* Seconds of a monotonic clock. */
double host_seconds(void);

#endif
