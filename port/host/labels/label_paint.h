/* label_paint.h: surfaces as a label map.
 * SPDX-License-Identifier: MIT */
#ifndef LABEL_PAINT_H
#define LABEL_PAINT_H

#include "labels/label_map.h"
#include "meshes/mesh_load.h"

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
