/* smr_systick.c: a periodic interrupt from the core's own timer.
 * Source: Arm, "Armv7-M" and "Armv8-M Architecture Reference Manual": SYST_CSR, SYST_RVR, SYST_CVR, ICSR.
 * SPDX-License-Identifier: MIT */
#include "smr_systick.h"

#define SMR_SYSTICK_BASE 0xE000E010u
#define SMR_SYSTICK_ICSR 0xE000ED04u
#define SMR_SYSTICK_PENDING (1u << 26) /* PENDSTSET */
#define SMR_SYSTICK_CLEAR (1u << 25)   /* PENDSTCLR */

typedef struct smr_systick_timer {
    volatile uint32_t control;
    volatile uint32_t reload;
    volatile uint32_t value;
} smr_systick_timer;

static smr_systick_timer *smr_systick_registers(void) { return (smr_systick_timer *)SMR_SYSTICK_BASE; }

void smr_systick_start(uint32_t steps)
{
    smr_systick_timer *timer = smr_systick_registers();
    timer->control = 0;
    timer->reload = steps - 1u;
    timer->value = 0;
    timer->control = 7u; /* the core's clock, interrupt, enable */
}

void smr_systick_stop(void)
{
    smr_systick_registers()->control = 0;
    *(volatile uint32_t *)SMR_SYSTICK_ICSR = SMR_SYSTICK_CLEAR;
}

int smr_systick_pending(void) { return (*(volatile uint32_t *)SMR_SYSTICK_ICSR & SMR_SYSTICK_PENDING) != 0u; }
