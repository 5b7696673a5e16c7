/* voxel_volume.h: image volumes: in memory and from files.
 *
 * In memory, coordinates are millimetres in LPS. The centre of the voxel with index (i, j, k) is
 * origin + direction (spacing * (i, j, k)).
 * SPDX-License-Identifier: MIT */
#ifndef VOXEL_VOLUME_H
#define VOXEL_VOLUME_H

#include <stddef.h>
#include <stdint.h>

#include "base/byte_buffer.h"
#include "base/text_scan.h"
#include "smr.h"

enum { HOST_UINT8 = 0, HOST_INT8, HOST_UINT16, HOST_INT16, HOST_FLOAT32 };

typedef struct host_volume {
    void *voxels;       /* [size[2]][size[1]][size[0]], host byte order, on a 64-byte address; owned */
    uint32_t type;      /* HOST_UINT8 ... HOST_FLOAT32; wider types become float; NaN and infinity are kept */
    uint32_t size[3];   /* voxels along each axis, 1 or more */
    float origin[3];    /* mm, centre of the first voxel */
    float spacing[3];   /* mm, positive */
    float direction[9]; /* row-major; column j: unit direction of axis j; may be left-handed */
} host_volume;

/* Reads MetaImage, NIfTI-1 or NRRD, also gzipped; the content decides the format, then the extension.
 * Returns 0, or -1 with the error filled and the volume empty. */
int host_volume_read(const char *path, host_volume *volume, host_error *error);

/* The same without the voxels: the grid of a volume. */
int host_volume_read_grid(const char *path, host_volume *grid, host_error *error);

/* The same for label maps: a NRRD may have several layers, whose values are next to each other for each voxel, and
 * lines "key:=value", which are added to keys. layers: 1 or more. */
int host_volume_read_layers(const char *path, host_volume *volume, uint32_t *layers, host_buffer *keys,
                            host_error *error);

void host_volume_free(host_volume *volume);

/* Negates one world coordinate (0..2) of the geometry. The voxels' order in memory stays. */
void host_volume_mirror(host_volume *volume, int axis);

/* 1 when the extension is one of a volume, or .dcm, for which the reader's error says what to do. */
int host_is_volume_path(const char *path);

/* Bytes of one voxel. */
uint32_t host_volume_voxel_bytes(uint32_t type);

/* Voxel i as a number. type: HOST_UINT8 ...; SMR_VOXEL_UINT8 ... are the same numbers (volume_image.c). */
static inline double host_voxel(const void *voxels, uint32_t type, size_t i)
{
    switch (type) {
    case HOST_UINT8: return (double)((const uint8_t *)voxels)[i];
    case HOST_INT8: return (double)((const int8_t *)voxels)[i];
    case HOST_UINT16: return (double)((const uint16_t *)voxels)[i];
    case HOST_INT16: return (double)((const int16_t *)voxels)[i];
    default: return (double)((const float *)voxels)[i];
    }
}

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
