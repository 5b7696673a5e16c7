/* smr_pthread.h: a pool of persistent POSIX threads behind smr_port.
 *
 * The calling thread is worker 0, so n_workers = 1 starts no thread. Nothing is allocated: the pool lives
 * in the caller's memory. Loops of several threads, or of several tasks of a loop, may meet: one of the tasks' loops
 * gets the workers that have no other task, and all others run in their own thread.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_PTHREAD_H
#define SMR_PTHREAD_H

#include <smr.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct smr_pthread smr_pthread;

/* Bytes smr_pthread_create() needs; 0 when n_workers is not in 1..SMR_WORKERS_MAX. */
size_t smr_pthread_bytes(uint32_t n_workers);

/* Builds the pool in `memory` (SMR_ALIGN-aligned) and starts n_workers - 1 threads.
 * The memory must stay until smr_pthread_destroy().
 * Errors: E_NULL, E_CONFIG (n_workers), E_ALIGN, E_ARENA, E_STATE (the system gave no thread). */
smr_status smr_pthread_create(smr_pthread **pool, void *memory, size_t bytes, uint32_t n_workers);

/* The port to hand to smr_init(). With NULL: one worker, no clock. */
smr_port smr_pthread_port(smr_pthread *pool);

/* Ends and joins the threads. The memory is the caller's again. NULL is allowed. */
void smr_pthread_destroy(smr_pthread *pool);

#ifdef __cplusplus
}
#endif

#endif
