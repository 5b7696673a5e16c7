/* closest_point_goals.c: the goal of a vertex on its target surface: the closest point with an agreeing normal,
 * averaged with the pulls of target vertices (target_to_model_pulls.c). Displacements along the surface are reduced.
 * Each iteration searches. Searches in one of four iterations, before the last radius, would spare 18 % of a tick with
 * the same error; but goals would jump, and inputs moved together would end more than a micrometre apart.
 * Before the last radius goals shift along the target to where the target bulges as the model does, by a share of a
 * damped Gauss-Newton step: closest points alone let ridges slide off ridges.
 * Source: paper 2.1 and 3, geometric registration. Bounds: config.forces.node_budget tree nodes a vertex.
 * SPDX-License-Identifier: MIT */
#include "geometry/box_tree/triangle.h"
#include "registration/surface_goals/closest_point_goals.h"

#define SMR_FARTHER 1.0001f   /* factor on a displacement, for its rounding */
#define SMR_ROUNDED 2.5e-7f   /* rounding of two positions relative to the target, as a share of the coordinates */
#define SMR_ALIKE_FLAT 122.0f /* (gradient of relief)^2 * area below which shifts get shorter: 1 in 9 % of its root */
#define SMR_ALIKE_REACH 0.05f /* longest shift to an alike place, in search distances */
#define SMR_PATH_MOST 8.0f /* mm: length of `path` at which certainties are discarded, so that its rounding is small */
#define SMR_PATH_LEAST 2.0e-6f /* mm: added to each displacement: more than the rounding of sums up to SMR_PATH_MOST */

/* Saves the state of targets. The caller sets the surfaces again, from which the list of distinct targets follows. */
static void keep_targets(smr_arena *a, smr_surface_goals *g, const smr_shared *shared)
{
    smr_keep_floats(a, &g->limit, 1, 0.0f, FLT_MAX);
    smr_keep_words(a, &g->n_clouds_at_begin, 1, shared->n_structures);
    smr_keep_words(a, &g->n_points_at_begin, 1, UINT32_MAX);
    g->partial = 0;
    for (uint32_t i = 0; smr_keeps(a) && i < shared->n_structures; i++) {
        smr_target none = {0}, *t = g->target == NULL ? &none : &g->target[i];
        smr_keep_words(a, &t->partial, 1, shared->config.partial.coverage != SMR_COVERAGE_WHOLE);
        smr_keep_words(a, &t->n_visible, 1, shared->n);
        smr_keep_words(a, &t->n_judged, 1, shared->n);
        smr_keep_words(a, &t->measured, 1, 1);
        smr_keep_words(a, &t->others, 1, 1);
        smr_keep_floats(a, &t->scale, 1, 0.0f, SMR_KEPT_MM);
        smr_keep_floats(a, &t->area_share, 1, 0.0f, 1.0f);
        smr_keep_floats(a, &t->compared, 3, -FLT_MAX, FLT_MAX); /* and product, pulled */
        smr_keep_floats(a, &t->own, 1, 0.0f, FLT_MAX);
        if (shared->config.partial.coverage != SMR_COVERAGE_WHOLE)
            smr_keep_floats(a, &t->view.x, 3, -SMR_KEPT_UNIT, SMR_KEPT_UNIT);
        g->partial |= t->partial;
    }
}

SMR_SELDOM void smr_surface_goals_layout(smr_arena *a, smr_surface_goals *g, const smr_shared *shared)
{
    const size_t n = shared->n;
    const uint32_t m = smr_target_slots(shared);
    g->target = smr_slot_scratch(a, g->target, shared->n_structures, sizeof *g->target);
    g->goal = smr_slot_scratch(a, g->goal, shared->n_structures, sizeof *g->goal);
    g->warm = smr_slot_indexes(a, g->warm, n, SMR_TRIANGLES_MAX); /* each search checks the index against its surface */
    g->warm_next = smr_slot_scratch(a, g->warm_next, n, sizeof(uint32_t));
    g->other = smr_slot_scratch(a, g->other, n, sizeof *g->other);
    keep_targets(a, g, shared);
    if (shared->config.partial.coverage != SMR_COVERAGE_WHOLE) {
        g->visibility = smr_slot_bytes(a, g->visibility, n, SMR_VISIBLE_ONE);
        g->visibility_next = smr_slot_scratch(a, g->visibility_next, n, 1);
    }
    if (m == 0u)
        return;
    g->then = smr_slot_scratch(a, g->then, shared->n_structures, sizeof *g->then);
    g->target_warm = smr_slot_indexes(a, g->target_warm, m, SMR_TRIANGLES_MAX);
    g->target_other = smr_slot_scratch(a, g->target_other, m, sizeof *g->target_other);
    g->target_residual = smr_slot_scratch(a, g->target_residual, m, sizeof *g->target_residual);
    g->histogram = smr_slot_scratch(a, g->histogram, SMR_RESIDUALS, sizeof *g->histogram);
    g->body_weight = smr_slot_bytes(a, g->body_weight, SMR_BODY_SLOTS(shared->n_structures), 255u);
    g->body_sum = smr_slot_scratch(a, g->body_sum, SMR_BODY_SLOTS(shared->n_structures), sizeof *g->body_sum);
    g->pull = smr_slot_scratch(a, g->pull, shared->config.basic.n_workers * n, 4u * sizeof(int64_t));
}

static void clear_pulls(smr_surface_goals *g, uint32_t k, uint32_t parts)
{
    const smr_piece p = smr_part(g->shared->config.basic.n_workers * g->shared->n, k, parts);
    if (g->pull != NULL)
        memset(g->pull + 4u * (size_t)p.first, 0, 4u * (size_t)(p.last - p.first) * sizeof *g->pull);
}

void smr_pulls_clear(smr_surface_goals *g) { clear_pulls(g, 0, 1); }

static void clear_certainties(smr_surface_goals *g, uint32_t k, uint32_t parts)
{
    const smr_piece p = smr_part(g->shared->n, k, parts),
                    t = smr_part(g->shared->config.basic.n_target_vertices, k, parts);
    memset(g->other + p.first, 0, (p.last - p.first) * sizeof *g->other);
    if (g->target_other != NULL)
        memset(g->target_other + t.first, 0, (t.last - t.first) * sizeof *g->target_other);
    for (uint32_t i = 0; i < g->shared->n_structures; i++)
        g->target[i].path = g->target[i].moved = 0.0f;
}

void smr_certainties_clear(smr_surface_goals *g) { clear_certainties(g, 0, 1); }

/* Discards what the target vertices of a structure know of other triangles. */
static void clear_pulling(smr_surface_goals *g, uint32_t structure)
{
    g->target[structure].path = 0.0f;
    for (uint32_t k = 0; k < g->n_goals && g->target_other != NULL; k++)
        if (g->goal[k].structure == structure)
            memset(g->target_other + g->goal[k].first_warm, 0, g->goal[k].n_vertices * sizeof *g->target_other);
}

void smr_certainties_age(smr_surface_goals *g, float *most2)
{
    const uint32_t n = g->shared->n_structures;
    for (uint32_t i = 0; i < n && most2 != NULL; i++) {
        float moved2 = 0.0f;
        for (uint32_t k = i; k < n * g->shared->config.basic.n_workers; k += n) {
            moved2 = smr_max(moved2, most2[k]);
            most2[k] = 0.0f;
        }
        g->target[i].moved = SMR_SQRT(moved2);
        g->target[i].path += SMR_FARTHER * g->target[i].moved + SMR_PATH_LEAST;
        if (!(g->target[i].path < SMR_PATH_MOST))
            clear_pulling(g, i);
    }
}

static void clear_target_warm(smr_surface_goals *g, uint32_t k, uint32_t parts)
{
    const smr_piece t = smr_part(g->shared->config.basic.n_target_vertices, k, parts);
    for (uint32_t j = t.first; g->target_warm != NULL && j < t.last; j++)
        g->target_warm[j] = SMR_NONE;
}

void smr_target_warm_clear(smr_surface_goals *g) { clear_target_warm(g, 0, 1); }

SMR_SELDOM void smr_surface_goals_reset(smr_surface_goals *g, uint32_t k, uint32_t parts)
{
    const smr_piece p = smr_part(g->shared->n, k, parts);
    clear_pulls(g, k, parts);
    clear_certainties(g, k, parts);
    clear_target_warm(g, k, parts);
    if (g->visibility != NULL) {
        memset(g->visibility + p.first, 0, p.last - p.first);
        memset(g->visibility_next + p.first, 0, p.last - p.first);
    }
    for (uint32_t v = p.first; v < p.last; v++)
        g->warm[v] = g->warm_next[v] = SMR_NONE;
    if (k > 0u)
        return;
    smr_outliers_forget(g, SMR_ALL);
    for (uint32_t i = 0; i < g->shared->n_structures; i++)
        g->target[i].view = smr_v(0, 0, 0);
}

void smr_surface_goals_commit(smr_surface_goals *g)
{
    for (uint32_t i = 0; i < g->shared->n_structures; i++)
        g->target[i].noise = smr_noise_of(&g->target[i], smr_le_float(g->shared->model->edge_mm));
    if (smr_attraction_on(g))
        smr_outliers_commit(g);
}

smr_status smr_targets_valid(const smr_surface_goals *g)
{
    smr_status status = SMR_OK;
    for (uint32_t i = 0; i < g->shared->n_structures; i++) {
        const smr_target *t = &g->target[i];
        if (t->surface == NULL)
            continue;
        if (!smr_surface_valid(t->surface) || t->surface->n_vertices != t->n_vertices ||
            t->surface->changes != t->changes)
            return SMR_E_STATE;
        if (smr_surface_guard(t->surface) != t->guard)
            status = SMR_E_DAMAGED;
    }
    return status;
}

/* Returns what the last search for v, at the positions before, makes known at p, v's present position. */
static smr_certainty known_of(const smr_surface_goals *g, uint32_t v, smr_vec p, smr_pause *pause)
{
    const float step = smr_length(smr_sub(smr_get3(g->shape->x, v), smr_get3(g->shape->x_next, v)));
    const float rounded = SMR_ROUNDED * (smr_abs(p.x) + smr_abs(p.y) + smr_abs(p.z));
    const float other = (float)g->other[v] * smr_other_unit(g);
    return smr_known(g, other - SMR_FARTHER * step - rounded, step, SMR_LEARN_GOAL, pause);
}

/* Returns the position of vertex v, mm from the target's origin. */
static smr_vec from_target(const smr_surface_goals *g, uint32_t v, const smr_surface *target)
{
    return smr_add(smr_get3(g->shape->x, v), smr_sub(g->shape->origin, target->origin));
}

/* Finds the closest point of the target to vertex v. Returns 0 when no point is acceptable. */
static int project(smr_surface_goals *g, uint32_t v, const smr_surface *target, smr_pause *pause,
                   smr_surface_find *find)
{
    const smr_config *c = &g->shared->config;
    const smr_vec p = from_target(g, v, target);
    smr_certainty known = known_of(g, v, p, pause);
    g->warm_next[v] = g->warm[v];
    g->other[v] = 0;
    find->hit = (smr_hit){0.0f, SMR_NONE, {0, 0, 0}};
    find->displacement = smr_v(0, 0, 0);
    if (smr_reject_outside(c, smr_add(p, target->origin)))
        return 0;
    smr_query q = {p, smr_get3(g->shape->normal, v), g->shared->min_cos, c->forces.node_budget, g->warm[v]};
    if (smr_dot(q.normal, q.normal) < 0.5f)
        q.min_cos = -2.0f; /* a vertex without triangles has no normal: all normals agree */
    smr_hit hit = {g->schedule->search_mm * g->schedule->search_mm, SMR_NONE, {0, 0, 0}};
    const unsigned char *const use = smr_other_bodies(g, smr_model_owner(g->shared->model, v));
    if (!smr_surface_search_known(target, use, &q, &hit, &known) || hit.triangle == SMR_NONE)
        return 0;
    g->warm_next[v] = hit.triangle;
    const float units = known.other_mm / smr_max(smr_other_unit(g), 1.0e-20f);
    g->other[v] = (uint16_t)smr_clamp(units, 0.0f, 65535.0f); /* rounded down */
    if (smr_reject_border(g, target, &hit) || smr_reject_distance(g, hit.d2))
        return 0;
    find->hit = hit;
    find->displacement = smr_sub(smr_triangle_point(&target->tree, hit.triangle, hit.weight), p);
    return !smr_reject_outside(c, smr_add(smr_add(p, find->displacement), target->origin));
}

/* Returns the mean, mm, of the displacement `goal` to the closest point and the mean pull, which has this weight. */
static smr_vec blend(const smr_surface_goals *g, int has_goal, smr_vec goal, float weight, smr_vec pull)
{
    const float share = has_goal ? g->shared->config.basic.attraction * weight : weight;
    return smr_add(smr_scale(goal, 1.0f - share), smr_scale(pull, share));
}

/* Returns the stored relief of the model at v. */
static int relief_of(const smr_surface_goals *g, uint32_t v) { return (int16_t)smr_le16(g->shared->relief[v]); }

/* Returns the shift of v's goal, mm, in the plane of the closest triangle, to where the target bulges as the model. */
static smr_vec to_alike(const smr_surface_goals *g, uint32_t v, const smr_surface *target, const smr_hit *hit)
{
    const float *const f = target->relief, *const w = hit->weight, weight = g->shared->config.forces.curvature;
    const uint32_t *const t = smr_triangle_of(target->triangle, hit->triangle, target->n_vertices);
    const float area = target->area_mean * (float)target->n_used;
    smr_vec rise = smr_v(0, 0, 0), n = rise; /* gradient of relief, 1/mm; normal */
    for (uint32_t k = 0; k < 3u; k++) {
        rise = smr_add(rise, smr_scale(smr_get3(target->slope, t[k]), w[k]));
        n = smr_add(n, smr_scale(smr_get3(target->normal, t[k]), w[k]));
    }
    if (!(smr_dot(n, smr_get3(g->shape->normal, v)) > 0.0f))
        return smr_v(0, 0, 0); /* a surface inside out bulges the other way */
    const float less =
        (float)relief_of(g, v) * (1.0f / SMR_RELIEF_ONE) - (w[0] * f[t[0]] + w[1] * f[t[1]] + w[2] * f[t[2]]);
    const smr_vec shift = smr_scale(rise, less / (smr_dot(rise, rise) + SMR_ALIKE_FLAT / smr_max(area, SMR_SUM_TINY)));
    const float most = SMR_ALIKE_REACH * g->schedule->search_mm, length = smr_length(shift);
    return smr_scale(shift, length > most ? weight * most / smr_max(length, SMR_SUM_TINY) : weight);
}

/* Returns 1 when relief may lead goals. In contact others decide what moves along a surface; within a box or the noise
 * that the caller states goals stay as they are. */
static int relief_leads(const smr_config *c)
{
    return c->forces.curvature > 0.0f && !(c->contact.share > 0.0f) && !c->forces.use_box &&
           !(c->partial.noise_mm > 0.0f);
}

/* Returns 1 when goals of v shift to where the target is alike: before the last radius, where both have a relief. On a
 * partial target vertices that it does not show would follow. */
static int leads_to_alike(const smr_surface_goals *g, uint32_t v, const smr_surface *target)
{
    return relief_leads(&g->shared->config) && target->relief != NULL && g->shared->relief != NULL &&
           relief_of(g, v) != SMR_RELIEF_NONE && !g->target[smr_model_owner(g->shared->model, v)].partial &&
           !smr_at_last_radius(g->shared, g->schedule) && !g->schedule->tracking;
}

int smr_surface_goal(smr_surface_goals *g, uint32_t v, const smr_surface *target, smr_pause *pause,
                     smr_vec *displacement, smr_surface_find *find)
{
    smr_vec pull = smr_v(0, 0, 0);
    const int has_goal = project(g, v, target, pause, find);
    if (pause->kept)
        return 0;
    float weight = smr_attraction_on(g) ? smr_pull_take(g, v, &pull) : 0.0f;
    if (!has_goal && g->shared->config.forces.use_box)
        weight = 0.0f; /* no pulls act outside the box */
    const smr_vec goal = has_goal ? smr_beyond_noise(g, find->displacement) : smr_v(0, 0, 0);
    *displacement = smr_off_surface(g, v, blend(g, has_goal, goal, weight, pull));
    if (has_goal && leads_to_alike(g, v, target))
        *displacement = smr_add(*displacement, to_alike(g, v, target, &find->hit));
    return has_goal || weight > 0.0f;
}

/* Returns the displacement of vertex v to the closest point of a target triangle, mm. */
static smr_vec to_triangle(const smr_surface_goals *g, uint32_t v, const smr_surface *target, uint32_t triangle)
{
    const uint32_t *const t = smr_triangle_of(target->triangle, triangle, target->n_vertices);
    const smr_vec p = from_target(g, v, target), a = smr_get3(target->xyz, t[0]), b = smr_get3(target->xyz, t[1]);
    float w[3];
    (void)smr_triangle_closest(p, a, b, smr_get3(target->xyz, t[2]), w);
    return smr_sub(smr_triangle_point(&target->tree, triangle, w), p);
}

smr_vec smr_surface_goal_again(const smr_surface_goals *g, uint32_t v)
{
    const smr_surface *const target = g->target[smr_model_owner(g->shared->model, v)].surface;
    smr_vec goal = smr_v(0, 0, 0), pull = goal;
    int64_t sum[4] = {0, 0, 0, 0};
    if (target == NULL || smr_is_cloud(target))
        return goal;
    const int has_goal = g->warm[v] < target->tree.n_triangles;
    if (has_goal)
        goal = smr_beyond_noise(g, to_triangle(g, v, target, g->warm[v]));
    if (smr_attraction_on(g))
        smr_pull_look(g, v, sum);
    return blend(g, has_goal, goal, smr_pull_mean(sum, &pull), pull);
}
