/* smr_port_template.c: compiles, links and is correct, but has no clock and no second worker.
 *
 * docs/PORTING.md has the rules and a test that shows whether your port keeps them.
 * SPDX-License-Identifier: MIT */
#include "smr_port_template.h"

/* Runs run(arg, t, w) once for each t < n_tasks and returns when all have returned.
 *
 * Fill in when you have more than one core:
 *  - hand out the task numbers in any order; a shared counter balances best,
 *  - give every core its own w in 0..n_workers-1: two tasks with one w never run at one time,
 *  - before you return, make the cores' writes visible to the caller (a barrier, cache maintenance where
 *    the cores' caches are not coherent),
 *  - do not allocate, do not fail: this function has no way to report an error. If a core is not
 *    available, run its share here.
 * The result does not depend on the order or on n_workers: the library partitions its work by the model. */
static void smr_template_parallel(void *ctx, smr_task run, void *arg, uint32_t n_tasks)
{
    (void)ctx;
    for (uint32_t task = 0; task < n_tasks; task++)
        run(arg, task, 0);
}

/* Monotonic nanoseconds since any moment.
 *
 * Fill in from a free-running timer. It must never go back, also when the timer wraps: extend a 32-bit
 * count in software as port/baremetal does. It is read between chunks of some tens of microseconds, so a
 * resolution of 1 us is enough. A clock that stands still, as here, is legal: a budget then never ends a
 * tick early. Better leave now_ns NULL in that case, so that the report says 0 instead of a wrong time. */
static uint64_t smr_template_now(void *ctx)
{
    const smr_template *state = ctx;
    return state->last_ns;
}

smr_port smr_template_port(smr_template *state)
{
    smr_port port;
    state->last_ns = 0;
    port.ctx = state;
    port.n_workers = 1u;
    port.parallel = smr_template_parallel;
    port.now_ns = smr_template_now;
    return port;
}
