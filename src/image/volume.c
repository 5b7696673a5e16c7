/* volume.c: trilinear interpolation along lines (paper 2.1) in volumes of five voxel types, any spacing and direction.
 * A sample is inside when all eight voxels around it are. An axis of one voxel is a slab as thick as its spacing.
 * Method: index coordinates first + k move are monotonic in k, even when rounded, so the samples inside are one run,
 * found by its two ends. The run is processed in batches by loops that compilers vectorise.
 * SPDX-License-Identifier: MIT */
#include "base/bytes.h"
#include "base/lanes.h"
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
    float to_index[9];
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
    if (voxels > SMR_VOXELS_MAX || !invert3(volume->direction, to_index))
        return SMR_E_INPUT;
    memset(grid->column, 0, sizeof grid->column);
    grid->low[3] = grid->high[3] = 0.0f;
    for (uint32_t a = 0; a < 3u; a++) {
        const uint32_t size = volume->size[a];
        for (uint32_t k = 0; k < 3u; k++)
            grid->column[k][a] = to_index[3u * a + k] / volume->spacing[a];
        grid->low[a] = size == 1u ? -0.5f : 0.0f;
        grid->high[a] = size == 1u ? 0.5f : (float)(int32_t)(size - 1u);
        grid->last[a] = size == 1u ? 0 : (int32_t)size - 2;
    }
    grid->volume = *volume;
    return SMR_OK;
}

#define SMR_BATCH 48u /* largest number of samples that one batch interpolates */
/* Loops over a batch take a multiple of this many samples, the last sample several times. */
#define SMR_FILLED (SMR_LANES < 4u ? 1u : 4u)

/* A line in index coordinates: sample k lies at first + k move. */
typedef struct line {
    float first[4], move[4]; /* 0 along an axis of one voxel; the fourth number is not used */
} line;

/* Where each sample of a batch lies between voxels, for each axis. */
typedef struct cells {
    int32_t lower[3][SMR_BATCH];  /* index, along the axis, of the voxel at or below the sample */
    float fraction[3][SMR_BATCH]; /* distance from the lower voxel / distance between voxels, 0 .. 1 */
} cells;

static inline uint32_t padded(uint32_t n) { return (n + SMR_FILLED - 1u) & ~(SMR_FILLED - 1u); }

/* Distances between voxels in memory, in voxels. */
typedef struct strides {
    size_t row, slice; /* from one row to the next; from one slice to the next */
    size_t dx, dy, dz; /* from a voxel to the next one in x, y, z; 0 for an axis of one voxel */
} strides;

static int between(float at, float low, float high) { return at >= low && at <= high; }

/* Shrinks the run of samples *from .. *to - 1 of a line to those inside along an axis. */
static void clip(const smr_grid *grid, const line *l, uint32_t axis, uint32_t *from, uint32_t *to)
{
    const float first = l->first[axis], move = l->move[axis], low = grid->low[axis], high = grid->high[axis];
    while (*from < *to && !between(first + move * (float)(int32_t)*from, low, high))
        ++*from;
    while (*to > *from && !between(first + move * (float)(int32_t)(*to - 1u), low, high))
        --*to;
}

/* Returns a line in index coordinates. Of its n samples, samples *from .. *to - 1 lie inside the volume. */
static line line_of(const smr_grid *grid, smr_vec start, smr_vec spacing, uint32_t n, uint32_t *from, uint32_t *to)
{
    const float(*const c)[4] = grid->column, *const low = grid->low, *const high = grid->high;
    const smr_vec d = smr_sub(start, smr_load(grid->volume.origin));
    const float end = (float)(int32_t)(n - 1u);
    int32_t within[4];
    line l;
    for (uint32_t a = 0; a < 4u; a++) { /* of four, as vectors have four numbers */
        const float first = c[0][a] * d.x + c[1][a] * d.y + c[2][a] * d.z;
        const float move = c[0][a] * spacing.x + c[1][a] * spacing.y + c[2][a] * spacing.z, last = first + move * end;
        within[a] = (first >= low[a]) & (first <= high[a]) & (last >= low[a]) & (last <= high[a]);
        l.first[a] = first;
        l.move[a] = move;
    }
    *from = 0;
    *to = n;
    for (uint32_t axis = 0; !(within[0] & within[1] & within[2]) && axis < 3u; axis++)
        clip(grid, &l, axis, from, to);
    for (uint32_t axis = 0; axis < 3u; axis++)
        if (low[axis] < 0.0f) /* an axis of one voxel */
            l.first[axis] = l.move[axis] = 0.0f;
    return l;
}

/* Writes the lower voxels and fractions of samples k .. k+n-1, which all lie inside the volume, from place `to` on. */
static inline void find_cells(const smr_grid *grid, const line *l, uint32_t k, uint32_t n, cells *c, uint32_t to)
{
    const float end = (float)(int32_t)(k + n - 1u);
    for (uint32_t i = 0; i < padded(n); i++) {
        const float sample = smr_min((float)(int32_t)(k + i), end);
        for (uint32_t axis = 0; axis < 3u; axis++) {
            const float at = l->first[axis] + l->move[axis] * sample;
            const int32_t voxel = (int32_t)at, lower = voxel - (voxel > grid->last[axis]); /* one too far at most */
            c->lower[axis][to + i] = lower;
            c->fraction[axis][to + i] = at - (float)lower;
        }
    }
}

/* Returns the index in memory of the lowest of the eight voxels around sample i. */
static inline size_t first_voxel(const cells *c, uint32_t i, const strides *d)
{
    return (size_t)c->lower[0][i] + d->row * (size_t)c->lower[1][i] + d->slice * (size_t)c->lower[2][i];
}

/* Returns the value between eight voxels: v000 the lowest of them, v100 the next one in x, v010 in y. */
static inline float blend(const cells *c, uint32_t i, float v000, float v100, float v010, float v110, float v001,
                          float v101, float v011, float v111)
{
    const float fx = c->fraction[0][i], fy = c->fraction[1][i], fz = c->fraction[2][i];
    const float a = v000 + fx * (v100 - v000), b = v010 + fx * (v110 - v010);
    const float e = v001 + fx * (v101 - v001), f = v011 + fx * (v111 - v011);
    const float near = a + fy * (b - a), far = e + fy * (f - e);
    return near + fz * (far - near);
}

/* Return the first and the second of two successive voxels of `bits` bits. Shifts of `number` keep the sign, if any. */
#define SMR_UPPER(number, bits, pair) (float)(int32_t)((pair) >> (bits))
#define SMR_LOWER(number, bits, pair) (float)(int32_t)((number)((uint32_t)(pair) << (32u - (bits))) >> (32u - (bits)))
#define SMR_FIRST(number, bits, pair) (SMR_BIG_ENDIAN ? SMR_UPPER(number, bits, pair) : SMR_LOWER(number, bits, pair))
#define SMR_SECOND(number, bits, pair) (SMR_BIG_ENDIAN ? SMR_LOWER(number, bits, pair) : SMR_UPPER(number, bits, pair))

/* Defines a function that interpolates n samples in voxels of `bits` bits, gathered in pairs, which vectorises. */
#define SMR_TRILINEAR(name, bits, two, number)                                                                         \
    static inline number name##_pair(const uint8_t *v, size_t dx)                                                      \
    {                                                                                                                  \
        two pair = 0;                                                                                                  \
        if (dx != 0u)                                                                                                  \
            memcpy(&pair, v, sizeof pair);                                                                             \
        else                                                                                                           \
            memcpy(&pair, v, sizeof pair / 2u); /* the other half of the pair is beyond the last voxel */              \
        return pair;                                                                                                   \
    }                                                                                                                  \
    static void name(const void *voxels, const cells *c, const strides *d, uint32_t n, float *value)                   \
    {                                                                                                                  \
        const size_t bytes = (bits) / 8u, dx = d->dx, dy = bytes * d->dy, dz = bytes * d->dz;                          \
        number pair[4][SMR_BATCH];                                                                                     \
        for (uint32_t i = 0; i < padded(n); i++) {                                                                     \
            const uint8_t *v = (const uint8_t *)voxels + bytes * first_voxel(c, i, d);                                 \
            pair[0][i] = name##_pair(v, dx);                                                                           \
            pair[1][i] = name##_pair(v + dy, dx);                                                                      \
            pair[2][i] = name##_pair(v + dz, dx);                                                                      \
            pair[3][i] = name##_pair(v + dz + dy, dx);                                                                 \
        }                                                                                                              \
        for (uint32_t i = 0; i < padded(n); i++)                                                                       \
            value[i] = blend(c, i, SMR_FIRST(number, bits, pair[0][i]), SMR_SECOND(number, bits, pair[0][i]),          \
                             SMR_FIRST(number, bits, pair[1][i]), SMR_SECOND(number, bits, pair[1][i]),                \
                             SMR_FIRST(number, bits, pair[2][i]), SMR_SECOND(number, bits, pair[2][i]),                \
                             SMR_FIRST(number, bits, pair[3][i]), SMR_SECOND(number, bits, pair[3][i]));               \
    }

SMR_TRILINEAR(sample_uint8, 8u, uint16_t, uint32_t)
SMR_TRILINEAR(sample_int8, 8u, int16_t, int32_t)
SMR_TRILINEAR(sample_uint16, 16u, uint32_t, uint32_t)
SMR_TRILINEAR(sample_int16, 16u, int32_t, int32_t)

static void sample_float(const void *voxels, const cells *c, const strides *d, uint32_t n, float *value)
{
    for (uint32_t i = 0; i < n; i++) {
        const float *const v = (const float *)voxels + first_voxel(c, i, d), *const far = v + d->dz;
        value[i] =
            blend(c, i, v[0], v[d->dx], v[d->dy], v[d->dy + d->dx], far[0], far[d->dx], far[d->dy], far[d->dy + d->dx]);
    }
}

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
    for (uint32_t i = 0; (v->mask != NULL || v->type == SMR_VOXEL_FLOAT) && i < n; i++) {
        if ((v->mask == NULL || !masked(v->mask + first_voxel(c, i, d), d)) && smr_within(value[i], SMR_HUGE))
            continue;
        value[i] = 0.0f;
        inside[i] = 0;
        left--;
    }
    return left;
}

static inline strides strides_of(const smr_volume *v)
{
    const size_t row = v->size[0], slice = row * v->size[1];
    return (strides){row, slice, v->size[0] > 1u ? 1u : 0u, v->size[1] > 1u ? row : 0u, v->size[2] > 1u ? slice : 0u};
}

uint32_t smr_grid_line(const smr_grid *grid, smr_vec start, smr_vec spacing, uint32_t n, float *value, uint8_t *inside)
{
    const smr_volume *v = &grid->volume;
    const strides d = strides_of(v);
    uint32_t from, to, count = 0;
    const line l = line_of(grid, start, spacing, n, &from, &to);
    if (to - from < n) {
        memset(value, 0, n * sizeof *value);
        memset(inside, 0, n);
    }
    memset(inside + from, 1, to - from);
    for (uint32_t k = from; k < to; k += SMR_BATCH) {
        cells c;
        float batch[SMR_BATCH];
        const uint32_t some = smr_min_u32(to - k, SMR_BATCH);
        find_cells(grid, &l, k, some, &c, 0);
        sample(v, &c, &d, some, batch);
        memcpy(value + k, batch, some * sizeof *batch);
        count += drop(v, &c, &d, some, value + k, inside + k);
    }
    return count;
}

#define SMR_SHARE (SMR_BATCH / SMR_TOGETHER) /* largest number of samples of each of the lines in a batch */

int smr_grid_lines(const smr_grid *grid, const smr_vec start[SMR_TOGETHER], smr_vec spacing, uint32_t n,
                   float value[SMR_TOGETHER][SMR_PROFILE_MAX])
{
    const smr_volume *v = &grid->volume;
    const strides d = strides_of(v);
    line l[SMR_TOGETHER];
    for (uint32_t i = 0; i < SMR_TOGETHER; i++) {
        uint32_t from, to;
        l[i] = line_of(grid, start[i], spacing, n, &from, &to);
        if (to - from < n)
            return 0;
    }
    for (uint32_t k = 0; k < n; k += SMR_SHARE) {
        cells c;
        float batch[SMR_BATCH];
        uint8_t inside[SMR_BATCH];
        const uint32_t some = smr_min_u32(n - k, SMR_SHARE), each = padded(some), all = SMR_TOGETHER * each;
        for (uint32_t i = 0; i < SMR_TOGETHER; i++)
            find_cells(grid, &l[i], k, some, &c, i * each);
        sample(v, &c, &d, all, batch);
        if (drop(v, &c, &d, all, batch, inside) < all)
            return 0;
        for (uint32_t i = 0; i < SMR_TOGETHER; i++)
            for (uint32_t j = 0; j < some; j++)
                value[i][k + j] = batch[i * each + j];
    }
    return 1;
}

void smr_grid_ahead(const smr_grid *grid, smr_vec start, smr_vec spacing, uint32_t n)
{
    const smr_volume *v = &grid->volume;
    const size_t bytes = voxel_bytes(v->type), row = bytes * v->size[0], slice = row * v->size[1];
    uint32_t from, to;
    const line l = line_of(grid, start, spacing, n, &from, &to);
    for (uint32_t k = from; k < to; k++) {
        const smr_vec at = smr_add(smr_load(l.first), smr_scale(smr_load(l.move), (float)(int32_t)k));
        const uint8_t *cell = (const uint8_t *)v->voxels + bytes * (size_t)(int32_t)at.x + row * (size_t)(int32_t)at.y +
                              slice * (size_t)(int32_t)at.z;
        __builtin_prefetch(cell);
        __builtin_prefetch(cell + row);
        __builtin_prefetch(cell + slice);
        __builtin_prefetch(cell + slice + row);
    }
}
