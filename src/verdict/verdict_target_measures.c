/* verdict_target_measures.c: how a structure lies on its target. On a surface: distances in both directions, integrated
 * over the area. On a cloud: residuals of points, coverage, agreement of normals. In an image: how well intensity
 * profiles match in their places, compared with chance. By landmarks or the caller's goals: residuals.
 * Bounds: a search for each vertex and triangle of a target surface; two for each point of a cloud and structure that
 * shares it; SMR_LOOKED comparisons in an image; one pass over triangles and vertices.
 * SPDX-License-Identifier: MIT */
#include "geometry/box_tree/triangle.h"
#include "verdict/verdict_measures.h"

#define SMR_MEASURE_NODES 4096u /* most nodes that a search opens */
#define SMR_MEASURE_AGREE 0.0f  /* cosine of the angle between two normals above which the normals agree */
#define SMR_MEASURE_EDGES 1.0f  /* distance up to which the target is covered, in mean edge lengths of the model */
#define SMR_MEASURE_TIMES 2.0f  /* distance up to which the target is covered, in mean residuals, if larger */
#define SMR_SURELY 1.001f       /* factor on distances, so that rounding errors do not cover the target */
#define SMR_LOOKED 400u         /* most compared vertices of a structure in an image, evenly spaced */

int smr_vertex_visible(const smr *s, uint32_t v)
{
    const smr_surface_goals *g = &s->forces.surface;
    const uint32_t owner = smr_model_owner(s->shared.model, v);
    int32_t wins = 0;
    uint32_t n = 0;
    if (g->target[owner].surface != NULL && g->visibility != NULL && g->target[owner].n_judged > 0u)
        return g->visibility[v] > SMR_VISIBLE_ONE / 2u;
    if (g->target[owner].surface != NULL || !s->forces.image.has_image || !s->forces.image.structure[owner].idle ||
        smr_field_of_past(&s->forces.occluded))
        return s->forces.found_last[v] == SMR_FOUND_GOAL;
    smr_image_compare(&s->forces.image, v, &wins, &n); /* goals are unknown after the search has ended */
    return wins > 0;
}

/* Adds a structure's residual to the measures. Returns the distance, mm, up to which the target counts as covered. */
static float add_residual(const smr *s, smr_mean residual, smr_evidence *e)
{
    const float edge = smr_max(smr_le_float(s->shared.model->edge_mm), 1.0e-6f);
    e->residual.sum += residual.sum;
    e->residual.weight += residual.weight;
    return smr_max(SMR_MEASURE_EDGES * edge, SMR_MEASURE_TIMES * smr_mean_of(residual, 0.0f));
}

/* Returns the share of a triangle's corners that are visible. */
static float visible_part(const smr *s, const uint32_t *t)
{
    const int n = smr_vertex_visible(s, t[0]) + smr_vertex_visible(s, t[1]) + smr_vertex_visible(s, t[2]);
    return (float)n * (1.0f / 3.0f);
}

/* Returns the centre of a triangle with these corners. */
static smr_vec centre_of(smr_corner_values v) { return smr_scale(smr_add(v.a, smr_add(v.b, v.c)), 1.0f / 3.0f); }

/* Finds the point closest to q, within the squared distance most2, on the structures that share a target. Returns the
 * structure; SMR_NONE: none. */
static uint32_t closest(const smr *s, const smr_surface *target, const smr_query *q, float most2, smr_hit *hit)
{
    uint32_t found = SMR_NONE;
    *hit = (smr_hit){most2, SMR_NONE, {0, 0, 0}};
    for (uint32_t i = 0; i < s->shared.n_structures; i++) {
        const smr_box_tree *f = &s->shape.structure[i].tree;
        const float before = hit->d2;
        if (s->forces.surface.target[i].surface != target || f->n_triangles == 0u)
            continue;
        smr_tree_closest(f, q, hit);
        found = hit->d2 < before ? i : found;
    }
    return found;
}

/* ---- surfaces ---- */

/* A structure and its target surface without other bodies. */
typedef struct surface_pair {
    const smr *s;
    const smr_shape_structure *one;
    const smr_surface *target;
    smr_tree_mask mask; /* triangles of the target that count */
    float *distance;    /* [n] distance of each vertex to the target surface, mm; SMR_FAR: none */
    uint32_t *nearest;  /* [n] closest target triangle of each vertex; SMR_NONE: none */
} surface_pair;

/* Vertices or triangles of the model whose closest points on the target are searched together. */
typedef struct group {
    smr_query query[SMR_GROUP_POINTS];
    smr_hit hit[SMR_GROUP_POINTS];
    uint32_t item[SMR_GROUP_POINTS], n;
} group;

/* Adds a position of the model to the group, with its normal, a target triangle to try first, and the squared search
 * distance. Returns 1 when the group is full. */
static int add_query(const surface_pair *p, group *g, uint32_t item, smr_vec at, smr_vec normal, uint32_t warm,
                     float d2)
{
    const smr_vec to = smr_add(at, smr_sub(p->s->shape.origin, p->target->origin));
    g->query[g->n] = (smr_query){to, normal, -2.0f, SMR_MEASURE_NODES, warm};
    g->hit[g->n] = (smr_hit){d2, SMR_NONE, {0, 0, 0}};
    g->item[g->n++] = item;
    return g->n == SMR_GROUP_POINTS;
}

/* Searches the target for a group. */
static void search_group(const surface_pair *p, group *g)
{
    const int masked = p->mask.use != NULL || p->target->n_fragment > 0u;
    if (g->n > 0u)
        smr_closest_group(&p->target->tree, masked ? &p->mask : NULL, g->query, g->n, g->hit);
}

/* Stores the distances of a group of vertices, and empties the group. */
static void take_distances(const surface_pair *p, group *g)
{
    search_group(p, g);
    for (uint32_t i = 0; i < g->n; i++) {
        p->nearest[g->item[i]] = g->hit[i].triangle;
        p->distance[g->item[i]] = g->hit[i].triangle == SMR_NONE ? SMR_FAR : SMR_SQRT(g->hit[i].d2);
    }
    g->n = 0;
}

/* Finds the distance of each vertex to the target surface, mm. Returns the mean over visible vertices. */
static smr_mean find_distances(const surface_pair *p)
{
    const smr *s = p->s;
    const uint32_t structure = (uint32_t)(p->one - s->shape.structure);
    smr_mean residual = {0, 0};
    group g = {.n = 0};
    for (uint32_t v = 0; v < s->shared.n; v++) /* in stored order, in which neighbours are near each other */
        if (smr_model_owner(s->shared.model, v) == structure &&
            add_query(p, &g, v, smr_get3(s->shape.x, v), smr_get3(s->shape.normal, v), s->forces.surface.warm[v],
                      SMR_FAR))
            take_distances(p, &g);
    take_distances(p, &g);
    for (uint32_t i = 0; i < p->one->n_vertices; i++) {
        const uint32_t v = smr_model_position(s->shared.model, p->one->first_vertex + i);
        if (smr_vertex_visible(s, v) && p->distance[v] < SMR_FAR)
            smr_mean_add(&residual, p->distance[v], 1.0f);
    }
    return residual;
}

/* Adds the agreement of normals of a group of triangles, and empties the group. */
static void add_agreement(const surface_pair *p, group *g, smr_evidence *e)
{
    search_group(p, g);
    for (uint32_t i = 0; i < g->n; i++) {
        if (g->hit[i].triangle == SMR_NONE)
            continue;
        const smr_vec normal = g->query[i].normal, other = smr_get3(p->target->tree.normal, g->hit[i].triangle);
        const float area = smr_length(normal);
        smr_mean_add(&e->agree, smr_dot(other, normal) > SMR_MEASURE_AGREE * area, area);
    }
    g->n = 0;
}

/* Adds the visible share of the structure's area, and agreement of normals where the structure is near the target. */
static void add_model(const surface_pair *p, float near, smr_evidence *e)
{
    group g = {.n = 0};
    for (uint32_t k = 0; k < p->one->tree.n_triangles; k++) {
        const uint32_t *t = smr_model_triangle(&p->s->shared, p->one->first_triangle + k);
        const smr_corner_values corner = smr_corners_of(p->s->shape.x, t);
        const smr_vec normal = smr_scale(smr_triangle_cross(corner.a, corner.b, corner.c), 0.5f);
        const float area = smr_length(normal);
        const float nearest = smr_min(smr_min(p->distance[t[0]], p->distance[t[1]]), p->distance[t[2]]);
        smr_mean_add(&e->visible, visible_part(p->s, t), area);
        if (!(nearest > near) && area > 0.0f &&
            add_query(p, &g, k, centre_of(corner), normal, p->nearest[t[0]], 4.0f * near * near))
            add_agreement(p, &g, e);
    }
    add_agreement(p, &g, e);
}

/* The last position of the target whose distance to the model was measured. */
typedef struct measured {
    smr_vec at;                   /* mm */
    float mm;                     /* distance to a triangle of the model; SMR_FAR: no triangle is near */
    uint32_t structure, triangle; /* that triangle, if near */
} measured;

/* Returns 1 when position c of the target lies within `near` mm of the structures that share the target: by its
 * distance to the last position, by the triangle found there, or by a search. */
static int is_covered(const surface_pair *p, smr_vec c, float near, measured *last)
{
    smr_hit hit;
    if ((last->mm + smr_length(smr_sub(c, last->at))) * SMR_SURELY <= near)
        return 1;
    const float before = last->mm;
    last->at = c;
    if (before < SMR_FAR) {
        const smr_box_tree *f = &p->s->shape.structure[last->structure].tree;
        const uint32_t *t = smr_triangle_of(f->triangle, last->triangle, f->n_vertices);
        const smr_corner_values corner = smr_corners_of(p->s->shape.x, t);
        last->mm = SMR_SQRT(smr_triangle_closest(c, corner.a, corner.b, corner.c, hit.weight));
        if (last->mm <= near)
            return 1;
    }
    const smr_query q = {c, smr_v(0, 0, 0), -2.0f, SMR_MEASURE_NODES, SMR_NONE};
    last->structure = closest(p->s, p->target, &q, SMR_SURELY * near * near, &hit);
    last->triangle = hit.triangle;
    last->mm = last->structure == SMR_NONE ? SMR_FAR : SMR_SQRT(hit.d2);
    return last->mm <= near;
}

/* Adds the coverage of the target surface by the structures that share the target. */
static void add_target(const surface_pair *p, float near, smr_evidence *e)
{
    const smr_vec shift = smr_sub(p->target->origin, p->s->shape.origin);
    const smr_query any = {shift, smr_v(0, 0, 0), -2.0f, SMR_MEASURE_NODES, SMR_NONE};
    measured last = {.mm = SMR_FAR};
    smr_hit hit;
    const int is_model = closest(p->s, p->target, &any, SMR_FAR, &hit) != SMR_NONE; /* 0: no structure has triangles */
    for (uint32_t k = 0; k < p->target->tree.n_triangles; k++) {
        const smr_corner_values corner =
            smr_corners_of(p->target->xyz, smr_triangle_of(p->target->triangle, k, p->target->n_vertices));
        const float area = smr_length(smr_scale(smr_triangle_cross(corner.a, corner.b, corner.c), 0.5f));
        const int other = smr_tree_left_out(&p->mask, k);
        smr_mean_add(&e->others, other ? 1.0f : 0.0f, area);
        if (other || !is_model)
            continue;
        smr_mean_add(&e->covered, (float)is_covered(p, smr_add(centre_of(corner), shift), near, &last), area);
    }
}

static void measure_surface(const smr *s, uint32_t structure, int all, smr_evidence *e)
{
    const smr_surface *target = s->forces.surface.target[structure].surface;
    const surface_pair p = {.s = s,
                            .one = &s->shape.structure[structure],
                            .target = target,
                            .mask = {target->work.body, smr_other_bodies(&s->forces.surface, structure)},
                            .distance = (float *)s->overlay.record,
                            .nearest = s->overlay.record + s->shared.n};
    const float near = add_residual(s, find_distances(&p), e);
    if (!all)
        return;
    add_model(&p, near, e);
    if (s->shape.node != NULL)
        add_target(&p, near, e);
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

/* Adds outliers of the whole cloud, coverage of its other points by all structures, and agreement of normals on this
 * structure. */
static void add_points(const smr *s, uint32_t structure, const smr_surface *cloud, float near, smr_evidence *e)
{
    smr_hit hit;
    for (uint32_t j = 0; j < cloud->n_vertices; j++) {
        const uint32_t on = closest_to_point(s, cloud, j, &hit);
        const smr_vec n = smr_get3(cloud->normal, j);
        if (on == SMR_NONE)
            continue;
        const int stray = is_stray(s, structure, j, hit.d2);
        smr_mean_add(&e->strays, stray ? 1.0f : 0.0f, cloud->area[j]);
        if (stray)
            continue;
        smr_mean_add(&e->covered, hit.d2 <= near * near ? 1.0f : 0.0f, cloud->area[j]);
        if (on != structure || hit.d2 > near * near || !(smr_dot(n, n) > 0.5f))
            continue;
        const smr_vec normal = smr_get3(s->shape.structure[on].tree.normal, hit.triangle);
        smr_mean_add(&e->agree, smr_dot(n, normal) > SMR_MEASURE_AGREE ? 1.0f : 0.0f, cloud->area[j]);
    }
}

static void measure_points(const smr *s, uint32_t structure, int all, smr_evidence *e)
{
    const smr_surface *cloud = s->forces.surface.target[structure].surface;
    const smr_box_tree *f = &s->shape.structure[structure].tree;
    smr_mean residual = {0, 0};
    smr_hit hit;
    for (uint32_t j = 0; j < cloud->n_vertices; j++)
        if (closest_to_point(s, cloud, j, &hit) == structure && !is_stray(s, structure, j, hit.d2))
            smr_mean_add(&residual, SMR_SQRT(hit.d2), cloud->area[j]);
    const float near = add_residual(s, residual, e);
    if (!all)
        return;
    for (uint32_t k = 0; k < f->n_triangles; k++) {
        const uint32_t *t = smr_triangle_of(f->triangle, k, f->n_vertices);
        smr_mean_add(&e->visible, visible_part(s, t), 0.5f * smr_length(smr_corners_cross(s->shape.x, t)));
    }
    add_points(s, structure, cloud, near, e);
}

/* ---- images, landmarks and the caller's goals ---- */

static void measure_image(const smr *s, uint32_t structure, smr_evidence *e)
{
    const smr_shape_structure *one = &s->shape.structure[structure];
    const uint32_t looked = smr_min_u32(one->n_vertices, SMR_LOOKED);
    uint32_t shown = 0;
    for (uint32_t i = 0; i < one->n_vertices; i++)
        shown +=
            (uint32_t)smr_image_shows(&s->forces.image, smr_model_position(s->shared.model, one->first_vertex + i));
    for (uint32_t k = 0; k < looked && !smr_field_of_past(&s->forces.occluded); k++) {
        const uint32_t i = (uint32_t)((uint64_t)k * one->n_vertices / looked);
        int32_t wins;
        uint32_t n;
        const uint32_t v = smr_model_position(s->shared.model, one->first_vertex + i);
        smr_image_compare(&s->forces.image, v, &wins, &n);
        if (n > 0u)
            smr_mean_add(&e->similarity, (float)wins / (float)n, (float)n);
    }
    if (!(e->similarity.weight > 0.0f) && shown > 0u && !smr_field_of_past(&s->forces.occluded))
        smr_mean_add(&e->similarity, 0.0f, 1.0f); /* without a comparison the similarity counts as chance */
    e->n_invisible = one->n_vertices - shown;
    const float matched = smr_forces_matched(&s->forces, structure);
    if (matched >= 0.0f)
        smr_mean_add(&e->goals, matched, (float)shown);
    if (s->forces.surface.target[structure].measured)
        smr_mean_add(&e->visible, smr_max(matched, 0.0f) * ((float)shown / (float)one->n_vertices),
                     (float)one->n_vertices);
    for (uint32_t i = 0; i < one->n_vertices; i++) {
        const uint32_t v = smr_model_position(s->shared.model, one->first_vertex + i);
        if (s->forces.found_last[v] == SMR_FOUND_GOAL)
            smr_mean_add(&e->residual, s->forces.residual[v], 1.0f);
    }
}

static void measure_landmarks(const smr *s, uint32_t structure, smr_evidence *e)
{
    const smr_landmark_goals *g = &s->forces.landmarks;
    const smr_shape_structure *one = &s->shape.structure[structure];
    uint32_t own = 0, visible = 0;
    for (uint32_t k = 0; k < g->n; k++) {
        if (smr_model_owner(s->shared.model, g->landmark[k].corner[0]) != structure)
            continue;
        const smr_vec foot = smr_landmark_foot(g, k, s->shape.x);
        smr_mean_add(&e->residual, smr_length(smr_sub(smr_landmark_goal(g, k), foot)), 1.0f);
        own++;
    }
    if (own == 0u)
        return;
    for (uint32_t i = 0; i < one->n_vertices; i++)
        visible += (uint32_t)smr_vertex_visible(s, smr_model_position(s->shared.model, one->first_vertex + i));
    smr_mean_add(&e->visible, (float)visible / (float)one->n_vertices, (float)one->n_vertices);
}

static void measure_caller(const smr *s, uint32_t structure, smr_evidence *e)
{
    const smr_shape_structure *one = &s->shape.structure[structure];
    for (uint32_t i = 0; i < one->n_vertices; i++) {
        const uint32_t v = smr_model_position(s->shared.model, one->first_vertex + i);
        const int visible = smr_vertex_visible(s, v);
        smr_mean_add(&e->visible, (float)visible, 1.0f);
        if (visible)
            smr_mean_add(&e->residual, s->forces.residual[v], 1.0f);
    }
}

void smr_measure_target(const smr *s, uint32_t structure, int all, smr_evidence *e)
{
    const smr_surface *target = s->forces.surface.target[structure].surface;
    if (target != NULL && smr_is_cloud(target))
        measure_points(s, structure, all, e);
    else if (target != NULL)
        measure_surface(s, structure, all, e);
    else if (smr_image_on(&s->forces.image))
        measure_image(s, structure, e);
    else if (smr_follows_landmarks(s, structure))
        measure_landmarks(s, structure, e);
    else if (smr_caller_has_goals(&s->forces.caller, structure))
        measure_caller(s, structure, e);
}
