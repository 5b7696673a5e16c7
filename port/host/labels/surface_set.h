/* surface_set.h: a directory of surfaces, each with a name and a label.
 * SPDX-License-Identifier: MIT */
#ifndef SURFACE_SET_H
#define SURFACE_SET_H

#include "labels/label_map.h"
#include "meshes/triangle_mesh.h"
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

#endif
