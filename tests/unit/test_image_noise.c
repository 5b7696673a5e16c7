/* test_image_noise.c: the noise of an image is measured, its samples are averaged, and a ball in it is found.
 * SPDX-License-Identifier: MIT */
#include "suite.h"

#include <math.h>
#include <string.h>

#include "property/rig_ball_image.h"
#include "registration/registration.h"

#define SIDE 36u

/* Intensities rise by 3 a voxel in x and fall by 5 in z. Noise between -a and a has the deviation a / sqrt(3). */
static smr_volume slope(uint32_t long_axis, float a)
{
    float *voxels;
    uint32_t seed = 7;
    smr_volume v = rig_cube(SIDE, 1.0f, &voxels);
    v.spacing[long_axis] = 3.0f;
    v.origin[long_axis] *= 3.0f;
    for (uint32_t i = 0; i < SIDE * SIDE * SIDE; i++)
        voxels[i] = 400.0f + 3.0f * (float)(i % SIDE) - 5.0f * (float)(i / SIDE / SIDE) + rig_between(&seed, -a, a);
    return v;
}

TEST(test_noise_level)
{
    static const float all[] = {0.0f, 3.0f, 60.0f};
    smr_grid grid;
    for (uint32_t i = 0; i < 9u; i++) {
        const smr_volume v = slope(i / 3u, all[i % 3u]);
        assert_int_equal(SMR_OK, smr_grid_open(&v, &grid));
        const float noise = smr_grid_noise(&grid), truth = all[i % 3u] / 1.732f;
        if (!(noise >= 0.9f * truth && noise <= 1.1f * truth + 1.0e-3f))
            fail_msg("noise %g measured as %g", (double)truth, (double)noise);
    }
    smr_volume none = slope(2, 60.0f); /* two slices, or one, do: the mask lies in a slice */
    for (none.size[2] = 2; none.size[2] > 0u; none.size[2]--) {
        assert_int_equal(SMR_OK, smr_grid_open(&none, &grid));
        assert_true(fabsf(smr_grid_noise(&grid) - 60.0f / 1.732f) < 4.0f);
    }
    none = slope(0, 9.0f); /* too thin; then no place without NaN */
    none.size[2] = none.size[1] = 2;
    assert_int_equal(SMR_OK, smr_grid_open(&none, &grid));
    assert_true(!(smr_grid_noise(&grid) > 0.0f));
    float *voxels;
    none = rig_cube(SIDE, 1.0f, &voxels);
    for (uint32_t i = 0; i < SIDE * SIDE * SIDE; i++)
        voxels[i] = i % 3u > 0u ? (float)i : (float)NAN;
    assert_int_equal(SMR_OK, smr_grid_open(&none, &grid));
    assert_true(!(smr_grid_noise(&grid) > 0.0f));
    for (uint32_t i = 0; i < SIDE * SIDE * SIDE; i++) /* all places alike, below their mean, which is rounded up */
        voxels[i] = i % 3u == 0u && i / SIDE % 3u == 0u ? 4123.0f : 0.0f;
    assert_true(smr_grid_noise(&grid) == 0.0f);
}

/* The median of as many zeros as others is one of the others: noise in half of the bright places is seen. */
TEST(test_noise_in_half_of_the_places)
{
    float *voxels;
    smr_grid grid;
    const smr_volume v = rig_cube(18, 1.0f, &voxels); /* places: slices 1..16 of x and y from 0..15 on, three each */
    for (uint32_t i = 0; i < 18u * 18u * 18u; i++) {
        const uint32_t z = i / (18u * 18u), even = (i + i / 18u) % 2u;
        voxels[i] = z > 8u ? 0.0f : z > 4u ? 1000.0f : even ? 1001.0f : 999.0f;
    }
    assert_int_equal(SMR_OK, smr_grid_open(&v, &grid));
    assert_float_equal(16.0f / 4.05f, smr_grid_noise(&grid), 0.05f);
}

/* Means over samples are nearer to the slope than the line's own samples, the more the higher the noise, and on few
 * lines less so. */
TEST(test_thick_line)
{
    const smr_volume v = slope(2, 60.0f);
    smr_grid grid;
    double off[4] = {0.0, 0.0, 0.0, 0.0};
    uint32_t n = 0, seed = 3;
    assert_int_equal(SMR_OK, smr_grid_open(&v, &grid));
    for (uint32_t i = 0; i < 60u; i++) {
        float value[4][64];
        uint8_t inside[4][64];
        const smr_vec at = smr_v(rig_between(&seed, -16, 16), rig_between(&seed, -16, 16), rig_between(&seed, -48, 48));
        const smr_vec way = smr_v(rig_between(&seed, -1, 1), rig_between(&seed, -1, 1), i < 9u ? 0.0f : 0.5f);
        const smr_vec step = smr_scale(way, 0.5f / smr_length(way));
        const uint32_t count = smr_grid_line(&grid, at, step, 64, value[0], inside[0]);
        assert_int_equal(count, smr_grid_thick_line(&grid, 1.0f, 0, at, step, 64, value[1], inside[1]));
        assert_int_equal(count, smr_grid_thick_line(&grid, 4.0f, 0, at, step, 64, value[2], inside[2]));
        assert_int_equal(count, smr_grid_thick_line(&grid, 4.0f, 1, at, step, 64, value[3], inside[3]));
        for (uint32_t j = 1; j < 4u; j++)
            assert_memory_equal(inside[0], inside[j], sizeof inside[0]);
        for (uint32_t k = 0; k < count; k++, n++)
            for (uint32_t j = 0; j < 4u; j++) {
                const smr_vec p = smr_sub(smr_add(at, smr_scale(step, (float)k)), smr_load(v.origin));
                const double truth = 400.0 + 3.0 * (double)p.x - 5.0 / 3.0 * (double)p.z;
                off[j] += ((double)value[j][k] - truth) * ((double)value[j][k] - truth);
            }
    }
    for (uint32_t j = 0; j < 4u; j++)
        off[j] = sqrt(off[j] / n);
    if (!(n > 1000u && off[1] < 0.6 * off[0] && off[2] < 0.85 * off[1] && off[3] > 1.1 * off[2]))
        fail_msg("%u samples, off by %g %g %g %g", n, off[0], off[1], off[2], off[3]);
}

/* An image whose axes are stored in another order has the same samples: which axis is the longest voxels' is found. */
TEST(test_thick_line_in_any_order_of_axes)
{
    static const uint32_t stride[3] = {1, SIDE, SIDE * SIDE};
    const smr_volume v = slope(0, 60.0f);
    for (uint32_t turn = 1; turn < 3u; turn++) {
        float *voxels, value[2][64];
        uint8_t inside[2][64];
        smr_grid grid[2];
        smr_volume w = rig_cube(SIDE, 1.0f, &voxels);
        for (uint32_t i = 0; i < SIDE * SIDE * SIDE; i++)
            voxels[i % SIDE * stride[turn] + i / SIDE % SIDE * stride[(turn + 1u) % 3u] +
                   i / SIDE / SIDE * stride[(turn + 2u) % 3u]] = ((const float *)v.voxels)[i];
        memcpy(w.origin, v.origin, sizeof w.origin);
        for (uint32_t i = 0; i < 9u; i++) {
            w.spacing[(i + turn) % 3u] = v.spacing[i % 3u];
            w.direction[i / 3u * 3u + (i + turn) % 3u] = v.direction[i];
        }
        assert_true(smr_grid_open(&v, &grid[0]) == SMR_OK && smr_grid_open(&w, &grid[1]) == SMR_OK);
        for (uint32_t k = 0; k < 2u; k++)
            assert_int_equal(64, smr_grid_thick_line(&grid[k], 4.0f, 0, smr_v(-9, -5, -7), smr_v(0.2f, 0.1f, 0.3f), 64,
                                                     value[k], inside[k]));
        for (uint32_t i = 0; i < 64u; i++)
            assert_float_equal(value[0][i], value[1][i], 0.01f);
    }
}

/* Noise of a deviation of 0.29 times the contrast; a restored registration measures it again. */
TEST(test_ball_in_noise)
{
    const smr_volume reference = rig_ball_image(RIG_BALL_MM, rig_nowhere),
                     target = rig_ball_image(RIG_BALL_MM + 2.0f, rig_shift);
    const smr_model *model = rig_ball_model(&reference);
    const smr_config config = smr_config_default_image();
    float *const voxels = rig_alloc(RIG_BALL_SIDE * RIG_BALL_SIDE * RIG_BALL_SIDE * sizeof *voxels);
    smr_volume noisy = target;
    uint32_t seed = 11;
    double sum = 0.0;
    for (uint32_t i = 0; i < RIG_BALL_SIDE * RIG_BALL_SIDE * RIG_BALL_SIDE; i++)
        voxels[i] = ((const float *)target.voxels)[i] + rig_between(&seed, -400.0f, 400.0f);
    noisy.voxels = voxels;
    smr *const s = rig_init(model, &config, NULL);
    assert_int_equal(SMR_OK, smr_set_volume(s, &noisy));
    (void)rig_run(s, 20);
    smr *const again = rig_restored(s, model, &config);
    assert_non_null(again);
    assert_int_equal(SMR_OK, smr_set_volume(again, &noisy));
    assert_true(rig_run(s, 10000).state_hash == rig_run(again, 10000).state_hash);
    const float *const x = rig_positions(s, model);
    for (uint32_t v = 0; v < s->shared.n; v++)
        sum += fabs((double)smr_length(smr_sub(smr_load(x + 3u * v), smr_load(rig_shift))) - (double)RIG_BALL_MM - 2.0);
    if (!(sum / s->shared.n < 0.35))
        fail_msg("%g mm off in the mean", sum / s->shared.n);
}

/* Before the last radius more vertices are active the more noise there is, up to four times; not where one image
 * follows the other, for there budgets take fewer after the search. */
TEST(test_more_in_noise)
{
    static const float noise[] = {0.5f, 2.0f, 3.0f, 9.0f}, more[] = {1.0f, 1.0f, 2.25f, 4.0f};
    const smr_volume reference = rig_ball_image(RIG_BALL_MM, rig_nowhere);
    const smr_config config = smr_config_default_image();
    smr *const s = rig_init(rig_ball_model(&reference), &config, NULL);
    smr_image_goals *const g = &s->forces.image;
    assert_int_equal(SMR_OK, smr_set_volume(s, &reference));
    for (uint32_t i = 0; i < 4u; i++) {
        g->noise = noise[i] * g->noise_level;
        assert_float_equal(more[i], smr_image_more(g), 1.0e-3f);
        s->schedule.tracking = 1;
        assert_float_equal(1.0f, smr_image_more(g), 0.0f);
        s->schedule.tracking = 0;
    }
    s->schedule.radius = smr_last_radius(&s->shared);
    assert_float_equal(1.0f, smr_image_more(g), 0.0f);
}

/* In much noise goals come from means over many lines up to the first quarter of the active vertices, and over few
 * lines behind it. */
TEST(test_few_lines_behind_the_first_vertices)
{
    const smr_volume reference = rig_ball_image(RIG_BALL_MM, rig_nowhere);
    smr_config config = smr_config_default_image();
    config.image.rest = 0;
    smr *const s = rig_init(rig_ball_model(&reference), &config, NULL);
    smr_image_goals *const g = &s->forces.image;
    uint32_t differ = 0;
    assert_int_equal(SMR_OK, smr_set_volume(s, &reference));
    (void)rig_run(s, 1);
    g->noise = 9.0f * g->noise_level;
    for (uint32_t v = 1; v < s->shared.n / 8u; v++) {
        const uint32_t active[4] = {v + 1u, 4u * v, 4u * v + 1u, 8u * v};
        smr_vec d[4] = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
        for (uint32_t i = 0; i < 4u; i++) {
            s->schedule.n_active = active[i];
            (void)g->calls->goal(g, v, &d[i]);
        }
        assert_true(memcmp(&d[0], &d[1], sizeof d[0]) == 0 && memcmp(&d[2], &d[3], sizeof d[2]) == 0);
        differ += memcmp(&d[1], &d[2], sizeof d[1]) != 0;
    }
    assert_true(differ > s->shared.n / 16u);
}
