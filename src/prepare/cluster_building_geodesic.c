/* cluster_building_geodesic.c: clusters by geodesic distance (paper 2.2), as shortest paths over mesh edges (Dijkstra
 * 1959) with a binary heap. Lengths are whole micrometres, so a path has the same length in both directions and
 * clusters are symmetric.
 * Paths over edges are up to a sixth longer than the true geodesic on regular meshes.
 * Bounds: at most one heap entry per directed edge.
 * SPDX-License-Identifier: MIT */
#include "prepare/prepare_plan.h"

/* A binary heap of vertices with the smallest distance first. */
typedef struct heap {
    uint32_t *pair; /* [2 n] distance (micrometres) and vertex of each item */
    uint32_t n;
} heap;

static void push(heap *h, uint32_t distance, uint32_t vertex)
{
    uint32_t i = h->n++;
    while (i > 0u) {
        uint32_t up = (i - 1u) / 2u;
        if (h->pair[2u * (size_t)up] <= distance)
            break;
        memcpy(h->pair + 2u * (size_t)i, h->pair + 2u * (size_t)up, 2u * sizeof(uint32_t));
        i = up;
    }
    h->pair[2u * (size_t)i] = distance;
    h->pair[2u * (size_t)i + 1u] = vertex;
}

/* Removes the item with the smallest distance. */
static void pop(heap *h, uint32_t *distance, uint32_t *vertex)
{
    *distance = h->pair[0];
    *vertex = h->pair[1];
    const uint32_t d = h->pair[2u * (size_t)(h->n - 1u)], v = h->pair[2u * (size_t)(h->n - 1u) + 1u];
    h->n--;
    uint32_t i = 0;
    for (;;) {
        uint32_t child = 2u * i + 1u;
        if (child >= h->n)
            break;
        if (child + 1u < h->n && h->pair[2u * (size_t)(child + 1u)] < h->pair[2u * (size_t)child])
            child++;
        if (h->pair[2u * (size_t)child] >= d)
            break;
        memcpy(h->pair + 2u * (size_t)i, h->pair + 2u * (size_t)child, 2u * sizeof(uint32_t));
        i = child;
    }
    h->pair[2u * (size_t)i] = d;
    h->pair[2u * (size_t)i + 1u] = v;
}

/* Length of the edge between a and b. */
static uint32_t micrometres(const smr_plan *p, uint32_t a, uint32_t b)
{
    float mm = smr_length(smr_sub(smr_load(p->xyz + 3u * (size_t)a), smr_load(p->xyz + 3u * (size_t)b)));
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
        uint32_t distance, from;
        pop(&h, &distance, &from);
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
