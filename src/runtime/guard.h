/* guard.h: what guard.c and mend.c share: hinges.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_GUARD_H
#define SMR_GUARD_H

#include "runtime/state.h"

static inline const smr_image_hinge *smr_hinge_at(const smr *s, uint32_t i)
{
    return (const smr_image_hinge *)smr_at(s->model, s->model->at_hinges) + i;
}

static inline uint32_t smr_hinge_second(const smr_image_hinge *h) { return smr_le32(h->bend) & SMR_HINGE_MASK; }

#endif
