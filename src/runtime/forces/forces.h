/* forces.h: external forces f^e = stiffness (goal - x) (paper 2.1). In: positions, normals, targets. Out: the force on
 * each vertex and what was found. Each source of goals has files and a struct of its own and is listed at the end.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_FORCES_H
#define SMR_FORCES_H

#include "runtime/forces/caller_goals.h"
#include "runtime/forces/contact.h"
#include "runtime/forces/image_goal.h"
#include "runtime/forces/point_spread.h"
#include "runtime/forces/smooth.h"
#include "runtime/forces/unseen_field.h"

/* What was found for a vertex. */
enum { SMR_FOUND_NO_TARGET = 0, SMR_FOUND_GOAL = 1, SMR_FOUND_NONE = 2, SMR_FOUND_UNDECIDED = 3 };

/* Sums over all vertices of the forces of an iteration. */
typedef struct smr_force_totals {
    uint32_t n_drawn;     /* active vertices with a target */
    uint32_t n_forces;    /* of them with a goal */
    uint32_t n_rejected;  /* of them without */
    float mean, rms, max; /* distance to the goal, mm */
    float largest[2];     /* of the two kinds of quantities that match/sums.c will sum */
} smr_force_totals;

typedef struct smr_forces {
    const smr_shared *shared;
    const smr_pace *pace;
    const smr_shape *shape;
    smr_surface_goals surface;
    smr_landmark_goals landmarks;
    smr_point_spread points;
    smr_unseen_field unseen;
    smr_image_goals image;
    smr_caller_goals caller;
    smr_smooth smooth;
    smr_contact contact;
    smr_tally *tally;
    float *force;        /* [n][3] mm; while goals are sought: the way to the goal */
    float *residual;     /* [n] distance to the goal, mm, where there is one */
    uint8_t *found;      /* [n] SMR_FOUND_..., of the forces under way */
    uint8_t *found_last; /* [n] the same, of the last complete forces */
    smr_force_totals totals;
    float matched;       /* as smr_tick_report.details.matched_share */
    uint32_t unmeasured; /* 1: no complete forces since a target, the image or positions were set */
} smr_forces;

void smr_forces_layout(smr_arena *a, smr_forces *f, const smr_shared *shared);
void smr_forces_wire(smr_forces *f, const smr_shared *shared, const smr_pace *pace, const smr_shape *shape,
                     const smr_overlay *overlay);
void smr_forces_reset(smr_forces *f);      /* an iteration is given up: nothing of its forces is left */
void smr_forces_unmeasured(smr_forces *f); /* what was measured was about other targets or positions */
/* Share of a structure's vertices with a goal when goals were last sought for it; -1: not with this target. */
float smr_forces_matched(const smr_forces *f, uint32_t structure);

uint32_t smr_force_chunk(const smr_forces *f); /* vertices of a task of smr_forces_search */
uint32_t smr_forces_tasks(const void *forces);
void smr_forces_search(void *forces, uint32_t task, uint32_t worker); /* ways to goals; the dearest step */
uint32_t smr_contact_tasks(const void *forces);
void smr_contact_search(void *forces, uint32_t task, uint32_t worker); /* what is touched, and what that adds */
uint32_t smr_forces_take_tasks(const void *forces);
void smr_forces_take(void *forces, uint32_t task, uint32_t worker); /* ways -> forces */
void smr_forces_end(smr_forces *f);                                 /* totals, and what the next forces start from */
void smr_forces_note_seen(smr_forces *f); /* what targets showed of each vertex, for landmarks between them */

/* A share of the last iteration's step (momentum; Polyak 1964). Valid until evolve writes x_next, which holds the
 * positions before x. */
static inline smr_vec smr_momentum(const smr_forces *f, uint32_t v)
{
    const smr_vec step = smr_sub(smr_load(smr_at3(f->shape->x, v)), smr_load(smr_at3(f->shape->x_next, v)));
    return smr_scale(step, f->pace->repairing > 0u ? 0.0f : f->pace->momentum * f->pace->ease);
}

/* The displacement that matching sees: x + f^e - x^r, and momentum. In dynamics forces act on the vertices, not on the
 * clusters' fits: x - x^r, or y - x^r when a time step starts. */
static inline smr_vec smr_drive(const smr_forces *f, uint32_t v)
{
    const smr_vec x = smr_load(smr_at3(f->shape->x, v));
    if (f->shape->dynamics != NULL)
        return smr_sub(smr_dynamics_from(f->shape->dynamics, f->pace, v, x), smr_load(smr_at3(f->shape->x_ref, v)));
    const smr_vec u = smr_sub(smr_add(x, smr_load(smr_at3(f->force, v))), smr_load(smr_at3(f->shape->x_ref, v)));
    return smr_add(u, smr_momentum(f, v));
}

/* ---- The sources of goals. A further one has its struct in smr_forces and its lines in what follows. ---- */

/* 1: every surface is still the one that was set. */
static inline int smr_inputs_stand(const smr_forces *f)
{
    return smr_targets_stand(&f->surface) && smr_fixed_stand(&f->contact);
}

static inline void smr_sources_layout(smr_arena *a, smr_forces *f, const smr_shared *shared)
{
    smr_surface_goals_layout(a, &f->surface, shared);
    smr_landmark_goals_layout(a, &f->landmarks, shared);
    smr_image_goals_layout(a, &f->image, shared);
    smr_caller_goals_layout(a, &f->caller, shared);
    smr_smooth_layout(a, &f->smooth, shared);
    smr_contact_layout(a, &f->contact, shared);
}

static inline void smr_sources_wire(smr_forces *f, const smr_overlay *overlay)
{
    smr_surface_goals_wire(&f->surface, f->shared, f->pace, f->shape);
    smr_landmark_goals_wire(&f->landmarks, f->shared, f->pace, f->shape);
    smr_point_spread_wire(&f->points, f->shared, f->shape, &f->surface, overlay);
    smr_unseen_field_wire(&f->unseen, f->shared, f->pace, f->shape, &f->surface, &f->landmarks, overlay);
    smr_unseen_field_watch(&f->unseen, f->found_last, &f->image.has_image);
    smr_image_goals_wire(&f->image, f->shared, f->pace, f->shape, f->found_last, &overlay->rings);
    smr_caller_goals_wire(&f->caller, f->shared, f->pace, f->shape);
    smr_smooth_wire(&f->smooth, f->shared, f->pace, f->shape, &overlay->rings);
    smr_contact_wire(&f->contact, f->shared, f->pace, f->shape);
}

static inline void smr_sources_reset(smr_forces *f)
{
    smr_surface_goals_reset(&f->surface);
    smr_landmark_goals_reset(&f->landmarks);
    smr_image_goals_reset(&f->image);
    f->caller.summed = 0;
    smr_contact_reset(&f->contact);
}

/* The forces under way are complete: the next ones start from them. */
static inline void smr_sources_stand(smr_forces *f)
{
    smr_image_goals_stand(&f->image);
    smr_caller_goals_stand(&f->caller);
    smr_surface_goals_stand(&f->surface);
    smr_landmark_goals_stand(&f->landmarks);
    smr_contact_stand(&f->contact);
    if (f->landmarks.n > 0u)
        smr_forces_note_seen(f);
}

/* What a source asks for before the search for goals, as steps of the tick: SMR_STEP(member, work, order, n_tasks, run,
 * pieces, abreast). */
#define SMR_SOURCE_STEPS(SMR_STEP)                                                                                     \
    SMR_STEP(caller, SMR_WORK_TASKS, SMR_ANY_ORDER, smr_caller_tasks, smr_caller_ask, NULL, NULL)                      \
    SMR_STEP(surface, SMR_WORK_TASKS, SMR_ANY_ORDER, smr_attract_tasks, smr_attract_search, NULL, NULL)                \
    SMR_STEP(points, SMR_WORK_TASKS, SMR_SERIAL, smr_point_spread_tasks, smr_point_spread_run, NULL, NULL)             \
    SMR_STEP(unseen, SMR_WORK_TASKS, SMR_SERIAL, smr_unseen_field_tasks, smr_unseen_field_solve, NULL, NULL)           \
    SMR_STEP(image, SMR_WORK_TASKS, SMR_ANY_ORDER, smr_fill_tasks, smr_fill_sum, smr_fill_pieces, smr_fill_abreast)

/* Nothing draws v. What pulls it must not wait for the next iteration. */
static inline void smr_sources_drop(smr_forces *f, uint32_t v)
{
    smr_vec way;
    if (smr_attraction_on(&f->surface))
        (void)smr_pull_take(&f->surface, v, &way);
}

/* Weight of goals in the image beside those on a surface. */
static inline float smr_weight_beside(const smr_forces *f, int rest)
{
    const int looks = f->image.has_image && !smr_field_of_past(&f->unseen);
    return rest ? 1.0f : looks ? f->shared->config.image.beside * f->pace->ease : 0.0f;
}

/* The way to a goal on the surface, to one in the image beside it, and of what neither shows. Of a part goals on the
 * surface weigh as far as it shows the vertex. */
static inline uint8_t smr_goal_on_surface(smr_forces *f, uint32_t v, const smr_target *drawn, smr_vec *way)
{
    const int found = smr_surface_goal(&f->surface, v, drawn->surface, way), rest = smr_field_of_rest(&f->unseen, v);
    const int goal = drawn->partial ? f->surface.seen_next[v] > 0u : found;
    const float beside = smr_weight_beside(f, rest);
    float weight = rest ? (float)f->surface.seen_next[v] * (1.0f / (float)SMR_SEEN_ONE) : (float)goal;
    smr_vec own;
    const int in_image = beside > 0.0f && smr_image_goal(&f->image, v, &own) == SMR_GOAL;
    if (!(rest && in_image) && (drawn->partial || f->landmarks.n > 0u))
        smr_unseen_field_blend(&f->unseen, v, found, way);
    if (in_image)
        smr_blend(way, &weight, own, beside);
    if (rest && in_image)
        smr_unseen_field_prevail(&f->unseen, v, way);
    return weight > 0.0f ? SMR_FOUND_GOAL : SMR_FOUND_NONE;
}

/* The image is of the past: its goals were found, and go along with what else is followed. */
static inline uint8_t smr_goal_of_past(smr_forces *f, uint32_t v, smr_vec *way)
{
    smr_image_keep(&f->image, v);
    *way = smr_unseen_field_way(&f->unseen, v);
    return f->found_last[v] == SMR_FOUND_NO_TARGET ? SMR_FOUND_UNDECIDED : f->found_last[v];
}

/* The way to a goal in the image, and what fills in. Where the search has ended its goals are kept. */
static inline uint8_t smr_goal_in_image(smr_forces *f, uint32_t v, smr_vec *way)
{
    if (smr_field_of_past(&f->unseen))
        return smr_goal_of_past(f, v, way);
    int seen = smr_image_goal(&f->image, v, way);
    if (smr_field_of_image(&f->unseen))
        seen = smr_unseen_field_steady(&f->unseen, v, seen, way);
    else if (seen == SMR_NO_GOAL)
        *way = smr_fill_way(&f->image, v);
    if (f->landmarks.n == 0u)
        return seen == SMR_GOAL ? SMR_FOUND_GOAL : seen == SMR_UNDECIDED ? SMR_FOUND_UNDECIDED : SMR_FOUND_NONE;
    const int kept = !smr_image_seeks(&f->image, smr_model_owner(f->shared->model, v)) && f->landmarks.seen[v] > 0u;
    if (seen == SMR_GOAL || kept)
        smr_unseen_field_prevail(&f->unseen, v, way);
    else
        smr_unseen_field_fill(&f->unseen, v, way);
    return seen == SMR_GOAL ? SMR_FOUND_GOAL : seen == SMR_UNDECIDED ? SMR_FOUND_UNDECIDED : SMR_FOUND_NONE;
}

/* Without a target of its own a vertex follows landmarks, where there are any. */
static inline uint8_t smr_goal_of_landmarks(smr_forces *f, uint32_t v, smr_vec *way)
{
    smr_sources_drop(f, v);
    if (f->landmarks.n == 0u)
        return SMR_FOUND_NO_TARGET;
    smr_unseen_field_fill(&f->unseen, v, way);
    return smr_landmark_binds(&f->landmarks, v) ? SMR_FOUND_GOAL : SMR_FOUND_NONE;
}

/* The way to the vertex' goal on a target, mm; 0 for none. A structure with a target surface follows it, every other
 * one the image. A vertex without triangles lies on no surface and follows neither. Returns SMR_FOUND_... */
static inline uint8_t smr_goal_on_target(smr_forces *f, uint32_t v, smr_vec *way)
{
    const smr_target *drawn = &f->surface.target[smr_model_owner(f->shared->model, v)];
    *way = smr_v(0, 0, 0);
    /* nothing may stay from forces that started again after a surface came or went */
    smr_image_forget(&f->image, v);
    if (f->surface.seen_next != NULL)
        f->surface.seen_next[v] = 0;
    if (drawn->surface == NULL && !f->image.has_image)
        return smr_goal_of_landmarks(f, v, way);
    if (!f->shape->on_surface[v]) {
        smr_sources_drop(f, v);
        return SMR_FOUND_NO_TARGET;
    }
    return drawn->surface != NULL ? smr_goal_on_surface(f, v, drawn, way) : smr_goal_in_image(f, v, way);
}

/* The same of all sources: ways to goals are averaged by weight, and one on a target weighs 1. */
static inline uint8_t smr_sources_goal(smr_forces *f, uint32_t v, smr_vec *way)
{
    const uint8_t found = smr_goal_on_target(f, v, way);
    const float weight = found == SMR_FOUND_GOAL ? 1.0f : 0.0f;
    return smr_caller_blend(&f->caller, v, way, weight) > weight ? SMR_FOUND_GOAL : found;
}

#endif
