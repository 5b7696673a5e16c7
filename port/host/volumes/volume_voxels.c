/* volume_voxels.c: converts the bytes of a file to voxels. Memory is bounded by the file's size, not by its header.
 * SPDX-License-Identifier: MIT */
#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "base/system.h"
#include "volumes/volume_reader.h"

/* The best compression by deflate: the longest copy takes at least two bits. */
#define PACKED_BEST 1032u

/* Values, of all layers. */
static size_t voxel_count(const host_volume_reader *reader)
{
    const host_volume *const volume = reader->volume;
    return (size_t)volume->size[0] * volume->size[1] * volume->size[2] * (reader->layers > 0u ? reader->layers : 1u);
}

/* The type in memory of a file's type. */
static uint32_t kept_type(const host_volume_reader *reader)
{
    if (!reader->scaled)
        switch (reader->type) {
        case HOST_TYPE_U8: return SMR_VOXEL_UINT8;
        case HOST_TYPE_I8: return SMR_VOXEL_INT8;
        case HOST_TYPE_U16: return SMR_VOXEL_UINT16;
        case HOST_TYPE_I16: return SMR_VOXEL_INT16;
        case HOST_TYPE_I32:
        case HOST_TYPE_U32:
        case HOST_TYPE_I64:
        case HOST_TYPE_F32:
        case HOST_TYPE_F64:
        case HOST_TYPE_NONE:
        default: break;
        }
    return SMR_VOXEL_FLOAT;
}

static float to_float(double value)
{
    if (value > (double)FLT_MAX)
        return HUGE_VALF;
    return value < -(double)FLT_MAX ? -HUGE_VALF : (float)value;
}

static int host_is_big_endian(void)
{
    const uint16_t one = 1;
    unsigned char first = 0;
    memcpy(&first, &one, 1);
    return first == 0;
}

/* 1 when numbers are equal in memory and file but for the byte order. */
static void copy_voxels(const host_volume_reader *reader, const unsigned char *from, size_t n, size_t bytes)
{
    unsigned char *const to = reader->volume->voxels;
    if (bytes == 1u || reader->big_endian == host_is_big_endian()) {
        memcpy(to, from, n * bytes);
        return;
    }
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < bytes; k++)
            to[i * bytes + k] = from[i * bytes + bytes - 1u - k];
}

static void convert_voxels(const host_volume_reader *reader, const unsigned char *from, size_t n, size_t bytes)
{
    float *const to = reader->volume->voxels;
    for (size_t i = 0; i < n; i++) {
        double value = host_type_read(reader->type, from + i * bytes, reader->big_endian);
        if (reader->unsigned64 && value < 0.0)
            value += 18446744073709551616.0;
        if (reader->scaled)
            value = reader->slope * value + reader->inter;
        to[i] = to_float(value);
    }
}

static int allocate(const host_volume_reader *reader, size_t n)
{
    const size_t bytes = n * host_volume_voxel_bytes(reader->volume->type);
    reader->volume->voxels = host_alloc_scattered(bytes);
    if (reader->volume->voxels == NULL)
        return host_fail(reader->error, "voxels", "%zu bytes of free memory", bytes);
    return 0;
}

static int load_raw(const host_volume_reader *reader, const unsigned char *data, size_t size)
{
    const size_t n = voxel_count(reader), bytes = host_type_bytes(reader->type);
    if (n * bytes > size)
        return host_fail(reader->error, "voxels",
                         "%zu bytes for %" PRIu32 " x %" PRIu32 " x %" PRIu32 " of them, found %zu", n * bytes,
                         reader->volume->size[0], reader->volume->size[1], reader->volume->size[2], size);
    size_t skip = reader->byte_skip < 0 ? size - n * bytes : (size_t)reader->byte_skip;
    if (skip > size - n * bytes)
        return host_fail(reader->error, "voxels", "%zu bytes after the %zu to skip, found %zu", n * bytes, skip,
                         skip < size ? size - skip : 0u);
    if (allocate(reader, n) != 0)
        return -1;
    if (reader->volume->type == SMR_VOXEL_FLOAT && (reader->scaled || reader->type != HOST_TYPE_F32))
        convert_voxels(reader, data + skip, n, bytes);
    else
        copy_voxels(reader, data + skip, n, bytes);
    return 0;
}

/* Stores one number read from text; 0 when the type cannot hold it. */
static int put_number(const host_volume_reader *reader, size_t i, double value)
{
    void *const to = reader->volume->voxels;
    const uint32_t type = reader->volume->type;
    static const double low[] = {0.0, -128.0, 0.0, -32768.0}, high[] = {255.0, 127.0, 65535.0, 32767.0};
    if (type == SMR_VOXEL_FLOAT) {
        ((float *)to)[i] = to_float(value);
        return 1;
    }
    if (!(value >= low[type] && value <= high[type]) || floor(value) < value)
        return 0;
    if (type == SMR_VOXEL_UINT8)
        ((uint8_t *)to)[i] = (uint8_t)value;
    else if (type == SMR_VOXEL_INT8)
        ((int8_t *)to)[i] = (int8_t)value;
    else if (type == SMR_VOXEL_UINT16)
        ((uint16_t *)to)[i] = (uint16_t)value;
    else
        ((int16_t *)to)[i] = (int16_t)value;
    return 1;
}

static int load_text(const host_volume_reader *to, const unsigned char *data, size_t size)
{
    const size_t n = voxel_count(to);
    const size_t at = to->byte_skip > 0 ? (size_t)to->byte_skip : 0u;
    /* a number takes a digit and a space */
    if (at > size || n > (size - at + 1u) / 2u)
        return host_fail(to->error, "voxels", "%zu numbers, found %zu bytes of text", n, at < size ? size - at : 0u);
    if (allocate(to, n) != 0)
        return -1;
    host_text text = host_text_over(data + at, size - at);
    for (size_t i = 0; i < n; i++) {
        host_word word;
        double value = 0.0;
        if (!host_text_word(&text, &word))
            return host_fail_at(to->error, "voxel", i, "more numbers, but the file ends here");
        if (!host_word_double(word, &value) || !put_number(to, i, value))
            return host_fail_at(to->error, "voxel", i, "a number of the file's type, found %.*s",
                                (int)(word.n < 32u ? word.n : 32u), word.start);
    }
    return 0;
}

static int load_deflated(const host_volume_reader *reader, const unsigned char *data, size_t size)
{
    const size_t bytes = voxel_count(reader) * host_type_bytes(reader->type);
    const size_t skip = reader->byte_skip > 0 ? (size_t)reader->byte_skip : 0u;
    if (skip > HOST_UNPACKED_MAX || bytes > HOST_UNPACKED_MAX - skip)
        return host_fail(reader->error, "voxels", "at most %zu MB after unpacking, found %zu bytes claimed",
                         HOST_UNPACKED_MAX >> 20, bytes);
    if ((skip + bytes) / PACKED_BEST > size)
        return host_fail(reader->error, "voxels", "packed data for %zu bytes, found %zu", skip + bytes, size);
    unsigned char *unpacked = host_alloc(skip + bytes);
    if (unpacked == NULL)
        return host_fail(reader->error, "voxels", "%zu bytes of free memory", skip + bytes);
    const char *expected = host_inflate(data, size, unpacked, skip + bytes);
    int result = expected != NULL ? host_fail(reader->error, "voxels", "%s", expected)
                                  : load_raw(reader, unpacked, skip + bytes);
    free(unpacked);
    return result;
}

int host_volume_convert(host_volume_reader *from)
{
    host_text text = host_text_over(from->data, from->n);
    host_word line;
    for (int64_t i = 0; i < from->line_skip; i++)
        if (!host_text_line(&text, &line))
            return host_fail(from->error, "voxels", "%" PRId64 " lines to skip, found %" PRId64, from->line_skip, i);
    size_t size = (size_t)(text.end - text.at);
    from->data += from->n - size;
    from->n = size;
    from->volume->type = kept_type(from);
    if (from->encoding == HOST_ENCODING_TEXT)
        return load_text(from, from->data, from->n);
    if (from->encoding == HOST_ENCODING_DEFLATE)
        return load_deflated(from, from->data, from->n);
    return load_raw(from, from->data, from->n);
}

/* Puts the data file's name in front of the error's text, since the error line names the header's file. */
static void name_data_file(host_error *error, const char *path, const char *key, host_word w)
{
    char place[sizeof error->place];
    (void)snprintf(place, sizeof place, "%s %.*s, %.20s", key, (int)(w.n < 48u ? w.n : 48u), w.start, error->place);
    memcpy(error->place, place, sizeof place);
    error->file = path;
}

int host_volume_read_detached(host_volume_reader *reader, const char *key, host_word w)
{
    const char *const slash = strrchr(reader->path, '/');
    const size_t folder = slash == NULL || (w.n > 0 && w.start[0] == '/') ? 0u : (size_t)(slash - reader->path) + 1u;
    if (w.n == 0 || memchr(w.start, '\0', w.n) != NULL)
        return host_volume_fail(reader, "%s with the name of a file", key);
    char *path = malloc(folder + w.n + 1u);
    if (path == NULL)
        return host_fail(reader->error, "file", "free memory for a file name");
    memcpy(path, reader->path, folder);
    memcpy(path + folder, w.start, w.n);
    path[folder + w.n] = '\0';
    int result = host_file_read(path, NULL, &reader->detached, reader->error);
    /* host_file_read has left the path in the error; it is freed here, so the error must not keep it. */
    reader->error->file = reader->path;
    if (result != 0)
        name_data_file(reader->error, reader->path, key, w);
    free(path);
    reader->data = reader->detached.data;
    reader->n = reader->detached.size;
    return result;
}

smr_volume host_volume_view(const host_volume *volume)
{
    smr_volume view = {0};
    view.voxels = volume->voxels;
    view.type = volume->type;
    memcpy(view.size, volume->size, sizeof view.size);
    memcpy(view.origin, volume->origin, sizeof view.origin);
    memcpy(view.spacing, volume->spacing, sizeof view.spacing);
    memcpy(view.direction, volume->direction, sizeof view.direction);
    return view;
}

int host_image_read(const char *path, int mirror, host_image *image, host_error *error)
{
    host_volume *const volume = &image->volume;
    memset(image, 0, sizeof *image);
    error->file = path;
    if (host_volume_read(path, volume, error) != 0)
        return -1;
    if (mirror != HOST_MIRROR_NONE)
        host_volume_mirror(volume, mirror);
    image->view = host_volume_view(volume);
    image->bytes = (size_t)volume->size[0] * volume->size[1] * volume->size[2] * host_volume_voxel_bytes(volume->type);
    return 0;
}

void host_image_free(host_image *image)
{
    host_volume_free(&image->volume);
    memset(image, 0, sizeof *image);
}
