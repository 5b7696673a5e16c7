/* volume_file.c: reads a volume file of any format: finds the format and calls its reader. Mirrors and frees volumes.
 * SPDX-License-Identifier: MIT */
#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "files/file_names.h"
#include "volumes/volume_reader.h"

/* Unit axes with a smaller determinant count as coplanar. */
#define FLAT 1e-6

int host_volume_fail(const host_volume_reader *reader, const char *expected, ...)
{
    char text[sizeof reader->error->expected];
    va_list list;
    va_start(list, expected);
    (void)vsnprintf(text, sizeof text, expected, list);
    va_end(list);
    return host_fail_at(reader->error, "header line", reader->line, "%s", text);
}

/* Fills the error: of the current line, or of the field when the format has no lines. */
static int fail_field(const host_volume_reader *reader, const char *place, const char *expected)
{
    return reader->line > 0 ? host_volume_fail(reader, "%s: %s", place, expected)
                            : host_fail(reader->error, place, "%s", expected);
}

int host_volume_set_size(host_volume_reader *reader, const char *place, const int64_t size[3])
{
    char text[160];
    uint64_t n = 1;
    for (size_t i = 0; i < 3; i++) {
        if (size[i] < 1) {
            (void)snprintf(text, sizeof text, "three counts of 1 or more, found %" PRId64, size[i]);
            return fail_field(reader, place, text);
        }
        if ((uint64_t)size[i] > HOST_FILE_MAX / n) {
            (void)snprintf(text, sizeof text, "at most %zu million voxels, found %" PRId64 " x %" PRId64 " x %" PRId64,
                           HOST_FILE_MAX / 1000000u, size[0], size[1], size[2]);
            return fail_field(reader, place, text);
        }
        n *= (uint64_t)size[i];
        reader->volume->size[i] = (uint32_t)size[i];
    }
    return 0;
}

double host_determinant(const double a[3][3])
{
    return a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1]) - a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0]) +
           a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0]);
}

/* 1 when the whole volume lies within the coordinate limits; 0 for NaN. */
static int box_is_near(const host_volume *volume, const double steps[3][3], const double origin[3])
{
    const double limit = (double)SMR_COORD_MAX;
    for (int i = 0; i < 3; i++) {
        double low = origin[i], high = origin[i];
        for (int j = 0; j < 3; j++) {
            const double way = steps[j][i] * ((double)volume->size[j] - 1.0);
            low += way < 0.0 ? way : 0.0;
            high += way < 0.0 ? 0.0 : way;
        }
        if (!(low >= -limit && high <= limit))
            return 0;
    }
    return 1;
}

int host_volume_set_geometry(host_volume_reader *to, const char *at, const double steps[3][3], const double origin[3])
{
    host_volume *const volume = to->volume;
    char text[120];
    double unit[3][3];
    for (int j = 0; j < 3; j++) {
        const double mm = sqrt(steps[j][0] * steps[j][0] + steps[j][1] * steps[j][1] + steps[j][2] * steps[j][2]);
        if (!(mm >= 1e-6 && mm <= (double)SMR_COORD_MAX)) /* written so that NaN fails */
            return host_fail(to->error, at, "a positive spacing and a direction along axis %d, found %g mm", j, mm);
        volume->spacing[j] = (float)mm;
        for (int i = 0; i < 3; i++)
            unit[j][i] = steps[j][i] / mm;
    }
    if (!(fabs(host_determinant((const double(*)[3])unit)) > FLAT))
        return host_fail(to->error, at, "three axes that do not lie in one plane");
    if (!box_is_near(volume, steps, origin)) {
        (void)snprintf(text, sizeof text, "a volume within +-%.0f mm", (double)SMR_COORD_MAX);
        return host_fail(to->error, at, "%s, found the first voxel at %g %g %g", text, origin[0], origin[1], origin[2]);
    }
    for (int i = 0; i < 3; i++) {
        volume->origin[i] = (float)origin[i];
        for (int j = 0; j < 3; j++)
            volume->direction[3 * i + j] = (float)unit[j][i];
    }
    return 0;
}

void host_volume_turn_ras(double steps[3][3], double origin[3])
{
    for (int i = 0; i < 2; i++) {
        origin[i] = 0.0 - origin[i];
        for (int j = 0; j < 3; j++)
            steps[j][i] = 0.0 - steps[j][i];
    }
}

uint32_t host_volume_voxel_bytes(uint32_t type)
{
    static const unsigned char bytes[] = {1, 1, 2, 2, 4};
    return bytes[type];
}

typedef int (*read_function)(host_volume_reader *reader, const unsigned char *data, size_t n);

/* A NIfTI file starts with the size of its header: 348, or 540 in version 2. */
static int looks_like_nifti(const unsigned char *head, size_t n)
{
    for (int order = 0; n >= 348u && order < 2; order++) {
        const double bytes = host_type_read(HOST_TYPE_I32, head, order);
        if (bytes >= 348.0 && bytes <= 348.0 && (head[344] == 'n'))
            return 1;
        if (bytes >= 540.0 && bytes <= 540.0 && head[4] == 'n')
            return 1;
    }
    return 0;
}

static read_function reader_for(const char *path, const unsigned char *head, size_t n)
{
    if (host_starts_with(head, n, "NRRD0"))
        return host_read_nrrd;
    if (host_starts_with(head, n, "ObjectType") || host_starts_with(head, n, "NDims"))
        return host_read_metaimage;
    if (looks_like_nifti(head, n))
        return host_read_nifti;
    if (host_has_extension(path, ".mha") || host_has_extension(path, ".mhd"))
        return host_read_metaimage;
    if (host_has_extension(path, ".nrrd") || host_has_extension(path, ".nhdr"))
        return host_read_nrrd;
    if (host_has_extension(path, ".nii"))
        return host_read_nifti;
    return NULL;
}

static int accept_volume(const host_head *head, host_error *error)
{
    if (reader_for(head->path, head->data, head->n) != NULL)
        return 0;
    if (host_has_extension(head->path, ".dcm") || (head->n >= 132u && memcmp(head->data + 128, "DICM", 4) == 0))
        return host_fail(error, "content", "a MetaImage, NIfTI-1 or NRRD volume; dcm2niix makes one of a DICOM series");
    return host_fail(error, "content", "a MetaImage, NIfTI-1 or NRRD volume");
}

int host_volume_read_layers(const char *path, host_volume *to, uint32_t *layers, host_buffer *keys, host_error *error)
{
    host_bytes bytes;
    host_volume_reader reader = {.volume = to, .error = error, .path = path, .keys = keys};
    memset(to, 0, sizeof *to);
    if (host_file_read(path, accept_volume, &bytes, error) != 0)
        return -1;
    read_function read = reader_for(path, bytes.data, bytes.size);
    int result = read != NULL ? read(&reader, bytes.data, bytes.size)
                              : host_fail(error, "content", "a MetaImage, NIfTI-1 or NRRD volume");
    host_file_free(&bytes);
    host_file_free(&reader.detached);
    if (result != 0)
        host_volume_free(to);
    *layers = reader.layers > 0u ? reader.layers : 1u;
    return result;
}

int host_volume_read(const char *path, host_volume *volume, host_error *error)
{
    uint32_t layers = 0;
    return host_volume_read_layers(path, volume, &layers, NULL, error);
}

void host_volume_free(host_volume *volume)
{
    free(volume->voxels);
    memset(volume, 0, sizeof *volume);
}

void host_volume_mirror(host_volume *volume, int axis)
{
    const size_t row = (size_t)axis;
    /* 0 - x instead of -x: does not turn 0 into -0, which prints differently */
    volume->origin[row] = 0.0f - volume->origin[row];
    for (size_t j = 0; j < 3; j++)
        volume->direction[3u * row + j] = 0.0f - volume->direction[3u * row + j];
}

int host_is_volume_path(const char *path)
{
    static const char *const endings[] = {".mha", ".mhd", ".nii", ".nrrd", ".nhdr", ".dcm"};
    for (size_t i = 0; i < sizeof endings / sizeof endings[0]; i++)
        if (host_has_extension(path, endings[i]))
            return 1;
    return 0;
}

int host_volume_read_grid(const char *path, host_volume *grid, host_error *error)
{
    if (host_volume_read(path, grid, error) != 0)
        return -1;
    free(grid->voxels);
    grid->voxels = NULL;
    return 0;
}
