/* label_cells.h: the cells of a label map that surfaces pass through, label by label.
 * SPDX-License-Identifier: MIT */
#ifndef LABEL_CELLS_H
#define LABEL_CELLS_H

#include <stddef.h>
#include <stdint.h>

#include "base/error_line.h"

/* Cell (x, y, z) of a map of size (nx, ny, nz), 0 <= x <= nx and so on, lies between the voxels (x - 1, y - 1, z -
 * 1) and (x, y, z); beyond the map all is background. Its number is x + (nx + 1) (y + (ny + 1) z). */
typedef struct host_cells {
    uint32_t size[3];    /* of the map */
    size_t *first;       /* [n_labels + 1]: where a label's cells start; owned */
    uint32_t *cell;      /* numbers, ascending for each label; owned */
    unsigned char *mask; /* bit c: corner c has the label; owned */
    uint32_t n_labels;
} host_cells;

/* Finds the cells of the labels 1 to n_labels. index: [size[2]][size[1]][size[0]], 0 is background.
 * 0, or -1 with the error filled; host_cells_free in either case. */
int host_cells_find(const uint16_t *index, const uint32_t size[3], uint32_t n_labels, host_cells *cells,
                    host_error *error);
void host_cells_free(host_cells *cells);

#endif
