/* schedule.h: what happens between iterations.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_SCHEDULE_H
#define SMR_SCHEDULE_H

#include "registration/registration.h"

void smr_schedule_start(smr *s);                   /* at the first radius, from the present positions */
void smr_schedule_begin(smr *s);                   /* before an iteration: active vertices, search distances, shares */
int smr_schedule_plastic(const smr *s);            /* 1: the iteration about to stand ends with x^r = x */
void smr_schedule_radius(smr *s, uint32_t radius); /* goes on at this radius */
void smr_schedule_next(smr *s);                    /* after an iteration: x^r = x, the next radius, the end */
void smr_schedule_keep(smr_arena *a, smr *s);      /* where the schedule stands */
void smr_report_keep(smr_arena *a, smr_tick_report *r, uint32_t n); /* what pace does not tell; tick.c */
float smr_schedule_progress(const smr *s);                          /* 0..1: share of the schedule's iterations done */

#endif
