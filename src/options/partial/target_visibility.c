/* target_visibility.c: visibility of each vertex in a target that may lack parts of the model. The visibility falls on
 * an open border of the target, where normals disagree, and where the goal is not mutual: the model point closest to
 * the goal lies far from the vertex. Each factor is continuous. A goal counts by the visibility; the field of occluded
 * vertices has the rest of the weight. A closed target counts as whole while most vertices are visible; then all goals
 * have full weight. In a cloud the vertices that its points' weights reach are visible.
 * Bounds: three closest points on triangles for each judged vertex; two passes over the vertices.
 * SPDX-License-Identifier: MIT */
#include "geometry/box_tree/triangle.h"
#include "options/partial/partial.h"

#define SMR_VISIBLE_WHOLE 0.9f   /* share of visible vertices below which a closed target counts as a part */
#define SMR_VISIBLE_PART 0.7f    /* share of visible vertices at or below which smr_visibility_partial() is 1 */
#define SMR_VISIBLE_COS 0.6f     /* cosine of vertex' and target's normals from which the goal has full weight */
#define SMR_VISIBLE_STEADY 8u    /* largest change of a visibility, 0 .. 255, that is ignored, so that goals converge */
#define SMR_OFF_EDGES 0.5f       /* factor on the mean edge length in the tolerance of goals */
#define SMR_OFF_RADII 0.1f       /* factor on the cluster radius in the tolerance of goals */
#define SMR_OFF_LEAST 1.0e-6f    /* smallest tolerance of goals, mm */
#define SMR_MUTUAL_DISTANCE 0.2f /* part of the tolerance of mutual goals / mean distance of closest points */
#define SMR_MUTUAL_NONE 1.5f    /* distance / tolerance from which a mutual goal has weight 0; at 1 the weight is 0.5 */
#define SMR_VISIBLE_CHUNK 1024u /* number of vertices in a task that counts visible vertices */
#define SMR_POINTS_FULL 0.22f   /* weight of points / mean weight from which a vertex is fully visible */

static int cloud_shows(const smr_target *t) { return t->surface != NULL && smr_is_cloud(t->surface); }
static int open_target(const smr_target *t) { return t->surface != NULL && t->surface->open != 0u; }

/* Returns 1 when visibility in structure i can be judged: it has a target surface, and triangles, hence normals. */
static int can_judge(const smr_surface_goals *g, uint32_t i)
{
    return g->visibility != NULL && g->target[i].surface != NULL && g->shape->structure[i].tree.n_triangles > 0u;
}

int smr_visibility_always_partial(const smr_surface_goals *g, uint32_t structure)
{
    const smr_target *t = &g->target[structure];
    return t->partial != 0u && (g->shared->config.partial.coverage == SMR_COVERAGE_PARTIAL || open_target(t));
}

void smr_visibility_start(smr_surface_goals *g)
{
    g->partial = 0;
    for (uint32_t i = 0; i < g->shared->n_structures; i++) {
        smr_target *t = &g->target[i];
        t->partial = can_judge(g, i) && (g->shared->config.partial.coverage == SMR_COVERAGE_PARTIAL || open_target(t));
        g->partial |= t->partial;
    }
}

/* Returns 1 in the first iteration of a radius; after a repair of folds in a later one instead. */
static int judges_whole(const smr_schedule *p)
{
    return p->repaired > 0u ? p->repaired == 1u : p->radius_iteration == 0u;
}

/* Returns 1 when whole targets are judged like parts: once at each radius and in the last iteration of all. */
static int judged_now(const smr_surface_goals *g)
{
    const smr_schedule *p = g->schedule;
    const uint32_t last = g->shared->config.basic.iterations_last;
    return judges_whole(p) || (smr_at_last_radius(g->shared, p) && p->radius_iteration + 1u >= last);
}

int smr_visibility_judged(const smr_surface_goals *g, uint32_t structure)
{
    return can_judge(g, structure) && (g->target[structure].partial != 0u || judged_now(g));
}

/* Returns the weight of a goal on an open border, 0..1, which falls with the vertex' distance beyond the border. */
static float inside_border(const smr_surface *target, const smr_hit *hit, smr_vec displacement, float tolerance)
{
    if (!smr_surface_on_border(target, hit->triangle, hit->weight))
        return 1.0f;
    const smr_vec n = smr_get3(target->tree.normal, hit->triangle);
    const float beyond = smr_length(smr_sub(displacement, smr_scale(n, smr_dot(n, displacement))));
    return smr_clamp(1.0f - beyond / tolerance, 0.0f, 1.0f);
}

/* Weighted sums over the model's points that are closest to the corners of a target triangle. */
typedef struct answer {
    smr_vec sum;    /* sum of the points' positions, mm times weight */
    float weight;   /* sum of the weights of those corners that have a closest point */
    float distance; /* sum of the distances between corner and point, mm times weight */
} answer;

/* Adds to *a the point of a model triangle closest to target vertex j. triangle: the one that j's last search found. */
static void add_corner(const smr_surface_goals *g, const smr_shape_structure *one, const smr_surface *target,
                       uint32_t j, uint32_t triangle, float weight, answer *a)
{
    const uint32_t *t = smr_triangle_at(one->tree.triangle, triangle, one->tree.n_vertices);
    const float *x = g->shape->x;
    const smr_vec y = smr_add(smr_get3(target->xyz, j), smr_sub(target->origin, g->shape->origin));
    float w[3];
    const float d2 = smr_triangle_closest(y, smr_get3(x, t[0]), smr_get3(x, t[1]), smr_get3(x, t[2]), w);
    a->sum = smr_add(a->sum, smr_scale(smr_triangle_point(&one->tree, triangle, w), weight));
    a->weight += weight;
    a->distance += weight * SMR_SQRT(d2);
}

static uint32_t first_warm(const smr_surface_goals *g, const smr_surface *target)
{
    uint32_t k = 0;
    while (k + 1u < g->n_goals && g->goal[k].surface != target)
        k++;
    return g->goal[k].first_warm;
}

/* Returns the weight of v's goal, 0..1: high where the model point closest to the goal is near v. */
static float mutual(const smr_surface_goals *g, uint32_t v, const smr_surface *target, const smr_hit *hit,
                    float tolerance)
{
    const smr_shape_structure *one = &g->shape->structure[smr_model_owner(g->shared->model, v)];
    const uint32_t *corner = smr_triangle_of(target->triangle, hit->triangle, target->n_vertices);
    answer a = {{0, 0, 0}, 0, 0};
    if (!smr_attracts(g, target))
        return 1.0f;
    const uint32_t *warm = g->target_warm + first_warm(g, target);
    for (uint32_t c = 0; c < 3u; c++) {
        const uint32_t triangle = warm[corner[c]] - one->first_triangle;
        if (warm[corner[c]] != SMR_NONE && triangle < one->tree.n_triangles && hit->weight[c] > 0.0f)
            add_corner(g, one, target, corner[c], triangle, hit->weight[c], &a);
    }
    if (!(a.weight >= 0.5f))
        return 0.0f;
    const smr_vec at = smr_get3(g->shape->x, v), found = smr_scale(a.sum, 1.0f / a.weight);
    tolerance += SMR_MUTUAL_DISTANCE * a.distance / a.weight;
    return smr_clamp(SMR_MUTUAL_NONE - smr_length(smr_sub(found, at)) / tolerance, 0.0f, 1.0f);
}

/* Stores the visibility `share`, 0..1, of vertex v for the current forces; small changes keep the old value. */
static void put_visibility(smr_surface_goals *g, uint32_t v, float share)
{
    const uint32_t now = (uint32_t)(share * (float)SMR_VISIBLE_ONE + 0.5f), old = g->visibility[v];
    g->visibility_next[v] = (uint8_t)(now + SMR_VISIBLE_STEADY >= old && now <= old + SMR_VISIBLE_STEADY ? old : now);
}

void smr_visibility_judge(smr_surface_goals *g, uint32_t v, const smr_surface *target, const smr_hit *hit,
                          smr_vec displacement)
{
    const float edge = smr_le_float(g->shared->model->edge_mm), radius = g->schedule->lists.radius;
    const float tolerance = smr_max(SMR_OFF_EDGES * edge + SMR_OFF_RADII * radius, SMR_OFF_LEAST);
    const smr_vec normal = smr_get3(g->shape->normal, v), other = smr_get3(target->tree.normal, hit->triangle);
    const float least = smr_min(g->shared->min_cos, SMR_VISIBLE_COS - 0.1f);
    const float agree = smr_clamp((smr_dot(normal, other) - least) / (SMR_VISIBLE_COS - least), 0.0f, 1.0f);
    float share = agree * inside_border(target, hit, displacement, tolerance);
    if (share > 0.0f)
        share *= mutual(g, v, target, hit, tolerance);
    put_visibility(g, v, share);
}

void smr_visibility_judge_points(smr_surface_goals *g, uint32_t v, float weight)
{
    const float full = SMR_POINTS_FULL * g->target[smr_model_owner(g->shared->model, v)].spread;
    put_visibility(g, v, weight < full ? weight / full : 1.0f);
}

float smr_visibility_of(const smr_surface_goals *g, uint32_t v, int has_goal)
{
    if (g->target[smr_model_owner(g->shared->model, v)].partial)
        return (float)g->visibility_next[v] * (1.0f / (float)SMR_VISIBLE_ONE);
    return has_goal ? 1.0f : 0.0f;
}

float smr_visibility_partial(const smr_surface_goals *g, uint32_t v)
{
    const smr_target *t = &g->target[smr_model_owner(g->shared->model, v)];
    const float visible = (float)t->n_visible / (float)smr_max_u32(t->n_judged, 1);
    return smr_clamp((SMR_VISIBLE_WHOLE - visible) / (SMR_VISIBLE_WHOLE - SMR_VISIBLE_PART), 0.0f, 1.0f);
}

/* Sets smr_target.view, the mean normal of vertices that a cloud shows, short when the cloud surrounds the structure.
 * Skipped while a tracked model recovers, and after a jump. */
void smr_visibility_note_view(smr_surface_goals *g)
{
    const smr_schedule *p = g->schedule;
    if (g->visibility == NULL || p->recovering == 1u || p->jumped)
        return;
    for (uint32_t i = 0; i < g->shared->n_structures; i++) {
        smr_target *t = &g->target[i];
        if (cloud_shows(t))
            t->view = smr_scale(t->facing, 1.0f / (float)smr_max_u32(t->n_visible, 1));
    }
}

uint32_t smr_visibility_tasks(const void *arg)
{
    const smr_surface_goals *g = arg;
    const int counts = g->visibility != NULL && (g->partial || judged_now(g));
    return counts ? smr_ceil_div(g->schedule->n_active, SMR_VISIBLE_CHUNK) : 0u;
}

void smr_visibility_count(void *arg, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_surface_goals *g = arg;
    const uint32_t first = task * SMR_VISIBLE_CHUNK;
    for (uint32_t i = 0; i < g->shared->n_structures && task == 0u; i++) {
        g->target[i].visible_now = g->target[i].judged_now = 0;
        g->target[i].facing = smr_v(0, 0, 0);
    }
    for (uint32_t v = first; v < smr_min_u32(first + SMR_VISIBLE_CHUNK, g->schedule->n_active); v++) {
        smr_target *t = &g->target[smr_model_owner(g->shared->model, v)];
        const uint32_t visible = g->visibility_next[v] > SMR_VISIBLE_ONE / 2u;
        t->visible_now += visible;
        if (visible && cloud_shows(t))
            t->facing = smr_add(t->facing, smr_get3(g->shape->normal, v));
        t->judged_now += g->shape->on_surface[v]; /* only vertices of triangles are judged */
    }
}

void smr_visibility_commit(smr_surface_goals *g)
{
    if (smr_visibility_tasks(g) == 0u)
        return;
    for (uint32_t i = 0; i < g->shared->n_structures; i++) {
        g->target[i].n_visible = g->target[i].visible_now;
        g->target[i].n_judged = g->target[i].judged_now;
    }
    if (!judges_whole(g->schedule) || g->shared->config.partial.coverage != SMR_COVERAGE_AUTO)
        return;
    g->partial = 0;
    for (uint32_t i = 0; i < g->shared->n_structures; i++) {
        smr_target *t = &g->target[i];
        if (can_judge(g, i) && !open_target(t))
            t->partial = (float)t->n_visible < SMR_VISIBLE_WHOLE * (float)t->n_judged;
        g->partial |= t->partial;
    }
}

uint32_t smr_field_visibility(const smr_occluded_field *f, uint32_t v)
{
    const smr_target *const target = &f->goals->target[smr_model_owner(f->shared->model, v)];
    if (smr_field_of_past(f) && target->surface == NULL)
        return 0u;
    if (f->landmarks->n > 0u)
        return f->landmarks->visibility[v];
    const int in_image = smr_field_of_image(f) || (smr_field_of_part(f) && target->surface == NULL);
    if (!in_image || (target->partial && !smr_field_of_rest(f, v)))
        return f->goals->visibility[v];
    return f->found[v] == SMR_FOUND_GOAL ? SMR_VISIBLE_ONE : 0u;
}
