/* voxel_volume.h: image volumes: in memory, from files, and written as uncompressed NRRD or MetaImage.
 *
 * In memory, coordinates are millimetres in LPS. The centre of the voxel with index (i, j, k) is
 * origin + direction (spacing * (i, j, k)).
 * SPDX-License-Identifier: MIT */
#ifndef VOXEL_VOLUME_H
#define VOXEL_VOLUME_H

#include "base/byte_buffer.h"
#include "base/text_scan.h"
#include "smr.h"

typedef struct host_volume {
    void *voxels;       /* [size[2]][size[1]][size[0]], host byte order, on a 64-byte address; owned */
    uint32_t type;      /* SMR_VOXEL_...; wider types become float; NaN and infinity are kept */
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
int host_volume_read_layers(const char *path, host_volume *to, uint32_t *layers, host_buffer *keys, host_error *error);

void host_volume_free(host_volume *volume);

/* The determinant of a matrix: negative where the matrix mirrors. */
double host_determinant(const double m[3][3]);

/* Negates one world coordinate (0..2) of the geometry. The voxels' order in memory stays. */
void host_volume_mirror(host_volume *volume, int axis);

/* 1 when the extension is one of a volume, or .dcm, for which the reader's error says what to do. */
int host_is_volume_path(const char *path);

/* Bytes of one voxel. */
uint32_t host_volume_voxel_bytes(uint32_t type);

/* Voxel i as a number. type: SMR_VOXEL_... */
static inline double host_voxel(const void *voxels, uint32_t type, size_t i)
{
    switch (type) {
    case SMR_VOXEL_UINT8: return (double)((const uint8_t *)voxels)[i];
    case SMR_VOXEL_INT8: return (double)((const int8_t *)voxels)[i];
    case SMR_VOXEL_UINT16: return (double)((const uint16_t *)voxels)[i];
    case SMR_VOXEL_INT16: return (double)((const int16_t *)voxels)[i];
    default: return (double)((const float *)voxels)[i];
    }
}

/* The volume as the library's type; borrows the voxels. */
smr_volume host_volume_view(const host_volume *volume);

typedef struct host_image {
    host_volume volume; /* owned */
    smr_volume view;    /* borrows the voxels of `volume` */
    size_t bytes;       /* bytes of the voxels */
} host_image;

/* Reads an image. mirror: HOST_MIRROR_..., of its geometry. 0, or -1 with the error filled and the image empty. */
int host_image_read(const char *path, int mirror, host_image *image, host_error *error);

/* Frees the image, which may be empty. */
void host_image_free(host_image *image);

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
