/* label_overlap.h: how well two label maps agree, structure by structure.
 * SPDX-License-Identifier: MIT */
#ifndef LABEL_OVERLAP_H
#define LABEL_OVERLAP_H

#include "labels/label_map.h"
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

/* 1 when two volumes have the same voxels. */
int host_same_grid(const host_volume *a, const host_volume *b);

#endif
