/* set_targets.c: sets the surfaces, the clouds and the image that structures are deformed onto, and the fixed surfaces
 * that structures must not enter.
 * Bounds: one pass over a fixed surface's vertices; for an image those of a start of the schedule.
 * SPDX-License-Identifier: MIT */
#include "registration/tick/iteration_steps.h"
#include "options/track/track.h"
#include "registration/api/setup.h"
#include "registration/schedule_radius.h"

/* Returns the number of entries in target_warm that a surface needs; a cloud may grow to its capacity. */
static uint32_t slots_of(const smr_surface *s) { return smr_is_cloud(s) ? s->capacity : s->n_vertices; }

/* Returns entry k of the list of distinct targets; structure i is the first with this surface. before: entry k - 1, or
 * NULL. Components get a number of their own while there is room for those of all targets. */
static smr_goal goal_on(const smr_surface *surface, uint32_t k, uint32_t i, const smr_goal *before)
{
    const uint32_t first = before == NULL ? 0u : before->first_body + before->n_bodies + SMR_BODY_FIRST;
    const int room = first + surface->n_bodies <= SMR_BODY_PART + SMR_BODY_FIRST * k;
    return (smr_goal){.surface = surface,
                      .n_vertices = surface->n_vertices,
                      .structure = i,
                      .first_body = first,
                      .n_bodies = room ? surface->n_bodies : 0u};
}

uint64_t smr_list_goals(const smr_surface_goals *g, smr_goal *goal, uint32_t *n_goals, uint32_t *n_tasks)
{
    const smr_target *target = g->target;
    uint64_t slots = 0;
    *n_goals = *n_tasks = 0;
    for (uint32_t i = 0; i < g->shared->n_structures; i++) {
        const smr_surface *surface = target[i].surface;
        uint32_t known = 0;
        while (known < i && target[known].surface != surface)
            known++;
        if (surface == NULL || known < i)
            continue;
        if (goal != NULL) {
            goal[*n_goals] = goal_on(surface, *n_goals, i, *n_goals > 0u ? &goal[*n_goals - 1u] : NULL);
            goal[*n_goals].first_task = *n_tasks;
            goal[*n_goals].first_warm = (uint32_t)slots;
        }
        ++*n_goals;
        *n_tasks += smr_ceil_div(surface->n_vertices, SMR_FORCE_CHUNK);
        slots += slots_of(surface);
    }
    return slots;
}

/* Returns the number of entries in target_warm that all targets need once `structure` has this surface. */
static uint64_t slots_with(smr_surface_goals *g, uint32_t structure, const smr_surface *surface)
{
    uint32_t n_goals, n_tasks;
    if (structure == SMR_ALL)
        return surface == NULL ? 0u : slots_of(surface);
    const smr_surface *before = g->target[structure].surface;
    g->target[structure].surface = surface;
    const uint64_t slots = smr_list_goals(g, NULL, &n_goals, &n_tasks);
    g->target[structure].surface = before;
    return slots;
}

/* Discards the results of searches on the former target of a structure or SMR_ALL. */
static void forget_searches(smr_surface_goals *g, uint32_t structure)
{
    for (uint32_t v = 0; v < g->shared->n; v++)
        if (structure == SMR_ALL || smr_model_owner(g->shared->model, v) == structure)
            g->warm[v] = SMR_NONE;
    smr_target_warm_clear(g);
    smr_pulls_clear(g);
    g->limit = g->limit_next = 0.0f;
}

void smr_take_goals(smr_surface_goals *g)
{
    (void)smr_list_goals(g, g->goal, &g->n_goals, &g->n_tasks);
    g->n_clouds = g->n_points = 0;
    for (uint32_t i = 0; i < g->n_goals; i++) {
        const uint32_t cloud = (uint32_t)smr_is_points(g->goal[i].surface);
        g->n_clouds += cloud;
        g->n_points += cloud * g->goal[i].n_vertices;
    }
}

/* Returns 1 when the cloud starts with the points of the former target in the same order, so no point has moved.
 * Weights and normals may differ. Compares contents, since a replay may have another cloud. */
static int only_grown(const smr_surface_goals *g, uint32_t first, uint32_t last, const smr_surface *surface)
{
    smr_points_then known = {0, 0};
    if (g->then == NULL || surface == NULL || !smr_is_points(surface))
        return 0;
    for (uint32_t i = first; i < last; i++) {
        const smr_points_then *then = &g->then[i];
        if (then->sum == known.sum && then->n == known.n && known.sum != 0u)
            continue;
        if (then->n > surface->n_vertices || g->clouds->checksum(surface->xyz, then->n) != then->sum)
            return 0;
        known = *then;
    }
    return 1;
}

void smr_note_like(smr_surface_goals *g, uint32_t structure, uint32_t other)
{
    g->target[structure].n_vertices = g->target[other].n_vertices;
    g->target[structure].changes = g->target[other].changes;
    g->target[structure].guard = g->target[other].guard;
    if (g->then != NULL)
        g->then[structure] = g->then[other];
}

void smr_note_target(smr_surface_goals *g, uint32_t first, uint32_t last)
{
    const smr_surface *surface = g->target[first].surface;
    const int cloud = surface != NULL && smr_is_points(surface);
    g->target[first].n_vertices = surface == NULL ? 0u : surface->n_vertices;
    g->target[first].changes = surface == NULL ? 0u : surface->changes;
    g->target[first].guard = surface == NULL ? 0u : smr_surface_guard(surface);
    if (g->then != NULL) {
        const uint32_t n = cloud ? surface->n_vertices : 0u;
        g->then[first] = (smr_points_then){cloud ? g->clouds->checksum(surface->xyz, n) : 0u, n};
    }
    for (uint32_t i = first; i < last; i++) {
        smr_note_like(g, i, first);
        if (surface != NULL && !cloud)
            g->target[i].view = smr_v(0, 0, 0);
    }
}

SMR_SELDOM smr_status smr_settable(const smr *s, int built, int legal)
{
    if (s == NULL)
        return SMR_E_NULL;
    if (!built)
        return SMR_E_CONFIG;
    return legal && smr_changeable(s) ? smr_sound(s) : SMR_E_STATE;
}

SMR_SELDOM void smr_restart_forces(smr *s, uint32_t changed)
{
    smr_surface_goals *g = &s->forces.surface;
    smr_target_warm_clear(g);
    for (uint32_t i = 0; i < s->shared.n_structures; i++)
        g->target[i].measured = 0;
    smr_forces_unmeasured(&s->forces);
    smr_tracking_changed(s, changed);
    if (!smr_forces_pending(s))
        return;
    smr_pulls_clear(g);
    smr_place_reset(s);
}

/* Sets a mesh, a cloud or no target, without logging it. clouds: functions for clouds; NULL: no cloud is set. */
SMR_SELDOM static smr_status set_target(smr *s, uint32_t structure, const smr_surface *surface,
                                        const smr_cloud_calls *clouds)
{
    smr_surface_goals *g = &s->forces.surface;
    const uint32_t n_structures = s->shared.n_structures;
    if (structure != SMR_ALL && structure >= n_structures)
        return SMR_E_INPUT;
    const uint32_t n_slots = smr_target_slots(g->shared);
    const int mesh = surface == NULL || !smr_is_cloud(surface); /* a mesh needs no slots without attraction */
    if (n_slots == 0u ? !mesh : slots_with(g, structure, surface) > n_slots)
        return SMR_E_ARENA;
    smr_forces_settle(s);
    const uint32_t first = structure == SMR_ALL ? 0u : structure,
                   last = structure == SMR_ALL ? n_structures : first + 1u;
    g->clouds = clouds != NULL ? clouds : g->clouds;
    const int grown = only_grown(g, first, last, surface); /* 1: searches start from their last results */
    for (uint32_t i = first; i < last; i++) {
        g->target[i].surface = surface;
        g->target[i].measured = 0;
        g->target[i].compared = g->target[i].product = g->target[i].pulled = g->target[i].own = 0.0f;
    }
    smr_note_target(g, first, last);
    s->schedule.n_set++;
    smr_forces_unmeasured(&s->forces);
    const uint32_t n_goals = g->n_goals;
    smr_take_goals(g);
    if (grown && g->n_goals == n_goals) { /* only new points: results of searches and weights stay valid */
        smr_pulls_clear(g);
        if (smr_forces_pending(s) && (s->step > 0u || s->next_task > 0u))
            forget_searches(g, structure); /* how far they got depends on the budget */
    } else {
        forget_searches(g, structure);
        smr_outliers_forget(g, structure);
        for (uint32_t i = first; i < last && !s->schedule.tracking; i++) /* this cloud may show another side */
            g->target[i].view = smr_v(0, 0, 0);
    }
    if (smr_visibility_on(g))
        smr_visibility_start(g);
    smr_tracking_changed(s, surface != NULL && !grown ? SMR_CHANGED_SHOWN : SMR_CHANGED);
    if (smr_forces_pending(s))
        smr_place_reset(s); /* restarts the forces with the new goals; otherwise the old goals remain */
    return SMR_OK;
}

SMR_SELDOM smr_status smr_set_surface(smr *s, uint32_t structure, const smr_surface *surface)
{
    SMR_TRY(smr_settable(s, 1, surface == NULL || (smr_surface_valid(surface) && !smr_is_cloud(surface))));
    if (!SMR_HAS_PARTIAL && surface != NULL && surface->open && s->shared.config.partial.coverage != SMR_COVERAGE_WHOLE)
        return SMR_E_CONFIG;
    if (s->n_awaited > 0u)
        return s->await(s, SMR_LOG_SURFACE, structure, surface);
    SMR_TRY(set_target(s, structure, surface, NULL));
    smr_changed(s, SMR_LOG_SURFACE, structure, surface, 0);
    return SMR_OK;
}

SMR_SELDOM smr_status smr_set_points(smr *s, uint32_t structure, const smr_points *points)
{
    const smr_surface *surface = points == NULL ? NULL : &points->surface;
    SMR_TRY(smr_settable(s, SMR_HAS_PARTIAL, points == NULL || smr_points_valid(points)));
    if (s->n_awaited > 0u)
        return s->await(s, SMR_LOG_POINTS, structure, surface);
    SMR_TRY(set_target(s, structure, surface, surface != NULL ? &smr_clouds : NULL));
    smr_changed(s, SMR_LOG_POINTS, structure, points, 0);
    return SMR_OK;
}

SMR_SELDOM smr_status smr_set_fixed(smr *s, uint32_t index, const smr_surface *surface)
{
    const int legal = surface == NULL || (smr_surface_valid(surface) && !smr_is_cloud(surface));
    SMR_TRY(smr_settable(s, SMR_HAS_CONTACT, legal));
    smr_contact *c = &s->forces.contact;
    if (c->fixed == NULL)
        return SMR_E_ARENA;
    if (index >= s->shared.config.contact.n_fixed)
        return SMR_E_INPUT;
    if (s->n_awaited > 0u)
        return s->await(s, SMR_LOG_FIXED_SURFACE, index, surface);
    smr_forces_settle(s);
    smr_contact_fix(c, index, surface);
    smr_restart_forces(s, SMR_CHANGED);
    smr_changed(s, SMR_LOG_FIXED_SURFACE, index, surface, 0);
    return SMR_OK;
}

SMR_SELDOM smr_status smr_set_volume(smr *s, const smr_volume *volume)
{
    smr_grid grid;
    if (s == NULL)
        return SMR_E_NULL;
    if (!SMR_HAS_IMAGE)
        return SMR_E_CONFIG;
    SMR_TRY(smr_sound(s));
    if (!smr_changeable(s) || (volume != NULL && smr_le32(s->shared.model->profile_samples) == 0u))
        return SMR_E_STATE;
    SMR_TRY(volume == NULL ? SMR_OK : smr_grid_open(volume, &grid));
    if (s->n_awaited > 0u)
        return s->await(s, SMR_LOG_VOLUME, 0, volume);
    if (volume == NULL && !s->forces.image.has_image)
        return SMR_OK;
    const int follows = smr_tracks(&s->schedule) && volume != NULL && s->forces.image.has_image;
    if (follows && !SMR_HAS_PARTIAL)
        return SMR_E_CONFIG; /* vertices without an image goal would need the field of occluded vertices */
    smr_image_goals_open(&s->forces.image, volume == NULL ? NULL : &grid);
    smr_abandon_iteration(s);
    s->schedule.n_set++;
    for (uint32_t i = 0; i < smr_plastic_tasks(s); i++)
        smr_plastic_follow(s, i, 0);
    if (follows)
        smr_restart_forces(s, SMR_CHANGED_IMAGE);
    else
        smr_schedule_start(s);
    if (smr_moves(s))
        smr_time_steps_copy(s, (smr_piece){0, s->shared.n});
    smr_changed(s, SMR_LOG_VOLUME, 0, volume, 0);
    return SMR_OK;
}
