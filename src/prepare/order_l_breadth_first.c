/* order_l_breadth_first.c: the paper's own order L (2.2, cluster optimisation): breadth first over one-ring clusters
 * xi_i = {j : d(i,j) <= s_min}, s_min = max_i min_j d(i,j); seeds are the vertices with the largest one-ring. One chain
 * over the whole model, kept for comparison with the forest: both give the same sums, bit for bit.
 * SPDX-License-Identifier: MIT */
#include "prepare/plan.h"

#include "geometry/hilbert_curve.h"

/* s_min^2: the largest distance from a vertex to its nearest neighbour. */
static float one_ring_radius(smr_plan *p)
{
    float largest = 0.0f;
    for (uint32_t v = 0; v < p->n; v++) {
        uint32_t near;
        float d2;
        if (smr_nearest(p, v, 0, p->n, 1, &near, &d2) == 1u)
            largest = smr_max(largest, d2);
    }
    return SMR_SQRT(largest) * 1.000001f;
}

static void one_ring(smr_plan *p, uint32_t v, float s_min, uint64_t *row)
{
    smr_ball_row(p, v, s_min, row);
    for (uint32_t w = smr_row_first(row, p->words); p->separate && w < smr_row_last(row, p->words); w++)
        for (uint64_t rest = row[w]; rest != 0u; rest &= rest - 1u)
            if (p->owner[w * 64u + (uint32_t)__builtin_ctzll(rest)] != p->owner[v])
                row[w] &= ~(rest & (~rest + 1u));
}

/* Vertices by the size of their one-ring, largest first, ties by index: item[n]. */
static void seeds(smr_plan *p, float s_min, uint64_t *row)
{
    for (uint32_t v = 0; v < p->n; v++) {
        one_ring(p, v, s_min, row);
        p->key[v] = p->n - smr_row_count(row, p->words);
        p->item[v] = v;
    }
    smr_curve_sort(p->key, p->item, p->tmp, p->n);
}

smr_status smr_breadth_first(smr_plan *p, smr_list_writer *l, float radius, uint32_t step, uint32_t steps)
{
    uint64_t *own = smr_plan_row(p, 0), *parent = smr_plan_row(p, 1), *ring = smr_plan_row(p, 2);
    const float s_min = one_ring_radius(p);
    const uint32_t none = UINT32_MAX;
    uint32_t head = 0, tail = 0, seed = 0;
    uint32_t *up = p->count; /* parent vertex until the vertex is written, then its |zeta| */
    seeds(p, s_min, ring);
    for (uint32_t v = 0; v < p->n; v++)
        p->rank[v] = none;
    smr_list_block(l);
    while (head < p->n) {
        if (head == tail) { /* a seed, summed directly */
            while (p->rank[p->item[seed]] != none)
                seed++;
            const uint32_t v = p->item[seed];
            p->rank[v] = tail;
            up[v] = v;
            p->queue[tail++] = v;
        }
        const uint32_t v = p->queue[head++], from = up[v];
        smr_cluster_row(p, v, radius, own);
        p->count[v] = smr_row_count(own, p->words);
        if (from != v)
            smr_cluster_row(p, from, radius, parent);
        smr_list_entry(l, p, v, p->rank[from], own, from == v ? NULL : parent);
        one_ring(p, v, s_min, ring);
        for (uint32_t w = smr_row_first(ring, p->words); w < smr_row_last(ring, p->words); w++) {
            for (uint64_t rest = ring[w]; rest != 0u; rest &= rest - 1u) {
                const uint32_t next = w * 64u + (uint32_t)__builtin_ctzll(rest);
                if (p->rank[next] != none)
                    continue;
                p->rank[next] = tail;
                up[next] = v;
                p->queue[tail++] = next;
            }
        }
        if (head % 1024u == 0u && p->config->progress != NULL &&
            p->config->progress(p->config->progress_ctx, step, steps) != 0)
            return SMR_E_ABORTED;
    }
    return SMR_OK;
}
