/* smr_semihost.h: text and exit status from a board to the debugger or emulator.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_SEMIHOST_H
#define SMR_SEMIHOST_H

#include <stddef.h>
#include <stdint.h>

/* Writes a NUL-terminated text to the host's console. */
void smr_semihost_write(const char *text);

/* Reads a file of the host's into to[bytes]; returns how many bytes there were, 0 when there is none. For tests. */
size_t smr_semihost_read_file(const char *name, void *to, size_t bytes);

/* Any of the debugger's operations by its number, with its block of arguments. */
uintptr_t smr_semihost_call(uintptr_t operation, const void *argument);

/* Ends the emulation with this exit status. Does not return. */
void smr_semihost_exit(int status);

#endif
