/* test_tangential_shift.c: a profile taken a little to the side is found again by a shift along the surface; without
 * contrast along the surface the shift is zero.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include <string.h>
#include "image/tangential_shift.h"

#define SIDE 40u     /* voxels */
#define SPACING 1.0f /* mm */
#define N 20u
#define STEP 0.5f
#define REACH 1.5f

typedef enum pattern { WAVES, LAYERS, PLAIN } pattern;

/* Waves of some 20 mm in all directions, layers along z, or one value. */
static double value_at(pattern kind, double x, double y, double z)
{
    switch (kind) {
    case WAVES:
        return 100.0 + 40.0 * sin(0.31 * x + 0.2) + 40.0 * cos(0.27 * y - 0.05 * z) + 30.0 * sin(0.23 * z + 0.1 * x);
    case LAYERS: return 100.0 + 50.0 * tanh(0.4 * z);
    default: return 100.0;
    }
}

static smr_grid image(pattern kind)
{
    smr_grid grid;
    float *voxels;
    const smr_volume v = rig_cube(SIDE, SPACING, &voxels);
    for (uint32_t i = 0; i < SIDE * SIDE * SIDE; i++) {
        const uint32_t at[3] = {i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE};
        voxels[i] = (float)value_at(kind, (double)(v.origin[0] + SPACING * (float)at[0]),
                                    (double)(v.origin[1] + SPACING * (float)at[1]),
                                    (double)(v.origin[2] + SPACING * (float)at[2]));
    }
    assert_int_equal(SMR_OK, smr_grid_open(&v, &grid));
    return grid;
}

/* What a profile of the image says that was taken `beside` the line on which it is looked for now. */
typedef struct trial {
    smr_vec middle, normal, beside;
    float noise, gain, brighter; /* the image's contrast and brightness against the profile's, 1 and 0: the same */
} trial;

static smr_vec found_way(const smr_grid *grid, const trial *t)
{
    uint8_t packed[N];
    float value[N], here[N], low = 0.0f, range = 0.0f;
    unsigned char inside[N];
    const smr_vec step = smr_scale(t->normal, STEP), start = smr_sub(t->middle, smr_scale(step, 0.5f * (float)N));
    assert_int_equal(N, smr_grid_line(grid, smr_add(start, t->beside), step, N, value, inside));
    smr_profile_pack(value, inside, N, packed, &low, &range);
    assert_int_equal(N, smr_grid_line(grid, start, step, N, here, inside));
    for (uint32_t k = 0; k < N; k++)
        here[k] = t->gain * here[k] + t->brighter;
    const smr_profile reference = {packed, low, range, N};
    smr_centred both;
    const smr_place place = {&reference, start, step, t->normal, &both, t->gain, t->noise, REACH};
    if (range > 0.0f)
        smr_centre(&reference, here, &both);
    return smr_tangential_shift(grid, &place);
}

static float length(smr_vec a) { return sqrtf(smr_dot(a, a)); }

static smr_vec any_normal(uint32_t *seed)
{
    float n[3];
    rig_within(seed, -1, 1, n);
    n[2] = 0.6f + 0.4f * n[2];
    return smr_scale(smr_load(n), 1.0f / length(smr_load(n)));
}

/* A step of up to 1 mm is found again except for a part of it: the search is one linear step, slightly damped, on
 * profiles without their means. */
TEST(test_finds_the_side)
{
    const smr_grid grid = image(WAVES);
    uint32_t seed = 4;
    double missed = 0.0;
    for (uint32_t k = 0; k < 300u; k++) {
        float place[3], aside[3];
        rig_within(&seed, -5, 5, place);
        rig_within(&seed, -1, 1, aside);
        trial t = {smr_load(place), any_normal(&seed), {0, 0, 0}, 0.1f, 1.0f, 0.0f};
        const smr_vec side = smr_load(aside);
        t.beside = smr_scale(smr_sub(side, smr_scale(t.normal, smr_dot(side, t.normal))), 0.6f);
        const smr_vec way = found_way(&grid, &t);
        assert_true(fabsf(smr_dot(way, t.normal)) < 1.0e-4f);
        assert_true(length(way) <= REACH + 1.0e-4f);
        missed += (double)(length(smr_sub(way, t.beside)) / length(t.beside));
        t.noise = 1.0e4f; /* next to which the image shows nothing */
        assert_true(length(found_way(&grid, &t)) < 1.0e-3f);
    }
    if (!(missed / 300.0 < 0.45))
        fail_msg("%.3f of the way missed in the mean", missed / 300.0);
}

/* Where the profile is, nothing moves; where the image does not change across the normal, neither. */
TEST(test_stays)
{
    const smr_grid waves = image(WAVES), layers = image(LAYERS), plain = image(PLAIN);
    trial t = {{1, 2, 0}, {0, 0, 1}, {0, 0, 0}, 0.1f, 1.0f, 0.0f};
    assert_true(length(found_way(&waves, &t)) < 0.05f);
    t.beside = smr_v(0.7f, -0.4f, 0.0f);
    assert_true(length(found_way(&waves, &t)) > 0.3f);
    assert_true(length(found_way(&layers, &t)) < 1.0e-3f);
    assert_true(length(found_way(&plain, &t)) == 0.0f); /* the profile has no range */
}

/* Brightness changes nothing. At the right place more contrast moves nothing. Values that no image has give a step
 * within reach. */
TEST(test_brightness)
{
    const smr_grid grid = image(WAVES);
    trial t = {{1, 2, 0}, {0, 0, 1}, {0.6f, 0.5f, 0.0f}, 0.1f, 1.0f, 0.0f};
    const smr_vec way = found_way(&grid, &t);
    t.brighter = 1.0e3f;
    assert_true(length(smr_sub(found_way(&grid, &t), way)) < 1.0e-3f);
    t.gain = 50.0f; /* the slopes beside it are the image's own: far more is missing than they can bring */
    assert_true(fabsf(length(found_way(&grid, &t)) - REACH) < 1.0e-3f);
    t.beside = smr_v(0, 0, 0);
    t.gain = 1.5f;
    assert_true(length(found_way(&grid, &t)) < 0.1f);
    t.brighter = 1.0e30f; /* no image's value: finite all the same */
    assert_true(length(found_way(&grid, &t)) <= REACH + 1.0e-4f);
    t.brighter = HUGE_VALF;
    assert_true(length(found_way(&grid, &t)) <= REACH + 1.0e-4f);
}

/* The contrast of a profile that is stretched, wherever it lies in brightness. */
TEST(test_contrast)
{
    const uint8_t packed[4] = {0, 100, 255, 30};
    const smr_profile reference = {packed, 10.0f, 51.0f, 4};
    float found[4];
    smr_centred both;
    for (uint32_t k = 0; k < 6u; k++) {
        static const float gain[6] = {0.0f, 0.3f, 1.0f, 1.5f, 3.9f, 60.0f};
        for (uint32_t i = 0; i < 4u; i++)
            found[i] = 300.0f - gain[k] * 51.0f * (float)packed[i] / 255.0f; /* its sign does not count */
        smr_centre(&reference, found, &both);
        assert_true(fabsf(smr_contrast(&both, 4) - fminf(gain[k], 4.0f)) < 1.0e-3f);
    }
    found[2] = HUGE_VALF;
    smr_centre(&reference, found, &both);
    assert_true(smr_contrast(&both, 4) >= 0.0f && smr_contrast(&both, 4) <= 4.0f);
}

/* Lines of which a part lies outside tell nothing. */
TEST(test_outside)
{
    const smr_grid grid = image(WAVES);
    trial t = {{0, 0, 0}, {0, 0, 1}, {-1, 0, 0}, 0.1f, 1.0f, 0.0f};
    t.middle.x = 19.0f; /* the last voxel is at 19.5 mm */
    assert_true(length(found_way(&grid, &t)) == 0.0f);
    t.middle.x = 17.5f;
    assert_true(length(found_way(&grid, &t)) > 0.0f);
}
