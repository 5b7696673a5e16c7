/* unit_save.h: a small registration of two structures and its save, for the tests of saving and restoring.
 * SPDX-License-Identifier: MIT */
#ifndef UNIT_SAVE_H
#define UNIT_SAVE_H

#include "smr.h"

#define UNIT_SAVE_BYTES SMR_SAVE_BYTES(200, 2, 400, 2, SMR_METHOD_POLAR)

/* Two balls beside each other; the second follows an image where it has no surface. */
typedef struct unit_save {
    const smr_model *model;
    smr_mesh ball[2];
    const smr_surface *surface, *copy, *other; /* both balls moved; the same again; another one */
    smr_volume volume, other_volume;
    smr_config config;
    unsigned char saved[UNIT_SAVE_BYTES]; /* after 7 iterations, ball 0 onto `surface`, ball 1 into the image */
    size_t bytes;
    uint32_t what; /* UNIT_SAVE_... */
} unit_save;

/* rig_free_all() frees it. FEW: of 20 vertices each, and few voxels; SURFACES: likewise, and without an image. */
enum { UNIT_SAVE_ALL, UNIT_SAVE_FEW, UNIT_SAVE_SURFACES };
void unit_save_make(unit_save *u, uint32_t what);

/* As it was before it was saved. */
smr *unit_save_begin(const unit_save *u, uint32_t ticks);

/* Restores saved[bytes] with the default port; NULL where *status is not SMR_OK. The inputs are set again if `all`. */
smr *unit_save_restored(const unit_save *u, const unsigned char *saved, size_t bytes, int all, smr_status *status);

/* Where the kept values begin, and the bytes before the closing checksum. */
size_t unit_save_values(const unsigned char *saved, size_t *end);

/* Where a save holds the n bytes at `what`, which it does. */
unsigned char *unit_save_find(unsigned char *saved, const void *what, size_t n);

/* Makes the checksum right again after a change. */
void unit_save_seal(unsigned char *saved, size_t bytes);

#endif
