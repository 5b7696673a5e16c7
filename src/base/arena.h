/* arena.h: memory that the caller hands over, cut into aligned slots.
 * A layout function runs twice over the same code: with a NULL base it measures, with a real one it places.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_ARENA_H
#define SMR_ARENA_H

#include "base/base.h"

typedef struct smr_arena {
    unsigned char *base; /* NULL: measure only */
    size_t capacity;     /* bytes at base */
    size_t used;         /* bytes asked for so far; SIZE_MAX once a size did not fit size_t */
} smr_arena;

/* An arena that only measures. */
smr_arena smr_arena_measure(void);

/* Checks base and starts an arena on it. Errors: E_NULL, E_ALIGN. */
smr_status smr_arena_start(smr_arena *a, void *base, size_t capacity);

/* Takes count * size bytes on the next SMR_ALIGN boundary. Returns NULL when measuring or when it does not
 * fit; `used` counts on in both cases, so that smr_arena_check() sees the shortage. Under the address
 * sanitiser a poisoned red zone follows each slot. */
void *smr_arena_take(smr_arena *a, size_t count, size_t size);

/* SMR_E_ARENA when more was taken than there is. */
smr_status smr_arena_check(const smr_arena *a);

/* Lifts the red zones again, so that the memory can be used for something else. */
void smr_arena_release(void *base, size_t capacity);

#endif
