/* How close two surfaces are, and whether one is folded.
 * SPDX-License-Identifier: MIT */
#ifndef SURFACE_DISTANCES_H
#define SURFACE_DISTANCES_H

#include "smr.h"

/* Of point-to-surface distances, mm. n = 0: there were none. */
typedef struct host_stats {
    double mean, rms, max;
    double p95; /* the smallest distance that at least 95 of 100 points do not exceed */
    size_t n;
} host_stats;

/* Distances of many points to one surface. */
typedef struct host_query {
    const smr_surface *surface;
    const float *xyz; /* [n][3] */
    size_t n;
    float *mm; /* [n], written */
} host_query;

/* Answers all queries with all threads. 0, or -1 when memory ends or a point finds nothing. */
int host_distances(const smr_port *port, const host_query *queries, uint32_t n_queries);

/* Sorts mm. */
host_stats host_stats_of(float *mm, size_t n);

/* A surface and its memory; NULL when the mesh has no triangle or memory ends. free() both: *memory. */
smr_surface *host_surface_make(const smr_mesh *mesh, void **memory);

/* Interior edges (exactly two triangles) whose two triangle normals point against each other (negative dot
 * product) in `mesh`: *absolute counts them all, *folds those where they do not in `source`, a mesh of the
 * same triangles (NULL: *folds = *absolute). 0, or -1 when memory ends. */
int host_folds(const smr_mesh *mesh, const float *source_xyz, uint64_t *folds, uint64_t *absolute);

#endif
