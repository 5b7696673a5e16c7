/* schedule.h: what happens between iterations.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_SCHEDULE_H
#define SMR_SCHEDULE_H

#include "registration/registration.h"

void smr_schedule_start(smr *s);                   /* at the first radius, from the present positions */
void smr_schedule_begin(smr *s);                   /* before an iteration: active vertices, search distances, shares */
void smr_schedule_next(smr *s);                    /* after an iteration: x^r = x, the next radius, the end */
void smr_schedule_keep(smr_arena *a, smr *s);      /* where the schedule stands */
void smr_report_keep(smr_arena *a, smr_tick_report *r, uint32_t n); /* what pace does not tell; tick.c */

#endif
