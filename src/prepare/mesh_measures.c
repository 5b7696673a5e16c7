/* mesh_measures.c: the mesh neighbours of each vertex, edge lengths, and the masses m_i of the vertices (paper 2.3): 1
 * each, or a third of the area of the adjacent triangles, scaled to a mean of 1 and rounded to multiples of
 * 1 / SMR_MASS_UNITS. Vertices without triangles get no forces and have the least mass.
 * Bounds: 6 nt neighbours before duplicates are removed; those of each vertex are sorted.
 * SPDX-License-Identifier: MIT */
#include "geometry/box_tree/hilbert_curve.h"
#include "geometry/box_tree/triangle.h"
#include "prepare/prepare_plan.h"

/* Fills neighbour_start and neighbour with the two neighbours of each corner of each triangle, duplicates included. */
static void list_corners(smr_plan *p)
{
    uint32_t *start = p->neighbour_start;
    memset(start, 0, ((size_t)p->n + 1u) * sizeof *start);
    for (size_t i = 0; i < 3u * (size_t)p->nt; i++)
        start[p->triangle[i]] += 2u;
    for (uint32_t v = 1; v <= p->n; v++)
        start[v] += start[v - 1u];
    for (size_t i = 3u * (size_t)p->nt; i-- > 0u;) {
        const uint32_t *t = p->triangle + i / 3u * 3u;
        const uint32_t v = p->triangle[i], corner = (uint32_t)(i % 3u);
        p->neighbour[--start[v]] = t[(corner + 1u) % 3u];
        p->neighbour[--start[v]] = t[(corner + 2u) % 3u];
    }
}

/* Computes edge_mm and edge_max, the mean and largest edge length. Each edge counts twice, once from either end. */
static void measure_edges(smr_plan *p)
{
    float sum = 0.0f;
    p->edge_max = 0.0f;
    for (uint32_t v = 0; v < p->n; v++)
        for (uint32_t i = p->neighbour_start[v]; i < p->neighbour_start[v + 1u]; i++) {
            const float length = smr_length(smr_sub(smr_get3(p->xyz, v), smr_get3(p->xyz, p->neighbour[i])));
            sum += length;
            p->edge_max = smr_max(p->edge_max, length);
        }
    p->edge_mm = p->neighbour_start[p->n] > 0u ? sum / (float)p->neighbour_start[p->n] : 0.0f;
}

void smr_plan_neighbours(smr_plan *p)
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
    measure_edges(p);
}

void smr_plan_mass(smr_plan *p)
{
    const int by_area = p->config->mass == SMR_MASS_AREA && p->nt > 0u;
    float total = 0.0f;
    for (uint32_t v = 0; v < p->n; v++)
        p->mass[v] = by_area ? 0.0f : p->nt == 0u ? 1.0f : 1.0f / SMR_MASS_UNITS;
    for (uint32_t i = 0; !by_area && i < 3u * p->nt; i++)
        p->mass[p->triangle[i]] = 1.0f;
    if (!by_area)
        return;
    for (uint32_t k = 0; k < p->nt; k++) {
        const uint32_t *t = p->triangle + 3u * (size_t)k;
        const float third = smr_length(smr_corners_cross(p->xyz, t)) * (1.0f / 6.0f);
        for (uint32_t c = 0; c < 3u; c++)
            p->mass[t[c]] += third;
        total += 3.0f * third;
    }
    const float unit = total > 0.0f ? SMR_MASS_UNITS * (float)p->n / total : 0.0f;
    for (uint32_t v = 0; v < p->n; v++) {
        const float units = smr_clamp(p->mass[v] * unit + 0.5f, 1.0f, SMR_MASS_MAX * SMR_MASS_UNITS);
        p->mass[v] = (float)(uint32_t)units / SMR_MASS_UNITS;
    }
}
