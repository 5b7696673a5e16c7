/* cluster_building.c: the clusters zeta_i = {j : d(x_i, x_j) <= s} (paper 2.2, clustering) as rows of bits, and the
 * vertices nearest to a vertex.
 * Method: search in a box tree whose leaves are single vertices in the order of the curve, so that a node within the
 * ball is one run of bits. Membership is the comparison d^2 <= s^2, the same from either end: clusters are symmetric.
 * Geodesic distances are shortest paths over mesh edges (Dijkstra 1959) in whole micrometres, the same in both
 * directions; on regular meshes paths are up to a sixth longer than the true geodesic.
 * Bounds: every node of the tree at most once; SMR_NEAREST insertions a vertex; one heap entry a directed edge.
 * SPDX-License-Identifier: MIT */
#include "prepare/prepare_plan.h"

#define SMR_INSIDE 0.99999f  /* factor of r^2: a box wholly within this squared distance holds only members */
#define SMR_OUTSIDE 1.00001f /* factor of r^2: a box wholly beyond this squared distance holds no member */

void smr_plan_clear_rows(const smr_plan *p)
{
    memset(p->row, 0, p->n_rows * (p->words + (size_t)1u) * sizeof *p->row);
    for (uint32_t i = 0; i < p->n_rows; i++)
        smr_plan_row(p, i)[p->words] = p->words;
}

uint32_t smr_box_kinds(const smr_node *node, smr_vec p, float inside2, float outside2, uint32_t *reaching)
{
    const float at[3] = {p.x, p.y, p.z};
    uint32_t near = 0, inner = 0;
    for (uint32_t k = 0; k < SMR_TREE_WIDTH; k++) {
        float near2 = 0.0f, far2 = 0.0f; /* squared distances to the box' nearest and farthest point, mm^2 */
        for (uint32_t axis = 0; axis < 3u; axis++) {
            const float below = node->lo[axis][k] - at[axis], above = at[axis] - node->hi[axis][k];
            const float out = smr_positive(smr_max(below, above)); /* distance outside the box on the axis */
            const float far = smr_min(below, above);               /* minus the distance to the box' farther side, mm */
            near2 += out * out;
            far2 += far * far;
        }
        near |= near2 <= outside2 ? smr_child_bit[k] : 0u;
        inner |= far2 <= inside2 ? smr_child_bit[k] : 0u;
    }
    *reaching = near & ~inner;
    return inner;
}

/* Not inlined: GCC would unroll, not vectorise, the loop. */
__attribute__((noinline)) uint32_t smr_leaf_members(const smr_node *leaf, smr_vec p, float near2, float far2,
                                                    uint32_t *outer)
{
    uint32_t near = 0, far = 0;
    for (uint32_t k = 0; k < SMR_TREE_WIDTH; k++) {
        const float x = leaf->lo[0][k] - p.x, y = leaf->lo[1][k] - p.y, z = leaf->lo[2][k] - p.z;
        const float d2 = x * x + y * y + z * z;
        near |= d2 <= near2 ? smr_child_bit[k] : 0u;
        far |= d2 <= far2 ? smr_child_bit[k] : 0u;
    }
    *outer = far;
    return near;
}

typedef struct ball {
    smr_vec centre;   /* centre of the ball, mm */
    smr_boundary at;  /* squared distances between which the ball's boundary lies */
    float r2;         /* squared radius of the ball, mm^2 */
    uint32_t touched; /* not 0: a vertex lies in the boundary */
} ball;

/* Returns the vertices of a leaf in the ball, a bit each. */
static uint64_t members_of(const smr_node *leaf, ball *b)
{
    uint32_t outer, members = smr_leaf_members(leaf, b->centre, b->at.near2, b->at.far2, &outer);
    if (members == outer)
        return members;
    b->touched = 1;
    return smr_leaf_members(leaf, b->centre, b->r2, b->r2, &outer);
}

/* Returns the vertices below a node of level 1 that lie in the ball, a bit each. inner, reaching: smr_box_kinds(). */
static uint64_t members_below(const smr_node *leaf, ball *b, uint32_t inner, uint32_t reaching)
{
    uint64_t word = 0;
    for (; inner != 0u; inner &= inner - 1u)
        word |= (uint64_t)255u << (SMR_TREE_WIDTH * (uint32_t)__builtin_ctz(inner));
    for (; reaching != 0u; reaching &= reaching - 1u) {
        const uint32_t k = (uint32_t)__builtin_ctz(reaching);
        word |= members_of(leaf + k, b) << (SMR_TREE_WIDTH * k);
    }
    return word;
}

uint32_t smr_ball_row(const smr_plan *p, uint32_t v, float radius, uint64_t *row)
{
    ball b = {smr_get3(p->xyz, v), smr_boundary_at(radius), radius * radius, 0};
    const float inside = smr_min(SMR_INSIDE * b.r2, b.at.near2), outside = smr_max(SMR_OUTSIDE * b.r2, b.at.far2);
    const smr_box_tree *const tree = p->members > 0u ? &p->few : &p->points;
    smr_visit stack[SMR_TREE_LEVELS * SMR_TREE_WIDTH];
    uint32_t top = 0, first = p->words, last = 0; /* first .. last - 1: words with members */
    smr_row_clear(row, p->words);
    stack[top++] = (smr_visit){0.0f, tree->n_levels - 1u, 0u};
    if (tree->n_levels == 1u) { /* the tree's only node is a leaf */
        row[first = --top] = members_of(tree->node, &b);
        last = 1;
    }
    while (top > 0u) {
        const smr_visit at = stack[--top];
        const uint32_t base = at.index * SMR_TREE_WIDTH, shift = 3u * (at.level - 2u); /* 2^shift words in a child */
        uint32_t reaching,
            inner = smr_box_kinds(&tree->node[tree->level[at.level] + at.index], b.centre, inside, outside, &reaching);
        if (at.level == 1u) {
            row[at.index] = members_below(&tree->node[base], &b, inner, reaching);
            first = smr_min_u32(first, at.index);
            last = smr_max_u32(last, at.index + 1u);
            continue;
        }
        for (; inner != 0u; inner &= inner - 1u) {
            const uint32_t child = base + (uint32_t)__builtin_ctz(inner);
            const uint32_t end = smr_min_u32((child + 1u) << shift, p->words);
            for (uint32_t w = child << shift; w < end; w++)
                row[w] = ~(uint64_t)0;
            first = smr_min_u32(first, child << shift);
            last = smr_max_u32(last, end);
        }
        for (; reaching != 0u; reaching &= reaching - 1u)
            stack[top++] = (smr_visit){0.0f, at.level - 1u, base + (uint32_t)__builtin_ctz(reaching)};
    }
    if (last == p->words)
        row[last - 1u] &= ~(uint64_t)0 >> (63u - (tree->n_triangles - 1u) % 64u); /* none behind the last vertex */
    smr_row_cover(row, p->words, first, last);
    return b.touched;
}

/* A binary heap of [n] items, smallest item first. An item is a distance in micrometres << 32 | a vertex. */
typedef struct heap {
    uint64_t *item;
    uint32_t n;
} heap;

static void push(heap *h, uint32_t distance, uint32_t vertex)
{
    const uint64_t item = (uint64_t)distance << 32 | vertex;
    uint32_t i = h->n++;
    for (; i > 0u && h->item[(i - 1u) / 2u] > item; i = (i - 1u) / 2u)
        h->item[i] = h->item[(i - 1u) / 2u];
    h->item[i] = item;
}

static uint64_t pop(heap *h)
{
    const uint64_t first = h->item[0], last = h->item[--h->n];
    uint32_t i = 0;
    for (uint32_t child = 1; child < h->n; child = 2u * i + 1u) {
        child += child + 1u < h->n && h->item[child + 1u] < h->item[child];
        if (h->item[child] >= last)
            break;
        h->item[i] = h->item[child];
        i = child;
    }
    h->item[i] = last;
    return first;
}

static void geodesic_row(smr_plan *p, uint32_t v, float radius, uint64_t *row)
{
    const uint32_t limit = (uint32_t)smr_min(radius * 1000.0f, 4.0e9f);
    heap h = {p->geo_heap, 0};
    smr_row_clear(row, p->words);
    p->geo_distance[v] = 0;
    smr_row_set(row, p->words, v);
    push(&h, 0, v);
    while (h.n > 0u) {
        const uint64_t item = pop(&h);
        const uint32_t distance = (uint32_t)(item >> 32), from = (uint32_t)item;
        if (distance > p->geo_distance[from])
            continue; /* skips an item that was pushed before a shorter path was found */
        for (uint32_t i = p->neighbour_start[from]; i < p->neighbour_start[from + 1u]; i++) {
            const uint32_t to = p->neighbour[i];
            const float mm = smr_length(smr_sub(smr_get3(p->xyz, from), smr_get3(p->xyz, to)));
            const uint32_t edge = (uint32_t)(mm * 1000.0f + 0.5f);
            if (edge > limit - distance || distance + edge >= p->geo_distance[to])
                continue;
            p->geo_distance[to] = distance + edge;
            smr_row_set(row, p->words, to);
            push(&h, distance + edge, to);
        }
    }
    for (uint32_t w = smr_row_first(row, p->words); w < smr_row_last(row, p->words); w++)
        for (uint64_t rest = row[w]; rest != 0u; rest &= rest - 1u)
            p->geo_distance[w * 64u + (uint32_t)__builtin_ctzll(rest)] = UINT32_MAX;
}

void smr_row_keep_structure(const smr_plan *p, uint32_t v, uint64_t *row)
{
    for (uint32_t w = smr_row_first(row, p->words); smr_keeps_apart(p) && w < smr_row_last(row, p->words); w++)
        for (uint64_t rest = row[w]; rest != 0u; rest &= rest - 1u) {
            uint32_t bit = (uint32_t)__builtin_ctzll(rest);
            if (smr_kept_apart(p, v, smr_bit_vertex(p, w * 64u + bit)))
                row[w] &= ~((uint64_t)1 << bit);
        }
}

uint32_t smr_cluster_row(smr_plan *p, uint32_t v, float radius, uint64_t *row)
{
    uint32_t touched = 0;
    if (p->config->distance == SMR_DISTANCE_GEODESIC)
        geodesic_row(p, v, radius, row);
    else
        touched = smr_ball_row(p, v, radius, row);
    smr_row_keep_structure(p, v, row);
    for (uint32_t i = p->neighbour_start[v]; smr_holds_neighbours(p, radius) && i < p->neighbour_start[v + 1u]; i++) {
        const uint32_t next = p->neighbour[i];
        if (smr_is_member(p, next))
            smr_row_set(row, p->words, p->members > 0u ? p->bit[next] : next);
    }
    return touched;
}

/* Returns, in each byte, the number of bits set in that byte of x. The function has no branch. */
static uint64_t bits_per_byte(uint64_t x)
{
    x = x - (x >> 1 & 0x5555555555555555u);
    x = (x & 0x3333333333333333u) + (x >> 2 & 0x3333333333333333u);
    return (x + (x >> 4)) & 0x0f0f0f0f0f0f0f0fu;
}

uint32_t smr_row_count(const uint64_t *row, uint32_t words)
{
    uint32_t count = 0;
    for (uint32_t w = smr_row_first(row, words); w < smr_row_last(row, words); w++)
        count += (uint32_t)((bits_per_byte(row[w]) * 0x0101010101010101u) >> 56);
    return count;
}

#define SMR_ADDED 7u   /* words that full adders make one word of ones, one of twos and one of fours of */
#define SMR_ABREAST 4u /* words side by side: a byte of their sum holds at most 4 * SMR_ADDED * 8 bits = 224 */

/* Returns the number of bits in which SMR_ABREAST * SMR_ADDED words differ, as a sum in each byte (W. J. Harley and
 * R. Seal, in Warren, "Hacker's Delight", 2012). */
static inline uint64_t differing(const uint64_t *a, const uint64_t *b)
{
    uint64_t bytes = 0;
    for (uint32_t i = 0; i < SMR_ABREAST; i++) {
        uint64_t one = a[i] ^ b[i], carry[3];
        for (uint32_t k = 0; k < 3u; k++) {
            const uint32_t at = i + (2u * k + 1u) * SMR_ABREAST;
            const uint64_t x = a[at] ^ b[at], y = a[at + SMR_ABREAST] ^ b[at + SMR_ABREAST], odd = one ^ x;
            carry[k] = (one & x) | (odd & y);
            one = odd ^ y;
        }
        const uint64_t odd = carry[0] ^ carry[1], four = (carry[0] & carry[1]) | (odd & carry[2]);
        bytes += bits_per_byte(one) + (bits_per_byte(odd ^ carry[2]) << 1) + (bits_per_byte(four) << 2);
    }
    return bytes;
}

static uint32_t sum_of_bytes(uint64_t bytes)
{
    bytes = (bytes & 0x00ff00ff00ff00ffu) + (bytes >> 8 & 0x00ff00ff00ff00ffu);
    return (uint32_t)((bytes * 0x0001000100010001u) >> 48);
}

uint32_t smr_row_difference_count(const uint64_t *a, const uint64_t *b, uint32_t words)
{
    const uint32_t last = smr_max_u32(smr_row_last(a, words), smr_row_last(b, words));
    uint32_t count = 0, w = smr_min_u32(smr_row_first(a, words), smr_row_first(b, words));
    for (; w + SMR_ABREAST * SMR_ADDED <= last; w += SMR_ABREAST * SMR_ADDED)
        count += sum_of_bytes(differing(a + w, b + w));
    uint64_t bytes = 0;
    for (; w < last; w++)
        bytes += bits_per_byte(a[w] ^ b[w]);
    return count + sum_of_bytes(bytes);
}

#define SMR_NODE_FULL 255u /* all children of a node, a bit each */

/* The n <= k vertices found so far that are nearest to a given vertex, the nearest first. */
typedef struct candidates {
    float d2[SMR_NEAREST]; /* squared distance of each vertex found, mm^2 */
    uint32_t *found;       /* [k] curve index of each vertex found */
    uint32_t n, k;
} candidates;

/* Returns 1 when the list is full and d2 is not below the list's last distance. */
static int too_far(const candidates *c, float d2) { return c->n == c->k && d2 >= c->d2[c->k - 1u]; }

/* Inserts a vertex into the list, sorted by distance; the farthest vertex drops out of a full list. */
static void insert(candidates *c, uint32_t vertex, float d2)
{
    uint32_t i = c->n < c->k ? c->n++ : c->k - 1u;
    for (; i > 0u && c->d2[i - 1u] > d2; i--) {
        c->d2[i] = c->d2[i - 1u];
        c->found[i] = c->found[i - 1u];
    }
    c->d2[i] = d2;
    c->found[i] = vertex;
}

uint32_t smr_nearest(const smr_plan *p, uint32_t v, uint32_t first, uint32_t last, uint32_t k, uint32_t *found,
                     float *distance2)
{
    const smr_vec centre = smr_get3(p->xyz, v);
    candidates best = {.found = found, .k = k};
    float d2[SMR_TREE_WIDTH];
    smr_visit stack[SMR_TREE_LEVELS * SMR_TREE_WIDTH];
    uint32_t top = 0;
    stack[top++] = (smr_visit){0.0f, p->points.n_levels - 1u, 0u};
    while (top > 0u) {
        const smr_visit at = stack[--top];
        if (too_far(&best, at.d2))
            continue;
        const uint32_t near = smr_box_distances(&p->points.node[p->points.level[at.level] + at.index], centre,
                                                best.n == k ? best.d2[k - 1u] : FLT_MAX, d2);
        /* the child that holds v is pushed last and opened first: small distances are found early */
        const uint32_t turn = at.level > 0u ? (1u + (v >> (3u * at.level))) % SMR_TREE_WIDTH : 0u;
        for (uint32_t rest = (near | near << SMR_TREE_WIDTH) >> turn & SMR_NODE_FULL; rest != 0u; rest &= rest - 1u) {
            const uint32_t c = ((uint32_t)__builtin_ctz(rest) + turn) % SMR_TREE_WIDTH;
            const uint32_t child = at.index * SMR_TREE_WIDTH + c;
            const uint64_t from = (uint64_t)child << (3u * at.level), to = (uint64_t)(child + 1u) << (3u * at.level);
            if (from >= last || to <= first || from >= p->n || too_far(&best, d2[c]))
                continue;
            if (at.level > 0u)
                stack[top++] = (smr_visit){d2[c], at.level - 1u, child};
            else if (child != v && !smr_kept_apart(p, child, v))
                insert(&best, child, d2[c]);
        }
    }
    if (distance2 != NULL)
        memcpy(distance2, best.d2, best.n * sizeof best.d2[0]);
    return best.n;
}
