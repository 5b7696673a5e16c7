/* mesh.h: checks of triangle meshes, and vertex normals and areas.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_MESH_H
#define SMR_MESH_H

#include "base/base.h"

/* Checks every count, index and coordinate of a caller's mesh. Errors: E_NULL, E_INPUT. */
smr_status smr_mesh_check(const smr_mesh *mesh);
/* Writes normal[n][3]: unit vertex normals, 0 without area; unless NULL, area[n]: a third of adjacent areas, mm^2. */
void smr_mesh_normals(const smr_mesh *mesh, float *normal, float *area);

/* Adds twice the area vector of each triangle first .. last-1 to normal[] of the triangle's corners; unless area is
 * NULL, also a third of the triangle's area, mm^2, to area[] of the corners. */
void smr_mesh_add_normals(const float *xyz, const uint32_t *triangle, uint32_t n_vertices, uint32_t first,
                          uint32_t last, float *normal, float *area);
/* Returns the sum of hashes of the triangles' edges: 0 for a closed mesh, whose edges have as many triangles in either
 * direction. */
uint64_t smr_mesh_edges(const uint32_t *triangle, uint32_t n_triangles);

#endif
