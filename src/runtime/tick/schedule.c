/* schedule.c: what happens between iterations: plasticity (x^r = x), convergence, and the next finer radius.
 * SPDX-License-Identifier: MIT */
#include "runtime/state.h"

#define SMR_REPAIR_MAX 30u
#define SMR_ENOUGH_ALL 1000.0f /* active vertices of the whole model with an image */
#define SMR_ACTIVE_EVERY 8u    /* iterations */
#define SMR_ABOUT 0.75f
#define SMR_FIRST_TIMES                                                                                                \
    2u /* with an image, iterations at the first radius: few vertices have goals, and most of the way is made */
#define SMR_NARROWING 0.5f /* search distances shrink to this share at most, from one radius to the next */

uint32_t smr_last_radius(const smr *s) { return smr_min_u32(s->config.radius_last, s->n_radii - 1u); }

int smr_guarded(const smr *s) { return s->config.fold_guard && s->radius + 2u > smr_last_radius(s); }

/* Image forces cost most of the time, and a large cluster needs few of them: about so many that the smallest cluster keeps
 * active_enough. Whole levels: which vertices they hold does not depend on how the curve runs through the model. */
static float enough_for_image(const smr *s)
{
    const float cluster = (float)s->n * (float)s->config.active_enough / (float)smr_max_u32(s->lists.smallest, 1u);
    const float enough = smr_max(cluster, SMR_ENOUGH_ALL); /* clusters that span the model share their vertices */
    uint32_t level = 0;
    while (level + 1u < smr_le32(s->model->n_levels) &&
           (float)smr_le32(s->model->level_end[level]) < SMR_ABOUT * enough)
        level++;
    return (float)smr_le32(s->model->level_end[level]);
}

/* The first vertices in the order in which they matter that take part now: the share that the configuration asks for, but
 * never too few for the clusters of this radius. */
static uint32_t active_count(const smr *s)
{
    const float n = (float)s->n, last = s->config.active_share, first = smr_min(s->config.active_first, last);
    float count = n * (first + (last - first) * smr_schedule_progress(s));
    if (s->has_grid && s->config.active_enough > 0u)
        count = smr_min(count, enough_for_image(s));
    const uint32_t whole = (uint32_t)count;
    return smr_min_u32(smr_max_u32(whole + ((float)whole < count), s->lists.active_min), s->n);
}

/* A new number makes cluster centres anew, so it waits for a new reference shape, which does so anyway, but not for ever.
 * The caller's own choice does not wait, nor do vertices that the last budget left out. */
void smr_schedule_active(smr *s)
{
    const uint32_t count = s->n_pinned > 0u ? smr_max_u32(s->n_pinned, s->lists.active_min) : active_count(s);
    s->report.n_wanted = count;
    if (count == s->n_active ||
        (s->n_pinned == 0u && !s->control.cut && !s->reference_stale && s->radius_iteration % SMR_ACTIVE_EVERY != 0u))
        return;
    s->n_active = count;
    s->reference_stale = 1;
    s->control.cut = 0;
}

/* With an image alone nothing is repaired: its last radius is not single vertices, so what is folded straightens again, and
 * fold_open.c opens the rest. A repair's patches would lose what forces had found there. */
static int repairs_before(const smr *s, uint32_t radius)
{
    return smr_guarded(s) && s->n_hinges > 0u && (s->begun_goals > 0u || !s->has_grid) &&
           (radius == s->config.radius_first || radius + 1u == smr_last_radius(s));
}

static void use_radius(smr *s, uint32_t radius)
{
    s->radius = radius;
    s->radius_iteration = 0;
    s->lists = smr_model_lists(s->model, radius);
    s->reference_stale = 1;
    s->n_active = active_count(s);
    s->momentum = radius == smr_last_radius(s) ? s->config.momentum_last : s->config.momentum;
    const float before = radius > 0u ? smr_model_lists(s->model, radius - 1u).radius : 0.0f;
    s->search = smr_min(s->config.search_mm, s->config.search_radii * smr_max(s->lists.radius, SMR_NARROWING * before));
    s->fit_due = radius == smr_last_radius(s);
    s->repairing = (uint32_t)repairs_before(s, radius);
}

/* Gives up an iteration under way: x stands, as if it had just been reached without a step, however far it had come. Nothing
 * of it is left, nor of what searches could start from, so that a replay need not know how far that was. */
void smr_abandon_iteration(smr *s)
{
    for (size_t v = 0; s->eigen != NULL && v < s->n; v++)
        for (size_t i = 0; i < 9u; i++)
            s->eigen[9u * v + i] = i % 4u == 0u ? 1.0f : 0.0f;
    if (s->pull != NULL)
        memset(s->pull, 0, s->config.n_workers * (size_t)s->n * 4u * sizeof *s->pull);
    memcpy(s->x_next, s->x, 3u * (size_t)s->n * sizeof(float));
    memset(s->found, 0, s->n);
    memset(s->seen, 0, s->n);
    memset(s->contrast, 0, s->n);
    memset(s->contrast_next, 0, s->n);
    memset(s->lighter, SMR_LIGHTER_NONE, s->n);
    memset(s->lighter_next, SMR_LIGHTER_NONE, s->n);
    memset(s->held, 0, s->n);
    for (uint32_t v = 0; v < s->n; v++)
        s->warm[v] = s->warm_next[v] = SMR_NONE;
    for (uint32_t j = 0; s->target_warm != NULL && j < s->config.n_target_vertices; j++)
        s->target_warm[j] = SMR_NONE;
    for (uint32_t i = 0; i < s->n_parts; i++)
        s->part[i].facets.xyz = s->x;
    smr_facets_now(s);
    smr_mend_abandon(s);
    s->step = s->next_task = 0;
}

void smr_schedule_start(smr *s)
{
    s->iteration = 0;
    s->since_plastic = 0;
    s->plastic_updates = 0;
    s->converged = s->done = s->repairing = 0;
    s->step = 0;
    s->next_task = 0;
    s->force_limit = 0.0f;
    s->ease = 1.0f;
    s->begun_goals = s->n_goals;
    use_radius(s, s->config.radius_first);
    s->fit_due = 1; /* an abandoned iteration may have made it of other positions */
}

static void plastic_update(smr *s)
{
    memcpy(s->x_ref, s->x, 3u * (size_t)s->n * sizeof(float));
    s->reference_stale = 1;
    s->since_plastic = 0;
    s->plastic_updates++;
}

/* At most so many iterations at the radius in use; at the first one in any case. */
static uint32_t first_iterations(const smr *s)
{
    const int alone = s->config.radius_first == smr_last_radius(s);
    return alone ? s->config.iterations_last : s->config.iterations * (s->has_grid ? SMR_FIRST_TIMES : 1u);
}

static uint32_t radius_iterations(const smr *s)
{
    if (s->radius == s->config.radius_first)
        return first_iterations(s);
    return s->radius == smr_last_radius(s) ? s->config.iterations_last : s->config.iterations;
}

/* How an iteration ends that is number radius_iteration at its radius, and since_plastic since x^r was new. */
typedef struct ending {
    int small, spent, settled, done, plastic;
} ending;

/* Evening out takes the whole last radius: an end that comes early is a choice which last bits decide. Rest is rest. A target
 * that is set or taken away in the iteration counts from the next one on, as in a replay. */
static int may_end_early(const smr *s)
{
    return !(s->moved_mm > 0.0f) || s->radius != smr_last_radius(s) || s->begun_goals == 0u || !(s->config.even > 0.0f);
}

/* A radius is done when an iteration moves less than the threshold, or after its number of iterations; the last radius' end
 * is the registration's end. */
static ending ending_of(const smr *s, uint32_t radius_iteration, uint32_t since_plastic)
{
    const int last = s->radius == smr_last_radius(s);
    const float moved_um = s->moved_mm * 1000.0f;
    ending e;
    e.settled = moved_um < s->config.settle_um && may_end_early(s);
    e.spent = radius_iteration >= radius_iterations(s);
    e.small = moved_um < s->config.plastic_um;
    e.done = s->repairing == 0u && last && (e.settled || e.spent);
    const int due = s->config.plastic_every != 0u && since_plastic >= s->config.plastic_every;
    e.plastic = s->repairing > 0u || (!e.done && (e.small || due || e.settled || e.spent));
    return e;
}

int smr_schedule_plastic(const smr *s) { return ending_of(s, s->radius_iteration + 1u, s->since_plastic + 1u).plastic; }

/* After each iteration. */
void smr_schedule_next(smr *s)
{
    const ending e = ending_of(s, s->radius_iteration, s->since_plastic);
    const int repairs = s->repairing > 0u; /* these iterations do not count */
    if (repairs) {
        s->repairing = s->n_folding > 0u && s->repairing < SMR_REPAIR_MAX ? s->repairing + 1u : 0u;
        s->radius_iteration = 0;
    }
    if (e.plastic)
        plastic_update(s);
    if (e.done) {
        s->converged = (uint32_t)(e.small || e.settled);
        s->done = 1;
    } else if (!repairs && s->radius != smr_last_radius(s) && (e.settled || e.spent)) {
        use_radius(s, s->radius + 1u);
    }
}

/* Image goals jump from sample to sample where the image is poor: over the last radius' second half forces and momentum
 * fall to 0, in equal steps, so that the model comes to rest in their mean. */
static float ease_of(const smr *s)
{
    const uint32_t all = s->config.iterations_last, left = all - smr_min_u32(s->radius_iteration + 1u, all);
    if (!s->has_grid || s->radius != smr_last_radius(s) || left >= all / 2u)
        return 1.0f;
    return (float)left / (float)(all / 2u);
}

/* Search distances and strength of the coming iteration. */
void smr_schedule_distances(smr *s)
{
    s->ease = ease_of(s);
    if (!s->done)
        smr_even_share(s);
    const float done = smr_schedule_progress(s);
    s->farthest_mm = s->config.profile_mm + done * (s->config.profile_end_mm - s->config.profile_mm);
    s->profile_mm = smr_min(s->farthest_mm, s->config.profile_radii * s->lists.radius);
    s->gradient_mm = s->config.gradient_mm + done * (s->config.gradient_end_mm - s->config.gradient_mm);
}

float smr_schedule_progress(const smr *s)
{
    if (s->done)
        return 1.0f;
    const float first = (float)first_iterations(s), level = (float)s->config.iterations;
    const uint32_t steps = smr_last_radius(s) - s->config.radius_first, at = s->radius - s->config.radius_first;
    const float total = steps > 0u ? first + level * (float)(steps - 1u) + (float)s->config.iterations_last : first;
    return ((at > 0u ? first + level * (float)(at - 1u) : 0.0f) + (float)s->radius_iteration) / total;
}
