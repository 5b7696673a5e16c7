/* volume.c: trilinear interpolation in volumes of five voxel types, any spacing and direction.
 * The eight voxels around a sample are read only when all of them lie inside: outside is known, never read. An axis of one
 * voxel is a slab one spacing thick.
 * SPDX-License-Identifier: MIT */
#include "geometry/volume.h"

#define SMR_AXIS_MAX 65536u
#define SMR_VOXELS_MAX ((uint64_t)1 << 40)
#define SMR_HUGE 1.0e30f /* larger voxel values count as not there */

static int invert3(const float m[9], float out[9])
{
    const smr_vec a = smr_load(m), b = smr_load(m + 3), c = smr_load(m + 6);
    const smr_vec bc = smr_cross(b, c), ca = smr_cross(c, a), ab = smr_cross(a, b);
    const float det = smr_dot(a, bc), size = smr_length(a) * smr_length(b) * smr_length(c);
    if (!(smr_abs(det) > 1.0e-4f * size))
        return 0;
    const float k = 1.0f / det;
    const float inverse[9] = {bc.x * k, ca.x * k, ab.x * k, bc.y * k, ca.y * k, ab.y * k, bc.z * k, ca.z * k, ab.z * k};
    memcpy(out, inverse, sizeof inverse);
    return 1;
}

static uint32_t voxel_bytes(uint32_t type)
{
    return type <= SMR_VOXEL_INT8 ? 1u : (type <= SMR_VOXEL_INT16 ? 2u : 4u);
}

smr_status smr_grid_open(const smr_volume *volume, smr_grid *grid)
{
    uint64_t voxels = 1;
    if (volume == NULL || volume->voxels == NULL)
        return SMR_E_NULL;
    if (volume->type > SMR_VOXEL_FLOAT || (uintptr_t)volume->voxels % voxel_bytes(volume->type) != 0u)
        return SMR_E_INPUT;
    for (uint32_t a = 0; a < 3u; a++) {
        const float spacing = volume->spacing[a];
        if (volume->size[a] < 1u || volume->size[a] > SMR_AXIS_MAX || !(spacing > 1.0e-6f && spacing < SMR_COORD_MAX) ||
            !smr_within(volume->origin[a], SMR_COORD_MAX))
            return SMR_E_INPUT;
        voxels *= volume->size[a];
        for (uint32_t r = 0; r < 3u; r++) {
            if (!smr_within(volume->direction[3u * r + a], 2.0f))
                return SMR_E_INPUT;
        }
    }
    if (voxels > SMR_VOXELS_MAX || !invert3(volume->direction, grid->to_index))
        return SMR_E_INPUT;
    for (uint32_t i = 0; i < 9u; i++)
        grid->to_index[i] /= volume->spacing[i / 3u];
    grid->volume = *volume;
    return SMR_OK;
}

/* The cell of one index coordinate: lower voxel and fraction. Returns 0 outside. */
static inline int cell(float at, uint32_t size, uint32_t *lower, float *fraction)
{
    if (size == 1u) {
        *lower = 0;
        *fraction = 0.0f;
        return at >= -0.5f && at <= 0.5f;
    }
    if (!(at >= 0.0f && at <= (float)(size - 1u)))
        return 0;
    const uint32_t i = (uint32_t)at;
    *lower = i < size - 1u ? i : size - 2u;
    *fraction = at - (float)*lower;
    return 1;
}

/* Offsets of the eight corners of a cell: an axis of one voxel has no second one. */
typedef struct corners {
    size_t base, dx, dy, dz;
    float fx, fy, fz;
} corners;

static int find_corners(const smr_volume *v, smr_vec at, corners *c)
{
    uint32_t x, y, z;
    if (!cell(at.x, v->size[0], &x, &c->fx) || !cell(at.y, v->size[1], &y, &c->fy) || !cell(at.z, v->size[2], &z, &c->fz))
        return 0;
    const size_t row = v->size[0], slice = row * v->size[1];
    c->base = x + row * y + slice * z;
    c->dx = v->size[0] > 1u ? 1u : 0u;
    c->dy = v->size[1] > 1u ? row : 0u;
    c->dz = v->size[2] > 1u ? slice : 0u;
    return 1;
}

static int masked(const uint8_t *mask, const corners *c)
{
    const uint8_t *m = mask + c->base;
    return !(m[0] && m[c->dx] && m[c->dy] && m[c->dx + c->dy] && m[c->dz] && m[c->dx + c->dz] && m[c->dy + c->dz] &&
             m[c->dx + c->dy + c->dz]);
}

#define SMR_TRILINEAR(type)                                                                                    \
    do {                                                                                                       \
        const type *v = (const type *)voxels + c->base;                                                        \
        const float a = (float)v[0] + c->fx * ((float)v[c->dx] - (float)v[0]);                                 \
        const float b = (float)v[c->dy] + c->fx * ((float)v[c->dx + c->dy] - (float)v[c->dy]);                 \
        const float d = (float)v[c->dz] + c->fx * ((float)v[c->dx + c->dz] - (float)v[c->dz]);                 \
        const float e = (float)v[c->dy + c->dz] + c->fx * ((float)v[c->dx + c->dy + c->dz] - (float)v[c->dy + c->dz]); \
        const float f = a + c->fy * (b - a), g = d + c->fy * (e - d);                                          \
        return f + c->fz * (g - f);                                                                            \
    } while (0)

static inline float trilinear(const void *voxels, uint32_t type, const corners *c)
{
    switch (type) {
    case SMR_VOXEL_UINT8: SMR_TRILINEAR(uint8_t);
    case SMR_VOXEL_INT8: SMR_TRILINEAR(int8_t);
    case SMR_VOXEL_UINT16: SMR_TRILINEAR(uint16_t);
    case SMR_VOXEL_INT16: SMR_TRILINEAR(int16_t);
    default: SMR_TRILINEAR(float);
    }
}

uint32_t smr_grid_line(const smr_grid *grid, smr_vec start, smr_vec step, uint32_t n, float *value, unsigned char *inside)
{
    const smr_volume *v = &grid->volume;
    const smr_vec first = smr_mul(grid->to_index, smr_sub(start, smr_load(v->origin)));
    const smr_vec move = smr_mul(grid->to_index, step);
    uint32_t count = 0;
    for (uint32_t k = 0; k < n; k++) {
        corners c;
        value[k] = 0.0f;
        inside[k] = 0;
        if (!find_corners(v, smr_add(first, smr_scale(move, (float)k)), &c) || (v->mask != NULL && masked(v->mask, &c)))
            continue;
        const float sample = trilinear(v->voxels, v->type, &c);
        if (!smr_within(sample, SMR_HUGE))
            continue;
        value[k] = sample;
        inside[k] = 1;
        count++;
    }
    return count;
}
