/* edge_collapse.h: one edge of a closed surface becomes a vertex: where it goes, what that costs, whether it may.
 *
 * Costs are quadrics (M. Garland, P. Heckbert, 1997): squared distances to the planes of the triangles so far, weighted
 * by area. The new vertex is the cheapest place that keeps the volume (P. Lindstrom, G. Turk, 1998).
 * SPDX-License-Identifier: MIT */
#ifndef EDGE_COLLAPSE_H
#define EDGE_COLLAPSE_H

#include "meshes/triangle_mesh.h"

#define HOST_RING_MOST 64u /* triangles about a vertex, at most */

/* Symmetric: xx xy xz yy yz zz, then x y z, then 1. */
typedef struct host_quadric {
    double q[10];
} host_quadric;

/* A surface that loses edges. The corners of a vertex are a list: first[v], next[corner], SMR_NONE at its end. */
typedef struct host_thinned {
    double *xyz;           /* [n_vertices][3] mm from the centre; owned, as are the following */
    host_quadric *quadric; /* [n_vertices] */
    uint32_t *triangles;   /* [n_triangles][3]; the first is SMR_NONE where the triangle is gone */
    uint32_t *first;       /* [n_vertices]; SMR_NONE: the vertex is gone */
    uint32_t *next;        /* [n_triangles][3] */
    double centre[3];
    uint32_t n_vertices, n_triangles, left; /* left: triangles that are still there */
} host_thinned;

/* 0, or -1 when out of memory; host_thinned_free in either case. */
int host_thinned_make(const host_mesh *mesh, host_thinned *t);
void host_thinned_free(host_thinned *t);

/* The vertices about v, n of them, at most HOST_RING_MOST. Returns n; 0 when there are more. */
uint32_t host_thinned_ring(const host_thinned *t, uint32_t v, uint32_t ring[HOST_RING_MOST]);

/* Where the edge's vertex would go, and the cost of that, mm^4. */
double host_collapse_place(const host_thinned *t, uint32_t a, uint32_t b, double at[3]);

/* 1 when the edge may become a vertex at that place: the surface stays closed and a surface, no triangle turns over, no
 * edge is folded and no triangle becomes a needle. */
int host_collapse_may(const host_thinned *t, uint32_t a, uint32_t b, const double at[3]);

/* Does it: a goes there, b is gone. */
void host_collapse_do(host_thinned *t, uint32_t a, uint32_t b, const double at[3]);

#endif
