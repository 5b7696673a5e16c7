/* point_targets.c: clouds of points as targets.
 * SPDX-License-Identifier: MIT */
#include "measure/point_targets.h"

#include <stdlib.h>

#include "base/memory.h"

smr_points *host_points_make(const host_mesh *mesh, void **memory)
{
    smr_points *points = NULL;
    size_t bytes = 0;
    *memory = NULL;
    if (smr_points_bytes(mesh->n_vertices, &bytes) == SMR_OK)
        *memory = host_alloc(bytes);
    if (*memory != NULL && smr_points_open(mesh->n_vertices, *memory, bytes, &points) == SMR_OK &&
        smr_points_add(points, mesh->xyz, mesh->normals, NULL, mesh->n_vertices) == SMR_OK)
        return points;
    free(*memory);
    *memory = NULL;
    return NULL;
}

smr_surface *host_points_surface(const host_mesh *mesh, void **memory)
{
    void *cloud = NULL;
    const smr_points *const points = host_points_make(mesh, &cloud);
    smr_surface *surface = NULL;
    size_t bytes = 0;
    *memory = NULL;
    if (points != NULL && smr_points_surface_bytes(mesh->n_vertices, &bytes) == SMR_OK)
        *memory = host_alloc(bytes);
    if (*memory == NULL || smr_points_surface(points, *memory, bytes, &surface) != SMR_OK) {
        free(*memory);
        *memory = NULL;
        surface = NULL;
    }
    free(cloud);
    return surface;
}
