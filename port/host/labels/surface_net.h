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

/* A neighbour of a vertex, and a quadrangle with the side from the vertex to it: side k from corner k to corner k +
 * 1. */
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
