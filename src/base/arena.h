/* arena.h: divides the caller's memory into aligned slots. One layout function serves twice: with a NULL base the
 * layout function measures the bytes, with a real base it places the slots.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_ARENA_H
#define SMR_ARENA_H

#include "base/base.h"

typedef struct smr_arena {
    unsigned char *base;       /* start of the memory; NULL: slots are measured, not placed */
    size_t capacity;           /* size of the memory at base, bytes */
    size_t used;               /* bytes requested so far; SIZE_MAX after an overflow of size_t */
    struct smr_keeper *keeper; /* state of a save or restore, during which no slot is placed; NULL: slots are placed */
} smr_arena;

/* Returns an arena that only measures. */
static inline smr_arena smr_arena_measure(void) { return (smr_arena){NULL, 0, 0, NULL}; }

/* Starts an arena on base, which must be aligned to SMR_ALIGN. Errors: E_NULL, E_ALIGN. */
smr_status smr_arena_start(smr_arena *a, void *base, size_t capacity);

/* Takes count * size bytes at the next multiple of SMR_ALIGN. Returns NULL when measuring or when the slot does not
 * fit; `used` grows in both cases. Under the address sanitiser a poisoned red zone follows each slot. */
void *smr_arena_take(smr_arena *a, size_t count, size_t size);
/* Removes the red zones, so that the caller can use the memory for something else. */
void smr_arena_release(void *base, size_t capacity);

#endif
