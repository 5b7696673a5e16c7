/* scene_field.h: the displacement field of a scene, computed in little time.
 * SPDX-License-Identifier: MIT */
#ifndef SCENE_FIELD_H
#define SCENE_FIELD_H

#include "base/byte_buffer.h"
#include "carry/carry_result.h"

#define HOST_SCENE_VOXELS 500000u /* at most, 12 bytes each */

/* Writes the field from the patient's space to the model's around the result as NRRD into the buffer, which stores
 * failure: every 4 mm, or coarser where that gives too many voxels. It is computed at every second voxel along each
 * axis, halved between them, and fitted to the vertices as host_carried_field() does. Returns at how many of the voxels
 * that are computed the way back was not found, in *share their share; or -1 with the error filled. */
int64_t host_scene_field_write(host_carried *c, host_buffer *out, double *share, host_error *error);

#endif
