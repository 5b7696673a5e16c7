/* carry_file.c: writes and reads carry.bin.
 * SPDX-License-Identifier: MIT */
#include "carry/carry_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/crc32.h"
#include "files/file_read.h"

#define MAGIC 0x43524d53u /* "SMRC" */
#define VERSION 1u
#define HEADER_BYTES 32u
#define CHECKED_FROM 12u /* the first byte that the checksum is of */
#define RECORD_BYTES (SMR_NAME_BYTES + 4u)

static uint32_t checksum(const unsigned char *data, size_t n)
{
    host_crc32 crc;
    host_crc32_start(&crc);
    host_crc32_add(&crc, data, n);
    return host_crc32_end(&crc);
}

static uint32_t u32_at(const unsigned char *p)
{
    return (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
}

static void put_u32(unsigned char *p, uint32_t value)
{
    uint32_t i = 0;
    for (i = 0; i < 4u; i++)
        p[i] = (unsigned char)(value >> 8u * i);
}

void host_carry_write(const host_carry_shape *shape, host_buffer *out)
{
    const uint32_t header[] = {MAGIC, VERSION, 0, shape->n_vertices, shape->n_structures, (uint32_t)(shape->mirror + 1),
                               0,     0};
    const size_t start = out->size;
    size_t i = 0;
    for (i = 0; i < sizeof header / sizeof header[0]; i++)
        host_buffer_u32(out, header[i]);
    for (i = 0; i < shape->n_structures; i++) {
        host_buffer_add(out, shape->name[i], SMR_NAME_BYTES);
        host_buffer_u32(out, shape->count[i]);
    }
    for (i = 0; i < 3u * (size_t)shape->n_vertices; i++)
        host_buffer_f32(out, shape->rest[i]);
    for (i = 0; i < 3u * (size_t)shape->n_vertices; i++)
        host_buffer_f32(out, shape->now[i]);
    if (!out->failed)
        put_u32(out->data + start + 8, checksum(out->data + start + CHECKED_FROM, out->size - start - CHECKED_FROM));
}

/* What the counts say that the file has, or 0 for counts that no result has. */
static uint64_t bytes_of(uint32_t n_vertices, uint32_t n_structures)
{
    if (n_vertices == 0u || n_vertices > SMR_VERTICES_MAX || n_structures == 0u || n_structures > SMR_STRUCTURES_MAX)
        return 0;
    return HEADER_BYTES + (uint64_t)RECORD_BYTES * n_structures + 24u * (uint64_t)n_vertices;
}

static int take_names(host_carry_shape *shape, const unsigned char *at, host_error *error)
{
    uint64_t sum = 0;
    uint32_t i = 0;
    for (i = 0; i < shape->n_structures; i++, at += RECORD_BYTES) {
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
    size_t i = 0;
    for (i = 0; i < n; i++, at += 4) {
        const uint32_t bits = u32_at(at);
        memcpy(&to[i], &bits, sizeof bits);
        if (!(to[i] >= -SMR_COORD_MAX && to[i] <= SMR_COORD_MAX)) /* written so that NaN fails */
            return host_fail_at(error, "vertex", i / 3u, "finite coordinates within +-%.0f mm", (double)SMR_COORD_MAX);
    }
    return 0;
}

static int parse(host_carry_shape *shape, const unsigned char *data, size_t size, host_error *error)
{
    const size_t names = HEADER_BYTES;
    size_t words = 0;
    if (size < HEADER_BYTES || u32_at(data) != MAGIC)
        return host_fail(error, "content", "what smr register leaves in a result's directory as " HOST_CARRY_NAME);
    if (u32_at(data + 4) != VERSION)
        return host_fail(error, "version", "%u, found %u: register again", VERSION, u32_at(data + 4));
    shape->n_vertices = u32_at(data + 12);
    shape->n_structures = u32_at(data + 16);
    if (bytes_of(shape->n_vertices, shape->n_structures) != size)
        return host_fail(error, "size", "the bytes that its counts say: it is cut off or damaged");
    if (u32_at(data + 8) != checksum(data + CHECKED_FROM, size - CHECKED_FROM))
        return host_fail(error, "checksum", "that of its bytes: it is damaged");
    if (u32_at(data + 20) > 3u || u32_at(data + 24) != 0u || u32_at(data + 28) != 0u)
        return host_fail(error, "header", "a coordinate 0 to 3 and zeros");
    shape->mirror = (int)u32_at(data + 20) - 1;
    words = 3u * (size_t)shape->n_vertices;
    shape->name = calloc(shape->n_structures, sizeof *shape->name);
    shape->count = calloc(shape->n_structures, sizeof *shape->count);
    shape->rest = malloc(words * sizeof(float));
    shape->now = malloc(words * sizeof(float));
    if (shape->name == NULL || shape->count == NULL || shape->rest == NULL || shape->now == NULL)
        return host_fail(error, "start", "free memory");
    data += names;
    if (take_names(shape, data, error) != 0)
        return -1;
    data += (size_t)RECORD_BYTES * shape->n_structures;
    return take_floats(data, words, shape->rest, error) != 0 ||
                   take_floats(data + 4u * words, words, shape->now, error) != 0
               ? -1
               : 0;
}

int host_carry_parse(const unsigned char *data, size_t size, host_carry_shape *shape, host_error *error)
{
    int result = 0;
    memset(shape, 0, sizeof *shape);
    result = parse(shape, data, size, error);
    if (result != 0)
        host_carry_free(shape);
    return result;
}

static int accept_ours(const char *path, const unsigned char *head, size_t n, size_t total, host_error *error)
{
    (void)path;
    (void)total;
    if (n < 4u || u32_at(head) != MAGIC)
        return host_fail(error, "content", "what smr register leaves in a result's directory as " HOST_CARRY_NAME);
    return 0;
}

int host_carry_read(const char *directory, host_carry_shape *shape, char **path, host_error *error)
{
    const size_t n = strlen(directory) + sizeof "/" HOST_CARRY_NAME;
    host_bytes bytes;
    int result = 0;
    memset(shape, 0, sizeof *shape);
    *path = malloc(n);
    error->file = directory;
    if (*path == NULL)
        return host_fail(error, "start", "free memory");
    (void)snprintf(*path, n, "%s/%s", directory, HOST_CARRY_NAME);
    error->file = *path;
    if (host_file_read(*path, accept_ours, &bytes, error) != 0)
        return -1;
    result = host_carry_parse(bytes.data, bytes.size, shape, error);
    host_file_free(&bytes);
    return result;
}

void host_carry_free(host_carry_shape *shape)
{
    free(shape->name);
    free(shape->count);
    free(shape->rest);
    free(shape->now);
    memset(shape, 0, sizeof *shape);
}
