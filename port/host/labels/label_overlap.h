/* label_overlap.h: how label maps, or a label map and surfaces, overlap.
 * SPDX-License-Identifier: MIT */
#ifndef LABEL_OVERLAP_H
#define LABEL_OVERLAP_H

#include "labels/label_surfaces.h"
#include "labels/surface_set.h"
#include "measure/surface_distances.h"

/* A structure of two maps. */
typedef struct host_overlap {
    char name[SMR_NAME_BYTES];
    uint32_t a, b;               /* its labels' numbers in the maps; SMR_NONE: it is not there */
    uint64_t voxels_a, voxels_b; /* of each */
    uint64_t both;               /* voxels that it has in both */
    double dice;                 /* twice those, over the sum of its voxels in each; 0 to 1 */
    double mm3_a, mm3_b;
    host_stats to_b, to_a; /* distances between its surfaces, over their areas; n = 0: one of them is missing */
    double hausdorff95;    /* mm, the larger 95th percentile of both directions */
    double mean;           /* mm, over both surfaces */
} host_overlap;

/* Compares the labels of two maps with the same size by their names; label_7 is also the label 7 of another name. Gives
 * a's labels, then those that b alone has. mesh_a, mesh_b: [n_labels] their surfaces; one without triangles has no
 * distances. overlap: [a->n_labels + b->n_labels]. Returns how many there are, or -1 with the error filled. */
int host_overlaps_measure(const smr_port *port, const host_label_map *a, const smr_mesh *mesh_a,
                          const host_label_map *b, const smr_mesh *mesh_b, host_overlap *overlap, host_error *error);

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
