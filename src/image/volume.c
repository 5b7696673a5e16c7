/* volume.c: trilinear interpolation along lines (paper 2.1) in volumes of five voxel types, any spacing and direction.
 * A sample is inside when all eight voxels around it are. An axis of one voxel is a slab as thick as its spacing.
 * Method: index coordinates first + k move are monotonic in k, even when rounded, so the samples inside are one run,
 * found by its two ends. The run is processed in batches by loops that compilers vectorise.
 * SPDX-License-Identifier: MIT */
#include "image/volume.h"

#define SMR_AXIS_MAX 65536u /* largest number of voxels along an axis of a volume */
#define SMR_VOXELS_MAX ((uint64_t)1 << 40)
#define SMR_NOT_UNIT 0.01f /* largest |squared length - 1| of a direction */
#define SMR_HUGE 1.0e30f   /* intensity: a sample of larger absolute value counts as outside the image */

/* Writes the inverse of the row-major matrix m. Returns 0 when m is nearly singular. */
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

static uint32_t voxel_bytes(uint32_t type) { return type <= SMR_VOXEL_INT8 ? 1u : (type <= SMR_VOXEL_INT16 ? 2u : 4u); }

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
        const smr_vec axis = smr_v(volume->direction[a], volume->direction[3u + a], volume->direction[6u + a]);
        if (!smr_within(smr_dot(axis, axis) - 1.0f,
                        SMR_NOT_UNIT)) /* refuses axes that are no unit vectors, such as axes as long as the spacing */
            return SMR_E_INPUT;
    }
    if (voxels > SMR_VOXELS_MAX || !invert3(volume->direction, grid->to_index))
        return SMR_E_INPUT;
    for (uint32_t i = 0; i < 9u; i++)
        grid->to_index[i] /= volume->spacing[i / 3u];
    grid->volume = *volume;
    return SMR_OK;
}

#define SMR_BATCH 32u /* number of samples that one batch interpolates */

/* A line in index coordinates: sample k lies at first + k move. */
typedef struct line {
    float first[3], move[3];
} line;

static line line_of(const smr_grid *grid, smr_vec start, smr_vec spacing)
{
    line l;
    smr_store(l.first, smr_mul(grid->to_index, smr_sub(start, smr_load(grid->volume.origin))));
    smr_store(l.move, smr_mul(grid->to_index, spacing));
    return l;
}

/* Where each sample of a batch lies between voxels, for each axis. */
typedef struct cells {
    int32_t lower[3][SMR_BATCH];  /* index, along the axis, of the voxel at or below the sample */
    float fraction[3][SMR_BATCH]; /* distance from the lower voxel / distance between voxels, 0 .. 1 */
} cells;

/* Distances between voxels in memory, in voxels. */
typedef struct strides {
    size_t row, slice; /* from one row to the next; from one slice to the next */
    size_t dx, dy, dz; /* from a voxel to the next one in x, y, z; 0 for an axis of one voxel */
} strides;

/* Returns 1 when the index coordinate `at` lies inside an axis of n voxels. */
static int on_axis(float at, uint32_t n) { return n == 1u ? smr_within(at, 0.5f) : at >= 0 && at <= (float)(n - 1u); }

/* Shrinks the run of samples *from .. *to - 1 to those inside an axis of `size` voxels. */
static void clip(float first, float move, uint32_t size, uint32_t *from, uint32_t *to)
{
    while (*from < *to && !on_axis(first + move * (float)*from, size))
        ++*from;
    while (*to > *from && !on_axis(first + move * (float)(*to - 1u), size))
        --*to;
}

/* Writes the lower voxels and fractions of samples k .. k+n-1, which all lie inside the volume. */
static void find_cells(const smr_volume *v, const line *l, uint32_t k, uint32_t n, cells *c)
{
    for (uint32_t axis = 0; axis < 3u; axis++) {
        if (v->size[axis] == 1u) {
            memset(c->lower[axis], 0, sizeof c->lower[axis]);
            memset(c->fraction[axis], 0, sizeof c->fraction[axis]);
            continue;
        }
        const int32_t last = (int32_t)v->size[axis] - 2;
        const float first = l->first[axis], move = l->move[axis];
        for (uint32_t i = 0; i < n; i++) {
            const float at = first + move * (float)(int32_t)(k + i);
            const int32_t voxel = (int32_t)at, lower = voxel < last ? voxel : last;
            c->lower[axis][i] = lower;
            c->fraction[axis][i] = at - (float)lower;
        }
    }
}

/* Returns the index in memory of the lowest of the eight voxels around sample i. */
static inline size_t first_voxel(const cells *c, uint32_t i, const strides *d)
{
    return (size_t)c->lower[0][i] + d->row * (size_t)c->lower[1][i] + d->slice * (size_t)c->lower[2][i];
}

/* Defines a function that interpolates n samples in voxels of `type`, gathered as `number`, which vectorises. */
#define SMR_TRILINEAR(name, type, number)                                                                              \
    static void name(const void *voxels, const cells *c, const strides *d, uint32_t n, float *value)                   \
    {                                                                                                                  \
        number corner[8][SMR_BATCH];                                                                                   \
        for (uint32_t i = 0; i < n; i++) {                                                                             \
            const type *v = (const type *)voxels + first_voxel(c, i, d);                                               \
            corner[0][i] = v[0];                                                                                       \
            corner[1][i] = v[d->dx];                                                                                   \
            corner[2][i] = v[d->dy];                                                                                   \
            corner[3][i] = v[d->dy + d->dx];                                                                           \
            v += d->dz;                                                                                                \
            corner[4][i] = v[0];                                                                                       \
            corner[5][i] = v[d->dx];                                                                                   \
            corner[6][i] = v[d->dy];                                                                                   \
            corner[7][i] = v[d->dy + d->dx];                                                                           \
        }                                                                                                              \
        for (uint32_t i = 0; i < n; i++) {                                                                             \
            const float fx = c->fraction[0][i], fy = c->fraction[1][i], fz = c->fraction[2][i];                        \
            const float a = (float)corner[0][i] + fx * ((float)corner[1][i] - (float)corner[0][i]);                    \
            const float b = (float)corner[2][i] + fx * ((float)corner[3][i] - (float)corner[2][i]);                    \
            const float e = (float)corner[4][i] + fx * ((float)corner[5][i] - (float)corner[4][i]);                    \
            const float f = (float)corner[6][i] + fx * ((float)corner[7][i] - (float)corner[6][i]);                    \
            const float near = a + fy * (b - a), far = e + fy * (f - e);                                               \
            value[i] = near + fz * (far - near);                                                                       \
        }                                                                                                              \
    }

SMR_TRILINEAR(sample_uint8, uint8_t, int32_t)
SMR_TRILINEAR(sample_int8, int8_t, int32_t)
SMR_TRILINEAR(sample_uint16, uint16_t, int32_t)
SMR_TRILINEAR(sample_int16, int16_t, int32_t)
SMR_TRILINEAR(sample_float, float, float)

/* Writes value[i], the interpolated intensity of sample i of the batch, i < n. */
static void sample(const smr_volume *v, const cells *c, const strides *d, uint32_t n, float *value)
{
    switch (v->type) {
    case SMR_VOXEL_UINT8: sample_uint8(v->voxels, c, d, n, value); break;
    case SMR_VOXEL_INT8: sample_int8(v->voxels, c, d, n, value); break;
    case SMR_VOXEL_UINT16: sample_uint16(v->voxels, c, d, n, value); break;
    case SMR_VOXEL_INT16: sample_int16(v->voxels, c, d, n, value); break;
    default: sample_float(v->voxels, c, d, n, value); break;
    }
}

/* Returns 1 when the mask is 0 at any of the eight voxels around a sample; lo: the mask at the lowest of the eight. */
static int masked(const uint8_t *lo, const strides *d)
{
    const uint8_t *m = lo + d->dz;
    return !(lo[0] && lo[d->dx] && lo[d->dy] && lo[d->dx + d->dy] && m[0] && m[d->dx] && m[d->dy] && m[d->dx + d->dy]);
}

/* Sets value and inside to 0 where the mask is 0 or a value is NaN or huge. Returns the number of samples inside. */
static uint32_t drop(const smr_volume *v, const cells *c, const strides *d, uint32_t n, float *value, uint8_t *inside)
{
    uint32_t left = n;
    memset(inside, 1, n);
    for (uint32_t i = 0; (v->mask != NULL || v->type == SMR_VOXEL_FLOAT) && i < n; i++) {
        if ((v->mask == NULL || !masked(v->mask + first_voxel(c, i, d), d)) && smr_within(value[i], SMR_HUGE))
            continue;
        value[i] = 0.0f;
        inside[i] = 0;
        left--;
    }
    return left;
}

uint32_t smr_grid_line(const smr_grid *grid, smr_vec start, smr_vec spacing, uint32_t n, float *value, uint8_t *inside)
{
    const smr_volume *v = &grid->volume;
    const size_t row = v->size[0], slice = row * v->size[1];
    const strides d = {row, slice, v->size[0] > 1u ? 1u : 0u, v->size[1] > 1u ? row : 0u, v->size[2] > 1u ? slice : 0u};
    const line l = line_of(grid, start, spacing);
    uint32_t from = 0, to = n, count = 0;
    for (uint32_t axis = 0; axis < 3u; axis++)
        clip(l.first[axis], l.move[axis], v->size[axis], &from, &to);
    memset(value, 0, n * sizeof *value);
    memset(inside, 0, n);
    for (uint32_t k = from; k < to; k += SMR_BATCH) {
        cells c;
        const uint32_t some = smr_min_u32(to - k, SMR_BATCH);
        find_cells(v, &l, k, some, &c);
        sample(v, &c, &d, some, value + k);
        count += drop(v, &c, &d, some, value + k, inside + k);
    }
    return count;
}

#define SMR_AHEAD 2u /* every SMR_AHEAD-th sample is prefetched: voxels are mostly larger than the samples' distance */

void smr_grid_ahead(const smr_grid *grid, smr_vec start, smr_vec spacing, uint32_t n)
{
    const smr_volume *v = &grid->volume;
    const size_t bytes = voxel_bytes(v->type), row = bytes * v->size[0], slice = row * v->size[1];
    const line l = line_of(grid, start, spacing);
    const smr_vec top = smr_v((float)(v->size[0] - 1u), (float)(v->size[1] - 1u), (float)(v->size[2] - 1u));
    for (uint32_t k = 0; k < n; k += SMR_AHEAD) {
        const smr_vec at = smr_add(smr_load(l.first), smr_scale(smr_load(l.move), (float)(int32_t)k));
        if (!(at.x >= 0.0f && at.x < top.x && at.y >= 0.0f && at.y < top.y && at.z >= 0.0f && at.z < top.z))
            continue;
        const size_t to = bytes * (size_t)(int32_t)at.x + row * (size_t)(int32_t)at.y + slice * (size_t)(int32_t)at.z;
        const uint8_t *cell = (const uint8_t *)v->voxels + to;
        __builtin_prefetch(cell);
        __builtin_prefetch(cell + row);
        __builtin_prefetch(cell + slice);
        __builtin_prefetch(cell + slice + row);
    }
}
