/* A volume from a file as the library sees it: a reference image or a target.
 * SPDX-License-Identifier: MIT */
#ifndef VOLUME_IMAGE_H
#define VOLUME_IMAGE_H

#include <stddef.h>

#include "base/mirror.h"
#include "volumes/voxel_volume.h"
#include "smr.h"

typedef struct host_image {
    host_volume volume; /* owned */
    smr_volume view;    /* borrows the voxels: both live equally long */
    size_t bytes;       /* of the voxels */
} host_image;

/* Reads a volume. mirror: HOST_MIRROR_..., of its geometry. 0, or -1 with the error filled and the image empty. */
int host_image_read(const char *path, int mirror, host_image *image, host_error *error);

/* An empty image is allowed. */
void host_image_free(host_image *image);

#endif
