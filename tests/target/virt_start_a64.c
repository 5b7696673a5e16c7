/* virt_start_a64.c: reset code of an AArch64 core at EL1: vectors, FPU, stack. The MMU stays off, so compile with
 * -mstrict-align; a device turns MMU and caches on here.
 * SPDX-License-Identifier: MIT */
#include "smr_start.h"

__asm__(".section .vectors, \"ax\"\n"
        ".global smr_start_reset\n"
        "smr_start_reset:\n"
        "    adr x0, smr_start_vectors\n"
        "    msr vbar_el1, x0\n"
        "    mov x0, #3 << 20\n" /* FPEN: no traps; default FPCR: round to nearest, denormals kept */
        "    msr cpacr_el1, x0\n"
        "    isb\n"
        "    ldr x0, =smr_stack_top\n"
        "    mov sp, x0\n"
        "    b smr_start_run\n"
        "    .balign 2048\n"
        "smr_start_vectors:\n"
        "    .rept 16\n"
        "    b smr_start_fault\n"
        "    .balign 128\n"
        "    .endr\n");
