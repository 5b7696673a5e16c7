/* reference.h: what matching needs of the reference shape x^r, made anew whenever x^r or the active vertices change.
 * In: x^r, masses. Out: centre c^r, mass M and spread of each cluster, 1 / |zeta|.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_REFERENCE_H
#define SMR_REFERENCE_H

#include "registration/match/sums.h"

typedef struct smr_reference {
    const smr_shared *shared;
    const smr_pace *pace;
    const smr_shape *shape;
    smr_sums *sums; /* lent: the moments are summed there, before the displacements */
    smr_tally *tally;
    uint32_t stale;      /* 1: x^r or the active vertices are new. Written by the tick */
    uint32_t missing;    /* 1: what follows was not saved: it is made again though nothing is new. By setup/restore.c */
    float *centre;       /* [n][3] c^r of each cluster, mm */
    float *spread;       /* [n][6] inverse inertia tensor (rigid) or covariance (polar), upper triangle */
    float *cluster_mass; /* [n] M; this and the two above only of active vertices' clusters */
    float *share;        /* [n] 1 / |zeta| over active members; 0 for none */
    float coarse, fine;  /* mm: x^r is rounded to these steps where spreads and centres are summed */
    float per_coarse;    /* 1 / mm: the steps' inverses, exact. Divided here once: where a compiler makes vectors */
    float per_fine;      /* of three divisions, the lane left over divides by 0 */
} smr_reference;

void smr_reference_layout(smr_arena *a, smr_reference *r, const smr_shared *shared);
void smr_reference_wire(smr_reference *r, const smr_shared *shared, const smr_pace *pace, const smr_shape *shape,
                        smr_sums *sums, const smr_overlay *overlay);

/* 1 when what matching needs is made in this iteration. */
static inline int smr_reference_due(const smr_reference *r) { return r->stale != 0u || r->missing != 0u; }

/* Steps, all skipped unless due. */
uint32_t smr_reference_tasks(const void *reference);
void smr_reference_reach(void *reference, uint32_t task, uint32_t worker); /* deviation of x^r from the rest pose */
void smr_reference_begin(smr_reference *r);                                /* chooses the steps of rounding */
uint32_t smr_reference_record_tasks(const void *reference);
void smr_reference_record(void *reference, uint32_t task, uint32_t worker);
uint32_t smr_reference_block_tasks(const void *reference);
uint32_t smr_reference_block_abreast(const void *reference);
void smr_reference_block_pieces(void *reference, int cut);
void smr_reference_forest(void *reference, uint32_t task, uint32_t worker);
uint32_t smr_reference_boundary_tasks(const void *reference);
void smr_boundary_reference(void *reference, uint32_t task, uint32_t worker); /* cluster_boundary.c; serial */
uint32_t smr_reference_cluster_tasks(const void *reference);
void smr_reference_cluster(void *reference, uint32_t task, uint32_t worker);
void smr_reference_end(smr_reference *r);

/* value / SMR_BOUNDARY_UNITS, to the nearest, for values within +-2^62. Takes as long whatever its sign. */
static inline uint32_t smr_boundary_part(int64_t value)
{
    const uint64_t up = (uint64_t)1 << 62;
    return (uint32_t)(((uint64_t)value + up + SMR_BOUNDARY_UNITS / 2) / SMR_BOUNDARY_UNITS) -
           (uint32_t)(up / SMR_BOUNDARY_UNITS);
}

/* Adds a part of one vertex to the sums of another's cluster: share / SMR_BOUNDARY_UNITS of its moments. */
void smr_reference_add(smr_reference *r, uint32_t to, uint32_t from, int32_t share);

#endif
