/* coarse_to_fine_schedule.h: what happens between iterations.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_COARSE_TO_FINE_SCHEDULE_H
#define SMR_COARSE_TO_FINE_SCHEDULE_H

#include "registration/registration.h"

void smr_schedule_start(smr *s); /* starts at the first radius, from the present positions */
void smr_schedule_begin(smr *s); /* called before an iteration: active vertices, search distances, shares */
void smr_schedule_next(smr *s);  /* called after an iteration: plasticity, the next radius, or the end */

#endif
