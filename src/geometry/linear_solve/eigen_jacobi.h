/* eigen_jacobi.h: eigenvalues, eigenvectors and pseudo-inverses of symmetric 3x3 matrices.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_EIGEN_JACOBI_H
#define SMR_EIGEN_JACOBI_H

#include "base/vec.h"

/* Indexes of the six upper entries of a symmetric matrix s[6]. */
enum { SMR_XX, SMR_XY, SMR_XZ, SMR_YY, SMR_YZ, SMR_ZZ };

/* Adds the symmetric matrix w d d^T to the symmetric matrix s. */
static inline void smr_add_square(float s[6], float w, smr_vec d)
{
    s[SMR_XX] += w * d.x * d.x;
    s[SMR_XY] += w * d.x * d.y;
    s[SMR_XZ] += w * d.x * d.z;
    s[SMR_YY] += w * d.y * d.y;
    s[SMR_YZ] += w * d.y * d.z;
    s[SMR_ZZ] += w * d.z * d.z;
}

/* Returns column k of a row-major 3x3 matrix. */
static inline smr_vec smr_axis(const float m[9], int k) { return smr_v(m[k], m[3 + k], m[6 + k]); }

/* Returns the product of the symmetric matrix s and the vector a. */
static inline smr_vec smr_mul_symmetric(const float s[6], smr_vec a)
{
    const float full[9] = {s[0], s[1], s[2], s[1], s[3], s[4], s[2], s[4], s[5]};
    return smr_mul(full, a);
}

/* Writes A^T B, which must be symmetric, of matrices with the columns a[k] and b[k]. */
static inline void smr_products(const smr_vec a[3], const smr_vec b[3], float out[6])
{
    out[SMR_XX] = smr_dot(a[0], b[0]); /* written out: a loop would add a sixth to a rotation's time */
    out[SMR_XY] = smr_dot(a[0], b[1]);
    out[SMR_XZ] = smr_dot(a[0], b[2]);
    out[SMR_YY] = smr_dot(a[1], b[1]);
    out[SMR_YZ] = smr_dot(a[1], b[2]);
    out[SMR_ZZ] = smr_dot(a[2], b[2]);
}

/* Diagonalises a symmetric matrix A in place by `sweeps` cyclic Jacobi sweeps with a warm start.
 * s: in V^T A V (smr_congruence); out the eigenvalues in s[XX], s[YY], s[ZZ], unsorted.
 * v: in the start V, orthonormal, row-major; out the eigenvectors as columns. */
void smr_jacobi(float s[6], float v[9], uint32_t sweeps);
void smr_congruence(const float s[6], const float v[9], float out[6]); /* writes V^T S V for a symmetric s */
/* Finds the eigenvalues of s, largest first, and the eigenvectors as columns of a proper rotation v. */
void smr_eigen(const float s[6], float value[3], float v[9]);
/* Writes the pseudo-inverse of a positive semidefinite s. Eigenvalues below `floor` times the largest count as 0. */
void smr_pseudo_inverse(const float s[6], float floor, float out[6]);

#endif
