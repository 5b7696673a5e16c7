/* similarity_fit.h: the rigid or scaled pose that maps points onto corresponding points with the least squared error.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_SIMILARITY_FIT_H
#define SMR_SIMILARITY_FIT_H

#include "base/vec.h"

/* Returns the vector a rotated by the inverse of the pose's rotation, and scaled by the pose. */
static inline smr_vec smr_pose_turn_back(const smr_pose *p, smr_vec a)
{
    return smr_v(p->m[0][0] * a.x + p->m[1][0] * a.y + p->m[2][0] * a.z,
                 p->m[0][1] * a.x + p->m[1][1] * a.y + p->m[2][1] * a.z,
                 p->m[0][2] * a.x + p->m[1][2] * a.y + p->m[2][2] * a.z);
}

/* Sets the translation of the pose *p, 0 so far, so that the pose maps the point `from` onto the point `to`, mm. */
static inline void smr_pose_onto(smr_pose *p, smr_vec from, smr_vec to)
{
    const smr_vec shift = smr_sub(to, smr_pose_apply(p, from));
    p->m[0][3] = shift.x;
    p->m[1][3] = shift.y;
    p->m[2][3] = shift.z;
}

/* Index of the first entry of each kind of sum in smr_fit.sum[]; SMR_FIT_SUMS is the number of entries. */
enum { SMR_FIT_FROM = 0, SMR_FIT_TO = 3, SMR_FIT_CROSS = 6, SMR_FIT_FROM2 = 15, SMR_FIT_TO2, SMR_FIT_SUMS };

/* Sums over pairs of points (from, to) with weights w; points are relative to the origins. */
typedef struct smr_fit {
    smr_vec origin_from, origin_to; /* mm: origins of the points `from` and `to` */
    float sum[SMR_FIT_SUMS];        /* sums of w from, w to, w to from^T (row-major), w |from|^2, w |to|^2 */
    float lost[SMR_FIT_SUMS];       /* rounding error of each entry of sum[], to be added */
    float weight;                   /* sum of the weights w of all pairs */
} smr_fit;

/* Sets the origins, mm, and clears the sums. Origins near the points keep the digits of coordinates far from 0. */
void smr_fit_start(smr_fit *f, smr_vec origin_from, smr_vec origin_to);
/* Adds the terms of one pair of points, mm, with weight w > 0 to the sums of f. */
void smr_fit_add(smr_fit *f, smr_vec from, smr_vec to, float w);

/* Returns the pose that minimises sum w |pose(from) - to|^2; scaled not 0: with the scale sqrt(variance of to /
 * variance of from). A rotation that the pairs do not determine is the identity. */
smr_pose smr_fit_solve(const smr_fit *f, int scaled);

#endif
