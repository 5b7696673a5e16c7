/* track_verdict.h: how good a frame is.
 * SPDX-License-Identifier: MIT */
#ifndef TRACK_VERDICT_H
#define TRACK_VERDICT_H

#include "model/model_from_files.h"

/* Frames in which each structure was not good, in images. */
typedef struct host_track_doubts {
    uint32_t frames[SMR_STRUCTURES_MAX];
} host_track_doubts;

/* The verdict on the frame that s is at. images: the model where frames are images, otherwise NULL: the verdict on the
 * whole. In an image a structure may lie where nothing holds it while the whole is good, and a frame may end on its
 * way: then it is no better than `look`, and such structures' reasons are added. Returns the status of
 * smr_get_verdict(). */
smr_status host_track_judge(smr *s, const host_model *images, int settled, smr_verdict *verdict,
                            host_track_doubts *doubts);

/* Prints which structures were not good and in how many frames; nothing where there are none. */
void host_track_print_doubts(const host_track_doubts *doubts, const host_model *model);

#endif
