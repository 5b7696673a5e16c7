/* volume_reader.h: shared by the readers of volume formats: the volume being read and the bytes of its voxels.
 * SPDX-License-Identifier: MIT */
#ifndef VOLUME_READER_H
#define VOLUME_READER_H

#include "files/file_read.h"
#include "volumes/voxel_volume.h"

/* Offsets in a NIfTI-1's header. */
enum {
    AT_DIM = 40,
    AT_TYPE = 70,
    AT_BITS = 72,
    AT_PIXDIM = 76,
    AT_VOXELS = 108,
    AT_SLOPE = 112,
    AT_INTER = 116,
    AT_UNITS = 123,
    AT_QFORM = 252,
    AT_SFORM = 254,
    AT_QUATERNION = 256,
    AT_QOFFSET = 268,
    AT_SROW = 280,
    AT_MAGIC = 344
};

enum { HOST_LAYERS_MAX = 1024 };
enum { HOST_ENCODING_RAW = 0, HOST_ENCODING_TEXT, HOST_ENCODING_DEFLATE };

/* A volume being read. A format's reader fills the layout, then calls the functions below in order. */
typedef struct host_volume_reader {
    host_volume *volume;
    host_error *error;
    const char *path;
    uint32_t line; /* current line of the header, for the error line; 0: the format has no lines */

    host_type type;
    int unsigned64; /* 1: type is HOST_TYPE_I64, but the file's numbers are unsigned */
    int big_endian;
    int encoding; /* HOST_ENCODING_... */
    int scaled;   /* 1: voxel = slope * number + inter, as float */
    double slope, inter;
    int64_t line_skip; /* lines to skip before the voxels, before unpacking */
    int64_t byte_skip; /* bytes to skip before the voxels, after unpacking; -1: the voxels are at the end of the file */
    uint32_t layers;   /* values of each voxel, one after the other; 0: one */
    host_buffer *keys; /* gets a NRRD's "key:=value" lines; NULL: an image is read, which has one layer */

    const unsigned char *data; /* [n] bytes with the voxels; borrowed, or detached.data */
    size_t n;
    host_bytes detached; /* the voxels' file, when separate; owned */
} host_volume_reader;

/* Fills the error of the current header line. Returns -1. */
int host_volume_fail(const host_volume_reader *reader, const char *expected, ...) HOST_PRINTF(2, 3);

/* Sets the volume's size; refuses counts below 1 and totals that no file can hold. */
int host_volume_set_size(host_volume_reader *reader, const char *place, const int64_t size[3]);

/* Sets the volume's geometry. steps[j]: vector from one voxel to the next along axis j, mm, LPS. */
int host_volume_set_geometry(host_volume_reader *to, const char *at, const double steps[3][3], const double origin[3]);

/* Converts RAS to LPS and back: negates the first two coordinates. */
void host_volume_turn_ras(double steps[3][3], double origin[3]);

/* Reads the separate file of the voxels; its path is relative to the header's. */
int host_volume_read_detached(host_volume_reader *reader, const char *key, host_word name);

/* Skips, unpacks and converts reader->data to volume->voxels. */
int host_volume_convert(host_volume_reader *reader);

/* The readers of the formats. data: the whole file, or the header when the voxels have a separate file. */
int host_read_metaimage(host_volume_reader *reader, const unsigned char *data, size_t n);
int host_read_nifti(host_volume_reader *reader, const unsigned char *data, size_t n);
int host_read_nrrd(host_volume_reader *reader, const unsigned char *data, size_t n);

/* Unpacks a zlib or gzip stream of exactly out_n bytes and checks its checksum. Returns NULL, or what was expected. */
const char *host_inflate(const unsigned char *data, size_t n, unsigned char *out, size_t out_n);

#endif
