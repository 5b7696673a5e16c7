/* cluster_reference.h: what matching needs of the reference shape x^r, recomputed when x^r or the active vertices
 * change. In: x^r, masses. Out: centre c^r, mass M and spread of each cluster, 1 / |zeta|.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_CLUSTER_REFERENCE_H
#define SMR_CLUSTER_REFERENCE_H

#include "registration/match/cluster_sums.h"

typedef struct smr_reference {
    const smr_shared *shared;
    const smr_schedule *schedule;
    const smr_shape *shape;
    smr_sums *sums; /* sums the moments before the displacements */
    smr_tally *tally;
    uint32_t stale;      /* 1: x^r or the active vertices are new */
    uint32_t missing;    /* 1: the arrays below were not saved, and are recomputed after a restore */
    float *centre;       /* [n][3] c^r of each cluster, mm */
    float *spread;       /* [n][6] inverse inertia tensor (rigid) or covariance (polar), upper triangle */
    float *cluster_mass; /* [n] M; centre, spread and M exist for active vertices' clusters only */
    float *share;        /* [n] 1 / |zeta| over active members; 0 without members */
    float coarse, fine;  /* steps, mm, to which x^r is rounded for spreads and for centres */
    float per_coarse;    /* 1 / coarse, 1 / mm, exact. Divided once: */
    float per_fine;      /* 1 / fine, 1 / mm. A vector division would divide by 0 in its unused lane */
} smr_reference;

void smr_reference_layout(smr_arena *a, smr_reference *r, const smr_shared *shared);

/* Returns 1 when the reference is recomputed in this iteration. */
static inline int smr_reference_due(const smr_reference *r) { return r->stale != 0u || r->missing != 0u; }

/* Steps, skipped unless due. */
uint32_t smr_reference_tasks(const void *reference);
void smr_reference_reach(void *reference, uint32_t task, uint32_t worker);
void smr_reference_begin(smr_reference *r); /* chooses the rounding steps */
uint32_t smr_reference_record_tasks(const void *reference);
void smr_reference_record(void *reference, uint32_t task, uint32_t worker);
uint32_t smr_reference_block_tasks(const void *reference);
uint32_t smr_reference_block_abreast(const void *reference);
void smr_reference_block_pieces(void *reference, int cut);
void smr_reference_forest(void *reference, uint32_t task, uint32_t worker);
uint32_t smr_reference_boundary_tasks(const void *reference);
/* fractional weights; tasks run one after the other */
void smr_boundary_reference(void *reference, uint32_t task, uint32_t worker);
uint32_t smr_reference_cluster_tasks(const void *reference);
void smr_reference_cluster(void *reference, uint32_t task, uint32_t worker);
void smr_reference_end(smr_reference *r);

/* value / SMR_BOUNDARY_UNITS, rounded to nearest, for values within +-2^62. Its time does not depend on the sign. */
static inline uint32_t smr_boundary_part(int64_t value)
{
    const uint64_t up = (uint64_t)1 << 62;
    return (uint32_t)(((uint64_t)value + up + SMR_BOUNDARY_UNITS / 2) / SMR_BOUNDARY_UNITS) -
           (uint32_t)(up / SMR_BOUNDARY_UNITS);
}

/* Adds share / SMR_BOUNDARY_UNITS of one vertex' moments to the sums of another's cluster. */
void smr_reference_add(smr_reference *r, uint32_t to, uint32_t from, int32_t share);

#endif
