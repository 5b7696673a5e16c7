/* smr_start.c: vector table and reset handler of a Cortex-M with FPU; calls main and ends with its status.
 * SPDX-License-Identifier: MIT */
#include "smr_semihost.h"
#include "smr_systick.h"

#define SMR_START_CPACR 0xE000ED88u /* coprocessor access control */

/* From the linker script. */
extern uint32_t smr_stack_top[], smr_data_load[], smr_data_begin[], smr_data_end[];
extern uint32_t smr_bss_begin[], smr_bss_end[];

int main(void);
void smr_start_reset(void);
void smr_start_fault(void);

typedef void (*smr_start_vector)(void);

/* The first word is the stack's top, so the table is of unions, not of functions. */
typedef union smr_start_entry {
    uint32_t *stack;
    smr_start_vector handler;
} smr_start_entry;

__attribute__((section(".vectors"), used)) static const smr_start_entry SMR_START_VECTORS[16] = {
    {.stack = smr_stack_top},         {.handler = smr_start_reset}, {.handler = smr_start_fault}, /* NMI */
    {.handler = smr_start_fault},                                                                 /* hard fault */
    {.handler = smr_start_fault}, /* memory management */
    {.handler = smr_start_fault}, /* bus */
    {.handler = smr_start_fault}, /* usage */
    {.handler = smr_start_fault},     {.handler = smr_start_fault}, {.handler = smr_start_fault},
    {.handler = smr_start_fault},     {.handler = smr_start_fault},                               /* SVCall */
    {.handler = smr_start_fault},     {.handler = smr_start_fault}, {.handler = smr_start_fault}, /* PendSV */
    {.handler = smr_systick_handler},
};

void smr_start_reset(void)
{
    volatile uint32_t *cpacr = (volatile uint32_t *)SMR_START_CPACR;
    const uint32_t *from = smr_data_load;
    /* The FPU is on before any C that may use it; default FPSCR: round to nearest, denormals kept. */
    *cpacr |= 0xFu << 20;
    __asm__ volatile("dsb\n\tisb" ::: "memory");
    /* volatile: the loops must stay loops, no call into a library that is not set up yet. */
    for (volatile uint32_t *to = smr_data_begin; to < smr_data_end; to++)
        *to = *from++;
    for (volatile uint32_t *to = smr_bss_begin; to < smr_bss_end; to++)
        *to = 0;
    smr_semihost_exit(main());
}

/* A program that starts the timer has a handler of its own. */
__attribute__((weak)) void smr_systick_handler(void) { smr_start_fault(); }

void smr_start_fault(void)
{
    smr_semihost_write("smr: fault\n");
    smr_semihost_exit(99);
}
