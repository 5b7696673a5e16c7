/* attract.h: what forces.c needs of the target-to-model attraction.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_ATTRACT_H
#define SMR_ATTRACT_H

#include "runtime/state.h"

#define SMR_PULL_SCALE 1048576.0f /* 2^20: pulls are summed in micrometres times weight, and finer */
#define SMR_PULL_FULL 0.25f       /* mean areas of target that count in full */

/* 1 when target vertices pull in this iteration. */
int smr_pull_on(const smr *s);

/* The mean pull on a stored vertex, mm; clears it for the next iteration. Returns how much it counts, 0..1: less when
 * little of the target pulls there, so that no target vertex makes a difference by barely reaching a triangle. */
float smr_pull_take(smr *s, uint32_t v, smr_vec *mean);

#endif
