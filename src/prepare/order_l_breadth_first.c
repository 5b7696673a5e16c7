/* order_l_breadth_first.c: the paper's own order L and parents (2.2, cluster optimisation): breadth first over
 * one-ring clusters xi_i = {j : d(x_i, x_j) <= s_min}, s_min = max_i min_j d(x_i, x_j), from the vertex with the
 * largest one-ring. The whole model is one block. The forest (order_l_forest.c) gives the same sums, bit for bit.
 * Bounds: n vertices, the word range of their rows each.
 * SPDX-License-Identifier: MIT */
#include "geometry/box_tree/hilbert_curve.h"
#include "prepare/prepare_plan.h"

/* Returns s_min, mm: the largest distance from a vertex to its nearest vertex, with room for rounding. */
static float one_ring_radius(smr_plan *p)
{
    float largest = 0.0f, d2;
    uint32_t near;
    for (uint32_t v = 0; v < p->n; v++)
        if (smr_nearest(p, v, 0, p->n, 1, &near, &d2) == 1u)
            largest = smr_max(largest, d2);
    return SMR_SQRT(largest) * 1.000001f;
}

static void one_ring(smr_plan *p, uint32_t v, float s_min, uint64_t *row)
{
    (void)smr_ball_row(p, v, s_min, row);
    smr_row_keep_structure(p, v, row);
}

/* Sorts the vertices into p->item[n] by size |xi| of their one-ring, the largest first, ties by number. */
static void sort_seeds(smr_plan *p, float s_min, uint64_t *row)
{
    for (uint32_t v = 0; v < p->n; v++) {
        one_ring(p, v, s_min, row);
        p->key[v] = p->n - smr_row_count(row, p->words);
        p->item[v] = v;
    }
    smr_curve_sort(p->key, p->item, p->tmp, p->n);
}

/* Appends the vertices of v's one-ring that are not in L yet to the queue, with the parent v. Returns the new tail. */
static uint32_t append_ring(smr_plan *p, uint32_t v, const uint64_t *ring, uint32_t *parent, uint32_t tail)
{
    for (uint32_t w = smr_row_first(ring, p->words); w < smr_row_last(ring, p->words); w++)
        for (uint64_t rest = ring[w]; rest != 0u; rest &= rest - 1u) {
            const uint32_t next = w * 64u + (uint32_t)__builtin_ctzll(rest);
            if (p->entry[next] != UINT32_MAX)
                continue;
            p->entry[next] = tail;
            parent[next] = v;
            p->queue[tail++] = next;
        }
    return tail;
}

smr_status smr_breadth_first(smr_plan *p, smr_list_writer *l, float radius, uint32_t radius_index, uint32_t n_radii)
{
    uint64_t *own = smr_plan_row(p, 0), *parent_row = smr_plan_row(p, 1), *ring = smr_plan_row(p, 2);
    const float s_min = one_ring_radius(p);
    uint32_t head = 0, tail = 0, seed = 0;
    uint32_t *parent = p->count; /* an element holds a vertex' parent until the entry is written, then |zeta| */
    sort_seeds(p, s_min, ring);
    memset(p->entry, 0xff, p->n * sizeof *p->entry); /* UINT32_MAX: the vertex is not in L yet */
    smr_list_block(l);
    while (head < p->n) {
        if (head == tail) { /* the queue is empty: the next seed is a root, summed directly */
            while (p->entry[p->item[seed]] != UINT32_MAX)
                seed++;
            const uint32_t v = p->item[seed];
            p->entry[v] = tail;
            parent[v] = v;
            p->queue[tail++] = v;
        }
        const uint32_t v = p->queue[head++], up = parent[v];
        p->touched[v] = smr_cluster_row(p, v, radius, own);
        p->count[v] = smr_row_count(own, p->words);
        if (up != v)
            (void)smr_cluster_row(p, up, radius, parent_row);
        const smr_list_entry e = {v, p->entry[up], own, up == v ? NULL : parent_row};
        smr_entry_write(l, p, &e, l->n_entries, l->n_indexes);
        smr_list_append(l, p->count[v], smr_entry_indexes(p, &e));
        one_ring(p, v, s_min, ring);
        tail = append_ring(p, v, ring, parent, tail);
        if (head % 1024u == 0u && p->config->progress != NULL &&
            p->config->progress(p->config->progress_ctx, radius_index, n_radii) != 0)
            return SMR_E_ABORTED;
    }
    return SMR_OK;
}
