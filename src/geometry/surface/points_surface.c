/* points_surface.c: a cloud as a surface for closest-point search: each point is a triangle without area, with the
 * point's normal. Used for start poses and measures; forces need no search in a cloud.
 * Bounds: those of a surface with as many triangles as points.
 * SPDX-License-Identifier: MIT */
#include "geometry/surface/points.h"

#include "base/arena.h"

static size_t index_bytes(uint32_t n) { return 3u * (size_t)n * sizeof(uint32_t); }

smr_status smr_points_surface_bytes(uint32_t n, size_t *bytes)
{
    const smr_status status = smr_surface_bytes(n, n, bytes);
    if (status != SMR_OK)
        return status;
    if (*bytes > SIZE_MAX - index_bytes(n))
        return SMR_E_INPUT;
    *bytes += index_bytes(n);
    return SMR_OK;
}

smr_status smr_points_surface_begin(const smr_points *points, void *memory, size_t bytes, smr_surface **surface)
{
    size_t needed;
    if (points == NULL || memory == NULL || surface == NULL)
        return SMR_E_NULL;
    if (!smr_points_valid(points))
        return SMR_E_STATE;
    const smr_surface *cloud = &points->surface;
    const uint32_t n = cloud->n_vertices;
    smr_status status = smr_points_surface_bytes(n, &needed);
    if (status != SMR_OK)
        return status;
    if ((uintptr_t)memory % SMR_ALIGN != 0u)
        return SMR_E_ALIGN;
    if (bytes < needed)
        return SMR_E_ARENA;
    uint32_t *index = (void *)((unsigned char *)memory + needed - index_bytes(n));
    const smr_mesh mesh = {cloud->xyz, index, n, n};
    status = smr_surface_begin(&mesh, memory, needed - index_bytes(n), surface);
    if (status == SMR_OK) {
        smr_arena_release(index, index_bytes(n));
        (*surface)->work.index = index;
        (*surface)->work.cloud = cloud;
        (*surface)->work.changes = cloud->changes;
    }
    return status;
}

smr_status smr_points_surface(const smr_points *points, void *memory, size_t bytes, smr_surface **surface)
{
    const smr_status status = smr_points_surface_begin(points, memory, bytes, surface);
    return status == SMR_OK ? smr_surface_step(*surface, 0, NULL, 0) : status;
}
