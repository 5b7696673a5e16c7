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
#define SMR_STORED_MOST 3.0e38f /* largest stored energy, uJ */
#define SMR_FARTHEST 1.0e6f     /* largest absolute coordinate of a predicted position, mm */

/* Energies stored at the end of the last complete time step, uJ: elastic energy; energy of the springs to goals. */
typedef struct smr_stored_energy {
    float elastic, goals;
} smr_stored_energy;

/* Energies of a group in a time step, uJ. ELASTIC, GOALS: springs at the end. BEFORE, AFTER: kinetic, at the start, and
 * undamped at the end. SPIN: part of AFTER in rotation. WORK: of gravity and goals. PUSHED: number of moving pins. */
enum { SMR_ELASTIC, SMR_GOALS, SMR_BEFORE, SMR_AFTER, SMR_SPIN, SMR_WORK, SMR_PUSHED, SMR_STEP_ENERGIES };

/* Sums of a time step for a structure; for a group (structures that share clusters), in its first structure. */
typedef struct smr_step_sums {
    float energy[SMR_STEP_ENERGIES];
    uint32_t fixed;          /* 1: the group has pinned vertices, and the group's rigid motion counts as 0 */
    float mass;              /* mass of the group's vertices, g */
    smr_vec speed;           /* mean velocity of the group at the start of the step, mm/s */
    smr_vec displacement;    /* mean displacement of the group in the step, mm */
    smr_vec middle;          /* mean position of the group at the end of the step, mm */
    smr_vec spin;            /* rotation of the group in the step about `middle`, radians */
    float share, spin_share; /* factors on velocities at the step's end: non-rigid motion; rotation */
    float n_pinned;          /* number of pinned vertices of the structure */
    smr_vec centre;          /* centre of the structure's pinned vertices, mm */
    smr_vec off, turn;       /* pinned vertices minus reference shape, mm: about off + turn x (x - centre) */
    float inertia[6];        /* inertia tensor of the group, g mm^2; of pinned vertices with mass 1 */
} smr_step_sums;

typedef struct smr_dynamics {
    float step_s;      /* h: length of a time step, s */
    float keeps;       /* 1 / (1 + h c): factor by which the damping c scales velocities in a time step */
    float springs;     /* keeps * k h^2: elastic stiffness k, damped / inertial stiffness 1 / h^2 */
    smr_vec fall;      /* keeps * h^2 g: displacement by the gravity g in a time step, mm */
    uint32_t ends;     /* 1: the current iteration ends a time step */
    float gram;        /* grams in a unit of weight: mass of a vertex = weight * members * gram */
    uint32_t n_pinned; /* number of pinned vertices */
    smr_stored_energy stored;
    uint32_t weighed;    /* 1: the caller has set masses since the last complete time step */
    uint32_t *group;     /* [n_structures] first structure of each structure's group, which shares clusters */
    float *bent;         /* [n_structures] reported elastic energy of a group, uJ, in its first structure */
    float *spare;        /* [n_structures] energy that later steps may add to a group, uJ, in its first structure */
    smr_step_sums *sums; /* [n_structures] sums of a time step for each structure and group */
    uint32_t structure, vertex; /* next structure of the summation, and next vertex of this structure */
    float *begin;               /* [n][3] positions at the start of the time step, mm */
    float *velocity;            /* [n][3] velocities at the start of the time step, mm/s */
    float *mass;                /* [n] mass of each vertex as set, g; 0: pinned, moves at its set velocity */
    float *members;             /* [n] number of members of each vertex' cluster at the current radius */
    float *weight;              /* [n] weight of each vertex in fits: multiple of 1 / smr_shared.mass_unit */
} smr_dynamics;

void smr_dynamics_layout(smr_arena *a, smr_dynamics **dynamics, const smr_shared *shared);
void smr_dynamics_wire(smr_dynamics *d, const smr_shared *shared); /* takes settings */

/* Returns the vector a with each coordinate limited to -most .. most. */
static inline smr_vec smr_clamped(smr_vec a, float most)
{
    return smr_v(smr_clamp(a.x, -most, most), smr_clamp(a.y, -most, most), smr_clamp(a.z, -most, most));
}

/* Returns the velocity of vertex v after a time step's damping, mm/s. Pinned vertices are not damped. */
static inline smr_vec smr_dynamics_speed(const smr_dynamics *d, uint32_t v)
{
    return smr_scale(smr_get3(d->velocity, v), d->mass[v] > 0.0f ? d->keeps : 1.0f);
}

/* Returns the position of vertex v at the end of the time step without springs, mm: y = x + keeps (h v + h^2 g). */
smr_vec smr_dynamics_free(const smr_dynamics *d, uint32_t v);

/* Returns where the rest shape is fitted at vertex v after a sweep, mm, so that clusters fit only motion besides
 * the rigid one: the position x; at the end of a time step, the prediction y for the next one. */
static inline smr_vec smr_dynamics_ahead(const smr_dynamics *d, uint32_t v, smr_vec x)
{
    if (!d->ends)
        return x;
    if (!(d->mass[v] > 0.0f))
        return smr_add(x, smr_scale(smr_get3(d->velocity, v), d->step_s));
    const smr_vec displacement = smr_sub(x, smr_get3(d->begin, v));
    return smr_add(x, smr_add(smr_scale(displacement, d->keeps), d->fall));
}

/* Returns the position x of v after a sweep, mm: minimises m/2h^2 |x - y|^2 + m k/2 |x - average|^2 + m k share/2 |x -
 * goal|^2, with m / keeps for m. share: stiffness of the spring to the goal divided by k; pull: share * goal. */
static inline smr_vec smr_dynamics_next(const smr_dynamics *d, uint32_t v, smr_vec average, float share, smr_vec pull)
{
    const smr_vec y = smr_dynamics_free(d, v);
    if (!(d->mass[v] > 0.0f))
        return y;
    const smr_vec elastic = smr_scale(smr_add(average, pull), d->springs);
    return smr_scale(smr_add(y, elastic), 1.0f / (1.0f + d->springs * (1.0f + share)));
}

/* Returns 1 when dynamics are on: the model has mass and moves in time. */
static inline int smr_moves(const smr *s) { return SMR_HAS_DYNAMICS && s->shape.dynamics != NULL; }

/* ---- time steps, of SMR_SWEEPS iterations each ---- */

void smr_time_steps_start(smr *s);             /* starts time steps at velocity 0, after smr_time_steps_copy() */
void smr_time_steps_copy(smr *s, smr_piece p); /* a piece of the present positions becomes the rest shape */
void smr_time_steps_begin(smr *s); /* before an iteration: sets `ends`, 1 when the iteration ends a time step */
void smr_time_steps_next(smr *s);  /* after each iteration: moves the rest shape; sets velocities when a step ends */

/* Returns the mass of vertex v that v's rounded weight in fits stands for, g. 0: the vertex is pinned. */
static inline float smr_counted_mass(const smr_dynamics *d, uint32_t v)
{
    return d->mass[v] > 0.0f ? d->weight[v] * d->members[v] * d->gram : 0.0f;
}

/* Steps of an iteration: set positions at which a sweep starts, before forces; move x_next to the sweep's result. */
smr_count_tasks smr_sweep_tasks;
smr_run_task smr_sweep_begin, smr_sweep_end;

/* Number of members of each vertex' cluster, vertices near the boundary in part, and groups of structures that share
 * clusters, directly or through others, named by their first structure: sums over clusters of records whose word k is
 * not 0 for vertices of structure + k, k < SMR_WORDS; in turn for each SMR_WORDS structures. */
void smr_members_begin(smr *s);
void smr_members_mark(smr *s, uint32_t structure, smr_piece p); /* writes records */
void smr_members_add(smr *s, uint32_t structure, smr_piece p);  /* takes sums */

/* Weights of fits, from masses and members; pieces in order, the first behind the last of the other. A pinned vertex
 * outweighs the rest of its cluster, which turns about it. */
void smr_weights_add(smr *s, smr_piece p); /* finds the mean of mass / members, and the number of pinned vertices */
void smr_weights_set(smr *s, smr_piece p);

/* Step of iterations that end a time step: sums momenta and energies. Tasks run one after the other. */
smr_count_tasks smr_step_energy_tasks;
smr_run_task smr_step_energy;
void smr_step_velocities(smr *s); /* when a time step ends: computes velocities; sets `begin` to x */

#endif
