/* align_coarse.h: a few samples of both surfaces as plain arrays, and what a pose costs among them.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_ALIGN_COARSE_H
#define SMR_ALIGN_COARSE_H

#include "start/align/align_pairs.h"

#define SMR_COARSE 96u /* samples of each side; a multiple of SMR_COARSE_LANES */
#define SMR_COARSE_LANES 8u

typedef struct smr_coarse {
    float x[SMR_SIDES][6][SMR_COARSE];   /* positions, mm, and unit normals: three rows each */
    float weight[SMR_SIDES][SMR_COARSE]; /* adds up to 1 */
    float faced;                         /* 1; 0: the target is a cloud without normals */
    float limit;                         /* mm: what is farther is not explained */
} smr_coarse;

void smr_coarse_take(smr_coarse *c, const smr_aligner *a);

/* What a pose costs, as smr_pairs_cost(): 0 when it explains both sides. */
float smr_coarse_cost(const smr_coarse *c, const smr_pose *pose);

/* Sample i of a side; the model's as the pose turns it, without its translation. */
smr_vec smr_coarse_point(const smr_coarse *c, uint32_t side, uint32_t i, const smr_pose *pose);

#endif
