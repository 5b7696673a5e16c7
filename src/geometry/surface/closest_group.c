/* closest_group.c: closest triangles of several points near each other. One walk down the box tree lists the nodes that
 * any of the points may need; each point then searches the listed nodes.
 * Bounds: a walk that opens each node once; SMR_GROUP_NODES nodes and their leaves for each point, or its own search.
 * SPDX-License-Identifier: MIT */
#include "geometry/surface/surface.h"

#define SMR_GROUP_NODES 24u /* largest number of nodes above the leaves that a group searches together */

/* Returns a node of a tree that has nodes, or the root where a fault in a box led beyond it. */
static const smr_node *node_at(const smr_box_tree *f, uint32_t index)
{
    return &f->node[smr_min_u32(index, f->level[f->n_levels - 1u])];
}

/* Returns the children of a node within the squared distance `bound` of a box as bits. */
static uint32_t children_near(const smr_node *node, smr_box box, float bound)
{
    uint32_t near = 0;
    for (uint32_t k = 0; k < SMR_TREE_WIDTH; k++) {
        const float x = smr_positive(node->lo[0][k] - box.hi.x) + smr_positive(box.lo.x - node->hi[0][k]);
        const float y = smr_positive(node->lo[1][k] - box.hi.y) + smr_positive(box.lo.y - node->hi[1][k]);
        const float z = smr_positive(node->lo[2][k] - box.hi.z) + smr_positive(box.lo.z - node->hi[2][k]);
        near |= x * x + y * y + z * z <= bound ? smr_child_bit[k] : 0u;
    }
    return near;
}

/* Lists nodes above leaves within the squared distance `bound` of a box. Returns n; above SMR_GROUP_NODES: too many. */
static uint32_t list_nodes(const smr_box_tree *f, smr_box box, float bound, uint32_t node[SMR_GROUP_NODES])
{
    uint32_t from[SMR_GROUP_NODES], n = f->n_levels > 0u;
    node[0] = 0;
    for (uint32_t level = f->n_levels; level > 2u && n <= SMR_GROUP_NODES; level--) {
        const uint32_t n_above = n;
        memcpy(from, node, n * sizeof *node);
        n = 0;
        for (uint32_t i = 0; i < n_above; i++)
            for (uint32_t near = children_near(node_at(f, f->level[level - 1u] + from[i]), box, bound); near != 0u;
                 near &= near - 1u, n++)
                if (n < SMR_GROUP_NODES)
                    node[n] = from[i] * SMR_TREE_WIDTH + (uint32_t)__builtin_ctz(near);
    }
    return n;
}

static void search_leaf(const smr_box_tree *f, const smr_tree_mask *mask, const smr_query *q, uint32_t leaf,
                        smr_hit *hit)
{
    float d2[SMR_TREE_WIDTH];
    const uint32_t first = leaf * SMR_TREE_WIDTH;
    for (uint32_t near = smr_box_distances(node_at(f, leaf), q->point, hit->d2, d2); near != 0u; near &= near - 1u) {
        const uint32_t c = (uint32_t)__builtin_ctz(near);
        if (d2[c] <= hit->d2 && first + c < f->n_triangles && first + c != q->warm)
            smr_tree_try(f, mask, q, first + c, hit);
    }
}

/* Searches the leaves of a node above them, or the only leaf, for q's closest triangle. */
static void search_node(const smr_box_tree *f, const smr_tree_mask *mask, const smr_query *q, uint32_t node,
                        smr_hit *hit)
{
    float d2[SMR_TREE_WIDTH];
    if (f->n_levels == 1u) {
        search_leaf(f, mask, q, node, hit);
        return;
    }
    for (uint32_t near = smr_box_distances(node_at(f, f->level[1] + node), q->point, hit->d2, d2); near != 0u;
         near &= near - 1u) {
        const uint32_t c = (uint32_t)__builtin_ctz(near);
        if (d2[c] <= hit->d2)
            search_leaf(f, mask, q, node * SMR_TREE_WIDTH + c, hit);
    }
}

void smr_closest_group(const smr_box_tree *f, const smr_tree_mask *mask, smr_query *q, uint32_t n, smr_hit *hit)
{
    if (n == 1u) {
        smr_tree_closest_but(f, mask, &q[0], &hit[0], NULL);
        return;
    }
    smr_box box = {q[0].point, q[0].point};
    float bound = 0.0f;
    int forged = 0; /* 1: positions of a forged model, NaN or as far as empty boxes */
    uint32_t node[SMR_GROUP_NODES];
    for (uint32_t i = 0; i < n; i++) {
        if (q[i].warm >= f->n_triangles)
            q[i].warm = i > 0u ? hit[i - 1u].triangle : SMR_NONE;
        if (q[i].warm < f->n_triangles)
            smr_tree_try(f, mask, &q[i], q[i].warm, &hit[i]);
        else
            smr_tree_closest_but(f, mask, &q[i], &hit[i], NULL);
        forged |= !(smr_dot(q[i].point, q[i].point) < SMR_FAR);
        bound = smr_max(bound, hit[i].d2);
        box = (smr_box){smr_low(box.lo, q[i].point), smr_high(box.hi, q[i].point)};
    }
    const uint32_t n_nodes = forged ? SMR_GROUP_NODES + 1u : list_nodes(f, box, bound, node);
    for (uint32_t i = 0; i < n; i++) {
        const uint32_t before = i > 0u ? hit[i - 1u].triangle : SMR_NONE;
        if (before < f->n_triangles && before != q[i].warm)
            smr_tree_try(f, mask, &q[i], before, &hit[i]);
        q[i].warm = hit[i].triangle;
        for (uint32_t k = 0; k < n_nodes && n_nodes <= SMR_GROUP_NODES; k++)
            search_node(f, mask, &q[i], node[k], &hit[i]);
        if (n_nodes > SMR_GROUP_NODES)
            smr_tree_closest_but(f, mask, &q[i], &hit[i], NULL);
    }
}

smr_status smr_surface_distances(const smr_surface *surface, const float *xyz, uint32_t n, float *mm)
{
    smr_query q[SMR_GROUP_POINTS];
    smr_hit hit[SMR_GROUP_POINTS];
    uint32_t last = SMR_NONE;
    if (surface == NULL || xyz == NULL || mm == NULL)
        return SMR_E_NULL;
    if (!smr_surface_valid(surface))
        return SMR_E_STATE;
    for (uint32_t i = 0; i < n; i++)
        if (!smr_within3(smr_get3(xyz, i), SMR_COORD_MAX))
            return SMR_E_INPUT;
    for (uint32_t first = 0; first < n; first += SMR_GROUP_POINTS) {
        const uint32_t count = smr_min_u32(n - first, SMR_GROUP_POINTS);
        for (uint32_t i = 0; i < count; i++) {
            const smr_vec at = smr_sub(smr_get3(xyz, first + i), surface->origin);
            q[i] = (smr_query){at, smr_v(0, 0, 0), -2.0f, UINT32_MAX, i == 0u ? last : SMR_NONE};
            hit[i] = (smr_hit){SMR_FAR, SMR_NONE, {0, 0, 0}};
        }
        smr_closest_group(&surface->tree, NULL, q, count, hit);
        last = hit[count - 1u].triangle;
        for (uint32_t i = 0; i < count; i++)
            mm[first + i] = hit[i].triangle == SMR_NONE ? -1.0f : SMR_SQRT(hit[i].d2);
    }
    return SMR_OK;
}
