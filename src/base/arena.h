/* arena.h: divides the caller's memory into aligned slots. One layout function serves twice: with a NULL base the
 * layout function measures the bytes, with a real base it places the slots.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_ARENA_H
#define SMR_ARENA_H

#include "base/base.h"

typedef struct smr_arena {
    unsigned char *base;       /* start of the memory; NULL: slots are measured, not placed */
    size_t capacity;           /* size of the memory at base, bytes */
    size_t used;               /* bytes of all slots so far, gaps included; SIZE_MAX after an overflow of size_t */
    struct smr_keeper *keeper; /* state of a save or restore, during which no slot is placed; NULL: slots are placed */
} smr_arena;

/* Returns an arena that places no slots and only adds up their bytes. */
static inline smr_arena smr_arena_measure(void) { return (smr_arena){NULL, 0, 0, NULL}; }

/* Starts an arena on base, which must be aligned to SMR_ALIGN. Errors: E_NULL, E_ALIGN. */
smr_status smr_arena_start(smr_arena *a, void *base, size_t capacity);

/* Reserves a slot of count * size bytes at the next multiple of SMR_ALIGN and returns its address; NULL when the arena
 * only measures or the slot does not fit. `used` grows. The address sanitiser's build adds a red zone. */
void *smr_arena_take(smr_arena *a, size_t count, size_t size);
/* Unmarks all red zones in `capacity` bytes at base, so that the caller may use the memory for something else. */
void smr_arena_release(void *base, size_t capacity);

#endif
