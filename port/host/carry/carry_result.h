/* carry_result.h: carry.bin, by which points, fields and volumes are carried, and a result that carries them.
 *
 * carry.bin, little-endian: "SMRC", u32 version 2, u32 CRC-32 of all that follows, u32 vertices, u32 structures, u32
 * mirrored coordinate of the model (0 none, 1 x, 2 y, 3 z), two u32 0; for each structure char name[64] and u32
 * vertices; then f32 rest[vertices][3], f32 now[vertices][3] and f32 error[vertices][2], mm. Version 1 has no error.
 * SPDX-License-Identifier: MIT */
#ifndef CARRY_RESULT_H
#define CARRY_RESULT_H

#include "base/byte_buffer.h"
#include "base/text_scan.h"
#include "base/system.h"
#include "smr.h"

#define HOST_CARRY_NAME "carry.bin"

typedef struct host_carry_shape {
    uint32_t n_vertices, n_structures;
    int mirror;                   /* HOST_MIRROR_...: the model's coordinate that register negated */
    char (*name)[SMR_NAME_BYTES]; /* [n_structures]; owned */
    uint32_t *count;              /* [n_structures] vertices; owned */
    float *rest, *now;            /* [n_vertices][3] mm, structures in a row; owned */
    float *error;                 /* [n_vertices][2] mm, expected across the surface and along it, -1: unknown; owned */
} host_carry_shape;

/* Room for as many structures and vertices as the shape says. 0, or -1 when out of memory. */
int host_carry_allocate(host_carry_shape *shape);

/* Writes the file's bytes into the buffer, which stores failure. */
void host_carry_write(const host_carry_shape *shape, host_buffer *out);

void host_carry_free(host_carry_shape *shape);

#define HOST_CARRY_MISS 0.01f /* mm: a place that is not found nearer than this was not found */

typedef struct host_carried {
    host_port port;
    host_carry_shape shape;
    char *path;       /* of carry.bin; owned */
    void *memory;     /* of the map; owned */
    smr_carry *carry; /* lies in memory */
} host_carried;

/* Opens the result. 0, or -1 with the error filled. Call host_carried_close() in both cases. */
int host_carried_open(host_carried *c, const char *directory, uint32_t threads, host_error *error);

/* Likewise, of the bytes of carry.bin, which are not kept. */
int host_carried_take(host_carried *c, const unsigned char *data, size_t size, uint32_t threads, host_error *error);

void host_carried_close(host_carried *c);

/* Carries n points xyz [n][3] mm in place: inverse 0 from the model's space to the result's, 1 back. The model's space
 * is that of its files, before register mirrored them. missed (may be NULL): [n], 1 where the way back was not found.
 * Returns how many were not, or -1 with the error filled. */
int64_t host_carried_points(host_carried *c, uint32_t inverse, float *xyz, uint32_t n, unsigned char *missed,
                            host_error *error);

/* The expected error at a point of the model's space, or of the result's (inverse 1), mm: across the surface and along
 * it; the mean of squares over near vertices. -1: unknown. */
void host_carried_error(const host_carried *c, uint32_t inverse, const float xyz[3], double error[2]);

#define HOST_FRAME_MM 5.0f /* over which a frame's turn is measured */

/* Turns the orientations [n][9] of frames at xyz [n][3] mm as the map turns space there; rows of matrices whose columns
 * are axes. xyz is where host_carried_points() takes them from. 0, or -1 with the error filled. */
int host_carried_frames(host_carried *c, uint32_t inverse, const float *xyz, uint32_t n, float *axes,
                        host_error *error);

/* The box around the model, before (inverse 0) or after. */
void host_carried_box(const host_carried *c, uint32_t inverse, float low[3], float high[3]);

#endif
