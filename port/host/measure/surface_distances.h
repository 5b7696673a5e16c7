/* surface_distances.h: distances between surfaces, over area and over vertices; folds; targets of points.
 * SPDX-License-Identifier: MIT */
#ifndef SURFACE_DISTANCES_H
#define SURFACE_DISTANCES_H

#include "meshes/triangle_mesh.h"

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

/* Statistics of n distances, mm, each with a weight. n = 0: no distance. */
typedef struct host_stats {
    double mean, rms, max;
    double p95; /* 95th percentile: distances up to this have at least 95 % of the weight */
    size_t n;
    double weight; /* of all */
} host_stats;

/* A query: the distances from one mesh to one surface. host_distances writes samples, mm and order. */
typedef struct host_query {
    const smr_surface *surface; /* borrowed */
    smr_mesh mesh;              /* borrowed */
    host_samples samples;       /* where they are measured; owned */
    float *mm;                  /* [samples.n]; owned */
    uint32_t *order;            /* [samples.n] samples along a curve, so that neighbours are near each other; owned */
} host_query;

/* The distance from a point to the surface, mm; NaN where nothing is found. */
float host_distance(const smr_surface *surface, const float point[3]);

/* Answers all queries with all threads; samples and mm are empty before. 0, or -1 when out of memory or when a point
 * has no closest point; host_queries_free in either case. */
int host_distances(const smr_port *port, host_query *queries, uint32_t n_queries);
void host_queries_free(host_query *queries, uint32_t n_queries);

/* Statistics of several queries taken together, integrated over the meshes' area (host_samples_weigh), or over their
 * vertices, of which each counts the same; a vertex without triangles does not count in a mesh that has some.
 * seen: NULL, or for each query NULL or [n_vertices] with 0 for vertices whose triangles are left out.
 * 0, or -1 when out of memory. */
int host_area_stats(const host_query *queries, uint32_t n, const unsigned char *const *seen, host_stats *stats);
int host_vertex_stats(const host_query *queries, uint32_t n, const unsigned char *const *seen, host_stats *stats);

/* A distance and what it counts. */
typedef struct host_weighted {
    float mm, weight;
} host_weighted;

/* The statistics of n distances; sorts them. */
host_stats host_stats_of(host_weighted *value, size_t n);

/* Builds a surface in *memory; free(*memory) releases both. NULL when the mesh has no triangle or memory is short. */
smr_surface *host_surface_make(const smr_mesh *mesh, void **memory);

/* Folds: interior edges (exactly two triangles) where the triangles' normals have a negative dot product. */
typedef struct host_folds {
    uint64_t n, all;   /* those that are no folds before the deformation; all of them */
    double deepest_mm; /* of the n: largest height over the edge of the smaller one of both triangles */
} host_folds;

/* Counts folds of `mesh`. source_xyz: the vertices before the deformation (NULL: n is all). 0, or -1 when out of
 * memory. */
int host_count_folds(const smr_mesh *mesh, const float *source_xyz, host_folds *folds);

/* The mesh's vertices as a cloud in *memory; free(*memory) releases it. NULL when memory is short. */
smr_points *host_points_make(const host_mesh *mesh, void **memory);

/* The same as a surface to search in. */
smr_surface *host_points_surface(const host_mesh *mesh, void **memory);

#endif
