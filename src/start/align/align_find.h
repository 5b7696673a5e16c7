/* align_find.h: reduces all poses to a few good ones: the stages of the start pose before its last refinement.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_ALIGN_FIND_H
#define SMR_ALIGN_FIND_H

#include "start/align/align_choose.h"
#include "start/align/align_coarse.h"

/* State of smr_align() in the caller's memory. */
typedef struct smr_align_work {
    smr_aligner aligner;
    smr_coarse coarse;
    smr_pose_list found, shorter; /* poses of the current stage */
    smr_pose_list best;           /* result of smr_align_find() */
    uint32_t few, some, all;      /* number of samples in short, in longer and in the last refinements */
} smr_align_work;

/* Fills w->best, always with a scale: bones of two sizes are distinguished better so. `given` is one of the tried
 * poses. */
void smr_align_find(smr_align_work *w, const smr_pose *given);

/* The best pose of the model's mirror image near this scale. Needs w->coarse from smr_align_find(). */
smr_pose smr_align_find_mirrored(smr_align_work *w, float scale, int scaled);

#endif
