/* smr_start_m.c: vector table and reset handler of a Cortex-M.
 * SPDX-License-Identifier: MIT */
#include "smr_start.h"
#include "smr_systick.h"

#define SMR_START_CPACR 0xE000ED88u /* coprocessor access control */

extern uint32_t smr_stack_top[]; /* from the linker script */

typedef void (*smr_start_vector)(void);

/* The first word is the stack's top, so the table is of unions, not of functions. */
typedef union smr_start_entry {
    uint32_t *stack;
    smr_start_vector handler;
} smr_start_entry;

__attribute__((section(".vectors"), used)) static const smr_start_entry SMR_START_VECTORS[16] = {
    {.stack = smr_stack_top},
    {.handler = smr_start_reset},
    [2 ... 14] = {.handler = smr_start_fault}, /* from NMI to PendSV */
    {.handler = smr_systick_handler},
};

void smr_start_reset(void)
{
#ifdef __ARM_FP /* the FPU is on before any C that may use it; default FPSCR: round to nearest, denormals kept */
    volatile uint32_t *cpacr = (volatile uint32_t *)SMR_START_CPACR;
    *cpacr |= 0xFu << 20;
    __asm__ volatile("dsb\n\tisb" ::: "memory");
#endif
    smr_start_run();
}

/* A program that starts the timer has a handler of its own. */
__attribute__((weak)) void smr_systick_handler(void) { smr_start_fault(); }
