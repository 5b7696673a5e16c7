/* dynamics.h: capability: a model that has mass and moves in time. In: smr_set_motion(), positions, average goals. Out:
 * where sweeps start, weights of the clusters' fits, positions under way, velocities and energies. time_steps.c has the
 * method.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_DYNAMICS_H
#define SMR_DYNAMICS_H

#include "registration/registration.h"

#ifdef SMR_WITHOUT_DYNAMICS
#define SMR_HAS_DYNAMICS 0
#else
#define SMR_HAS_DYNAMICS 1
#endif

#define SMR_MASS_LEAST 1.0e-6f  /* g */
#define SMR_MASS_MOST 1.0e6f    /* g */
#define SMR_SPEED_MOST 1.0e6f   /* mm/s along an axis */
#define SMR_STORED_MOST 3.0e38f /* uJ */
#define SMR_FARTHEST 1.0e6f     /* mm along an axis: vertices stop there */

/* Energies of the last complete time step, uJ. */
typedef struct smr_stored_energy {
    float elastic, goals;
} smr_stored_energy;

/* Energies of a group of structures, uJ: of springs at a time step's end; kinetic ones at its start, and at its end
 * before damping, of that SPIN in the group's turn; work of gravity and goals. PUSHED: number of moving pins. */
enum { SMR_ELASTIC, SMR_GOALS, SMR_BEFORE, SMR_AFTER, SMR_SPIN, SMR_WORK, SMR_PUSHED, SMR_STEP_ENERGIES };

/* What is summed at a time step's end. First what is of a group, in the sums of its first structure; of groups without
 * pinned vertices also the motion as a whole, for nothing within them changes its momentum. */
typedef struct smr_step_sums {
    float energy[SMR_STEP_ENERGIES];
    uint32_t fixed;             /* 1: has pinned vertices: no such motion, all is 0 */
    float mass;                 /* g */
    smr_vec speed, way, middle; /* means: mm/s when the step began, mm in it, mm at its end */
    smr_vec spin;               /* turn in the step about the middle */
    float share, spin_share;    /* what velocities are scaled by: what is beside way and turn, and the turn's */
    float n_pinned;             /* of the structure's own, as are the next three */
    smr_vec centre, off, turn;  /* of pinned vertices; off the reference shape: off + turn x (x - centre) */
    float inertia[6];           /* of what turns: the group, or the structure's pinned vertices */
} smr_step_sums;

typedef struct smr_dynamics {
    const smr_shared *shared;
    float step_s;  /* h */
    float springs; /* k h^2: elastic over inertial stiffness */
    smr_vec fall;  /* h^2 g, mm */
    float keeps;   /* share of the velocities that damping leaves */
    uint32_t ends; /* 1: the iteration under way ends a time step. Written by time_steps.c */
    float gram;    /* g: mass of a vertex is weight * members * gram */
    smr_stored_energy stored;
    uint32_t weighed;           /* 1: masses were set since the last complete time step */
    uint32_t *group;            /* [n_structures] first of those that share clusters, at the radius in use */
    float *bent;                /* [n_structures] uJ, of each group's first: elastic energy as reported */
    float *spare;               /* [n_structures] uJ, likewise: all of it, and what steps have taken beside damping */
    smr_step_sums *sums;        /* [n_structures] */
    uint32_t structure, vertex; /* where summing is */
    float *begin;               /* [n][3] mm: positions at the start of the time step */
    float *velocity;            /* [n][3] mm/s at the start of the time step */
    float *mass;                /* [n] g as asked for; 0: it keeps its velocity whatever happens */
    float *members;             /* [n] |zeta|, of the radius in use */
    float *weight;              /* [n] in the clusters' fits: whole multiples of 1 / smr_shared.mass_unit */
} smr_dynamics;

void smr_dynamics_layout(smr_arena *a, smr_dynamics **dynamics, const smr_shared *shared);
void smr_dynamics_wire(smr_dynamics *d, const smr_shared *shared); /* at rest, with the model's masses */

/* Where vertex v would be at the end of the time step if nothing held it: y = x + h v + h^2 g. */
static inline smr_vec smr_dynamics_free(const smr_dynamics *d, uint32_t v)
{
    const smr_vec way = smr_scale(smr_load(smr_at3(d->velocity, v)), d->step_s), x = smr_load(smr_at3(d->begin, v));
    const smr_vec y = smr_add(smr_add(x, way), d->mass[v] > 0.0f ? d->fall : smr_v(0, 0, 0));
    return smr_v(smr_clamp(y.x, -SMR_FARTHEST, SMR_FARTHEST), smr_clamp(y.y, -SMR_FARTHEST, SMR_FARTHEST),
                 smr_clamp(y.z, -SMR_FARTHEST, SMR_FARTHEST));
}

/* 1: the iteration is the first of a time step: it starts at y. */
static inline int smr_first_sweep(const smr_pace *p) { return p->iteration % SMR_SWEEPS == 0u; }

/* Where a sweep starts: at y, or where the sweep before came to. */
static inline smr_vec smr_dynamics_from(const smr_dynamics *d, const smr_pace *p, uint32_t v, smr_vec x)
{
    return smr_first_sweep(p) ? smr_dynamics_free(d, v) : x;
}

/* x, where a sweep has taken vertex v; when the time step ends with it: y of the next one, but for rounding. The
 * reference shape is laid there, so that the fits see what is left beside the rigid motion. */
static inline smr_vec smr_dynamics_ahead(const smr_dynamics *d, uint32_t v, smr_vec x)
{
    if (!d->ends)
        return x;
    if (!(d->mass[v] > 0.0f))
        return smr_add(x, smr_scale(smr_load(smr_at3(d->velocity, v)), d->step_s));
    const smr_vec way = smr_sub(x, smr_load(smr_at3(d->begin, v)));
    return smr_add(x, smr_add(smr_scale(way, d->keeps), d->fall));
}

/* Where a sweep takes vertex v: the least of m/2h^2 |x - y|^2 + m k/2 |x - average|^2 + m k share/2 |x - goal|^2, where
 * share is that of the spring to the goal and pull is share * goal. */
static inline smr_vec smr_dynamics_next(const smr_dynamics *d, uint32_t v, smr_vec average, float share, smr_vec pull)
{
    const smr_vec y = smr_dynamics_free(d, v);
    if (!(d->mass[v] > 0.0f))
        return y;
    const smr_vec held = smr_scale(smr_add(average, pull), d->springs);
    return smr_scale(smr_add(y, held), 1.0f / (1.0f + d->springs * (1.0f + share)));
}

/* 1: the model has mass. */
static inline int smr_moves(const smr *s) { return SMR_HAS_DYNAMICS && s->shape.dynamics != NULL; }

/* ---- time steps, of SMR_SWEEPS iterations each ---- */

void smr_time_steps_start(smr *s); /* x is at rest, and the shape that the model is elastic about */
void smr_time_steps_begin(smr *s); /* before an iteration */
void smr_time_steps_next(smr *s);  /* after an iteration */
void smr_time_steps_weigh(smr *s); /* masses are new: weights of the clusters' fits */

/* Mass of a vertex as it counts, g. 0: it keeps its velocity. */
static inline float smr_counted_mass(const smr_dynamics *d, uint32_t v)
{
    return d->mass[v] > 0.0f ? d->weight[v] * d->members[v] * d->gram : 0.0f;
}

/* A structure's vertex i in the caller's order. */
static inline uint32_t smr_vertex_of(const smr *s, uint32_t structure, uint32_t i)
{
    return smr_model_position(s->shared.model, s->shape.structure[structure].first_vertex + i);
}

/* Steps: where a sweep starts, before forces; where it takes vertices from their average goals. */
uint32_t smr_sweep_tasks(const void *s);
void smr_sweep_begin(void *s, uint32_t task, uint32_t worker);
void smr_sweep_end(void *s, uint32_t task, uint32_t worker);

/* ---- energies ---- */

/* Step, before the iteration that ends a time step stands: sums, one task after the other. */
uint32_t smr_step_energy_tasks(const void *s); /* 0 in other iterations */
void smr_step_energy(void *s, uint32_t task, uint32_t worker);

/* When it stands: velocities. `begin` is where the step began, and becomes x. */
void smr_step_velocities(smr *s);

#endif
