/* cloud_copy.c: stages of building a cloud's copy as a surface: each point is a triangle without an area.
 * Bounds: one pass over the points.
 * SPDX-License-Identifier: MIT */
#include "geometry/surface/surface.h"

int smr_cloud_index(smr_surface *s, uint32_t first, uint32_t last)
{
    for (uint32_t i = first; i < last; i++) {
        uint32_t *const corner = s->work.index + 3u * (size_t)i;
        corner[0] = corner[1] = corner[2] = i;
    }
    return 1;
}

/* Copies the cloud's normals and weights. Returns 0 when the cloud has changed since the build began. */
int smr_cloud_copy(smr_surface *s, uint32_t first, uint32_t last)
{
    const smr_surface *cloud = s->work.cloud;
    const size_t at = first, n = last - first;
    if (cloud->changes != s->work.changes)
        return 0;
    memcpy(s->normal + 3u * at, cloud->normal + 3u * at, 3u * n * sizeof(float));
    memcpy(s->area + at, cloud->area + at, n * sizeof(float));
    memset(s->border + at, 0, n);
    for (size_t k = at; k < last; k++)
        memcpy(s->tree.normal + 3u * k, cloud->normal + 3u * (size_t)s->original[k], 3u * sizeof(float));
    return 1;
}
