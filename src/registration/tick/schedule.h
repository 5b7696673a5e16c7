/* schedule.h: what happens between iterations.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_SCHEDULE_H
#define SMR_SCHEDULE_H

#include "registration/registration.h"

void smr_schedule_start(smr *s);                   /* at the first radius, from the present positions */
void smr_schedule_begin(smr *s);                   /* before an iteration: active vertices, search distances, shares */
void smr_schedule_next(smr *s);                    /* after an iteration: x^r = x, the next radius, the end */

#endif
