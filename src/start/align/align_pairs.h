/* align_pairs.h: closest points in both directions under a pose, and what they say about it.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_ALIGN_PAIRS_H
#define SMR_ALIGN_PAIRS_H

#include "start/align/align_side.h"

enum { SMR_MODEL, SMR_TARGET, SMR_SIDES };

/* Two surfaces being aligned, in the caller's memory. */
typedef struct smr_aligner {
    smr_align_side side[SMR_SIDES];
    uint32_t *order; /* [samples] bits of squared distances */
    uint32_t used;   /* samples of each side that the last smr_pairs_find() used: the first so many pairs */
    float far2;      /* mm^2: search limit, and the squared distance of samples without a pair */
    float limit;     /* mm: what is farther is not explained, when poses are compared */
} smr_aligner;

/* The smaller spread of both sides, mm. */
static inline float smr_aligner_spread(const smr_aligner *a)
{
    return smr_min(a->side[SMR_MODEL].spread, a->side[SMR_TARGET].spread) + 1.0e-6f;
}

/* The cost of a pose from those of its two sides: that of the side that is explained better, and half of the other. A
 * part is explained by the whole, the whole not by a part; and a pose that explains all of a part is better than one
 * that explains a little more of both. */
static inline float smr_cost_of_sides(float a, float b) { return smr_min(a, b) + 0.5f * smr_max(a, b); }

/* Finds the closest point for `samples` samples of each side. */
void smr_pairs_find(smr_aligner *a, const smr_pose *pose, uint32_t samples);

/* What follows is about the last pairs found. */

/* Distance beyond which pairs do not belong together, mm: from the distances themselves, those of the side that fits
 * better. */
float smr_pairs_limit(const smr_aligner *a);

/* Share of a side's samples, 0..1, that are nearer than `limit` mm. */
float smr_pairs_share(const smr_aligner *a, uint32_t side, float limit);

/* 0 when all is explained, 1.5 when nothing is: distances over a->limit, squared, at most 1 each. */
float smr_pairs_cost(const smr_aligner *a);

/* Root mean square distance of the nearest share[] of each side's samples, mm. */
float smr_pairs_rms(const smr_aligner *a, const float share[SMR_SIDES]);

#endif
