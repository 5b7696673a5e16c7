/* label_side.h: what two label maps, or a label map and a directory of surfaces, have for their comparison.
 * SPDX-License-Identifier: MIT */
#ifndef LABEL_SIDE_H
#define LABEL_SIDE_H

#include "labels/label_map.h"
#include "labels/label_surfaces.h"
#include "labels/surface_set.h"

/* One of the two: as a map and as surfaces. */
typedef struct host_label_side {
    const char *path;
    int is_set;                  /* a directory of surfaces */
    host_surface_set set;        /* owned */
    host_label_map map;          /* owned; of a set: once it is painted */
    host_label_surface *surface; /* [map.n_labels] of a map; owned */
    smr_mesh *mesh;              /* [map.n_labels]; the array is owned */
} host_label_side;

/* 1 when the path is a directory, or a file that says it is a volume. */
int host_is_label_side(const char *path);

/* Reads both and brings them on one grid: the first map's; another map's surfaces are painted on it. passes: of
 * smoothing. 0, or -1 with the error filled; host_label_side_free in either case. */
int host_label_sides_read(host_label_side side[2], const char *names, uint32_t passes, const smr_port *port,
                          host_error *error);
void host_label_side_free(host_label_side *side);

#endif
