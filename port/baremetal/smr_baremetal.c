/*
 * smr_baremetal: clock from the CMSDK APB timer 0 of the MPS2 boards; one worker, plain loop.
 *
 * For another board change the register addresses and the frequency; for a chip with a cycle counter
 * (DWT CYCCNT, which the emulator does not have) read that instead.
 *
 * SPDX-License-Identifier: MIT
 */
#include "smr_baremetal.h"

#define SMR_BAREMETAL_TIMER 0x40000000u /* CMSDK APB timer 0 */
#define SMR_BAREMETAL_NS_PER_TICK 40u   /* 25 MHz */

/* The timer's registers, in the order of its manual. */
typedef struct smr_baremetal_timer {
    volatile uint32_t ctrl;
    volatile uint32_t value;
    volatile uint32_t reload;
    volatile uint32_t interrupt;
} smr_baremetal_timer;

static smr_baremetal_timer *smr_baremetal_registers(void)
{
    return (smr_baremetal_timer *)SMR_BAREMETAL_TIMER;
}

static uint64_t smr_baremetal_now(void *ctx)
{
    smr_baremetal *state = (smr_baremetal *)ctx;
    uint32_t value = smr_baremetal_registers()->value;
    state->ticks += state->last - value; /* counts down; the unsigned difference survives one wrap */
    state->last = value;
    return state->ticks * SMR_BAREMETAL_NS_PER_TICK;
}

smr_port smr_baremetal_port(smr_baremetal *state)
{
    smr_baremetal_timer *timer = smr_baremetal_registers();
    smr_port port;
    timer->ctrl = 0;
    timer->reload = 0xffffffffu;
    timer->value = 0xffffffffu;
    timer->ctrl = 1u; /* enable, no interrupt */
    state->ticks = 0;
    state->last = timer->value;
    port.ctx = state;
    port.n_workers = 1u;
    port.parallel = NULL;
    port.now_ns = smr_baremetal_now;
    return port;
}
