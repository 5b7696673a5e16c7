/* fit.c: least-squares rigid and similarity transforms between corresponding points.
 * SPDX-License-Identifier: MIT */
#include "geometry/fit.h"

#include "geometry/rotation.h"

void smr_fit_start(smr_fit *f) { memset(f, 0, sizeof *f); }

void smr_fit_add(smr_fit *f, smr_vec from, smr_vec to, float w)
{
    if (f->weight == 0.0f) {
        f->origin_from = from;
        f->origin_to = to;
    }
    from = smr_sub(from, f->origin_from);
    to = smr_sub(to, f->origin_to);
    f->weight += w;
    f->from = smr_add(f->from, smr_scale(from, w));
    f->to = smr_add(f->to, smr_scale(to, w));
    f->from2 += w * smr_dot(from, from);
    f->to2 += w * smr_dot(to, to);
    const float a[3] = {to.x * w, to.y * w, to.z * w}, b[3] = {from.x, from.y, from.z};
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++)
            f->cross[3 * r + c] += a[r] * b[c];
}

smr_pose smr_fit_solve(const smr_fit *f, int similarity)
{
    float v[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, r[9] = {0};
    float scale = 1.0f;
    smr_vec from = smr_v(0, 0, 0), to = from;
    if (f->weight > 0.0f) {
        from = smr_scale(f->from, 1.0f / f->weight);
        to = smr_scale(f->to, 1.0f / f->weight);
        const float a[3] = {to.x * f->weight, to.y * f->weight, to.z * f->weight}, b[3] = {from.x, from.y, from.z};
        float cross[9];
        for (int i = 0; i < 9; i++)
            cross[i] = f->cross[i] - a[i / 3] * b[i % 3];
        smr_polar(cross, v, r);
        const float from2 = f->from2 - f->weight * smr_dot(from, from), to2 = f->to2 - f->weight * smr_dot(to, to);
        if (similarity && from2 > 1.0e-12f && to2 > 1.0e-12f)
            scale = SMR_SQRT(to2 / from2);
    }
    smr_pose pose;
    for (int i = 0; i < 3; i++)
        for (int c = 0; c < 3; c++)
            pose.m[i][c] = (r[3 * i + c] + (i == c ? 1.0f : 0.0f)) * scale;
    from = smr_add(from, f->origin_from);
    to = smr_add(to, f->origin_to);
    pose.m[0][3] = pose.m[1][3] = pose.m[2][3] = 0.0f;
    const smr_vec moved = smr_pose_apply(&pose, from);
    pose.m[0][3] = to.x - moved.x;
    pose.m[1][3] = to.y - moved.y;
    pose.m[2][3] = to.z - moved.z;
    return pose;
}
