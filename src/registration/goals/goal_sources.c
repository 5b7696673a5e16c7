/* goal_sources.c: which target wins at a vertex. A structure with a target surface follows it, every other one the
 * image, and what neither shows a smooth field; goals of the caller's own are averaged with that by weight.
 * Bounds: those of the sources.
 * SPDX-License-Identifier: MIT */
#include "registration/goals/forces.h"

void smr_caller_goals_layout(smr_arena *a, smr_caller_goals *g, const smr_shared *shared)
{
    if (shared->config.caller.goals != 0u)
        g->goals = smr_slot_scratch(a, g->goals, shared->n_structures, sizeof *g->goals); /* set again: waiting.c */
    if (shared->config.caller.force != SMR_CALLER_OFF)
        g->gave = smr_slot_scratch(a, g->gave, shared->n, 4u * sizeof(float));
}

void smr_caller_goals_wire(smr_caller_goals *g, const smr_shared *shared, const smr_pace *pace, const smr_shape *shape)
{
    g->shared = shared;
    g->pace = pace;
    g->shape = shape;
    if (g->goals != NULL)
        memset(g->goals, 0, shared->n_structures * sizeof *g->goals);
}

int smr_inputs_stand(const smr_forces *f)
{
    return smr_targets_stand(&f->surface) && (!SMR_HAS_CONTACT || smr_fixed_stand(&f->contact));
}

void smr_sources_layout(smr_arena *a, smr_forces *f, const smr_shared *shared)
{
    smr_surface_goals_layout(a, &f->surface, shared);
    if (SMR_HAS_PARTIAL)
        smr_landmark_goals_layout(a, &f->landmarks, shared);
    if (SMR_HAS_IMAGE)
        smr_image_goals_layout(a, &f->image, shared);
    smr_caller_goals_layout(a, &f->caller, shared);
    if (SMR_HAS_CONTACT) {
        smr_smooth_layout(a, &f->smooth, shared);
        smr_contact_layout(a, &f->contact, shared);
    }
}

void smr_sources_wire(smr_forces *f, const smr_overlay *overlay)
{
    smr_surface_goals_wire(&f->surface, f->shared, f->pace, f->shape);
    if (SMR_HAS_PARTIAL) {
        smr_landmark_goals_wire(&f->landmarks, f->shared, f->pace, f->shape);
        smr_point_spread_wire(&f->points, f->shared, f->shape, &f->surface, overlay);
        smr_unseen_field_wire(&f->unseen, f->shared, f->pace, f->shape, &f->surface, &f->landmarks, overlay);
        smr_unseen_field_watch(&f->unseen, f->found_last, &f->image.has_image);
    }
    if (SMR_HAS_IMAGE)
        smr_image_goals_wire(&f->image, f->shared, f->pace, f->shape, f->found_last, &overlay->rings);
    smr_caller_goals_wire(&f->caller, f->shared, f->pace, f->shape);
    if (SMR_HAS_CONTACT) {
        smr_smooth_wire(&f->smooth, f->shared, f->pace, f->shape, &overlay->rings);
        smr_contact_wire(&f->contact, f->shared, f->pace, f->shape);
    }
}

void smr_sources_reset(smr_forces *f)
{
    smr_surface_goals_reset(&f->surface);
    if (SMR_HAS_PARTIAL)
        smr_landmark_goals_reset(&f->landmarks);
    if (SMR_HAS_IMAGE)
        smr_image_goals_reset(&f->image);
    f->caller.summed = 0;
    if (SMR_HAS_CONTACT)
        smr_contact_reset(&f->contact);
}

/* What targets showed of each vertex, for landmarks between them. */
static void note_visible(smr_forces *f)
{
    for (uint32_t v = 0; v < f->pace->n_active; v++) {
        const uint32_t owner = smr_model_owner(f->shared->model, v);
        const smr_target *target = &f->surface.target[owner];
        const uint8_t found = f->found_last[v] == SMR_FOUND_GOAL ? SMR_SEEN_ONE : 0u;
        if (target->surface != NULL)
            f->landmarks.seen[v] = target->partial ? f->surface.seen[v] : found;
        else if (!smr_image_on(&f->image))
            f->landmarks.seen[v] = 0;
        else if (smr_image_seeks(&f->image, owner))
            f->landmarks.seen[v] = found;
    }
}

void smr_sources_stand(smr_forces *f)
{
    if (smr_image_on(&f->image))
        smr_image_goals_stand(&f->image);
    smr_caller_stand(&f->caller);
    smr_surface_goals_stand(&f->surface);
    if (smr_visibility_on(&f->surface))
        smr_overlap_stand(&f->surface);
    if (smr_landmarks_on(&f->landmarks)) {
        smr_landmark_goals_stand(&f->landmarks);
        note_visible(f);
    }
    if (smr_contact_used(&f->contact))
        smr_contact_stand(&f->contact);
}

void smr_sources_drop(smr_forces *f, uint32_t v)
{
    smr_vec way;
    if (smr_attraction_on(&f->surface))
        (void)smr_pull_take(&f->surface, v, &way);
}

/* Weight of goals in the image beside those on a surface. rest: the image shows what the surface does not. */
static float weight_beside(const smr_forces *f, int rest)
{
    const int looks = smr_image_on(&f->image) && !smr_field_of_past(&f->unseen);
    return rest ? 1.0f : looks ? f->shared->config.image.beside * f->pace->ease : 0.0f;
}

/* The way to a goal on a mesh or a cloud, and how far the target shows the vertex. */
static int goal_on_target(smr_forces *f, uint32_t v, const smr_target *drawn, smr_vec *way)
{
    smr_surface_goals *g = &f->surface;
    smr_surface_find find;
    if (smr_is_points(drawn->surface))
        return smr_point_goal(g, v, way);
    const int found = smr_surface_goal(g, v, drawn->surface, way, &find);
    if (SMR_HAS_PARTIAL && find.hit.triangle != SMR_NONE && smr_overlap_judged(g, smr_model_owner(f->shared->model, v)))
        smr_overlap_judge(g, v, drawn->surface, &find.hit, find.way);
    return found;
}

/* The way to a goal on the surface, to one in the image beside it, and of what neither shows. Of a part goals on the
 * surface weigh as far as it shows the vertex. */
static uint8_t goal_on_surface(smr_forces *f, uint32_t v, const smr_target *drawn, smr_vec *way)
{
    const int found = goal_on_target(f, v, drawn, way), rest = smr_field_of_rest(&f->unseen, v);
    const int partial = smr_shows_part(drawn), landmarks = smr_landmarks_on(&f->landmarks);
    const int goal = partial ? f->surface.seen_next[v] > 0u : found;
    const float beside = weight_beside(f, rest);
    float weight = rest ? (float)f->surface.seen_next[v] * (1.0f / (float)SMR_SEEN_ONE) : (float)goal;
    smr_vec own;
    const int in_image = SMR_HAS_IMAGE && beside > 0.0f && smr_image_goal(&f->image, v, &own) == SMR_GOAL;
    if (!(rest && in_image) && (partial || landmarks))
        smr_unseen_field_blend(&f->unseen, v, found, way);
    if (in_image)
        smr_blend(way, &weight, own, beside);
    if (rest && in_image)
        smr_unseen_field_prevail(&f->unseen, v, way);
    return weight > 0.0f ? SMR_FOUND_GOAL : SMR_FOUND_NONE;
}

/* The image is of the past: its goals were found, and go along with what else is followed. */
static uint8_t goal_of_past(smr_forces *f, uint32_t v, smr_vec *way)
{
    smr_image_keep(&f->image, v);
    *way = smr_unseen_field_way(&f->unseen, v);
    return f->found_last[v] == SMR_FOUND_NO_TARGET ? SMR_FOUND_UNDECIDED : f->found_last[v];
}

/* The way to a goal in the image, and what fills in. Where the search has ended its goals are kept. */
static uint8_t goal_in_image(smr_forces *f, uint32_t v, smr_vec *way)
{
    if (smr_field_of_past(&f->unseen))
        return goal_of_past(f, v, way);
    int seen = smr_image_goal(&f->image, v, way);
    if (smr_field_of_image(&f->unseen))
        seen = smr_unseen_field_steady(&f->unseen, v, seen, way);
    else if (seen == SMR_NO_GOAL)
        *way = smr_fill_way(&f->image, v);
    const uint8_t found = seen == SMR_GOAL        ? SMR_FOUND_GOAL
                          : seen == SMR_UNDECIDED ? SMR_FOUND_UNDECIDED
                                                  : SMR_FOUND_NONE;
    if (!smr_landmarks_on(&f->landmarks))
        return found;
    const int kept = !smr_image_seeks(&f->image, smr_model_owner(f->shared->model, v)) && f->landmarks.seen[v] > 0u;
    if (seen == SMR_GOAL || kept)
        smr_unseen_field_prevail(&f->unseen, v, way);
    else
        smr_unseen_field_fill(&f->unseen, v, way);
    return found;
}

/* Without a target of its own a vertex follows landmarks, where there are any. */
static uint8_t goal_of_landmarks(smr_forces *f, uint32_t v, smr_vec *way)
{
    smr_sources_drop(f, v);
    if (!smr_landmarks_on(&f->landmarks))
        return SMR_FOUND_NO_TARGET;
    smr_unseen_field_fill(&f->unseen, v, way);
    return smr_landmark_binds(&f->landmarks, v) ? SMR_FOUND_GOAL : SMR_FOUND_NONE;
}

/* The way to the vertex' goal on its own target; 0 for none. A vertex without triangles lies on no surface and follows
 * neither surface nor image. */
static uint8_t goal_of_own(smr_forces *f, uint32_t v, smr_vec *way)
{
    const smr_target *drawn = &f->surface.target[smr_model_owner(f->shared->model, v)];
    const int image = smr_image_on(&f->image);
    *way = smr_v(0, 0, 0);
    /* nothing may stay from forces that started again after a surface came or went */
    if (image)
        smr_image_forget(&f->image, v);
    if (smr_visibility_on(&f->surface))
        f->surface.seen_next[v] = 0;
    if (drawn->surface == NULL && !image)
        return goal_of_landmarks(f, v, way);
    if (!f->shape->on_surface[v]) {
        smr_sources_drop(f, v);
        return SMR_FOUND_NO_TARGET;
    }
    return SMR_HAS_IMAGE && drawn->surface == NULL ? goal_in_image(f, v, way) : goal_on_surface(f, v, drawn, way);
}

uint8_t smr_sources_goal(smr_forces *f, uint32_t v, smr_vec *way)
{
    const uint8_t found = goal_of_own(f, v, way);
    const float weight = found == SMR_FOUND_GOAL ? 1.0f : 0.0f;
    return smr_caller_blend(&f->caller, v, way, weight) > weight ? SMR_FOUND_GOAL : found;
}
