/* folds.h: what fold_find.c, fold_repair.c, fold_limit.c and fold_open.c share: hinges.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_FOLDS_H
#define SMR_FOLDS_H

#include "runtime/state.h"

static inline const smr_stored_hinge *smr_hinge_at(const smr *s, uint32_t i)
{
    return (const smr_stored_hinge *)smr_at(s->model, s->model->at_hinges) + i;
}

static inline uint32_t smr_hinge_second(const smr_stored_hinge *h) { return smr_le32(h->bend) & SMR_HINGE_MASK; }

/* A hinge that is open at rest is a fold as soon as its triangles look away from each other; a little earlier, for rounding. */
#define SMR_FOLD_COS 0.001f

/* No hinge with a larger cosine folds or is held back (fold_limit.c): limits are 0.02 at most (fold_hinges.c). */
#define SMR_BRAKE_BELOW 0.31f

/* Evening out ends for a vertex, by this share. */
static inline void smr_hold(smr *s, uint32_t v, float share)
{
    if (s->radius == smr_last_radius(s))
        s->held[v] = (uint8_t)smr_max_u32(s->held[v], (uint32_t)(share * SMR_HELD + 0.5f));
}

/* How far the steps of a hinge's corners must become alike, 0 .. 1, when its cosine would be `next`. */
float smr_brake_share(const smr *s, const smr_stored_hinge *h, float next);

/* The cosine between a hinge's normals at x. */
float smr_hinge_cosine(const smr *s, float *x, const smr_stored_hinge *h);

static inline int smr_hinge_open(const smr_stored_hinge *h)
{
    return smr_hinge_limit(smr_le32(h->bend)) > SMR_HINGE_OPEN;
}

#endif
