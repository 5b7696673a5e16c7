/* golden_save.h: interrupts a golden registration: saves it, restores it in another arena and sets its inputs again.
 * SPDX-License-Identifier: MIT */
#ifndef GOLDEN_SAVE_H
#define GOLDEN_SAVE_H

#include <smr.h>

/* Saves, one after the other. */
typedef struct golden_saves {
    unsigned char *memory;
    size_t bytes, used; /* of memory; of it so far */
    uint32_t given;     /* 1: memory holds another processor's saves: those made here must be equal, and go on */
    uint32_t checksums; /* of the saves without their heads, which hold the library's version, together */
} golden_saves;

/* What a registration has. */
typedef struct golden_inputs {
    const smr_model *model;
    const smr_surface *target; /* of all structures; or NULL */
    const smr_volume *volume;  /* or NULL */
    void *arena;               /* another one */
    size_t arena_bytes;
} golden_inputs;

/* *s is another registration afterwards, with one worker and no clock. */
smr_status golden_interrupt(golden_saves *saves, const golden_inputs *inputs, smr **s);

#endif
