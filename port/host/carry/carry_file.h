/* carry_file.h: the file in a result's directory from which points, fields and volumes are carried: names, rest and
 * registered positions.
 *
 * carry.bin, little-endian: "SMRC", u32 version 1, u32 CRC-32 of all that follows, u32 vertices, u32 structures, u32
 * mirrored coordinate of the model (0 none, 1 x, 2 y, 3 z), two u32 0; for each structure char name[64] and u32
 * vertices; then f32 rest[vertices][3] and f32 now[vertices][3], mm.
 * SPDX-License-Identifier: MIT */
#ifndef CARRY_FILE_H
#define CARRY_FILE_H

#include "base/byte_buffer.h"
#include "base/mirror.h"
#include "smr.h"

#define HOST_CARRY_NAME "carry.bin"

typedef struct host_carry_shape {
    uint32_t n_vertices, n_structures;
    int mirror;                   /* HOST_MIRROR_...: the model's coordinate that register negated */
    char (*name)[SMR_NAME_BYTES]; /* [n_structures]; owned */
    uint32_t *count;              /* [n_structures] vertices; owned */
    float *rest, *now;            /* [n_vertices][3] mm, structures in a row; owned */
} host_carry_shape;

/* Writes the file's bytes into the buffer, which stores failure. */
void host_carry_write(const host_carry_shape *shape, host_buffer *out);

/* Reads DIRECTORY/carry.bin, which may come from anywhere. 0, or -1 with the error filled and the shape empty. The
 * error borrows *path, which the caller frees at the end. */
int host_carry_read(const char *directory, host_carry_shape *shape, char **path, host_error *error);

/* Takes the bytes of such a file; likewise. */
int host_carry_parse(const unsigned char *data, size_t size, host_carry_shape *shape, host_error *error);

void host_carry_free(host_carry_shape *shape);

#endif
