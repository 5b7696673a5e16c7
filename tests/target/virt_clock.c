/* virt_clock.c: the counter of QEMU's board `virt`: 62.5 MHz with an AArch64 core, 10 MHz with a RISC-V one.
 * SPDX-License-Identifier: MIT */
#include "smr_clock.h"

#ifdef __aarch64__
#define VIRT_CLOCK_READ "isb\n\tmrs %0, cntvct_el0"
#define VIRT_CLOCK_NS 16u
#else
#define VIRT_CLOCK_READ "rdtime %0"
#define VIRT_CLOCK_NS 100u
#endif

void smr_clock_start(void) {}

uint32_t smr_clock_count(void)
{
    uintptr_t count;
    __asm__ volatile(VIRT_CLOCK_READ : "=r"(count)::"memory");
    return (uint32_t)count;
}

uint64_t smr_clock_ns(uint64_t steps) { return steps * VIRT_CLOCK_NS; }
