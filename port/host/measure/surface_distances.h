/* surface_distances.h: distances between surfaces, and the number of folds.
 * SPDX-License-Identifier: MIT */
#ifndef SURFACE_DISTANCES_H
#define SURFACE_DISTANCES_H

#include "smr.h"

/* Statistics of n distances, mm. n = 0: no distance. */
typedef struct host_stats {
    double mean, rms, max;
    double p95; /* 95th percentile: at least 95 % of the distances are at most this */
    size_t n;
} host_stats;

/* A query: the distances of n points to one surface. */
typedef struct host_query {
    const smr_surface *surface;
    const float *xyz; /* [n][3] */
    size_t n;
    float *mm; /* [n], written */
} host_query;

/* Answers all queries with all threads. 0, or -1 when out of memory or when a point has no closest point. */
int host_distances(const smr_port *port, const host_query *queries, uint32_t n_queries);

/* The statistics of mm[n]; sorts mm. */
host_stats host_stats_of(float *mm, size_t n);

/* Builds a surface in *memory; free(*memory) releases both. NULL when the mesh has no triangle or memory is short. */
smr_surface *host_surface_make(const smr_mesh *mesh, void **memory);

/* Counts folds: interior edges (exactly two triangles) where the triangles' normals have a negative dot product in
 * `mesh`. *absolute: all of them; *folds: those that are no folds at source_xyz, the vertices before the deformation
 * (NULL: *folds = *absolute). 0, or -1 when out of memory. */
int host_count_folds(const smr_mesh *mesh, const float *source_xyz, uint64_t *folds, uint64_t *absolute);

#endif
