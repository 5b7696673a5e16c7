/* surface_distances.h: distances between surfaces, and the number of folds.
 * SPDX-License-Identifier: MIT */
#ifndef SURFACE_DISTANCES_H
#define SURFACE_DISTANCES_H

#include "measure/surface_samples.h"

/* Statistics of n distances, mm, each with a weight. n = 0: no distance. */
typedef struct host_stats {
    double mean, rms, max;
    double p95; /* 95th percentile: distances up to this have at least 95 % of the weight */
    size_t n;
    double weight; /* of all */
} host_stats;

/* A query: the distances from one mesh to one surface. host_distances writes samples and mm. */
typedef struct host_query {
    const smr_surface *surface; /* borrowed */
    smr_mesh mesh;              /* borrowed */
    host_samples samples;       /* where they are measured; owned */
    float *mm;                  /* [samples.n]; owned */
} host_query;

/* Answers all queries with all threads; samples and mm are empty before. 0, or -1 when out of memory or when a point
 * has no closest point; host_queries_free in either case. */
int host_distances(const smr_port *port, host_query *queries, uint32_t n_queries);
void host_queries_free(host_query *queries, uint32_t n_queries);

/* Statistics of several queries taken together, integrated over the meshes' area (host_samples_weigh), or over their
 * vertices, of which each counts the same; a vertex without triangles does not count in a mesh that has some.
 * seen: NULL, or for each query NULL or [n_vertices] with 0 for vertices whose triangles are left out.
 * 0, or -1 when out of memory. */
int host_area_stats(const host_query *queries, uint32_t n_queries, const unsigned char *const *seen, host_stats *stats);
int host_vertex_stats(const host_query *queries, uint32_t n_queries, const unsigned char *const *seen,
                      host_stats *stats);

/* A distance and what it counts. */
typedef struct host_weighted {
    float mm, weight;
} host_weighted;

/* The statistics of n distances; sorts them. */
host_stats host_stats_of(host_weighted *value, size_t n);

/* Builds a surface in *memory; free(*memory) releases both. NULL when the mesh has no triangle or memory is short. */
smr_surface *host_surface_make(const smr_mesh *mesh, void **memory);

/* Counts folds: interior edges (exactly two triangles) where the triangles' normals have a negative dot product in
 * `mesh`. *absolute: all of them; *folds: those that are no folds at source_xyz, the vertices before the deformation
 * (NULL: *folds = *absolute). 0, or -1 when out of memory. */
int host_count_folds(const smr_mesh *mesh, const float *source_xyz, uint64_t *folds, uint64_t *absolute);

#endif
