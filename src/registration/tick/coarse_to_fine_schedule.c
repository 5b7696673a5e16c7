/* coarse_to_fine_schedule.c: the schedule between iterations: active vertices, search distances, x^r = x, next radius.
 * Bounds: SMR_RADII_MAX; in tracking by images and with track.ahead, and in dynamics, passes over the vertices.
 * SPDX-License-Identifier: MIT */
#include "registration/schedule_radius.h"
#include "registration/tick/iteration_steps.h"

#define SMR_ACTIVE_EVERY 8u /* iterations between two changes of n_active at one radius */
#define SMR_TRUSTED 0.7f    /* share of vertices with a goal in an image from which on the image's forces are whole */
#define SMR_DISTRUST 0.6f   /* the same share up to which they are 0: noise alone gives up to 0.59, people 0.77 */
#define SMR_GROWN 1.25f     /* factor by which the number of all clouds' points grows before a radius is repeated */

/* Chooses n_active. A change needs new cluster centres and waits for a new reference shape or for
 * SMR_ACTIVE_EVERY iterations. The caller's choice, and vertices that a budget left out, do not wait. */
static void choose_active(smr *s)
{
    const smr_lists *const l = &s->schedule.lists;
    const uint32_t count = s->schedule.n_active_chosen > 0u
                               ? smr_min_u32(smr_max_u32(s->schedule.n_active_chosen, l->active_min), l->members)
                               : smr_radius_active(s);
    s->report.details.n_wanted = count;
    if (count == s->schedule.n_active || (s->schedule.n_active_chosen == 0u && !s->budget.cut && !s->reference.stale &&
                                          s->schedule.radius_iteration % SMR_ACTIVE_EVERY != 0u))
        return;
    s->schedule.n_active = count;
    s->reference.stale = 1;
    s->budget.cut = 0;
}

/* Stores the structures that have a target. A target that is set during an iteration counts from the next one on. */
static void begin_targets(smr_surface_goals *g)
{
    g->n_goals_at_begin = g->n_goals;
    g->n_clouds_at_begin = g->n_clouds;
    g->n_points_at_begin = g->n_points;
    for (uint32_t i = 0; i < g->shared->n_structures; i++)
        g->target[i].had_target = g->target[i].surface != NULL;
}

SMR_SELDOM void smr_place_reset(smr *s)
{
    s->step = s->next_task = s->n_shares = s->n_dealt = 0;
    for (uint32_t k = 0; k < s->shared.config.basic.n_workers; k++)
        smr_worker_start(&s->shared.worker[k]);
}

SMR_SELDOM void smr_schedule_start(smr *s)
{
    smr_schedule *p = &s->schedule;
    p->iteration = p->since_plastic = p->plastic_updates = p->converged = p->done = p->repairing = p->repaired = 0;
    p->gain = p->fade = 1.0f;
    s->reference.strained = 0;
    if (SMR_HAS_TRACK) {
        smr_tracking_end(s);
        smr_outliers_forget(&s->forces.surface, SMR_ALL); /* without the scale of residuals in tracking */
    }
    smr_place_reset(s);
    s->forces.surface.limit = s->forces.surface.limit_next = 0.0f;
    if (smr_visibility_on(&s->forces.surface))
        smr_visibility_start(&s->forces.surface);
    s->schedule.part_at_begin = (uint32_t)smr_shows_part(s);
    begin_targets(&s->forces.surface);
    smr_radius_go(s, s->shared.config.schedule.radius_first);
    s->shape.rest_pose_due = 1; /* an abandoned iteration may have fitted the rest pose to other positions */
    if (smr_moves(s))
        smr_time_steps_start(s);
}

void smr_schedule_next(smr *s)
{
    if (smr_moves(s)) {
        smr_time_steps_next(s);
        return;
    }
    if (smr_tracks(&s->schedule)) {
        smr_tracking_next(s);
        return;
    }
    const smr_ending e = smr_ending_of(s, s->schedule.radius_iteration);
    const int plastic = smr_plastic_due(s, &e, s->schedule.since_plastic);
    const uint32_t repairs = s->schedule.repairing;
    if (repairs > 0u)
        s->schedule.repairing = s->schedule.radius_iteration = 0; /* an iteration of fold repair does not count */
    s->schedule.repaired -= s->schedule.repaired > 0u;
    if (repairs > 0u && s->folds.n_guarded > 0u)
        s->schedule.repaired = SMR_REPAIRED;
    if (plastic)
        smr_plastic_update(s);
    if (e.done) {
        s->schedule.converged = (uint32_t)((e.small || e.settled) && s->forces.matched > 0.0f);
        s->schedule.done = !SMR_HAS_TRACK || s->shared.config.track.mode == SMR_TRACK_OFF;
        if (SMR_HAS_TRACK && !s->schedule.done)
            smr_tracking_start(s);
    } else if (repairs == 0u && !smr_at_last_radius(&s->shared, &s->schedule) && (e.settled || e.spent)) {
        /* a much larger cloud repeats the radius; memory limits a cloud's size, so repetition ends */
        const int grown = (float)s->forces.surface.n_points_at_begin > SMR_GROWN * (float)s->schedule.n_points;
        smr_radius_go(s, s->schedule.radius + (grown ? 0u : 1u));
    }
}

/* Returns the share of image forces and momentum in this iteration. The share falls to 0 in equal steps over the second
 * half of the last radius, so that the model converges to the mean of goals that jump between samples; and where so few
 * vertices find goals in an image as in mere noise. */
static float fade_of(const smr *s)
{
    const uint32_t all = s->shared.config.basic.iterations_last,
                   left = all - smr_min_u32(s->schedule.radius_iteration + 1u, all);
    float share = 1.0f;
    if (!s->shared.config.image.fade || smr_tracks(&s->schedule) || smr_moves(s) || !smr_image_on(&s->forces.image))
        return share;
    /* an image that shows a part has few goals without being noise */
    if (s->forces.matched >= 0.0f && s->forces.surface.n_goals == 0u && s->forces.image.n_invisible == 0u)
        share = smr_clamp((s->forces.matched - SMR_DISTRUST) / (SMR_TRUSTED - SMR_DISTRUST), 0.0f, 1.0f);
    if (smr_at_last_radius(&s->shared, &s->schedule) && left < all / 2u)
        share *= (float)left / (float)(all / 2u);
    return share;
}

/* Chooses search distances and the share of image forces for the coming iteration. */
static void choose_distances(smr *s)
{
    const smr_config *c = &s->shared.config;
    smr_schedule *p = &s->schedule;
    const float done = smr_tracks(p) ? smr_tracking_progress(s) : smr_radius_progress(s);
    p->fade = fade_of(s);
    p->farthest_mm = c->image.profile_mm + done * (c->image.profile_end_mm - c->image.profile_mm);
    p->profile_mm = smr_min(p->farthest_mm, c->image.profile_radii * p->lists.radius);
    p->gradient_mm = c->image.gradient_mm + done * (c->image.gradient_end_mm - c->image.gradient_mm);
}

/* Chooses the share of the last displacement that is added to the forces in the coming iteration. */
static void choose_momentum(smr *s)
{
    const smr_motion_config *c = &s->shared.config.motion;
    s->schedule.momentum = smr_moves(s)                                   ? 0.0f
                           : smr_at_last_radius(&s->shared, &s->schedule) ? c->momentum_last
                                                                          : c->momentum;
    if (smr_tracks(&s->schedule))
        smr_tracking_momentum(s);
}

void smr_schedule_begin(smr *s)
{
    const int tracks = smr_tracks(&s->schedule);
    s->schedule.part_at_begin = (uint32_t)smr_shows_part(s);
    s->shape.rest_pose_before = s->shape.rest_pose;
    if (tracks)
        smr_tracking_begin(s);
    if (smr_moves(s))
        smr_time_steps_begin(s);
    choose_active(s);
    s->report.details.n_taken = s->schedule.n_active;
    choose_distances(s);
    s->reference.n_sweeps = 1;
    begin_targets(&s->forces.surface);
    choose_momentum(s);
    if (s->schedule.radius_iteration == 0u)
        s->schedule.n_points = s->forces.surface.n_points_at_begin;
    smr_tangent_begin(&s->evolve.tangent_smooth);
    if (smr_volumes_used(&s->volumes))
        smr_volumes_begin(&s->volumes);
    if (smr_contact_used(&s->forces.contact))
        smr_contact_begin(&s->forces.contact);
}

smr_status smr_set_active(smr *s, uint32_t n_active)
{
    SMR_TRY(smr_sound(s));
    if (!smr_ready(s))
        return SMR_E_STATE;
    s->schedule.n_active_chosen = smr_min_u32(n_active, s->shared.n);
    smr_changed(s, SMR_LOG_ACTIVE, n_active, NULL, 0);
    return SMR_OK;
}
