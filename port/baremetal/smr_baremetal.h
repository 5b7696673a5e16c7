/*
 * smr_baremetal: the port for one Cortex-M core without an operating system, shown on the MPS2 boards.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SMR_BAREMETAL_H
#define SMR_BAREMETAL_H

#include <smr.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The clock's memory: extends the 32-bit timer to 64 bits. The caller owns it. */
typedef struct smr_baremetal {
    uint64_t ticks;   /* timer ticks up to `last` */
    uint32_t last;    /* the timer's value at the last reading; it counts down */
} smr_baremetal;

/* Starts the board's CMSDK timer 0 and returns a port with one worker and this clock. The clock must be
 * read at least once per wrap of the timer (171 s at 25 MHz), which every tick with a budget does.
 * *state must stay as long as the port is used. */
smr_port smr_baremetal_port(smr_baremetal *state);

#ifdef __cplusplus
}
#endif

#endif /* SMR_BAREMETAL_H */
