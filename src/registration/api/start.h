/* start.h: jobs that start a registration (base/job.h). Start positions are set by stages of set_start_pose.c, which
 * smr_init() and smr_restore() go on from: each adds stages of its own before and behind.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_START_H
#define SMR_START_H

#include "registration/api/setup.h"
#include "registration/measure_job.h"

#define SMR_START_PIECE 128u /* vertices in a task */

/* Start positions in the making. */
typedef struct smr_starting {
    smr_measuring job;
    smr_run_task *then; /* goes on when the positions are set; NULL: the job ends */
    const float *xyz;   /* positions of a structure, mm; NULL: the rest shape in a pose */
    uint32_t structure;
    uint32_t claimed;     /* 1: positions are being written, and only this job goes on */
    smr_pose given, pose; /* pose of the rest shape, and the same without its shift; then a fitted pose */
    smr_status wrong;     /* status where a position is out of range */
    smr_vec shift;        /* displacement of all positions, mm: to the origin in a pose, then to a new origin */
    smr_box box;          /* box around the positions visited so far, mm */
    smr_fit fit;          /* sums of the fit in progress */
    float most;           /* largest squared distance from a rigid pose so far, mm^2 */
    uint32_t k, at;       /* structure that is measured now, and number of its items done */
    smr_bulk bulk;        /* volume of that structure so far */
    smr_vec area;         /* twice the sum of its area vectors at rest, mm^2 */
    float open, areas;    /* lengths of such sums of all structures, and sums of lengths, mm^2 */
} smr_starting;

/* The registration in the arena while smr_init() divides it. */
typedef struct smr_initing {
    smr_starting start;
    smr_run_task *then; /* goes on behind smr_init(); NULL: the job ends */
    const smr_model *model;
    smr_config config;
    smr_port own; /* the caller's port, copied */
    void *arena;
    size_t needed; /* bytes of the registration */
    smr **out;
} smr_initing;

_Static_assert(sizeof(smr_initing) <= SMR_JOB_BYTES, "a registration in the making lies in the caller's job");

/* Stages of set_start_pose.c. smr_start_go() goes on with them. */
void smr_start_go(smr_starting *j);
void smr_start_add_to_box(smr_starting *j, uint32_t task, float *xyz);
smr_count_tasks smr_start_vertices, smr_start_in_parts, smr_start_fits, smr_start_leaves, smr_start_uppers;
smr_run_task smr_start_box, smr_start_find_parts, smr_start_scale_fit, smr_start_refit_leaves, smr_start_refit_uppers;

/* Stages of start_masses.c, with dynamics: weights of fits, in pieces of the vertices. */
smr_count_tasks smr_start_weights;
smr_run_task smr_start_add_weights, smr_start_set_weights;

/* Goes on with the stages of start_masses.c: members and weights; `then` comes behind them. */
void smr_start_masses_go(smr_starting *j);

/* Begins smr_init() in *j. Errors: as smr_init(). */
smr_status smr_init_check(smr_initing *j, const smr_model *model, const smr_config *config, const smr_port *port,
                          void *arena, size_t bytes, smr **out);

#endif
