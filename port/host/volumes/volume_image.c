/* volume_image.c: reads an image from a volume file, as the library's type.
 * SPDX-License-Identifier: MIT */
#include "volumes/volume_image.h"

#include <string.h>

_Static_assert((int)HOST_UINT8 == (int)SMR_VOXEL_UINT8 && (int)HOST_INT8 == (int)SMR_VOXEL_INT8 &&
                   (int)HOST_UINT16 == (int)SMR_VOXEL_UINT16 && (int)HOST_INT16 == (int)SMR_VOXEL_INT16 &&
                   (int)HOST_FLOAT32 == (int)SMR_VOXEL_FLOAT,
               "voxel types have the same numbers on both sides");

int host_image_read(const char *path, int mirror, host_image *image, host_error *error)
{
    host_volume *const volume = &image->volume;
    smr_volume *const view = &image->view;
    memset(image, 0, sizeof *image);
    error->file = path;
    if (host_volume_read(path, volume, error) != 0)
        return -1;
    if (mirror != HOST_MIRROR_NONE)
        host_volume_mirror(volume, mirror);
    view->voxels = volume->voxels;
    view->type = volume->type;
    memcpy(view->size, volume->size, sizeof view->size);
    memcpy(view->origin, volume->origin, sizeof view->origin);
    memcpy(view->spacing, volume->spacing, sizeof view->spacing);
    memcpy(view->direction, volume->direction, sizeof view->direction);
    image->bytes = (size_t)view->size[0] * view->size[1] * view->size[2] * host_volume_voxel_bytes(view->type);
    return 0;
}

void host_image_free(host_image *image)
{
    host_volume_free(&image->volume);
    memset(image, 0, sizeof *image);
}
