/* volume_write.c: NRRD and MetaImage, uncompressed. What a reader takes of a displacement field is in ITK's and
 * Slicer's documents: vectors in LPS, vector first, intent 1006.
 * SPDX-License-Identifier: MIT */
#include "volumes/voxel_volume.h"
#include <math.h>
#include <string.h>
#include "files/file_names.h"
#include "volumes/volume_reader.h"

#define VOXELS_MAX 200e6 /* of a computed grid */
#define SIDE_MAX 65536.0

int host_volume_can_write(const char *path, host_error *error)
{
    error->file = path;
    if (!host_is_packed_name(path) && (host_has_extension(path, ".nrrd") || host_has_extension(path, ".mha")))
        return 0;
    return host_fail(error, "name", "an output that ends in .nrrd or .mha");
}

static void put_nrrd(const host_volume *g, uint32_t type, uint32_t channels, const char *keys, host_buffer *out)
{
    static const char *const types[] = {"uint8", "int8", "uint16", "int16", "float"};
    const int vector = channels > 1u;
    host_buffer_print(out, "NRRD0005\ntype: %s\ndimension: %d\nspace: left-posterior-superior\nsizes:", types[type],
                      vector ? 4 : 3);
    if (vector)
        host_buffer_print(out, " %u", channels);
    host_buffer_print(out, " %u %u %u\nspace directions:%s", g->size[0], g->size[1], g->size[2], vector ? " none" : "");
    for (uint32_t j = 0; j < 3; j++)
        host_buffer_print(out, " (%.9g,%.9g,%.9g)", (double)g->direction[j] * (double)g->spacing[j],
                          (double)g->direction[3u + j] * (double)g->spacing[j],
                          (double)g->direction[6u + j] * (double)g->spacing[j]);
    host_buffer_print(out,
                      "\nkinds:%s domain domain domain\nendian: little\nencoding: raw\n"
                      "space origin: (%.9g,%.9g,%.9g)\n%s%s\n",
                      vector ? " vector" : "", (double)g->origin[0], (double)g->origin[1], (double)g->origin[2],
                      vector ? "measurement frame: (1,0,0) (0,1,0) (0,0,1)\n" : "", keys);
}

static void put_meta(const host_volume *g, uint32_t type, uint32_t channels, host_buffer *out)
{
    static const char *const types[] = {"MET_UCHAR", "MET_CHAR", "MET_USHORT", "MET_SHORT", "MET_FLOAT"};
    host_buffer_print(out, "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
                           "CompressedData = False\nTransformMatrix =");
    for (uint32_t j = 0; j < 9; j++) /* axis by axis: the matrix' columns */
        host_buffer_print(out, " %.9g", (double)g->direction[j % 3u * 3u + j / 3u]);
    host_buffer_print(out,
                      "\nOffset = %.9g %.9g %.9g\nAnatomicalOrientation = LPS\nElementSpacing = %.9g %.9g %.9g\n"
                      "DimSize = %u %u %u\n",
                      (double)g->origin[0], (double)g->origin[1], (double)g->origin[2], (double)g->spacing[0],
                      (double)g->spacing[1], (double)g->spacing[2], g->size[0], g->size[1], g->size[2]);
    if (channels > 1u)
        host_buffer_print(out, "ElementNumberOfChannels = %u\n", channels);
    host_buffer_print(out, "ElementType = %s\nElementDataFile = LOCAL\n", types[type]);
}

void host_volume_write_header(const host_volume *grid, uint32_t type, uint32_t channels, const char *keys,
                              const char *path, host_buffer *out)
{
    if (host_has_extension(path, ".nrrd"))
        put_nrrd(grid, type, channels, keys, out);
    else
        put_meta(grid, type, channels, out);
}

void host_volume_write_values(const void *values, uint32_t type, size_t n, host_buffer *out)
{
    const uint32_t bytes = host_volume_voxel_bytes(type);
    const unsigned char *p = values;
    if (host_buffer_reserve(out, n * bytes) != 0)
        return;
    for (size_t i = 0; i < n; i++, p += bytes) {
        uint32_t value = 0;
        uint16_t half = 0;
        if (bytes == 4u)
            memcpy(&value, p, 4);
        else if (bytes == 2u)
            memcpy(&half, p, 2);
        value = bytes == 1u ? *p : (bytes == 2u ? half : value);
        for (uint32_t k = 0; k < bytes; k++)
            out->data[out->size++] = (unsigned char)(value >> 8u * k);
    }
}

void host_volume_place(const host_volume *grid, const double index[3], double at[3])
{
    for (uint32_t r = 0; r < 3; r++) {
        at[r] = (double)grid->origin[r];
        for (uint32_t j = 0; j < 3; j++)
            at[r] += (double)grid->direction[3u * r + j] * (double)grid->spacing[j] * index[j];
    }
}

/* Directions may be oblique and left-handed; the reader has refused flat ones. */
void host_volume_to_index(const host_volume *v, double out[9])
{
    double m[9], det = 0.0;
    for (uint32_t i = 0; i < 9; i++)
        m[i] = (double)v->direction[i] * (double)v->spacing[i % 3u];
    for (uint32_t i = 0; i < 9; i++) {
        const uint32_t r = i / 3u, c = i % 3u, r1 = (r + 1u) % 3u, r2 = (r + 2u) % 3u, c1 = (c + 1u) % 3u,
                       c2 = (c + 2u) % 3u;
        out[3u * c + r] = m[3u * r1 + c1] * m[3u * r2 + c2] - m[3u * r1 + c2] * m[3u * r2 + c1];
    }
    det = m[0] * out[0] + m[1] * out[3] + m[2] * out[6];
    for (uint32_t i = 0; i < 9; i++)
        out[i] /= det;
}

int host_volume_around(const float low[3], const float high[3], float edge, const float spacing[3], host_volume *grid)
{
    double voxels = 1.0;
    memset(grid, 0, sizeof *grid);
    for (uint32_t k = 0; k < 3; k++) {
        const double n = ceil(((double)high[k] - (double)low[k] + 2.0 * (double)edge) / (double)spacing[k]) + 1.0;
        voxels *= n;
        if (!(n >= 1.0 && n <= SIDE_MAX))
            return -1;
        grid->size[k] = (uint32_t)n;
        grid->origin[k] = low[k] - edge;
        grid->spacing[k] = spacing[k];
        grid->direction[4u * k] = 1.0f;
    }
    return voxels <= VOXELS_MAX ? 0 : -1;
}

enum { HEADER_BYTES = 352 };

static void put_short(unsigned char *header, int at, uint32_t value)
{
    header[at] = (unsigned char)value;
    header[at + 1] = (unsigned char)(value >> 8);
}

static void put_float(unsigned char *header, int at, float value)
{
    uint32_t bits = 0;
    memcpy(&bits, &value, 4);
    put_short(header, at, bits);
    put_short(header, at + 2, bits >> 16);
}

int host_volume_write_nifti(const host_volume *grid, uint32_t type, host_buffer *out)
{
    static const unsigned codes[] = {2, 256, 512, 4, 16};
    unsigned char header[HEADER_BYTES] = {0};
    put_short(header, 0, 348);
    put_short(header, AT_DIM, 3);
    for (int i = 0; i < 7; i++)
        put_short(header, AT_DIM + 2 + 2 * i, i < 3 ? grid->size[i] : 1u);
    put_short(header, AT_TYPE, codes[type]);
    put_short(header, AT_BITS, 8u * host_volume_voxel_bytes(type));
    put_float(header, AT_PIXDIM, 1.0f);
    put_float(header, AT_VOXELS, (float)HEADER_BYTES);
    put_float(header, AT_SLOPE, 1.0f);
    header[AT_UNITS] = 2; /* mm */
    put_short(header, AT_SFORM, 1);
    for (int i = 0; i < 3; i++) {
        const float sign = i < 2 ? -1.0f : 1.0f; /* LPS to RAS */
        put_float(header, AT_PIXDIM + 4 + 4 * i, grid->spacing[i]);
        for (int j = 0; j < 3; j++)
            put_float(header, AT_SROW + 16 * i + 4 * j, sign * grid->direction[3 * i + j] * grid->spacing[j]);
        put_float(header, AT_SROW + 16 * i + 12, sign * grid->origin[i]);
    }
    memcpy(header + AT_MAGIC, "n+1", 4);
    host_buffer_add(out, header, sizeof header);
    return grid->size[0] <= 32767u && grid->size[1] <= 32767u && grid->size[2] <= 32767u ? 0 : -1;
}
