/* align_pose.c: the inverse of a pose. In a file of its own: a compiler that sees two calls makes one vector of
 * their divisions, with 0 / 0 in unused lanes, which devices trap.
 * Bounds: constant.
 * SPDX-License-Identifier: MIT */
#include "start/align/align_pose.h"

smr_pose smr_pose_invert(const smr_pose *p)
{
    const float s2 = p->m[0][0] * p->m[0][0] + p->m[1][0] * p->m[1][0] + p->m[2][0] * p->m[2][0];
    const float inverse = 1.0f / s2;
    smr_pose q;
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++)
            q.m[r][c] = p->m[c][r] * inverse;
    smr_pose_through(&q, smr_column(p, 3), smr_v(0, 0, 0));
    return q;
}
