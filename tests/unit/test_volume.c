/* test_volume.c: samples of a volume against double precision, what counts as outside, and every refusal.
 * Voxels lie in heap memory of exactly their size, so that a sanitizer detects reads beside them.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "image/volume.h"

#define SAMPLES 40u

static const uint32_t bytes_of[] = {1, 1, 2, 2, 4};
static const float unit_axes[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};

static size_t count_of(const smr_volume *v) { return (size_t)v->size[0] * v->size[1] * v->size[2]; }

static void put(void *voxels, uint32_t type, size_t i, uint32_t *seed)
{
    const uint32_t bits = rig_random(seed, 65536u);
    switch (type) {
    case SMR_VOXEL_UINT8: ((uint8_t *)voxels)[i] = (uint8_t)(bits & 255u); break;
    case SMR_VOXEL_INT8: ((int8_t *)voxels)[i] = (int8_t)((int)(bits & 255u) - 128); break;
    case SMR_VOXEL_UINT16: ((uint16_t *)voxels)[i] = (uint16_t)bits; break;
    case SMR_VOXEL_INT16: ((int16_t *)voxels)[i] = (int16_t)((int)bits - 32768); break;
    default: ((float *)voxels)[i] = rig_between(seed, -1000.0f, 1000.0f); break;
    }
}

static double voxel(const smr_volume *v, size_t i)
{
    switch (v->type) {
    case SMR_VOXEL_UINT8: return ((const uint8_t *)v->voxels)[i];
    case SMR_VOXEL_INT8: return ((const int8_t *)v->voxels)[i];
    case SMR_VOXEL_UINT16: return ((const uint16_t *)v->voxels)[i];
    case SMR_VOXEL_INT16: return ((const int16_t *)v->voxels)[i];
    default: return (double)((const float *)v->voxels)[i];
    }
}

static double span_of(uint32_t type)
{
    return type <= SMR_VOXEL_INT8 ? 255.0 : type <= SMR_VOXEL_INT16 ? 65535.0 : 2000.0;
}

/* A volume of random voxels in a block of exactly their size; the caller frees it. */
static void *fill(smr_volume *v, uint32_t seed)
{
    void *voxels = malloc(count_of(v) * bytes_of[v->type]);
    assert_non_null(voxels);
    for (size_t i = 0; i < count_of(v); i++)
        put(voxels, v->type, i, &seed);
    v->voxels = voxels;
    return voxels;
}

static smr_volume shaped(uint32_t type, uint32_t x, uint32_t y, uint32_t z)
{
    smr_volume v;
    memset(&v, 0, sizeof v);
    v.type = type;
    v.size[0] = x;
    v.size[1] = y;
    v.size[2] = z;
    for (uint32_t a = 0; a < 3u; a++)
        v.spacing[a] = 1.0f;
    memcpy(v.direction, unit_axes, sizeof unit_axes);
    return v;
}

/* Index coordinates of a point, by Cramer's rule in double. */
static void index_of(const smr_volume *v, const double p[3], double index[3])
{
    double m[9], d[3], det = 1.0;
    for (uint32_t r = 0; r < 3u; r++) {
        d[r] = p[r] - (double)v->origin[r];
        for (uint32_t c = 0; c < 3u; c++)
            m[3u * r + c] = (double)v->direction[3u * r + c] * (double)v->spacing[c];
    }
    for (uint32_t c = 0; c < 4u; c++) {
        double k[9];
        memcpy(k, m, sizeof k);
        for (uint32_t r = 0; c > 0u && r < 3u; r++)
            k[3u * r + c - 1u] = d[r];
        const double is = k[0] * (k[4] * k[8] - k[5] * k[7]) - k[1] * (k[3] * k[8] - k[5] * k[6]) +
                          k[2] * (k[3] * k[7] - k[4] * k[6]);
        if (c == 0u)
            det = is;
        else
            index[c - 1u] = is / det;
    }
}

/* The trilinear value. Returns 1 inside, 0 outside, -1 too near to the border to tell. */
static int oracle(const smr_volume *v, const double p[3], double *value)
{
    const double unsure = 1.0e-3;
    double at[3], f[3];
    size_t low[3], high[3];
    int near = 0;
    index_of(v, p, at);
    for (uint32_t a = 0; a < 3u; a++) {
        const double lo = v->size[a] == 1u ? -0.5 : 0.0, hi = v->size[a] == 1u ? 0.5 : v->size[a] - 1.0;
        if (at[a] < lo - unsure || at[a] > hi + unsure)
            return 0;
        near |= at[a] < lo + unsure || at[a] > hi - unsure;
        const double clamped = v->size[a] == 1u ? 0.0 : fmin(fmax(at[a], 0.0), v->size[a] - 1.0);
        low[a] = (size_t)clamped;
        high[a] = low[a] + 1u < v->size[a] ? low[a] + 1u : low[a];
        f[a] = clamped - (double)low[a];
    }
    *value = 0.0;
    for (uint32_t c = 0; c < 8u; c++) {
        const size_t x = c & 1u ? high[0] : low[0], y = c & 2u ? high[1] : low[1], z = c & 4u ? high[2] : low[2];
        const double w = (c & 1u ? f[0] : 1.0 - f[0]) * (c & 2u ? f[1] : 1.0 - f[1]) * (c & 4u ? f[2] : 1.0 - f[2]);
        *value += w * voxel(v, x + v->size[0] * (y + v->size[1] * z));
    }
    return near ? -1 : 1;
}

/* Lines through and past the volume; returns how many samples were compared inside. */
static uint32_t compare(const smr_volume *v, uint32_t seed)
{
    smr_grid grid;
    uint32_t compared = 0;
    assert_int_equal(SMR_OK, smr_grid_open(v, &grid));
    for (uint32_t line = 0; line < 60u; line++) {
        double from[3] = {0, 0, 0}, move[3];
        float start[3], step[3], value[SAMPLES];
        unsigned char inside[SAMPLES];
        uint32_t count = 0;
        for (uint32_t a = 0; a < 3u; a++) { /* in index coordinates, from well outside to well outside */
            const float n = (float)v->size[a];
            const double p = (double)rig_between(&seed, -0.4f * n, 1.4f * n - 1.0f);
            const double q = (double)rig_between(&seed, -0.4f * n, 1.4f * n - 1.0f);
            from[a] = p;
            move[a] = (q - p) / SAMPLES;
        }
        for (uint32_t r = 0; r < 3u; r++) {
            double s = (double)v->origin[r], d = 0.0;
            for (uint32_t c = 0; c < 3u; c++) {
                const double axis = (double)v->direction[3u * r + c] * (double)v->spacing[c];
                s += axis * from[c];
                d += axis * move[c];
            }
            start[r] = (float)s;
            step[r] = (float)d;
        }
        const uint32_t n_inside = smr_grid_line(&grid, smr_load(start), smr_load(step), SAMPLES, value, inside);
        for (uint32_t k = 0; k < SAMPLES; k++) {
            double p[3], want = 0.0;
            for (uint32_t r = 0; r < 3u; r++)
                p[r] = (double)start[r] + k * (double)step[r];
            const int is = oracle(v, p, &want);
            count += inside[k];
            assert_true(inside[k] <= 1u && (is < 0 || is == (int)inside[k]));
            assert_true(inside[k] == 1u || value[k] == 0.0f);
            if (inside[k]) {
                assert_true(fabs(want - (double)value[k]) < 1.0e-3 * span_of(v->type));
                compared++;
            }
        }
        assert_int_equal(count, n_inside);
    }
    return compared;
}

TEST(test_values)
{
    static const uint32_t size[5][3] = {{5, 7, 6}, {2, 2, 2}, {1, 6, 4}, {9, 1, 1}, {1, 1, 1}};
    for (uint32_t type = 0; type <= SMR_VOXEL_FLOAT; type++) {
        for (uint32_t k = 0; k < 15u; k++) {
            const uint32_t *n = size[k % 5u];
            smr_volume v = shaped(type, n[0], n[1], n[2]);
            if (k >= 5u) { /* oblique and anisotropic */
                rig_rotation(1, -2, 0.5f, 37.0f, v.direction);
                v.spacing[0] = 0.4f;
                v.spacing[1] = 1.7f;
                v.spacing[2] = 3.0f;
                v.origin[0] = -31.5f;
                v.origin[1] = 20.25f;
                v.origin[2] = 77.0f;
            }
            for (uint32_t r = 0; k >= 10u && r < 3u; r++) /* a left-handed one */
                v.direction[3u * r] = -v.direction[3u * r];
            void *voxels = fill(&v, 5u + k);
            assert_true(compare(&v, 11u * k + type) > 100u);
            free(voxels);
        }
    }
}

/* Exactly on the first and the last voxel is inside; the next float is not. */
TEST(test_ends)
{
    smr_volume v = shaped(SMR_VOXEL_FLOAT, 4, 4, 4);
    float *voxels = fill(&v, 9);
    smr_grid grid;
    float value;
    unsigned char inside;
    assert_int_equal(SMR_OK, smr_grid_open(&v, &grid));
    for (uint32_t c = 0; c < 8u; c++) {
        const float x = c & 1u ? 3.0f : 0.0f, y = c & 2u ? 3.0f : 0.0f, z = c & 4u ? 3.0f : 0.0f;
        assert_int_equal(1, smr_grid_line(&grid, smr_v(x, y, z), smr_v(0, 0, 0), 1, &value, &inside));
        assert_true(fabsf(value - voxels[(uint32_t)x + 4u * (uint32_t)y + 16u * (uint32_t)z]) < 1.0e-3f);
        const float out = nextafterf(x, c & 1u ? 10.0f : -10.0f);
        assert_int_equal(0, smr_grid_line(&grid, smr_v(out, y, z), smr_v(0, 0, 0), 1, &value, &inside));
        assert_true(value == 0.0f && inside == 0u);
    }
    static const float wild[] = {1.0e30f, -1.0e30f, (float)INFINITY, (float)NAN};
    for (uint32_t k = 0; k < 4u; k++) {
        assert_int_equal(0, smr_grid_line(&grid, smr_v(1, wild[k], 1), smr_v(0, 0, 0), 1, &value, &inside));
        assert_int_equal(0, inside);
    }
    free(voxels);
}

static int around(const float at[3], const uint32_t hole[3], const uint32_t size[3])
{
    for (uint32_t a = 0; a < 3u; a++) {
        const uint32_t low = (uint32_t)at[a] < size[a] - 1u ? (uint32_t)at[a] : size[a] - 2u;
        if (hole[a] != low && hole[a] != low + 1u)
            return 0;
    }
    return 1;
}

/* One voxel that the mask takes out, or that is no number, or no sensible one: the eight cells about it are
 * outside. */
TEST(test_holes)
{
    static const float bad[] = {(float)NAN, (float)INFINITY, -(float)INFINITY, 3.0e38f, -3.0e38f};
    static const uint32_t hole[3] = {2, 1, 3};
    for (uint32_t k = 0; k < 6u; k++) {
        smr_volume v = shaped(SMR_VOXEL_FLOAT, 5, 4, 6);
        float *voxels = fill(&v, 21);
        uint8_t *mask = malloc(count_of(&v));
        uint32_t seed = k, held = 0;
        const size_t at = hole[0] + 5u * (hole[1] + 4u * (size_t)hole[2]);
        smr_grid grid;
        assert_non_null(mask);
        memset(mask, 1 + (int)k, count_of(&v));
        if (k < 5u)
            voxels[at] = bad[k];
        else
            mask[at] = 0;
        v.mask = k == 5u || k == 1u ? mask : NULL;
        assert_int_equal(SMR_OK, smr_grid_open(&v, &grid));
        for (uint32_t i = 0; i < 2000u; i++) {
            float p[3];
            rig_within(&seed, 0, 1, p);
            for (uint32_t a = 0; a < 3u; a++)
                p[a] = 0.01f + p[a] * ((float)v.size[a] - 1.02f);
            float value;
            unsigned char inside;
            const uint32_t got = smr_grid_line(&grid, smr_load(p), smr_v(0, 0, 0), 1, &value, &inside);
            assert_int_equal(!around(p, hole, v.size), got);
            assert_int_equal(got, inside);
            assert_true(got == 1u ? fabsf(value) <= 1000.01f : value == 0.0f);
            held += 1u - got;
        }
        assert_true(held > 50u);
        free(mask);
        free(voxels);
    }
}

TEST(test_refusals)
{
    static const float worse[] = {0.0f, -1.0f, (float)NAN, (float)INFINITY, 2.0e5f};
    smr_volume good = shaped(SMR_VOXEL_FLOAT, 2, 2, 2), v;
    void *voxels = fill(&good, 1);
    smr_grid grid, before;
    memset(&grid, 7, sizeof grid);
    before = grid;
    assert_int_equal(SMR_E_NULL, smr_grid_open(NULL, &grid));
    v = good;
    v.voxels = NULL;
    assert_int_equal(SMR_E_NULL, smr_grid_open(&v, &grid));
    static const uint32_t types[] = {5, 6, 0x80000000u, 0xffffffffu};
    for (uint32_t k = 0; k < 4u; k++) {
        v = good;
        v.type = types[k];
        assert_int_equal(SMR_E_INPUT, smr_grid_open(&v, &grid));
    }
    for (uint32_t type = 0; type <= SMR_VOXEL_FLOAT; type++) {
        for (uint32_t off = 1; off < 4u; off++) {
            v = good;
            v.type = type;
            v.voxels = (const char *)voxels + off;
            const int want = off % bytes_of[type] == 0u ? SMR_OK : SMR_E_INPUT;
            smr_grid other;
            assert_int_equal(want, smr_grid_open(&v, &other));
        }
    }
    for (uint32_t a = 0; a < 3u; a++) {
        static const uint32_t sizes[] = {0, 65537, 0xffffffffu};
        for (uint32_t k = 0; k < 3u; k++) {
            v = good;
            v.size[a] = sizes[k];
            assert_int_equal(SMR_E_INPUT, smr_grid_open(&v, &grid));
        }
        for (uint32_t k = 0; k < 5u; k++) {
            v = good;
            v.spacing[a] = worse[k];
            assert_int_equal(SMR_E_INPUT, smr_grid_open(&v, &grid));
            v = good;
            v.origin[a] = worse[k];
            assert_int_equal(k < 2u, smr_grid_open(&v, k < 2u ? &(smr_grid){0} : &grid) == SMR_OK);
        }
    }
    assert_memory_equal(&before, &grid, sizeof grid);
    free(voxels);
}

TEST(test_refused_shapes)
{
    smr_volume good = shaped(SMR_VOXEL_FLOAT, 2, 2, 2), v;
    void *voxels = fill(&good, 1);
    smr_grid grid, before;
    memset(&grid, 7, sizeof grid);
    before = grid;
    for (uint32_t i = 0; i < 9u; i++) {
        v = good;
        v.direction[i] = (float)NAN;
        assert_int_equal(SMR_E_INPUT, smr_grid_open(&v, &grid));
        v.direction[i] = -(float)INFINITY;
        assert_int_equal(SMR_E_INPUT, smr_grid_open(&v, &grid));
    }
    static const float singular[4][9] = {
        {0}, {1, 1, 0, 0, 0, 0, 0, 0, 1}, {1, 0, 0, 0, 1, 0, 0, 0, 0}, {0.6f, 0.6f, 0, 0.8f, 0.8f, 0, 0, 0, 1}};
    for (uint32_t k = 0; k < 4u; k++) {
        v = good;
        memcpy(v.direction, singular[k], sizeof v.direction);
        assert_int_equal(SMR_E_INPUT, smr_grid_open(&v, &grid));
    }
    for (uint32_t a = 0; a < 3u;
         a++) { /* an axis that is no unit vector, such as one with the spacing in it; rounding is none */
        static const float lengths[] = {1.5f, 0.5f, 0.9f, 1.0e-13f, 2.0e19f};
        for (uint32_t k = 0; k < 5u; k++) {
            v = good;
            v.direction[4u * a] = lengths[k];
            assert_int_equal(SMR_E_INPUT, smr_grid_open(&v, &grid));
        }
        v.direction[4u * a] = 0.9999f;
        assert_int_equal(SMR_OK, smr_grid_open(&v, &(smr_grid){0}));
    }
    v = good; /* more voxels than any memory holds */
    v.size[0] = v.size[1] = v.size[2] = 65536;
    assert_int_equal(SMR_E_INPUT, smr_grid_open(&v, &grid));
    v.size[0] = 16384; /* 2^40 voxels are the most */
    v.size[1] = 8192;
    v.size[2] = 8193;
    assert_int_equal(SMR_E_INPUT, smr_grid_open(&v, &grid));
    v.size[2] = 8192;
    assert_int_equal(SMR_OK, smr_grid_open(&v, &(smr_grid){0}));
    assert_memory_equal(&before, &grid, sizeof grid);
    v.size[1] = v.size[2] = 1; /* the longest axis is accepted; nothing is read before a sample is asked for */
    assert_int_equal(SMR_OK, smr_grid_open(&v, &grid));
    free(voxels);
}
