/* align_search.h: the coarse search of start poses.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_ALIGN_SEARCH_H
#define SMR_ALIGN_SEARCH_H

#include "start/align/align_coarse.h"
#include "start/align/align_list.h"

#define SMR_SHIFTS 7u      /* translations for each rotation */
#define SMR_SHIFTS_LONG 3u /* translations by the centroid and by the ends of the target's longest axis */

/* Searches the poses of this scale with the first n_shifts translations, of the model or, mirrored not 0, of its
 * mirror image. The list keeps the best poses, at most two with the same rotation. */
void smr_align_search(const smr_aligner *a, const smr_coarse *c, float scale, uint32_t n_shifts, int mirrored,
                      smr_pose_list *found);

#endif
