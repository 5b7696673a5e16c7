/* baseline.h: shape matching as a plain float program would do it: each cluster summed directly, or along the paper's
 * breadth-first chain. The library's sums are compared with it.
 * SPDX-License-Identifier: MIT */
#ifndef BASELINE_H
#define BASELINE_H

#include "../property/model_lists.h"

typedef struct baseline {
    rig_lists lists;
    float *ref;     /* [n][3] reference shape */
    float *goal;    /* [n][3] x + f */
    float *centre;  /* [n][3] of each cluster */
    float *inverse; /* [n][9] inverse inertia */
    float *record;  /* [n][16] what is summed */
    float *sum;     /* [n][16] */
    float *x;       /* [n][3] result */
} baseline;

/* Clusters of radius 0 of the model; goal: any displaced copy of the rest shape. */
baseline baseline_start(const smr_model *model);

/* One matching: sums, rigid kinematics with Rodrigues' formula, averaging. chain: along the stored chain. */
void baseline_match(baseline *b, int chain);

#endif
