/* transform_fit.h: the rigid or scaled pose that lays one set of points onto another.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_TRANSFORM_FIT_H
#define SMR_TRANSFORM_FIT_H

#include "base/vec.h"

enum { SMR_FIT_FROM = 0, SMR_FIT_TO = 3, SMR_FIT_CROSS = 6, SMR_FIT_FROM2 = 15, SMR_FIT_TO2, SMR_FIT_SUMS };

/* Sums over weighted pairs (from, to); add pairs, then solve. What each addition rounds off is summed, too. */
typedef struct smr_fit {
    smr_vec origin_from, origin_to;
    float sum[SMR_FIT_SUMS];  /* w from, w to, w to from^T (row-major), w |from|^2, w |to|^2 */
    float lost[SMR_FIT_SUMS]; /* what rounding took from them */
    float weight;
} smr_fit;

/* Points are taken relative to these, which should lie among them, so that far-away coordinates do not cost digits. */
void smr_fit_start(smr_fit *f, smr_vec origin_from, smr_vec origin_to);
void smr_fit_add(smr_fit *f, smr_vec from, smr_vec to, float weight);

/* The pose minimising sum w |pose(from) - to|^2: rotation by polar decomposition, and a scale when scaled is not 0
 * (ratio of the symmetric kind: sqrt(spread of to / spread of from)). Identity rotation when the pairs leave it open.
 * Source: Horn, Hilden, Negahdaripour 1988. */
smr_pose smr_fit_solve(const smr_fit *f, int scaled);

#endif
