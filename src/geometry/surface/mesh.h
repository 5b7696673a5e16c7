/* mesh.h: validation of triangle meshes, vertex normals and areas, and orders of triangles.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_MESH_H
#define SMR_MESH_H

#include "geometry/box_tree/box_tree.h"

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

/* order[n_triangles]: the mesh's triangle indexes in tree order (box_tree.h). Scratch: centre [n_triangles][3],
 * key [n_triangles], tmp [2 n_triangles]. */
void smr_mesh_order(const smr_mesh *mesh, uint32_t *order, float *centre, uint32_t *key, uint32_t *tmp);

/* The same in steps. centre and order are those of smr_mesh_centres(). */
#define SMR_ORDER_BYTES 256u /* values of a byte */
#define SMR_ORDER_SMALL 88u  /* triangles: ranges up to this size are sorted at once */

typedef struct smr_order {
    const float *centre;                 /* [n][3] of triangles */
    uint32_t *order, *key, *tmp, *count; /* [n]; [n]; [2 n]; [SMR_ORDER_BYTES] */
    uint32_t n;
    uint32_t stack[2u * 3u * SMR_TREE_LEVELS + 2u], top; /* ranges that wait */
    uint32_t first, size, stage, at;                     /* the range under way; size 0: none */
    float lo[3], hi[3];                                  /* around its centres */
} smr_order;

/* centre and order of the triangles first .. last-1, as the caller has them. */
void smr_mesh_centres(const smr_mesh *mesh, float *centre, uint32_t *order, uint32_t first, uint32_t last);
void smr_order_start(smr_order *o, uint32_t n, const float *centre, uint32_t *order, uint32_t *key, uint32_t *tmp,
                     uint32_t *count);

/* Goes on for `most` visits to a triangle, and to sort a small range once more. Returns 1 when the order is complete.
 * */
int smr_order_step(smr_order *o, uint32_t most);

#endif
