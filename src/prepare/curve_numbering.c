/* curve_numbering.c: numbers the vertices along a Hilbert curve through the whole model and the triangles in the tree
 * order of their structure, and builds the box tree over the vertices.
 * Bounds: radix sorts of n vertices; box_tree_order.c for triangles.
 * SPDX-License-Identifier: MIT */
#include "geometry/box_tree/hilbert_curve.h"
#include "prepare/prepare_plan.h"

static smr_box whole_box(const smr_plan *p)
{
    smr_box box = smr_box_of(p->structures[0].mesh.xyz, 1);
    for (uint32_t s = 0; s < p->n_structures; s++)
        for (uint32_t i = 0; i < p->structures[s].mesh.n_vertices; i++)
            smr_box_grow(&box, smr_get3(p->structures[s].mesh.xyz, i));
    return box;
}

/* Numbers the vertices along the curve: writes the plan's centre, original, position, xyz and owner. */
static void order_vertices(smr_plan *p)
{
    const smr_box box = whole_box(p);
    smr_store(p->centre, smr_whole(smr_scale(smr_add(box.lo, box.hi), 0.5f)));
    uint32_t k = 0;
    for (uint32_t s = 0; s < p->n_structures; s++)
        for (uint32_t i = 0; i < p->structures[s].mesh.n_vertices; i++, k++) {
            p->key[k] = smr_curve_key(box, smr_get3(p->structures[s].mesh.xyz, i));
            p->original[k] = k;
        }
    smr_curve_sort(p->key, p->original, p->tmp, p->n);
    for (uint32_t v = 0; v < p->n; v++)
        p->position[p->original[v]] = v;
    k = 0;
    for (uint32_t s = 0; s < p->n_structures; s++)
        for (uint32_t i = 0; i < p->structures[s].mesh.n_vertices; i++, k++) {
            smr_put3(p->xyz, p->position[k], smr_sub(smr_get3(p->structures[s].mesh.xyz, i), smr_load(p->centre)));
            p->owner[p->position[k]] = (uint16_t)s;
        }
}

/* Puts each structure's triangles into tree order: writes the plan's triangle_index and triangle. */
static void order_triangles(smr_plan *p)
{
    uint32_t first_vertex = 0, first = 0;
    for (uint32_t s = 0; s < p->n_structures; s++) {
        const smr_mesh *mesh = &p->structures[s].mesh;
        smr_mesh_order(mesh, p->triangle_index + first, p->triangle_centre, p->key, p->tmp);
        for (uint32_t k = 0; k < mesh->n_triangles; k++)
            for (uint32_t c = 0; c < 3u; c++)
                p->triangle[3u * (size_t)(first + k) + c] =
                    p->position[first_vertex + mesh->triangles[3u * (size_t)p->triangle_index[first + k] + c]];
        first_vertex += mesh->n_vertices;
        first += mesh->n_triangles;
    }
}

void smr_plan_tree(const smr_plan *p, smr_box_tree *tree, uint32_t n, const uint32_t *vertex)
{
    smr_tree_shape(tree, n);
    for (uint32_t leaf = 0; leaf < smr_tree_leaves(tree); leaf++) {
        smr_node *node = &tree->node[leaf];
        for (uint32_t k = 0; k < SMR_TREE_WIDTH; k++) {
            const uint32_t i = leaf * SMR_TREE_WIDTH + k, v = i < n && vertex != NULL ? vertex[i] : i;
            for (uint32_t axis = 0; axis < 3u; axis++)
                node->lo[axis][k] = node->hi[axis][k] = i < n ? p->xyz[3u * (size_t)v + axis] : SMR_FAR;
        }
    }
    smr_tree_refit_upper(tree);
}

void smr_plan_order(smr_plan *p)
{
    order_vertices(p);
    order_triangles(p);
    smr_plan_tree(p, &p->points, p->n, NULL);
    for (uint32_t v = 0; p->geo_distance != NULL && v < p->n; v++)
        p->geo_distance[v] = UINT32_MAX;
}
