/* What the readers of the single volume formats share: the volume under construction and its voxel bytes.
 * SPDX-License-Identifier: MIT */
#ifndef VOLUME_READER_H
#define VOLUME_READER_H

#include <stddef.h>
#include <stdint.h>

#include "base/number_types.h"
#include "base/text_scan.h"
#include "files/file_read.h"
#include "volumes/voxel_volume.h"

enum { HOST_ENCODING_RAW = 0, HOST_ENCODING_TEXT, HOST_ENCODING_DEFLATE };

/* A volume being read. A format's reader fills the layout, then calls the functions below in their order. */
typedef struct host_volume_reader {
    host_volume *volume;
    host_error *error;
    const char *path;
    uint32_t line; /* of the header, for the error line; 0: the format has no lines */

    host_type type;
    int unsigned64; /* 1: type is HOST_TYPE_I64, the file's numbers are unsigned */
    int big_endian;
    int encoding; /* HOST_ENCODING_... */
    int scaled;   /* 1: a voxel is slope * number + inter, as float */
    double slope, inter;
    int64_t line_skip; /* lines before the voxels, counted before unpacking */
    int64_t byte_skip; /* bytes before the voxels, counted after unpacking; -1: the voxels end the file */

    const unsigned char *data; /* [n] what holds the voxels; borrowed, or detached.data */
    size_t n;
    host_bytes detached; /* the voxels' own file; owned */
} host_volume_reader;

/* A header error at the present line. */
int host_volume_fail(const host_volume_reader *reader, const char *expected, ...) HOST_PRINTF(2, 3);

/* Takes over three counts of voxels; refuses those below 1 and claims that no file can hold. */
int host_volume_size(host_volume_reader *reader, const char *place, const int64_t size[3]);

/* Takes over where the voxels are. steps[j]: mm in world LPS from one voxel to the next along axis j. */
int host_volume_place(host_volume_reader *reader, const char *place, const double steps[3][3], const double origin[3]);

/* Negates the world's first two coordinates: RAS to LPS and back. */
void host_volume_turn(double steps[3][3], double origin[3]);

/* The voxels lie in a file of their own, named relative to the header's; reads it. */
int host_volume_detach(host_volume_reader *reader, const char *key, host_word name);

/* Skips, unpacks and converts reader->data into volume->voxels. */
int host_volume_load(host_volume_reader *reader);

/* The readers. data holds the whole file, or the header when the voxels have their own. */
int host_read_metaimage(host_volume_reader *reader, const unsigned char *data, size_t n);
int host_read_nifti(host_volume_reader *reader, const unsigned char *data, size_t n);
int host_read_nrrd(host_volume_reader *reader, const unsigned char *data, size_t n);

/* Unpacks one zlib or gzip stream that must give exactly out_n bytes; checks its sum. NULL, or what was
 * expected instead. */
const char *host_inflate(const unsigned char *data, size_t n, unsigned char *out, size_t out_n);

#endif
