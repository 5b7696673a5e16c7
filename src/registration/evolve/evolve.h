/* evolve.h: new positions x = x~ (paper 2.3, evolution), evened out along the surface, with their normals; plasticity.
 * In: averaged transforms, x^r. Out: x_next and what an iteration moved; x^r where it follows.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_EVOLVE_H
#define SMR_EVOLVE_H

#include "registration/match/reference.h"

#define SMR_HELD 255.0f /* held back altogether */

/* tangent_evening.c */
typedef struct smr_evening {
    const smr_shared *shared;
    const smr_pace *pace;
    const smr_shape *shape;
    const smr_surface_goals *goals;
    smr_rings rings;
    float share;   /* of the way to the mesh neighbours' mean, in this iteration; 0: none */
    uint8_t *held; /* [n] the most that folds/ held back of a step since the last radius began; SMR_HELD: all */
} smr_evening;

typedef struct smr_evolve {
    const smr_shared *shared;
    const smr_shape *shape;
    const smr_forces *forces;
    const smr_reference *reference;
    const smr_sums *sums;
    smr_evening evening;
    smr_tally *tally;
    float moved_mm;       /* largest displacement of the iteration under way */
    float mean_mm;        /* mean displacement, where the configuration asks for it */
    uint64_t hash;        /* of its positions */
    uint32_t normals_due; /* 1: it ends with normals of the triangles. Written by the tick */
} smr_evolve;

void smr_evolve_layout(smr_arena *a, smr_evolve *e, const smr_shared *shared);
void smr_evolve_wire(smr_evolve *e, const smr_shared *shared, const smr_pace *pace, const smr_shape *shape,
                     const smr_forces *forces, const smr_reference *reference, const smr_sums *sums,
                     const smr_overlay *overlay);
void smr_evolve_reset(smr_evolve *e); /* an iteration is given up */

uint32_t smr_evolve_tasks(const void *evolve);
void smr_evolve_step(void *evolve, uint32_t task, uint32_t worker);
void smr_evolve_measure(void *evolve, uint32_t task, uint32_t worker); /* displacements and hash of what stands */
void smr_evolve_measure_end(smr_evolve *e);
uint64_t smr_hash_positions(const float *xyz, uint32_t n); /* [n][3] */

/* tangent_evening.c: at the last radius. */
void smr_evening_begin(smr_evening *e); /* the share of the coming iteration */
uint32_t smr_evening_tasks(const void *evening);
void smr_evening_clear(void *evening, uint32_t task, uint32_t worker);
uint32_t smr_evening_ring_tasks(const void *evening);
void smr_evening_rings(void *evening, uint32_t task, uint32_t worker); /* serial */
smr_vec smr_evening_way(const smr_evening *e, uint32_t v);             /* valid after the rings, until the folds */

/* Evening out ends for a vertex whose step was held back, by this share. */
static inline void smr_evening_hold(smr_evening *e, uint32_t v, float share)
{
    if (smr_at_last_radius(e->shared, e->pace))
        e->held[v] = (uint8_t)smr_max_u32(e->held[v], (uint32_t)(share * SMR_HELD + 0.5f));
}

/* exact_normals.c: normals of the triangles, where they are due. */
uint32_t smr_exact_normals_tasks(const void *evolve);
void smr_exact_normals_clear(void *evolve, uint32_t task, uint32_t worker);
uint32_t smr_exact_normals_facet_tasks(const void *evolve);
void smr_exact_normals_facets(void *evolve, uint32_t task, uint32_t worker); /* serial */
void smr_exact_normals_unit(void *evolve, uint32_t task, uint32_t worker);

#endif
