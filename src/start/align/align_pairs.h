/* align_pairs.h: closest points in both directions under a pose, and measures of them.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_ALIGN_PAIRS_H
#define SMR_ALIGN_PAIRS_H

#include "start/align/align_side.h"

enum { SMR_MODEL, SMR_TARGET, SMR_SIDES };

/* Two surfaces being aligned, in the caller's memory. */
typedef struct smr_aligner {
    smr_align_side side[SMR_SIDES];
    uint32_t *order; /* [samples] bits of the squared distances */
    uint32_t used;   /* samples of each side in the last smr_pairs_find(): the first pairs */
    float far2;      /* squared search limit, mm^2; also the squared distance of samples without a pair */
    float limit;     /* distance beyond which samples do not match when poses are compared, mm */
} smr_aligner;

/* The smaller spread of both sides, mm. */
static inline float smr_aligner_spread(const smr_aligner *a)
{
    return smr_min(a->side[SMR_MODEL].spread, a->side[SMR_TARGET].spread) + 1.0e-6f;
}

/* The cost of a pose from those of its sides: that of the better side plus half of the other. A part lies on the
 * whole, but not the whole on a part; and a pose that matches all of a part is better than one that matches a little
 * more of both. */
static inline float smr_cost_of_sides(float a, float b) { return smr_min(a, b) + 0.5f * smr_max(a, b); }

/* Finds the closest points of `samples` samples of each side. */
void smr_pairs_find(smr_aligner *a, const smr_pose *pose, uint32_t samples);

/* The functions below are about the last pairs found. */

/* Distance beyond which pairs are outliers, mm: from the distances of the side that matches better. */
float smr_pairs_limit(const smr_aligner *a);

/* Share of a side's samples, 0..1, that are nearer than `limit` mm. */
float smr_pairs_share(const smr_aligner *a, uint32_t side, float limit);

/* Cost of the pairs: squared distances over a->limit, at most 1 each; 0 when all samples match, 1.5 when none does. */
float smr_pairs_cost(const smr_aligner *a);

/* Root mean square distance of the nearest share[] of each side's samples, mm. */
float smr_pairs_rms(const smr_aligner *a, const float share[SMR_SIDES]);

#endif
