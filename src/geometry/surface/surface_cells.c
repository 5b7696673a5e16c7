/* surface_cells.c: divides a surface into cells: each vertex belongs to the nearest of some vertices, the middles.
 * Method: in the caller's order, each vertex farther than the radius from all middles so far becomes a middle, whose
 * distances then spread along edges where they are shorter (label-correcting shortest paths). The result does not
 * depend on the order of the visits, except where two middles are equally near.
 * Bounds: a visit takes the triangles at one vertex.
 * SPDX-License-Identifier: MIT */
#include "geometry/surface/surface_cells.h"

void smr_cells_layout(smr_arena *a, smr_cells *c)
{
    const uint32_t n = c->surface->n_vertices;
    c->cell = smr_arena_take(a, SMR_CELLS_MOST, sizeof *c->cell);
    c->of = smr_arena_take(a, n, sizeof *c->of);
    c->along = smr_arena_take(a, n, sizeof *c->along);
    c->corner = smr_arena_take(a, n, sizeof *c->corner);
    c->next = smr_arena_take(a, c->surface->tree.n_triangles, 3u * sizeof *c->next);
    c->queue = smr_arena_take(a, n, sizeof *c->queue);
    c->queued = smr_arena_take(a, n, sizeof *c->queued);
}

void smr_cells_start(const smr_cells *c, uint32_t first, uint32_t last)
{
    for (uint32_t v = first; v < last; v++) {
        c->of[v] = c->corner[v] = SMR_NONE;
        c->queued[v] = 0;
    }
}

void smr_cells_chain(const smr_cells *c, uint32_t first, uint32_t last)
{
    for (uint32_t k = 3u * first; k < 3u * last; k++) {
        uint32_t *const newest = &c->corner[c->surface->triangle[k]];
        c->next[k] = *newest;
        *newest = k;
    }
}

/* Puts a vertex into a cell, and into the queue. */
static void reach(smr_cells *c, uint32_t v, uint32_t cell, float along)
{
    c->of[v] = cell;
    c->along[v] = along;
    if (!c->queued[v])
        c->queue[(c->front + c->waiting++) % c->surface->n_vertices] = v;
    c->queued[v] = 1;
}

int smr_cells_divide(smr_cells *c)
{
    const smr_surface *s = c->surface;
    if (c->waiting == 0u) {
        const uint32_t v = c->scan++;
        if (v >= s->n_vertices || c->n > SMR_CELLS_MOST)
            return 0;
        if (c->of[v] == SMR_NONE && s->area[v] > 0.0f && c->n++ < SMR_CELLS_MOST) {
            c->cell[c->n - 1u] = (smr_cell){v, 0.0f};
            reach(c, v, c->n - 1u, 0.0f);
        }
        return 1;
    }
    const uint32_t u = c->queue[c->front];
    c->front = (c->front + 1u) % s->n_vertices;
    c->waiting--;
    c->queued[u] = 0;
    for (uint32_t k = c->corner[u]; k != SMR_NONE; k = c->next[k])
        for (uint32_t i = k / 3u * 3u, end = i + 3u; i < end; i++) {
            const uint32_t v = s->triangle[i];
            const float along = c->along[u] + smr_length(smr_sub(smr_get3(s->xyz, u), smr_get3(s->xyz, v)));
            if (along <= c->radius && (c->of[v] == SMR_NONE || along < c->along[v]))
                reach(c, v, c->of[u], along);
        }
    return 1;
}
