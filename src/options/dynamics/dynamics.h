/* dynamics.h: capability: a model that has mass and moves in time. In: smr_set_motion(), positions, average goals. Out:
 * where sweeps start, weights of the clusters' fits, positions under way, velocities and energies.
 * dynamics_time_steps.c has the method.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_DYNAMICS_H
#define SMR_DYNAMICS_H

#include "registration/registration.h"

#ifdef SMR_WITHOUT_DYNAMICS
#define SMR_HAS_DYNAMICS 0
#else
#define SMR_HAS_DYNAMICS 1
#endif

#define SMR_MASS_LEAST 1.0e-6f  /* smallest mass of a vertex, g */
#define SMR_MASS_MOST 1.0e6f    /* largest mass of a vertex, g */
#define SMR_SPEED_MOST 1.0e6f   /* largest velocity along an axis, mm/s */
#define SMR_STORED_MOST 3.0e38f /* largest energy, uJ */
#define SMR_FARTHEST 1.0e6f     /* largest predicted coordinate, mm */

/* Energies of the last complete time step, uJ. */
typedef struct smr_stored_energy {
    float elastic, goals;
} smr_stored_energy;

/* Energies of a group of structures, uJ. ELASTIC and GOALS: springs at the end of a time step. BEFORE, AFTER:
 * kinetic energy at its start and at its end before damping; SPIN: the part of AFTER in the group's rotation. WORK:
 * of gravity and goals. PUSHED: number of moving pins. */
enum { SMR_ELASTIC, SMR_GOALS, SMR_BEFORE, SMR_AFTER, SMR_SPIN, SMR_WORK, SMR_PUSHED, SMR_STEP_ENERGIES };

/* Sums at the end of a time step. A group's sums are stored in its first structure. Groups without pinned vertices
 * also sum their rigid motion, since springs do not change their momentum. */
typedef struct smr_step_sums {
    float energy[SMR_STEP_ENERGIES];
    uint32_t fixed; /* 1: the group has pinned vertices, and its rigid motion is 0 */
    float mass;     /* mass of the group, g */
    /* means over the group: velocity at the start of the step, mm/s; displacement in the step, mm; position at its
     * end, mm */
    smr_vec speed, displacement, middle;
    smr_vec spin;            /* rotation of the group in the step about `middle`, radians */
    float share, spin_share; /* factors on velocities: on what is beside the rigid motion, and on the rotation */
    float n_pinned; /* pinned vertices of the structure itself; the next three fields also are the structure's own */
    /* of pinned vertices: centre, and their rigid motion off the reference shape, off + turn x (x - centre) */
    smr_vec centre, off, turn;
    float inertia[6]; /* inertia tensor of the group, or of the structure's pinned vertices */
} smr_step_sums;

typedef struct smr_dynamics {
    const smr_shared *shared;
    float step_s;  /* h: length of a time step, s */
    float springs; /* k h^2: elastic over inertial stiffness */
    smr_vec fall;  /* h^2 g: displacement by gravity in a time step, mm */
    float keeps;   /* factor that damping leaves of the velocities */
    uint32_t ends; /* 1: the iteration under way ends a time step. Written by dynamics_time_steps.c */
    float gram;    /* g: mass of a vertex is weight * members * gram */
    smr_stored_energy stored;
    uint32_t weighed; /* 1: masses were set since the last complete time step */
    /* [n_structures] number of the group's first structure; a group shares clusters at the current radius */
    uint32_t *group;
    float *bent; /* [n_structures] elastic energy as reported, uJ, in each group's first structure */
    /* [n_structures] energy that later steps may add, uJ, in each group's first structure: elastic energy, and what
     * steps took besides damping */
    float *spare;
    smr_step_sums *sums;        /* [n_structures] sums of each structure and group */
    uint32_t structure, vertex; /* position of the summation */
    float *begin;               /* [n][3] mm: positions at the start of the time step */
    float *velocity;            /* [n][3] mm/s at the start of the time step */
    float *mass;                /* [n] mass as set, g; 0: the vertex is pinned and keeps its velocity */
    float *members;             /* [n] |zeta|: cluster size at the current radius */
    float *weight;              /* [n] weight in the clusters' fits: a whole multiple of 1 / smr_shared.mass_unit */
} smr_dynamics;

void smr_dynamics_layout(smr_arena *a, smr_dynamics **dynamics, const smr_shared *shared);
void smr_dynamics_wire(smr_dynamics *d, const smr_shared *shared); /* sets masses to the model's */

/* Predicted position of vertex v at the end of the time step without springs: y = x + h v + h^2 g. */
static inline smr_vec smr_dynamics_free(const smr_dynamics *d, uint32_t v)
{
    const smr_vec displacement = smr_scale(smr_get3(d->velocity, v), d->step_s), x = smr_get3(d->begin, v);
    const smr_vec y = smr_add(smr_add(x, displacement), d->mass[v] > 0.0f ? d->fall : smr_v(0, 0, 0));
    return smr_v(smr_clamp(y.x, -SMR_FARTHEST, SMR_FARTHEST), smr_clamp(y.y, -SMR_FARTHEST, SMR_FARTHEST),
                 smr_clamp(y.z, -SMR_FARTHEST, SMR_FARTHEST));
}

/* The position x of vertex v after a sweep; at the end of a time step, y of the next one. The rest shape is fitted
 * to it, so that the clusters' fits see only what is left beside the rigid motion. */
static inline smr_vec smr_dynamics_ahead(const smr_dynamics *d, uint32_t v, smr_vec x)
{
    if (!d->ends)
        return x;
    if (!(d->mass[v] > 0.0f))
        return smr_add(x, smr_scale(smr_get3(d->velocity, v), d->step_s));
    const smr_vec displacement = smr_sub(x, smr_get3(d->begin, v));
    return smr_add(x, smr_add(smr_scale(displacement, d->keeps), d->fall));
}

/* The new position of vertex v in a sweep: the minimum of m/2h^2 |x - y|^2 + m k/2 |x - average|^2 + m k share/2 |x
 * - goal|^2. share: of the spring to the goal; pull: share * goal. */
static inline smr_vec smr_dynamics_next(const smr_dynamics *d, uint32_t v, smr_vec average, float share, smr_vec pull)
{
    const smr_vec y = smr_dynamics_free(d, v);
    if (!(d->mass[v] > 0.0f))
        return y;
    const smr_vec elastic = smr_scale(smr_add(average, pull), d->springs);
    return smr_scale(smr_add(y, elastic), 1.0f / (1.0f + d->springs * (1.0f + share)));
}

/* 1: the model has mass. */
static inline int smr_moves(const smr *s) { return SMR_HAS_DYNAMICS && s->shape.dynamics != NULL; }

/* ---- time steps, of SMR_SWEEPS iterations each ---- */

void smr_time_steps_start(smr *s); /* starts at rest; x becomes the rest shape */
void smr_time_steps_begin(smr *s); /* called before an iteration */
void smr_time_steps_next(smr *s);  /* called after an iteration */
void smr_time_steps_weigh(smr *s); /* called when masses are new: weights of the clusters' fits */

/* Mass of a vertex as the fits count it, g. 0: the vertex is pinned. */
static inline float smr_counted_mass(const smr_dynamics *d, uint32_t v)
{
    return d->mass[v] > 0.0f ? d->weight[v] * d->members[v] * d->gram : 0.0f;
}

/* The stored number of a structure's vertex i in the caller's order. */
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
uint32_t smr_step_energy_tasks(const void *s); /* 0 in iterations that do not end a time step */
void smr_step_energy(void *s, uint32_t task, uint32_t worker);

/* Called when that iteration is complete: velocities. `begin` becomes x. */
void smr_step_velocities(smr *s);

#endif
