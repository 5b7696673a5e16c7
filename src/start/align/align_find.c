/* align_find.c: reduces all poses to a few good ones. Method: coarse searches at scale 1, at a smaller and a larger
 * scale and, where the spreads differ, at their ratio, which is right for whole surfaces; short refinements of the
 * results and of the given pose, longer ones of the best.
 * Bounds: 4 coarse searches, at most 48 refinements of SMR_ROUNDS_SHORT rounds, 4 of SMR_ROUNDS. Mirror image: 1
 * search, 8 refinements of SMR_ROUNDS_SHORT rounds, 1 of SMR_ROUNDS.
 * SPDX-License-Identifier: MIT */
#include "start/align/align.h"

#define SMR_ROUNDS_SHORT 6u
#define SMR_ROUNDS 16u
#define SMR_FINALISTS 4u
#define SMR_OF_SCALE 8u       /* poses kept from a search at another scale, and from the search for the mirror image */
#define SMR_LARGER 1.136f     /* ratio of the other scales, and its inverse: a part does not determine the scale */
#define SMR_SAME_SIZE 0.03f   /* spreads that differ by less than this share need no search of their own */
#define SMR_ALIKE_COS 0.95f   /* poses within this angle (18 degrees) count as one pose, if also */
#define SMR_ALIKE_SHIFT 0.1f  /* within this distance, over the target's spread, */
#define SMR_CHEAPER 0.98f     /* of two similar poses the later one wins only if it costs less than this share */
#define SMR_ALIKE_SCALE 1.04f /* and within this ratio of scales */

/* Distance between two poses, mm: between the images of the model's centre, or between the points that map to the
 * target's centre, whichever is smaller. */
static float shift_between(const smr_aligner *a, const smr_pose *p, const smr_pose *q)
{
    const smr_vec model = a->side[SMR_MODEL].centre, target = a->side[SMR_TARGET].centre;
    const smr_pose p_back = smr_pose_invert(p), q_back = smr_pose_invert(q);
    const float forth = smr_length(smr_sub(smr_pose_apply(p, model), smr_pose_apply(q, model)));
    const float back = smr_length(smr_sub(smr_pose_apply(&p_back, target), smr_pose_apply(&q_back, target)));
    return smr_min(forth, back * smr_pose_scale(p));
}

int smr_pose_differs(const smr_aligner *a, const smr_pose *p, const smr_pose *q, float cosine, float shift)
{
    float trace = 0.0f;
    for (uint32_t i = 0; i < 9u; i++)
        trace += p->m[i / 3u][i % 3u] * q->m[i / 3u][i % 3u];
    trace /= smr_pose_scale(p) * smr_pose_scale(q); /* 1 + 2 cos of the angle between both */
    return trace < 1.0f + 2.0f * cosine || shift_between(a, p, q) > shift * a->side[SMR_TARGET].spread;
}

/* Inserts a pose, or replaces a similar one that costs clearly more, so that rounding does not decide. */
static void insert_or_replace(const smr_aligner *a, const smr_pose *pose, float cost, smr_pose_list *into)
{
    for (uint32_t i = 0; i < into->n; i++) {
        const float ratio = smr_pose_scale(pose) / smr_pose_scale(&into->pose[i]);
        if (ratio > SMR_ALIKE_SCALE || ratio * SMR_ALIKE_SCALE < 1.0f ||
            smr_pose_differs(a, pose, &into->pose[i], SMR_ALIKE_COS, SMR_ALIKE_SHIFT))
            continue;
        if (cost >= SMR_CHEAPER * into->cost[i])
            return;
        smr_list_remove(into, i);
        break;
    }
    smr_list_insert(into, pose, cost);
}

/* Refines the poses of `from` for `rounds` rounds (how: SMR_REFINE_...) into `into`. Poses that become similar are
 * merged, failed ones are left out. */
static void refine_list(smr_aligner *a, const smr_pose_list *from, uint32_t samples, uint32_t rounds, uint32_t how,
                        smr_pose_list *into)
{
    for (uint32_t i = 0; i < from->n; i++) {
        smr_pose pose = from->pose[i];
        if (!smr_align_refine(a, samples, rounds, how, &pose))
            continue;
        smr_pairs_find(a, &pose, samples);
        insert_or_replace(a, &pose, smr_pairs_cost(a), into);
    }
}

/* Adds the poses that a search at this scale finds to w->shorter. how: SMR_REFINE_... */
static void try_scale(smr_align_work *w, float scale, uint32_t how)
{
    smr_list_start(&w->found, SMR_OF_SCALE);
    smr_align_search(&w->aligner, &w->coarse, scale, SMR_SHIFTS_LONG, 0, &w->found);
    refine_list(&w->aligner, &w->found, w->few, SMR_ROUNDS_SHORT, SMR_REFINE_SCALED | how, &w->shorter);
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
    refine_list(a, &w->found, w->few, SMR_ROUNDS_SHORT, SMR_REFINE_TRIMMED, &w->shorter);
    try_scale(w, 1.0f / SMR_LARGER, SMR_REFINE_TRIMMED);
    try_scale(w, SMR_LARGER, SMR_REFINE_TRIMMED);
    if (!smr_within(ratio - 1.0f, SMR_SAME_SIZE) && ratio > 0.2f && ratio < 5.0f)
        try_scale(w, ratio, 0);
    smr_list_start(&w->best, SMR_FINALISTS);
    refine_list(a, &w->shorter, w->some, SMR_ROUNDS, SMR_REFINE_SCALED | SMR_REFINE_TRIMMED, &w->best);
}

smr_pose smr_align_find_mirrored(smr_align_work *w, float scale, int scaled)
{
    const uint32_t how = SMR_REFINE_TRIMMED | (scaled ? SMR_REFINE_SCALED : 0u);
    smr_list_start(&w->found, SMR_OF_SCALE);
    smr_align_search(&w->aligner, &w->coarse, scale, SMR_SHIFTS_LONG, 1, &w->found);
    smr_pose pose = w->found.pose[0];
    smr_list_start(&w->shorter, 1);
    refine_list(&w->aligner, &w->found, w->few, SMR_ROUNDS_SHORT, how, &w->shorter);
    if (w->shorter.n > 0u)
        pose = w->shorter.pose[0];
    (void)smr_align_refine(&w->aligner, w->some, SMR_ROUNDS, how, &pose);
    return pose;
}
