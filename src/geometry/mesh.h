/* mesh.h: validation of triangle meshes, vertex normals and areas, and orders of triangles.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_MESH_H
#define SMR_MESH_H

#include "base/vec.h"

/* Checks every count, index and coordinate of a caller's mesh. Errors: E_NULL, E_INPUT. */
smr_status smr_mesh_check(const smr_mesh *mesh);

/* normal[n_vertices][3]: area-weighted vertex normals, unit, or zero where no adjacent triangle has an area.
 * area[n_vertices], unless NULL: a third of the area of the adjacent triangles, mm^2. */
void smr_mesh_normals(const smr_mesh *mesh, float *normal, float *area);

/* Lists the triangles at each vertex v: around[start[v] .. start[v+1]-1], ascending indexes.
 * start: [n_vertices + 1], around: [3 n_triangles]. A triangle that names a vertex twice is listed twice. */
void smr_mesh_around(const smr_mesh *mesh, uint32_t *start, uint32_t *around);

/* order[n_triangles]: the mesh's triangle indexes in tree order (box_tree.h). Scratch: centre [n_triangles][3],
 * key [n_triangles], tmp [2 n_triangles]. */
void smr_mesh_order(const smr_mesh *mesh, uint32_t *order, float *centre, uint32_t *key, uint32_t *tmp);

#endif
