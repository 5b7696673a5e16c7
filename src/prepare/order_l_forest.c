/* order_l_forest.c: the order L in which cluster sums are updated (paper 2.2, cluster optimisation), as a minimum spanning
 * forest: each cluster's parent is chosen so that all differences together are as short as can be among spatial and
 * mesh neighbours. A virtual root, at the price of a whole cluster, stands for "sum it directly". Blocks of the
 * curve order have a forest each: they are independent at run time.
 * Method: Kruskal 1956 with union-find; weights are |zeta_i symmetric-difference zeta_k| from rows of bits.
 * SPDX-License-Identifier: MIT */
#include "prepare/plan.h"

#include "geometry/hilbert_curve.h"

#define SMR_TOGETHER 31u /* words whose bits a byte each can count: 8 bits a word */

/* Bits set in a xor b. Bytes count their bits side by side, without a branch: the loop is vector code. */
static uint32_t difference_count(const uint64_t *a, const uint64_t *b, uint32_t words)
{
    const uint32_t last = smr_max_u32(smr_row_last(a, words), smr_row_last(b, words));
    uint32_t count = 0;
    for (uint32_t w = smr_min_u32(smr_row_first(a, words), smr_row_first(b, words)), end; w < last; w = end) {
        uint64_t bytes = 0;
        end = smr_min_u32(w + SMR_TOGETHER, last);
        for (size_t i = w; i < end; i++) {
            uint64_t x = a[i] ^ b[i];
            x = x - (x >> 1 & 0x5555555555555555u);
            x = (x & 0x3333333333333333u) + (x >> 2 & 0x3333333333333333u);
            bytes += (x + (x >> 4)) & 0x0f0f0f0f0f0f0f0fu;
        }
        bytes = (bytes & 0x00ff00ff00ff00ffu) + (bytes >> 8 & 0x00ff00ff00ff00ffu);
        count += (uint32_t)((bytes * 0x0001000100010001u) >> 48);
    }
    return count;
}

static uint32_t find(uint32_t *set, uint32_t i)
{
    while (set[i] != i) {
        set[i] = set[set[i]];
        i = set[i];
    }
    return i;
}

/* A block, for loops over its vertices or candidate edges: each task writes rows or entries of its own. */
typedef struct block {
    smr_plan *p;
    uint32_t first, last; /* vertices */
    float radius;
    uint32_t n_edges;
} block;

#define SMR_BLOCK_CHUNK 32u /* vertices of a task */
#define SMR_EDGE_CHUNK 512u /* edges of a task */

static void fill_rows(void *arg, uint32_t task, uint32_t worker)
{
    const block *b = arg;
    smr_plan *p = b->p;
    const uint32_t from = b->first + task * SMR_BLOCK_CHUNK, to = smr_min_u32(from + SMR_BLOCK_CHUNK, b->last);
    (void)worker;
    for (uint32_t v = from; v < to; v++) {
        uint64_t *row = smr_plan_row(p, v - b->first);
        smr_cluster_row(p, v, b->radius, row);
        p->count[v] = smr_row_count(row, p->words);
    }
}

static void fill_near(void *arg, uint32_t task, uint32_t worker)
{
    const block *b = arg;
    smr_plan *p = b->p;
    const uint32_t from = b->first + task * SMR_BLOCK_CHUNK, to = smr_min_u32(from + SMR_BLOCK_CHUNK, b->last);
    (void)worker;
    for (uint32_t v = from; v < to; v++) {
        uint32_t *near = p->near + SMR_NEAREST * (size_t)v;
        uint32_t k = smr_nearest(p, v, b->first, b->last, SMR_NEAREST, near, NULL);
        while (k < SMR_NEAREST)
            near[k++] = SMR_NONE;
    }
}

static void weigh_edges(void *arg, uint32_t task, uint32_t worker)
{
    const block *b = arg;
    smr_plan *p = b->p;
    const uint32_t from = task * SMR_EDGE_CHUNK, to = smr_min_u32(from + SMR_EDGE_CHUNK, b->n_edges);
    (void)worker;
    for (uint32_t e = from; e < to; e++) {
        p->key[e] = difference_count(smr_plan_row(p, p->edge_a[e]), smr_plan_row(p, p->edge_b[e]), p->words);
        p->item[e] = e;
    }
}

/* Candidate pairs (a < b, counted from first), each once: edge_a, edge_b. Returns their number. */
static uint32_t candidates(smr_plan *p, uint32_t first, uint32_t last)
{
    const uint32_t size = last - first;
    uint32_t n = 0;
    for (uint32_t v = first; v < last; v++) {
        uint32_t near[SMR_NEAREST + SMR_RING_TRIED], k = 0;
        for (const uint32_t *known = p->near + SMR_NEAREST * (size_t)v; k < SMR_NEAREST && known[k] != SMR_NONE; k++)
            near[k] = known[k];
        for (uint32_t i = p->ring_start[v], tried = 0; i < p->ring_start[v + 1u] && tried < SMR_RING_TRIED;
             i++, tried++)
            if (p->ring[i] >= first && p->ring[i] < last)
                near[k++] = p->ring[i];
        for (uint32_t i = 0; i < k; i++) {
            const uint32_t a = smr_min_u32(v, near[i]) - first, b = smr_max_u32(v, near[i]) - first;
            p->key[n] = a * size + b;
            p->item[n++] = a;
        }
    }
    smr_curve_sort(p->key, p->item, p->tmp, n);
    uint32_t unique = 0;
    for (uint32_t i = 0; i < n; i++) {
        if (i > 0u && p->key[i] == p->key[i - 1u])
            continue;
        p->edge_a[unique] = p->item[i];
        p->edge_b[unique++] = p->key[i] - p->item[i] * size;
    }
    return unique;
}

/* Keeps the edges of the minimum spanning tree over the block's vertices and the root (number size). */
static uint32_t spanning_tree(smr_plan *p, uint32_t first, uint32_t size, uint32_t n_edges)
{
    block all = {p, first, first + size, 0.0f, n_edges};
    smr_fork(&p->port, weigh_edges, &all, smr_ceil_div(n_edges, SMR_EDGE_CHUNK));
    for (uint32_t v = 0; v < size; v++) {
        p->edge_a[n_edges + v] = v;
        p->edge_b[n_edges + v] = size;
        p->key[n_edges + v] = p->count[first + v];
        p->item[n_edges + v] = n_edges + v;
    }
    n_edges += size;
    smr_curve_sort(p->key, p->item, p->tmp, n_edges);
    for (uint32_t v = 0; v <= size; v++)
        p->set[v] = v;
    uint32_t kept = 0;
    for (uint32_t i = 0; i < n_edges && kept < size; i++) {
        const uint32_t e = p->item[i];
        const uint32_t a = find(p->set, p->edge_a[e]), b = find(p->set, p->edge_b[e]);
        if (a != b) {
            p->set[a] = b;
            p->tmp[kept++] = e;
        }
    }
    return kept;
}

/* The kept edges as neighbour lists. */
static void link_up(smr_plan *p, uint32_t size, uint32_t kept)
{
    memset(p->link_start, 0, ((size_t)size + 2u) * sizeof(uint32_t));
    for (uint32_t i = 0; i < kept; i++) {
        p->link_start[p->edge_a[p->tmp[i]]]++;
        p->link_start[p->edge_b[p->tmp[i]]]++;
    }
    for (uint32_t v = 0, sum = 0; v < size + 2u; v++) {
        sum += p->link_start[v];
        p->link_start[v] = sum;
    }
    for (uint32_t i = kept; i-- > 0u;) {
        const uint32_t e = p->tmp[i];
        p->link[--p->link_start[p->edge_a[e]]] = p->edge_b[e];
        p->link[--p->link_start[p->edge_b[e]]] = p->edge_a[e];
    }
}

void smr_forest_block(smr_plan *p, smr_list_writer *l, uint32_t first, uint32_t last, float radius)
{
    const uint32_t size = last - first, none = UINT32_MAX;
    block all = {p, first, last, radius, 0};
    smr_fork(&p->port, fill_rows, &all, smr_ceil_div(size, SMR_BLOCK_CHUNK));
    if (p->near_kind != 1u + p->separate) /* otherwise the radius before had the same neighbours */
        smr_fork(&p->port, fill_near, &all, smr_ceil_div(size, SMR_BLOCK_CHUNK));
    const uint32_t kept = spanning_tree(p, first, size, candidates(p, first, last));
    link_up(p, size, kept);
    smr_list_block(l);
    /* from the root outwards: a parent always comes before its children. set[] now holds the parent. */
    for (uint32_t v = 0; v < size; v++)
        p->rank[first + v] = none;
    uint32_t head = 0, tail = 0;
    for (uint32_t i = p->link_start[size]; i < p->link_start[size + 1u]; i++) {
        p->set[p->link[i]] = size;
        p->queue[tail++] = p->link[i];
    }
    while (head < tail) {
        const uint32_t v = p->queue[head];
        const uint32_t up = p->set[v];
        p->rank[first + v] = head++;
        smr_list_entry(l, p, first + v, up == size ? p->rank[first + v] : p->rank[first + up], smr_plan_row(p, v),
                       up == size ? NULL : smr_plan_row(p, up));
        for (uint32_t i = p->link_start[v]; i < p->link_start[v + 1u]; i++) {
            if (p->link[i] == up)
                continue;
            p->set[p->link[i]] = v;
            p->queue[tail++] = p->link[i];
        }
    }
}
