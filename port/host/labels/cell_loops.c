/* cell_loops.c: groups the crossed edges of a cell into loops by what happens on its six faces.
 *
 * On a face with two crossed edges they belong together. On one with four, either its inside corners are cut off one
 * by one, or its outside corners are. Both cells of a face must do the same; then surfaces have no holes.
 * Source: G. M. Nielson, "Dual Marching Cubes", 2004; R. Wenger, "Isosurfaces", 2013, for faces crossed twice.
 * SPDX-License-Identifier: MIT */
#include "labels/cell_loops.h"

#include <string.h>

void host_cell_edge(unsigned edge, unsigned corner[2])
{
    const unsigned a = edge / 4u;
    corner[0] = (edge & 1u) << (a + 1u) % 3u | (edge >> 1 & 1u) << (a + 2u) % 3u;
    corner[1] = corner[0] | 1u << a;
}

/* The face's corners in a circle; edge k runs from corner k to corner k + 1. */
static void face_circle(unsigned face, unsigned corner[4], unsigned edge[4])
{
    const unsigned a = face / 2u, s = face % 2u, b = (a + 1u) % 3u, c = (a + 2u) % 3u;
    corner[0] = s << a;
    corner[1] = corner[0] | 1u << b;
    corner[2] = corner[1] | 1u << c;
    corner[3] = corner[0] | 1u << c;
    edge[0] = 4u * b + 2u * s;
    edge[1] = 4u * c + s + 2u;
    edge[2] = 4u * b + 2u * s + 1u;
    edge[3] = 4u * c + s;
}

static void unite(unsigned char group[HOST_CELL_EDGES], unsigned a, unsigned b)
{
    const unsigned char from = group[a] > group[b] ? group[a] : group[b],
                        to = group[a] > group[b] ? group[b] : group[a];
    unsigned e = 0;
    for (e = 0; e < HOST_CELL_EDGES; e++)
        if (group[e] == from)
            group[e] = to;
}

/* Joins the edges that belong together on a face. Returns 1 when its four edges are crossed. */
static int join_on_face(unsigned mask, unsigned face, int joined, unsigned char group[HOST_CELL_EDGES])
{
    unsigned corner[4], edge[4], k = 0, n = 0, crossed[4] = {0};
    face_circle(face, corner, edge);
    for (k = 0; k < 4u; k++)
        if ((mask >> corner[k] & 1u) != (mask >> corner[(k + 1u) % 4u] & 1u))
            crossed[n++] = edge[k];
    if (n == 2u)
        unite(group, crossed[0], crossed[1]);
    for (k = 0; n == 4u && k < 4u; k++)
        if ((mask >> corner[k] & 1u) != (unsigned)joined) /* this corner is cut off */
            unite(group, edge[(k + 3u) % 4u], edge[k]);
    return n == 4u;
}

host_loops host_cell_loops(unsigned mask, unsigned joined)
{
    unsigned char group[HOST_CELL_EDGES], name[HOST_CELL_EDGES];
    unsigned corner[4], edge[4], e = 0, f = 0, four = 0;
    host_loops loops;
    memset(&loops, 0, sizeof loops);
    memset(name, HOST_NO_LOOP, sizeof name);
    for (e = 0; e < HOST_CELL_EDGES; e++)
        group[e] = (unsigned char)e;
    for (f = 0; f < HOST_CELL_FACES; f++)
        four |= (unsigned)join_on_face(mask, f, (int)(joined >> f & 1u), group) << f;
    for (e = 0; e < HOST_CELL_EDGES; e++) {
        host_cell_edge(e, corner);
        loops.of[e] = HOST_NO_LOOP;
        if ((mask >> corner[0] & 1u) == (mask >> corner[1] & 1u))
            continue;
        if (name[group[e]] == HOST_NO_LOOP)
            name[group[e]] = loops.n++;
        loops.of[e] = name[group[e]];
    }
    for (f = 0; f < HOST_CELL_FACES; f++) {
        face_circle(f, corner, edge);
        if ((four >> f & 1u) != 0 && loops.of[edge[0]] == loops.of[edge[1]] && loops.of[edge[1]] == loops.of[edge[2]])
            loops.twice |= (unsigned char)(1u << f);
    }
    return loops;
}
