/* smr_clock.h: the board's free-running counter.
 *
 * A board has one file with these functions, about ten lines: smr_clock_*.c are examples, and exactly one is linked. On
 * a chip with a cycle counter, read that (DWT CYCCNT; the emulator has none).
 * SPDX-License-Identifier: MIT */
#ifndef SMR_CLOCK_H
#define SMR_CLOCK_H

#include <stdint.h>

/* Starts the counter. */
void smr_clock_start(void);

/* Its low 32 bits, counting up. */
uint32_t smr_clock_count(void);

/* Nanoseconds in this number of its steps, rounded down. */
uint64_t smr_clock_ns(uint64_t steps);

/* Hz of the core's own clock, which smr_systick.h counts (Cortex-M). */
uint32_t smr_clock_core_hz(void);

#endif
