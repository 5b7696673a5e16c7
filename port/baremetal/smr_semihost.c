/*
 * smr_semihost: Arm semihosting by `bkpt 0xab`, the M profile's form.
 * Source: Arm, "Semihosting for AArch32 and AArch64": SYS_WRITE0, SYS_EXIT_EXTENDED.
 *
 * SPDX-License-Identifier: MIT
 */
#include "smr_semihost.h"

#include <stdint.h>

#define SMR_SEMIHOST_WRITE0 0x04u
#define SMR_SEMIHOST_EXIT_EXTENDED 0x20u
#define SMR_SEMIHOST_APPLICATION_EXIT 0x20026u

static void smr_semihost_call(uint32_t operation, const void *argument)
{
    register uint32_t r0 __asm__("r0") = operation;
    register const void *r1 __asm__("r1") = argument;
    __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
}

void smr_semihost_write(const char *text)
{
    smr_semihost_call(SMR_SEMIHOST_WRITE0, text);
}

void smr_semihost_exit(int status)
{
    uint32_t block[2] = {SMR_SEMIHOST_APPLICATION_EXIT, (uint32_t)status};
    smr_semihost_call(SMR_SEMIHOST_EXIT_EXTENDED, block);
    for (;;) {
        /* Nobody listens: stay here. */
    }
}
