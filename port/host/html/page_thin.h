/* page_thin.h: what a page of bounded size shows of surfaces and of an image.
 * SPDX-License-Identifier: MIT */
#ifndef PAGE_THIN_H
#define PAGE_THIN_H

#include "meshes/triangle_mesh.h"
#include "model/input_check.h"
#include "volumes/voxel_volume.h"

/* What is shown of a mesh. */
typedef struct host_page_mesh {
    uint32_t *keep;      /* [n_vertices] indices of the mesh's vertices; owned */
    uint32_t *triangles; /* [n_triangles][3] of the kept vertices; owned */
    uint32_t n_vertices, n_triangles;
} host_page_mesh;

/* Keeps one vertex in each cube of cell_mm, all for 0, and the triangles that are left. 0, or -1 when out of memory. */
int host_page_thin(const host_mesh *mesh, float cell_mm, host_page_mesh *out);
void host_page_mesh_free(host_page_mesh *mesh);

typedef struct host_page_part {
    const host_mesh *mesh; /* borrowed */
    size_t vertex_bytes;   /* of each vertex on the page */
    host_page_mesh thin;   /* owned */
} host_page_part;

/* Thins all parts with the smallest cube, about, that leaves at most so many vertices and bytes of vertices and
 * triangles. *cell_mm: the cube's side; 0: nothing was thinned. 0, or -1 when out of memory. */
int host_page_thin_all(host_page_part *part, uint32_t n, size_t vertices_most, size_t bytes_most, float *cell_mm);
void host_page_parts_free(host_page_part *part, uint32_t n); /* NULL is allowed */

typedef struct host_page_image {
    uint32_t size[3];
    float spacing[3];  /* mm; means over voxels of the image where it is larger than the image's */
    float first[3];    /* mm, centre of the first voxel */
    double low, high;  /* brightness that 0 and 255 stand for */
    unsigned char *at; /* [size[2]][size[1]][size[0]]; owned */
} host_page_image;

/* Cuts out what lies within margin_mm of the box, in at most so many voxels. 0, or -1 when out of memory. Where box
 * and image do not meet it is empty: at is NULL. */
int host_page_image_make(const host_volume *image, const host_box *box, float margin_mm, size_t most,
                         host_page_image *out);

#endif
