/* schedule_radius.h: at which cluster radius a registration stands, how its iterations end (convergence.c), and when
 * the reference shape follows (plasticity.c).
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
/* index of the radius with the smallest ratio to this one, mm, from first to last */
uint32_t smr_radius_near(const smr_model *m, uint32_t first, uint32_t last, float mm);
uint32_t smr_radius_after(const smr *s); /* index of the radius after the schedule, and in dynamics */
float smr_radius_progress(const smr *s); /* 0..1: share of the schedule's iterations done */

/* What an iteration ended with. All are 0 or 1. */
typedef struct smr_ending {
    int small;   /* no vertex moved by plastic_um or more */
    int settled; /* no vertex moved by settle_um or more, and the radius may end early */
    int spent;   /* it was the last iteration of its radius */
    int done;    /* it was the last of the schedule */
} smr_ending;

/* Of iteration number radius_iteration at the radius in use. */
smr_ending smr_ending_of(const smr *s, uint32_t radius_iteration);

/* plasticity.c: 1 when x^r = x follows an iteration that ended so, the since_plastic-th since x^r was new. */
int smr_plastic_due(const smr *s, const smr_ending *e, uint32_t since_plastic);
int smr_plastic_ahead(const smr *s); /* the same of the iteration under way, before it is complete */
void smr_plastic_update(smr *s);     /* x^r = x. Normals follow with smr_plastic_normals(), once current */
void smr_plastic_positions(smr_shape *shape);
void smr_plastic_normals(smr_shape *shape);

#endif
