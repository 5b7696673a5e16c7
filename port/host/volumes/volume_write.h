/* volume_write.h: writes volumes: images and displacement fields, as NRRD or MetaImage, uncompressed, LPS.
 * SPDX-License-Identifier: MIT */
#ifndef VOLUME_WRITE_H
#define VOLUME_WRITE_H

#include "base/byte_buffer.h"
#include "volumes/voxel_volume.h"

/* Checks that the extension is .nrrd or .mha. 0, or -1 with the error filled. */
int host_volume_can_write(const char *path, host_error *error);

/* Writes the header of a volume with the grid of `grid`, of 1 or 3 channels, into the buffer. keys: more lines of a
 * NRRD header, each with its line break; "" for none. The voxels follow: x fastest, channels of a voxel together. */
void host_volume_write_header(const host_volume *grid, uint32_t type, uint32_t channels, const char *keys,
                              const char *path, host_buffer *out);

/* Writes the header of a NIfTI-1 file, of one channel; the voxels follow. 0, or -1 when an axis has more than 32767. */
int host_volume_write_nifti(const host_volume *grid, uint32_t type, host_buffer *out);

/* Writes n values of a type, host byte order, as little-endian. */
void host_volume_write_values(const void *values, uint32_t type, size_t n, host_buffer *out);

/* The centre of a voxel, also of one between voxels, mm. */
void host_volume_place(const host_volume *grid, const double index[3], double at[3]);

/* The matrix, row-major, from place - origin to index. */
void host_volume_to_index(const host_volume *grid, double out[9]);

/* A grid along the axes around a box, with a margin on all sides. 0, or -1 when it has too many voxels. */
int host_volume_around(const float low[3], const float high[3], float margin, const float spacing[3],
                       host_volume *grid);

#endif
