/* align_find.h: from all poses to a few good ones: the stages of the start pose before its last refinement.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_ALIGN_FIND_H
#define SMR_ALIGN_FIND_H

#include "start/align/align_choose.h"
#include "start/align/align_coarse.h"

/* Everything that smr_align() keeps in the caller's memory. */
typedef struct smr_align_work {
    smr_aligner aligner;
    smr_coarse coarse;
    smr_pose_list found, shorter; /* of the stage at work */
    smr_pose_list best;           /* what smr_align_find() found */
    uint32_t few, some, all;      /* samples of short, of longer and of the last refinements */
} smr_align_work;

/* Fills w->best, with a scale whatever the caller wants: bones of two sizes are told apart better so. `given` is one of
 * the poses that are tried. */
void smr_align_find(smr_align_work *w, const smr_pose *given);

/* The best pose of the model's mirror image, near this scale. Needs w->coarse as smr_align_find() left it. */
smr_pose smr_align_find_mirrored(smr_align_work *w, float scale, int scaled);

#endif
