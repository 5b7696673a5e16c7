/* box_tree.c: shape of the box tree over triangles, and refits: boxes and normals recomputed from new positions.
 * SPDX-License-Identifier: MIT */
#include "geometry/box_tree/box_tree.h"
#include "geometry/box_tree/triangle.h"

uint32_t smr_tree_nodes(uint32_t n_triangles)
{
    smr_box_tree f;
    smr_tree_shape(&f, n_triangles);
    return f.n_levels > 0u ? f.level[f.n_levels - 1u] + 1u : 0u; /* the highest level is one node */
}

void smr_tree_shape(smr_box_tree *f, uint32_t n_triangles)
{
    f->n_triangles = n_triangles;
    f->n_levels = 0;
    uint32_t first = 0;
    for (uint32_t n = n_triangles; n > 1u || (n == 1u && f->n_levels == 0u); first += n) {
        n = smr_ceil_div(n, SMR_TREE_WIDTH);
        f->level[f->n_levels++] = first;
    }
}

smr_box smr_node_box(const smr_node *node)
{
    smr_box box = smr_no_box();
    for (uint32_t k = 0; k < SMR_TREE_WIDTH && node->lo[0][k] < SMR_FAR; k++) {
        box.lo = smr_low(box.lo, smr_v(node->lo[0][k], node->lo[1][k], node->lo[2][k]));
        box.hi = smr_high(box.hi, smr_v(node->hi[0][k], node->hi[1][k], node->hi[2][k]));
    }
    return box;
}

static void clear_node(smr_node *node)
{
    for (uint32_t axis = 0; axis < 3u; axis++)
        for (uint32_t k = 0; k < SMR_TREE_WIDTH; k++)
            node->lo[axis][k] = node->hi[axis][k] = SMR_FAR;
}

void smr_tree_refit_leaves(const smr_box_tree *f, uint32_t first, uint32_t last)
{
    for (uint32_t leaf = first; leaf < last; leaf++) {
        smr_node *node = f->node == NULL ? NULL : &f->node[leaf];
        uint32_t base = leaf * SMR_TREE_WIDTH;
        uint32_t n = smr_min_u32(f->n_triangles - base, SMR_TREE_WIDTH);
        if (node != NULL && n < SMR_TREE_WIDTH)
            clear_node(node);
        for (uint32_t k = 0; k < n; k++) {
            const smr_corner_values v = smr_corners_of(f->xyz, smr_triangle_at(f->triangle, base + k, f->n_vertices));
            float lo[3], hi[3];
            smr_put3(f->normal, base + k, smr_unit(smr_triangle_cross(v.a, v.b, v.c)));
            if (node == NULL)
                continue;
            smr_store(lo, smr_low(v.a, smr_low(v.b, v.c)));
            smr_store(hi, smr_high(v.a, smr_high(v.b, v.c)));
            for (uint32_t axis = 0; axis < 3u; axis++) {
                node->lo[axis][k] = lo[axis];
                node->hi[axis][k] = hi[axis];
            }
        }
    }
}

/* Sets the box of child k of a node to the box around the child's own children. */
static void set_from(smr_node *node, uint32_t k, const smr_node *child)
{
    for (uint32_t axis = 0; axis < 3u; axis++) {
        float lo = child->lo[axis][0], hi = child->hi[axis][0];
        for (uint32_t c = 1; c < SMR_TREE_WIDTH; c++) {
            if (child->lo[axis][c] >= SMR_FAR)
                break;
            lo = smr_min(lo, child->lo[axis][c]);
            hi = smr_max(hi, child->hi[axis][c]);
        }
        node->lo[axis][k] = lo;
        node->hi[axis][k] = hi;
    }
}

void smr_tree_refit_nodes(const smr_box_tree *f, uint32_t first, uint32_t last)
{
    uint32_t l = 1;
    for (uint32_t i = first; i < last; i++) {
        while (l + 1u < f->n_levels && i >= f->level[l + 1u])
            l++;
        smr_node *node = &f->node[i];
        const uint32_t child = f->level[l - 1u] + (i - f->level[l]) * SMR_TREE_WIDTH;
        clear_node(node);
        for (uint32_t k = 0; k < SMR_TREE_WIDTH && child + k < f->level[l]; k++)
            set_from(node, k, &f->node[child + k]);
    }
}
