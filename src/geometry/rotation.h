/* rotation.h: rotations out of angular velocities and out of covariance matrices.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_ROTATION_H
#define SMR_ROTATION_H

#include "base/vec.h"

#define SMR_ANGLE_MAX 1.5f /* rad: a longer angular velocity is shortened to this */

/* sin(a) / a and (1 - cos(a)) / a^2 for a^2 within 0 .. SMR_ANGLE_MAX^2. */
void smr_sinc(float a2, float *sine, float *cosine);

/* cos of an angle in degrees, 0..180. */
float smr_cos_degrees(float degrees);

/* R - I of the rotation vector w (Rodrigues' formula), row-major. */
void smr_rodrigues(smr_vec w, float r_minus_i[9]);

/* R - I of the rotation nearest to a (polar decomposition, A = R S), row-major. v: eigenvectors of the last
 * call for this cluster (warm start), a proper rotation; updated. Defined for every finite a: rank 2 and
 * reflected matrices get the proper rotation that keeps the two larger directions; rank 1 the shortest rotation
 * between the two directions; rank 0 no rotation. */
void smr_polar(const float a[9], float v[9], float r_minus_i[9]);

#endif
