/* half_edges.h: the edges of a triangle mesh.
 * SPDX-License-Identifier: MIT */
#ifndef HALF_EDGES_H
#define HALF_EDGES_H

#include "smr.h"

/* A side of a triangle whose ends differ. */
typedef struct host_half_edge {
    uint32_t other; /* the larger vertex */
    uint32_t side;  /* 3 times the triangle, plus which of its corners the side starts at */
} host_half_edge;

/* Half-edges grouped by their smaller vertex v: edge[first[v]] to edge[first[v + 1] - 1], sorted by `other`, then by
 * `side`. Half-edges of one edge are therefore neighbours. */
typedef struct host_half_edges {
    size_t *first;        /* [n_vertices + 2]; owned */
    host_half_edge *edge; /* owned */
} host_half_edges;

/* 0, or -1 when out of memory. */
int host_half_edges_make(const smr_mesh *mesh, host_half_edges *edges);

void host_half_edges_free(host_half_edges *edges);

/* The end of the run of half-edges that belong to the same edge as number i of vertex v. */
static inline size_t host_half_edges_end(const host_half_edges *edges, size_t v, size_t i)
{
    size_t end = i + 1u;
    while (end < edges->first[v + 1u] && edges->edge[end].other == edges->edge[i].other)
        end++;
    return end;
}

#endif
