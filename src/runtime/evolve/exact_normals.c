/* exact_normals.c: vertex normals from the triangles at x_next, area-weighted, where the iteration ends with a new reference shape or the
 * configuration asks for it; otherwise the averaged rotations carry them (evolve.c). The same sums as smr_mesh_normals(), in
 * the same order, cut into small tasks. They lie where evolve left the carried ones.
 * Bounds: one pass over triangles, two over vertices.
 * SPDX-License-Identifier: MIT */
#include "geometry/triangle.h"
#include "runtime/state.h"

uint32_t smr_exact_tasks(smr *s) { return s->exact ? s->n_tasks : 0u; }
uint32_t smr_exact_facet_tasks(smr *s) { return s->exact ? smr_ceil_div(s->n_triangles, SMR_TRIANGLE_CHUNK) : 0u; }

void smr_exact_clear(void *arg, uint32_t task, uint32_t worker)
{
    smr *s = arg;
    (void)worker;
    for (uint32_t v = task * SMR_CHUNK; v < smr_chunk_end(s, task); v++)
        smr_spare_set(s, v, smr_v(0, 0, 0));
}

/* Neighbours share vertices: one task after the other. */
void smr_exact_facets(void *arg, uint32_t task, uint32_t worker)
{
    smr *s = arg;
    (void)worker;
    const uint32_t last = smr_min_u32((task + 1u) * SMR_TRIANGLE_CHUNK, s->n_triangles);
    for (uint32_t k = task * SMR_TRIANGLE_CHUNK; k < last; k++) {
        const uint32_t *t = s->triangle + 3u * (size_t)k;
        const smr_vec n = smr_triangle_cross(smr_load(smr_at3(s->x_next, t[0])), smr_load(smr_at3(s->x_next, t[1])),
                                             smr_load(smr_at3(s->x_next, t[2])));
        for (uint32_t c = 0; c < 3u; c++)
            smr_spare_set(s, t[c], smr_add(smr_spare(s, t[c]), n));
    }
}

void smr_exact_unit(void *arg, uint32_t task, uint32_t worker)
{
    smr *s = arg;
    (void)worker;
    for (uint32_t v = task * SMR_CHUNK; v < smr_chunk_end(s, task); v++)
        smr_spare_set(s, v, smr_unit(smr_spare(s, v)));
}
