/* schedule.c: what happens between iterations: plasticity (x^r = x), convergence, and the next finer radius.
 * Bounds: one pass over the vertices where x^r follows; SMR_RADII_MAX.
 * SPDX-License-Identifier: MIT */
#include "runtime/tick/schedule.h"

#define SMR_REPAIR_MAX 30u
#define SMR_ENOUGH_ALL 1000.0f /* active vertices of the whole model with an image */
#define SMR_ACTIVE_EVERY 8u    /* iterations */
#define SMR_ABOUT 0.75f
#define SMR_FIRST_TIMES                                                                                                \
    2u /* with an image, iterations at the first radius: few vertices have goals, and most of the way is made */
#define SMR_NARROWING 0.5f /* search distances shrink to this share at most, from one radius to the next */

/* Image forces cost most of the time, and a large cluster needs few of them: about so many that the smallest cluster
 * keeps active_enough. Whole levels: which vertices they hold does not depend on how the curve runs through the
 * model. */
static float enough_for_image(const smr *s)
{
    const float cluster =
        (float)s->shared.n * (float)s->shared.config.active_enough / (float)smr_max_u32(s->pace.lists.smallest, 1u);
    const float enough = smr_max(cluster, SMR_ENOUGH_ALL); /* clusters that span the model share their vertices */
    uint32_t level = 0;
    while (level + 1u < smr_le32(s->shared.model->n_levels) &&
           (float)smr_le32(s->shared.model->level_end[level]) < SMR_ABOUT * enough)
        level++;
    return (float)smr_le32(s->shared.model->level_end[level]);
}

/* The first vertices in the order in which they matter that take part now: the share that the configuration asks for,
 * but never too few for the clusters of this radius. */
static uint32_t active_count(const smr *s)
{
    const float n = (float)s->shared.n, last = s->shared.config.active_share,
                first = smr_min(s->shared.config.active_first, last);
    float count = n * (first + (last - first) * smr_schedule_progress(s));
    if (s->forces.image.has_image && s->shared.config.active_enough > 0u)
        count = smr_min(count, enough_for_image(s));
    const uint32_t whole = (uint32_t)count;
    return smr_min_u32(smr_max_u32(whole + ((float)whole < count), s->pace.lists.active_min), s->shared.n);
}

/* A new number makes cluster centres anew, so it waits for a new reference shape, which does so anyway, but not for
 * ever. The caller's own choice does not wait, nor do vertices that the last budget left out. */
static void choose_active(smr *s)
{
    const uint32_t count =
        s->pace.n_pinned > 0u ? smr_max_u32(s->pace.n_pinned, s->pace.lists.active_min) : active_count(s);
    s->report.n_wanted = count;
    if (count == s->pace.n_active || (s->pace.n_pinned == 0u && !s->budget.cut && !s->reference.stale &&
                                      s->pace.radius_iteration % SMR_ACTIVE_EVERY != 0u))
        return;
    s->pace.n_active = count;
    s->reference.stale = 1;
    s->budget.cut = 0;
}

/* With an image alone nothing is repaired: its last radius is not single vertices, so what is folded straightens
 * again, and fold_open.c opens the rest. A repair's patches would lose what forces had found there. */
static int repairs_before(const smr *s, uint32_t radius)
{
    return smr_folds_guarded(&s->shared, &s->pace) && s->shared.n_hinges > 0u &&
           (s->forces.surface.n_goals_begun > 0u || !s->forces.image.has_image) &&
           (radius == s->shared.config.radius_first || radius + 1u == smr_last_radius(&s->shared));
}

static void use_radius(smr *s, uint32_t radius)
{
    s->pace.radius = radius;
    s->pace.radius_iteration = 0;
    s->pace.lists = smr_model_lists(s->shared.model, radius);
    s->reference.stale = 1;
    s->pace.n_active = active_count(s);
    s->pace.momentum =
        radius == smr_last_radius(&s->shared) ? s->shared.config.momentum_last : s->shared.config.momentum;
    const float before = radius > 0u ? smr_model_lists(s->shared.model, radius - 1u).radius : 0.0f;
    s->pace.search_mm = smr_min(s->shared.config.search_mm,
                                s->shared.config.search_radii * smr_max(s->pace.lists.radius, SMR_NARROWING * before));
    s->shape.rest_pose_due = radius == smr_last_radius(&s->shared);
    s->pace.repairing = (uint32_t)repairs_before(s, radius);
}

void smr_schedule_start(smr *s)
{
    s->pace.iteration = 0;
    s->pace.since_plastic = 0;
    s->pace.plastic_updates = 0;
    s->pace.converged = s->pace.done = s->pace.repairing = 0;
    s->step = 0;
    s->next_task = 0;
    s->forces.surface.limit = 0.0f;
    s->pace.ease = 1.0f;
    s->forces.surface.n_goals_begun = s->forces.surface.n_goals;
    use_radius(s, s->shared.config.radius_first);
    s->shape.rest_pose_due = 1; /* an abandoned iteration may have made it of other positions */
}

static void plastic_update(smr *s)
{
    smr_plastic_positions(&s->shape);
    s->reference.stale = 1;
    s->pace.since_plastic = 0;
    s->pace.plastic_updates++;
}

/* At most so many iterations at the radius in use; at the first one in any case. */
static uint32_t first_iterations(const smr *s)
{
    const int alone = s->shared.config.radius_first == smr_last_radius(&s->shared);
    return alone ? s->shared.config.iterations_last
                 : s->shared.config.iterations * (s->forces.image.has_image ? SMR_FIRST_TIMES : 1u);
}

static uint32_t radius_iterations(const smr *s)
{
    if (s->pace.radius == s->shared.config.radius_first)
        return first_iterations(s);
    return smr_at_last_radius(&s->shared, &s->pace) ? s->shared.config.iterations_last : s->shared.config.iterations;
}

/* How an iteration ends that is number radius_iteration at its radius, and since_plastic since x^r was new. */
typedef struct ending {
    int small, spent, settled, done, plastic;
} ending;

/* Evening out takes the whole last radius: an end that comes early is a choice which last bits decide. Rest is rest.
 * A target that is set or taken away in the iteration counts from the next one on, as in a replay. */
static int may_end_early(const smr *s)
{
    return !(s->evolve.moved_mm > 0.0f) || !smr_at_last_radius(&s->shared, &s->pace) ||
           s->forces.surface.n_goals_begun == 0u || !(s->shared.config.even > 0.0f);
}

/* A radius is done when an iteration moves less than the threshold, or after its number of iterations; the last
 * radius' end is the registration's end. */
static ending ending_of(const smr *s, uint32_t radius_iteration, uint32_t since_plastic)
{
    const int last = smr_at_last_radius(&s->shared, &s->pace);
    const float moved_um = s->evolve.moved_mm * 1000.0f;
    ending e;
    e.settled = moved_um < s->shared.config.settle_um && may_end_early(s);
    e.spent = radius_iteration >= radius_iterations(s);
    e.small = moved_um < s->shared.config.plastic_um;
    e.done = s->pace.repairing == 0u && last && (e.settled || e.spent);
    const int due = s->shared.config.plastic_every != 0u && since_plastic >= s->shared.config.plastic_every;
    e.plastic = s->pace.repairing > 0u || (!e.done && (e.small || due || e.settled || e.spent));
    return e;
}

int smr_schedule_plastic(const smr *s)
{
    return ending_of(s, s->pace.radius_iteration + 1u, s->pace.since_plastic + 1u).plastic;
}

/* After each iteration. */
void smr_schedule_next(smr *s)
{
    const ending e = ending_of(s, s->pace.radius_iteration, s->pace.since_plastic);
    const int repairs = s->pace.repairing > 0u; /* these iterations do not count */
    if (repairs) {
        s->pace.repairing = s->folds.n_folding > 0u && s->pace.repairing < SMR_REPAIR_MAX ? s->pace.repairing + 1u : 0u;
        s->pace.radius_iteration = 0;
    }
    if (e.plastic)
        plastic_update(s);
    if (e.done) {
        s->pace.converged = (uint32_t)(e.small || e.settled);
        s->pace.done = 1;
    } else if (!repairs && !smr_at_last_radius(&s->shared, &s->pace) && (e.settled || e.spent)) {
        use_radius(s, s->pace.radius + 1u);
    }
}

/* Image goals jump from sample to sample where the image is poor: over the last radius' second half forces and momentum
 * fall to 0, in equal steps, so that the model comes to rest in their mean. */
static float ease_of(const smr *s)
{
    const uint32_t all = s->shared.config.iterations_last, left = all - smr_min_u32(s->pace.radius_iteration + 1u, all);
    if (!s->forces.image.has_image || !smr_at_last_radius(&s->shared, &s->pace) || left >= all / 2u)
        return 1.0f;
    return (float)left / (float)(all / 2u);
}

/* Search distances and strength of the coming iteration. */
static void choose_distances(smr *s)
{
    s->pace.ease = ease_of(s);
    const float done = smr_schedule_progress(s);
    s->pace.farthest_mm =
        s->shared.config.profile_mm + done * (s->shared.config.profile_end_mm - s->shared.config.profile_mm);
    s->pace.profile_mm = smr_min(s->pace.farthest_mm, s->shared.config.profile_radii * s->pace.lists.radius);
    s->pace.gradient_mm =
        s->shared.config.gradient_mm + done * (s->shared.config.gradient_end_mm - s->shared.config.gradient_mm);
}

float smr_schedule_progress(const smr *s)
{
    if (s->pace.done)
        return 1.0f;
    const float first = (float)first_iterations(s), level = (float)s->shared.config.iterations;
    const uint32_t steps = smr_last_radius(&s->shared) - s->shared.config.radius_first,
                   at = s->pace.radius - s->shared.config.radius_first;
    const float total =
        steps > 0u ? first + level * (float)(steps - 1u) + (float)s->shared.config.iterations_last : first;
    return ((at > 0u ? first + level * (float)(at - 1u) : 0.0f) + (float)s->pace.radius_iteration) / total;
}

/* A target that is set in the iteration counts from the next one on, as in a replay. */
static void begin_targets(smr_surface_goals *g)
{
    g->n_goals_begun = g->n_goals;
    for (uint32_t i = 0; i < g->shared->n_structures; i++)
        g->target[i].begun = g->target[i].surface != NULL;
}

void smr_schedule_begin(smr *s)
{
    choose_active(s);
    s->report.n_taken = s->pace.n_active;
    choose_distances(s);
    begin_targets(&s->forces.surface);
    smr_evening_begin(&s->evolve.evening);
}
