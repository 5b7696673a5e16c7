/* eigen_jacobi.c: diagonalisation of symmetric 3x3 matrices by cyclic Jacobi iterations (paper 2.3), and
 * pseudo-inverses. Method: Golub, Van Loan, "Matrix Computations", 8.5: each rotation zeroes one off-diagonal pair.
 * From a cold start four sweeps leave off-diagonals below 1e-6 of the largest eigenvalue; from a warm start two do.
 * Bounds: sweeps * 3 rotations, no data-dependent loop.
 * SPDX-License-Identifier: MIT */
#include "geometry/linear_solve/eigen_jacobi.h"

#define SMR_SWEEPS_COLD 6u /* number of Jacobi sweeps of smr_eigen(), which starts from the identity */

/* Zeroes the entry pq by a Jacobi rotation in the plane of p and q. pp, qq: the plane's diagonal entries; pr, qr: the
 * other two off-diagonal entries. vp, vq: first entries of the eigenvector columns p and q. */
static void rotate(float *pp, float *qq, float *pq, float *pr, float *qr, float *vp, float *vq)
{
    const float off = *pq, size = smr_abs(*pp) + smr_abs(*qq);
    if (!(smr_abs(off) > 1.0e-9f * size) || !(smr_abs(off) > 1.0e-30f))
        return;
    const float theta = (*qq - *pp) / (2.0f * off), big = smr_abs(theta);
    const float tangent = big > 1.0e9f ? 0.5f / big : 1.0f / (big + SMR_SQRT(big * big + 1.0f));
    const float t = theta < 0.0f ? -tangent : tangent;
    const float c = 1.0f / SMR_SQRT(t * t + 1.0f), s = t * c;
    *pp -= t * off;
    *qq += t * off;
    *pq = 0.0f;
    float a = *pr, b = *qr;
    *pr = c * a - s * b;
    *qr = s * a + c * b;
    for (int k = 0; k < 9; k += 3) {
        a = vp[k];
        b = vq[k];
        vp[k] = c * a - s * b;
        vq[k] = s * a + c * b;
    }
}

void smr_jacobi(float s[6], float v[9], uint32_t sweeps)
{
    for (uint32_t i = 0; i < sweeps; i++) {
        rotate(&s[SMR_XX], &s[SMR_YY], &s[SMR_XY], &s[SMR_XZ], &s[SMR_YZ], &v[0], &v[1]);
        rotate(&s[SMR_XX], &s[SMR_ZZ], &s[SMR_XZ], &s[SMR_XY], &s[SMR_YZ], &v[0], &v[2]);
        rotate(&s[SMR_YY], &s[SMR_ZZ], &s[SMR_YZ], &s[SMR_XY], &s[SMR_XZ], &v[1], &v[2]);
    }
}

void smr_congruence(const float s[6], const float v[9], float out[6])
{
    const smr_vec c[3] = {smr_axis(v, 0), smr_axis(v, 1), smr_axis(v, 2)};
    const smr_vec sc[3] = {smr_mul_symmetric(s, c[0]), smr_mul_symmetric(s, c[1]), smr_mul_symmetric(s, c[2])};
    smr_products(c, sc, out);
}

void smr_eigen(const float s[6], float value[3], float v[9])
{
    float d[6], e[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    memcpy(d, s, sizeof d);
    smr_jacobi(d, e, SMR_SWEEPS_COLD);
    const float diagonal[3] = {d[SMR_XX], d[SMR_YY], d[SMR_ZZ]};
    int first = 0, last = 0;
    for (int i = 1; i < 3; i++) {
        if (diagonal[i] > diagonal[first])
            first = i;
        if (diagonal[i] <= diagonal[last])
            last = i;
    }
    if (first == last)
        last = (first + 2) % 3;
    const int order[3] = {first, 3 - first - last, last};
    for (int k = 0; k < 3; k++) {
        value[k] = diagonal[order[k]];
        for (int row = 0; row < 3; row++)
            v[3 * row + k] = e[3 * row + order[k]];
    }
    const smr_vec third = smr_cross(smr_axis(v, 0), smr_axis(v, 1)); /* third axis of a proper rotation v */
    v[2] = third.x;
    v[5] = third.y;
    v[8] = third.z;
}

/* Inverts s by cofactors. Returns 0, without an inverse, when an eigenvalue might be below 1e-3 of the mean one. */
static int cofactor_inverse(const float s[6], float out[6])
{
    const float trace = s[SMR_XX] + s[SMR_YY] + s[SMR_ZZ];
    if (!(trace > 1.0e-15f && trace < 1.0e15f))
        return 0;
    float n[6], c[6];
    for (int i = 0; i < 6; i++)
        n[i] = s[i] * (3.0f / trace); /* scales s so that the mean eigenvalue is 1 */
    c[SMR_XX] = n[SMR_YY] * n[SMR_ZZ] - n[SMR_YZ] * n[SMR_YZ];
    c[SMR_XY] = n[SMR_XZ] * n[SMR_YZ] - n[SMR_XY] * n[SMR_ZZ];
    c[SMR_XZ] = n[SMR_XY] * n[SMR_YZ] - n[SMR_XZ] * n[SMR_YY];
    c[SMR_YY] = n[SMR_XX] * n[SMR_ZZ] - n[SMR_XZ] * n[SMR_XZ];
    c[SMR_YZ] = n[SMR_XY] * n[SMR_XZ] - n[SMR_XX] * n[SMR_YZ];
    c[SMR_ZZ] = n[SMR_XX] * n[SMR_YY] - n[SMR_XY] * n[SMR_XY];
    const float det = n[SMR_XX] * c[SMR_XX] + n[SMR_XY] * c[SMR_XY] + n[SMR_XZ] * c[SMR_XZ];
    if (!(det > 2.5e-3f)) /* det is the product of three values with mean 1: the smallest is above det / 2.25 */
        return 0;
    const float k = 3.0f / (trace * det);
    for (int i = 0; i < 6; i++)
        out[i] = c[i] * k;
    return 1;
}

void smr_pseudo_inverse(const float s[6], float floor, float out[6])
{
    float value[3], v[9], w[3];
    if (floor <= 1.0e-3f && cofactor_inverse(s, out))
        return;
    smr_eigen(s, value, v);
    for (int k = 0; k < 3; k++)
        w[k] = value[k] > floor * value[0] && value[k] > 1.0e-20f ? 1.0f / value[k] : 0.0f;
    for (int r = 0, i = 0; r < 9; r += 3)
        for (int c = r; c < 9; c += 3)
            out[i++] = v[r] * w[0] * v[c] + v[r + 1] * w[1] * v[c + 1] + v[r + 2] * w[2] * v[c + 2];
}
