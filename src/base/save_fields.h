/* save_fields.h: the slots of a registration, and which of their values are saved. A stage lists its slots once, in its
 * layout function: a slot is either scratch or has a range of legal values. The same lines measure and place slots
 * (arena.h), and count, save, check and restore values. Saved values are little-endian, without gaps, in layout order.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_SAVE_FIELDS_H
#define SMR_SAVE_FIELDS_H

#include "base/arena.h"

/* Modes of a keeper. No slot is placed in any mode. */
enum {
    SMR_KEEP_COUNT = 1, /* count the bytes of all values */
    SMR_KEEP_SAVE,      /* check each value and write it to `to` */
    SMR_KEEP_CHECK,     /* read each value from `from` and check it; store values of struct fields, not of slots */
    SMR_KEEP_RESTORE    /* read each value from `from`, check it and store it */
};

struct smr_keeper;

/* Functions that write, check or read arrays of saved values. Only save and restore name smr_keep_all, so a program
 * that does neither links none of these functions. field NULL: no value is stored. or_none 1: SMR_NONE is legal. */
typedef struct smr_keep_calls {
    void (*words)(struct smr_keeper *k, uint32_t *field, size_t count, uint32_t most, int or_none);
    void (*floats)(struct smr_keeper *k, float *field, size_t count, float least, float most);
    void (*bytes)(struct smr_keeper *k, uint8_t *field, size_t count, uint32_t most);
    void (*pose)(smr_arena *a, smr_pose *pose, float most);
} smr_keep_calls;

extern const smr_keep_calls smr_keep_all;

typedef struct smr_keeper {
    const smr_keep_calls *calls;
    void (*fields)(smr_arena *a, smr *s); /* passes all saved struct fields to smr_keep_...() */
    uint32_t mode;                        /* SMR_KEEP_...: whether values are counted, saved, checked or restored */
    uint32_t wrong;            /* 1: a value was outside the legal range, or the saved bytes ended too early */
    uint32_t plan;             /* checksum of the counts, kinds and ranges of the values listed so far */
    unsigned char *to;         /* [bytes] memory that a save writes */
    const unsigned char *from; /* [bytes] memory that a check or restore reads */
    size_t at, bytes;          /* number of bytes processed so far; size of `to` or `from`, bytes */
    size_t first, last; /* bytes of this pass: values of slots elsewhere are left out, but not fields of structs */
    uint32_t slot;      /* 1: the values belong to a slot */
} smr_keeper;

/* Returns 1 while the arena counts, saves, checks or restores values instead of placing slots. */
static inline int smr_keeps(const smr_arena *a) { return a->keeper != NULL; }

/* Place a slot of count elements and return its address; in a save or restore process the values of the slot at `now`
 * and return `now`. Scratch is not saved. Legal: floats within +-most; indexes < below, or SMR_NONE; bytes <= most. */
void *smr_slot_scratch(smr_arena *a, void *now, size_t count, size_t size);
float *smr_slot_floats(smr_arena *a, float *now, size_t count, float most);
uint32_t *smr_slot_indexes(smr_arena *a, uint32_t *now, size_t count, uint32_t below);
uint8_t *smr_slot_bytes(smr_arena *a, uint8_t *now, size_t count, uint32_t most);
/* Save or restore fields of a struct; do nothing while slots are placed. Legal: words <= most, floats least .. most. */
void smr_keep_words(smr_arena *a, uint32_t *field, size_t count, uint32_t most);
void smr_keep_floats(smr_arena *a, float *field, size_t count, float least, float most);
void smr_keep_long(smr_arena *a, uint64_t *field);
void smr_keep_pose(smr_arena *a, smr_pose *pose, float most); /* saves a pose; legal: a similarity within +-most */
void smr_keep_require(smr_arena *a, int legal);               /* marks the save as wrong unless `legal` is 1 */

#endif
