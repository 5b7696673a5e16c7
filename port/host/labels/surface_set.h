/* surface_set.h: a directory of surfaces, each with a name and a label; the voxels inside closed surfaces.
 * SPDX-License-Identifier: MIT */
#ifndef SURFACE_SET_H
#define SURFACE_SET_H

#include "labels/label_map.h"
#include "track/track_frames.h"

typedef struct host_surface_set {
    const char *directory; /* borrowed */
    host_frames files;     /* one frame: the directory; owned */
    host_load *load;       /* [n]; owned */
    host_label *label;     /* [n] names, values and colours; owned */
    uint32_t n;
} host_surface_set;

/* Reads the surfaces of a directory, in the order of their names. Their values: from names, a file as for
 * host_label_map_read; NULL: from DIRECTORY/labels.ctbl, where there is one. What has no value there gets the next one
 * above all others. 0, or -1 with the error filled; host_surface_set_free in either case. */
int host_surface_set_read(const char *directory, const char *names, const smr_port *port, host_surface_set *set,
                          host_error *error);
void host_surface_set_free(host_surface_set *set);

/* Paints the surfaces on a grid: a label map of one layer with the set's labels, whose voxels may be 0. shared: voxels
 * inside several surfaces; may be NULL. 0, or -1 with the error filled and the map empty. */
int host_surface_set_paint(const host_surface_set *set, const smr_port *port, const host_volume *grid,
                           host_label_map *map, uint64_t *shared, host_error *error);

typedef struct host_painted {
    uint16_t *index;           /* of the grid's voxels: 0, or 1 + the surface's number; owned */
    uint64_t *inside, *voxels; /* [n] voxels inside each surface, and those it has got; owned */
    uint64_t shared;           /* voxels inside several surfaces: each is of that in which it lies deepest */
} host_painted;

/* Paints n closed surfaces on a grid. loads: their meshes and paths. 0, or -1 with the error filled;
 * host_painted_free in either case. */
int host_paint(const smr_port *port, const host_load *loads, uint32_t n, const host_volume *grid, host_painted *painted,
               host_error *error);
void host_painted_free(host_painted *painted);

/* A box of voxels, and which of them are inside. */
typedef struct host_filled {
    uint32_t low[3], size[3]; /* size 0: none are */
    unsigned char *inside;    /* [size[2]][size[1]][size[0]], 0 or 1; owned */
    uint64_t voxels;          /* inside */
} host_filled;

/* The number in the grid of voxel i of the box. */
static inline size_t host_filled_voxel(const host_filled *f, size_t i, const host_volume *grid)
{
    const size_t x = i % f->size[0] + f->low[0], y = i / f->size[0] % f->size[1] + f->low[1],
                 z = i / f->size[0] / f->size[1] + f->low[2];
    return x + grid->size[0] * (y + grid->size[1] * z);
}

/* Finds the voxels of a grid whose centres lie inside a closed surface: a ray along the grid's first axis crosses it an
 * odd number of times before them. Which rays cross a triangle is decided in whole numbers, so rays through edges and
 * vertices are counted once; a centre on the surface belongs to one of its two sides.
 * 0, or -1 with the error's place and text filled; host_filled_free in either case. */
int host_surface_fill(const host_mesh *mesh, const host_volume *grid, host_filled *filled, host_error *error);
void host_filled_free(host_filled *filled);

/* Counts the edges with an odd number of triangles: 0 of a closed surface. Returns -1 when out of memory. */
int64_t host_open_edges(const host_mesh *mesh);

#endif
