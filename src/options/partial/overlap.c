/* overlap.c: how well a target surface shows each vertex, where it lacks parts that the model has. A goal counts less
 * on an open border of the target (the vertex lies beyond it), where the normals disagree, and where it is not
 * mutual: where the model's points closest to the target around the goal lie elsewhere than the vertex. Each falls off
 * continuously. Beyond that the vertex follows its seen neighbours (unseen_field.c).
 * A closed target is taken as whole while most of what is drawn to it is seen: then everything counts in full.
 * A cloud of points shows the vertices that its points' weights reach (point_spread.c).
 * Bounds: three closest points on triangles for each vertex that is judged; two passes over the vertices.
 * SPDX-License-Identifier: MIT */
#include "geometry/box_tree/triangle.h"
#include "options/partial/partial.h"

#define SMR_SEEN_WHOLE 0.9f /* share of a structure seen from which on its closed target is taken as whole */
#define SMR_SEEN_PART 0.7f  /* the same up to which it is taken as a part */
#define SMR_SEEN_COS 0.6f   /* cosine between normals from which on they agree in full */
#define SMR_SEEN_STEADY 8u  /* smaller changes are none, so that goals and weights come to rest */
#define SMR_OFF_EDGES 0.5f  /* mean edges, and */
#define SMR_OFF_RADII 0.1f  /* cluster radii: how far beyond a border nothing is left of a goal, and how far the two */
#define SMR_MUTUAL_WAY                                                                                                 \
    0.2f /* surfaces' closest points may disagree, besides this share of the way between them. From */
#define SMR_MUTUAL_NONE 1.5f  /* half of it on a goal counts less, at so many times nothing */
#define SMR_OFF_LEAST 1.0e-6f /* mm */
#define SMR_POINTS_FULL 0.22f /* of the mean weight of points at a vertex: from here on it is seen in full */

static int cloud_shows(const smr_target *t) { return t->surface != NULL && smr_is_cloud(t->surface); }
static int open_target(const smr_target *t) { return t->surface != NULL && t->surface->open != 0u; }

/* Without triangles a structure has no normals, and nothing of the target finds it. */
static int can_judge(const smr_surface_goals *g, uint32_t structure)
{
    return g->seen != NULL && g->target[structure].surface != NULL &&
           g->shape->structure[structure].facets.n_triangles > 0u;
}

int smr_overlap_lasting(const smr_surface_goals *g, uint32_t structure)
{
    const smr_target *t = &g->target[structure];
    return t->partial != 0u && (g->shared->config.partial.coverage == SMR_COVERAGE_PARTIAL || open_target(t));
}

void smr_overlap_start(smr_surface_goals *g)
{
    g->partial = 0;
    for (uint32_t i = 0; i < g->shared->n_structures; i++) {
        smr_target *t = &g->target[i];
        t->partial = can_judge(g, i) && (g->shared->config.partial.coverage == SMR_COVERAGE_PARTIAL || open_target(t));
        g->partial |= t->partial;
    }
}

/* 1 in an iteration that judges whole targets, too: at each radius' start, where it is decided whether they are, and in
 * the last of all, for what is read out afterwards. */
static int judged_now(const smr_surface_goals *g)
{
    const smr_pace *p = g->pace;
    const int ends =
        smr_at_last_radius(g->shared, p) && p->radius_iteration + 1u >= g->shared->config.basic.iterations_last;
    return p->radius_iteration == 0u || ends;
}

int smr_overlap_judged(const smr_surface_goals *g, uint32_t structure)
{
    return can_judge(g, structure) && (g->target[structure].partial != 0u || judged_now(g));
}

/* The share left of a goal on an open border, by how far the vertex lies beyond it. */
static float inside_border(const smr_surface *target, const smr_hit *hit, smr_vec way, float tolerance)
{
    if (!smr_surface_on_border(target, hit->triangle, hit->weight))
        return 1.0f;
    const smr_vec n = smr_load(target->facets.normal + 3u * (size_t)hit->triangle);
    const float beyond = smr_length(smr_sub(way, smr_scale(n, smr_dot(n, way))));
    return smr_clamp(1.0f - beyond / tolerance, 0.0f, 1.0f);
}

/* What the corners of a target triangle find on a structure of the model: the mean of their closest points there. */
typedef struct answer {
    smr_vec sum;  /* mm, times the weight that found something */
    float weight; /* of the corners that found something */
    float way;    /* mm: how far away, times the weight */
} answer;

/* The present closest point of target vertex j on the triangle that it found last. */
static void add_corner(const smr_surface_goals *g, const smr_shape_structure *one, const smr_surface *target,
                       uint32_t j, uint32_t triangle, float weight, answer *a)
{
    const uint32_t *t = one->facets.triangle + 3u * (size_t)triangle;
    const float *x = g->shape->x;
    const smr_vec y = smr_add(smr_load(target->xyz + 3u * (size_t)j), smr_sub(target->origin, g->shape->origin));
    float w[3];
    const float d2 = smr_triangle_closest(y, smr_load(x + 3u * (size_t)t[0]), smr_load(x + 3u * (size_t)t[1]),
                                          smr_load(x + 3u * (size_t)t[2]), w);
    a->sum = smr_add(a->sum, smr_scale(smr_facet_point(&one->facets, triangle, w), weight));
    a->weight += weight;
    a->way += weight * SMR_SQRT(d2);
}

/* The first slot of a target's vertices in target_warm. */
static uint32_t first_warm(const smr_surface_goals *g, const smr_surface *target)
{
    uint32_t k = 0;
    while (k + 1u < g->n_goals && g->goal[k].surface != target)
        k++;
    return g->goal[k].first_warm;
}

/* The share left of a goal that the target does not return. */
static float mutual(const smr_surface_goals *g, uint32_t v, const smr_surface *target, const smr_hit *hit,
                    float tolerance)
{
    const smr_shape_structure *one = &g->shape->structure[smr_model_owner(g->shared->model, v)];
    const uint32_t *corner = target->triangle + 3u * (size_t)hit->triangle;
    answer a = {{0, 0, 0}, 0, 0};
    if (!smr_attracts(g, target))
        return 1.0f;
    const uint32_t *warm = g->target_warm + first_warm(g, target);
    for (uint32_t c = 0; c < 3u; c++) {
        const uint32_t triangle = warm[corner[c]] - one->first_triangle;
        if (warm[corner[c]] != SMR_NONE && triangle < one->facets.n_triangles && hit->weight[c] > 0.0f)
            add_corner(g, one, target, corner[c], triangle, hit->weight[c], &a);
    }
    if (!(a.weight >= 0.5f))
        return 0.0f;
    const smr_vec at = smr_load(smr_at3(g->shape->x, v)), found = smr_scale(a.sum, 1.0f / a.weight);
    tolerance += SMR_MUTUAL_WAY * a.way / a.weight;
    return smr_clamp(SMR_MUTUAL_NONE - smr_length(smr_sub(found, at)) / tolerance, 0.0f, 1.0f);
}

/* What is not laid out yet, while clusters are large, may be off by more. */
static float tolerance_of(const smr_surface_goals *g)
{
    const float edge = smr_le_float(g->shared->model->edge_mm);
    return smr_max(SMR_OFF_EDGES * edge + SMR_OFF_RADII * g->pace->lists.radius, SMR_OFF_LEAST);
}

static void put_seen(smr_surface_goals *g, uint32_t v, float share)
{
    const uint32_t now = (uint32_t)(share * (float)SMR_SEEN_ONE + 0.5f), before = g->seen[v];
    g->seen_next[v] = (uint8_t)(now + SMR_SEEN_STEADY >= before && now <= before + SMR_SEEN_STEADY ? before : now);
}

void smr_overlap_judge(smr_surface_goals *g, uint32_t v, const smr_surface *target, const smr_hit *hit, smr_vec way)
{
    const float tolerance = tolerance_of(g);
    const smr_vec normal = smr_load(smr_at3(g->shape->normal, v));
    const smr_vec other = smr_load(target->facets.normal + 3u * (size_t)hit->triangle);
    const float least = smr_min(g->shared->min_cos, SMR_SEEN_COS - 0.1f);
    const float agree = smr_clamp((smr_dot(normal, other) - least) / (SMR_SEEN_COS - least), 0.0f, 1.0f);
    float share = agree * inside_border(target, hit, way, tolerance);
    if (share > 0.0f)
        share *= mutual(g, v, target, hit, tolerance);
    put_seen(g, v, share);
}

void smr_overlap_judge_points(smr_surface_goals *g, uint32_t v, float weight)
{
    const float full = SMR_POINTS_FULL * g->target[smr_model_owner(g->shared->model, v)].spread;
    put_seen(g, v, weight < full ? weight / full : 1.0f);
}

float smr_overlap_shown(const smr_surface_goals *g, uint32_t v, int has_goal)
{
    if (g->target[smr_model_owner(g->shared->model, v)].partial)
        return (float)g->seen_next[v] * (1.0f / (float)SMR_SEEN_ONE);
    return has_goal ? 1.0f : 0.0f;
}

float smr_overlap_part(const smr_surface_goals *g, uint32_t v)
{
    const smr_target *t = &g->target[smr_model_owner(g->shared->model, v)];
    const float seen = (float)t->n_seen / (float)smr_max_u32(t->n_judged, 1);
    return smr_clamp((SMR_SEEN_WHOLE - seen) / (SMR_SEEN_WHOLE - SMR_SEEN_PART), 0.0f, 1.0f);
}

/* Counts what is seen of each structure: vertices without a goal are unseen, those without triangles do not count. */
static void count_seen(const smr_surface_goals *g)
{
    for (uint32_t i = 0; i < g->shared->n_structures; i++)
        g->target[i].n_seen = g->target[i].n_judged = 0;
    for (uint32_t v = 0; v < g->pace->n_active; v++) {
        smr_target *t = &g->target[smr_model_owner(g->shared->model, v)];
        t->n_seen += g->seen[v] > SMR_SEEN_ONE / 2u;
        t->n_judged += g->shape->on_surface[v];
    }
}

/* Which way the places face that a cloud shows: the mean of their normals, short where it shows them all around. Known
 * while the model is laid out, unless what is followed has jumped: then the look may be a wrong one. */
void smr_overlap_look(smr_surface_goals *g)
{
    const smr_pace *p = g->pace;
    const int laid_out = p->tracking ? p->recovering != 1u : smr_at_last_radius(g->shared, p);
    if (g->shared->config.track.mode == SMR_TRACK_OFF || g->seen == NULL || g->n_clouds == 0u || !laid_out || p->jumped)
        return;
    for (uint32_t i = 0; i < g->shared->n_structures; i++)
        if (cloud_shows(&g->target[i]))
            g->target[i].view = smr_v(0, 0, 0);
    for (uint32_t v = 0; v < g->pace->n_active; v++) {
        smr_target *t = &g->target[smr_model_owner(g->shared->model, v)];
        if (g->seen[v] > SMR_SEEN_ONE / 2u && cloud_shows(t))
            t->view = smr_add(t->view, smr_load(smr_at3(g->shape->normal, v)));
    }
    for (uint32_t i = 0; i < g->shared->n_structures; i++) {
        smr_target *t = &g->target[i];
        if (cloud_shows(t))
            t->view = smr_scale(t->view, 1.0f / (float)smr_max_u32(t->n_seen, 1));
    }
}

void smr_overlap_stand(smr_surface_goals *g)
{
    if (g->seen == NULL || !(g->partial || judged_now(g)))
        return;
    memcpy(g->seen, g->seen_next, g->pace->n_active);
    count_seen(g);
    if (g->pace->radius_iteration != 0u || g->shared->config.partial.coverage != SMR_COVERAGE_AUTO)
        return;
    g->partial = 0;
    for (uint32_t i = 0; i < g->shared->n_structures; i++) {
        smr_target *t = &g->target[i];
        if (can_judge(g, i) && !open_target(t))
            t->partial = (float)t->n_seen < SMR_SEEN_WHOLE * (float)t->n_judged;
        g->partial |= t->partial;
    }
}
