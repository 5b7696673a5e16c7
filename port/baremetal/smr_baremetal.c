/* smr_baremetal.c: one worker, a plain loop, and a clock that extends the board's 32-bit counter.
 * SPDX-License-Identifier: MIT */
#include "smr_baremetal.h"
#include "smr_clock.h"

static uint64_t smr_baremetal_now(void *ctx)
{
    smr_baremetal *state = ctx;
    const uint32_t count = smr_clock_count();
    state->steps += count - state->last; /* the unsigned difference survives one wrap */
    state->last = count;
    return smr_clock_ns(state->steps);
}

smr_port smr_baremetal_port(smr_baremetal *state)
{
    smr_port port;
    smr_clock_start();
    state->steps = 0;
    state->last = smr_clock_count();
    port.ctx = state;
    port.n_workers = 1u;
    port.parallel = NULL;
    port.now_ns = smr_baremetal_now;
    return port;
}
