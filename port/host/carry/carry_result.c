/* carry_result.c: carry.bin, and a result that carries points by it.
 * SPDX-License-Identifier: MIT */
#include "carry/carry_result.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "files/file_names.h"
#include "files/file_read.h"
#include "files/gzip_write.h"

#define MAGIC 0x43524d53u /* "SMRC" */
#define VERSION 2u        /* the only other one, 1, has no errors */
#define HEADER_BYTES 32u
#define CHECKED_FROM 12u /* the first byte that the checksum is of */
#define RECORD_BYTES (SMR_NAME_BYTES + 4u)

static uint32_t u32_at(const unsigned char *p)
{
    return (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
}

static void put_u32(unsigned char *p, uint32_t value)
{
    for (uint32_t i = 0; i < 4u; i++)
        p[i] = (unsigned char)(value >> 8u * i);
}

void host_carry_write(const host_carry_shape *s, host_buffer *out)
{
    const uint32_t header[] = {MAGIC, VERSION, 0, s->n_vertices, s->n_structures, (uint32_t)(s->mirror + 1), 0, 0};
    const size_t from = out->size;
    for (size_t i = 0; i < sizeof header / sizeof header[0]; i++)
        host_buffer_u32(out, header[i]);
    for (size_t i = 0; i < s->n_structures; i++) {
        host_buffer_add(out, s->name[i], SMR_NAME_BYTES);
        host_buffer_u32(out, s->count[i]);
    }
    for (size_t i = 0; i < 3u * (size_t)s->n_vertices; i++)
        host_buffer_f32(out, s->rest[i]);
    for (size_t i = 0; i < 3u * (size_t)s->n_vertices; i++)
        host_buffer_f32(out, s->now[i]);
    for (size_t i = 0; i < 2u * (size_t)s->n_vertices; i++)
        host_buffer_f32(out, s->error[i]);
    if (!out->failed)
        put_u32(out->data + from + 8, host_crc32_of(out->data + from + CHECKED_FROM, out->size - from - CHECKED_FROM));
}

int host_carry_allocate(host_carry_shape *s)
{
    const size_t bytes = 3u * sizeof(float) * s->n_vertices;
    s->name = calloc(s->n_structures, sizeof *s->name);
    s->count = calloc(s->n_structures, sizeof *s->count);
    s->rest = malloc(bytes);
    s->now = malloc(bytes);
    s->error = malloc(bytes);
    for (size_t i = 0; s->error != NULL && i < 2u * (size_t)s->n_vertices; i++)
        s->error[i] = -1.0f;
    return s->name != NULL && s->count != NULL && s->rest != NULL && s->now != NULL && s->error != NULL ? 0 : -1;
}

/* What the counts say that the file has, or 0 for counts that no result has. */
static uint64_t bytes_of(uint32_t version, uint32_t n_vertices, uint32_t n_structures)
{
    if (n_vertices == 0u || n_vertices > SMR_VERTICES_MAX || n_structures == 0u || n_structures > SMR_STRUCTURES_MAX)
        return 0;
    return HEADER_BYTES + (uint64_t)RECORD_BYTES * n_structures + (16u + 8u * version) * (uint64_t)n_vertices;
}

static int take_names(host_carry_shape *shape, const unsigned char *at, host_error *error)
{
    uint64_t sum = 0;
    for (uint32_t i = 0; i < shape->n_structures; i++, at += RECORD_BYTES) {
        memcpy(shape->name[i], at, SMR_NAME_BYTES);
        shape->count[i] = u32_at(at + SMR_NAME_BYTES);
        sum += shape->count[i];
        if (at[SMR_NAME_BYTES - 1u] != '\0')
            return host_fail_at(error, "structure", i, "a name with a closing NUL");
    }
    return sum == shape->n_vertices ? 0 : host_fail(error, "structures", "as many vertices as the file has");
}

static int take_floats(const unsigned char *at, size_t n, float *to, host_error *error)
{
    for (size_t i = 0; i < n; i++, at += 4) {
        const uint32_t bits = u32_at(at);
        memcpy(&to[i], &bits, sizeof bits);
        if (!(to[i] >= -SMR_COORD_MAX && to[i] <= SMR_COORD_MAX)) /* written so that NaN fails */
            return host_fail_at(error, "vertex", i / 3u, "finite coordinates within +-%.0f mm", (double)SMR_COORD_MAX);
    }
    return 0;
}

static int parse(host_carry_shape *s, const unsigned char *at, size_t size, host_error *error)
{
    if (size < HEADER_BYTES || u32_at(at) != MAGIC)
        return host_fail(error, "content", "what smr register leaves in a result's directory as " HOST_CARRY_NAME);
    const uint32_t version = u32_at(at + 4);
    if (version != VERSION && version != 1u)
        return host_fail(error, "version", "%u, found %u: register again", VERSION, version);
    s->n_vertices = u32_at(at + 12);
    s->n_structures = u32_at(at + 16);
    if (bytes_of(version, s->n_vertices, s->n_structures) != size)
        return host_fail(error, "size", "the bytes that its counts say: it is cut off or damaged");
    if (u32_at(at + 8) != host_crc32_of(at + CHECKED_FROM, size - CHECKED_FROM))
        return host_fail(error, "checksum", "that of its bytes: it is damaged");
    if (u32_at(at + 20) > 3u || u32_at(at + 24) != 0u || u32_at(at + 28) != 0u)
        return host_fail(error, "header", "a coordinate 0 to 3 and zeros");
    s->mirror = (int)u32_at(at + 20) - 1;
    const size_t words = 3u * (size_t)s->n_vertices;
    if (host_carry_allocate(s) != 0)
        return host_fail(error, "start", "free memory");
    at += HEADER_BYTES;
    if (take_names(s, at, error) != 0)
        return -1;
    at += (size_t)RECORD_BYTES * s->n_structures;
    return take_floats(at, words, s->rest, error) != 0 || take_floats(at + 4u * words, words, s->now, error) != 0 ||
                   (version > 1u && take_floats(at + 8u * words, 2u * (size_t)s->n_vertices, s->error, error) != 0)
               ? -1
               : 0;
}

/* Takes the bytes of a carry.bin, which may come from anywhere. 0, or -1 with the error filled and the shape empty. */
static int parse_shape(const unsigned char *data, size_t size, host_carry_shape *shape, host_error *error)
{
    memset(shape, 0, sizeof *shape);
    int result = parse(shape, data, size, error);
    if (result != 0)
        host_carry_free(shape);
    return result;
}

static int accept_ours(const host_head *head, host_error *error)
{
    if (head->n < 4u || u32_at(head->data) != MAGIC)
        return host_fail(error, "content", "what smr register leaves in a result's directory as " HOST_CARRY_NAME);
    return 0;
}

/* Reads DIRECTORY/carry.bin; likewise. The error borrows *path, which the caller frees at the end. */
static int read_shape(const char *directory, host_carry_shape *shape, char **path, host_error *error)
{
    host_bytes bytes;
    memset(shape, 0, sizeof *shape);
    *path = host_path_in(directory, HOST_CARRY_NAME);
    if (*path == NULL)
        return host_fail_of(error, directory, "start", "free memory");
    error->file = *path;
    if (host_file_read(*path, accept_ours, &bytes, error) != 0)
        return -1;
    int result = parse_shape(bytes.data, bytes.size, shape, error);
    host_file_free(&bytes);
    return result;
}

void host_carry_free(host_carry_shape *shape)
{
    free(shape->name);
    free(shape->count);
    free(shape->rest);
    free(shape->now);
    free(shape->error);
    memset(shape, 0, sizeof *shape);
}

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
    if (host_port_open(&c->port, threads, error) != 0 || read_shape(directory, &c->shape, &c->path, error) != 0)
        return -1;
    return fit(c, error);
}

int host_carried_take(host_carried *c, const unsigned char *data, size_t size, uint32_t threads, host_error *error)
{
    memset(c, 0, sizeof *c);
    if (host_port_open(&c->port, threads, error) != 0 || parse_shape(data, size, &c->shape, error) != 0)
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
    for (uint32_t i = 0; i < n && c->shape.mirror != HOST_MIRROR_NONE; i++)
        xyz[3u * (size_t)i + (size_t)c->shape.mirror] = 0.0f - xyz[3u * (size_t)i + (size_t)c->shape.mirror];
}

int64_t host_carried_points(host_carried *c, uint32_t inverse, float *xyz, uint32_t n, unsigned char *missed,
                            host_error *error)
{
    smr_carry_fact *const facts = malloc((n + 1u) * sizeof *facts);
    int64_t bad = 0;
    if (facts == NULL)
        return host_fail(error, "carry", "free memory");
    if (!inverse)
        mirror(c, xyz, n);
    smr_status status = smr_carry_map(c->carry, c->shape.now, inverse, xyz, n, xyz, facts);
    if (inverse && status == SMR_OK)
        mirror(c, xyz, n);
    for (uint32_t i = 0; i < n && status == SMR_OK; i++) {
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

static double far2(const float *a, const float *b)
{
    const double x = (double)a[0] - (double)b[0], y = (double)a[1] - (double)b[1], z = (double)a[2] - (double)b[2];
    return x * x + y * y + z * z;
}

/* Weights fall with the fourth power of the distance, beyond the distance of the nearest vertex. */
void host_carried_error(const host_carried *c, uint32_t inverse, const float xyz[3], double error[2])
{
    float at[3] = {xyz[0], xyz[1], xyz[2]};
    const float *const from = inverse ? c->shape.now : c->shape.rest;
    double near2 = HUGE_VAL, sum[2] = {0.0, 0.0}, all = 0.0;
    if (!inverse)
        mirror(c, at, 1);
    for (uint32_t i = 0; i < c->shape.n_vertices; i++)
        near2 = fmin(near2, far2(at, from + 3u * (size_t)i));
    for (uint32_t i = 0; i < c->shape.n_vertices; i++) {
        const float *const mm = c->shape.error + 2u * (size_t)i;
        const double d2 = far2(at, from + 3u * (size_t)i) + near2 + 1.0e-6, weight = 1.0 / (d2 * d2);
        for (uint32_t k = 0; k < 2u && mm[0] >= 0.0f; k++)
            sum[k] += weight * (double)mm[k] * (double)mm[k];
        all += mm[0] >= 0.0f ? weight : 0.0;
    }
    for (uint32_t k = 0; k < 2u; k++)
        error[k] = all > 0.0 ? sqrt(sum[k] / all) : -1.0;
}

/* Columns of each matrix by the pose. */
static void turn(const smr_pose *poses, uint32_t n, float *orientation)
{
    for (uint32_t i = 0; i < n; i++, orientation += 9)
        for (uint32_t k = 0; k < 3; k++) {
            const float x = orientation[k], y = orientation[3u + k], z = orientation[6u + k];
            for (uint32_t r = 0; r < 3; r++)
                orientation[3u * r + k] = poses[i].m[r][0] * x + poses[i].m[r][1] * y + poses[i].m[r][2] * z;
        }
}

int host_carried_frames(host_carried *c, uint32_t inverse, const float *xyz, uint32_t n, float *axes, host_error *error)
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
        turn(poses, n, axes);
    free(from);
    free(to);
    free(poses);
    return result;
}

void host_carried_box(const host_carried *c, uint32_t inverse, float low[3], float high[3])
{
    const float *const xyz = inverse ? c->shape.now : c->shape.rest;
    for (size_t i = 0; i < 3u * (size_t)c->shape.n_vertices; i++) {
        const size_t k = i % 3u;
        const float v = !inverse && (int)k == c->shape.mirror ? 0.0f - xyz[i] : xyz[i];
        low[k] = i < 3u || v < low[k] ? v : low[k];
        high[k] = i < 3u || v > high[k] ? v : high[k];
    }
}
