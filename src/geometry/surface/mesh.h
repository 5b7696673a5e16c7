/* mesh.h: validation of triangle meshes, and vertex normals and areas.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_MESH_H
#define SMR_MESH_H

#include "base/base.h"

/* 1 when all n values are within +-most; 0 with a NaN among them. */
static inline int smr_all_within(const float *value, size_t n, float most)
{
    int outside = 0;
    for (size_t i = 0; i < n; i++)
        outside |= !smr_within(value[i], most);
    return !outside;
}

/* Checks every count, index and coordinate of a caller's mesh. Errors: E_NULL, E_INPUT. */
smr_status smr_mesh_check(const smr_mesh *mesh);

/* normal[n_vertices][3]: area-weighted vertex normals, unit, or zero where no adjacent triangle has an area.
 * area[n_vertices], unless NULL: a third of the area of the adjacent triangles, mm^2. */
void smr_mesh_normals(const smr_mesh *mesh, float *normal, float *area);

/* Adds what the triangles first .. last-1 add to the sums in normal and area, before normals are made unit. */
void smr_mesh_add_normals(const float *xyz, const uint32_t *triangle, uint32_t first, uint32_t last, float *normal,
                          float *area);

/* 1 when each edge of a mesh has as many triangles that run along it one way as the other way: it has an inside
 * wherever its vertices go. Decided by a sum of hashes: 64 bits. */
int smr_mesh_closed(const uint32_t *triangle, uint32_t n_triangles);

#endif
