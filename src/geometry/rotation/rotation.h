/* rotation.h: the paper's two ways to a cluster's rotation R_i (2.3), Rodrigues formula and polar decomposition;
 * logarithm and exponential of rigid motions, for averages that stay rigid (Arsigny et al., "A fast and log-Euclidean
 * polyaffine framework for locally linear registration", 2009; the paper's [11]).
 * SPDX-License-Identifier: MIT */
#ifndef SMR_ROTATION_H
#define SMR_ROTATION_H

#include "base/vec.h"

#define SMR_ANGLE_MAX 1.5f /* rad: largest rotation; longer rotation vectors are shortened */

float smr_cos_degrees(float degrees); /* returns the cosine of an angle of 0 .. 180 degrees */
/* Returns w shortened to at most `most` rad; w may be any vector, NaN and infinity included. */
smr_vec smr_turn_within(smr_vec w, float most);
/* Writes R - I, row-major, for the rotation R about w by |w| rad. R - I keeps the digits of small rotations. */
void smr_rodrigues(smr_vec w, float r_minus_i[9]);

/* Writes R - I, row-major, for the rotation R nearest to the matrix A (polar decomposition A = R S). v: in the
 * eigenvectors of A^T A from this cluster's last call, a proper rotation; out the new ones. For rank 2 and reflections
 * R keeps the two larger directions, for rank 1 R is the shortest rotation from A's row to its column, for rank 0 I. */
void smr_polar(const float a[9], float v[9], float r_minus_i[9]);

#define SMR_HALF_TURN 3.1415927f /* rad: the longest rotation vector */

/* The logarithm of a rigid motion: the velocity omega x p + u of each point p, which lasts for a unit of time. */
typedef struct smr_twist {
    smr_vec turn; /* rad: rotation vector omega, no longer than SMR_HALF_TURN */
    smr_vec rate; /* mm: u, the velocity of the origin */
} smr_twist;

/* Returns the rotation vector, rad, at most half a turn, of R, given as R - I; for a half turn always the same one. */
smr_vec smr_rotation_log(const float r_minus_i[9]);

/* Returns the motion that turns by the vector `turn` (rad, no longer than SMR_HALF_TURN) about the point `centre` and
 * then shifts by `shift`, mm. The rate is at most |turn| |centre| + 1.571 |shift|. */
smr_twist smr_twist_about(smr_vec turn, smr_vec centre, smr_vec shift);
/* Returns the displacement of p, mm, by the motion (turn at most SMR_HALF_TURN). Rotates *normal (unit, or 0), too. */
smr_vec smr_twist_move(smr_twist twist, smr_vec p, smr_vec *normal);

#endif
