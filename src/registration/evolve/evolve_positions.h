/* evolve_positions.h: new positions x = x~ (paper 2.3, evolution), smoothed along the surface, and their normals. In:
 * averaged transforms, x^r. Out: x_next, next normals, and the size of the displacements.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_EVOLVE_POSITIONS_H
#define SMR_EVOLVE_POSITIONS_H

#include "registration/match/cluster_match.h"

#define SMR_LIMITED_FULL 255.0f /* value of smr_tangent_smooth.limited for a step that was removed */

typedef struct smr_tangent_smooth {
    const smr_shared *shared;
    const smr_schedule *schedule;
    const smr_shape *shape;
    const smr_surface_goals *goals;
    smr_rings rings;
    float share; /* share of the way to the neighbours' mean that a vertex moves in this iteration; 0: no smoothing */
    uint8_t *limited; /* [n] largest removed share of the vertex' steps at the last radius, times SMR_LIMITED_FULL */
} smr_tangent_smooth;

/* What an iteration's end makes of x^r: nothing; the rest shape of tracking in new poses; x, where tracking starts. */
enum { SMR_REF_STAYS = 0, SMR_REF_POSED, SMR_REF_STARTS };

typedef struct smr_evolve {
    const smr_shared *shared;
    const smr_shape *shape;
    const smr_reference *reference;
    const smr_sums *sums;
    smr_tangent_smooth tangent_smooth;
    smr_tally *tally;
    float *most2;         /* [n_workers][n_structures] largest squared displacement, mm^2; NULL: nothing attracts */
    float moved_mm;       /* largest displacement of the current iteration, mm */
    float mean_mm;        /* mean displacement of the current iteration, mm */
    uint64_t hash;        /* hash of the positions x_next */
    uint32_t normals_due; /* 1: normals are computed from triangles in this iteration */
    uint32_t ref_next;    /* SMR_REF_...; plasticity sets x^r where the next iteration begins instead */
} smr_evolve;

void smr_evolve_layout(smr_arena *a, smr_evolve *e, const smr_shared *shared);
/* clears a part of `limited` when an iteration is abandoned */
void smr_evolve_reset(smr_evolve *e, uint32_t part, uint32_t parts);

/* Steps: smr_evolve_step writes x_next and next normals; smr_evolve_measure measures steps and hashes x_next. */
smr_count_tasks smr_evolve_tasks;
smr_run_task smr_evolve_step, smr_evolve_measure;
void smr_evolve_measure_end(smr_evolve *e);
uint64_t smr_hash_point(uint32_t v, const float *x);       /* returns what position x [3] of vertex v adds to a hash */
uint64_t smr_hash_positions(const float *xyz, uint32_t n); /* returns a hash of n positions xyz [n][3] */

/* Tangential smoothing, at the last radius. Steps: sums set to 0; sums over mesh neighbours, one task after another. */
void smr_tangent_begin(smr_tangent_smooth *e); /* chooses `share`, the strength of smoothing, for an iteration */
smr_count_tasks smr_tangent_tasks, smr_tangent_sum_tasks;
smr_run_task smr_tangent_clear, smr_tangent_sum;
smr_vec smr_tangent_displacement(const smr_tangent_smooth *e, uint32_t v); /* returns v's smoothing, mm */
/* Returns 1 + share of smoothing across the surface / largest one of clouds, of the target as it is now: 1 .. 2 for
 * clouds, where it divides the variance that noise leaves; 1 .. 3 for meshes. */
float smr_noise_smoothed(const smr_tangent_smooth *e, uint32_t structure);

/* Raises limited[v] to the share of the step of vertex v that a fold step removed. */
static inline void smr_tangent_limit(smr_tangent_smooth *e, uint32_t v, float share)
{
    if (smr_at_last_radius(e->shared, e->schedule))
        e->limited[v] = (uint8_t)smr_max_u32(e->limited[v], (uint32_t)(share * SMR_LIMITED_FULL + 0.5f));
}

/* Steps: vertex normals from triangles, in iterations with normals_due. The sums run one task after the other. */
smr_count_tasks smr_exact_normals_tasks, smr_exact_normals_sum_tasks;
smr_run_task smr_exact_normals_clear, smr_exact_normals_sum, smr_exact_normals_unit;

#endif
