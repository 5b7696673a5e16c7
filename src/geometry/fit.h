/* fit.h: the similarity that lays one set of points onto another.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_FIT_H
#define SMR_FIT_H

#include "base/vec.h"

/* Sums over weighted pairs (from, to); add pairs, then solve. Points are taken relative to the first pair, so that
 * far-away coordinates do not cost digits. */
typedef struct smr_fit {
    smr_vec origin_from, origin_to;
    smr_vec from, to;  /* weighted sums */
    float cross[9];    /* sum w to from^T, row-major */
    float from2, to2;  /* sums of squares */
    float weight;
} smr_fit;

void smr_fit_start(smr_fit *f);
void smr_fit_add(smr_fit *f, smr_vec from, smr_vec to, float weight);

/* The pose minimising sum w |pose(from) - to|^2: rotation by polar decomposition, and a scale when similarity is not 0
 * (ratio of the symmetric kind: sqrt(spread of to / spread of from)). Identity rotation when the pairs leave it open.
 * Source: Horn, Hilden, Negahdaripour 1988. */
smr_pose smr_fit_solve(const smr_fit *f, int similarity);

#endif
