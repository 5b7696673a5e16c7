/* verdict_cloud_measures.c: how a model lies on a cloud of points: visible share of its area, residuals, and agreement
 * of normals where points have them.
 * Bounds: two closest-point searches for each point and structure that shares the cloud; one pass over triangles.
 * SPDX-License-Identifier: MIT */
#include "verdict/verdict_measures.h"

/* The structure closest to point j, of those that share the cloud; SMR_NONE: none. */
static uint32_t closest(const smr *s, const smr_surface *cloud, uint32_t j, smr_hit *hit)
{
    const smr_vec shift = smr_sub(cloud->origin, s->shape.origin);
    const smr_query q = {smr_add(smr_get3(cloud->xyz, j), shift), smr_v(0, 0, 0), -2.0f, SMR_MEASURE_NODES, SMR_NONE};
    uint32_t found = SMR_NONE;
    *hit = (smr_hit){SMR_FAR, SMR_NONE, {0, 0, 0}};
    for (uint32_t i = 0; i < s->shared.n_structures && cloud->area[j] > 0.0f; i++) {
        const smr_box_tree *f = &s->shape.structure[i].tree;
        const float before = hit->d2;
        if (s->forces.surface.target[i].surface != cloud || f->n_triangles == 0u)
            continue;
        smr_tree_closest(f, &q, hit);
        found = hit->d2 < before ? i : found;
    }
    return found;
}

static smr_mean find_residual(const smr *s, uint32_t structure, const smr_surface *cloud)
{
    smr_mean residual = {0, 0};
    smr_hit hit;
    for (uint32_t j = 0; j < cloud->n_vertices; j++)
        if (closest(s, cloud, j, &hit) == structure)
            smr_mean_add(&residual, SMR_SQRT(hit.d2), cloud->area[j]);
    return residual;
}

/* Adds coverage over the whole cloud, whichever structure is near, and agreement of normals on this structure. */
static void add_points(const smr *s, uint32_t structure, const smr_surface *cloud, float near, smr_evidence *e)
{
    smr_hit hit;
    for (uint32_t j = 0; j < cloud->n_vertices; j++) {
        const uint32_t on = closest(s, cloud, j, &hit);
        const smr_vec n = smr_get3(cloud->normal, j);
        if (on == SMR_NONE)
            continue;
        smr_mean_add(&e->covered, hit.d2 <= near * near ? 1.0f : 0.0f, cloud->area[j]);
        if (on != structure || hit.d2 > near * near || !(smr_dot(n, n) > 0.5f))
            continue;
        const smr_vec normal = smr_get3(s->shape.structure[on].tree.normal, hit.triangle);
        smr_mean_add(&e->agree, smr_dot(n, normal) > SMR_MEASURE_AGREE ? 1.0f : 0.0f, cloud->area[j]);
    }
}

static void add_visible(const smr *s, const smr_shape_structure *one, smr_evidence *e)
{
    for (uint32_t k = 0; k < one->tree.n_triangles; k++) {
        const uint32_t *t = one->tree.triangle + 3u * (size_t)k;
        const smr_vec a = smr_get3(s->shape.x, t[0]), b = smr_get3(s->shape.x, t[1]);
        const smr_vec c = smr_get3(s->shape.x, t[2]);
        const int n = smr_vertex_visible(s, t[0]) + smr_vertex_visible(s, t[1]) + smr_vertex_visible(s, t[2]);
        smr_mean_add(&e->visible, (float)n * (1.0f / 3.0f), 0.5f * smr_length(smr_cross(smr_sub(b, a), smr_sub(c, a))));
    }
}

void smr_measure_points(const smr *s, uint32_t structure, smr_evidence *e)
{
    const smr_surface *cloud = s->forces.surface.target[structure].surface;
    const float near = smr_add_residual(s, find_residual(s, structure, cloud), e);
    add_visible(s, &s->shape.structure[structure], e);
    add_points(s, structure, cloud, near, e);
}
