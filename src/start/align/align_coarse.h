/* align_coarse.h: samples of both surfaces as plain arrays, and the cost of a pose between them.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_ALIGN_COARSE_H
#define SMR_ALIGN_COARSE_H

#include "start/align/align_pairs.h"

#define SMR_COARSE 96u /* samples of each side; a multiple of SMR_COARSE_LANES */
#define SMR_COARSE_LANES 8u

typedef struct smr_coarse {
    float x[SMR_SIDES][6][SMR_COARSE];   /* positions, mm, and unit normals: three rows each */
    float weight[SMR_SIDES][SMR_COARSE]; /* weights, whose sum is 1 */
    float faced;                         /* 1; 0: the target is a cloud without normals */
    float limit;                         /* mm: samples farther apart do not match */
} smr_coarse;

void smr_coarse_take(smr_coarse *c, const smr_aligner *a);

/* The cost of a pose, as smr_pairs_cost(): 0 when both sides match completely. */
float smr_coarse_cost(const smr_coarse *c, const smr_pose *pose);

/* Sample i of a side; the model's is rotated by the pose, but not translated. */
smr_vec smr_coarse_point(const smr_coarse *c, uint32_t side, uint32_t i, const smr_pose *pose);

#endif
