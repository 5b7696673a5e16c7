/* points_surface.c: a cloud as a surface to search in: each point is a triangle without an area, with the point's
 * normal. For start poses and for what else asks which point is nearest; forces need no search in a cloud.
 * Bounds: those of smr_surface_build() for as many triangles as points.
 * SPDX-License-Identifier: MIT */
#include "geometry/points.h"

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

/* What a mesh has not: normals and weights of its own, and no border. */
static void take_points(smr_surface *s, const smr_surface *cloud)
{
    const size_t n = cloud->n_vertices;
    memcpy(s->normal, cloud->normal, 3u * n * sizeof(float));
    memcpy(s->area, cloud->area, n * sizeof(float));
    memset(s->border, 0, n);
    for (size_t k = 0; k < n; k++)
        memcpy(s->facets.normal + 3u * k, cloud->normal + 3u * (size_t)s->original[k], 3u * sizeof(float));
    s->area_mean = 1.0f;
    s->open = 1;
    s->capacity = cloud->n_vertices;
}

smr_status smr_points_surface(const smr_points *points, void *memory, size_t bytes, smr_surface **surface)
{
    size_t needed;
    smr_surface *built;
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
    for (uint32_t i = 0; i < n; i++)
        index[3u * (size_t)i] = index[3u * (size_t)i + 1u] = index[3u * (size_t)i + 2u] = i;
    const smr_mesh mesh = {cloud->xyz, index, n, n};
    status = smr_surface_build(&mesh, memory, needed - index_bytes(n), &built);
    if (status != SMR_OK)
        return status;
    take_points(built, cloud);
    *surface = built;
    return SMR_OK;
}
