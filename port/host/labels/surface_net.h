/* surface_net.h: the smooth closed surface of one label.
 *
 * A surface net has a vertex for each loop of the surface through a cell, and a quadrangle around each grid line
 * between an inside and an outside voxel. Vertices stay in their cells, so every voxel's centre stays on its side of
 * the surface.
 * SPDX-License-Identifier: MIT */
#ifndef SURFACE_NET_H
#define SURFACE_NET_H

#include <stddef.h>
#include <stdint.h>

/* Corner x + 2 y + 4 z of a cell, x, y, z in 0, 1. Edge 4 a + u + 2 v runs along axis a, at u on axis (a + 1) % 3 and v
 * on axis (a + 2) % 3. Face 2 a + s lies across axis a, at s. */
enum { HOST_CELL_EDGES = 12, HOST_CELL_FACES = 6, HOST_NO_LOOP = 255 };

/* The edges that the surface crosses, grouped into closed loops. */
typedef struct host_loops {
    unsigned char n;                   /* loops, 0 to 4 */
    unsigned char of[HOST_CELL_EDGES]; /* the loop that crosses the edge; HOST_NO_LOOP: none does */
    unsigned char twice;               /* bit f: one loop crosses face f twice */
} host_loops;

/* The loops of a cell. mask: bit c says that corner c is inside. joined: bit f says that on face f, where two inside
 * corners lie on one diagonal, these are joined; otherwise they are apart. */
host_loops host_cell_loops(unsigned mask, unsigned joined);

/* The corners at the two ends of an edge; the second has the larger number. */
void host_cell_edge(unsigned edge, unsigned corner[2]);

/* A neighbour of a vertex, and a quadrangle with the side from the vertex to it: side k from corner k to k + 1. */
typedef struct host_net_side {
    uint32_t to, quad, k;
} host_net_side;

typedef struct host_net {
    float *xyz;           /* [n_vertices][3] mm along the map's axes, voxel 0 at 0; owned */
    float *start;         /* [n_vertices][3] likewise, before smoothing; owned */
    float *low, *high;    /* [n_vertices][3] where the vertex may be; owned */
    uint32_t *quad;       /* [n_quads][4] vertices, counterclockwise from outside; owned */
    unsigned char *split; /* [n_quads] 0: along corners 0 and 2, 1: along 1 and 3; owned */
    size_t *side_first;   /* [n_vertices + 1]; owned */
    host_net_side *side;  /* [4 n_quads] grouped by the vertex they start at; owned */
    uint32_t n_vertices, n_quads;
} host_net;

/* Builds the net of a label. cell, mask: its n cells, as in host_cells. size: of the map. spacing: mm. The map may have
 * at most 2^24 voxels along an axis. 0, or -1 when out of memory or beyond SMR_VERTICES_MAX; host_net_free in either
 * case. */
int host_net_make(const uint32_t *cell, const unsigned char *mask, size_t n, const uint32_t size[3],
                  const float spacing[3], host_net *net);
void host_net_free(host_net *net);

/* Smooths the net. passes: of the filter. volume: mm^3, what it is to enclose. Returns the number of edges that are
 * still turned back by more than a right angle. */
uint32_t host_net_smooth(host_net *net, uint32_t passes, double volume);

/* The volume inside, mm^3, and the area, mm^2. */
double host_net_volume(const host_net *net, double *area);

/* The two triangles of a quadrangle, as corners 0 to 3. */
void host_net_corners(const host_net *net, uint32_t quad, unsigned char corner[2][3]);

#endif
