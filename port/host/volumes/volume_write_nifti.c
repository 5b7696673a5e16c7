/* volume_write_nifti.c: the header of a NIfTI-1 file: its place by srow, in RAS.
 * SPDX-License-Identifier: MIT */
#include "volumes/volume_write.h"

#include <string.h>

enum {
    AT_DIM = 40,
    AT_TYPE = 70,
    AT_BITS = 72,
    AT_PIXDIM = 76,
    AT_VOXELS = 108,
    AT_SLOPE = 112,
    AT_UNITS = 123,
    AT_SFORM = 254,
    AT_SROW = 280,
    AT_MAGIC = 344,
    HEADER_BYTES = 352
};

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
    int i = 0, j = 0;
    put_short(header, 0, 348);
    put_short(header, AT_DIM, 3);
    for (i = 0; i < 7; i++)
        put_short(header, AT_DIM + 2 + 2 * i, i < 3 ? grid->size[i] : 1u);
    put_short(header, AT_TYPE, codes[type]);
    put_short(header, AT_BITS, 8u * host_volume_voxel_bytes(type));
    put_float(header, AT_PIXDIM, 1.0f);
    put_float(header, AT_VOXELS, (float)HEADER_BYTES);
    put_float(header, AT_SLOPE, 1.0f);
    header[AT_UNITS] = 2; /* mm */
    put_short(header, AT_SFORM, 1);
    for (i = 0; i < 3; i++) {
        const float sign = i < 2 ? -1.0f : 1.0f; /* LPS to RAS */
        put_float(header, AT_PIXDIM + 4 + 4 * i, grid->spacing[i]);
        for (j = 0; j < 3; j++)
            put_float(header, AT_SROW + 16 * i + 4 * j, sign * grid->direction[3 * i + j] * grid->spacing[j]);
        put_float(header, AT_SROW + 16 * i + 12, sign * grid->origin[i]);
    }
    memcpy(header + AT_MAGIC, "n+1", 4);
    host_buffer_add(out, header, sizeof header);
    return grid->size[0] <= 32767u && grid->size[1] <= 32767u && grid->size[2] <= 32767u ? 0 : -1;
}
