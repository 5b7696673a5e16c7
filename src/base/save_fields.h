/* save_fields.h: the slots of a registration, and which of their values are saved. A stage lists both once, in its
 * layout function: each slot is either scratch, or has a range of legal values. The same lines measure and place
 * (arena.h), and count, save, check and restore. So no slot can be missing from a save by mistake. Saved values are
 * little-endian, without gaps, in the order of the lines.
 * Bounds: one pass over each slot.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_SAVE_FIELDS_H
#define SMR_SAVE_FIELDS_H

#include "base/arena.h"

/* What happens to saved values. In none of these modes is a slot placed. */
enum {
    SMR_KEEP_COUNT = 1, /* count their bytes */
    SMR_KEEP_SAVE,      /* write to `to`, and check */
    SMR_KEEP_CHECK,     /* read from `from` and check; only fields are stored, since slots are not placed yet */
    SMR_KEEP_RESTORE    /* read from `from` and store */
};

struct smr_keeper;

/* Goes over values. Only what saves and restores names these, so a program that does neither has none of it. field
 * NULL: there is nowhere to store them. or_none: SMR_NONE is legal, too. */
typedef struct smr_keep_calls {
    void (*words)(struct smr_keeper *k, uint32_t *field, size_t count, uint32_t most, int or_none);
    void (*floats)(struct smr_keeper *k, float *field, size_t count, float least, float most);
    void (*bytes)(struct smr_keeper *k, uint8_t *field, size_t count, uint32_t most);
    void (*pose)(smr_arena *a, smr_pose *pose, float most);
} smr_keep_calls;

extern const smr_keep_calls smr_keep_all; /* save_field_values.c */

typedef struct smr_keeper {
    const smr_keep_calls *calls;
    void (*fields)(smr_arena *a, smr *s); /* goes over what is kept beside slots */
    uint32_t mode;                        /* mode, SMR_KEEP_... */
    uint32_t wrong;                       /* 1: a value is out of its range, or the bytes ended */
    uint32_t plan;                        /* checksum of the listed values: counts, kinds and ranges */
    unsigned char *to;                    /* [bytes] memory that is written */
    const unsigned char *from;            /* [bytes] memory that is read */
    size_t at, bytes;                     /* bytes processed so far; all bytes */
} smr_keeper;

/* Returns 1 while saved values are processed and no slots are placed. Only then fields of arrays of structs are
 * listed. */
static inline int smr_keeps(const smr_arena *a) { return a->keeper != NULL; }

/* A slot of count elements. now: its present address, which is returned while values are processed. scratch: always
 * written before it is read in an iteration. All other slots are saved: floats: each finite, within +-most. indexes:
 * each below `below`, or SMR_NONE. bytes: each at most `most`. */
void *smr_slot_scratch(smr_arena *a, void *now, size_t count, size_t size);
float *smr_slot_floats(smr_arena *a, float *now, size_t count, float most);
uint32_t *smr_slot_indexes(smr_arena *a, uint32_t *now, size_t count, uint32_t below);
uint8_t *smr_slot_bytes(smr_arena *a, uint8_t *now, size_t count, uint32_t most);

/* Saved fields of a struct; nothing happens while slots are placed. words: at most `most`. floats: least..most. */
void smr_keep_words(smr_arena *a, uint32_t *field, size_t count, uint32_t most);
void smr_keep_floats(smr_arena *a, float *field, size_t count, float least, float most);
void smr_keep_long(smr_arena *a, uint64_t *field);

/* A similarity, with entries of +-most. */
void smr_keep_pose(smr_arena *a, smr_pose *pose, float most);

/* Refuses the save unless `legal` is 1. */
void smr_keep_require(smr_arena *a, int legal);

#endif
