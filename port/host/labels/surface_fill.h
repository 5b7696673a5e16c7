/* surface_fill.h: the voxels inside closed surfaces.
 * SPDX-License-Identifier: MIT */
#ifndef SURFACE_FILL_H
#define SURFACE_FILL_H

#include "meshes/triangle_mesh.h"
#include "volumes/voxel_volume.h"

/* A box of voxels, and which of them are inside. */
typedef struct host_filled {
    uint32_t low[3], size[3]; /* size 0: none are */
    unsigned char *inside;    /* [size[2]][size[1]][size[0]], 0 or 1; owned */
    uint64_t voxels;          /* inside */
} host_filled;

/* Finds the voxels of a grid whose centres lie inside a closed surface: a ray along the grid's first axis crosses it an
 * odd number of times before them. Which rays cross a triangle is decided in whole numbers, so rays through edges and
 * vertices are counted once; a centre on the surface belongs to one of its two sides.
 * 0, or -1 with the error's place and text filled; host_filled_free in either case. */
int host_surface_fill(const host_mesh *mesh, const host_volume *grid, host_filled *filled, host_error *error);
void host_filled_free(host_filled *filled);

/* Counts the edges with an odd number of triangles: 0 of a closed surface. Returns -1 when out of memory. */
int64_t host_open_edges(const host_mesh *mesh);

#endif
