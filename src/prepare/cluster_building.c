/* cluster_building.c: the clusters zeta_i = {j : d(x_i, x_j) <= s} (paper 2.2, clustering) as rows of bits.
 * Method: search in a box tree whose leaves are single vertices in the order of the curve, so that a node within the
 * ball is one run of bits. Membership is the one comparison d^2 <= s^2, the same from either end: clusters are
 * symmetric.
 * Bounds: every node of the tree at most once.
 * SPDX-License-Identifier: MIT */
#include "prepare/prepare_plan.h"

#define SMR_INSIDE 0.99999f  /* times r^2: boxes within it hold only members of the cluster, whatever the rounding */
#define SMR_OUTSIDE 1.00001f /* times r^2: boxes beyond it hold no member of the cluster */

/* Adds the vertices first .. last-1 to the row. */
static void set_run(uint64_t *row, uint32_t words, uint32_t first, uint32_t last)
{
    smr_row_cover(row, words, first / 64u, (last - 1u) / 64u + 1u);
    for (uint32_t w = first / 64u; w <= (last - 1u) / 64u; w++) {
        uint64_t mask = ~(uint64_t)0;
        if (w == first / 64u)
            mask &= ~(uint64_t)0 << (first % 64u);
        if (w == (last - 1u) / 64u)
            mask &= ~(uint64_t)0 >> (63u - (last - 1u) % 64u);
        row[w] |= mask;
    }
}

/* The child boxes inside the ball around p, a bit each; *reaching: those that are partly inside. Empty boxes are
 * SMR_FAR away. */
static uint32_t box_kinds(const smr_node *node, smr_vec p, float inside2, float outside2, uint32_t *reaching)
{
    uint32_t near = 0, inner = 0;
    for (uint32_t k = 0; k < SMR_TREE_WIDTH; k++) {
        float near2, far2;
        smr_box_near_far(node, k, p, &near2, &far2);
        near |= near2 <= outside2 ? smr_child_bit[k] : 0u;
        inner |= far2 <= inside2 ? smr_child_bit[k] : 0u;
    }
    *reaching = near & ~inner;
    return inner;
}

/* The leaf's vertices with squared distance <= r2 from p, a bit each. Not inlined: GCC would unroll the loop there
 * instead of vectorising it. */
__attribute__((noinline)) static uint32_t leaf_members(const smr_node *leaf, smr_vec p, float r2)
{
    uint32_t members = 0;
    for (uint32_t k = 0; k < SMR_TREE_WIDTH; k++) {
        const float x = leaf->lo[0][k] - p.x, y = leaf->lo[1][k] - p.y, z = leaf->lo[2][k] - p.z;
        members |= x * x + y * y + z * z <= r2 ? smr_child_bit[k] : 0u;
    }
    return members;
}

/* Adds the members among a leaf's vertices to the row. */
static void set_leaf(const smr_plan *p, uint32_t leaf, smr_vec centre, float r2, uint64_t *row)
{
    const uint32_t first = leaf * SMR_TREE_WIDTH, members = leaf_members(&p->points.node[leaf], centre, r2);
    if (members == 0u)
        return;
    row[first / 64u] |= (uint64_t)members << (first % 64u);
    smr_row_cover(row, p->words, first / 64u, first / 64u + 1u);
}

void smr_ball_row(const smr_plan *p, uint32_t v, float radius, uint64_t *row)
{
    const smr_vec centre = smr_get3(p->xyz, v);
    const float r2 = radius * radius, inside = SMR_INSIDE * r2, outside = SMR_OUTSIDE * r2;
    smr_visit stack[SMR_TREE_LEVELS * SMR_TREE_WIDTH];
    uint32_t top = 0;
    smr_row_clear(row, p->words);
    stack[top++] = (smr_visit){0.0f, p->points.n_levels - 1u, 0u};
    while (top > 0u) {
        const smr_visit at = stack[--top];
        if (at.level == 0u) {
            set_leaf(p, at.index, centre, r2, row);
            continue;
        }
        const smr_node *node = &p->points.node[p->points.level[at.level] + at.index];
        uint32_t reaching = 0;
        for (uint32_t inner = box_kinds(node, centre, inside, outside, &reaching); inner != 0u; inner &= inner - 1u) {
            const uint32_t child = at.index * SMR_TREE_WIDTH + (uint32_t)__builtin_ctz(inner);
            const uint64_t last = (uint64_t)(child + 1u) << (3u * at.level);
            set_run(row, p->words, child << (3u * at.level), last < p->n ? (uint32_t)last : p->n);
        }
        for (; reaching != 0u; reaching &= reaching - 1u)
            stack[top++] =
                (smr_visit){0.0f, at.level - 1u, at.index * SMR_TREE_WIDTH + (uint32_t)__builtin_ctz(reaching)};
    }
}

void smr_row_keep_structure(const smr_plan *p, uint32_t v, uint64_t *row)
{
    for (uint32_t w = smr_row_first(row, p->words); w < smr_row_last(row, p->words); w++) {
        for (uint64_t rest = row[w]; rest != 0u; rest &= rest - 1u) {
            uint32_t bit = (uint32_t)__builtin_ctzll(rest);
            if (smr_kept_apart(p, v, w * 64u + bit))
                row[w] &= ~((uint64_t)1 << bit);
        }
    }
}

void smr_cluster_row(smr_plan *p, uint32_t v, float radius, uint64_t *row)
{
    if (p->config->distance == SMR_DISTANCE_GEODESIC)
        smr_geodesic_row(p, v, radius, row);
    else
        smr_ball_row(p, v, radius, row);
    if (p->separate)
        smr_row_keep_structure(p, v, row);
    for (uint32_t i = p->neighbour_start[v]; smr_holds_neighbours(p, radius) && i < p->neighbour_start[v + 1u]; i++)
        smr_row_set(row, p->words, p->neighbour[i]);
}
