/* align_poses.c: whether a given pose is one, and the inverse of a pose.
 * SPDX-License-Identifier: MIT */
#include "start/align/align.h"

#define SMR_POSE_ROUNDING 1.0e-3f  /* largest |R^T R - I| in an entry of the given pose's rotation R */
#define SMR_POSE_SCALE_MAX 1000.0f /* largest scale of the given pose; the smallest is 1 / this */

int smr_pose_legal(const smr_pose *p)
{
    const float scale = smr_pose_scale(p);
    if (!(scale * SMR_POSE_SCALE_MAX >= 1.0f && scale <= SMR_POSE_SCALE_MAX) || smr_pose_mirrors(p))
        return 0;
    for (uint32_t i = 0; i < 3u; i++) {
        if (!smr_within(p->m[i][3], SMR_POSE_SCALE_MAX * SMR_COORD_MAX))
            return 0;
        for (uint32_t k = 0; k <= i; k++)
            if (!smr_within(smr_dot(smr_column(p, i), smr_column(p, k)) / (scale * scale) - (i == k ? 1.0f : 0.0f),
                            SMR_POSE_ROUNDING))
                return 0;
    }
    return 1;
}

/* Returns the inverse of *p. One call in this file only: compilers vectorise two, whose unused lanes trap on 0 / 0. */
smr_pose smr_pose_invert(const smr_pose *p)
{
    const float inverse = 1.0f / smr_dot(smr_column(p, 0), smr_column(p, 0));
    smr_pose q;
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++)
            q.m[r][c] = p->m[c][r] * inverse;
    smr_pose_through(&q, smr_column(p, 3), smr_v(0, 0, 0));
    return q;
}
