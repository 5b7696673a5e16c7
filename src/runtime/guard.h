/* guard.h: what guard.c, mend.c and unfold.c share: hinges.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_GUARD_H
#define SMR_GUARD_H

#include "runtime/state.h"

static inline const smr_image_hinge *smr_hinge_at(const smr *s, uint32_t i)
{
    return (const smr_image_hinge *)smr_at(s->model, s->model->at_hinges) + i;
}

static inline uint32_t smr_hinge_second(const smr_image_hinge *h) { return smr_le32(h->bend) & SMR_HINGE_MASK; }

/* A hinge that is open at rest is a fold as soon as its triangles look away from each other; a little earlier, for rounding. */
#define SMR_FOLD_COS 0.001f

static inline int smr_hinge_open(const smr_image_hinge *h) { return smr_hinge_limit(smr_le32(h->bend)) > SMR_HINGE_OPEN; }

#endif
