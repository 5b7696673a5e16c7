/* cloud_pull_smoothing.c: smooths the pulls of a cloud's points over the mesh, which averages noise and gives goals to
 * vertices between points: a normalised convolution (Knutsson and Westin 1993). In each round a vertex keeps half of
 * its pull and weight and takes half of its mesh neighbours' mean. Displacements are smoothed, not positions, so the
 * model keeps its fine shape. Rounds go on until several points, and where clouds show the whole a fiftieth of the
 * smallest structure, lie within reach of each vertex. Smoothing follows the mesh: a thin wall's far side is near.
 * All clouds use the same number of rounds.
 * Small clusters would follow the noise of points. Leave-one-out cross-validation (Stone 1974) tells noise from motion:
 * goals are shortened to the share of each point's pull that the smoothed pulls of the other points predict.
 * Bounds: SMR_ROUNDS_MAX passes over triangles and vertices, two over vertices, one over the points.
 * SPDX-License-Identifier: MIT */
#include "geometry/box_tree/triangle.h"
#include "log/record/log_format.h"
#include "options/partial/partial.h"

#define SMR_ROUNDS_LEAST 2u   /* smallest number of rounds of smoothing */
#define SMR_ROUNDS_MAX 12u    /* largest number of rounds of smoothing */
#define SMR_REACH_POINTS 4.0f /* smallest mean number of points within reach of a vertex, where ROUNDS_MAX allow */
#define SMR_REACH_PARTS 50.0f /* number of vertices of the smallest structure with a cloud / within reach, at most */
#define SMR_REACH_WHOLE 0.9f  /* share of vertices that pulls reach above which a cloud shows the whole */
#define SMR_POINT_CHUNK 64u   /* number of points in a task that compares pulls with those of other points */

/* A point's share in the smoothed pulls where it lies: its weight / (FIRST + ROUND * rounds) / the weight there. On a
 * regular mesh it is half the probability that a random walk returns, plus half that it ends on a neighbour, to 2 %. */
#define SMR_OWN_FIRST 1.6f
#define SMR_OWN_ROUND 1.8f
#define SMR_OWN_MOST 0.8f         /* largest share of a point that other points are compared with */
#define SMR_CLUSTER_VERTICES 3.6f /* vertices of a cluster on a regular mesh / square of its radius in edges */
#define SMR_SWINGS 0.15f          /* cosine of pulls and the opposite of last displacements above which momentum ends */

/* Returns the cluster radius in mean edges. */
static float radius_edges(const smr_point_spread *p)
{
    return p->goals->schedule->lists.radius / smr_max(smr_le_float(p->shared->model->edge_mm), 1.0e-6f);
}

static uint32_t round_tasks(const smr_point_spread *p) { return smr_triangle_tasks(p->shared) + p->shared->n_tasks; }

uint32_t smr_point_spread_tasks(const void *arg)
{
    const smr_point_spread *p = arg;
    return p->goals->n_clouds > 0u ? 2u * p->shared->n_tasks + p->rounds * round_tasks(p) : 0u;
}

/* Sets the pull of vertex v to the sum of the points' pulls on v: x, y, z and weight; 0 without a cloud. */
static void take(smr_point_spread *p, uint32_t v)
{
    int64_t sum[4];
    float *pull = p->memory.pull + 4u * (size_t)v, *next = p->memory.next + 4u * (size_t)v;
    p->memory.count[v] = 0.0f;
    for (uint32_t i = 0; i < 4u; i++)
        pull[i] = next[i] = 0.0f;
    const smr_surface *surface = p->goals->target[smr_model_owner(p->shared->model, v)].surface;
    if (surface == NULL || !smr_is_cloud(surface))
        return;
    smr_pull_sum(p->goals, v, sum);
    for (uint32_t i = 0; i < 4u && sum[3] > 0; i++) /* weights that round to 0 have no goal */
        pull[i] = (float)sum[i] * (1.0f / SMR_PULL_SCALE);
    p->weight += pull[3];
    const smr_vec pulled = smr_load(pull), step = smr_sub(smr_get3(p->shape->x, v), smr_get3(p->shape->x_next, v));
    p->along += smr_dot(pulled, step);
    p->pulls += smr_dot(pulled, pulled) / smr_max(pull[3], SMR_SUM_TINY);
    p->steps += smr_dot(step, step) * pull[3];
}

/* Adds the pulls of each corner of triangle t to the sums of the other two corners. */
static void add(const smr_point_spread *p, const uint32_t *t)
{
    for (uint32_t c = 0; c < 3u; c++) {
        float *to = p->memory.next + 4u * (size_t)t[c];
        const float *a = p->memory.pull + 4u * (size_t)t[(c + 1u) % 3u];
        const float *b = p->memory.pull + 4u * (size_t)t[(c + 2u) % 3u];
        for (uint32_t i = 0; i < 4u; i++)
            to[i] += a[i] + b[i];
        p->memory.count[t[c]] += 2.0f;
    }
}

/* Replaces the pull of vertex v by the average of this pull and the mesh neighbours' mean pull. */
static void combine(smr_point_spread *p, uint32_t v)
{
    float *pull = p->memory.pull + 4u * (size_t)v, *next = p->memory.next + 4u * (size_t)v;
    const float share = p->memory.count[v] > 0.0f ? 1.0f / p->memory.count[v] : 0.0f;
    p->memory.count[v] = 0.0f;
    for (uint32_t i = 0; i < 4u; i++) {
        pull[i] = 0.5f * (pull[i] + share * next[i]);
        next[i] = 0.0f;
    }
    p->n_reached += pull[3] > 0.0f;
}

/* Adds vertices first .. last - 1 of the model to each target's `spread`, the mean weight of those that pulls reach. */
static void measure(smr_point_spread *p, uint32_t first, uint32_t last)
{
    for (uint32_t i = 0; i < p->shared->n_structures; i++) {
        const smr_shape_structure *one = &p->shape->structure[i];
        const uint32_t begin = one->first_vertex, end = begin + one->n_vertices;
        float *const spread = &p->goals->target[i].spread;
        for (uint32_t k = smr_max_u32(first, begin); k < smr_min_u32(last, end); k++) {
            const uint32_t v = smr_model_position(p->shared->model, k);
            const float weight = p->memory.pull[4u * (size_t)v + 3u];
            *spread = weight + (k > begin ? *spread : 0.0f);
            p->n_reached = (weight > 0.0f) + (k > begin ? p->n_reached : 0u);
            if (k + 1u == end)
                *spread /= smr_max((float)p->n_reached, 1.0f);
        }
    }
}

/* Counts the vertices of structures with a cloud and triangles. */
static void count_parts(smr_point_spread *p)
{
    p->n = 0;
    p->n_smallest = UINT32_MAX;
    for (uint32_t i = 0; i < p->shared->n_structures; i++) {
        const smr_surface *surface = p->goals->target[i].surface;
        const smr_shape_structure *one = &p->shape->structure[i];
        if (surface == NULL || !smr_is_cloud(surface) || one->tree.n_triangles == 0u)
            continue;
        p->n += one->n_vertices;
        p->n_smallest = smr_min_u32(p->n_smallest, one->n_vertices);
    }
}

/* Ends a round of smoothing and decides whether another follows. A pull reaches about 3 r (r + 1) + 1 vertices in r.
 * Where a cloud shows a part, expected errors follow from the part's bends, which more rounds would take away. */
static void end_round(smr_point_spread *p)
{
    const float r = (float)p->rounds, edges = radius_edges(p), in_cluster = SMR_CLUSTER_VERTICES * edges * edges;
    const float reach = 3.0f * r * (r + 1.0f) + 1.0f, reached = (float)p->n_reached;
    const int few = p->weight * reach < SMR_REACH_POINTS * reached;
    const int near = SMR_REACH_PARTS * smr_max(reach, in_cluster) < (float)p->n_smallest;
    const int more = few || (near && reached > SMR_REACH_WHOLE * (float)p->n);
    if (p->rounds < SMR_ROUNDS_LEAST || (p->rounds < SMR_ROUNDS_MAX && more))
        p->rounds++;
    p->n_reached = 0;
}

static void spread_pulls(void *arg, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_point_spread *p = arg;
    const uint32_t n = p->shared->n_tasks, of_triangles = round_tasks(p) - n;
    if (task == 0u) {
        p->rounds = 1;
        p->n_reached = 0;
        count_parts(p);
        p->weight = p->along = p->pulls = p->steps = 0.0f;
    }
    if (task < n) {
        for (uint32_t v = task * SMR_CHUNK; v < smr_chunk_end(p->shared, task); v++)
            take(p, v);
        return;
    }
    if (task >= n + p->rounds * round_tasks(p)) {
        const uint32_t chunk = task - n - p->rounds * round_tasks(p);
        measure(p, chunk * SMR_CHUNK, smr_chunk_end(p->shared, chunk));
        return;
    }
    const uint32_t at = (task - n) % round_tasks(p);
    if (at < of_triangles) {
        const uint32_t last = smr_min_u32((at + 1u) * SMR_TRIANGLE_CHUNK, p->shared->n_triangles);
        for (uint32_t k = at * SMR_TRIANGLE_CHUNK; k < last; k++)
            add(p, smr_model_triangle(p->shared, k));
        return;
    }
    for (uint32_t v = (at - of_triangles) * SMR_CHUNK; v < smr_chunk_end(p->shared, at - of_triangles); v++)
        combine(p, v);
    if (at + 1u == round_tasks(p))
        end_round(p);
}

/* Returns the pull of point j on triangle t of the model at x, mm, and the weights of the place that is pulled. */
static smr_vec pull_of(const smr_point_spread *p, const smr_goal *goal, uint32_t j, const uint32_t *t, float at[3])
{
    const smr_vec y = smr_add(smr_get3(goal->surface->xyz, j), smr_sub(goal->surface->origin, p->shape->origin));
    (void)smr_triangle_closest_of(&y, p->shape->x, t, at);
    return smr_sub(y, smr_corners_mean(smr_corners_of(p->shape->x, t), at));
}

/* Adds to the sums how the pull of point j along the normal goes with the smoothed pulls of the other points. */
static void compare_point(smr_point_spread *p, const smr_goal *goal, uint32_t j)
{
    const uint32_t slot = goal->first_warm + j, k = p->goals->target_warm[slot];
    if (p->goals->target_residual[slot] == SMR_RESIDUAL_NONE || k >= p->shared->n_triangles)
        return;
    const uint32_t *const t = smr_model_triangle(p->shared, k);
    float at[3], s[4] = {0, 0, 0, 0};
    const smr_vec pull = pull_of(p, goal, j, t, at), r = smr_beyond_noise(p->goals, pull);
    const float r2 = smr_dot(pull, pull);
    const float weight = smr_target_area(goal->surface, j) * smr_outlier_weight(p->goals, goal, j, r2);
    for (uint32_t c = 0; c < 3u; c++)
        for (uint32_t i = 0; i < 4u; i++)
            s[i] += at[c] * p->memory.pull[4u * (size_t)t[c] + i];
    const float own = weight / (SMR_OWN_FIRST + SMR_OWN_ROUND * (float)p->rounds);
    if (smr_reject_distance(p->goals, r2) || !(weight > 0.0f) || !(own < SMR_OWN_MOST * s[3]))
        return;
    const smr_vec n = smr_get3(p->shape->triangle_normal, k);
    const smr_vec others = smr_scale(smr_sub(smr_load(s), smr_scale(r, own)), 1.0f / (s[3] - own));
    const float is = smr_dot(n, r), predicted = smr_dot(n, others);
    smr_target *const target = &p->goals->target[smr_model_owner(p->shared->model, t[0])];
    target->product += weight * is * predicted;
    target->square += weight * predicted * predicted;
    target->pulled += weight * is * is;
    target->own += weight * own / s[3];
    target->compared += weight;
}

/* Sets the share of a cloud's goals that the model follows. Large clusters average over their points themselves: only
 * where a point's share in its cluster's motion, 1 / number of points, is as large as in the smoothed pulls, goals are
 * shortened in full. */
static void set_share(const smr_point_spread *p, const smr_goal *goal)
{
    const float edges = radius_edges(p);
    for (uint32_t i = 0; i < p->shared->n_structures; i++) {
        smr_target *target = &p->goals->target[i];
        if (target->surface != goal->surface)
            continue;
        const float predicted = target->square > 0.0f
                                    ? smr_clamp(target->product / smr_max(target->square, SMR_SUM_TINY), 0.0f, 1.0f)
                                    : 1.0f;
        const float in_cluster = target->spread * SMR_CLUSTER_VERTICES * edges * edges;
        const float counts = smr_min(smr_points_in_reach(target) / smr_max(in_cluster, SMR_SUM_TINY), 1.0f);
        target->share = 1.0f - counts * (1.0f - predicted);
    }
}

static uint32_t comparing_tasks(const smr_goal *goal)
{
    return smr_is_cloud(goal->surface) ? smr_ceil_div(goal->n_vertices, SMR_POINT_CHUNK) : 0u;
}

uint32_t smr_point_share_tasks(const void *arg)
{
    const smr_surface_goals *g = ((const smr_point_spread *)arg)->goals;
    uint32_t n = 0;
    for (uint32_t k = 0; g->n_clouds > 0u && k < g->n_goals; k++)
        n += comparing_tasks(&g->goal[k]);
    return n;
}

static void compare_pulls(void *arg, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_point_spread *p = arg;
    const smr_goal *goal = p->goals->goal;
    for (; task >= comparing_tasks(goal); goal++)
        task -= comparing_tasks(goal);
    for (uint32_t i = 0; task == 0u && i < p->shared->n_structures; i++) {
        smr_target *target = &p->goals->target[i];
        if (target->surface == goal->surface)
            target->compared = target->product = target->pulled = target->square = target->own = 0.0f;
    }
    const uint32_t last = smr_min_u32((task + 1u) * SMR_POINT_CHUNK, goal->n_vertices);
    for (uint32_t j = task * SMR_POINT_CHUNK; j < last; j++)
        compare_point(p, goal, j);
    if (last == goal->n_vertices)
        set_share(p, goal);
}

static int cloud_goal(smr_surface_goals *g, uint32_t v, smr_vec *displacement, float *residual)
{
    const smr_vec p = smr_add(smr_get3(g->shape->x, v), g->shape->origin);
    const float weight = g->spread[4u * (size_t)v + 3u];
    g->warm_next[v] = SMR_NONE;
    if (!(weight > 0.0f) || smr_reject_outside(&g->shared->config, p))
        return 0;
    const smr_vec goal = smr_points_goal(g, v);
    *residual = smr_length(goal);
    *displacement = smr_scale(goal, g->target[smr_model_owner(g->shared->model, v)].share);
    if (g->visibility != NULL)
        smr_visibility_judge_points(g, v, weight);
    return 1;
}

/* Returns 1 when pulls oppose the last displacements. */
static int pulls_oppose(const smr_point_spread *p)
{
    return p->goals->n_clouds > 0u && p->along < -SMR_SWINGS * SMR_SQRT(p->pulls * p->steps);
}

const smr_cloud_calls smr_clouds = {
    cloud_goal, spread_pulls, pulls_oppose, compare_pulls, smr_visibility_note_view, smr_points_checksum};

void smr_point_spread_run(void *arg, uint32_t task, uint32_t worker)
{
    ((const smr_point_spread *)arg)->goals->clouds->spread(arg, task, worker);
}

void smr_point_share_run(void *arg, uint32_t task, uint32_t worker)
{
    ((const smr_point_spread *)arg)->goals->clouds->compare(arg, task, worker);
}
