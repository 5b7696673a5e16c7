/* hilbert_curve.h: the space-filling curve along which vertices and triangles are stored.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_HILBERT_CURVE_H
#define SMR_HILBERT_CURVE_H

#include "base/vec.h"

typedef struct smr_box {
    smr_vec lo, hi;
} smr_box;

smr_box smr_box_of(const float *xyz, uint32_t n);

/* Position of p on a Hilbert curve of 10 bits per axis through the cube around box: 0 .. 2^30 - 1. */
uint32_t smr_curve_key(smr_box box, smr_vec p);

/* Sorts item[n] by key[n], stable, both in place. tmp: [2 n] scratch. */
void smr_curve_sort(uint32_t *key, uint32_t *item, uint32_t *tmp, uint32_t n);

#endif
