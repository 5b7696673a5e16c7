/* align_pose.h: arithmetic of rigid, scaled and mirrored poses, and short lists of them.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_ALIGN_POSE_H
#define SMR_ALIGN_POSE_H

#include "geometry/rotation/similarity_fit.h"

/* Sets the pose's translation so that it maps `from` onto `to`. */
static inline void smr_pose_through(smr_pose *p, smr_vec from, smr_vec to)
{
    const smr_vec shift = smr_sub(to, smr_pose_turn(p, from));
    p->m[0][3] = shift.x;
    p->m[1][3] = shift.y;
    p->m[2][3] = shift.z;
}

/* The pose's scale: the length of its first column. */
static inline float smr_pose_scale(const smr_pose *p) { return smr_length(smr_column(p, 0)); }

/* align_pose.c: the inverse of a rigid, scaled or mirrored pose. */
smr_pose smr_pose_invert(const smr_pose *p);

/* The pose after the reflection x -> -x: a mirrored model's pose in the model's own coordinates, and back. */
static inline void smr_pose_reflect(smr_pose *p)
{
    for (int r = 0; r < 3; r++)
        p->m[r][0] = -p->m[r][0];
}

/* Returns 1 when the pose contains a reflection. */
static inline int smr_pose_mirrors(const smr_pose *p)
{
    const smr_vec a = smr_v(p->m[0][0], p->m[0][1], p->m[0][2]), b = smr_v(p->m[1][0], p->m[1][1], p->m[1][2]);
    return smr_dot(smr_cross(a, b), smr_v(p->m[2][0], p->m[2][1], p->m[2][2])) < 0.0f;
}

#define SMR_LIST_MOST 24u

/* A short list of poses, sorted by cost. */
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
