/* align_refine.h: iterative closest point in both directions.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_ALIGN_REFINE_H
#define SMR_ALIGN_REFINE_H

#include "start/align/align_pairs.h"

/* Bits that select how a refinement fits. */
#define SMR_REFINE_SCALED 1u  /* with a common scale */
#define SMR_REFINE_TRIMMED 2u /* outlier pairs lose their weight */

/* Refines *pose, mirrored or not, in at most `rounds` rounds over `samples` samples of each side. Returns 0 with too
 * few pairs or when the scale collapses; *pose then is the last one. */
int smr_align_refine(smr_aligner *a, uint32_t samples, uint32_t rounds, uint32_t how, smr_pose *pose);

#endif
