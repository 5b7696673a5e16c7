/* mesh.h: validation of triangle meshes, vertex normals and areas, and orders of triangles.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_MESH_H
#define SMR_MESH_H

#include "base/base.h"

/* Checks every count, index and coordinate of a caller's mesh. Errors: E_NULL, E_INPUT. */
smr_status smr_mesh_check(const smr_mesh *mesh);

/* normal[n_vertices][3]: area-weighted vertex normals, unit, or zero where no adjacent triangle has an area.
 * area[n_vertices], unless NULL: a third of the area of the adjacent triangles, mm^2. */
void smr_mesh_normals(const smr_mesh *mesh, float *normal, float *area);

/* 1 when each edge of a mesh has as many triangles that run along it one way as the other way: it has an inside
 * wherever its vertices go. Decided by a sum of hashes: 64 bits. */
int smr_mesh_closed(const uint32_t *triangle, uint32_t n_triangles);

/* Lists the triangles at each vertex v: around[start[v] .. start[v+1]-1], ascending indexes.
 * start: [n_vertices + 1], around: [3 n_triangles]. A triangle that names a vertex twice is listed twice. */
void smr_mesh_around(const smr_mesh *mesh, uint32_t *start, uint32_t *around);

#endif
