/* label_cells.c: finds the cells that surfaces pass through: counts them for each label, then lists them.
 * SPDX-License-Identifier: MIT */
#include "labels/label_cells.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

#define CELLS_MAX ((size_t)100u * 1000u * 1000u) /* of all labels; a map of noise has more */

typedef struct scan {
    const uint16_t *index;
    const uint16_t *empty; /* [size[0]] zeros: the rows beyond the map */
    size_t *at;            /* [n_labels + 1] by label: the count, or where its next cell goes */
    host_cells *cells;
} scan;

/* A cell whose corners differ: each of its labels gets it, or is counted. */
static void add_cell(const scan *s, const uint16_t corner[8], uint32_t cell)
{
    unsigned c = 0, k = 0;
    for (c = 0; c < 8u; c++) {
        unsigned mask = 0;
        for (k = 0; k < 8u; k++)
            mask |= (unsigned)(corner[k] == corner[c]) << k;
        if (corner[c] == 0 || (mask & ((1u << c) - 1u)) != 0) /* background, or done */
            continue;
        if (s->cells->cell != NULL) {
            s->cells->cell[s->at[corner[c]]] = cell;
            s->cells->mask[s->at[corner[c]]] = (unsigned char)mask;
        }
        s->at[corner[c]]++;
    }
}

static const uint16_t *row_at(const scan *s, uint32_t y, uint32_t z)
{
    const uint32_t *const size = s->cells->size;
    /* y and z are one too large; 0 stands for the row before the map */
    if (y == 0 || y > size[1] || z == 0 || z > size[2])
        return s->empty;
    return s->index + ((size_t)(z - 1u) * size[1] + (y - 1u)) * size[0];
}

static void scan_row(const scan *s, uint32_t y, uint32_t z)
{
    const uint32_t nx = s->cells->size[0];
    const uint16_t *const row[4] = {row_at(s, y, z), row_at(s, y + 1u, z), row_at(s, y, z + 1u),
                                    row_at(s, y + 1u, z + 1u)};
    const uint32_t first = (nx + 1u) * (y + (s->cells->size[1] + 1u) * z);
    uint16_t corner[8] = {0};
    uint32_t x = 0, k = 0;
    for (x = 0; x <= nx; x++) {
        unsigned differ = 0;
        for (k = 0; k < 4u; k++) {
            corner[2u * k] = corner[2u * k + 1u];
            corner[2u * k + 1u] = x < nx ? row[k][x] : 0;
        }
        for (k = 1; k < 8u; k++)
            differ |= (unsigned)(corner[k] ^ corner[0]);
        if (differ != 0)
            add_cell(s, corner, first + x);
    }
}

static void scan_all(const scan *s)
{
    uint32_t y = 0, z = 0;
    for (z = 0; z <= s->cells->size[2]; z++)
        for (y = 0; y <= s->cells->size[1]; y++)
            scan_row(s, y, z);
}

/* Turns counts into the places where each label starts. Returns how many cells there are. */
static size_t place_labels(const scan *s)
{
    host_cells *const cells = s->cells;
    size_t all = 0;
    uint32_t i = 0;
    for (i = 0; i < cells->n_labels; i++) {
        cells->first[i] = all;
        all += s->at[i + 1u];
        s->at[i + 1u] = cells->first[i];
    }
    cells->first[cells->n_labels] = all;
    return all;
}

static int list_cells(const scan *s, host_error *error)
{
    host_cells *const cells = s->cells;
    size_t n = 0;
    scan_all(s);
    n = place_labels(s);
    if (n > CELLS_MAX)
        return host_fail(error, "labels",
                         "at most %zu million cells at the borders of labels, found %zu: is it a label map?",
                         CELLS_MAX / 1000000u, n);
    cells->mask = host_alloc(n);
    cells->cell = host_alloc(n * sizeof *cells->cell);
    if (cells->mask == NULL || cells->cell == NULL)
        return host_fail(error, "labels", "free memory");
    scan_all(s);
    return 0;
}

int host_cells_find(const uint16_t *index, const uint32_t size[3], uint32_t n_labels, host_cells *cells,
                    host_error *error)
{
    scan s;
    uint16_t *const empty = calloc(size[0], sizeof *empty);
    int result = -1;
    memset(cells, 0, sizeof *cells);
    memcpy(cells->size, size, sizeof cells->size);
    cells->n_labels = n_labels;
    cells->first = calloc((size_t)n_labels + 1u, sizeof *cells->first);
    s.index = index;
    s.empty = empty;
    s.cells = cells;
    s.at = calloc((size_t)n_labels + 1u, sizeof *s.at);
    if (empty == NULL || s.at == NULL || cells->first == NULL)
        (void)host_fail(error, "labels", "free memory");
    else
        result = list_cells(&s, error);
    free(s.at);
    free(empty);
    return result;
}

void host_cells_free(host_cells *cells)
{
    free(cells->first);
    free(cells->cell);
    free(cells->mask);
    memset(cells, 0, sizeof *cells);
}
