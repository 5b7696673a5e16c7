/* moving_triangles.c: the model's triangles as they move: normals, and box trees for target-to-model attraction.
 * Bounds: one pass over the triangles.
 * SPDX-License-Identifier: MIT */
#include "runtime/deformed/shape.h"

#define SMR_LEAVES 32u /* tree leaves of a task */

void smr_shape_layout(smr_arena *a, smr_shape *shape, const smr_shared *shared)
{
    const size_t n = shared->n, three = 3u * sizeof(float);
    shape->structure = smr_arena_take(a, shared->n_structures, sizeof *shape->structure);
    shape->x = smr_arena_take(a, n, three);
    shape->x_next = smr_arena_take(a, n, three);
    shape->x_ref = smr_arena_take(a, n, three);
    shape->normal = smr_arena_take(a, n, three);
    shape->normal_ref = smr_arena_take(a, n, three);
    shape->start = smr_arena_take(a, n, three);
    shape->on_surface = smr_arena_take(a, n, 1);
    shape->facet_normal = smr_arena_take(a, shared->n_triangles, three);
    if (SMR_BIG_ENDIAN)
        shape->own_triangle = smr_arena_take(a, shared->n_triangles, 3u * sizeof(uint32_t));
    for (uint32_t i = 0; i < shared->n_structures; i++)
        shape->n_nodes += smr_tree_nodes(smr_le32(smr_model_record(shared->model, i)->n_triangles));
    if (shared->config.n_target_vertices > 0u)
        shape->node = smr_arena_take(a, shape->n_nodes, sizeof *shape->node);
    smr_held_layout(a, shape, shared);
}

void smr_shape_start(smr_shape *shape)
{
    const smr_shared *c = shape->shared;
    uint32_t leaf = 0, node = 0;
    for (uint32_t i = 0; i < c->n_structures; i++) {
        const smr_stored_structure *r = smr_model_record(c->model, i);
        smr_shape_structure *one = &shape->structure[i];
        memset(one, 0, sizeof *one);
        one->first_vertex = smr_le32(r->first_vertex);
        one->n_vertices = smr_le32(r->n_vertices);
        one->first_triangle = smr_le32(r->first_triangle);
        one->first_leaf = leaf;
        smr_tree_shape(&one->facets, smr_le32(r->n_triangles));
        one->facets.triangle = c->triangle + 3u * (size_t)one->first_triangle;
        one->facets.normal = shape->facet_normal + 3u * (size_t)one->first_triangle;
        one->facets.node = shape->node == NULL ? NULL : shape->node + node;
        leaf += smr_tree_leaves(&one->facets);
        node += smr_tree_nodes(one->facets.n_triangles);
    }
    memset(shape->on_surface, 0, c->n);
    for (size_t i = 0; i < 3u * (size_t)c->n_triangles; i++)
        shape->on_surface[c->triangle[i]] = 1;
}

uint32_t smr_facets_tasks(const void *arg)
{
    const smr_shape *shape = arg;
    const smr_shape_structure *last = &shape->structure[shape->shared->n_structures - 1u];
    return smr_ceil_div(last->first_leaf + smr_tree_leaves(&last->facets), SMR_LEAVES);
}

void smr_facets_refit(void *arg, uint32_t task, uint32_t worker)
{
    const smr_shape *shape = arg;
    (void)worker;
    const uint32_t from = task * SMR_LEAVES, to = from + SMR_LEAVES;
    for (uint32_t i = 0; i < shape->shared->n_structures; i++) {
        const smr_shape_structure *one = &shape->structure[i];
        const uint32_t first = one->first_leaf, last = first + smr_tree_leaves(&one->facets);
        if (last > from && first < to)
            smr_tree_refit_leaves(&one->facets, smr_max_u32(first, from) - first, smr_min_u32(last, to) - first);
    }
}

void smr_facets_end(smr_shape *shape)
{
    for (uint32_t i = 0; i < shape->shared->n_structures; i++)
        if (shape->structure[i].facets.node != NULL) /* without a target, too: one may come before the next iteration */
            smr_tree_refit_upper(&shape->structure[i].facets);
}

void smr_facets_follow(smr_shape *shape, const float *xyz)
{
    for (uint32_t i = 0; i < shape->shared->n_structures; i++)
        shape->structure[i].facets.xyz = xyz;
}

void smr_facets_now(smr_shape *shape)
{
    smr_facets_follow(shape, shape->x);
    for (uint32_t i = 0; i < shape->shared->n_structures; i++)
        smr_tree_refit_leaves(&shape->structure[i].facets, 0, smr_tree_leaves(&shape->structure[i].facets));
    smr_facets_end(shape);
}
