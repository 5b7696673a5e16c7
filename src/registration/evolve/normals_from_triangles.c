/* normals_from_triangles.c: area-weighted vertex normals from the triangles at x_next, in iterations that end with a
 * new reference shape or where the configuration demands; in other iterations averaged rotations rotate the normals.
 * The sums and their order are those of smr_mesh_normals().
 * Bounds: one pass over triangles, two over vertices.
 * SPDX-License-Identifier: MIT */
#include "geometry/box_tree/triangle.h"
#include "registration/evolve/evolve_positions.h"

uint32_t smr_exact_normals_tasks(const void *arg)
{
    const smr_evolve *e = arg;
    return e->normals_due ? e->shared->n_tasks : 0u;
}

uint32_t smr_exact_normals_sum_tasks(const void *arg)
{
    const smr_evolve *e = arg;
    return e->normals_due ? smr_triangle_tasks(e->shared) : 0u;
}

void smr_exact_normals_clear(void *arg, uint32_t task, SMR_UNUSED uint32_t worker)
{
    const smr_evolve *e = arg;
    uint32_t *const sum = e->sums->sum;
    for (uint32_t v = task * SMR_CHUNK; v < smr_chunk_end(e->shared, task); v++)
        smr_next_normal_set(sum, v, smr_v(0, 0, 0));
}

/* Adds each triangle's normal to its corners. Triangles share corners, so tasks run one after the other. */
void smr_exact_normals_sum(void *arg, uint32_t task, SMR_UNUSED uint32_t worker)
{
    const smr_evolve *e = arg;
    float *const x = e->shape->x_next;
    uint32_t *const sum = e->sums->sum;
    const uint32_t last = smr_min_u32((task + 1u) * SMR_TRIANGLE_CHUNK, e->shared->n_triangles);
    for (uint32_t k = task * SMR_TRIANGLE_CHUNK; k < last; k++) {
        const uint32_t *t = smr_triangle_at(e->shared->triangle, k, e->shared->n);
        const smr_vec n = smr_corners_cross(x, t);
        for (uint32_t c = 0; c < 3u; c++)
            smr_next_normal_set(sum, t[c], smr_add(smr_next_normal(sum, t[c]), n));
    }
}

void smr_exact_normals_unit(void *arg, uint32_t task, SMR_UNUSED uint32_t worker)
{
    const smr_evolve *e = arg;
    uint32_t *const sum = e->sums->sum;
    for (uint32_t v = task * SMR_CHUNK; v < smr_chunk_end(e->shared, task); v++)
        smr_next_normal_set(sum, v, smr_unit(smr_next_normal(sum, v)));
}
