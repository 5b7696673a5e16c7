/* jacobi.h: eigenvectors of symmetric 3x3 matrices.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_JACOBI_H
#define SMR_JACOBI_H

#include "base/vec.h"

/* A symmetric matrix as its six upper entries, in the order xx xy xz yy yz zz. */
enum { SMR_XX, SMR_XY, SMR_XZ, SMR_YY, SMR_YZ, SMR_ZZ };

/* Diagonalises s in place by `sweeps` cyclic Jacobi sweeps, starting from the orthonormal v (row-major, columns
 * are eigenvectors; warm start) and leaving the eigenvectors there. s: [6], already V^T A V for that start.
 * Returns with the eigenvalues in s[XX], s[YY], s[ZZ], unsorted. */
void smr_jacobi(float s[6], float v[9], uint32_t sweeps);

/* V^T S V for symmetric s. */
void smr_congruence(const float s[6], const float v[9], float out[6]);

/* Eigenvalues, largest first, and their eigenvectors as columns of a proper rotation v. From scratch. */
void smr_eigen(const float s[6], float value[3], float v[9]);

/* The pseudo-inverse of a positive semidefinite s: directions with an eigenvalue below `floor` times the
 * largest one are left out (their inverse is 0), so a degenerate s has a defined answer. */
void smr_pseudo_inverse(const float s[6], float floor, float out[6]);

#endif
