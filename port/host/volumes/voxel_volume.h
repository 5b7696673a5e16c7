/* Image volumes of the host program: reading from files, mirroring.
 *
 * Inside, coordinates are LPS millimetres. The voxel at index (i, j, k) has its centre at
 * origin + direction (spacing * (i, j, k)).
 * SPDX-License-Identifier: MIT */
#ifndef VOXEL_VOLUME_H
#define VOXEL_VOLUME_H

#include <stdint.h>

#include "base/error_line.h"

enum { HOST_UINT8 = 0, HOST_INT8, HOST_UINT16, HOST_INT16, HOST_FLOAT32 };

typedef struct host_volume {
    void *voxels;       /* [size[2]][size[1]][size[0]], host byte order, on a 64-byte address; owned */
    uint32_t type;      /* HOST_UINT8 ... HOST_FLOAT32; wider files become float, NaN and infinity are kept */
    uint32_t size[3];   /* voxels along each axis, 1 or more */
    float origin[3];    /* mm, centre of the first voxel */
    float spacing[3];   /* mm, positive */
    float direction[9]; /* row-major, unit columns: column j is the direction of axis j; may be left-handed */
} host_volume;

/* Reads MetaImage, NIfTI-1 or NRRD, told apart by content, then by extension; packed ones too.
 * Returns 0, or -1 with the error filled and the volume empty. */
int host_volume_read(const char *path, host_volume *volume, host_error *error);

void host_volume_free(host_volume *volume);

/* Negates one world coordinate (0..2). The voxels stay where they are in memory. */
void host_volume_mirror(host_volume *volume, int axis);

/* Whether the path ends like a volume's file; .dcm too, so that its reader can say what to do. */
int host_is_volume_path(const char *path);

/* Bytes of one voxel. */
uint32_t host_volume_voxel_bytes(uint32_t type);

#endif
