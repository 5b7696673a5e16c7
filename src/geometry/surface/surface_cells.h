/* surface_cells.h: a surface divided into cells of about equal size.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_SURFACE_CELLS_H
#define SMR_SURFACE_CELLS_H

#include "base/arena.h"
#include "geometry/surface/surface.h"

#define SMR_CELLS_MOST 2048u /* largest number of cells of a surface */

/* The vertices nearest, along edges, to one of them. */
typedef struct smr_cell {
    uint32_t middle; /* that vertex */
    float area;      /* sum of the vertices' areas, mm^2 */
} smr_cell;

/* A surface in cells. The caller sets surface and radius. */
typedef struct smr_cells {
    const smr_surface *surface;
    float radius;            /* largest distance along edges from a vertex to the middle of its cell, mm */
    uint32_t n;              /* number of cells; above SMR_CELLS_MOST: there are too many */
    smr_cell *cell;          /* [SMR_CELLS_MOST] */
    uint32_t *of;            /* [n_vertices] cell of each vertex; SMR_NONE: the vertex has no area */
    float *along;            /* [n_vertices] distance along edges from the middle of the cell, mm */
    uint32_t *corner;        /* [n_vertices] index in triangle[] of a corner at each vertex; SMR_NONE: none */
    uint32_t *next;          /* [3 n_triangles] the next corner at the same vertex; SMR_NONE: none */
    uint32_t *queue;         /* [n_vertices] ring of vertices whose neighbours are to be visited */
    unsigned char *queued;   /* [n_vertices] 1: the vertex is in the queue */
    uint32_t front, waiting; /* first entry of the queue; number of entries */
    uint32_t scan;           /* next vertex that may become a middle */
} smr_cells;

void smr_cells_layout(smr_arena *a, smr_cells *c);
/* Before any triangle is chained: these vertices have no cell and no corner. */
void smr_cells_start(const smr_cells *c, uint32_t first, uint32_t last);
void smr_cells_chain(const smr_cells *c, uint32_t first, uint32_t last); /* chains the corners of some triangles */
/* Visits a vertex. Returns 0 when all vertices have a cell, or when there are too many cells. */
int smr_cells_divide(smr_cells *c);

#endif
