/* align_find.c: reduces all poses to a few good ones. Method: coarse searches at scale 1, at a smaller and a larger
 * scale and, where the spreads differ, at their ratio, which is right for whole surfaces; short refinements of the
 * results and of the given pose, longer ones of the best.
 * Bounds: 4 coarse searches, at most 48 refinements of SMR_ROUNDS_SHORT rounds, 4 of SMR_ROUNDS. Mirror image: 1
 * search, 8 refinements of SMR_ROUNDS_SHORT rounds, 1 of SMR_ROUNDS.
 * SPDX-License-Identifier: MIT */
#include "start/align/align_find.h"

#include "start/align/align_pose.h"
#include "start/align/align_refine.h"
#include "start/align/align_search.h"

#define SMR_ROUNDS_SHORT 6u
#define SMR_ROUNDS 16u
#define SMR_FINALISTS 4u
#define SMR_OF_SCALE 8u     /* poses kept from a search at another scale, and from the search for the mirror image */
#define SMR_LARGER 1.136f   /* ratio of the other scales, and its inverse: a part does not determine the scale */
#define SMR_SAME_SIZE 0.03f /* spreads that differ by less than this share need no search of their own */

/* Adds the poses that a search at this scale finds to w->shorter. how: SMR_REFINE_... */
static void try_scale(smr_align_work *w, float scale, uint32_t how)
{
    smr_list_start(&w->found, SMR_OF_SCALE);
    smr_align_search(&w->aligner, &w->coarse, scale, SMR_SHIFTS_LONG, 0, &w->found);
    smr_align_refine_list(&w->aligner, &w->found, w->few, SMR_ROUNDS_SHORT, SMR_REFINE_SCALED | how, &w->shorter);
}

void smr_align_find(smr_align_work *w, const smr_pose *given)
{
    smr_aligner *a = &w->aligner;
    const float ratio = a->side[SMR_TARGET].spread / smr_max(a->side[SMR_MODEL].spread, 1.0e-6f);
    smr_coarse_take(&w->coarse, a);
    smr_list_start(&w->found, SMR_LIST_MOST);
    smr_align_search(a, &w->coarse, 1.0f, SMR_SHIFTS, 0, &w->found);
    smr_list_insert(&w->found, given, 0.0f);
    smr_list_start(&w->shorter, SMR_FINALISTS);
    smr_align_refine_list(a, &w->found, w->few, SMR_ROUNDS_SHORT, SMR_REFINE_TRIMMED, &w->shorter);
    try_scale(w, 1.0f / SMR_LARGER, SMR_REFINE_TRIMMED);
    try_scale(w, SMR_LARGER, SMR_REFINE_TRIMMED);
    if (!smr_within(ratio - 1.0f, SMR_SAME_SIZE) && ratio > 0.2f && ratio < 5.0f)
        try_scale(w, ratio, 0);
    smr_list_start(&w->best, SMR_FINALISTS);
    smr_align_refine_list(a, &w->shorter, w->some, SMR_ROUNDS, SMR_REFINE_SCALED | SMR_REFINE_TRIMMED, &w->best);
}

smr_pose smr_align_find_mirrored(smr_align_work *w, float scale, int scaled)
{
    const uint32_t how = SMR_REFINE_TRIMMED | (scaled ? SMR_REFINE_SCALED : 0u);
    smr_list_start(&w->found, SMR_OF_SCALE);
    smr_align_search(&w->aligner, &w->coarse, scale, SMR_SHIFTS_LONG, 1, &w->found);
    smr_pose pose = w->found.pose[0];
    smr_list_start(&w->shorter, 1);
    smr_align_refine_list(&w->aligner, &w->found, w->few, SMR_ROUNDS_SHORT, how, &w->shorter);
    if (w->shorter.n > 0u)
        pose = w->shorter.pose[0];
    (void)smr_align_refine(&w->aligner, w->some, SMR_ROUNDS, how, &pose);
    return pose;
}
