/*
 * smr_semihost: text and exit status from a Cortex-M to the debugger or emulator.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SMR_SEMIHOST_H
#define SMR_SEMIHOST_H

/* Writes a NUL-terminated text to the host's console. */
void smr_semihost_write(const char *text);

/* Ends the emulation with this exit status. Does not return. */
void smr_semihost_exit(int status);

#endif /* SMR_SEMIHOST_H */
