/* convergence.h: how an iteration ends: at rest, with its radius, with the schedule; and whether x^r = x follows.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_CONVERGENCE_H
#define SMR_CONVERGENCE_H

#include "registration/schedule_radius.h"

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
