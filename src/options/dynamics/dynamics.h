/* dynamics.h: capability: a model that has mass and moves in time. In: smr_set_motion(), positions, average goals. Out:
 * the positions at which sweeps start and end, weights of the clusters' fits, velocities and energies.
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
#define SMR_STORED_MOST 3.0e38f /* largest energy in a save, uJ */
#define SMR_FARTHEST 1.0e6f     /* largest coordinate of a predicted position, mm */

/* Energies of the last complete time step, uJ. */
typedef struct smr_stored_energy {
    float elastic, goals;
} smr_stored_energy;

/* Energies of a group in a time step, uJ. ELASTIC, GOALS: springs at the end. BEFORE, AFTER: kinetic, at the start, and
 * undamped at the end. SPIN: part of AFTER in rotation. WORK: of gravity and goals. PUSHED: number of moving pins. */
enum { SMR_ELASTIC, SMR_GOALS, SMR_BEFORE, SMR_AFTER, SMR_SPIN, SMR_WORK, SMR_PUSHED, SMR_STEP_ENERGIES };

/* Sums of a time step; a group's are in its first structure. Groups without pinned vertices also sum rigid motion. */
typedef struct smr_step_sums {
    float energy[SMR_STEP_ENERGIES];
    uint32_t fixed;          /* 1: the group has pinned vertices, and its rigid motion is 0 */
    float mass;              /* mass of the group, g */
    smr_vec speed;           /* mean velocity of the group at the start of the step, mm/s */
    smr_vec displacement;    /* mean displacement of the group in the step, mm */
    smr_vec middle;          /* mean position of the group at the end of the step, mm */
    smr_vec spin;            /* rotation of the group in the step about `middle`, radians */
    float share, spin_share; /* factors on velocities at the step's end: on motion besides rigid motion; on rotation */
    float n_pinned;          /* number of pinned vertices of the structure itself */
    smr_vec centre;          /* centre of the structure's pinned vertices, mm */
    smr_vec off, turn; /* rigid motion of pinned vertices off the reference shape: off + turn x (x - centre), mm */
    float inertia[6];  /* inertia tensor of the group, or of the structure's pinned vertices */
} smr_step_sums;

typedef struct smr_dynamics {
    const smr_shared *shared;
    float step_s;  /* h: length of a time step, s */
    float keeps;   /* 1 / (1 + h c), with c the damping: factor of damping on velocities in a time step */
    float springs; /* keeps k h^2: ratio of elastic to inertial stiffness */
    smr_vec fall;  /* keeps h^2 g, with g the gravity: displacement by gravity in a time step, mm */
    uint32_t ends; /* 1: the current iteration ends a time step */
    float gram;    /* unit of weights, g: the mass of a vertex is weight * members * gram */
    smr_stored_energy stored;
    uint32_t weighed;    /* 1: masses were set since the last complete time step */
    uint32_t *group;     /* [n_structures] first structure of the group, whose structures share clusters */
    float *bent;         /* [n_structures] reported elastic energy, uJ, in each group's first structure */
    float *spare;        /* [n_structures] energy that later steps may add, uJ, in each group's first structure */
    smr_step_sums *sums; /* [n_structures] sums of each structure and group */
    uint32_t structure, vertex; /* next vertex of the summation, in the caller's order */
    float *begin;               /* [n][3] positions at the start of the time step, mm */
    float *velocity;            /* [n][3] velocities at the start of the time step, mm/s */
    float *mass;                /* [n] mass as set, g; 0: the vertex is pinned and keeps its velocity */
    float *members;             /* [n] number of members of each vertex' cluster, |zeta|, at the current radius */
    float *weight;              /* [n] weight in the clusters' fits: a whole multiple of 1 / smr_shared.mass_unit */
} smr_dynamics;

void smr_dynamics_layout(smr_arena *a, smr_dynamics **dynamics, const smr_shared *shared);
void smr_dynamics_wire(smr_dynamics *d, const smr_shared *shared); /* takes settings, and masses of the model */

/* The vector with each coordinate limited to -most .. most. */
static inline smr_vec smr_clamped(smr_vec a, float most)
{
    return smr_v(smr_clamp(a.x, -most, most), smr_clamp(a.y, -most, most), smr_clamp(a.z, -most, most));
}

/* The damped velocity of vertex v, mm/s. Pinned vertices are not damped. */
static inline smr_vec smr_dynamics_speed(const smr_dynamics *d, uint32_t v)
{
    return smr_scale(smr_get3(d->velocity, v), d->mass[v] > 0.0f ? d->keeps : 1.0f);
}

/* Predicted position of vertex v at the end of the time step without springs, mm: y = x + keeps (h v + h^2 g). */
static inline smr_vec smr_dynamics_free(const smr_dynamics *d, uint32_t v)
{
    const smr_vec displacement = smr_scale(smr_dynamics_speed(d, v), d->step_s), x = smr_get3(d->begin, v);
    return smr_clamped(smr_add(smr_add(x, displacement), d->mass[v] > 0.0f ? d->fall : smr_v(0, 0, 0)), SMR_FARTHEST);
}

/* The position to which the rest shape is fitted at vertex v after a sweep, so that clusters fit only motion besides
 * the rigid one: x; at the end of a time step, y of the next one. */
static inline smr_vec smr_dynamics_ahead(const smr_dynamics *d, uint32_t v, smr_vec x)
{
    if (!d->ends)
        return x;
    if (!(d->mass[v] > 0.0f))
        return smr_add(x, smr_scale(smr_get3(d->velocity, v), d->step_s));
    const smr_vec displacement = smr_sub(x, smr_get3(d->begin, v));
    return smr_add(x, smr_add(smr_scale(displacement, d->keeps), d->fall));
}

/* The new position of vertex v in a sweep, mm: minimises m/2h^2 |x - y|^2 + m k/2 |x - average|^2 + m k share/2 |x -
 * goal|^2, with m / keeps for m. share: stiffness of the spring to the goal divided by k; pull: share * goal. */
static inline smr_vec smr_dynamics_next(const smr_dynamics *d, uint32_t v, smr_vec average, float share, smr_vec pull)
{
    const smr_vec y = smr_dynamics_free(d, v);
    if (!(d->mass[v] > 0.0f))
        return y;
    const smr_vec elastic = smr_scale(smr_add(average, pull), d->springs);
    return smr_scale(smr_add(y, elastic), 1.0f / (1.0f + d->springs * (1.0f + share)));
}

/* Returns 1 when the model moves in time. */
static inline int smr_moves(const smr *s) { return SMR_HAS_DYNAMICS && s->shape.dynamics != NULL; }

/* ---- time steps, of SMR_SWEEPS iterations each ---- */

void smr_time_steps_start(smr *s); /* starts at rest; x becomes the rest shape */
void smr_time_steps_begin(smr *s); /* before an iteration: decides whether it ends a time step */
void smr_time_steps_next(smr *s);  /* call after each iteration: moves x^r; a time step's last one sets velocities */
void smr_time_steps_weigh(smr *s); /* called for new masses: computes weights of fits */

/* Returns the mass of a vertex that its rounded weight in the fits stands for, g. 0: the vertex is pinned. */
static inline float smr_counted_mass(const smr_dynamics *d, uint32_t v)
{
    return d->mass[v] > 0.0f ? d->weight[v] * d->members[v] * d->gram : 0.0f;
}

/* Steps: set the positions at which a sweep starts, before forces; move vertices from average goals to its result. */
smr_count_tasks smr_sweep_tasks;
smr_run_task smr_sweep_begin, smr_sweep_end;

/* Step in iterations that end a time step: sums energies. Tasks run one after the other. */
smr_count_tasks smr_step_energy_tasks;
smr_run_task smr_step_energy;
void smr_step_velocities(smr *s); /* called when the time step is complete: computes velocities; `begin` becomes x */

#endif
