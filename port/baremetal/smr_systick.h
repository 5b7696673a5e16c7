/* smr_systick.h: a periodic interrupt from the core's own timer, the same on every Cortex-M.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_SYSTICK_H
#define SMR_SYSTICK_H

#include <stdint.h>

/* Calls smr_systick_handler() every `steps` of the core's clock, 2..2^24. */
void smr_systick_start(uint32_t steps);
void smr_systick_stop(void);

/* 1 when the next period's interrupt is already pending: at the end of the handler that means it overran. */
int smr_systick_pending(void);

/* Defined by the program; without it an interrupt is a fault. */
void smr_systick_handler(void);

#endif
