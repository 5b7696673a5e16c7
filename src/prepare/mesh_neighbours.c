/* mesh_neighbours.c: the mesh neighbours of each vertex, and edge lengths.
 * Bounds: 6 nt neighbours before duplicates are removed; those of each vertex are sorted.
 * SPDX-License-Identifier: MIT */
#include "geometry/box_tree/hilbert_curve.h"
#include "prepare/prepare_plan.h"

/* Lists the two neighbours that each corner of each triangle has, duplicates included: neighbour_start, neighbour. */
static void list_corners(smr_plan *p)
{
    uint32_t *start = p->neighbour_start;
    memset(start, 0, ((size_t)p->n + 1u) * sizeof *start);
    for (size_t i = 0; i < 3u * (size_t)p->nt; i++)
        start[p->triangle[i]] += 2u;
    for (uint32_t v = 0, sum = 0; v <= p->n; v++) {
        sum += start[v];
        start[v] = sum;
    }
    for (size_t i = 3u * (size_t)p->nt; i-- > 0u;) {
        const uint32_t *t = p->triangle + i / 3u * 3u;
        const uint32_t v = p->triangle[i], corner = (uint32_t)(i % 3u);
        p->neighbour[--start[v]] = t[(corner + 1u) % 3u];
        p->neighbour[--start[v]] = t[(corner + 2u) % 3u];
    }
}

/* Finds the distinct mesh neighbours of each vertex, ascending. */
static void find_neighbours(smr_plan *p)
{
    uint32_t *start = p->neighbour_start;
    uint32_t out = 0;
    list_corners(p);
    for (uint32_t v = 0, from = 0; v < p->n; v++) {
        const uint32_t last = start[v + 1u], n = last - from, begin = out;
        for (uint32_t i = 0; i < n; i++)
            p->key[i] = p->item[i] = p->neighbour[from + i];
        smr_curve_sort(p->key, p->item, p->tmp, n);
        for (uint32_t i = 0; i < n; i++)
            if (p->key[i] != v && (i == 0u || p->key[i] != p->key[i - 1u]))
                p->neighbour[out++] = p->key[i];
        from = last;
        start[v] = begin;
    }
    start[p->n] = out;
}

static void measure_edges(smr_plan *p)
{
    float sum = 0.0f;
    p->edge_max = 0.0f;
    for (uint32_t v = 0; v < p->n; v++) {
        for (uint32_t i = p->neighbour_start[v]; i < p->neighbour_start[v + 1u]; i++) {
            const float *a = p->xyz + 3u * (size_t)v, *b = p->xyz + 3u * (size_t)p->neighbour[i];
            const float length = smr_length(smr_sub(smr_load(a), smr_load(b)));
            sum += length;
            p->edge_max = smr_max(p->edge_max, length);
        }
    }
    p->edge_mm = p->neighbour_start[p->n] > 0u ? sum / (float)p->neighbour_start[p->n] : 0.0f;
}

void smr_plan_neighbours(smr_plan *p)
{
    find_neighbours(p);
    measure_edges(p);
}
