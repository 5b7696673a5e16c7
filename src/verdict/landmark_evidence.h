/* landmark_evidence.h: expected errors of a structure that only landmarks determine.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_LANDMARK_EVIDENCE_H
#define SMR_LANDMARK_EVIDENCE_H

#include "verdict/evidence.h"

/* Fills smr_vertex_expected(); -1 with too few landmarks. */
void smr_measure_by_landmarks(const smr *s, uint32_t structure, smr_evidence *e);

#endif
