/* smr_start.h: what the reset code of each kind of core goes on with.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_START_H
#define SMR_START_H

#include <stdint.h>

/* Where the core begins: stack pointer and FPU are set, then smr_start_run() is called. */
void smr_start_reset(void);

/* Fills .data, clears .bss, calls main and ends with its status. */
void smr_start_run(void);

/* Says that there was a fault and ends with 99. */
void smr_start_fault(void);

#endif
