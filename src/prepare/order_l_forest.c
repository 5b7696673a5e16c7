/* order_l_forest.c: the order L and the parents of clusters (paper 2.2, cluster optimisation) as a minimum spanning
 * forest. Parents are chosen among nearest vertices and mesh neighbours so that all zeta+ and zeta- together are as
 * short as possible. A virtual root at the distance |zeta_i| stands for clusters that are summed directly. Each block
 * of vertices along the curve has a forest of its own, so that blocks are independent at run time.
 * Method: Kruskal 1956 with union-find; the weight of an edge i-k is |zeta+| + |zeta-|.
 * Bounds: block_size * (SMR_NEAREST + SMR_NEIGHBOURS_TRIED) candidate edges in a block.
 * SPDX-License-Identifier: MIT */
#include "geometry/box_tree/hilbert_curve.h"
#include "prepare/prepare_plan.h"

/* A block of vertices, as the argument of parallel loops, whose tasks write only the results of their own chunks. */
typedef struct block {
    smr_plan *p;
    uint32_t first, last;     /* vertices first .. last-1 along the curve */
    float radius;             /* radius of the clusters, mm */
    uint32_t n_edges;         /* number of candidate edges of the forest */
    const smr_list_writer *l; /* list of the radius; NULL: the loop does not write it */
    uint32_t entry;           /* number of the block's first entry in the list */
} block;

#define SMR_VERTEX_CHUNK 32u /* number of vertices that a task processes */
#define SMR_EDGE_CHUNK 512u  /* number of edges that a task processes */

static void sort_few(uint32_t *number, uint32_t n)
{
    for (uint32_t i = 1; i < n; i++) {
        const uint32_t own = number[i];
        uint32_t at = i;
        for (; at > 0u && number[at - 1u] > own; at--)
            number[at] = number[at - 1u];
        number[at] = own;
    }
}

/* Writes the weight |zeta+| + |zeta-| of each candidate edge of a chunk as the edge's sort key. */
static void weigh_edges(void *arg, uint32_t task, SMR_UNUSED uint32_t worker)
{
    const block *b = arg;
    smr_plan *p = b->p;
    const uint32_t from = task * SMR_EDGE_CHUNK, to = smr_min_u32(from + SMR_EDGE_CHUNK, b->n_edges);
    for (uint32_t e = from; e < to; e++) {
        p->key[e] = smr_row_difference_count(smr_plan_row(p, p->forest.edge_a[e]), smr_plan_row(p, p->forest.edge_b[e]),
                                             p->words);
        p->item[e] = e;
    }
}

/* Writes to near[] the nearest vertices and mesh neighbours of v in the block, counted from `first`. Returns n. */
static uint32_t list_near(const smr_plan *p, uint32_t v, uint32_t first, uint32_t last, uint32_t *near)
{
    const uint32_t *const known = p->forest.nearest + SMR_NEAREST * (size_t)v, from = p->neighbour_start[v];
    const uint32_t end = smr_min_u32(p->neighbour_start[v + 1u], from + SMR_NEIGHBOURS_TRIED);
    uint32_t k = 0;
    for (; k < SMR_NEAREST && known[k] != SMR_NONE; k++)
        near[k] = known[k] - first;
    for (uint32_t i = from; i < end; i++)
        if (p->neighbour[i] >= first && p->neighbour[i] < last)
            near[k++] = p->neighbour[i] - first;
    return k;
}

/* Fills edge_a < edge_b with the candidate edges, each once, vertices counted from `first`. Returns their number. The
 * edges are sorted: from key[start[a]] on lie, ascending, the vertices behind a with which a may have an edge. */
static uint32_t candidates(smr_plan *p, uint32_t first, uint32_t last)
{
    const uint32_t size = last - first;
    uint32_t near[SMR_NEAREST + SMR_NEIGHBOURS_TRIED], *const start = p->forest.link_start, unique = 0;
    memset(start, 0, ((size_t)size + 1u) * sizeof *start);
    for (uint32_t v = 0; v < size; v++)
        for (uint32_t k = list_near(p, first + v, first, last, near); k-- > 0u;)
            start[smr_min_u32(v, near[k])]++;
    for (uint32_t v = 1; v <= size; v++)
        start[v] += start[v - 1u];
    for (uint32_t v = size; v-- > 0u;)
        for (uint32_t k = list_near(p, first + v, first, last, near); k-- > 0u;)
            p->key[--start[smr_min_u32(v, near[k])]] = smr_max_u32(v, near[k]);
    for (uint32_t a = 0; a < size; a++) {
        const uint32_t n = start[a + 1u] - start[a], *const b = p->key + start[a];
        sort_few(p->key + start[a], n);
        for (uint32_t i = 0; i < n; i++)
            if (i == 0u || b[i] != b[i - 1u]) {
                p->forest.edge_a[unique] = a;
                p->forest.edge_b[unique++] = b[i];
            }
    }
    return unique;
}

/* Returns 1 when nearest[] holds the nearest vertices for clusters of the current radius. */
static int knows_nearest(const smr_plan *p) { return p->forest.nearest_kind == 1u + smr_keeps_apart(p); }

/* Finds the candidate edges, a task of its own, or fills rows and counts of a chunk's clusters, and nearest[] unless it
 * is known from the previous radius. */
static void fill_rows(void *arg, uint32_t task, SMR_UNUSED uint32_t worker)
{
    block *b = arg;
    smr_plan *p = b->p;
    if (task == 0u) {
        b->n_edges = knows_nearest(p) ? candidates(p, b->first, b->last) : 0u;
        return;
    }
    const uint32_t from = b->first + (task - 1u) * SMR_VERTEX_CHUNK, to = smr_min_u32(from + SMR_VERTEX_CHUNK, b->last);
    for (uint32_t v = from; v < to; v++) {
        uint64_t *row = smr_plan_row(p, v - b->first);
        p->touched[v] = smr_cluster_row(p, v, b->radius, row);
        p->count[v] = smr_row_count(row, p->words);
        if (knows_nearest(p))
            continue;
        uint32_t *near = p->forest.nearest + SMR_NEAREST * (size_t)v;
        uint32_t k = smr_nearest(p, v, b->first, b->last, SMR_NEAREST, near, NULL);
        while (k < SMR_NEAREST)
            near[k++] = SMR_NONE;
    }
}

/* Sorts the edges item[n] by their weights key[n], at most `most` each, stable: two passes mostly are enough. */
static void sort_edges(smr_plan *p, uint32_t n, uint32_t most)
{
    uint32_t count[SMR_SORT_BYTES];
    const smr_sort s = {p->key, p->item, p->tmp, count, n};
    for (uint32_t pass = 0; pass < (most > 0xffffu ? SMR_SORT_PASSES : 2u); pass++) {
        smr_sort_count(&s, pass, 0, n);
        smr_sort_move(&s, pass, 0, n);
    }
}

/* Writes the minimum spanning tree's edges over block and virtual root (number `size`) to tmp. Returns their number. */
static uint32_t spanning_tree(smr_plan *p, uint32_t first, uint32_t size, uint32_t n_edges)
{
    block all = {p, first, first + size, 0.0f, n_edges, NULL, 0};
    p->failed |= !smr_fork(&p->port, weigh_edges, &all, smr_ceil_div(n_edges, SMR_EDGE_CHUNK));
    for (uint32_t v = 0; v < size; v++) {
        p->forest.edge_a[n_edges + v] = v;
        p->forest.edge_b[n_edges + v] = size;
        p->key[n_edges + v] = p->count[first + v];
        p->item[n_edges + v] = n_edges + v;
    }
    n_edges += size;
    uint32_t most = 0;
    for (uint32_t e = 0; e < n_edges; e++)
        most = smr_max_u32(most, p->key[e]);
    sort_edges(p, n_edges, most);
    uint32_t kept = 0, *const parent = p->forest.parent;
    for (uint32_t v = 0; v <= size; v++)
        parent[v] = v;
    for (uint32_t i = 0; i < n_edges && kept < size; i++) {
        const uint32_t e = p->item[i];
        const uint32_t a = smr_set_root(parent, p->forest.edge_a[e]), b = smr_set_root(parent, p->forest.edge_b[e]);
        if (a != b) {
            parent[a] = b;
            p->tmp[kept++] = e;
        }
    }
    return kept;
}

/* Lists each vertex' neighbours in the spanning tree in link[], from link_start[v] on. kept: number of edges in tmp. */
static void link_up(smr_plan *p, uint32_t size, uint32_t kept)
{
    memset(p->forest.link_start, 0, ((size_t)size + 2u) * sizeof(uint32_t));
    for (uint32_t i = 0; i < kept; i++) {
        p->forest.link_start[p->forest.edge_a[p->tmp[i]]]++;
        p->forest.link_start[p->forest.edge_b[p->tmp[i]]]++;
    }
    for (uint32_t v = 1; v < size + 2u; v++)
        p->forest.link_start[v] += p->forest.link_start[v - 1u];
    for (uint32_t i = kept; i-- > 0u;) {
        const uint32_t e = p->tmp[i];
        p->forest.link[--p->forest.link_start[p->forest.edge_a[e]]] = p->forest.edge_b[e];
        p->forest.link[--p->forest.link_start[p->forest.edge_b[e]]] = p->forest.edge_a[e];
    }
}

/* Writes the block's vertices to queue[] breadth first from the root, so that parents come before their children. */
static void order_block(smr_plan *p, uint32_t first, uint32_t size)
{
    uint32_t head = 0, tail = 0;
    for (uint32_t i = p->forest.link_start[size]; i < p->forest.link_start[size + 1u]; i++) {
        p->forest.parent[p->forest.link[i]] = size;
        p->queue[tail++] = p->forest.link[i];
    }
    while (head < tail) {
        const uint32_t v = p->queue[head], up = p->forest.parent[v];
        p->entry[first + v] = head++;
        for (uint32_t i = p->forest.link_start[v]; i < p->forest.link_start[v + 1u]; i++) {
            if (p->forest.link[i] == up)
                continue;
            p->forest.parent[p->forest.link[i]] = v;
            p->queue[tail++] = p->forest.link[i];
        }
    }
}

/* Returns the entry of the block's vertex at this place of the queue. */
static smr_list_entry entry_at(const block *b, uint32_t place)
{
    const smr_plan *p = b->p;
    const uint32_t v = p->queue[place], up = p->forest.parent[v], root = b->last - b->first;
    return (smr_list_entry){b->first + v, up == root ? place : p->entry[b->first + up], smr_plan_row(p, v),
                            up == root ? NULL : smr_plan_row(p, up)};
}

/* Writes the numbers of indexes of a chunk's entries to key[]. */
static void count_indexes(void *arg, uint32_t task, SMR_UNUSED uint32_t worker)
{
    const block *b = arg;
    const uint32_t from = task * SMR_VERTEX_CHUNK, to = smr_min_u32(from + SMR_VERTEX_CHUNK, b->last - b->first);
    for (uint32_t i = from; i < to; i++) {
        const smr_list_entry e = entry_at(b, i);
        b->p->key[i] = smr_entry_indexes(b->p, &e);
    }
}

/* Writes a chunk's entries, whose first indexes are item[]. */
static void write_entries(void *arg, uint32_t task, SMR_UNUSED uint32_t worker)
{
    const block *b = arg;
    const uint32_t from = task * SMR_VERTEX_CHUNK, to = smr_min_u32(from + SMR_VERTEX_CHUNK, b->last - b->first);
    for (uint32_t i = from; i < to; i++) {
        const smr_list_entry e = entry_at(b, i);
        smr_entry_write(b->l, b->p, &e, b->entry + i, b->p->item[i]);
    }
}

void smr_forest_block(smr_plan *p, smr_list_writer *l, uint32_t first, uint32_t last, float radius)
{
    const uint32_t size = last - first, n_tasks = smr_ceil_div(size, SMR_VERTEX_CHUNK);
    block all = {p, first, last, radius, 0, l, l->n_entries};
    p->failed |= !smr_fork(&p->port, fill_rows, &all, 1u + n_tasks);
    if (p->failed)
        return;
    if (!knows_nearest(p))
        all.n_edges = candidates(p, first, last);
    link_up(p, size, spanning_tree(p, first, size, all.n_edges));
    order_block(p, first, size);
    p->failed |= !smr_fork(&p->port, count_indexes, &all, n_tasks);
    if (p->failed)
        return;
    smr_list_block(l);
    for (uint32_t i = 0; i < size; i++) {
        p->item[i] = l->n_indexes;
        smr_list_append(l, p->count[first + p->queue[i]], p->key[i]);
    }
    p->failed |= !smr_fork(&p->port, write_entries, &all, n_tasks);
}
