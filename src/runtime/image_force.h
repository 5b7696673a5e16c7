/* image_force.h: what force.c needs of the image forces.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_IMAGE_FORCE_H
#define SMR_IMAGE_FORCE_H

#include "runtime/state.h"

/* The way from vertex v to its goal in the image, along its normal. Returns the confidence, 0 for no goal. */
float smr_image_goal(const smr *s, uint32_t v, smr_vec *way);

#endif
