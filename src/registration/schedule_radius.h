/* schedule_radius.h: at which cluster radius a registration stands, and what follows from that.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_SCHEDULE_RADIUS_H
#define SMR_SCHEDULE_RADIUS_H

#include "registration/registration.h"

#define SMR_FIRST_CLOUD 3u /* the same factor with clouds: points without normals converge slowly */
#define SMR_REPAIR_MAX 30u /* most iterations of fold repair before a radius starts */

void smr_radius_go(smr *s, uint32_t radius); /* continues at this radius */
void smr_radius_take(smr *s);                /* what follows from the radius alone */
uint32_t smr_radius_active(const smr *s); /* active vertices that the configuration asks for, as clusters need them */
uint32_t smr_radius_iterations(const smr *s); /* at most, at the radius in use */
uint32_t smr_radius_after(const smr *s);      /* index of the radius after the schedule, and in dynamics */
float smr_radius_progress(const smr *s);      /* 0..1: share of the schedule's iterations done */

#endif
