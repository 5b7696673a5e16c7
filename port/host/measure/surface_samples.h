/* surface_samples.h: the points of a surface where distances are measured, and the area that each stands for.
 * SPDX-License-Identifier: MIT */
#ifndef SURFACE_SAMPLES_H
#define SURFACE_SAMPLES_H

#include "smr.h"

/* Vertices, then midpoints of edges, then centroids of triangles. A mesh without triangles has its vertices only. */
typedef struct host_samples {
    float *xyz;       /* [n][3], mm; owned */
    uint32_t *middle; /* [n_triangles][3] for each side its midpoint, SMR_NONE where its ends are one vertex; owned */
    size_t n;
    size_t n_vertices;
} host_samples;

/* 0, or -1 when out of memory. */
int host_samples_make(const smr_mesh *mesh, host_samples *samples);

void host_samples_free(host_samples *samples);

#define HOST_NOT_COUNTED (-1.0f)

/* Writes what each sample counts, weight[samples->n]: of each triangle's area 27/60 go to its centroid, 8/60 to the
 * midpoint of each side and 3/60 to each corner, which integrates polynomials up to the third degree exactly.
 * seen: NULL, or [n_vertices]: only triangles count whose three corners are not 0. What belongs to no triangle that
 * counts gets HOST_NOT_COUNTED. Where nothing has an area, and in a mesh without triangles, all count the same. */
void host_samples_weigh(const host_samples *samples, const smr_mesh *mesh, const unsigned char *seen, float *weight);

#endif
