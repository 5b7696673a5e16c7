/* volume.h: samples of a borrowed voxel volume along a line.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_VOLUME_H
#define SMR_VOLUME_H

#include "base/vec.h"

/* A checked volume with its world-to-index map. */
typedef struct smr_grid {
    smr_volume volume;
    float to_index[9]; /* index = to_index (world - origin) */
} smr_grid;

/* Checks everything but the voxels and derives the map. Errors: E_NULL, E_INPUT. */
smr_status smr_grid_open(const smr_volume *volume, smr_grid *grid);

/* n trilinear samples at start + k * step, k = 0 .. n - 1 (world mm). inside[k] is 0 where a sample lies outside the
 * volume or the mask, or meets a NaN; value[k] is 0 there and nothing outside is read. Returns how many are inside. */
uint32_t smr_grid_line(const smr_grid *grid, smr_vec start, smr_vec step, uint32_t n, float *value,
                       unsigned char *inside);

/* Asks the processor for the voxels that smr_grid_line will read on such a line, so that they are near by then. A hint only. */
void smr_grid_ahead(const smr_grid *grid, smr_vec start, smr_vec step, uint32_t n);

#endif
