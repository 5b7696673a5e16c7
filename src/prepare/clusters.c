/* clusters.c: the vertices around a vertex, as rows of bits, and its nearest ones (paper 2.2, clustering).
 * The search tree's leaves are single vertices in curve order, so a node that lies wholly inside the ball is one run
 * of bits. Membership is decided by one comparison, d^2 <= r^2, that is the same seen from either end.
 * SPDX-License-Identifier: MIT */
#include "prepare/plan.h"

#define SMR_INSIDE 0.99999f /* of r^2: a box this far inside holds only members, whatever the rounding */
#define SMR_OUTSIDE 1.00001f

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

static const uint32_t bit_of[SMR_TREE_WIDTH] = {1, 2, 4, 8, 16, 32, 64, 128};

/* Which of a node's eight boxes lie inside the ball around p, a bit each; *reaching: which others reach into it. Behind the
 * last vertex lies nothing: boxes there are SMR_FAR away. */
static uint32_t box_kinds(const smr_node *node, smr_vec p, float inside2, float outside2, uint32_t *reaching)
{
    const float at[3] = {p.x, p.y, p.z};
    uint32_t near = 0, inner = 0;
    for (uint32_t k = 0; k < SMR_TREE_WIDTH; k++) {
        float near2 = 0.0f, far2 = 0.0f; /* squared distances to the near and far ends */
        for (uint32_t axis = 0; axis < 3u; axis++) {
            const float below = node->lo[axis][k] - at[axis], above = at[axis] - node->hi[axis][k];
            const float out = smr_positive(below) + smr_positive(above); /* at most one is positive */
            const float far = smr_positive(below - above) - below;
            near2 += out * out;
            far2 += far * far;
        }
        near |= near2 <= outside2 ? bit_of[k] : 0u;
        inner |= far2 <= inside2 ? bit_of[k] : 0u;
    }
    *reaching = near & ~inner;
    return inner;
}

/* Squared distances from p to the eight boxes. */
static void box_distances(const smr_node *node, smr_vec p, float d2[SMR_TREE_WIDTH])
{
    for (uint32_t k = 0; k < SMR_TREE_WIDTH; k++) {
        const float x = smr_positive(node->lo[0][k] - p.x) + smr_positive(p.x - node->hi[0][k]);
        const float y = smr_positive(node->lo[1][k] - p.y) + smr_positive(p.y - node->hi[1][k]);
        const float z = smr_positive(node->lo[2][k] - p.z) + smr_positive(p.z - node->hi[2][k]);
        d2[k] = x * x + y * y + z * z;
    }
}

/* Which of a leaf's eight vertices lie within r2 of p, a bit each: for boxes without extent the same as box_kinds(). Kept
 * apart: GCC unrolls it where it is inlined, and then it is not vector code any more. */
__attribute__((noinline)) static uint32_t leaf_members(const smr_node *leaf, smr_vec p, float r2)
{
    uint32_t members = 0;
    for (uint32_t k = 0; k < SMR_TREE_WIDTH; k++) {
        const float x = leaf->lo[0][k] - p.x, y = leaf->lo[1][k] - p.y, z = leaf->lo[2][k] - p.z;
        members |= x * x + y * y + z * z <= r2 ? bit_of[k] : 0u;
    }
    return members;
}

static void set_leaf(const smr_plan *p, uint32_t leaf, smr_vec centre, float r2, uint64_t *row)
{
    const uint32_t first = leaf * SMR_TREE_WIDTH, members = leaf_members(&p->points.node[leaf], centre, r2);
    if (members == 0u)
        return;
    row[first / 64u] |= (uint64_t)members << (first % 64u);
    smr_row_cover(row, p->words, first / 64u, first / 64u + 1u);
}

typedef struct visit {
    uint32_t level, index;
} visit;

void smr_ball_row(const smr_plan *p, uint32_t v, float radius, uint64_t *row)
{
    const smr_vec centre = smr_load(p->xyz + 3u * (size_t)v);
    const float r2 = radius * radius, inside = SMR_INSIDE * r2, outside = SMR_OUTSIDE * r2;
    visit stack[SMR_TREE_LEVELS * SMR_TREE_WIDTH];
    uint32_t top = 0;
    smr_row_clear(row, p->words);
    stack[top++] = (visit){p->points.n_levels - 1u, 0u};
    while (top > 0u) {
        const visit at = stack[--top];
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
            stack[top++] = (visit){at.level - 1u, at.index * SMR_TREE_WIDTH + (uint32_t)__builtin_ctz(reaching)};
    }
}

uint32_t smr_nearest(const smr_plan *p, uint32_t v, uint32_t first, uint32_t last, uint32_t k, uint32_t *found,
                     float *distance2)
{
    const smr_vec centre = smr_load(p->xyz + 3u * (size_t)v);
    float best[SMR_NEAREST], near2[SMR_TREE_WIDTH], from2[SMR_TREE_LEVELS * SMR_TREE_WIDTH];
    visit stack[SMR_TREE_LEVELS * SMR_TREE_WIDTH]; /* from2: how near those boxes are */
    uint32_t top = 0, n = 0;
    from2[top] = 0.0f;
    stack[top++] = (visit){p->points.n_levels - 1u, 0u};
    while (top > 0u) {
        const visit at = stack[--top];
        if (n == k && from2[top] >= best[k - 1u])
            continue; /* nearer ones were found since */
        box_distances(&p->points.node[p->points.level[at.level] + at.index], centre, near2);
        for (uint32_t c = 0; c < SMR_TREE_WIDTH; c++) {
            /* on inner levels start with the child that holds v: good bounds early. It is pushed last. */
            const uint32_t child =
                at.index * SMR_TREE_WIDTH + (at.level > 0u ? (c + 1u + (v >> (3u * at.level))) % 8u : c);
            const uint32_t slot = child % SMR_TREE_WIDTH;
            const uint64_t from = (uint64_t)child << (3u * at.level), to = (uint64_t)(child + 1u) << (3u * at.level);
            if (from >= last || to <= first || from >= p->n || (n == k && near2[slot] >= best[k - 1u]))
                continue;
            if (at.level > 0u) {
                from2[top] = near2[slot];
                stack[top++] = (visit){at.level - 1u, child};
                continue;
            }
            if (child == v || (p->separate && p->owner[child] != p->owner[v]))
                continue;
            uint32_t i = n < k ? n++ : k - 1u;
            for (; i > 0u && best[i - 1u] > near2[slot]; i--) {
                best[i] = best[i - 1u];
                found[i] = found[i - 1u];
            }
            best[i] = near2[slot];
            found[i] = child;
        }
    }
    if (distance2 != NULL)
        memcpy(distance2, best, n * sizeof best[0]);
    return n;
}

uint32_t smr_row_count(const uint64_t *row, uint32_t words)
{
    uint32_t count = 0;
    for (uint32_t w = smr_row_first(row, words); w < smr_row_last(row, words); w++) {
        uint64_t x = row[w];
        x = x - (x >> 1 & 0x5555555555555555u);
        x = (x & 0x3333333333333333u) + (x >> 2 & 0x3333333333333333u);
        x = (x + (x >> 4)) & 0x0f0f0f0f0f0f0f0fu;
        count += (uint32_t)((x * 0x0101010101010101u) >> 56);
    }
    return count;
}

/* Takes the vertices of other structures out of a row. */
static void keep_owner(const smr_plan *p, uint32_t owner, uint64_t *row)
{
    for (uint32_t w = smr_row_first(row, p->words); w < smr_row_last(row, p->words); w++) {
        for (uint64_t rest = row[w]; rest != 0u; rest &= rest - 1u) {
            uint32_t bit = (uint32_t)__builtin_ctzll(rest);
            if (p->owner[w * 64u + bit] != owner)
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
        keep_owner(p, p->owner[v], row);
    for (uint32_t i = p->ring_start[v]; smr_uses_ring(p, radius) && i < p->ring_start[v + 1u]; i++)
        smr_row_set(row, p->words, p->ring[i]);
}
