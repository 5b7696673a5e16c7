/* cluster_building_geodesic.c: clusters by geodesic distance (paper 2.2), as shortest paths over mesh edges (Dijkstra
 * 1959) with a binary heap. Lengths are whole micrometres, so a path has the same length in both directions and
 * clusters are symmetric.
 * Paths over edges are up to a sixth longer than the true geodesic on regular meshes.
 * Bounds: at most one heap entry per directed edge.
 * SPDX-License-Identifier: MIT */
#include "prepare/prepare_plan.h"

/* A binary heap, smallest item first. An item is a distance in micrometres << 32 | a vertex. */
typedef struct heap {
    uint64_t *item; /* [n] */
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

static uint32_t micrometres(const smr_plan *p, uint32_t a, uint32_t b)
{
    float mm = smr_length(smr_sub(smr_get3(p->xyz, a), smr_get3(p->xyz, b)));
    return (uint32_t)(mm * 1000.0f + 0.5f);
}

void smr_geodesic_row(smr_plan *p, uint32_t v, float radius, uint64_t *row)
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
            continue; /* a shorter path was found after this item was pushed */
        for (uint32_t i = p->neighbour_start[from]; i < p->neighbour_start[from + 1u]; i++) {
            const uint32_t to = p->neighbour[i];
            const uint32_t edge = micrometres(p, from, to);
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
