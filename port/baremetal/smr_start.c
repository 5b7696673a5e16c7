/* smr_start.c: from the reset code to main, the same on every core.
 * SPDX-License-Identifier: MIT */
#include "smr_start.h"
#include "smr_semihost.h"

/* From the linker script. */
extern uint32_t smr_data_load[], smr_data_begin[], smr_data_end[], smr_bss_begin[], smr_bss_end[];

int main(void);

void smr_start_run(void)
{
    const uint32_t *from = smr_data_load;
    /* volatile: the loops must stay loops, no call into a library that is not set up yet. */
    for (volatile uint32_t *to = smr_data_begin; to < smr_data_end; to++)
        *to = *from++;
    for (volatile uint32_t *to = smr_bss_begin; to < smr_bss_end; to++)
        *to = 0;
    smr_semihost_exit(main());
}

void smr_start_fault(void)
{
    smr_semihost_write("smr: fault\n");
    smr_semihost_exit(99);
}
