/* smr_semihost.c: Arm semihosting on a 32-bit Arm, an AArch64 and a RISC-V core.
 * Sources: Arm, "Semihosting for AArch32 and AArch64": SYS_OPEN, SYS_CLOSE, SYS_WRITE0, SYS_READ,
 * SYS_EXIT_EXTENDED; RISC-V International, "RISC-V Semihosting".
 * SPDX-License-Identifier: MIT */
#include "smr_semihost.h"
#include <string.h>

#define SMR_SEMIHOST_OPEN 0x01u
#define SMR_SEMIHOST_CLOSE 0x02u
#define SMR_SEMIHOST_WRITE0 0x04u
#define SMR_SEMIHOST_READ 0x06u
#define SMR_SEMIHOST_EXIT_EXTENDED 0x20u
#define SMR_SEMIHOST_APPLICATION_EXIT 0x20026u

#if defined(__aarch64__)
#define SMR_SEMIHOST_NUMBER "x0"
#define SMR_SEMIHOST_BLOCK "x1"
#define SMR_SEMIHOST_TRAP "hlt 0xf000"
#elif defined(__riscv) /* three instructions of 4 bytes in one page: the debugger looks for all three */
#define SMR_SEMIHOST_NUMBER "a0"
#define SMR_SEMIHOST_BLOCK "a1"
#define SMR_SEMIHOST_TRAP                                                                                              \
    ".option push\n\t.option norvc\n\t.balign 16\n\tslli x0, x0, 0x1f\n\tebreak\n\tsrai x0, x0, 7\n\t.option pop"
#else
#define SMR_SEMIHOST_NUMBER "r0"
#define SMR_SEMIHOST_BLOCK "r1"
#if __ARM_ARCH_PROFILE == 'M'
#define SMR_SEMIHOST_TRAP "bkpt 0xab"
#elif defined(__thumb__)
#define SMR_SEMIHOST_TRAP "svc 0xab"
#else
#define SMR_SEMIHOST_TRAP "svc 0x123456"
#endif
#define SMR_SEMIHOST_CHANGES , "lr" /* by a supervisor call */
#endif

#ifndef SMR_SEMIHOST_CHANGES
#define SMR_SEMIHOST_CHANGES
#endif

uintptr_t smr_semihost_call(uintptr_t operation, const void *argument)
{
    register uintptr_t number __asm__(SMR_SEMIHOST_NUMBER) = operation;
    register const void *block __asm__(SMR_SEMIHOST_BLOCK) = argument;
    __asm__ volatile(SMR_SEMIHOST_TRAP : "+r"(number) : "r"(block) : "memory" SMR_SEMIHOST_CHANGES);
    return number;
}

void smr_semihost_write(const char *text) { (void)smr_semihost_call(SMR_SEMIHOST_WRITE0, text); }

size_t smr_semihost_read_file(const char *name, void *to, size_t bytes)
{
    const uintptr_t open[3] = {(uintptr_t)name, 1u, strlen(name)}; /* mode 1: "rb" */
    const uintptr_t handle = smr_semihost_call(SMR_SEMIHOST_OPEN, open);
    const uintptr_t read[3] = {handle, (uintptr_t)to, bytes};
    if (handle == UINTPTR_MAX)
        return 0;
    const uintptr_t missing = smr_semihost_call(SMR_SEMIHOST_READ, read);
    (void)smr_semihost_call(SMR_SEMIHOST_CLOSE, &handle);
    return missing <= bytes ? bytes - missing : 0u;
}

void smr_semihost_exit(int status)
{
    const uintptr_t block[2] = {SMR_SEMIHOST_APPLICATION_EXIT, (uintptr_t)status};
    (void)smr_semihost_call(SMR_SEMIHOST_EXIT_EXTENDED, block);
    for (;;) {
        /* no debugger is attached */
    }
}
