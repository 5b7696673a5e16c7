/* verdict_target_measures.c: stages that measure how a structure lies on its target. On a surface: distances in both
 * directions, integrated over the area. On a cloud: residuals of points, coverage, agreement of normals.
 * Bounds: a search for each vertex and triangle of a target surface; two for each point of a cloud and structure that
 * shares it; SMR_MEASURE_PIECE of them in a task.
 * SPDX-License-Identifier: MIT */
#include "base/lanes.h"
#include "geometry/box_tree/triangle.h"
#include "verdict/verdict_measures.h"

#define SMR_MEASURE_NODES 4096u /* most nodes that a search opens */
#define SMR_MEASURE_AGREE 0.0f  /* cosine of the angle between two normals above which the normals agree */
#define SMR_SURELY 1.001f       /* factor on distances, so that rounding errors do not cover the target */
/* Vertices in a task whose distances are found together; fewer where a piece takes long. No result depends on it. */
#define SMR_MEASURE_GROUP (SMR_LANES / 2u)
#define SMR_MEASURE_PIECE 7u   /* triangles of the target or points in a task that searches for each of them */
#define SMR_MEASURE_NORMALS 5u /* triangles of the model in a task, which are searched for together */

static float visible_part(const smr_judgement *j, const uint32_t *t)
{
    const unsigned char *visible = smr_judged_visible(j->s);
    const uint32_t n = (visible[t[0]] & SMR_JUDGED_VISIBLE) + (visible[t[1]] & SMR_JUDGED_VISIBLE) +
                       (visible[t[2]] & SMR_JUDGED_VISIBLE);
    return (float)n * (1.0f / 3.0f);
}

static smr_vec centre_of(smr_corner_values v) { return smr_scale(smr_add(v.a, smr_add(v.b, v.c)), 1.0f / 3.0f); }

/* Finds the point closest to q, within the squared distance most2, on the structures that share a target. Returns the
 * structure; SMR_NONE: none. */
static uint32_t closest(const smr *s, const smr_surface *target, const smr_query *q, float most2, smr_hit *hit)
{
    uint32_t found = SMR_NONE;
    *hit = (smr_hit){most2, SMR_NONE, {0, 0, 0}};
    for (uint32_t i = 0; i < s->shared.n_structures; i++) {
        const smr_box_tree *f = &s->shape.structure[i].tree;
        smr_hit one = *hit;
        if (s->forces.surface.target[i].surface != target || f->n_triangles == 0u)
            continue;
        smr_tree_closest(f, q, &one);
        if (one.d2 < hit->d2) {
            *hit = one;
            found = i;
        }
    }
    return found;
}

/* ---- surfaces ---- */

/* Returns the mask of the target's triangles that count: those of other bodies do not. */
static smr_tree_mask mask_of(const smr_judgement *j)
{
    return (smr_tree_mask){smr_judged_target(j)->work.body, smr_other_bodies(&j->s->forces.surface, j->structure)};
}

/* Vertices or triangles of the model whose closest points on the target are searched together. */
typedef struct group {
    smr_query query[SMR_GROUP_POINTS];
    smr_hit hit[SMR_GROUP_POINTS];
    uint32_t item[SMR_GROUP_POINTS], n;
} group;

/* Adds a position of the model to the group, with its normal, a target triangle to try first, and the squared search
 * distance. Returns 1 when the group is full. */
static int add_query(const smr_judgement *j, group *g, uint32_t item, smr_vec at, smr_vec normal, uint32_t warm,
                     float d2)
{
    const smr_vec to = smr_add(at, smr_sub(j->s->shape.origin, smr_judged_target(j)->origin));
    g->query[g->n] = (smr_query){to, normal, -2.0f, SMR_MEASURE_NODES, warm};
    g->hit[g->n] = (smr_hit){d2, SMR_NONE, {0, 0, 0}};
    g->item[g->n++] = item;
    return g->n == SMR_GROUP_POINTS;
}

static void search_group(const smr_judgement *j, group *g)
{
    const smr_tree_mask mask = mask_of(j);
    const int masked = mask.use != NULL || smr_judged_target(j)->n_fragment > 0u;
    if (g->n > 0u)
        smr_closest_group(&smr_judged_target(j)->tree, masked ? &mask : NULL, g->query, g->n, g->hit);
}

static void take_distances(const smr_judgement *j, group *g)
{
    search_group(j, g);
    for (uint32_t i = 0; i < g->n; i++) {
        smr_judged_nearest(j)[g->item[i]] = g->hit[i].triangle;
        smr_judged_distance(j)[g->item[i]] = g->hit[i].triangle == SMR_NONE ? SMR_FAR : SMR_SQRT(g->hit[i].d2);
    }
}

uint32_t smr_distances_tasks(const void *job)
{
    const smr_judgement *j = job;
    return j->by == SMR_BY_SURFACE ? smr_ceil_div(smr_judged(j)->n_vertices, SMR_MEASURE_GROUP) : 0u;
}

void smr_distances_find(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    const smr_judgement *j = job;
    const smr *s = j->s;
    const smr_piece piece = smr_piece_of(task, SMR_MEASURE_GROUP, smr_judged(j)->n_vertices);
    group g = {.n = 0};
    for (uint32_t i = piece.first; i < piece.last; i++) {
        const uint32_t v = smr_judged_list(j)[i];
        (void)add_query(j, &g, v, smr_get3(s->shape.x, v), smr_get3(s->shape.normal, v), s->forces.surface.warm[v],
                        SMR_FAR);
    }
    take_distances(j, &g);
}

/* Adds the agreement of normals of a group of triangles, and empties the group. */
static void add_agreement(const smr_judgement *j, group *g, smr_mean *agree)
{
    search_group(j, g);
    for (uint32_t i = 0; i < g->n; i++) {
        if (g->hit[i].triangle == SMR_NONE)
            continue;
        const smr_vec normal = g->query[i].normal,
                      other = smr_get3(smr_judged_target(j)->tree.normal, g->hit[i].triangle);
        const float area = smr_length(normal);
        smr_mean_add(agree, smr_dot(other, normal) > SMR_MEASURE_AGREE * area, area);
    }
    g->n = 0;
}

uint32_t smr_triangles_measure_tasks(const void *job)
{
    const smr_judgement *j = job;
    return j->verdict != NULL && smr_judged_target(j) != NULL
               ? smr_ceil_div(smr_judged(j)->tree.n_triangles, SMR_MEASURE_NORMALS)
               : 0u;
}

/* Measures the visible share of triangles' area, and, on a surface, the agreement of normals of triangles near it. */
void smr_triangles_measure(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_judgement *j = job;
    const smr_box_tree *f = &smr_judged(j)->tree;
    const smr_piece piece = smr_piece_of(task, SMR_MEASURE_NORMALS, f->n_triangles);
    const float *distance = smr_judged_distance(j);
    smr_mean *const place = smr_judge_place(j, task);
    group g = {.n = 0};
    for (uint32_t k = piece.first; k < piece.last; k++) {
        const uint32_t *t = smr_triangle_of(f->triangle, k, f->n_vertices);
        const smr_corner_values corner = smr_corners_of(j->s->shape.x, t);
        const smr_vec normal = smr_scale(smr_triangle_cross(corner.a, corner.b, corner.c), 0.5f);
        const float area = smr_length(normal);
        smr_mean_add(&place[0], visible_part(j, t), area);
        if (j->by != SMR_BY_SURFACE || !(area > 0.0f) ||
            smr_min(smr_min(distance[t[0]], distance[t[1]]), distance[t[2]]) > j->near)
            continue;
        if (add_query(j, &g, k, centre_of(corner), normal, smr_judged_nearest(j)[t[0]], 4.0f * j->near * j->near))
            add_agreement(j, &g, &place[1]);
    }
    add_agreement(j, &g, &place[1]);
}

void smr_triangles_take(void *job, uint32_t first, uint32_t last)
{
    smr_judgement *j = job;
    smr_judge_take(j, first, last, 0, &j->e.visible);
    smr_judge_take(j, first, last, 1, &j->e.agree);
}

/* The last position of the target whose distance to the model was measured. */
typedef struct measured {
    smr_vec at;                   /* mm */
    float mm;                     /* distance to a triangle of the model; SMR_FAR: no triangle is near */
    uint32_t structure, triangle; /* structure and number of that triangle of the model, if near */
} measured;

/* Returns 1 when position c of the target lies within j->near of the structures that share the target: by its distance
 * to the last position, by the triangle found there, or by a search. */
static int is_covered(const smr_judgement *j, smr_vec c, measured *last)
{
    smr_hit hit;
    const float near = j->near;
    if ((last->mm + smr_length(smr_sub(c, last->at))) * SMR_SURELY <= near)
        return 1;
    const float before = last->mm;
    last->at = c;
    if (before < SMR_FAR) {
        const smr_box_tree *f = &j->s->shape.structure[last->structure].tree;
        const uint32_t *t = smr_triangle_of(f->triangle, last->triangle, f->n_vertices);
        const smr_corner_values corner = smr_corners_of(j->s->shape.x, t);
        last->mm = SMR_SQRT(smr_triangle_closest(c, corner.a, corner.b, corner.c, hit.weight));
        if (last->mm <= near)
            return 1;
    }
    const smr_query q = {c, smr_v(0, 0, 0), -2.0f, SMR_MEASURE_NODES, SMR_NONE};
    last->structure = closest(j->s, smr_judged_target(j), &q, SMR_SURELY * near * near, &hit);
    last->triangle = hit.triangle;
    last->mm = last->structure == SMR_NONE ? SMR_FAR : SMR_SQRT(hit.d2);
    return last->mm <= near;
}

uint32_t smr_cover_tasks(const void *job)
{
    const smr_judgement *j = job;
    return j->verdict != NULL && j->by == SMR_BY_SURFACE && j->s->shape.node != NULL
               ? smr_ceil_div(smr_judged_target(j)->tree.n_triangles, SMR_MEASURE_PIECE)
               : 0u;
}

static int shares_triangles(const smr_judgement *j)
{
    for (uint32_t i = 0; i < j->s->shared.n_structures; i++)
        if (j->s->forces.surface.target[i].surface == smr_judged_target(j) &&
            j->s->shape.structure[i].tree.n_triangles > 0u)
            return 1;
    return 0;
}

/* Measures the coverage of target triangles by the structures that share the target. */
void smr_cover_measure(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_judgement *j = job;
    const smr_surface *target = smr_judged_target(j);
    const smr_tree_mask mask = mask_of(j);
    const smr_vec shift = smr_sub(target->origin, j->s->shape.origin);
    const smr_piece piece = smr_piece_of(task, SMR_MEASURE_PIECE, target->tree.n_triangles);
    smr_mean *const place = smr_judge_place(j, task);
    const int is_model = shares_triangles(j);
    measured last = {.mm = SMR_FAR};
    for (uint32_t k = piece.first; k < piece.last; k++) {
        const smr_corner_values corner =
            smr_corners_of(target->xyz, smr_triangle_of(target->triangle, k, target->n_vertices));
        const float area = smr_length(smr_scale(smr_triangle_cross(corner.a, corner.b, corner.c), 0.5f));
        const int other = smr_tree_left_out(&mask, k);
        smr_mean_add(&place[0], other ? 1.0f : 0.0f, area);
        if (!other && is_model)
            smr_mean_add(&place[1], (float)is_covered(j, smr_add(centre_of(corner), shift), &last), area);
    }
}

void smr_cover_take(void *job, uint32_t first, uint32_t last)
{
    smr_judgement *j = job;
    smr_judge_take(j, first, last, 0, &j->e.others);
    smr_judge_take(j, first, last, 1, &j->e.covered);
}

/* ---- clouds of points ---- */

/* Finds the structure closest to point j of a cloud, of those that share the cloud; SMR_NONE: none, or no weight. */
static uint32_t closest_to_point(const smr *s, const smr_surface *cloud, uint32_t j, smr_hit *hit)
{
    const smr_vec shift = smr_sub(cloud->origin, s->shape.origin);
    const smr_query q = {smr_add(smr_get3(cloud->xyz, j), shift), smr_v(0, 0, 0), -2.0f, SMR_MEASURE_NODES, SMR_NONE};
    return cloud->area[j] > 0.0f ? closest(s, cloud, &q, SMR_FAR, hit) : SMR_NONE;
}

/* Returns 1 when the registration leaves out point j of a cloud at squared distance d2 from the model, mm^2. */
static int is_stray(const smr *s, uint32_t structure, uint32_t j, float d2)
{
    const smr_surface_goals *g = &s->forces.surface;
    return !(smr_outlier_weight(g, smr_goal_of(g, structure), j, d2) > 0.0f);
}

/* Marks the vertex nearest to a point's foot. Workers may mark the same vertex. */
static void mark(const smr_judgement *j, const smr_hit *hit)
{
    const smr_box_tree *const f = &smr_judged(j)->tree;
    const float *const w = hit->weight;
    const uint32_t c = w[0] >= w[1] && w[0] >= w[2] ? 0u : w[1] >= w[2] ? 1u : 2u;
    unsigned char *const at = smr_judged_visible(j->s) + smr_triangle_of(f->triangle, hit->triangle, f->n_vertices)[c];
    __atomic_store_n(at, (unsigned char)(__atomic_load_n(at, __ATOMIC_RELAXED) | SMR_JUDGED_POINT), __ATOMIC_RELAXED);
}

uint32_t smr_cloud_tasks(const void *job)
{
    const smr_judgement *j = job;
    return j->by == SMR_BY_CLOUD ? smr_ceil_div(smr_judged_target(j)->n_vertices, SMR_MEASURE_PIECE) : 0u;
}

void smr_cloud_measure(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_judgement *j = job;
    const smr_surface *cloud = smr_judged_target(j);
    const smr_piece piece = smr_piece_of(task, SMR_MEASURE_PIECE, cloud->n_vertices);
    smr_mean *const place = smr_judge_place(j, task);
    smr_hit hit;
    for (uint32_t k = piece.first; k < piece.last; k++)
        if (closest_to_point(j->s, cloud, k, &hit) == j->structure && !is_stray(j->s, j->structure, k, hit.d2)) {
            smr_mean_add(&place[0], SMR_SQRT(hit.d2), cloud->area[k]);
            mark(j, &hit);
        }
}

void smr_cloud_take(void *job, uint32_t first, uint32_t last)
{
    smr_judgement *j = job;
    smr_judge_take(j, first, last, 0, &j->residual);
}

uint32_t smr_points_tasks(const void *job)
{
    return ((const smr_judgement *)job)->verdict != NULL ? smr_cloud_tasks(job) : 0u;
}

/* Measures outliers of the whole cloud, coverage of its other points by all structures, and agreement of normals on
 * this structure. */
void smr_points_measure(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_judgement *j = job;
    const smr *s = j->s;
    const smr_surface *cloud = smr_judged_target(j);
    const smr_piece piece = smr_piece_of(task, SMR_MEASURE_PIECE, cloud->n_vertices);
    const float near2 = j->near * j->near;
    smr_mean *const place = smr_judge_place(j, task);
    smr_hit hit;
    for (uint32_t k = piece.first; k < piece.last; k++) {
        const uint32_t on = closest_to_point(s, cloud, k, &hit);
        const smr_vec n = smr_get3(cloud->normal, k);
        if (on == SMR_NONE)
            continue;
        const int stray = is_stray(s, j->structure, k, hit.d2);
        smr_mean_add(&place[0], stray ? 1.0f : 0.0f, cloud->area[k]);
        if (stray)
            continue;
        smr_mean_add(&place[1], hit.d2 <= near2 ? 1.0f : 0.0f, cloud->area[k]);
        if (on != j->structure || hit.d2 > near2 || !(smr_dot(n, n) > 0.5f))
            continue;
        const smr_vec normal = smr_get3(s->shape.structure[on].tree.normal, hit.triangle);
        smr_mean_add(&place[2], smr_dot(n, normal) > SMR_MEASURE_AGREE ? 1.0f : 0.0f, cloud->area[k]);
    }
}

void smr_points_take(void *job, uint32_t first, uint32_t last)
{
    smr_judgement *j = job;
    smr_judge_take(j, first, last, 0, &j->e.strays);
    smr_judge_take(j, first, last, 1, &j->e.covered);
    smr_judge_take(j, first, last, 2, &j->e.agree);
}
