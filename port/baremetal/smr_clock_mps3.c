/* smr_clock_mps3.c: the system counter of the SSE-300 subsystem (MPS3 board, AN547): 64 bits at 32 MHz, of which the
 * low half is enough.
 * SPDX-License-Identifier: MIT */
#include "smr_clock.h"

#define SMR_CLOCK_CONTROL 0x58100000u /* CNTCR, secure */
#define SMR_CLOCK_STATUS 0x48101000u  /* CNTCV, low half: may be read without privilege */

void smr_clock_start(void)
{
    volatile uint32_t *control = (volatile uint32_t *)SMR_CLOCK_CONTROL;
    *control |= 1u; /* enable; others may use it already, so it is not set back */
}

uint32_t smr_clock_count(void) { return *(const volatile uint32_t *)SMR_CLOCK_STATUS; }

uint32_t smr_clock_core_hz(void) { return 32000000u; }

uint64_t smr_clock_ns(uint64_t steps) { return steps * 125u / 4u; } /* 31.25 ns */
