/* carry_volume.h: an image of the model deformed as the model was.
 * SPDX-License-Identifier: MIT */
#ifndef CARRY_VOLUME_H
#define CARRY_VOLUME_H

#include "carry/carry_result.h"
#include "volumes/voxel_volume.h"

/* Fills out->voxels, of the type of `image`, on the grid that out has: each voxel shows the place of the image that the
 * registration carried there, interpolated linearly; 0 outside the image. The way back is computed on a lattice of about
 * LATTICE_MM and interpolated. Returns how many points of the lattice were not found, or -1 with the error filled. */
int64_t host_carried_volume(host_carried *c, const host_volume *image, host_volume *out, host_error *error);

#endif
