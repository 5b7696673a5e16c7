/* rotation_logarithm.h: logarithm and exponential of rigid motions, for averages that stay rigid (Arsigny et al., "A
 * fast and log-Euclidean polyaffine framework for locally linear registration", 2009; the paper's [11]). The logarithm
 * of a motion is a twist: the velocity omega x p + u of each point p, which lasts for a unit of time.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_ROTATION_LOGARITHM_H
#define SMR_ROTATION_LOGARITHM_H

#include "base/vec.h"

#define SMR_HALF_TURN 3.1415927f /* rad: the longest rotation vector */

typedef struct smr_twist {
    smr_vec turn; /* rad: rotation vector omega, no longer than SMR_HALF_TURN */
    smr_vec rate; /* mm: u, the velocity of the origin */
} smr_twist;

/* Returns the rotation vector, rad, of the rotation R, given as R - I, row-major. Angles are 0 .. half a turn. At half
 * a turn both directions of the axis are right; the same R always gives the same one. */
smr_vec smr_rotation_log(const float r_minus_i[9]);

/* Returns the motion that turns by the vector `turn` (rad, no longer than SMR_HALF_TURN) about the point `centre` and
 * then shifts by `shift`, mm. The rate is at most |turn| |centre| + 1.571 |shift|. */
smr_twist smr_twist_about(smr_vec turn, smr_vec centre, smr_vec shift);

/* Returns the displacement of the point p, mm, by the motion, and turns *normal (unit, or 0). A turn longer than
 * SMR_HALF_TURN is shortened to SMR_HALF_TURN. */
smr_vec smr_twist_move(smr_twist twist, smr_vec p, smr_vec *normal);

#endif
