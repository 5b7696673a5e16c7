/* target_to_model_pulls.c: target-to-model attraction. Each target vertex finds the closest point of the deforming
 * model and pulls the corners of that triangle towards itself, weighted by area and barycentric coordinates. Closest
 * points of the model's vertices alone leave parts of the target uncovered. A target vertex also pulls other places of
 * the same structure that are nearly as near, the less the farther away, so last bits of distances change next to
 * nothing. Pulls are summed as 64-bit whole numbers, per worker and then over workers: any order gives the same bits.
 * Bounds: config.forces.node_budget tree nodes for each target vertex and structure that shares its surface.
 * SPDX-License-Identifier: MIT */
#include "geometry/box_tree/triangle.h"
#include "registration/surface_goals/closest_point_goals.h"

/* Length of a cloud's mean normal: below NONE the normal does not restrict the search, at FULL fully, and before
 * tracking from FLAT on not: that of a flat shape says which side was nearer, not which one is shown. */
#define SMR_VIEW_NONE 0.2f
#define SMR_VIEW_FULL 0.4f
#define SMR_VIEW_FLAT 0.45f
#define SMR_VIEW_AGAIN 1.0f     /* 1 + cosine of the largest angle between view and normal of a place, after a jump */
#define SMR_VIEW_FIRST 0.5f     /* the same before the last radius */
#define SMR_KEY_ROUNDED 4.0e-6f /* mm: more than the rounding of a near distance plus the path */

/* Instructions at most: of a target vertex but its searches, for each structure, and for each place that it pulls. */
#define SMR_WORK_TARGET 1500u
#define SMR_WORK_STRUCTURE 40u
#define SMR_WORK_PULL 700u

uint32_t smr_attract_tasks(const void *arg)
{
    const smr_surface_goals *g = arg;
    return smr_attraction_on(g) ? g->n_tasks : 0u;
}

/* Returns 1 while a point without a normal may be nearest to the wrong side of a thin model: before the last radius,
 * and after a jump. */
static int may_cross(const smr_surface_goals *g, const smr_surface *surface, const smr_query *q)
{
    const int lost =
        g->schedule->tracking ? g->schedule->recovering == 1u : !smr_at_last_radius(g->shared, g->schedule);
    return lost && smr_is_cloud(surface) && smr_dot(q->normal, q->normal) < 0.5f;
}

/* Restricts the search of such a point to the side of the model that most points showed in the last iteration, or in
 * the last one before a jump. */
static void face_view(const smr_surface_goals *g, uint32_t structure, smr_query *q)
{
    const smr_vec view = g->target[structure].view;
    const float length = smr_length(view), most = g->schedule->tracking ? SMR_VIEW_AGAIN : SMR_VIEW_FIRST;
    const float rises = (length - SMR_VIEW_NONE) / (SMR_VIEW_FULL - SMR_VIEW_NONE);
    const float falls = (SMR_VIEW_FLAT - length) / (SMR_VIEW_FLAT - SMR_VIEW_FULL);
    const float share = smr_min(smr_min(rises, 1.0f), g->schedule->tracking ? 1.0f : falls);
    q->min_cos = -2.0f;
    if (!(share > 0.0f))
        return;
    q->min_cos = share * most - 1.001f;
    q->normal = smr_scale(view, 1.0f / length);
}

/* Finds the closest acceptable model point on structures with this target, the last of which is `last`: first on the
 * structure found last, whose distance shortens the other searches. Returns 0 when the work ended. */
static int closest_structure(const smr_surface_goals *g, const smr_goal *goal, uint32_t last, smr_query *q,
                             uint32_t warm, smr_worker *w, smr_certainty *known)
{
    const smr_surface *const surface = goal->surface;
    const int crosses = may_cross(g, surface, q);
    const uint32_t n = last + 1u - goal->structure;
    smr_near_list further;
    for (; w->task.pull.at < 2u * n && !known->sure; w->task.pull.at++) {
        const uint32_t i = goal->structure + (w->task.pull.at < n ? w->task.pull.at : w->task.pull.at - n);
        const smr_shape_structure *one = &g->shape->structure[i];
        const uint32_t local = warm - one->first_triangle;
        const int is_warm = local < one->tree.n_triangles;
        if (g->target[i].surface != surface || is_warm != (w->task.pull.at < n))
            continue;
        if (crosses)
            face_view(g, i, q);
        q->warm = is_warm ? local : SMR_NONE;
        smr_near_list *const list = w->task.pull.found == SMR_NONE ? &w->task.pull.near : &further;
        smr_hit h = w->task.pull.hit;
        h.triangle = SMR_NONE;
        if (!smr_tree_near(&one->tree, q, &h, list, known))
            return 0;
        w->task.pull.n++;
        if (h.triangle == SMR_NONE ||
            !(h.d2 < w->task.pull.hit.d2 || w->task.pull.found == SMR_NONE || i < w->task.pull.found))
            continue;
        w->task.pull.hit = h;
        if (list == &further)
            memcpy(&w->task.pull.near, list, offsetof(smr_near_list, item) + list->n * sizeof *list->item);
        w->task.pull.found = i;
    }
    if (w->task.pull.n != 1u)
        known->other_mm = 0.0f; /* structures that share a target: nothing is known of the others */
    return 1;
}

/* Adds the pull of a target vertex at y to the corners of a triangle. */
static void add_pull(const smr_surface_goals *g, const smr_shape_structure *one, smr_vec y, const smr_near *near,
                     float area, int64_t *pull)
{
    const uint32_t *const t = smr_triangle_at(one->tree.triangle, near->triangle, one->tree.n_vertices);
    const smr_vec r = smr_beyond_noise(g, smr_sub(y, smr_corners_mean(smr_corners_of(one->tree.xyz, t), near->weight)));
    for (uint32_t c = 0; c < 3u; c++) {
        int64_t *to = pull + 4u * (size_t)t[c];
        const float w = area * near->share * near->weight[c] * SMR_PULL_SCALE;
        if (w == 0.0f) /* at an edge or a corner, or as far as the list's limit */
            continue;
        to[0] += (int64_t)(w * r.x);
        to[1] += (int64_t)(w * r.y);
        to[2] += (int64_t)(w * r.z);
        to[3] += (int64_t)w;
    }
}

/* Finds the model point closest to target vertex j on structures up to `last`; adds the vertex' pulls on the model. */
static void pull_one(smr_surface_goals *g, const smr_goal *goal, uint32_t last, uint32_t j, smr_worker *w,
                     int64_t *pull)
{
    const smr_surface *surface = goal->surface;
    const uint32_t slot = goal->first_warm + j;
    const smr_vec y = smr_add(smr_get3(surface->xyz, j), smr_sub(surface->origin, g->shape->origin));
    smr_query q = {y, smr_get3(surface->normal, j), g->shared->min_cos, g->shared->config.forces.node_budget, SMR_NONE};
    if (smr_dot(q.normal, q.normal) < 0.5f)
        q.min_cos = -2.0f;
    g->target_residual[slot] = SMR_RESIDUAL_NONE;
    if (smr_is_cloud(surface) && !(surface->area[j] > 0.0f))
        return;
    if (!w->pause.in_search) {
        w->task.pull.at = w->task.pull.n = 0;
        w->task.pull.found = SMR_NONE;
        w->task.pull.hit = (smr_hit){g->schedule->search_mm * g->schedule->search_mm, SMR_NONE, {0, 0, 0}};
    }
    const smr_target *target = &g->target[goal->structure]; /* where structures share it, nothing is ever known */
    const int crosses = may_cross(g, surface, &q);          /* then nothing is known of the side that is left out */
    const float other = crosses ? 0.0f : g->target_other[slot] - target->path;
    smr_certainty known = smr_known(g, other, crosses ? SMR_FAR : target->moved, SMR_LEARN_PULL, &w->pause);
    g->target_other[slot] = 0.0f; /* a search that is continued does not need the old value */
    if (!closest_structure(g, goal, last, &q, g->target_warm[slot], w, &known) || w->task.pull.found == SMR_NONE)
        return;
    const smr_hit *hit = &w->task.pull.hit;
    const smr_near_list *near = &w->task.pull.near;
    const smr_shape_structure *one = &g->shape->structure[w->task.pull.found];
    g->target_other[slot] = known.other_mm + target->path - SMR_KEY_ROUNDED;
    __atomic_store_n(&g->target_warm[slot], one->first_triangle + hit->triangle, __ATOMIC_RELAXED);
    const smr_vec r = smr_sub(y, smr_triangle_point(&one->tree, hit->triangle, hit->weight));
    const float r2 = smr_dot(r, r), weight = smr_target_area(surface, j) * smr_outlier_weight(g, goal, j, r2);
    smr_residual_put(g, slot, SMR_SQRT(r2));
    if (smr_reject_distance(g, r2) || !(weight > 0.0f))
        return;
    smr_work(&w->pause, near->n * SMR_WORK_PULL);
    for (uint32_t i = 0; i < near->n; i++)
        add_pull(g, one, y, &near->item[i], weight, pull);
}

/* Prefetches what the searches of the target vertices behind j read. Other workers may be writing their triangles. */
static void ahead(const smr_surface_goals *g, const smr_goal *goal, uint32_t j)
{
    const smr_shape_structure *const one = &g->shape->structure[goal->structure];
    const uint32_t *const warm = g->target_warm + goal->first_warm;
    const uint32_t last = goal->n_vertices - 1u, far = smr_min_u32(j + SMR_AHEAD, last);
    const uint32_t near = smr_min_u32(j + SMR_AHEAD / 2u, last);
    smr_tree_ahead(&one->tree, __atomic_load_n(&warm[far], __ATOMIC_RELAXED) - one->first_triangle);
    smr_tree_ahead_corners(&one->tree, __atomic_load_n(&warm[near], __ATOMIC_RELAXED) - one->first_triangle);
}

void smr_attract_search(void *arg, uint32_t task, uint32_t worker)
{
    smr_surface_goals *g = arg;
    smr_worker *w = &g->shared->worker[worker];
    int64_t *pull = g->pull + 4u * (size_t)g->shared->n * worker;
    uint32_t k = 0;
    while (k + 1u < g->n_goals && g->goal[k + 1u].first_task <= task)
        k++;
    const smr_goal *goal = &g->goal[k];
    if (!smr_attracts(g, goal->surface))
        return;
    uint32_t structure = g->shared->n_structures - 1u; /* the last one with this target */
    while (structure > goal->structure && g->target[structure].surface != goal->surface)
        structure--;
    const uint32_t first = (task - goal->first_task) * SMR_FORCE_CHUNK;
    const uint32_t last = smr_min_u32(first + SMR_FORCE_CHUNK, goal->n_vertices);
    const uint32_t work = SMR_WORK_TARGET + SMR_WORK_STRUCTURE * g->shared->n_structures;
    smr_worker_needs(w, work + SMR_NEAR_MOST * SMR_WORK_PULL);
    for (uint32_t j = first + w->at; j < last; j++) {
        if (smr_worker_stops(w, j - first))
            return;
        if (SMR_PREFETCHES)
            ahead(g, goal, j);
        pull_one(g, goal, structure, j, w, pull);
        if (smr_worker_kept(w, j - first, work))
            return;
    }
}

void smr_pull_look(const smr_surface_goals *g, uint32_t v, int64_t sum[4])
{
    sum[0] = sum[1] = sum[2] = sum[3] = 0;
    for (uint32_t w = 0; w < g->shared->config.basic.n_workers; w++) {
        const int64_t *p = g->pull + 4u * ((size_t)g->shared->n * w + v);
        for (uint32_t i = 0; i < 4u; i++)
            sum[i] += p[i];
    }
}

void smr_pull_sum(smr_surface_goals *g, uint32_t v, int64_t sum[4])
{
    smr_pull_look(g, v, sum);
    for (uint32_t w = 0; w < g->shared->config.basic.n_workers; w++)
        memset(g->pull + 4u * ((size_t)g->shared->n * w + v), 0, 4u * sizeof *g->pull);
}

float smr_pull_mean(const int64_t sum[4], smr_vec *mean)
{
    if (sum[3] <= 0)
        return 0.0f;
    const float inverse = 1.0f / (float)sum[3];
    *mean = smr_v((float)sum[0] * inverse, (float)sum[1] * inverse, (float)sum[2] * inverse);
    return smr_min((float)sum[3] * (1.0f / (SMR_PULL_SCALE * SMR_PULL_FULL)), 1.0f);
}

float smr_pull_take(smr_surface_goals *g, uint32_t v, smr_vec *mean)
{
    int64_t sum[4];
    smr_pull_sum(g, v, sum);
    return smr_pull_mean(sum, mean);
}
