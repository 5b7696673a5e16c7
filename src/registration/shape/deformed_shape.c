/* deformed_shape.c: arrays of the deforming model; normals and box trees of its moving triangles, for target-to-model
 * attraction and contact; the rest pose, fitted when a registration or its last radius starts.
 * Structures may start as rigid bodies, each in its own pose; the start is then the rest shape of evening and folds.
 * Bounds: one pass over vertices and triangles; four over the vertices for start positions.
 * SPDX-License-Identifier: MIT */
#include "geometry/box_tree/triangle.h"
#include "registration/shape/deformed_shape.h"

#define SMR_LEAVES 32u /* number of tree leaves in a task */
#define SMR_UPPERS 24u /* number of tree nodes above the leaves in a task */

SMR_SELDOM void smr_shape_layout(smr_arena *a, smr_shape *shape, const smr_shared *shared)
{
    const size_t n = shared->n;
    shape->structure = smr_slot_scratch(a, shape->structure, shared->n_structures, sizeof *shape->structure);
    shape->x = smr_slot_floats(a, shape->x, 3u * n, SMR_KEPT_MM);
    shape->x_next = smr_slot_floats(a, shape->x_next, 3u * n, SMR_KEPT_MM);
    shape->x_ref = smr_slot_floats(a, shape->x_ref, 3u * n, SMR_KEPT_MM);
    shape->normal = smr_slot_floats(a, shape->normal, 3u * n, SMR_KEPT_UNIT);
    shape->normal_ref = smr_slot_floats(a, shape->normal_ref, 3u * n, SMR_KEPT_UNIT);
    shape->start = smr_slot_floats(a, shape->start, 3u * n, SMR_KEPT_MM);
    shape->on_surface = smr_slot_scratch(a, shape->on_surface, n, 1);
    shape->triangle_normal = smr_slot_scratch(a, shape->triangle_normal, shared->n_triangles, 3u * sizeof(float));
    if (SMR_BIG_ENDIAN)
        shape->own_triangle = smr_slot_scratch(a, shape->own_triangle, shared->n_triangles, 3u * sizeof(uint32_t));
    shape->n_nodes = 0;
    for (uint32_t i = 0; i < shared->n_structures; i++)
        shape->n_nodes += smr_tree_nodes(smr_le32(smr_model_record(shared->model, i)->n_triangles));
    if (smr_target_slots(shared) > 0u || shared->config.contact.share > 0.0f)
        shape->node = smr_slot_scratch(a, shape->node, shape->n_nodes, sizeof *shape->node);
    smr_keep_floats(a, &shape->origin.x, 3, -SMR_KEPT_MM, SMR_KEPT_MM);
    const smr_vec off = smr_sub(shape->origin, smr_whole(shape->origin));
    smr_keep_require(a, smr_dot(off, off) == 0.0f);
    smr_keep_pose(a, &shape->rest_pose, SMR_KEPT_MM);
    smr_keep_words(a, &shape->rest_pose_due, 1, 1);
}

const uint32_t *smr_model_triangle(const smr_shared *c, uint32_t k) { return smr_triangle_at(c->triangle, k, c->n); }

void smr_shape_start(smr_shape *shape)
{
    const smr_shared *c = shape->shared;
    uint32_t leaf = 0, node = 0;
    for (uint32_t i = 0; i < c->n_structures; i++) {
        const smr_stored_structure *r = smr_model_record(c->model, i);
        smr_shape_structure *one = &shape->structure[i];
        one->first_vertex = smr_le32(r->first_vertex);
        one->n_vertices = smr_le32(r->n_vertices);
        one->first_triangle = smr_le32(r->first_triangle);
        one->first_leaf = leaf;
        smr_tree_shape(&one->tree, smr_le32(r->n_triangles));
        one->tree.triangle = c->triangle + 3u * (size_t)one->first_triangle;
        one->tree.n_vertices = c->n;
        one->tree.normal = shape->triangle_normal + 3u * (size_t)one->first_triangle;
        one->tree.node = shape->node == NULL ? NULL : shape->node + node;
        leaf += smr_tree_leaves(&one->tree);
        node += smr_tree_nodes(one->tree.n_triangles);
    }
}

void smr_shape_mark(smr_shape *shape, uint32_t first, uint32_t last)
{
    const smr_shared *c = shape->shared;
    for (size_t i = 3u * (size_t)first; i < 3u * (size_t)last; i++)
        shape->on_surface[smr_index(c->triangle[i], c->n)] = 1;
}

uint32_t smr_triangles_tasks(const void *arg)
{
    const smr_shape *shape = arg;
    const smr_shape_structure *last = &shape->structure[shape->shared->n_structures - 1u];
    return smr_ceil_div(last->first_leaf + smr_tree_leaves(&last->tree), SMR_LEAVES);
}

void smr_triangles_refit(void *arg, uint32_t task, SMR_UNUSED uint32_t worker)
{
    const smr_shape *shape = arg;
    const uint32_t from = task * SMR_LEAVES, to = from + SMR_LEAVES;
    for (uint32_t i = 0; i < shape->shared->n_structures; i++) {
        const smr_shape_structure *one = &shape->structure[i];
        const uint32_t first = one->first_leaf, last = first + smr_tree_leaves(&one->tree);
        if (last > from && first < to)
            smr_tree_refit_leaves(&one->tree, smr_max_u32(first, from) - first, smr_min_u32(last, to) - first);
    }
}

/* Returns the number of nodes of a structure's tree above the leaves. */
static uint32_t n_upper(const smr_box_tree *f)
{
    return f->n_levels > 0u ? f->level[f->n_levels - 1u] + 1u - smr_tree_leaves(f) : 0u;
}

uint32_t smr_uppers_tasks(const void *arg)
{
    const smr_shape *shape = arg;
    const smr_shape_structure *last = &shape->structure[shape->shared->n_structures - 1u];
    const uint32_t n_leaves = last->first_leaf + smr_tree_leaves(&last->tree);
    return shape->node != NULL ? smr_ceil_div(shape->n_nodes - n_leaves, SMR_UPPERS) : 0u;
}

void smr_uppers_refit(void *arg, uint32_t task, SMR_UNUSED uint32_t worker)
{
    const smr_shape *shape = arg;
    const uint32_t from = task * SMR_UPPERS, to = from + SMR_UPPERS;
    uint32_t first = 0;
    for (uint32_t i = 0; i < shape->shared->n_structures && first < to; i++) {
        const smr_box_tree *f = &shape->structure[i].tree;
        const uint32_t last = first + n_upper(f), leaves = smr_tree_leaves(f);
        if (last > from)
            smr_tree_refit_nodes(f, leaves + smr_max_u32(first, from) - first, leaves + smr_min_u32(last, to) - first);
        first = last;
    }
}

void smr_triangles_follow(smr_shape *shape, const float *xyz)
{
    for (uint32_t i = 0; i < shape->shared->n_structures; i++)
        shape->structure[i].tree.xyz = xyz;
}

void smr_triangles_now(smr_shape *shape)
{
    smr_triangles_follow(shape, shape->x);
    for (uint32_t i = 0; i < shape->shared->n_structures; i++)
        smr_tree_refit_leaves(&shape->structure[i].tree, 0, smr_tree_leaves(&shape->structure[i].tree));
    for (uint32_t task = 0; task < smr_uppers_tasks(shape); task++)
        smr_uppers_refit(shape, task, 0);
}

static void add_to_fit(smr_shape *shape, uint32_t from, uint32_t to)
{
    if (from == 0u)
        smr_fit_start(&shape->fit, smr_v(0, 0, 0), smr_v(0, 0, 0));
    for (uint32_t v = from; v < to; v++)
        smr_fit_add(&shape->fit, smr_rest_in_parts(shape, v), smr_get3(shape->x, v), 1.0f);
}

uint32_t smr_rest_pose_tasks(const void *arg)
{
    const smr_shape *shape = arg;
    return shape->rest_pose_due ? smr_ceil_div(shape->shared->n, SMR_MATCH_CHUNK) : 0u;
}

void smr_rest_pose_sum(void *arg, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_shape *shape = arg;
    add_to_fit(shape, task * SMR_MATCH_CHUNK, smr_min_u32((task + 1u) * SMR_MATCH_CHUNK, shape->shared->n));
}

void smr_rest_pose_end(smr_shape *shape)
{
    shape->rest_pose = smr_fit_solve(&shape->fit, 1);
    shape->rest_pose_due = 0;
}
