/* schedule_radius.c: the current cluster radius, and its iterations, active vertices and search distances.
 * Bounds: SMR_RADII_MAX, SMR_LEVELS_MAX.
 * SPDX-License-Identifier: MIT */
#include "registration/schedule_radius.h"

#define SMR_ENOUGH_ALL 1000.0f /* fewest active vertices of the whole model that suffice */
#define SMR_ABOUT 0.75f        /* share of the wanted active vertices at which a priority level suffices */
#define SMR_FIRST_TIMES 2u /* factor on the first radius' iterations with an image: most displacement happens there */
#define SMR_FIXED_ITERATIONS 9u /* most iterations at a radius where progress does not end the radius */
#define SMR_NARROWING 0.5f      /* smallest ratio of the search distances of two successive radii */
#define SMR_TRACK_EDGES 6.0f    /* default radius of tracking, in mean edges */

uint32_t smr_radius_near(const smr_model *m, uint32_t first, uint32_t last, float mm)
{
    uint32_t best = smr_min_u32(smr_max_u32(first, smr_le32(m->coarse_radii)), last);
    for (uint32_t r = best + 1u; r <= last; r++)
        if (mm * mm < smr_model_lists(m, best).radius * smr_model_lists(m, r).radius)
            best = r;
    return best;
}

/* Returns by default a radius whose clusters keep to one structure, so that structures slide and joints turn. */
uint32_t smr_radius_after(const smr *s)
{
    const float asked = s->shared.config.track.radius_mm, edge = smr_le_float(s->shared.model->edge_mm);
    const uint32_t last = smr_last_radius(&s->shared);
    const uint32_t best = smr_radius_near(s->shared.model, s->shared.config.schedule.radius_first, last,
                                          asked > 0.0f ? asked : SMR_TRACK_EDGES * edge);
    if (asked > 0.0f || s->shared.n_structures == 1u)
        return best;
    for (uint32_t r = best; r <= last && smr_model_lists(s->shared.model, r).radius > edge; r++)
        if (smr_model_separate(s->shared.model, r))
            return r;
    return best;
}

int smr_shows_part(const smr *s)
{
    uint32_t i = 0;
    while (i < s->shared.n_structures && !(SMR_HAS_PARTIAL && smr_visibility_always_partial(&s->forces.surface, i)))
        i++;
    return i < s->shared.n_structures;
}

/* Returns the largest number of iterations at a radius between the first and the last. A number and not progress ends
 * radii where progress misleads: the noise of points keeps vertices in motion, a model slides in a target that shows a
 * part of it, and volumes change against the target. */
static uint32_t level_iterations(const smr *s)
{
    const int counts =
        s->shared.config.motion.settle_share > 0.0f &&
        (s->forces.surface.n_clouds_at_begin + s->schedule.part_at_begin > 0u || smr_volumes_used(&s->volumes));
    return smr_min_u32(s->shared.config.basic.iterations, counts ? SMR_FIXED_ITERATIONS : UINT32_MAX);
}

static uint32_t first_iterations(const smr *s)
{
    const int alone = s->shared.config.schedule.radius_first == smr_last_radius(&s->shared);
    const uint32_t times = s->forces.image.has_image                  ? SMR_FIRST_TIMES
                           : s->forces.surface.n_clouds_at_begin > 0u ? SMR_FIRST_CLOUD
                                                                      : 1u;
    return alone ? s->shared.config.basic.iterations_last : level_iterations(s) * times;
}

uint32_t smr_radius_iterations(const smr *s)
{
    const smr_config *c = &s->shared.config;
    if (s->schedule.radius == c->schedule.radius_first)
        return first_iterations(s);
    return smr_at_last_radius(&s->shared, &s->schedule) ? c->basic.iterations_last : level_iterations(s);
}

float smr_radius_progress(const smr *s)
{
    if (s->schedule.done || s->schedule.tracking)
        return 1.0f;
    if (s->shared.config.dynamics.mode)
        return 0.0f;
    const smr_config *c = &s->shared.config;
    const float first = (float)first_iterations(s), level = (float)level_iterations(s);
    const uint32_t steps = smr_last_radius(&s->shared) - c->schedule.radius_first,
                   at = s->schedule.radius - c->schedule.radius_first;
    const float total = steps > 0u ? first + level * (float)(steps - 1u) + (float)c->basic.iterations_last : first;
    return ((at > 0u ? first + level * (float)(at - 1u) : 0.0f) + (float)s->schedule.radius_iteration) / total;
}

/* Returns 1 when fewer active vertices suffice: with an image, whose forces take most of an iteration, and at radii
 * before the last, whose clusters cannot follow single vertices. Not with a cloud that grows. */
static int few_suffice(const smr *s)
{
    const int grows = s->schedule.n_points > 0u && s->forces.surface.n_points > s->schedule.n_points;
    const int coarse = s->shared.config.motion.settle_share > 0.0f && !grows &&
                       !smr_at_last_radius(&s->shared, &s->schedule) && !s->schedule.tracking &&
                       !s->shared.config.dynamics.mode;
    return s->shared.config.schedule.active_enough > 0u && (s->forces.image.has_image || coarse);
}

/* Returns the number of active vertices that suffices: active_enough in the smallest cluster. A whole priority level,
 * whose vertices do not depend on the order along the curve. */
static float enough(const smr *s)
{
    const float n = (float)s->shared.n; /* of these as many as a closed surface of the triangles has get forces */
    const float drawn = 0.5f * (float)s->shared.n_triangles + 2.0f * (float)s->shared.n_structures;
    const float bare = s->shared.n_triangles > 0u ? smr_max(1.0f, n / drawn) : 1.0f;
    const float cluster =
        n * (float)s->shared.config.schedule.active_enough / (float)smr_max_u32(s->schedule.lists.smallest, 1u);
    const float floor = smr_max(cluster, SMR_ENOUGH_ALL); /* as clusters share vertices */
    const float wanted = bare * floor * smr_image_more(&s->forces.image);
    uint32_t level = 0;
    while (level + 1u < smr_le32(s->shared.model->n_levels) &&
           (float)smr_le32(s->shared.model->level_end[level]) < SMR_ABOUT * wanted)
        level++;
    return (float)smr_le32(s->shared.model->level_end[level]);
}

uint32_t smr_radius_active(const smr *s)
{
    const float n = (float)s->shared.n, last = s->shared.config.basic.active_share,
                first = smr_min(s->shared.config.schedule.active_first, last);
    float count = n * (first + (last - first) * smr_radius_progress(s));
    if (few_suffice(s))
        count = smr_min(count, enough(s));
    const uint32_t whole = (uint32_t)count;
    return smr_min_u32(smr_max_u32(whole + ((float)whole < count), s->schedule.lists.active_min),
                       s->schedule.lists.members);
}

/* Returns 1 when folds are repaired before this radius. Not with an image alone: the clusters of its last radius undo
 * folds, and a repair would undo displacements by forces. */
static int repairs_before(const smr *s, uint32_t radius)
{
    return smr_folds_guarded(&s->shared, &s->schedule) && s->shared.n_dihedrals > 0u &&
           (s->forces.surface.n_goals_at_begin > 0u || !s->forces.image.has_image) &&
           (radius == s->shared.config.schedule.radius_first || radius + 1u == smr_last_radius(&s->shared));
}

void smr_radius_take(smr *s)
{
    const smr_config *c = &s->shared.config;
    smr_schedule *p = &s->schedule;
    const float before = p->radius > 0u ? smr_model_lists(s->shared.model, p->radius - 1u).radius : 0.0f;
    p->lists = smr_model_lists(s->shared.model, p->radius);
    if (c->dynamics.mode)
        p->lists.active_min = s->shared.n; /* all vertices are active: only together they conserve momentum */
    const float within = c->forces.search_radii * smr_max(p->lists.radius, SMR_NARROWING * before);
    p->search_mm = smr_min(c->basic.search_mm, within);
}

void smr_radius_go(smr *s, uint32_t radius)
{
    s->schedule.radius = radius;
    s->schedule.n_points = s->forces.surface.n_points_at_begin;
    s->schedule.radius_iteration = 0;
    smr_radius_take(s);
    s->reference.stale = 1;
    s->schedule.n_active = smr_radius_active(s);
    s->shape.rest_pose_due = radius == smr_last_radius(&s->shared);
    s->schedule.repairing = (uint32_t)repairs_before(s, radius);
    s->schedule.repaired = 0;
}
