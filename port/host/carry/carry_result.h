/* carry_result.h: the map of space of a registration's result, for commands that carry something by it.
 * SPDX-License-Identifier: MIT */
#ifndef CARRY_RESULT_H
#define CARRY_RESULT_H

#include "base/threads.h"
#include "carry/carry_file.h"

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

#define HOST_FRAME_MM 5.0f /* over which a frame's turn is measured */

/* Turns the orientations [n][9] of frames at xyz [n][3] mm as the map turns space there; rows of matrices whose columns
 * are axes. xyz is where host_carried_points() takes them from. 0, or -1 with the error filled. */
int host_carried_frames(host_carried *c, uint32_t inverse, const float *xyz, uint32_t n, float *orientation,
                        host_error *error);

/* The box around the model, before (inverse 0) or after. */
void host_carried_box(const host_carried *c, uint32_t inverse, float low[3], float high[3]);

#endif
