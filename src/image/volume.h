/* volume.h: trilinear samples of an image volume along a line. The voxels stay in the caller's memory.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_VOLUME_H
#define SMR_VOLUME_H

#include "base/vec.h"
#include "image/intensity_profile.h"

/* A validated image volume and the map from world to index coordinates. */
typedef struct smr_grid {
    smr_volume volume;
    /* columns of the matrix of index coordinates = matrix (world - origin), and a 0 that makes them vectors of four */
    float column[3][4];
    float low[4], high[4]; /* lowest and highest index coordinate of a sample inside, along each axis */
    int32_t last[3];       /* largest index of the lower voxel of a sample, along each axis */
} smr_grid;

/* Returns a vector, world mm, in index coordinates. */
static inline smr_vec smr_grid_vector(const smr_grid *grid, smr_vec d)
{
    const float(*const c)[4] = grid->column;
    return smr_v(c[0][0] * d.x + c[1][0] * d.y + c[2][0] * d.z, c[0][1] * d.x + c[1][1] * d.y + c[2][1] * d.z,
                 c[0][2] * d.x + c[1][2] * d.y + c[2][2] * d.z);
}

/* Checks everything but the voxels' values, and fills *grid. Errors: E_NULL, E_INPUT. */
smr_status smr_grid_open(const smr_volume *volume, smr_grid *grid);

/* Writes n interpolated samples at start + k * spacing, k < n, world mm. inside[k] and value[k] are 0 where a sample
 * lies outside the volume or the mask, or meets a NaN. Returns the number of samples inside. */
uint32_t smr_grid_line(const smr_grid *grid, smr_vec start, smr_vec spacing, uint32_t n, float *value, uint8_t *inside);
/* Writes samples as smr_grid_line() does, n <= SMR_LINE_MAX, each a mean over some voxels across the line and along it.
 * noise: of the image / the mean noise level of structures; more noise, more voxels; few: 1 for few voxels across the
 * line. The same samples are inside. */
uint32_t smr_grid_thick_line(const smr_grid *grid, float noise, int few, smr_vec start, smr_vec spacing, uint32_t n,
                             float *value, uint8_t *inside);
#define SMR_TOGETHER 4u /* lines that are sampled together */
/* Writes n samples, at most SMR_PROFILE_MAX, of each of these lines as smr_grid_line() does. Returns 1, or 0 as soon as
 * a sample lies outside. Faster than line by line: the voxels of all lines are read at once. */
int smr_grid_lines(const smr_grid *grid, const smr_vec start[SMR_TOGETHER], smr_vec spacing, uint32_t n,
                   float value[SMR_TOGETHER][SMR_PROFILE_MAX]);
uint32_t smr_longest_axis(const smr_volume *v); /* the axis of the largest voxel spacing */
/* Returns the standard deviation of the image's noise, intensity; 0 for an image of less than three voxels a row. */
float smr_grid_noise(const smr_grid *grid);
/* Prefetches the voxels that smr_grid_line() reads with the arguments start, spacing and n; changes no result. */
void smr_grid_ahead(const smr_grid *grid, smr_vec start, smr_vec spacing, uint32_t n);

#endif
