/* hilbert_curve.h: the space-filling curve along which a model's vertices are numbered, and the sort by it.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_HILBERT_CURVE_H
#define SMR_HILBERT_CURVE_H

#include "base/vec.h"

/* An axis-aligned box, mm. */
typedef struct smr_box {
    smr_vec lo, hi;
} smr_box;

/* The bounding box of n >= 1 points, xyz: [n][3] mm. */
smr_box smr_box_of(const float *xyz, uint32_t n);

/* Position of p on a Hilbert curve of 10 bits per axis through the cube around box: 0 .. 2^30 - 1. */
uint32_t smr_curve_key(smr_box box, smr_vec p);

/* Sorts key[n] ascending and item[n] along with it, stable, in place. tmp: [2 n] scratch. */
void smr_curve_sort(uint32_t *key, uint32_t *item, uint32_t *tmp, uint32_t n);

#endif
