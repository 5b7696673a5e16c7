/* smr_semihost.c: Arm semihosting by `bkpt 0xab`, the M profile's form.
 * Source: Arm, "Semihosting for AArch32 and AArch64": SYS_OPEN, SYS_CLOSE, SYS_WRITE0, SYS_READ, SYS_GET_CMDLINE,
 * SYS_EXIT_EXTENDED.
 * SPDX-License-Identifier: MIT */
#include "smr_semihost.h"
#include <stdint.h>

#define SMR_SEMIHOST_OPEN 0x01u
#define SMR_SEMIHOST_CLOSE 0x02u
#define SMR_SEMIHOST_WRITE0 0x04u
#define SMR_SEMIHOST_READ 0x06u
#define SMR_SEMIHOST_GET_CMDLINE 0x15u
#define SMR_SEMIHOST_EXIT_EXTENDED 0x20u
#define SMR_SEMIHOST_APPLICATION_EXIT 0x20026u

static uint32_t smr_semihost_call(uint32_t operation, const void *argument)
{
    register uint32_t r0 __asm__("r0") = operation;
    register const void *r1 __asm__("r1") = argument;
    __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
    return r0;
}

void smr_semihost_write(const char *text) { (void)smr_semihost_call(SMR_SEMIHOST_WRITE0, text); }

size_t smr_semihost_read_file(const char *name, void *to, size_t bytes)
{
    uint32_t length = 0;
    while (name[length] != '\0')
        length++;
    const uint32_t open[3] = {(uint32_t)(uintptr_t)name, 1u, length}; /* mode 1: "rb" */
    const uint32_t handle = smr_semihost_call(SMR_SEMIHOST_OPEN, open);
    const uint32_t read[3] = {handle, (uint32_t)(uintptr_t)to, (uint32_t)bytes};
    if (handle == UINT32_MAX)
        return 0;
    const uint32_t missing = smr_semihost_call(SMR_SEMIHOST_READ, read);
    (void)smr_semihost_call(SMR_SEMIHOST_CLOSE, &handle);
    return missing <= bytes ? bytes - missing : 0u;
}

void smr_semihost_words(char *buffer, int size)
{
    const uint32_t block[2] = {(uint32_t)buffer, (uint32_t)size};
    int from = 0, to = 0;
    buffer[0] = '\0';
    if (smr_semihost_call(SMR_SEMIHOST_GET_CMDLINE, block) != 0u)
        buffer[0] = '\0';
    while (buffer[from] != '\0' && buffer[from] != ' ')
        from++; /* the program's name */
    while (buffer[from] == ' ')
        from++;
    do {
        buffer[to] = buffer[from++];
    } while (buffer[to++] != '\0');
}

void smr_semihost_exit(int status)
{
    uint32_t block[2] = {SMR_SEMIHOST_APPLICATION_EXIT, (uint32_t)status};
    (void)smr_semihost_call(SMR_SEMIHOST_EXIT_EXTENDED, block);
    for (;;) {
        /* no debugger is attached */
    }
}
