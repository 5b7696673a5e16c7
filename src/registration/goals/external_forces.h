/* external_forces.h: external forces f^e = stiffness (goal - x) (paper 2.1). In: positions, normals, targets. Out: for
 * each vertex the force and the result of the search. Each source of goals has its own file and struct.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_EXTERNAL_FORCES_H
#define SMR_EXTERNAL_FORCES_H

#include "options/contact/contact.h"
#include "options/image/image.h"
#include "options/partial/partial.h"
#include "registration/goals/caller_goals.h"

/* Counts and distances of one iteration's forces, over all vertices. */
typedef struct smr_force_totals {
    uint32_t n_with_target; /* number of active vertices with a target */
    uint32_t n_forces;      /* number of active vertices with a goal */
    uint32_t n_rejected;    /* number of active vertices with a target but without a goal */
    uint32_t n_residuals;   /* number of active vertices with a goal and a residual */
    float goal_mean;        /* mean distance to the goal over all active vertices with a goal, mm */
    float mean, rms, max;   /* mean, root mean square and largest of the n_residuals residuals, mm */
    float largest[2];       /* largest term of a vertex in cluster sums: mass times displacement; that times position */
} smr_force_totals;

typedef struct smr_forces {
    const smr_shared *shared;
    const smr_schedule *schedule;
    const smr_shape *shape;
    smr_surface_goals surface;
    smr_landmark_goals landmarks;
    smr_point_spread points;
    smr_occluded_field occluded;
    smr_image_goals image;
    smr_caller_goals caller;
    smr_smooth smooth;
    smr_contact contact;
    smr_tally *tally;
    float *force;        /* [n][3] force, mm; during the search: displacement to the goal, mm */
    float *residual;     /* [n] distance of a vertex to its target mesh, or to its goal, mm; -1: half visible or less */
    uint8_t *found;      /* [n] SMR_FOUND_...: result of each vertex' search in the current forces */
    uint8_t *found_last; /* [n] SMR_FOUND_...: result of each vertex' search in the last complete forces, ... */
    uint32_t n_kept;     /* ... of the first vertices; of others found[] has it while results are stored */
    smr_force_totals totals;
    float matched;       /* share of searched vertices that have a goal; -1: no vertex was searched */
    uint32_t unmeasured; /* 1: no forces were completed since a target, the image or positions were set */
} smr_forces;

void smr_forces_layout(smr_arena *a, smr_forces *f, const smr_shared *shared);
/* discards the results of the forces of an abandoned iteration, in part `part` of `parts` */
void smr_forces_reset(smr_forces *f, uint32_t part, uint32_t parts);
void smr_forces_unmeasured(smr_forces *f); /* marks all measured values as outdated: targets or positions are new */
/* Returns the share of a structure's searched vertices that have a goal; -1: not yet searched on this target. */
float smr_forces_matched(const smr_forces *f, uint32_t structure);

uint32_t smr_force_chunk(const smr_forces *f); /* number of vertices in a task of smr_forces_search */
/* Returns the factor on the force of v, 0..1, which falls at the end for image goals, except near hard landmarks. */
float smr_forces_ease(const smr_forces *f, uint32_t v);

/* Steps: displacements to goals; contacts, and the displacements that end penetration; forces from displacements. */
smr_count_tasks smr_forces_tasks, smr_contact_tasks, smr_forces_take_tasks;
smr_run_task smr_forces_search, smr_contact_search, smr_forces_take;
void smr_forces_end(smr_forces *f); /* sums up the forces */

/* Returns the momentum, mm, a share of the last displacement (Polyak 1964), until evolve overwrites x_next. */
static inline smr_vec smr_momentum(const smr_forces *f, uint32_t v)
{
    const smr_vec step = smr_sub(smr_get3(f->shape->x, v), smr_get3(f->shape->x_next, v));
    const int still = f->schedule->repairing > 0u || f->schedule->repaired == SMR_REPAIRED; /* a repair gives none */
    return smr_scale(step, still ? 0.0f : f->schedule->momentum * f->schedule->fade);
}

/* Returns the displacement from x^r that the match fits, mm: x + f^e - x^r plus momentum; in dynamics `from` - x^r. */
static inline smr_vec smr_match_displacement(const smr_forces *f, uint32_t v)
{
    const smr_vec x = smr_get3(f->shape->x, v);
    if (f->shape->from != NULL)
        return smr_sub(smr_get3(f->shape->from, v), smr_get3(f->shape->x_ref, v));
    const smr_vec u = smr_sub(smr_add(x, smr_get3(f->force, v)), smr_get3(f->shape->x_ref, v));
    return smr_add(u, smr_momentum(f, v));
}

/* goal_priority.c: the sources of goals. A further source has its struct in smr_forces and its lines in that file. */
/* Checks that no target or fixed surface has changed since it was set. Errors: E_STATE; E_DAMAGED (by a fault). */
smr_status smr_inputs_valid(const smr_forces *f);
void smr_sources_layout(smr_arena *a, smr_forces *f, const smr_shared *shared);
void smr_sources_reset(smr_forces *f, uint32_t part, uint32_t parts);
void smr_sources_commit(smr_forces *f); /* stores what complete forces found of all sources of goals */
/* Step after complete forces: stores the results of vertices and landmarks for the next forces. New targets must not
 * come between its tasks: smr_forces_settle() completes them first. Tasks run one after the other. */
smr_count_tasks smr_sources_keep_tasks;
smr_run_task smr_sources_keep;
/* Return the result of the last complete forces, SMR_FOUND_..., and visibility by them, 0..SMR_VISIBLE_ONE. */
static inline uint8_t smr_found(const smr_forces *f, uint32_t v)
{
    return (v < f->n_kept ? f->found_last : f->found)[v];
}
uint8_t smr_visibility_not_kept(const smr_forces *f, uint32_t v);
static inline uint8_t smr_visibility_found(const smr_forces *f, uint32_t v)
{
    return v < f->n_kept ? f->surface.visibility[v] : smr_visibility_not_kept(f, v);
}
void smr_sources_drop(smr_forces *f, uint32_t v); /* sets the target's pulls on v to 0 */

/* Finds v's displacement to its goal, mm, the weighted mean of all sources. *residual: distance to the closest point
 * on a target mesh, mm; -1: v is at most half visible; unchanged without such a point. Returns SMR_FOUND_..., which
 * does not count when pause->kept: the search stopped, and the same call continues. */
uint8_t smr_sources_goal(smr_forces *f, uint32_t v, smr_pause *pause, smr_vec *displacement, float *residual);

#endif
