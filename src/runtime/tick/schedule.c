/* schedule.c: what happens between iterations: plasticity (x^r = x), convergence, and the next finer radius.
 * Bounds: one pass over the vertices where x^r follows; SMR_RADII_MAX.
 * SPDX-License-Identifier: MIT */
#include "runtime/tick/schedule.h"
#include "runtime/tick/time_steps.h"
#include "runtime/tick/tracking.h"

#define SMR_REPAIR_MAX 30u     /* iterations spent on repairing folds before a radius starts, at most */
#define SMR_ENOUGH_ALL 1000.0f /* vertices: fewest active ones of the whole model, with an image */
#define SMR_ACTIVE_EVERY 8u    /* iterations between two changes of n_active at one radius */
#define SMR_ABOUT 0.75f        /* share of the active vertices wanted at which a level is enough */
#define SMR_FIRST_TIMES 2u     /* factor on the first radius' iterations with an image: most of the way is made there */
#define SMR_GROWN 1.25f        /* factor on the points of clouds from which on a radius is repeated */
#define SMR_FIRST_CLOUD 3u     /* the same with clouds: points without normals slide slowly into their places */
#define SMR_NARROWING 0.5f     /* search distances shrink to this share at most, from one radius to the next */

/* Active vertices that suffice for image forces: enough for active_enough in the smallest cluster. Image forces cost
 * most of an iteration, and large clusters need few of them. The number is a whole priority level, because the vertices
 * of a level do not depend on the order along the curve. */
static float enough_for_image(const smr *s)
{
    const float cluster = (float)s->shared.n * (float)s->shared.config.schedule.active_enough /
                          (float)smr_max_u32(s->pace.lists.smallest, 1u);
    const float enough = smr_max(cluster, SMR_ENOUGH_ALL); /* clusters that span the model share their vertices */
    uint32_t level = 0;
    while (level + 1u < smr_le32(s->shared.model->n_levels) &&
           (float)smr_le32(s->shared.model->level_end[level]) < SMR_ABOUT * enough)
        level++;
    return (float)smr_le32(s->shared.model->level_end[level]);
}

/* Active vertices now: the share that the configuration asks for, at least what the clusters of this radius need. */
static uint32_t active_count(const smr *s)
{
    const float n = (float)s->shared.n, last = s->shared.config.basic.active_share,
                first = smr_min(s->shared.config.schedule.active_first, last);
    float count = n * (first + (last - first) * smr_schedule_progress(s));
    if (s->forces.image.has_image && s->shared.config.schedule.active_enough > 0u)
        count = smr_min(count, enough_for_image(s));
    const uint32_t whole = (uint32_t)count;
    return smr_min_u32(smr_max_u32(whole + ((float)whole < count), s->pace.lists.active_min), s->shared.n);
}

/* Chooses n_active. A change costs new cluster centres, so it waits for a new reference shape, which costs them anyway,
 * or for SMR_ACTIVE_EVERY iterations. The caller's choice and vertices that a budget left out do not wait. */
static void choose_active(smr *s)
{
    const uint32_t count =
        s->pace.n_pinned > 0u ? smr_max_u32(s->pace.n_pinned, s->pace.lists.active_min) : active_count(s);
    s->report.details.n_wanted = count;
    if (count == s->pace.n_active || (s->pace.n_pinned == 0u && !s->budget.cut && !s->reference.stale &&
                                      s->pace.radius_iteration % SMR_ACTIVE_EVERY != 0u))
        return;
    s->pace.n_active = count;
    s->reference.stale = 1;
    s->budget.cut = 0;
}

/* 1 when folds are repaired before this radius. Not with an image alone: its last radius still has clusters, so folds
 * straighten by themselves and fold_open.c opens the rest; a repair would lose what forces had found there. */
static int repairs_before(const smr *s, uint32_t radius)
{
    return smr_folds_guarded(&s->shared, &s->pace) && s->shared.n_hinges > 0u &&
           (s->forces.surface.n_goals_begun > 0u || !s->forces.image.has_image) &&
           (radius == s->shared.config.schedule.radius_first || radius + 1u == smr_last_radius(&s->shared));
}

/* What follows from the radius alone. */
static void take_radius(smr *s)
{
    const uint32_t radius = s->pace.radius;
    s->pace.lists = smr_model_lists(s->shared.model, radius);
    s->pace.momentum = radius == smr_last_radius(&s->shared) ? s->shared.config.motion.momentum_last
                                                             : s->shared.config.motion.momentum;
    if (s->shared.config.dynamics.mode) {
        s->pace.lists.active_min = s->shared.n; /* momentum is that of all vertices */
        s->pace.momentum = 0.0f;
    }
    const float before = radius > 0u ? smr_model_lists(s->shared.model, radius - 1u).radius : 0.0f;
    s->pace.search_mm =
        smr_min(s->shared.config.basic.search_mm,
                s->shared.config.forces.search_radii * smr_max(s->pace.lists.radius, SMR_NARROWING * before));
}

void smr_schedule_radius(smr *s, uint32_t radius)
{
    s->pace.radius = radius;
    s->pace.n_points = s->forces.surface.n_points_begun;
    s->pace.radius_iteration = 0;
    take_radius(s);
    s->reference.stale = 1;
    s->pace.n_active = active_count(s);
    s->shape.rest_pose_due = radius == smr_last_radius(&s->shared);
    s->pace.repairing = (uint32_t)repairs_before(s, radius);
}

void smr_schedule_start(smr *s)
{
    s->pace.iteration = 0;
    s->pace.since_plastic = 0;
    s->pace.plastic_updates = 0;
    s->pace.converged = s->pace.done = s->pace.repairing = 0;
    smr_tracking_end(s);
    s->step = 0;
    s->next_task = 0;
    s->forces.surface.limit = 0.0f;
    smr_overlap_start(&s->forces.surface);
    s->pace.ease = 1.0f;
    s->forces.surface.n_goals_begun = s->forces.surface.n_goals;
    s->forces.surface.n_clouds_begun = s->forces.surface.n_clouds;
    s->forces.surface.n_points_begun = s->forces.surface.n_points;
    smr_schedule_radius(s, s->shared.config.schedule.radius_first);
    s->shape.rest_pose_due = 1; /* an abandoned iteration may have made it of other positions */
    if (s->shared.config.dynamics.mode)
        smr_time_steps_start(s);
}

static void plastic_update(smr *s)
{
    smr_plastic_positions(&s->shape);
    s->reference.stale = 1;
    s->pace.since_plastic = 0;
    s->pace.plastic_updates++;
}

/* Most iterations at the first radius. */
static uint32_t first_iterations(const smr *s)
{
    const int alone = s->shared.config.schedule.radius_first == smr_last_radius(&s->shared);
    const uint32_t times = s->forces.image.has_image               ? SMR_FIRST_TIMES
                           : s->forces.surface.n_clouds_begun > 0u ? SMR_FIRST_CLOUD
                                                                   : 1u;
    return alone ? s->shared.config.basic.iterations_last : s->shared.config.basic.iterations * times;
}

static uint32_t radius_iterations(const smr *s)
{
    if (s->pace.radius == s->shared.config.schedule.radius_first)
        return first_iterations(s);
    return smr_at_last_radius(&s->shared, &s->pace) ? s->shared.config.basic.iterations_last
                                                    : s->shared.config.basic.iterations;
}

/* Search distances and shares are chosen when an iteration begins. */
void smr_schedule_keep(smr_arena *a, smr *s)
{
    smr_pace *p = &s->pace;
    const uint32_t n = s->shared.n;
    smr_keep_words(a, &p->radius, 1, smr_last_radius(&s->shared));
    smr_keep_words(a, &p->radius_iteration, 1, UINT32_MAX);
    smr_keep_words(a, &p->iteration, 1, UINT32_MAX);
    smr_keep_words(a, &p->n_points, 1, UINT32_MAX);
    smr_keep_words(a, &p->since_plastic, 1, UINT32_MAX);
    smr_keep_words(a, &p->plastic_updates, 1, UINT32_MAX);
    smr_keep_words(a, &p->converged, 1, 1);
    smr_keep_words(a, &p->done, 1, 1);
    smr_keep_words(a, &p->repairing, 1, SMR_REPAIR_MAX);
    smr_keep_words(a, &p->n_active, 1, n);
    smr_keep_words(a, &p->n_pinned, 1, n);
    smr_keep_require(a, p->radius >= s->shared.config.schedule.radius_first);
    smr_tracking_keep(a, s);
    if (!smr_keeps(a) || a->keeper->mode == SMR_KEEP_COUNT || a->keeper->wrong)
        return;
    take_radius(s);
    smr_keep_require(a, p->n_active >= smr_min_u32(p->lists.active_min, n));
    if (s->shared.config.dynamics.mode) {
        smr_keep_require(a, !p->done && !p->repairing && p->radius == smr_tracking_radius(s));
        return;
    }
    if (p->tracking) {
        smr_keep_require(a, smr_tracking_legal(s));
        return;
    }
    smr_keep_require(a, p->radius_iteration <= (smr_at_last_radius(&s->shared, p)
                                                    ? s->shared.config.basic.iterations_last
                                                    : SMR_FIRST_CLOUD * s->shared.config.basic.iterations));
}

/* What follows an iteration. All are 0 or 1. */
typedef struct ending {
    int small, still, spent, settled, done, plastic;
} ending;

/* 1 when a radius may end before its iterations are spent. While tangent evening works the last radius runs to its end:
 * rounding would decide an early end. If nothing moved at all the end changes nothing. Volumes come to what is
 * asked at the first radius, before anything is fine. */
static int may_end_early(const smr *s)
{
    if (smr_volumes_under_way(&s->volumes))
        return 0;
    if (smr_contact_on(&s->forces.contact) && smr_at_last_radius(&s->shared, &s->pace))
        return 0; /* triangles are looked at as it ends */
    return !(s->evolve.moved_mm > 0.0f) || !smr_at_last_radius(&s->shared, &s->pace) ||
           s->forces.surface.n_goals_begun == 0u || !(s->shared.config.basic.even > 0.0f);
}

/* What follows iteration number radius_iteration at its radius, the since_plastic-th since x^r was new. A radius is
 * done when an iteration moves less than settle_um, or after its number of iterations; the registration is done with
 * the last radius. */
static ending ending_of(const smr *s, uint32_t radius_iteration, uint32_t since_plastic)
{
    const int last = smr_at_last_radius(&s->shared, &s->pace);
    const float moved_um = s->evolve.moved_mm * 1000.0f;
    ending e;
    e.settled = moved_um < s->shared.config.motion.settle_um && may_end_early(s);
    e.spent = radius_iteration >= radius_iterations(s);
    e.small = moved_um < s->shared.config.motion.plastic_um;
    e.still = s->shared.config.motion.plastic_by == SMR_PLASTIC_MEAN
                  ? s->evolve.mean_mm * 1000.0f < s->shared.config.motion.plastic_um
                  : e.small;
    e.done = s->pace.repairing == 0u && last && (e.settled || e.spent);
    const int due =
        s->shared.config.motion.plastic_every != 0u && since_plastic >= s->shared.config.motion.plastic_every;
    e.plastic = s->pace.repairing > 0u || (!e.done && (e.still || due || e.settled || e.spent));
    return e;
}

int smr_schedule_plastic(const smr *s)
{
    return !s->pace.tracking && !s->shared.config.dynamics.mode &&
           ending_of(s, s->pace.radius_iteration + 1u, s->pace.since_plastic + 1u).plastic;
}

/* 1: a cloud has grown so much since this radius began that the model is not yet laid out: the radius is repeated. A
 * cloud cannot grow beyond its memory, so that ends. */
static int grows(const smr *s) { return (float)s->forces.surface.n_points_begun > SMR_GROWN * (float)s->pace.n_points; }

/* After each iteration. */
void smr_schedule_next(smr *s)
{
    if (s->shared.config.dynamics.mode || s->pace.tracking) {
        (s->shared.config.dynamics.mode ? smr_time_steps_next : smr_tracking_next)(s);
        return;
    }
    const ending e = ending_of(s, s->pace.radius_iteration, s->pace.since_plastic);
    const int repairs = s->pace.repairing > 0u; /* these iterations do not count */
    if (repairs) {
        s->pace.repairing = s->folds.n_folding > 0u && s->pace.repairing < SMR_REPAIR_MAX ? s->pace.repairing + 1u : 0u;
        s->pace.radius_iteration = 0;
    }
    if (e.plastic)
        plastic_update(s);
    if (e.done) {
        s->pace.converged = (uint32_t)((e.small || e.settled) && s->forces.matched > 0.0f);
        s->pace.done = s->shared.config.track.mode == SMR_TRACK_OFF;
        if (!s->pace.done)
            smr_tracking_start(s);
    } else if (!repairs && !smr_at_last_radius(&s->shared, &s->pace) && (e.settled || e.spent)) {
        smr_schedule_radius(s, s->pace.radius + (grows(s) ? 0u : 1u));
    }
}

/* Share of image forces and momentum in this iteration: it falls to 0 in equal steps over the second half of the last
 * radius. Where the image is poor goals jump from sample to sample; so the model comes to rest in their mean. */
static float ease_of(const smr *s)
{
    const uint32_t all = s->shared.config.basic.iterations_last,
                   left = all - smr_min_u32(s->pace.radius_iteration + 1u, all);
    if (!s->shared.config.image.fade || s->pace.tracking || s->shared.config.dynamics.mode ||
        !s->forces.image.has_image || !smr_at_last_radius(&s->shared, &s->pace) || left >= all / 2u)
        return 1.0f;
    return (float)left / (float)(all / 2u);
}

/* Search distances and strength of the coming iteration. */
static void choose_distances(smr *s)
{
    s->pace.ease = ease_of(s);
    const float done = s->pace.tracking ? smr_tracking_progress(s) : smr_schedule_progress(s);
    s->pace.farthest_mm = s->shared.config.image.profile_mm +
                          done * (s->shared.config.image.profile_end_mm - s->shared.config.image.profile_mm);
    s->pace.profile_mm = smr_min(s->pace.farthest_mm, s->shared.config.image.profile_radii * s->pace.lists.radius);
    s->pace.gradient_mm = s->shared.config.image.gradient_mm +
                          done * (s->shared.config.image.gradient_end_mm - s->shared.config.image.gradient_mm);
}

float smr_schedule_progress(const smr *s)
{
    if (s->pace.done || s->pace.tracking)
        return 1.0f;
    if (s->shared.config.dynamics.mode)
        return 0.0f;
    const float first = (float)first_iterations(s), level = (float)s->shared.config.basic.iterations;
    const uint32_t steps = smr_last_radius(&s->shared) - s->shared.config.schedule.radius_first,
                   at = s->pace.radius - s->shared.config.schedule.radius_first;
    const float total =
        steps > 0u ? first + level * (float)(steps - 1u) + (float)s->shared.config.basic.iterations_last : first;
    return ((at > 0u ? first + level * (float)(at - 1u) : 0.0f) + (float)s->pace.radius_iteration) / total;
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
    smr_tracking_begin(s);
    if (s->shared.config.dynamics.mode)
        smr_time_steps_begin(s);
    choose_active(s);
    s->report.details.n_taken = s->pace.n_active;
    choose_distances(s);
    begin_targets(&s->forces.surface);
    smr_tracking_momentum(s);
    if (s->pace.radius_iteration == 0u)
        s->pace.n_points = s->forces.surface.n_points_begun;
    smr_evening_begin(&s->evolve.evening);
    smr_volumes_begin(&s->volumes);
    smr_contact_begin(&s->forces.contact);
}
