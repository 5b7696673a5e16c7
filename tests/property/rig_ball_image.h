/* rig_ball_image.h: a ball and its computed image.
 * SPDX-License-Identifier: MIT */
#ifndef RIG_BALL_IMAGE_H
#define RIG_BALL_IMAGE_H

#include "property/rig.h"

#define RIG_BALL_SIDE 76u     /* voxels */
#define RIG_BALL_SPACING 1.5f /* mm */
#define RIG_BALL_MM 30.0f     /* mm, its radius */

extern const float rig_nowhere[3]; /* the origin */
extern const float rig_shift[3];   /* 3 mm */

/* The image of a ball: bright inside, dark outside, with an edge some millimetres wide. */
smr_volume rig_ball_image(float radius, const float centre[3]);

/* A model of the ball that was prepared with its own image, or without any. */
const smr_model *rig_ball_model(const smr_volume *reference);

#endif
