/* cluster_match.h: shape matching of clusters (paper 2.2, 2.3). In: external forces, x, x^r, masses, the order L. Out:
 * for each cluster sums of displacements, centre, mass and spread in x^r, and the transform T_i; for each vertex the
 * sum of its clusters' transforms.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_CLUSTER_MATCH_H
#define SMR_CLUSTER_MATCH_H

#include "base/fixed_point.h"
#include "geometry/rotation/rotation.h"
#include "registration/goals/external_forces.h"

/* Sums over the vertices of each cluster (paper 2.2), of moments of x^r, displacements and transforms in turn. */
typedef struct smr_sums {
    const smr_shared *shared;
    const smr_schedule *schedule;
    const smr_forces *forces;
    uint32_t *record; /* [n][SMR_WORDS] fixed-point values of each vertex that are summed */
    uint32_t *sum;    /* [n][SMR_WORDS] sum of the records of all vertices of the vertex' cluster */
    float scale[2];   /* scales of the two kinds of quantities: stored = value * scale */
    uint32_t words;   /* number of words of a record in use: 6, 12 or 16 */
} smr_sums;

/* The clusters in the reference shape, recomputed when x^r or the active vertices change. */
typedef struct smr_reference {
    const smr_shared *shared;
    const smr_schedule *schedule;
    const smr_shape *shape;
    smr_sums *sums; /* memory in which the moments of x^r are summed */
    smr_tally *tally;
    uint32_t stale;     /* 1: x^r or the active vertices are new */
    uint32_t missing;   /* 1: centre, spread, cluster_mass and share must be computed after a restore */
    uint32_t strained;  /* 1: many edges were beyond the bound of strain when they were checked last (strain_bound.c) */
    uint32_t n_sweeps;  /* number of sweeps over the edges that are known to be due in this iteration */
    uint32_t n_over;    /* number of edges of triangles beyond the bound in this sweep so far */
    uint32_t many_over; /* 1: the first sweep of this check found many of them */
    float *centre;      /* [n][3] c^r of each cluster, mm */
    float *spread; /* [n][6] inverse inertia tensor (rigid) or covariance (polar) of each cluster, upper triangle */
    float *cluster_mass; /* [n] mass M of the cluster. Centre, spread and M exist for active vertices' clusters only */
    float *share;        /* [n] 1 / number of active vertices of the cluster; 0 without active vertices */
    float coarse, fine;  /* steps, mm, to which x^r is rounded for spreads and for centres */
    float per_coarse;    /* 1 / coarse, 1 / mm, exact */
    float per_fine;      /* 1 / fine, 1 / mm: a vector division by `fine` would divide by 0 in the unused lane */
} smr_reference;

typedef struct smr_match {
    const smr_shared *shared;
    const smr_schedule *schedule;
    const smr_reference *reference;
    const smr_sums *sums;
    smr_tally *tally;
    /* words 0..11 of smr_sums.sum: each cluster's transform, floats: R - I row-major, t in mm; fusing lie: a twist */
    float *eigen;     /* [n][9] start values of the polar decomposition; NULL for the rigid method */
    float largest[2]; /* largest entry of all R - I (or rotation vectors); largest entry of all t (or rates), mm */
} smr_match;

/* Sets number of words and scales of the next sums. largest0, largest1: bounds on a vertex' two kinds of values. */
void smr_sums_expect(smr_sums *s, uint32_t words, float largest0, float largest1);
uint32_t smr_method_words(const smr_shared *c); /* returns the number of words of a displacement's record */
/* Between iterations: sums a part of the lists of *block, and goes on to the next one. Returns 1 while work is left. */
int smr_sums_some(smr_sums *s, uint32_t *block);

/* Steps on smr_sums. smr_sums_record writes displacements as records. smr_sums_forest sums records over clusters; each
 * task is a block of the order L. smr_boundary_sums adds fractional weights, one task after the other. */
smr_count_tasks smr_sums_record_tasks, smr_block_tasks, smr_boundary_tasks;
smr_run_task smr_sums_record, smr_sums_forest, smr_boundary_sums;

/* Returns value / SMR_BOUNDARY_UNITS, rounded to nearest, for values within +-2^62, in a time that is always equal. */
static inline uint32_t smr_boundary_part(int64_t value)
{
    const uint64_t up = (uint64_t)1 << 62;
    return (uint32_t)(((uint64_t)value + up + SMR_BOUNDARY_UNITS / 2) / SMR_BOUNDARY_UNITS) -
           (uint32_t)(up / SMR_BOUNDARY_UNITS);
}

void smr_reference_layout(smr_arena *a, smr_reference *r, const smr_shared *shared);
void smr_reference_begin(smr_reference *r); /* chooses `coarse` and `fine`, the steps to which x^r is rounded */
void smr_reference_end(smr_reference *r);   /* marks centres, masses and spreads as current */

/* Steps that run only where smr_reference_due(): compute distances of x^r from the posed rest shape; records of moments
 * of x^r; moments near cluster boundaries, tasks in order; centre, mass and spread of each cluster. */
smr_count_tasks smr_reference_tasks, smr_reference_record_tasks, smr_reference_boundary_tasks;
smr_count_tasks smr_reference_cluster_tasks;
smr_run_task smr_reference_reach, smr_reference_record, smr_boundary_reference, smr_reference_cluster;

/* Returns 1 when this iteration recomputes centres, masses and spreads of the clusters. */
static inline int smr_reference_due(const smr_reference *r) { return r->stale != 0u || r->missing != 0u; }

/* Adds share / SMR_BOUNDARY_UNITS of the moments of vertex `from` to the sums of the cluster of vertex `to`. */
void smr_reference_add(smr_reference *r, uint32_t to, uint32_t from, int32_t share);

void smr_match_layout(smr_arena *a, smr_match *m, const smr_shared *shared);
/* discards start values of decompositions, of a part of the vertices */
void smr_match_reset(smr_match *m, uint32_t part, uint32_t parts);
void smr_match_end(smr_match *m); /* computes m->largest from the results of the tasks */

/* Steps on smr_match: smr_match_clusters computes the clusters' transforms; smr_average_record writes their records. */
smr_count_tasks smr_match_cluster_tasks, smr_average_tasks;
smr_run_task smr_match_clusters, smr_average_record;

static inline int smr_blends_logs(const smr_shared *shared) { return shared->config.motion.fusing == SMR_FUSING_LIE; }

/* Returns the number of words of a transform's record; the last three words hold t, or the rate of a twist. */
static inline uint32_t smr_transform_words(const smr_shared *shared) { return smr_blends_logs(shared) ? 6u : 12u; }

/* Returns a vertex' averaged twist from its sum of 6 words. inverse: 1 / smr_sums.scale; share: smr_reference.share. */
static inline smr_twist smr_average_twist(const uint32_t *w, const float inverse[2], float share)
{
    return (smr_twist){smr_scale(smr_unfix3(w, inverse[0]), share), smr_scale(smr_unfix3(w + 3, inverse[1]), share)};
}

/* Writes R - I of a vertex' averaged transform to r_minus_i, from the vertex' sum of 12 words. Returns t, mm. */
static inline smr_vec smr_average_transform(const uint32_t *w, const float inverse[2], float share, float r_minus_i[9])
{
    for (uint32_t i = 0; i < 9u; i++)
        r_minus_i[i] = smr_unfix(w[i], inverse[0]) * share;
    return smr_scale(smr_unfix3(w + 9, inverse[1]), share);
}

#endif
