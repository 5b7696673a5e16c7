/* cluster_sums.h: sums over clusters, Sigma_i(v) of paper 2.2. In: fixed-point records of each vertex. Out: their sums
 * over the cluster of each vertex. Reference moments, displacements and transforms are summed in turn.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_CLUSTER_SUMS_H
#define SMR_CLUSTER_SUMS_H

#include "registration/goals/external_forces.h"

typedef struct smr_sums {
    const smr_shared *shared;
    const smr_schedule *schedule;
    const smr_forces *forces;
    smr_tally *tally;
    uint32_t *record; /* [n][SMR_WORDS] fixed-point record of each vertex */
    uint32_t *sum;    /* [n][SMR_WORDS] sum of the records over the vertex' cluster */
    float scale[2];   /* scales of the two kinds of quantities: stored = value * scale */
    uint32_t words;   /* words in use: 6, 12 or 16 */
    uint32_t pieces;  /* pieces of a block in the current step; 0 and 1: blocks are whole */
} smr_sums;

/* Sets the number of words and the scales of the next sums, which stay below these bounds. */
void smr_sums_expect(smr_sums *s, uint32_t words, float largest0, float largest1);
uint32_t smr_method_words(const smr_shared *c); /* words of a displacement's record */

uint32_t smr_sums_record_tasks(const void *sums);
void smr_sums_record(void *sums, uint32_t task, uint32_t worker);

/* Sums along the order L. A task is a block, or a piece of one. */
uint32_t smr_block_tasks(const void *sums);
uint32_t smr_block_abreast(const void *sums);
void smr_block_pieces(void *sums, int cut);
void smr_sums_forest(void *sums, uint32_t task, uint32_t worker);

/* Fractional weights near cluster boundaries, after the sums. Tasks run one after the other. */
uint32_t smr_boundary_tasks(const void *sums);
void smr_boundary_sums(void *sums, uint32_t task, uint32_t worker);

void smr_sums_at_once(smr_sums *s); /* sums the records over all clusters, between iterations */

#endif
