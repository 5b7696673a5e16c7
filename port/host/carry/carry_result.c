/* carry_result.c: opens the map of a result, and carries points by it.
 * SPDX-License-Identifier: MIT */
#include "carry/carry_result.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

static int fit(host_carried *c, host_error *error)
{
    size_t bytes = 0;
    if (smr_carry_bytes(c->shape.n_vertices, 0, c->port.port.n_workers, &bytes) == SMR_OK)
        c->memory = host_alloc(bytes);
    if (c->memory == NULL || smr_carry_fit(c->shape.rest, c->shape.n_vertices, NULL, 0, &c->port.port, c->memory, bytes,
                                           &c->carry) != SMR_OK)
        return host_fail(error, "start", "free memory");
    return 0;
}

int host_carried_open(host_carried *c, const char *directory, uint32_t threads, host_error *error)
{
    memset(c, 0, sizeof *c);
    if (host_port_open(&c->port, threads, error) != 0 || host_carry_read(directory, &c->shape, &c->path, error) != 0)
        return -1;
    return fit(c, error);
}

int host_carried_take(host_carried *c, const unsigned char *data, size_t size, uint32_t threads, host_error *error)
{
    memset(c, 0, sizeof *c);
    if (host_port_open(&c->port, threads, error) != 0 || host_carry_parse(data, size, &c->shape, error) != 0)
        return -1;
    return fit(c, error);
}

void host_carried_close(host_carried *c)
{
    host_carry_free(&c->shape);
    free(c->path);
    free(c->memory);
    host_port_close(&c->port);
}

static void mirror(const host_carried *c, float *xyz, uint32_t n)
{
    uint32_t i = 0;
    for (i = 0; i < n && c->shape.mirror != HOST_MIRROR_NONE; i++)
        xyz[3u * (size_t)i + (size_t)c->shape.mirror] = 0.0f - xyz[3u * (size_t)i + (size_t)c->shape.mirror];
}

int64_t host_carried_points(host_carried *c, uint32_t inverse, float *xyz, uint32_t n, unsigned char *missed,
                            host_error *error)
{
    smr_carry_fact *const facts = malloc((n + 1u) * sizeof *facts);
    smr_status status = SMR_OK;
    int64_t bad = 0;
    uint32_t i = 0;
    if (facts == NULL)
        return host_fail(error, "carry", "free memory");
    if (!inverse)
        mirror(c, xyz, n);
    status = smr_carry_map(c->carry, c->shape.now, inverse, xyz, n, xyz, facts);
    if (inverse && status == SMR_OK)
        mirror(c, xyz, n);
    for (i = 0; i < n && status == SMR_OK; i++) {
        const int lost = !(facts[i].miss_mm <= HOST_CARRY_MISS);
        bad += lost;
        if (missed != NULL)
            missed[i] = (unsigned char)lost;
    }
    free(facts);
    return status == SMR_OK ? bad
                            : host_fail(error, "carry", "points within +-%.0f mm (%s)", (double)SMR_COORD_MAX,
                                        smr_status_name(status));
}

/* Columns of each matrix by the pose. */
static void turn(const smr_pose *poses, uint32_t n, float *orientation)
{
    uint32_t i = 0, k = 0, r = 0;
    for (i = 0; i < n; i++, orientation += 9)
        for (k = 0; k < 3; k++) {
            const float x = orientation[k], y = orientation[3u + k], z = orientation[6u + k];
            for (r = 0; r < 3; r++)
                orientation[3u * r + k] = poses[i].m[r][0] * x + poses[i].m[r][1] * y + poses[i].m[r][2] * z;
        }
}

int host_carried_frames(host_carried *c, uint32_t inverse, const float *xyz, uint32_t n, float *orientation,
                        host_error *error)
{
    const size_t places = (size_t)SMR_FRAME_PLACES * n;
    float *const from = malloc(places * 3u * sizeof *from + 1u), *const to = malloc(places * 3u * sizeof *to + 1u);
    smr_pose *const poses = malloc((n + 1u) * sizeof *poses);
    int result = -1;
    if (from == NULL || to == NULL || poses == NULL || places > SMR_VERTICES_MAX)
        (void)host_fail(error, "carry", "at most %u points with orientations, and free memory",
                        SMR_VERTICES_MAX / SMR_FRAME_PLACES);
    else if (smr_frame_places(xyz, n, HOST_FRAME_MM, from) != SMR_OK)
        (void)host_fail(error, "carry", "points within +-%.0f mm", (double)SMR_COORD_MAX);
    else {
        memcpy(to, from, places * 3u * sizeof *to);
        if (host_carried_points(c, inverse, to, (uint32_t)places, NULL, error) >= 0)
            result = smr_frame_poses(from, to, n, poses, NULL) == SMR_OK
                         ? 0
                         : host_fail(error, "carry", "frames that stay frames");
    }
    if (result == 0)
        turn(poses, n, orientation);
    free(from);
    free(to);
    free(poses);
    return result;
}

void host_carried_box(const host_carried *c, uint32_t inverse, float low[3], float high[3])
{
    const float *const xyz = inverse ? c->shape.now : c->shape.rest;
    size_t i = 0;
    for (i = 0; i < 3u * (size_t)c->shape.n_vertices; i++) {
        const size_t k = i % 3u;
        const float v = !inverse && (int)k == c->shape.mirror ? 0.0f - xyz[i] : xyz[i];
        low[k] = i < 3u || v < low[k] ? v : low[k];
        high[k] = i < 3u || v > high[k] ? v : high[k];
    }
}
