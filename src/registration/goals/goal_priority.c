/* goal_priority.c: the goal of a vertex, by priority: the structure's target surface or cloud; else the image; a smooth
 * field for vertices that are not visible. Goals of the caller are averaged with that goal by weight.
 * Bounds: those of the sources.
 * SPDX-License-Identifier: MIT */
#include "registration/goals/external_forces.h"

smr_status smr_inputs_valid(const smr_forces *f)
{
    const smr_status status = smr_targets_valid(&f->surface);
    return SMR_HAS_CONTACT && status == SMR_OK ? smr_fixed_valid(&f->contact) : status;
}

void smr_sources_layout(smr_arena *a, smr_forces *f, const smr_shared *shared)
{
    smr_surface_goals_layout(a, &f->surface, shared);
    if (SMR_HAS_PARTIAL)
        smr_landmark_goals_layout(a, &f->landmarks, shared);
    if (SMR_HAS_IMAGE)
        smr_image_goals_layout(a, &f->image, shared);
    if (shared->config.caller.goals != 0u)
        f->caller.goals = smr_slot_scratch(a, f->caller.goals, shared->n_structures, sizeof *f->caller.goals);
    if (shared->config.caller.force != SMR_CALLER_OFF)
        f->caller.force_output = smr_slot_scratch(a, f->caller.force_output, shared->n, 4u * sizeof(float));
    if (SMR_HAS_CONTACT) {
        smr_smooth_layout(a, &f->smooth, shared);
        smr_contact_layout(a, &f->contact, shared);
    }
}

void smr_sources_reset(smr_forces *f, uint32_t part, uint32_t parts)
{
    smr_surface_goals_reset(&f->surface, part, parts);
    if (SMR_HAS_PARTIAL)
        smr_landmark_goals_reset(&f->landmarks, part, parts);
    if (SMR_HAS_IMAGE)
        smr_image_goals_reset(&f->image, part, parts);
    f->caller.summed = 0;
    if (SMR_HAS_CONTACT)
        smr_contact_reset(&f->contact, part, parts);
}

/* Stores the visibility of each active vertex, which the field of landmarks reads. */
static void note_visible(smr_forces *f, smr_piece p)
{
    for (uint32_t v = p.first; v < smr_min_u32(p.last, f->schedule->n_active); v++) {
        const uint32_t owner = smr_model_owner(f->shared->model, v);
        const smr_target *target = &f->surface.target[owner];
        const uint8_t found = f->found_last[v] == SMR_FOUND_GOAL ? SMR_VISIBLE_ONE : 0u;
        if (target->surface != NULL)
            f->landmarks.visibility[v] = target->partial ? f->surface.visibility[v] : found;
        else if (!smr_image_on(&f->image))
            f->landmarks.visibility[v] = 0;
        else if (smr_image_seeks(&f->image, owner))
            f->landmarks.visibility[v] = found;
    }
}

void smr_sources_commit(smr_forces *f)
{
    if (f->caller.calls != NULL)
        f->caller.calls->stand(&f->caller);
    smr_surface_goals_commit(&f->surface);
    if (smr_visibility_on(&f->surface))
        smr_visibility_commit(&f->surface);
}

uint32_t smr_sources_keep_tasks(const void *arg)
{
    const smr_forces *f = arg;
    return f->shared->n_tasks + (smr_landmarks_on(&f->landmarks) ? f->landmarks.n : 0u);
}

void smr_sources_keep(void *arg, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_forces *f = arg;
    smr_surface_goals *g = &f->surface;
    if (task >= f->shared->n_tasks) {
        smr_landmark_keep(&f->landmarks, task - f->shared->n_tasks);
        return;
    }
    const smr_piece p = {task * SMR_CHUNK, smr_chunk_end(f->shared, task)};
    const uint32_t last = smr_min_u32(p.last, f->schedule->n_active), n = last > p.first ? last - p.first : 0u;
    memcpy(f->found_last + p.first, f->found + p.first, p.last - p.first);
    memcpy(g->warm + p.first, g->warm_next + p.first, n * sizeof *g->warm);
    if (smr_image_on(&f->image))
        smr_image_keep_found(&f->image, p);
    if (smr_visibility_on(g) && smr_visibility_tasks(g) > 0u)
        memcpy(g->visibility + p.first, g->visibility_next + p.first, n);
    if (smr_landmarks_on(&f->landmarks))
        note_visible(f, p);
    if (smr_contact_used(&f->contact))
        smr_contact_keep(&f->contact, p);
    f->n_kept = p.last;
}

uint8_t smr_visibility_not_kept(const smr_forces *f, uint32_t v)
{
    const smr_surface_goals *g = &f->surface;
    const int old = v >= f->schedule->n_active || !SMR_HAS_PARTIAL || smr_visibility_tasks(g) == 0u;
    return (old ? g->visibility : g->visibility_next)[v];
}

void smr_sources_drop(smr_forces *f, uint32_t v)
{
    smr_vec displacement;
    f->surface.other[v] = 0;
    if (smr_attraction_on(&f->surface))
        (void)smr_pull_take(&f->surface, v, &displacement);
}

/* Finds the displacement of v to a goal on its mesh or cloud, and the residual, mm; judges the visibility. Returns 0
 * without a goal. */
static int goal_on_target(smr_forces *f, uint32_t v, const smr_target *drawn, smr_pause *pause, smr_vec *displacement,
                          float *residual)
{
    smr_surface_goals *g = &f->surface;
    smr_surface_find find;
    if (smr_is_points(drawn->surface))
        return g->clouds->goal(g, v, displacement, residual);
    const int found = smr_surface_goal(g, v, drawn->surface, pause, displacement, &find);
    if (pause->kept || find.hit.triangle == SMR_NONE)
        return found;
    if (SMR_HAS_PARTIAL && smr_visibility_judged(g, smr_model_owner(f->shared->model, v)))
        smr_visibility_judge(g, v, drawn->surface, &find.hit, find.displacement);
    const int hardly = SMR_HAS_PARTIAL && drawn->partial && g->visibility_next[v] <= SMR_VISIBLE_ONE / 2u;
    *residual = hardly ? -1.0f : SMR_SQRT(find.hit.d2);
    return found;
}

/* Finds the displacement of v to a surface goal, mm, averaged with an image goal and with the field of occluded
 * vertices. With a partial target the surface goal's weight is the visibility of v. Returns SMR_FOUND_... */
static uint8_t goal_on_surface(smr_forces *f, uint32_t v, const smr_target *drawn, smr_pause *pause,
                               smr_vec *displacement, float *residual)
{
    const int found = goal_on_target(f, v, drawn, pause, displacement, residual);
    const int rest = smr_field_of_rest(&f->occluded, v);
    const int partial = SMR_HAS_PARTIAL && drawn->partial, landmarks = smr_landmarks_on(&f->landmarks);
    const int goal = partial ? f->surface.visibility_next[v] > 0u : found;
    const int looks = smr_image_on(&f->image) && !smr_field_of_past(&f->occluded);
    const float beside = rest ? 1.0f : looks ? f->shared->config.image.beside * f->schedule->fade : 0.0f;
    float weight = rest ? (float)f->surface.visibility_next[v] * (1.0f / (float)SMR_VISIBLE_ONE) : (float)goal;
    smr_vec own;
    if (pause->kept)
        return SMR_FOUND_NONE;
    const int in_image = SMR_HAS_IMAGE && beside > 0.0f && f->image.calls->goal(&f->image, v, &own) == SMR_GOAL;
    if (SMR_HAS_IMAGE && beside > 0.0f && !in_image)
        smr_image_forget(&f->image, v); /* drops the image's result: the surface decides what is visible */
    if (!(rest && in_image) && (partial || landmarks))
        smr_occluded_field_blend(&f->occluded, v, found, displacement);
    if (in_image)
        smr_blend(displacement, &weight, own, beside);
    if (rest && in_image)
        smr_occluded_field_blend_hard(&f->occluded, v, displacement);
    return weight > 0.0f ? SMR_FOUND_GOAL : SMR_FOUND_NONE;
}

/* Finds the displacement of v to an image goal, or without one its smoothing displacement, mm. Returns SMR_FOUND_... */
static uint8_t goal_in_image(smr_forces *f, uint32_t v, smr_vec *displacement)
{
    static const uint8_t found_of[] = {[SMR_NO_GOAL] = SMR_FOUND_NONE,
                                       [SMR_GOAL] = SMR_FOUND_GOAL,
                                       [SMR_UNDECIDED] = SMR_FOUND_UNDECIDED,
                                       [SMR_INVISIBLE] = SMR_FOUND_NO_TARGET};
    if (smr_field_of_past(
            &f->occluded)) { /* the field moves goals found in an outdated image along with newer targets */
        smr_image_keep(&f->image, v);
        *displacement = smr_occluded_field_displacement(&f->occluded, v);
        return f->found_last[v] == SMR_FOUND_NO_TARGET ? SMR_FOUND_UNDECIDED : f->found_last[v];
    }
    int visible = f->image.calls->goal(&f->image, v, displacement);
    if (smr_field_of_image(&f->occluded))
        visible = smr_occluded_field_blend_image(&f->occluded, v, visible, displacement);
    else if (visible == SMR_NO_GOAL)
        *displacement = f->image.calls->fill(&f->image, v);
    else if (visible == SMR_INVISIBLE && smr_field_of_part(&f->occluded))
        *displacement = smr_occluded_field_follow(&f->occluded, v);
    const uint8_t found = found_of[visible];
    if (!smr_landmarks_on(&f->landmarks))
        return found;
    const int kept =
        !smr_image_seeks(&f->image, smr_model_owner(f->shared->model, v)) && f->landmarks.visibility[v] > 0u;
    if (visible == SMR_GOAL || kept)
        smr_occluded_field_blend_hard(&f->occluded, v, displacement);
    else
        smr_occluded_field_fill(&f->occluded, v, displacement);
    return found;
}

/* Finds the displacement, mm, of a vertex without target and image, which follows landmarks. Returns SMR_FOUND_... */
static uint8_t goal_of_landmarks(smr_forces *f, uint32_t v, smr_vec *displacement)
{
    smr_sources_drop(f, v);
    if (!smr_landmarks_on(&f->landmarks))
        return SMR_FOUND_NO_TARGET;
    smr_occluded_field_fill(&f->occluded, v, displacement);
    return smr_landmark_binds(&f->landmarks, v) ? SMR_FOUND_GOAL : SMR_FOUND_NONE;
}

/* Finds the displacement of v to its goal, mm, without goals of the caller; 0 for a vertex without triangles unless the
 * vertex follows landmarks. Returns SMR_FOUND_... */
static uint8_t goal_of_own(smr_forces *f, uint32_t v, smr_pause *pause, smr_vec *displacement, float *residual)
{
    const smr_target *drawn = &f->surface.target[smr_model_owner(f->shared->model, v)];
    const int image = smr_image_on(&f->image);
    *displacement = smr_v(0, 0, 0);
    if (image)
        smr_image_forget(&f->image, v); /* a result may be left from forces that were restarted with another surface */
    if (smr_visibility_on(&f->surface))
        f->surface.visibility_next[v] = 0;
    if (drawn->surface == NULL && !image)
        return goal_of_landmarks(f, v, displacement);
    if (!f->shape->on_surface[v]) {
        smr_sources_drop(f, v);
        return SMR_FOUND_NO_TARGET;
    }
    return SMR_HAS_IMAGE && drawn->surface == NULL ? goal_in_image(f, v, displacement)
                                                   : goal_on_surface(f, v, drawn, pause, displacement, residual);
}

uint8_t smr_sources_goal(smr_forces *f, uint32_t v, smr_pause *pause, smr_vec *displacement, float *residual)
{
    const uint8_t found = goal_of_own(f, v, pause, displacement, residual);
    const float weight = found == SMR_FOUND_GOAL ? 1.0f : 0.0f;
    if (f->caller.calls == NULL || pause->kept)
        return found;
    return f->caller.calls->blend(&f->caller, v, displacement, weight) > weight ? SMR_FOUND_GOAL : found;
}
