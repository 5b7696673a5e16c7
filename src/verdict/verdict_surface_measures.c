/* verdict_surface_measures.c: how model and target surface lie on each other, in both directions, integrated over the
 * area. Bounds: a closest-point search for each vertex and for each triangle of the target.
 * SPDX-License-Identifier: MIT */
#include "verdict/verdict_measures.h"

static smr_vec area_of(smr_vec a, smr_vec b, smr_vec c)
{
    return smr_scale(smr_cross(smr_sub(b, a), smr_sub(c, a)), 0.5f);
}

static smr_vec corner(const float *xyz, const uint32_t *t, uint32_t c) { return smr_get3(xyz, t[c]); }

/* Distance of each vertex to the target, mm; SMR_FAR beyond the search. */
static void find_distances(const smr *s, const smr_shape_structure *one, const smr_surface *target, float *distance)
{
    for (uint32_t i = 0; i < one->n_vertices; i++) {
        const uint32_t v = smr_model_position(s->shared.model, one->first_vertex + i);
        const smr_vec p = smr_add(smr_get3(s->shape.x, v), smr_sub(s->shape.origin, target->origin));
        const smr_query q = {p, smr_get3(s->shape.normal, v), -2.0f, SMR_MEASURE_NODES, s->forces.surface.warm[v]};
        smr_hit hit = {SMR_FAR, SMR_NONE, {0, 0, 0}};
        smr_surface_search(target, &q, &hit);
        distance[v] = hit.triangle == SMR_NONE ? SMR_FAR : SMR_SQRT(hit.d2);
    }
}

static void add_model(const smr *s, const smr_shape_structure *one, const smr_surface *target, const float *distance,
                      float near, smr_evidence *e)
{
    const smr_vec shift = smr_sub(s->shape.origin, target->origin);
    for (uint32_t k = 0; k < one->tree.n_triangles; k++) {
        const uint32_t *t = one->tree.triangle + 3u * (size_t)k;
        const smr_vec a = corner(s->shape.x, t, 0), b = corner(s->shape.x, t, 1), c = corner(s->shape.x, t, 2);
        const smr_vec normal = area_of(a, b, c);
        const float area = smr_length(normal);
        float visible = 0.0f, nearest = SMR_FAR;
        for (uint32_t i = 0; i < 3u; i++) {
            visible += (float)smr_vertex_visible(s, t[i]) * (1.0f / 3.0f);
            nearest = smr_min(nearest, distance[t[i]]);
        }
        smr_mean_add(&e->visible, visible, area);
        if (nearest > near || !(area > 0.0f))
            continue;
        const smr_vec middle = smr_add(smr_scale(smr_add(a, smr_add(b, c)), 1.0f / 3.0f), shift);
        const smr_query q = {middle, normal, -2.0f, SMR_MEASURE_NODES, SMR_NONE};
        smr_hit hit = {4.0f * near * near, SMR_NONE, {0, 0, 0}};
        smr_surface_search(target, &q, &hit);
        if (hit.triangle != SMR_NONE)
            smr_mean_add(&e->agree,
                         smr_dot(smr_get3(target->tree.normal, hit.triangle), normal) > SMR_MEASURE_AGREE * area, area);
    }
}

/* Adds the coverage of the target by the structures that share it. */
static void add_target(const smr *s, const smr_surface *target, float near, smr_evidence *e)
{
    const smr_vec shift = smr_sub(target->origin, s->shape.origin);
    for (uint32_t k = 0; k < target->tree.n_triangles; k++) {
        const uint32_t *t = target->triangle + 3u * (size_t)k;
        if (smr_surface_fragment(target, t[0]))
            continue;
        const smr_vec a = corner(target->xyz, t, 0), b = corner(target->xyz, t, 1), c = corner(target->xyz, t, 2);
        const float area = smr_length(area_of(a, b, c));
        const smr_vec middle = smr_add(smr_scale(smr_add(a, smr_add(b, c)), 1.0f / 3.0f), shift);
        const smr_query q = {middle, smr_v(0, 0, 0), -2.0f, SMR_MEASURE_NODES, SMR_NONE};
        smr_hit hit = {SMR_FAR, SMR_NONE, {0, 0, 0}};
        for (uint32_t i = 0; i < s->shared.n_structures; i++) {
            const smr_box_tree *f = &s->shape.structure[i].tree;
            if (s->forces.surface.target[i].surface != target || f->n_triangles == 0u)
                continue;
            smr_tree_closest(f, &q, &hit);
        }
        if (!(hit.d2 < SMR_FAR))
            continue;
        const float d = SMR_SQRT(hit.d2);
        smr_mean_add(&e->covered, d <= near, area);
    }
}

void smr_measure_surface(const smr *s, uint32_t structure, smr_evidence *e)
{
    const smr_shape_structure *one = &s->shape.structure[structure];
    const smr_surface *target = s->forces.surface.target[structure].surface;
    float *const distance = smr_vertex_distance(s);
    smr_mean residual = {0, 0};
    find_distances(s, one, target, distance);
    for (uint32_t i = 0; i < one->n_vertices; i++) {
        const uint32_t v = smr_model_position(s->shared.model, one->first_vertex + i);
        if (smr_vertex_visible(s, v) && distance[v] < SMR_FAR)
            smr_mean_add(&residual, distance[v], 1.0f);
    }
    const float near = smr_add_residual(s, residual, e);
    add_model(s, one, target, distance, near, e);
    if (s->shape.node != NULL)
        add_target(s, target, near, e);
}
