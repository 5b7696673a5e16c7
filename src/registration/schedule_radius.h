/* schedule_radius.h: the current cluster radius, convergence, and plasticity.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_SCHEDULE_RADIUS_H
#define SMR_SCHEDULE_RADIUS_H

#include "registration/registration.h"

#define SMR_FIRST_CLOUD 3u /* factor on the number of iterations at the first radius with clouds: slow convergence */

void smr_radius_go(smr *s, uint32_t radius);  /* makes this the current radius, before its first iteration */
void smr_radius_take(smr *s);                 /* sets clusters, momentum and search distance of the current radius */
uint32_t smr_radius_active(const smr *s);     /* returns the number of active vertices by configuration and clusters */
uint32_t smr_radius_iterations(const smr *s); /* returns the largest number of iterations at the current radius */
/* returns the index, first .. last, of the radius, with all vertices in clusters, whose ratio to mm is nearest to 1 */
uint32_t smr_radius_near(const smr_model *m, uint32_t first, uint32_t last, float mm);
uint32_t smr_radius_after(const smr *s); /* returns the index of the radius for tracking and for dynamics */
int smr_shows_part(const smr *s);        /* returns 1 when a target surface shows a part of the model to the end */
float smr_radius_progress(const smr *s); /* returns the completed share of the schedule's iterations, 0..1 */

/* Result of an iteration. Each field is 0 or 1. */
typedef struct smr_ending {
    int small;   /* 1: no vertex moved by plastic_um or more */
    int settled; /* 1: no vertex moved by settle_um or more, and the radius may end early */
    int spent;   /* 1: the iteration was the last one of its radius, which then ends */
    int done;    /* 1: the iteration was the last one of the schedule */
} smr_ending;

smr_ending smr_ending_of(const smr *s, uint32_t radius_iteration); /* judges this iteration of the current radius */

/* Returns 1 when x^r must be set to x after an iteration with this ending, since_plastic iterations after the last. */
int smr_plastic_due(const smr *s, const smr_ending *e, uint32_t since_plastic);
/* Returns 1 when x^r will be set to x after the current iteration. In tracking and dynamics x^r is the rest shape in
 * new poses instead (tracking_rest_shape.c). */
int smr_plastic_ahead(const smr *s);
void smr_plastic_update(smr *s);       /* x^r is x from now on, of which the next iteration's first step makes a copy */
int smr_plastic_follows(const smr *s); /* 1: x^r is x, whether or not the copy is made */
/* First step: copies positions and normals to those of the reference shape where plasticity has set x^r to x. */
smr_count_tasks smr_plastic_tasks;
smr_run_task smr_plastic_follow;

/* strain_bound.c. Step, one task after the other: shortens edges of the next positions that are beyond the bound. */
smr_count_tasks smr_strain_tasks;
smr_run_task smr_strain_limit;

#endif
