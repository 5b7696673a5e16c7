/* landmark_goals.h: points of the model whose places are known. In: landmarks as the caller set them, positions. Out:
 * what the smooth field of unseen_field.c must pass by, and how far a hard one prevails around itself.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_LANDMARK_GOALS_H
#define SMR_LANDMARK_GOALS_H

#include "runtime/forces/surface_goal.h"

#define SMR_LANDMARK_NEAR 24u /* vertices that carry a point which does not lie on a surface */
#define SMR_HARD_EDGES 4.0f   /* mean edges: a hard landmark prevails within this distance of its triangle */

/* A landmark and what of the model it is bound to. Written by setup/landmarks.c. */
typedef struct smr_bound_landmark {
    smr_landmark given;
    uint32_t corner[3]; /* stored vertices; with a vertex all the same */
    float share[3];     /* barycentric: of the foot, the point of the surface nearest to the landmark's */
    smr_vec foot;       /* at rest, mm from the model's centre */
    smr_vec apart;      /* from there to the point at rest, mm */
    smr_vec more;       /* hard: what is asked for beyond its place, mm, since clusters do not follow in full */
    uint32_t n_near;    /* 0: the point is the foot */
    uint32_t near[SMR_LANDMARK_NEAR]; /* stored vertices whose motion turns `apart` */
} smr_bound_landmark;

typedef struct smr_landmark_goals {
    const smr_shared *shared;
    const smr_shape *shape;
    smr_bound_landmark *landmark; /* [config.partial.n_landmarks]; NULL: none can be set */
    uint32_t n;                   /* set now */
    float reach;                  /* mm: how far a hard one prevails */
    const smr_pace *pace;
    uint8_t *seen; /* [n vertices] 0 .. SMR_SEEN_ONE: what the target showed when it last was sought */
} smr_landmark_goals;

void smr_landmark_goals_layout(smr_arena *a, smr_landmark_goals *g, const smr_shared *shared);
void smr_landmark_goals_wire(smr_landmark_goals *g, const smr_shared *shared, const smr_pace *pace,
                             const smr_shape *shape);
void smr_landmark_goals_stand(smr_landmark_goals *g); /* the forces under way are complete */
void smr_landmark_goals_reset(smr_landmark_goals *g); /* nothing of the forces so far is left */

/* The foot of landmark k where its vertices are in `xyz`, [n][3]. */
smr_vec smr_landmark_foot(const smr_landmark_goals *g, uint32_t k, float *xyz);

/* From the foot to the point, where the vertices are now. */
smr_vec smr_landmark_apart(const smr_landmark_goals *g, uint32_t k);

/* Where landmark k wants its foot, mm from the shape's origin. What it asks for lies `more` beyond. */
smr_vec smr_landmark_goal(const smr_landmark_goals *g, uint32_t k);

/* 1 at a vertex that landmark k is bound to, falling to 0 at a distance of `reach` at the start. */
float smr_landmark_prevails(const smr_landmark_goals *g, uint32_t k, uint32_t v);

/* Falls from 1 at distance 0 to 0 at 1 and beyond; a covariance in space (Wendland 1995). */
static inline float smr_bump(float distance)
{
    const float left = smr_max(1.0f - distance, 0.0f), left2 = left * left;
    return left2 * left2 * (4.0f * distance + 1.0f);
}

/* 1 at a vertex that a landmark is bound to. */
int smr_landmark_binds(const smr_landmark_goals *g, uint32_t v);

#endif
