/* outlier_weights.c: the weight of a target vertex by its residual, its distance from the model. A target may hold more
 * than the model: stray points, an instrument, neighbouring bodies in the same file. Residuals of what belongs to the
 * model keep within a few scales. The scales are measured in each iteration and fall from coarse to fine.
 * Method: redescending M-estimator, Tukey's biweight (Beaton and Tukey 1974). The scale is the residual below which
 * half of the area lies that the model can cover: a median absolute deviation among inliers (Hampel 1974), also where
 * the model is a small part of the target. A connected component of the target with few inliers is another body, and
 * none of its vertices pulls. Not a mixture with a uniform share of outliers: that needs exponentials, and its
 * deviation grows where outliers are most of the target.
 * Bounds: two passes over the target vertices an iteration; for a new radius or target one over the model's triangles
 * for each distinct target.
 * SPDX-License-Identifier: MIT */
#include "geometry/box_tree/triangle.h"
#include "registration/surface_goals/closest_point_goals.h"

#define SMR_OUTLIER_CHUNK 256u    /* number of target vertices, or of model triangles, in a task */
#define SMR_OUTLIER_SIGMA 1.4826f /* standard deviation / median absolute value of a normal distribution */
#define SMR_OUTLIER_CUT 4.685f    /* residual / deviation from which on the weight is 0: 95 % efficiency if normal */
#define SMR_OUTLIER_EDGES 1.0f    /* smallest residual of weight 0 on a mesh, in mean edges: triangles are flat */
#define SMR_OUTLIER_POINTS 0.25f  /* smallest residual of weight 0 on a cloud, in mean edges: near strays harm most */
#define SMR_OUTLIER_AREA 65536.0f /* areas are summed in units of 1 / 65536 of the mean area */
#define SMR_OUTLIER_RADII 0.35f   /* smallest residual of weight 0 in cluster radii: large clusters are stiff */
#define SMR_OUTLIER_TRACK 24.0f   /* cluster radius / scale of residuals that is assumed for a moved target */
#define SMR_OUTLIER_TINY 1.0e-20f /* least divisor: compilers divide before they test divisors for 0 */

/* Tips and corners of a mesh have residuals above NONE times SMR_OUTLIER_CUT scales. Each further cut, up to MOST, adds
 * GAIN to their weight; over the first the residual of weight 0 doubles. Else means of pulls hardly reach tips. */
#define SMR_TIP_NONE 2.0f
#define SMR_TIP_MOST 10.0f
#define SMR_TIP_GAIN 8.0f
#define SMR_TIP_MM 1.0e4f /* largest mean edge, mm, of a model with tips: sums of pulls stay within 63 bits */

/* A component's share of inliers / largest share of a component: another body below NONE, the model's above FULL. */
#define SMR_BODY_NONE 0.3f
#define SMR_BODY_FULL 0.6f

/* Residuals are kept in 16 bits, in 1 / 1024 of an octave from 2^-12 mm, and counted in eighths of an octave. */
#define SMR_RESIDUAL_LEAST ((127u - 12u) << 10)
#define SMR_RESIDUAL_STEPS 128u /* number of steps of a stored residual in an eighth of an octave */

void smr_residual_put(smr_surface_goals *g, uint32_t slot, float mm)
{
    const uint32_t steps = smr_float_bits(mm) >> 13;
    g->target_residual[slot] =
        (uint16_t)(steps <= SMR_RESIDUAL_LEAST ? 0u : smr_min_u32(steps - SMR_RESIDUAL_LEAST, SMR_RESIDUAL_NONE - 1u));
}

/* Returns the smallest residual, mm, that is stored as this number of steps. */
static float residual_of(uint32_t steps) { return smr_float_of((SMR_RESIDUAL_LEAST + steps) << 13); }

static float biweight(float r2, float cut)
{
    const float q = smr_positive(1.0f - r2 / smr_max(cut * cut, SMR_OUTLIER_TINY));
    return q * q;
}

/* Returns the residual, mm, from which on vertices of a target with this scale have no weight. */
static float cut_of(const smr_surface_goals *g, const smr_surface *surface, float scale)
{
    const float edges = smr_is_cloud(surface) ? SMR_OUTLIER_POINTS : SMR_OUTLIER_EDGES;
    const int coarse = !g->schedule->tracking || g->schedule->recovering > 0u;
    const float least = smr_max(edges * smr_le_float(g->shared->model->edge_mm),
                                coarse ? SMR_OUTLIER_RADII * g->schedule->lists.radius : 0.0f);
    return smr_max(SMR_OUTLIER_CUT * scale, least);
}

/* Returns by how many cuts the residual of target vertex j is above SMR_TIP_NONE cuts: 0 in clouds and in small
 * components, where it is a stray, and at clusters of an edge or more, whose residuals are those of stiffness. */
static float tip_of(const smr_surface_goals *g, const smr_surface *surface, uint32_t j, float scale, float r2)
{
    const float edge = smr_le_float(g->shared->model->edge_mm);
    if (!(g->schedule->lists.radius < edge) || !(edge < SMR_TIP_MM) || smr_surface_body(surface, j) < SMR_BODY_FIRST)
        return 0.0f;
    const float cuts = SMR_SQRT(r2) / smr_max(SMR_OUTLIER_CUT * scale, SMR_OUTLIER_TINY);
    return smr_clamp(cuts - SMR_TIP_NONE, 0.0f, SMR_TIP_MOST);
}

static uint32_t body_slot(const smr_goal *goal, uint32_t j)
{
    return goal->first_body + smr_min_u32(smr_surface_body(goal->surface, j), SMR_BODY_SMALL + goal->n_bodies);
}

float smr_outlier_weight(const smr_surface_goals *g, const smr_goal *goal, uint32_t j, float r2)
{
    const float scale = g->target[goal->structure].scale;
    if (!(scale > 0.0f)) /* a new target: a mesh waits one iteration, a cloud has no other goals */
        return smr_is_cloud(goal->surface) ? 1.0f : 0.0f;
    const float tip = tip_of(g, goal->surface, j, scale, r2);
    const float cut = cut_of(g, goal->surface, scale) * (1.0f + smr_min(tip, 1.0f));
    return (1.0f + SMR_TIP_GAIN * tip) * biweight(r2, cut) * (1.0f / 255.0f) *
           (float)g->body_weight[body_slot(goal, j)];
}

const unsigned char *smr_other_bodies(const smr_surface_goals *g, uint32_t structure)
{
    if (!g->target[structure].others || !smr_attraction_on(g))
        return NULL;
    const smr_goal *goal = smr_goal_of(g, structure);
    return goal->n_bodies == goal->surface->n_bodies ? g->body_weight + goal->first_body : NULL;
}

/* Returns the number of tasks of one pass over a target; 0: the target does not pull. */
static uint32_t pass_tasks(const smr_surface_goals *g, const smr_goal *goal)
{
    return smr_attracts(g, goal->surface) ? smr_ceil_div(goal->n_vertices, SMR_OUTLIER_CHUNK) : 0u;
}

/* Returns the number of tasks over model triangles: 0 unless radius or target is new, and for points (all inliers). */
static uint32_t area_tasks(const smr_surface_goals *g, const smr_goal *goal)
{
    const int known = g->target[goal->structure].area_share > 0.0f && g->schedule->radius_iteration > 0u;
    return known || smr_is_cloud(goal->surface) || !smr_attracts(g, goal->surface)
               ? 0u
               : smr_ceil_div(g->shared->n_triangles, SMR_OUTLIER_CHUNK);
}

static uint32_t goal_tasks(const smr_surface_goals *g, const smr_goal *goal)
{
    return area_tasks(g, goal) + 2u * pass_tasks(g, goal);
}

uint32_t smr_outlier_tasks(const void *arg)
{
    const smr_surface_goals *g = arg;
    uint32_t n = 0;
    for (uint32_t k = 0; k < g->n_goals; k++)
        n += goal_tasks(g, &g->goal[k]);
    return n;
}

/* Adds the areas of triangles first .. last-1 of the model that belong to structures with this target. */
static void add_area(const smr_surface_goals *g, smr_goal *goal, uint32_t first, uint32_t last)
{
    for (uint32_t i = 0; i < g->shared->n_structures; i++) {
        const smr_shape_structure *one = &g->shape->structure[i];
        const uint32_t end = smr_min_u32(last, one->first_triangle + one->tree.n_triangles);
        if (g->target[i].surface != goal->surface)
            continue;
        for (uint32_t k = smr_max_u32(first, one->first_triangle); k < end; k++)
            goal->model_area += 0.5f * smr_length(smr_corners_cross(g->shape->x, smr_model_triangle(g->shared, k)));
    }
}

/* Returns the largest share of a target's area that the structures with this target can cover. */
static float area_share(const smr_surface_goals *g, const smr_goal *goal)
{
    const float all = goal->surface->area_mean * (float)goal->surface->n_used;
    if (smr_is_cloud(goal->surface))
        return 1.0f;
    if (area_tasks(g, goal) == 0u)
        return g->target[goal->structure].area_share;
    return smr_min(goal->model_area / smr_max(all, SMR_OUTLIER_TINY), 1.0f);
}

/* Adds an area to the histogram's two bins around a residual, so that the scale follows residuals without jumps. */
static void tally(smr_surface_goals *g, uint32_t steps, uint32_t area)
{
    const uint32_t eighth = smr_min_u32(steps / SMR_RESIDUAL_STEPS, SMR_RESIDUALS - 2u),
                   part = steps % SMR_RESIDUAL_STEPS;
    if (steps == SMR_RESIDUAL_NONE) {
        g->histogram[SMR_RESIDUALS - 1u] += (uint64_t)area * SMR_RESIDUAL_STEPS;
        return;
    }
    g->histogram[eighth] += (uint64_t)area * (SMR_RESIDUAL_STEPS - part);
    g->histogram[eighth + 1u] += (uint64_t)area * part;
}

/* Returns the scale of a target's residuals, mm; 0: the model reaches too little of the target. */
static float scale_of(const smr_surface_goals *g, float share)
{
    float half = 0.0f, sum = 0.0f;
    uint32_t k = 0;
    for (uint32_t i = 0; i < SMR_RESIDUALS; i++)
        half += 0.5f * share * (float)g->histogram[i];
    while (k < SMR_RESIDUALS - 1u && sum + (float)g->histogram[k] < half)
        sum += (float)g->histogram[k++];
    if (!(half > 0.0f) || k == SMR_RESIDUALS - 1u)
        return 0.0f;
    const float high = residual_of(k * SMR_RESIDUAL_STEPS),
                low = k > 0u ? residual_of((k - 1u) * SMR_RESIDUAL_STEPS) : high;
    const float part = (half - sum) / smr_max((float)g->histogram[k], 1.0f);
    return SMR_OUTLIER_SIGMA * (low + part * (high - low));
}

/* First pass: counts residuals. Second pass: sums inliers of components. */
static void add_vertices(smr_surface_goals *g, const smr_goal *goal, uint32_t chunk, int second)
{
    const float cut = cut_of(g, goal->surface, goal->scale);
    const uint32_t last = smr_min_u32((chunk + 1u) * SMR_OUTLIER_CHUNK, goal->n_vertices);
    for (uint32_t j = chunk * SMR_OUTLIER_CHUNK; j < last; j++) {
        const uint32_t steps = g->target_residual[goal->first_warm + j];
        const uint32_t area = (uint32_t)(SMR_OUTLIER_AREA * smr_target_area(goal->surface, j) + 0.5f);
        if (!second) {
            tally(g, steps, area);
            continue;
        }
        const float r = residual_of(steps);
        smr_body_sum *sum = &g->body_sum[body_slot(goal, j)];
        sum->area += area;
        sum->inlier += steps < SMR_RESIDUAL_NONE ? (uint32_t)(biweight(r * r, cut) * (float)area + 0.5f) : 0u;
    }
}

void smr_outlier_sum(void *arg, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_surface_goals *g = arg;
    smr_goal *goal = g->goal;
    for (; task >= goal_tasks(g, goal); goal++)
        task -= goal_tasks(g, goal);
    const uint32_t n_area = area_tasks(g, goal), n = pass_tasks(g, goal);
    if (task == 0u) {
        goal->model_area = 0.0f;
        memset(g->histogram, 0, SMR_RESIDUALS * sizeof *g->histogram);
        memset(g->body_sum + goal->first_body, 0, (SMR_BODY_FIRST + goal->n_bodies) * sizeof *g->body_sum);
    }
    if (task < n_area) {
        add_area(g, goal, task * SMR_OUTLIER_CHUNK,
                 smr_min_u32((task + 1u) * SMR_OUTLIER_CHUNK, g->shared->n_triangles));
        return;
    }
    task -= n_area;
    if (task == n) {
        goal->area_share = area_share(g, goal);
        goal->scale = scale_of(g, goal->area_share);
    }
    add_vertices(g, goal, task % n, task >= n);
}

static float inlier_share(const smr_body_sum *sum) { return (float)sum->inlier / smr_max((float)sum->area, 1.0f); }

/* Sets the weight of each component of a target by the component's share of inliers. */
static void weigh_bodies(smr_surface_goals *g, const smr_goal *goal)
{
    const smr_body_sum *sum = g->body_sum + goal->first_body;
    uint8_t *weight = g->body_weight + goal->first_body;
    smr_target *target = &g->target[goal->structure];
    float most = 0.0f;
    target->others = 0;
    for (uint32_t b = SMR_BODY_FIRST; b < SMR_BODY_FIRST + goal->n_bodies; b++)
        most = smr_max(most, inlier_share(&sum[b]));
    for (uint32_t b = SMR_BODY_FIRST; b < SMR_BODY_FIRST + goal->n_bodies; b++) {
        const float over = most > 0.0f ? inlier_share(&sum[b]) / smr_max(most, SMR_OUTLIER_TINY) : 1.0f;
        const float share = smr_clamp((over - SMR_BODY_NONE) / (SMR_BODY_FULL - SMR_BODY_NONE), 0.0f, 1.0f);
        weight[b] = (uint8_t)(255.0f * share + 0.5f);
        target->others |= weight[b] == 0u;
    }
}

void smr_outliers_commit(smr_surface_goals *g)
{
    for (uint32_t k = 0; k < g->n_goals; k++) {
        const smr_goal *goal = &g->goal[k];
        if (!smr_attracts(g, goal->surface))
            continue;
        g->target[goal->structure].scale = goal->scale;
        g->target[goal->structure].area_share = goal->area_share;
        weigh_bodies(g, goal);
    }
    for (uint32_t i = 0; i < g->shared->n_structures; i++)
        for (uint32_t k = 0; k < g->n_goals; k++)
            if (g->goal[k].surface == g->target[i].surface)
                g->target[i].others = g->target[g->goal[k].structure].others;
}

float smr_residual_typical(const smr_surface_goals *g)
{
    float sum = 0.0f, n = 0.0f;
    for (uint32_t k = 0; k < g->n_goals; k++) {
        const float one = smr_attracts(g, g->goal[k].surface) ? 1.0f : 0.0f;
        sum += one * g->target[g->goal[k].structure].scale;
        n += one;
    }
    return sum / (smr_max(n, 1.0f) * SMR_OUTLIER_SIGMA);
}

void smr_outliers_forget(smr_surface_goals *g, uint32_t structure)
{
    const float scale = g->schedule->tracking ? g->schedule->lists.radius / SMR_OUTLIER_TRACK : 0.0f;
    for (uint32_t i = 0; i < g->shared->n_structures; i++) {
        smr_target *target = &g->target[i];
        if (structure == SMR_ALL || structure == i)
            target->scale = scale > 0.0f ? smr_max(target->scale, scale) : 0.0f;
        target->area_share = 0.0f; /* structures may join or leave a target */
        target->others = 0;
    }
    if (g->body_weight != NULL)
        memset(g->body_weight, 255, SMR_BODY_SLOTS(g->shared->n_structures));
}
