/* similarity_fit.c: least-squares rigid and scaled transforms between corresponding points.
 * Source: Horn, Hilden, Negahdaripour 1988. The rotation is found by polar decomposition and two Newton steps.
 * SPDX-License-Identifier: MIT */
#include "geometry/rotation/similarity_fit.h"
#include "geometry/linear_solve/eigen_jacobi.h"
#include "geometry/rotation/rotation.h"

#define SMR_FIT_OPEN 1.0e-4f /* curvature below which the rotation about an axis is undetermined / largest curvature */
#define SMR_FIT_NEAR 0.01f   /* rad: longer Newton steps, as in reflections and deficient ranks, are not taken */

void smr_fit_start(smr_fit *f, smr_vec origin_from, smr_vec origin_to)
{
    *f = (smr_fit){.origin_from = origin_from, .origin_to = origin_to};
}

/* Adds each term with compensation (Knuth 1969). Rounding would move the end of a bone by a micrometre. */
void smr_fit_add(smr_fit *f, smr_vec from, smr_vec to, float w)
{
    from = smr_sub(from, f->origin_from);
    to = smr_sub(to, f->origin_to);
    const smr_vec a = smr_scale(to, w);
    float term[SMR_FIT_SUMS];
    smr_store(term + SMR_FIT_FROM, smr_scale(from, w));
    smr_store(term + SMR_FIT_TO, a);
    smr_store(term + SMR_FIT_CROSS, smr_scale(from, a.x));
    smr_store(term + SMR_FIT_CROSS + 3, smr_scale(from, a.y));
    smr_store(term + SMR_FIT_CROSS + 6, smr_scale(from, a.z));
    term[SMR_FIT_FROM2] = w * smr_dot(from, from);
    term[SMR_FIT_TO2] = w * smr_dot(to, to);
    f->weight += w;
    for (uint32_t i = 0; i < SMR_FIT_SUMS; i++) {
        const float before = f->sum[i], sum = before + term[i], added = sum - before;
        f->lost[i] += (before - (sum - added)) + (term[i] - added);
        f->sum[i] = sum;
    }
}

/* Moves r by a Newton step towards the rotation R for which R^T A is symmetric. The polar decomposition squares A,
 * which costs half of the digits of a long bone's rotation about its axis. Undetermined rotations stay as they are. */
static void sharpen(const float a[9], float r[9])
{
    float m[9], turn[9], out[9], c[6], p[6];
    for (uint32_t i = 0; i < 9u; i++) /* m = R^T A */
        m[i] = r[i / 3u] * a[i % 3u] + r[3u + i / 3u] * a[3u + i % 3u] + r[6u + i / 3u] * a[6u + i % 3u];
    c[SMR_XX] = m[4] + m[8];
    c[SMR_YY] = m[8] + m[0];
    c[SMR_ZZ] = m[0] + m[4];
    c[SMR_XY] = -0.5f * (m[1] + m[3]);
    c[SMR_XZ] = -0.5f * (m[2] + m[6]);
    c[SMR_YZ] = -0.5f * (m[5] + m[7]);
    smr_pseudo_inverse(c, SMR_FIT_OPEN, p);
    const smr_vec w = smr_mul_symmetric(p, smr_v(m[7] - m[5], m[2] - m[6], m[3] - m[1]));
    if (!(smr_dot(w, w) < SMR_FIT_NEAR * SMR_FIT_NEAR))
        return;
    smr_rodrigues(w, turn);
    for (uint32_t i = 0; i < 9u; i++) /* out = R + R (turn - I) */
        out[i] = r[i] + (r[i / 3u * 3u] * turn[i % 3u] + r[i / 3u * 3u + 1u] * turn[3u + i % 3u] +
                         r[i / 3u * 3u + 2u] * turn[6u + i % 3u]);
    memcpy(r, out, sizeof out);
}

/* Returns the sum of w a b, with a and b relative to their means. Arguments: indexes of the sums of w a b, w a, w b. */
static float centred(const smr_fit *f, uint32_t product, uint32_t a, uint32_t b)
{
    return f->sum[product] - f->sum[a] / f->weight * f->sum[b] + f->lost[product];
}

/* Returns the sum of w |a - mean of a|^2, mm^2. product: index of the sum of w |a|^2; a: index of the sum of w a.x. */
static float spread(const smr_fit *f, uint32_t product, uint32_t a)
{
    return centred(f, product, a, a) - f->sum[a + 1u] / f->weight * f->sum[a + 1u] -
           f->sum[a + 2u] / f->weight * f->sum[a + 2u];
}

smr_pose smr_fit_solve(const smr_fit *f, int scaled)
{
    float v[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, r[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    float scale = 1.0f;
    smr_vec from = f->origin_from, to = f->origin_to;
    if (f->weight > 0.0f) {
        float cross[9], r_minus_i[9];
        for (uint32_t i = 0; i < 9u; i++)
            cross[i] = centred(f, SMR_FIT_CROSS + i, SMR_FIT_TO + i / 3u, SMR_FIT_FROM + i % 3u);
        smr_polar(cross, v, r_minus_i);
        for (uint32_t i = 0; i < 9u; i++)
            r[i] += r_minus_i[i];
        sharpen(cross, r);
        sharpen(cross, r);
        const float from2 = spread(f, SMR_FIT_FROM2, SMR_FIT_FROM), to2 = spread(f, SMR_FIT_TO2, SMR_FIT_TO);
        if (scaled && from2 > 1.0e-12f && to2 > 1.0e-12f)
            scale = SMR_SQRT(to2 / from2);
        from = smr_add(from, smr_scale(smr_load(f->sum + SMR_FIT_FROM), 1.0f / f->weight));
        to = smr_add(to, smr_scale(smr_load(f->sum + SMR_FIT_TO), 1.0f / f->weight));
    }
    smr_pose pose = {{{0.0f}}};
    for (uint32_t i = 0; i < 9u; i++)
        pose.m[i / 3u][i % 3u] = r[i] * scale;
    smr_pose_onto(&pose, from, to);
    return pose;
}
