/* cell_loops.h: how a surface passes through a cell, the cube between eight voxel centres, of a binary mask.
 * SPDX-License-Identifier: MIT */
#ifndef CELL_LOOPS_H
#define CELL_LOOPS_H

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

#endif
