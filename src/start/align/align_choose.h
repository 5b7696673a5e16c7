/* align_choose.h: refines the poses of the coarse search and selects among them.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_ALIGN_CHOOSE_H
#define SMR_ALIGN_CHOOSE_H

#include "start/align/align_list.h"
#include "start/align/align_pairs.h"

/* Returns 1 when two poses differ by more than cosine `cosine` of rotation, or by more than `shift` of the target's
 * spread. */
int smr_pose_differs(const smr_aligner *a, const smr_pose *p, const smr_pose *q, float cosine, float shift);

/* Refines the poses of `from` for `rounds` rounds (how: SMR_REFINE_...) into `into`. Poses that become similar are
 * merged, failed ones are left out. */
void smr_align_refine_list(smr_aligner *a, const smr_pose_list *from, uint32_t samples, uint32_t rounds, uint32_t how,
                           smr_pose_list *into);

#endif
