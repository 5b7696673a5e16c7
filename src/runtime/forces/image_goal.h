/* image_goal.h: what forces.c needs of the image forces.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_IMAGE_GOAL_H
#define SMR_IMAGE_GOAL_H

#include "runtime/state.h"

enum { SMR_NO_GOAL = 0, SMR_GOAL, SMR_UNSEEN };

/* The way from vertex v to its goal in the image, along its normal and a little to the side: SMR_GOAL, and *way is set.
 * *contrast, *lighter:
 * how the image compares there, as smr.contrast and smr.lighter have it, where it can be compared. SMR_NO_GOAL: the image shows none that is to be believed. SMR_UNSEEN: it cannot tell, for the vertex has no profile, the search leaves the image or
 * meets nothing but one value, or search distances are below a sample. */
int smr_image_goal(const smr *s, uint32_t v, smr_vec *way, uint8_t *contrast, uint8_t *lighter);

/* Asks for the voxels that the goal of v will need. */
void smr_image_ahead(const smr *s, uint32_t v);

#endif
