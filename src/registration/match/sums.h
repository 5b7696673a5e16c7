/* sums.h: sums over clusters, Sigma_i(v) of paper 2.2. In: fixed-point records of each vertex. Out: their sums over the
 * cluster of each vertex. Reference moments, displacements and transforms are summed in turn.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_SUMS_H
#define SMR_SUMS_H

#include "registration/goals/forces.h"

typedef struct smr_sums {
    const smr_shared *shared;
    const smr_pace *pace;
    const smr_forces *forces;
    smr_tally *tally;
    uint32_t *record; /* [n][SMR_WORDS] fixed-point quantities of each vertex */
    uint32_t *sum;    /* [n][SMR_WORDS] their sums over its cluster */
    float scale[2];   /* of the two kinds of quantities: stored = value * scale */
    uint32_t words;   /* in use of a record: 6, 12 or 16 */
    uint32_t pieces;  /* of a block in the step under way; 0 and 1: whole */
} smr_sums;

void smr_sums_wire(smr_sums *s, const smr_shared *shared, const smr_pace *pace, const smr_forces *forces,
                   const smr_overlay *overlay);

/* What comes is summed in `words` words, with sums that stay below these bounds. */
void smr_sums_expect(smr_sums *s, uint32_t words, float largest0, float largest1);
uint32_t smr_method_words(const smr_shared *c); /* of the displacements' records */

/* Records of displacements. */
uint32_t smr_sums_record_tasks(const void *sums);
void smr_sums_record(void *sums, uint32_t task, uint32_t worker);

/* The chain along the order L: a task is a block, or a piece of one. */
uint32_t smr_block_tasks(const void *sums);
uint32_t smr_block_abreast(const void *sums);
void smr_block_pieces(void *sums, int cut);
void smr_sums_forest(void *sums, uint32_t task, uint32_t worker);

/* cluster_boundary.c: fractional weights of vertices near a cluster's boundary. Serial, after the chain. */
uint32_t smr_boundary_tasks(const void *sums);
void smr_boundary_sums(void *sums, uint32_t task, uint32_t worker);

#endif
