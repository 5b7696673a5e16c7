/* align_refine.h: iterative closest point in both directions.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_ALIGN_REFINE_H
#define SMR_ALIGN_REFINE_H

#include "start/align/align_pairs.h"

/* How a refinement fits: bits. */
#define SMR_REFINE_SCALED 1u  /* with one scale */
#define SMR_REFINE_TRIMMED 2u /* pairs that do not belong together lose their weight */

/* Refines *pose, mirrored or not, by at most `rounds` rounds over `samples` samples of each side. Returns 0 when it
 * fails: hardly any pairs, or the scale collapses; *pose is then where it got to. */
int smr_align_refine(smr_aligner *a, uint32_t samples, uint32_t rounds, uint32_t how, smr_pose *pose);

#endif
