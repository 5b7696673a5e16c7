/* align_choose.c: shortens and improves lists of poses.
 * SPDX-License-Identifier: MIT */
#include "start/align/align_choose.h"

#include "start/align/align_pose.h"
#include "start/align/align_refine.h"

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

void smr_align_refine_list(smr_aligner *a, const smr_pose_list *from, uint32_t samples, uint32_t rounds, uint32_t how,
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
