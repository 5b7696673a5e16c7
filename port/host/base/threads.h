/* Threads and the clock for the command line.
 * SPDX-License-Identifier: MIT */
#ifndef THREADS_H
#define THREADS_H

#include "smr_pthread.h"
#include "base/error_line.h"

typedef struct host_port {
    smr_port port;
    smr_pthread *pool; /* owned */
    void *memory;      /* of the pool; owned */
} host_port;

/* Starts the threads; 0 means one for each processor. */
int host_port_open(host_port *port, uint32_t threads, host_error *error);
void host_port_close(host_port *port);

/* run(arg, t, worker) for each t < n_tasks, by the port's workers. */
void host_parallel(const smr_port *port, smr_task run, void *arg, uint32_t n_tasks);

/* Monotonic seconds. */
double host_seconds(void);

#endif
