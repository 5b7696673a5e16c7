/* verdict_landmark_measures.h: expected errors of a structure that only landmarks determine.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_VERDICT_LANDMARK_MEASURES_H
#define SMR_VERDICT_LANDMARK_MEASURES_H

#include "verdict/verdict_measures.h"

/* Fills smr_vertex_expected(); -1 with too few landmarks. */
void smr_measure_by_landmarks(const smr *s, uint32_t structure, smr_evidence *e);

#endif
