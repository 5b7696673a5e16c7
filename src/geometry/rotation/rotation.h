/* rotation.h: the paper's two ways to a cluster's rotation R_i (2.3): Rodrigues formula and polar decomposition.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_ROTATION_H
#define SMR_ROTATION_H

#include "base/vec.h"

#define SMR_ANGLE_MAX 1.5f /* rad: longer rotation vectors are shortened to this length */

/* Returns the cosine of an angle of 0 .. 180 degrees. */
float smr_cos_degrees(float degrees);

/* Returns w shortened to at most `most` rad; w may be any vector, NaN and infinity included. */
smr_vec smr_turn_within(smr_vec w, float most);

/* Writes R - I, row-major, for the rotation R about w by |w| rad. R - I keeps the digits of small rotations. */
void smr_rodrigues(smr_vec w, float r_minus_i[9]);

/* Writes R - I, row-major, for the rotation R nearest to the matrix A (polar decomposition A = R S).
 * v: in the eigenvectors of A^T A from this cluster's last call (warm start), a proper rotation; out the new ones.
 * For rank 2 and reflections R is the proper rotation that keeps the two larger directions, for rank 1 the shortest
 * rotation between the two directions, for rank 0 the identity. */
void smr_polar(const float a[9], float v[9], float r_minus_i[9]);

#endif
