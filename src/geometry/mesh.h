/* mesh.h: checks and measures of triangle meshes.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_MESH_H
#define SMR_MESH_H

#include "base/vec.h"

/* Every count, index and coordinate of a mesh from outside. Errors: E_NULL, E_INPUT. */
smr_status smr_mesh_check(const smr_mesh *mesh);

/* Area-weighted vertex normals (unit, or zero) and, when area is not NULL, a third of the adjacent triangles' area.
 * normal: [n_vertices][3], area: [n_vertices], mm^2. */
void smr_mesh_normals(const smr_mesh *mesh, float *normal, float *area);

/* Triangles around each vertex: around[start[v] .. start[v+1]-1] are triangle indices, ascending.
 * start: [n_vertices + 1], around: [3 n_triangles]. A triangle that names a vertex twice is listed twice. */
void smr_mesh_around(const smr_mesh *mesh, uint32_t *start, uint32_t *around);

/* Order of the triangles for a box tree (box_tree.h): order[n_triangles]. centre: [n_triangles][3], key: [n_triangles],
 * tmp: [2 n_triangles] scratch. */
void smr_mesh_order(const smr_mesh *mesh, uint32_t *order, float *centre, uint32_t *key, uint32_t *tmp);

#endif
