/* volume_image.h: an image from a volume file as the library's type: the reference or the target.
 * SPDX-License-Identifier: MIT */
#ifndef VOLUME_IMAGE_H
#define VOLUME_IMAGE_H

#include <stddef.h>

#include "base/mirror.h"
#include "volumes/voxel_volume.h"
#include "smr.h"

typedef struct host_image {
    host_volume volume; /* owned */
    smr_volume view;    /* borrows the voxels of `volume` */
    size_t bytes;       /* bytes of the voxels */
} host_image;

/* Reads an image. mirror: HOST_MIRROR_..., applied to its geometry. 0, or -1 with the error filled and the image
 * empty. */
int host_image_read(const char *path, int mirror, host_image *image, host_error *error);

/* Frees the image, which may be empty. */
void host_image_free(host_image *image);

#endif
