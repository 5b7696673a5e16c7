/* system.h: aligned memory, signals that stop the program, threads and the clock.
 * SPDX-License-Identifier: MIT */
#ifndef SYSTEM_H
#define SYSTEM_H

#include <signal.h>
#include <stddef.h>
#include "base/error_line.h"
#include "smr_pthread.h"

/* At least one byte at a 64-byte aligned address; NULL when out of memory. Released by free(). */
void *host_alloc(size_t bytes);

/* Like host_alloc, for large arrays with scattered reads, such as voxels. Uses huge pages where the system has them:
 * with pages of 4 KB the address look-ups take as long as the reads. */
void *host_alloc_scattered(size_t bytes);

typedef sigset_t host_stop_set;

/* Lets run handle these signals, except those that are ignored (nohup). */
void host_stop_catch(void (*run)(int number));

/* Blocks these signals in this thread, and in threads that it starts. before: what was blocked, for restoring. */
void host_stop_block(host_stop_set *before);
void host_stop_restore(const host_stop_set *before);

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
