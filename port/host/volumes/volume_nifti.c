/* volume_nifti.c: reads NIfTI-1 in one file (.nii): a header of 348 bytes, then the voxels. World coordinates are RAS.
 *
 * Orientation: srow when sform_code > 0, else the quaternion when qform_code > 0, else pixdim alone (method 1 of the
 * standard: axes along +x, +y, +z of RAS, origin 0). As in common implementations, a slope of 0 or NaN means that
 * voxels are not scaled.
 * SPDX-License-Identifier: MIT */
#include <math.h>
#include <string.h>
#include "volumes/volume_reader.h"

enum { HEADER_BYTES = 348 };

typedef struct nifti_header {
    const unsigned char *data;
    int big_endian;
} nifti_header;

static int read_int(const nifti_header *header, int at)
{
    return (int)host_type_read(HOST_TYPE_I16, header->data + at, header->big_endian);
}

static double read_float(const nifti_header *header, int at)
{
    return host_type_read(HOST_TYPE_F32, header->data + at, header->big_endian);
}

/* The header's size, its first number, gives the byte order. */
static int read_order(host_volume_reader *reader, nifti_header *header, size_t n)
{
    const char *const magic = (const char *)header->data + AT_MAGIC;
    int size = 0;
    if (n < HEADER_BYTES)
        return host_fail(reader->error, "header", "%d bytes, found %zu", (int)HEADER_BYTES, n);
    for (header->big_endian = 0; header->big_endian < 2; header->big_endian++) {
        size = (int)host_type_read(HOST_TYPE_I32, header->data, header->big_endian);
        if (size == 540)
            return host_fail(reader->error, "sizeof_hdr", "348 (NIfTI-1), found 540 (NIfTI-2 is not read)");
        if (size == HEADER_BYTES)
            break;
    }
    if (size != HEADER_BYTES)
        return host_fail(reader->error, "sizeof_hdr", "348 in one order of bytes or the other");
    if (memcmp(magic, "ni1", 4) == 0)
        return host_fail(reader->error, "magic", "n+1 (one .nii file; pairs of .hdr and .img are not read)");
    if (memcmp(magic, "n+1", 4) != 0)
        return host_fail(reader->error, "magic", "n+1");
    reader->big_endian = header->big_endian;
    return 0;
}

static int read_size(host_volume_reader *reader, const nifti_header *header)
{
    int64_t size[3];
    const int n = read_int(header, AT_DIM);
    if (n < 1 || n > 7)
        return host_fail(reader->error, "dim[0]", "1 to 7 dimensions in the header's order of bytes, found %d", n);
    for (int i = 4; i <= n; i++)
        if (read_int(header, AT_DIM + 2 * i) != 1)
            return host_fail(reader->error, "dim", "3 dimensions, found dim[%d] = %d (series and vectors are not read)",
                             i, read_int(header, AT_DIM + 2 * i));
    if (n < 3)
        return host_fail(reader->error, "dim[0]", "3 dimensions, found %d", n);
    for (int i = 0; i < 3; i++)
        size[i] = read_int(header, AT_DIM + 2 + 2 * i);
    return host_volume_set_size(reader, "dim", size);
}

static int read_type(host_volume_reader *reader, const nifti_header *header)
{
    static const struct {
        int code;
        host_type type;
        int unsigned64;
    } types[] = {{2, HOST_TYPE_U8, 0},     {4, HOST_TYPE_I16, 0},   {8, HOST_TYPE_I32, 0},   {16, HOST_TYPE_F32, 0},
                 {64, HOST_TYPE_F64, 0},   {256, HOST_TYPE_I8, 0},  {512, HOST_TYPE_U16, 0}, {768, HOST_TYPE_U32, 0},
                 {1024, HOST_TYPE_I64, 0}, {1280, HOST_TYPE_I64, 1}};
    const int code = read_int(header, AT_TYPE), bits = read_int(header, AT_BITS);
    for (size_t i = 0; i < sizeof types / sizeof types[0]; i++)
        if (types[i].code == code) {
            reader->type = types[i].type;
            reader->unsigned64 = types[i].unsigned64;
            if ((int)host_type_bytes(reader->type) * 8 == bits)
                return 0;
            return host_fail(reader->error, "bitpix", "%d for datatype %d, found %d",
                             (int)host_type_bytes(reader->type) * 8, code, bits);
        }
    return host_fail(reader->error, "datatype",
                     "a code of whole numbers or floats (colour and complex are not read), found %d", code);
}

static int read_scale(host_volume_reader *reader, const nifti_header *header)
{
    const double slope = read_float(header, AT_SLOPE), inter = read_float(header, AT_INTER);
    if (isnan(slope) || !(slope < 0.0 || slope > 0.0))
        return 0;
    if (!isfinite(slope) || !isfinite(inter))
        return host_fail(reader->error, "scl_slope, scl_inter", "finite numbers, found %g and %g", slope, inter);
    reader->slope = slope;
    reader->inter = inter;
    reader->scaled = slope < 1.0 || slope > 1.0 || inter < 0.0 || inter > 0.0;
    return 0;
}

static void place_by_rows(const nifti_header *header, double steps[3][3], double origin[3])
{
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++)
            steps[j][i] = read_float(header, AT_SROW + 16 * i + 4 * j);
        origin[i] = read_float(header, AT_SROW + 16 * i + 12);
    }
}

/* Axes from the unit quaternion (a, b, c, d). The file has no a, it is >= 0. qfac = pixdim[0] < 0 reverses axis 3. */
static void place_by_quaternion(const nifti_header *h, const double spacing[3], double steps[3][3], double origin[3])
{
    const double qfac = read_float(h, AT_PIXDIM) < 0.0 ? -1.0 : 1.0;
    double b = read_float(h, AT_QUATERNION), c = read_float(h, AT_QUATERNION + 4), d = read_float(h, AT_QUATERNION + 8);
    double a = 1.0 - (b * b + c * c + d * d);
    if (a < 1e-7) { /* a rotation by 180 degrees, rounded; NaN passes and is refused with the axes */
        const double length = sqrt(b * b + c * c + d * d);
        b /= length;
        c /= length;
        d /= length;
        a = 0.0;
    } else {
        a = sqrt(a);
    }
    steps[0][0] = a * a + b * b - c * c - d * d;
    steps[0][1] = 2.0 * (b * c + a * d);
    steps[0][2] = 2.0 * (b * d - a * c);
    steps[1][0] = 2.0 * (b * c - a * d);
    steps[1][1] = a * a + c * c - b * b - d * d;
    steps[1][2] = 2.0 * (c * d + a * b);
    steps[2][0] = 2.0 * (b * d + a * c);
    steps[2][1] = 2.0 * (c * d - a * b);
    steps[2][2] = a * a + d * d - b * b - c * c;
    for (int i = 0; i < 3; i++) {
        steps[0][i] *= spacing[0];
        steps[1][i] *= spacing[1];
        steps[2][i] *= spacing[2] * qfac;
        origin[i] = read_float(h, AT_QOFFSET + 4 * i);
    }
}

/* Millimetres per unit of length; 0 for an unknown code. */
static double unit_mm(int code)
{
    switch (code & 7) {
    case 0: /* unspecified */
    case 2: return 1.0;
    case 1: return 1000.0;
    case 3: return 0.001;
    default: return 0.0;
    }
}

static int read_place(host_volume_reader *reader, const nifti_header *header)
{
    const double unit = unit_mm(header->data[AT_UNITS]);
    const int by_rows = read_int(header, AT_SFORM) > 0, by_quaternion = read_int(header, AT_QFORM) > 0;
    double steps[3][3] = {{0}}, origin[3] = {0}, spacing[3];
    if (!(unit > 0.0))
        return host_fail(reader->error, "xyzt_units", "metres, millimetres or micrometres, found code %d",
                         header->data[AT_UNITS] & 7);
    for (int i = 0; i < 3; i++) {
        spacing[i] = read_float(header, AT_PIXDIM + 4 + 4 * i);
        if (!by_rows && !(spacing[i] > 0.0 && spacing[i] <= (double)SMR_COORD_MAX))
            return host_fail(reader->error, "pixdim", "three positive numbers, found %g", spacing[i]);
        steps[i][i] = spacing[i];
    }
    if (by_rows)
        place_by_rows(header, steps, origin);
    else if (by_quaternion)
        place_by_quaternion(header, spacing, steps, origin);
    for (int i = 0; i < 3; i++) {
        origin[i] *= unit;
        for (int j = 0; j < 3; j++)
            steps[j][i] *= unit;
    }
    host_volume_turn_ras(steps, origin);
    return host_volume_set_geometry(reader,
                                    by_rows         ? "srow"
                                    : by_quaternion ? "quatern, pixdim"
                                                    : "pixdim",
                                    (const double(*)[3])steps, origin);
}

int host_read_nifti(host_volume_reader *reader, const unsigned char *data, size_t n)
{
    nifti_header header = {data, 0};
    if (read_order(reader, &header, n) != 0 || read_size(reader, &header) != 0 || read_type(reader, &header) != 0 ||
        read_scale(reader, &header) != 0 || read_place(reader, &header) != 0)
        return -1;
    double start = read_float(&header, AT_VOXELS);
    if (!(start >= (double)HEADER_BYTES && start <= (double)n))
        return host_fail(reader->error, "vox_offset", "a place from %d to the file's %zu bytes, found %g",
                         (int)HEADER_BYTES, n, start);
    reader->data = data + (size_t)start;
    reader->n = n - (size_t)start;
    return host_volume_convert(reader);
}
