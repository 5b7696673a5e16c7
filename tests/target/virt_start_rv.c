/* virt_start_rv.c: reset code of a RISC-V core in machine mode: trap vector, FPU, stack.
 * SPDX-License-Identifier: MIT */
#include "smr_start.h"

__asm__(".section .vectors, \"ax\"\n"
        ".global smr_start_reset\n"
        "smr_start_reset:\n"
        "    la t0, smr_start_trap\n"
        "    csrw mtvec, t0\n"
        "    li t0, 1 << 13\n" /* mstatus.FS: on, initial state */
        "    csrs mstatus, t0\n"
        "    csrw fcsr, zero\n" /* round to nearest */
        "    la sp, smr_stack_top\n"
        "    j smr_start_run\n"
        "    .balign 4\n"
        "smr_start_trap:\n"
        "    j smr_start_fault\n");
