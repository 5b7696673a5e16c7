/* smr_clock_mps2.c: CMSDK APB timer 0 of the MPS2 boards, 32 bits at 25 MHz, with the Cortex-M33 at 20 MHz.
 * SPDX-License-Identifier: MIT */
#include "smr_clock.h"

#ifdef __ARM_FEATURE_CMSE /* AN505, in secure state */
#define SMR_CLOCK_TIMER 0x50000000u
#define SMR_CLOCK_NS 50u
#else
#define SMR_CLOCK_TIMER 0x40000000u
#define SMR_CLOCK_NS 40u
#endif

/* The timer's registers, in the order of its manual. */
typedef struct smr_clock_timer {
    volatile uint32_t ctrl;
    volatile uint32_t value; /* counts down */
    volatile uint32_t reload;
    volatile uint32_t interrupt;
} smr_clock_timer;

static smr_clock_timer *smr_clock_registers(void) { return (smr_clock_timer *)SMR_CLOCK_TIMER; }

void smr_clock_start(void)
{
    smr_clock_timer *timer = smr_clock_registers();
    timer->ctrl = 0;
    timer->reload = 0xffffffffu;
    timer->value = 0xffffffffu;
    timer->ctrl = 1u; /* enable, no interrupt */
}

uint32_t smr_clock_count(void) { return ~smr_clock_registers()->value; }

uint32_t smr_clock_core_hz(void) { return 1000000000u / SMR_CLOCK_NS; }

uint64_t smr_clock_ns(uint64_t steps) { return steps * SMR_CLOCK_NS; }
