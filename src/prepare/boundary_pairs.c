/* boundary_pairs.c: pairs of vertices about a radius apart. Whether they are in each other's cluster would be a matter of their last
 * bits, and an unusual member carries its whole cluster along. So over a narrow boundary about the radius a member's share falls
 * from all to nothing, linearly with the distance. The lists keep to d <= r; what the share differs from that is written here.
 * Geodesic distances are whole numbers of micrometres: no boundary.
 * Bounds: one visit to the tree's boxes that the boundary crosses, for each vertex.
 * SPDX-License-Identifier: MIT */
#include "prepare/plan.h"

#define SMR_BOUNDARY_MM 7.0e-4f /* half the boundary's width: some thirty times what rounding coordinates moves */
#define SMR_BOUNDARY_SHARE (1.0f / 256.0f) /* of the radius, at most */
#define SMR_BOUNDARY_ROUNDING 1.0e-6f      /* of squared distances to boxes */

static int ring_neighbour(const smr_plan *p, uint32_t v, uint32_t other)
{
    for (uint32_t i = p->ring_start[v]; i < p->ring_start[v + 1u]; i++)
        if (p->ring[i] == other)
            return 1;
    return 0;
}

static float distance2(const smr_plan *p, uint32_t a, uint32_t b)
{
    const smr_vec d = smr_sub(smr_load(p->xyz + 3u * (size_t)a), smr_load(p->xyz + 3u * (size_t)b));
    return smr_dot(d, d);
}

/* Writes the pair, when its share is not what the lists have; counts who is in a cluster without being in its list. */
static void put_pair(smr_plan *p, smr_list_writer *l, uint32_t a, uint32_t b, float radius, float half)
{
    const float d2 = distance2(p, a, b);
    const float share = smr_clamp(0.5f + (radius - SMR_SQRT(d2)) / (2.0f * half), 0.0f, 1.0f);
    const int inside = d2 <= radius * radius, units = (int)(share * (float)SMR_BOUNDARY_UNITS + 0.5f);
    const int add = units - (inside ? SMR_BOUNDARY_UNITS : 0);
    if (add == 0 || (p->separate && p->owner[a] != p->owner[b]) ||
        (smr_uses_ring(p, radius) && ring_neighbour(p, a, b)))
        return;
    const uint32_t field[3] = {p->stored[a], p->stored[b], (uint32_t)(add + SMR_BOUNDARY_UNITS / 2)};
    const size_t at = l->at_boundary + (size_t)l->n_boundary * sizeof(smr_stored_boundary);
    for (uint32_t i = 0; i < 3u; i++)
        smr_put32(l->w, at + 4u * i, field[i]);
    l->n_boundary++;
    p->rank[a] += !inside;
    p->rank[b] += !inside;
}

/* Which of a node's eight boxes reach into the boundary around p, a bit each. */
static uint32_t crossing(const smr_node *node, smr_vec p, float near2, float far2)
{
    static const uint32_t bit[SMR_TREE_WIDTH] = {1, 2, 4, 8, 16, 32, 64, 128};
    const float at[3] = {p.x, p.y, p.z};
    uint32_t crossed = 0;
    for (uint32_t k = 0; k < SMR_TREE_WIDTH; k++) {
        float nearest = 0.0f, farthest = 0.0f;
        for (uint32_t axis = 0; axis < 3u; axis++) {
            const float below = node->lo[axis][k] - at[axis], above = at[axis] - node->hi[axis][k];
            const float out = smr_positive(below) + smr_positive(above); /* at most one is positive */
            const float far = smr_positive(below - above) - below;
            nearest += out * out;
            farthest += far * far;
        }
        crossed |= ((nearest <= far2) & (farthest >= near2)) != 0 ? bit[k] : 0u;
    }
    return crossed;
}

/* The same for a leaf, whose boxes are single vertices. Kept apart, as in clusters.c: it is vector code only by itself. */
__attribute__((noinline)) static uint32_t crossing_leaf(const smr_node *leaf, smr_vec p, float near2, float far2)
{
    static const uint32_t bit[SMR_TREE_WIDTH] = {1, 2, 4, 8, 16, 32, 64, 128};
    uint32_t crossed = 0;
    for (uint32_t k = 0; k < SMR_TREE_WIDTH; k++) {
        const float x = leaf->lo[0][k] - p.x, y = leaf->lo[1][k] - p.y, z = leaf->lo[2][k] - p.z,
                    d2 = x * x + y * y + z * z;
        crossed |= ((d2 <= far2) & (d2 >= near2)) != 0 ? bit[k] : 0u;
    }
    return crossed;
}

typedef struct visit {
    uint32_t level, index;
} visit;

/* The pairs of v and vertices behind it along the curve. */
static void find(smr_plan *p, smr_list_writer *l, uint32_t v, float radius, float half)
{
    const smr_vec at = smr_load(p->xyz + 3u * (size_t)v);
    const float near2 = (radius - half) * (radius - half) * (1.0f - SMR_BOUNDARY_ROUNDING);
    const float far2 = (radius + half) * (radius + half) * (1.0f + SMR_BOUNDARY_ROUNDING);
    visit stack[SMR_TREE_LEVELS * SMR_TREE_WIDTH];
    uint32_t top = 0;
    stack[top++] = (visit){p->points.n_levels - 1u, 0u};
    while (top > 0u) {
        const visit node = stack[--top];
        const smr_node *boxes = &p->points.node[p->points.level[node.level] + node.index];
        uint32_t in = node.level > 0u ? crossing(boxes, at, near2, far2) : crossing_leaf(boxes, at, near2, far2);
        for (; in != 0u; in &= in - 1u) {
            const uint32_t child = node.index * SMR_TREE_WIDTH + (uint32_t)__builtin_ctz(in);
            const uint64_t first = (uint64_t)child << (3u * node.level), last = (uint64_t)(child + 1u)
                                                                                << (3u * node.level);
            if (last <= (uint64_t)v + 1u || first >= p->n)
                continue;
            if (node.level > 0u)
                stack[top++] = (visit){node.level - 1u, child};
            else
                put_pair(p, l, v, child, radius, half);
        }
    }
}

void smr_write_boundary(smr_plan *p, smr_list_writer *l, float radius)
{
    const float half = smr_min(SMR_BOUNDARY_MM, SMR_BOUNDARY_SHARE * radius);
    l->at_boundary = smr_put_section(l->w, 0);
    memset(p->rank, 0, p->n * sizeof *p->rank); /* nobody's number in a block any more: how many more it may hold */
    for (uint32_t v = 0; v < p->n && p->config->distance != SMR_DISTANCE_GEODESIC; v++) {
        if (l->at_boundary + l->n_boundary * sizeof(smr_stored_boundary) > UINT32_MAX)
            break; /* too large for a model, as smr_prepare will find */
        find(p, l, v, radius, half);
    }
    l->w->used = l->at_boundary + (size_t)l->n_boundary * sizeof(smr_stored_boundary);
    for (uint32_t v = 0; v < p->n; v++) /* each of them with half its mass at most */
        l->largest = smr_max_u32(l->largest, p->count[v] + (p->rank[v] + 1u) / 2u);
}
