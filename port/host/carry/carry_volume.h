/* carry_volume.h: what a result carries on a grid: volumes, and displacement fields.
 * SPDX-License-Identifier: MIT */
#ifndef CARRY_VOLUME_H
#define CARRY_VOLUME_H

#include "carry/carry_result.h"
#include "volumes/voxel_volume.h"

/* Fills out->voxels, of the type of `image`, on the grid that out has: each voxel shows the place of the image that
 * the registration carried there, interpolated linearly; 0 outside the image. The way back is computed on a lattice of
 * about LATTICE_MM and interpolated. Returns how many of its points were not found, or -1 with the error filled. */
int64_t host_carried_volume(host_carried *c, const host_volume *image, host_volume *out, host_error *error);

/* Fills field [size[2]][size[1]][size[0]][3], mm: what leads from a place to where the registration carried it;
 * inverse 1: from a place of the result to the model's. On grids of 5 mm or finer the values near vertices are changed
 * a little, so that linear interpolation between voxels leads from vertex to vertex. Returns at how many voxels the
 * way back was not found, or -1 with the error filled. */
int64_t host_carried_field(host_carried *c, const host_volume *grid, uint32_t inverse, float *field, host_error *error);

/* That fit alone, to any field on the grid; nothing is done on a coarser one. */
void host_carried_field_fit(const host_carried *c, const host_volume *grid, uint32_t inverse, float *field);

/* The grid's cells in which the map by a field folds: the Jacobian determinant at one of the corners is 0 or negative;
 * with `mirrors` 0 or positive. */
uint64_t host_field_folds(const host_volume *grid, const float *field, int mirrors);

/* Writes the field as a file of the path's format into the buffer, which stores failure. */
void host_carried_field_file(const host_volume *grid, uint32_t inverse, const float *field, const char *path,
                             host_buffer *out);

#endif
