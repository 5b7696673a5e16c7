/* priority_list_levels.c: the stored order of vertices: by priority levels, the most important level first, and along
 * the curve within a level. The first m stored vertices are about the best m to keep active; lists sorted by stored
 * number are sorted by priority; neighbours in memory are mostly neighbours in space. A level ends with the active_min
 * of each radius.
 * SPDX-License-Identifier: MIT */
#include "prepare/prepare_plan.h"

#include "geometry/box_tree/hilbert_curve.h"

#define SMR_LEVEL_EIGHTHS 16u /* growth: a level and all before it hold 16/8 as many vertices as those before it */

/* Sets n_levels and level_end: an end at each of need[n] (ascending), and ends in between while there is room. */
static void choose_ends(smr_plan *p, const uint32_t *need, uint32_t n)
{
    uint32_t end[SMR_LEVELS_MAX], n_ends = 0; /* ends of levels, from the last to the first */
    for (uint32_t i = n; i-- > 0u;) {
        const uint32_t below = i > 0u ? need[i - 1u] : need[0];
        end[n_ends++] = need[i];
        for (;;) {
            const uint32_t between = (uint32_t)((uint64_t)end[n_ends - 1u] * 8u / SMR_LEVEL_EIGHTHS);
            if (n_ends + i >= SMR_LEVELS_MAX || between <= below + below / 8u)
                break;
            end[n_ends++] = between;
        }
    }
    p->n_levels = n_ends;
    for (uint32_t i = 0; i < n_ends; i++)
        p->level_end[i] = end[n_ends - 1u - i];
}

/* need: the distinct active_min of all radii and the number of all vertices, ascending. Returns their number. */
static uint32_t sorted_needs(const smr_plan *p, uint32_t n_radii, uint32_t need[SMR_RADII_MAX + 1u])
{
    uint32_t n = 0, last = 0;
    for (;;) {
        uint32_t next = p->n;
        for (uint32_t r = 0; r < n_radii; r++)
            if (p->active_min[r] > last)
                next = smr_min_u32(next, p->active_min[r]);
        need[n++] = last = next;
        if (next == p->n)
            return n;
    }
}

void smr_plan_one_level(smr_plan *p, uint32_t n_radii)
{
    p->n_levels = 1;
    p->level_end[0] = p->n;
    for (uint32_t r = 0; r < n_radii; r++)
        p->active_min[r] = p->n;
    for (uint32_t v = 0; v < p->n; v++) {
        p->stored[v] = p->along[v] = v;
        p->level[v] = 0;
    }
}

void smr_plan_levels(smr_plan *p, uint32_t n_radii)
{
    uint32_t need[SMR_RADII_MAX + 1u];
    choose_ends(p, need, sorted_needs(p, n_radii, need));
    for (uint32_t v = 0; v < p->n; v++) {
        const uint32_t rank = p->priority.place[v] == SMR_REMAINS ? 0u : p->n - 1u - p->priority.place[v];
        uint32_t level = 0;
        while (rank >= p->level_end[level])
            level++;
        p->key[v] = p->level[v] = level;
        p->along[v] = v;
    }
    smr_curve_sort(p->key, p->along, p->tmp, p->n); /* stable */
    for (uint32_t v = 0; v < p->n; v++)
        p->stored[p->along[v]] = v;
}
