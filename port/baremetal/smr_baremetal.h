/* smr_baremetal.h: the port for one core without an operating system, shown on emulated boards.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_BAREMETAL_H
#define SMR_BAREMETAL_H

#include <smr.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The clock's memory: extends the board's 32-bit counter to 64 bits. The caller owns it. */
typedef struct smr_baremetal {
    uint64_t steps; /* of the counter, up to `last` */
    uint32_t last;  /* the counter when it was last read */
} smr_baremetal;

/* Starts the board's counter (smr_clock.h) and returns a port with one worker and this clock. The clock must be read
 * at least once per wrap of the counter (171 s at 25 MHz, 134 s at 32 MHz), which every tick with a budget does, and
 * only from one context at a time: from the interrupt that ticks, or outside of it. *state must stay as long as the
 * port is used. */
smr_port smr_baremetal_port(smr_baremetal *state);

#ifdef __cplusplus
}
#endif

#endif
