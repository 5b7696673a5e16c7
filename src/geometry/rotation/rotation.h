/* rotation.h: the paper's two ways to a cluster's rotation R_i (2.3): Rodrigues formula and polar decomposition.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_ROTATION_H
#define SMR_ROTATION_H

#include "base/vec.h"

#define SMR_ANGLE_MAX 1.5f /* rad: longer rotation vectors are shortened to this */

/* The cosine of an angle in degrees, 0 .. 180. */
float smr_cos_degrees(float degrees);

/* A rotation vector of the same direction, no longer than `most` rad; any w, also one that is not finite. */
smr_vec smr_turn_within(smr_vec w, float most);

/* R - I for the rotation about w by |w| rad (Rodrigues formula), row-major. R - I keeps the digits of small
 * rotations. */
void smr_rodrigues(smr_vec w, float r_minus_i[9]);

/* R - I for the rotation R nearest to the matrix A (polar decomposition A = R S), row-major.
 * v: in the eigenvectors of A^T A from this cluster's last call (warm start), a proper rotation; out the new ones.
 * Defined for every finite A: rank 2 and reflections give the proper rotation that keeps the two larger directions,
 * rank 1 the shortest rotation between the two directions, rank 0 the identity. */
void smr_polar(const float a[9], float v[9], float r_minus_i[9]);

#endif
