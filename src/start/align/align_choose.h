/* align_choose.h: refines what the coarse search found and chooses among it.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_ALIGN_CHOOSE_H
#define SMR_ALIGN_CHOOSE_H

#include "start/align/align_list.h"
#include "start/align/align_pairs.h"

/* 1 when two poses are clearly different: more than cosine `cosine` of turn, or the share `shift` of the target's
 * spread apart. */
int smr_pose_differs(const smr_aligner *a, const smr_pose *p, const smr_pose *q, float cosine, float shift);

/* Refines the poses of `from` for so many rounds, how: SMR_REFINE_..., and puts them into `into`; those that end alike
 * become one, and those that fail are left out. */
void smr_align_refine_list(smr_aligner *a, const smr_pose_list *from, uint32_t samples, uint32_t rounds, uint32_t how,
                           smr_pose_list *into);

#endif
