/* page_thin.h: fewer vertices and triangles of a surface, for a page of bounded size.
 * SPDX-License-Identifier: MIT */
#ifndef PAGE_THIN_H
#define PAGE_THIN_H

#include "meshes/triangle_mesh.h"

/* What is shown of a mesh. */
typedef struct host_page_mesh {
    uint32_t *keep;      /* [n_vertices] indices of the mesh's vertices; owned */
    uint32_t *triangles; /* [n_triangles][3] of the kept vertices; owned */
    uint32_t n_vertices, n_triangles;
} host_page_mesh;

/* Keeps one vertex in each cube of cell_mm, all for 0, and the triangles that are left. 0, or -1 when out of memory. */
int host_page_thin(const host_mesh *mesh, float cell_mm, host_page_mesh *out);
void host_page_mesh_free(host_page_mesh *mesh);

/* mm: the mean length of a triangle's first side; 0 without triangles. */
float host_page_edge(const host_mesh *mesh);

/* Bytes that n_vertices of vertex_bytes each, and triangles, take. */
size_t host_page_mesh_bytes(uint32_t n_vertices, uint32_t n_triangles, size_t vertex_bytes);

#endif
