/* volume_geometry.c: checks the size and the geometry of a volume, for all formats.
 * SPDX-License-Identifier: MIT */
#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>

#include "smr.h"
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
    size_t i = 0;
    for (i = 0; i < 3; i++) {
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

static double determinant(const double a[3][3])
{
    return a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1]) - a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0]) +
           a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0]);
}

/* 1 when the whole volume lies within the coordinate limits; 0 for NaN. */
static int box_is_near(const host_volume *volume, const double steps[3][3], const double origin[3])
{
    const double limit = (double)SMR_COORD_MAX;
    int i = 0, j = 0;
    for (i = 0; i < 3; i++) {
        double low = origin[i], high = origin[i];
        for (j = 0; j < 3; j++) {
            const double way = steps[j][i] * ((double)volume->size[j] - 1.0);
            low += way < 0.0 ? way : 0.0;
            high += way < 0.0 ? 0.0 : way;
        }
        if (!(low >= -limit && high <= limit))
            return 0;
    }
    return 1;
}

int host_volume_set_geometry(host_volume_reader *reader, const char *place, const double steps[3][3],
                             const double origin[3])
{
    host_volume *const volume = reader->volume;
    char text[120];
    double unit[3][3];
    int i = 0, j = 0;
    for (j = 0; j < 3; j++) {
        const double mm = sqrt(steps[j][0] * steps[j][0] + steps[j][1] * steps[j][1] + steps[j][2] * steps[j][2]);
        if (!(mm >= 1e-6 && mm <= (double)SMR_COORD_MAX)) /* written so that NaN fails */
            return host_fail(reader->error, place, "a positive spacing and a direction along axis %d, found %g mm", j,
                             mm);
        volume->spacing[j] = (float)mm;
        for (i = 0; i < 3; i++)
            unit[j][i] = steps[j][i] / mm;
    }
    if (!(fabs(determinant((const double(*)[3])unit)) > FLAT))
        return host_fail(reader->error, place, "three axes that do not lie in one plane");
    if (!box_is_near(volume, steps, origin)) {
        (void)snprintf(text, sizeof text, "a volume within +-%.0f mm", (double)SMR_COORD_MAX);
        return host_fail(reader->error, place, "%s, found the first voxel at %g %g %g", text, origin[0], origin[1],
                         origin[2]);
    }
    for (i = 0; i < 3; i++) {
        volume->origin[i] = (float)origin[i];
        for (j = 0; j < 3; j++)
            volume->direction[3 * i + j] = (float)unit[j][i];
    }
    return 0;
}

void host_volume_turn_ras(double steps[3][3], double origin[3])
{
    int i = 0, j = 0;
    for (i = 0; i < 2; i++) {
        origin[i] = 0.0 - origin[i];
        for (j = 0; j < 3; j++)
            steps[j][i] = 0.0 - steps[j][i];
    }
}

uint32_t host_volume_voxel_bytes(uint32_t type)
{
    static const unsigned char bytes[] = {1, 1, 2, 2, 4};
    return bytes[type];
}
