/* schedule.c: what happens between iterations, from coarse to fine: which vertices take part, how far goals are sought,
 * whether x^r = x (plasticity.c), and the next finer radius (convergence.c, radius.c).
 * Bounds: one pass over the vertices where x^r follows; SMR_RADII_MAX.
 * SPDX-License-Identifier: MIT */
#include "registration/tick/schedule.h"

#include "options/dynamics/dynamics.h"
#include "options/track/track.h"
#include "registration/convergence.h"

#define SMR_ACTIVE_EVERY 8u /* iterations between two changes of n_active at one radius */
#define SMR_GROWN 1.25f     /* factor on the points of clouds from which on a radius is repeated */

/* Chooses n_active. A change costs new cluster centres, so it waits for a new reference shape, which costs them anyway,
 * or for SMR_ACTIVE_EVERY iterations. The caller's choice and vertices that a budget left out do not wait. */
static void choose_active(smr *s)
{
    const uint32_t count =
        s->pace.n_pinned > 0u ? smr_max_u32(s->pace.n_pinned, s->pace.lists.active_min) : smr_radius_active(s);
    s->report.details.n_wanted = count;
    if (count == s->pace.n_active || (s->pace.n_pinned == 0u && !s->budget.cut && !s->reference.stale &&
                                      s->pace.radius_iteration % SMR_ACTIVE_EVERY != 0u))
        return;
    s->pace.n_active = count;
    s->reference.stale = 1;
    s->budget.cut = 0;
}

void smr_schedule_start(smr *s)
{
    s->pace.iteration = 0;
    s->pace.since_plastic = 0;
    s->pace.plastic_updates = 0;
    s->pace.converged = s->pace.done = s->pace.repairing = 0;
    s->pace.gain = 1.0f;
    if (SMR_HAS_TRACK)
        smr_tracking_end(s);
    s->step = 0;
    s->next_task = 0;
    s->forces.surface.limit = 0.0f;
    if (smr_visibility_on(&s->forces.surface))
        smr_overlap_start(&s->forces.surface);
    s->pace.ease = 1.0f;
    s->forces.surface.n_goals_begun = s->forces.surface.n_goals;
    s->forces.surface.n_clouds_begun = s->forces.surface.n_clouds;
    s->forces.surface.n_points_begun = s->forces.surface.n_points;
    smr_radius_go(s, s->shared.config.schedule.radius_first);
    s->shape.rest_pose_due = 1; /* an abandoned iteration may have made it of other positions */
    if (smr_moves(s))
        smr_time_steps_start(s);
}

/* 1: a cloud has grown so much since this radius began that the model is not yet laid out: the radius is repeated. A
 * cloud cannot grow beyond its memory, so that ends. */
static int grows(const smr *s) { return (float)s->forces.surface.n_points_begun > SMR_GROWN * (float)s->pace.n_points; }

/* After each iteration. */
void smr_schedule_next(smr *s)
{
    if (smr_moves(s)) {
        smr_time_steps_next(s);
        return;
    }
    if (smr_tracks(&s->pace)) {
        smr_tracking_next(s);
        return;
    }
    const smr_ending e = smr_ending_of(s, s->pace.radius_iteration);
    const int plastic = smr_plastic_due(s, &e, s->pace.since_plastic);
    const int repairs = s->pace.repairing > 0u; /* these iterations do not count */
    if (repairs) {
        s->pace.repairing = s->folds.n_folding > 0u && s->pace.repairing < SMR_REPAIR_MAX ? s->pace.repairing + 1u : 0u;
        s->pace.radius_iteration = 0;
    }
    if (plastic)
        smr_plastic_update(s);
    if (e.done) {
        s->pace.converged = (uint32_t)((e.small || e.settled) && s->forces.matched > 0.0f);
        s->pace.done = !SMR_HAS_TRACK || s->shared.config.track.mode == SMR_TRACK_OFF;
        if (SMR_HAS_TRACK && !s->pace.done)
            smr_tracking_start(s);
    } else if (!repairs && !smr_at_last_radius(&s->shared, &s->pace) && (e.settled || e.spent)) {
        smr_radius_go(s, s->pace.radius + (grows(s) ? 0u : 1u));
    }
}

/* Share of image forces and momentum in this iteration: it falls to 0 in equal steps over the second half of the last
 * radius. Where the image is poor goals jump from sample to sample; so the model comes to rest in their mean. */
static float ease_of(const smr *s)
{
    const uint32_t all = s->shared.config.basic.iterations_last,
                   left = all - smr_min_u32(s->pace.radius_iteration + 1u, all);
    if (!s->shared.config.image.fade || smr_tracks(&s->pace) || smr_moves(s) || !smr_image_on(&s->forces.image) ||
        !smr_at_last_radius(&s->shared, &s->pace) || left >= all / 2u)
        return 1.0f;
    return (float)left / (float)(all / 2u);
}

/* Search distances and strength of the coming iteration. */
static void choose_distances(smr *s)
{
    s->pace.ease = ease_of(s);
    const float done = smr_tracks(&s->pace) ? smr_tracking_progress(s) : smr_radius_progress(s);
    s->pace.farthest_mm = s->shared.config.image.profile_mm +
                          done * (s->shared.config.image.profile_end_mm - s->shared.config.image.profile_mm);
    s->pace.profile_mm = smr_min(s->pace.farthest_mm, s->shared.config.image.profile_radii * s->pace.lists.radius);
    s->pace.gradient_mm = s->shared.config.image.gradient_mm +
                          done * (s->shared.config.image.gradient_end_mm - s->shared.config.image.gradient_mm);
}

/* Notes which structures have a target now. One that is set during the iteration counts from the next one on. */
static void begin_targets(smr_surface_goals *g)
{
    g->n_goals_begun = g->n_goals;
    g->n_clouds_begun = g->n_clouds;
    g->n_points_begun = g->n_points;
    for (uint32_t i = 0; i < g->shared->n_structures; i++)
        g->target[i].begun = g->target[i].surface != NULL;
}

void smr_schedule_begin(smr *s)
{
    const int tracks = smr_tracks(&s->pace);
    if (tracks)
        smr_tracking_begin(s);
    if (smr_moves(s))
        smr_time_steps_begin(s);
    choose_active(s);
    s->report.details.n_taken = s->pace.n_active;
    choose_distances(s);
    begin_targets(&s->forces.surface);
    if (tracks)
        smr_tracking_momentum(s);
    if (s->pace.radius_iteration == 0u)
        s->pace.n_points = s->forces.surface.n_points_begun;
    smr_evening_begin(&s->evolve.evening);
    if (smr_volumes_used(&s->volumes))
        smr_volumes_begin(&s->volumes);
    if (smr_contact_used(&s->forces.contact))
        smr_contact_begin(&s->forces.contact);
}
