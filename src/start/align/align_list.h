/* align_list.h: a short list of poses, sorted by cost.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_ALIGN_LIST_H
#define SMR_ALIGN_LIST_H

#include "base/vec.h"

#define SMR_LIST_MOST 24u

typedef struct smr_pose_list {
    smr_pose pose[SMR_LIST_MOST];
    float cost[SMR_LIST_MOST];
    uint32_t n, most; /* number of poses; most poses that are kept, at most SMR_LIST_MOST */
} smr_pose_list;

static inline void smr_list_start(smr_pose_list *l, uint32_t most)
{
    l->n = 0;
    l->most = most;
}

/* Inserts a pose in order of cost, behind those of the same cost. A full list loses its last pose. */
static inline void smr_list_insert(smr_pose_list *l, const smr_pose *pose, float cost)
{
    uint32_t at = l->n < l->most ? l->n++ : l->most;
    for (; at > 0u && l->cost[at - 1u] > cost; at--) {
        if (at < l->most) {
            l->cost[at] = l->cost[at - 1u];
            l->pose[at] = l->pose[at - 1u];
        }
    }
    if (at < l->most) {
        l->cost[at] = cost;
        l->pose[at] = *pose;
    }
}

static inline void smr_list_remove(smr_pose_list *l, uint32_t at)
{
    l->n--;
    for (; at < l->n; at++) {
        l->cost[at] = l->cost[at + 1u];
        l->pose[at] = l->pose[at + 1u];
    }
}

#endif
