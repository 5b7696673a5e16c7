/* test_fill_unseen.c: vertices that the image does not show shrink towards their neighbours; where the image is
 * undecided they stay.
 * SPDX-License-Identifier: MIT */
#include "cmocka_first.h"

#include <math.h>
#include <string.h>

#include "property/rig.h"
#include "registration/tick/coarse_to_fine_schedule.h"

#define SIDE 60u     /* voxels of 2 mm */
#define RADIUS 30.0f /* mm */

static const float none[3] = {0, 0, 0};

static int tidy(void **state)
{
    (void)state;
    rig_free_all();
    return 0;
}

/* A ball (1), a texture unlike its surface (0), one value (2), or the ball's lower part below that texture (3).
 * The image ends above z = top. */
static smr_volume image(int ball, float top)
{
    float *voxels;
    const smr_volume v = rig_cube(SIDE, 2.0f, &voxels);
    for (uint32_t i = 0; i < SIDE * SIDE * SIDE; i++) {
        const float x = v.origin[0] + 2.0f * (float)(i % SIDE), y = v.origin[1] + 2.0f * (float)(i / SIDE % SIDE);
        const float z = v.origin[2] + 2.0f * (float)(i / SIDE / SIDE);
        const double r = sqrt((double)(x * x + y * y + z * z));
        const int shown = ball == 1 || (ball == 3 && z < 8.0f);
        voxels[i] = shown ? (float)(500.0 + 400.0 * tanh(((double)RADIUS - r) / 2.0)) : 100.0f;
        if (!shown && ball != 2 && i % 7u == 3u)
            voxels[i] = 103.0f;
        if (z > top)
            voxels[i] = NAN;
    }
    return v;
}

static double mean_radius(const smr *s, const smr_model *model)
{
    const float *x = rig_positions(s, model);
    double sum = 0.0;
    for (uint32_t i = 0; i < s->shared.n; i++)
        sum +=
            sqrt((double)(x[3u * i] * x[3u * i] + x[3u * i + 1u] * x[3u * i + 1u] + x[3u * i + 2u] * x[3u * i + 2u]));
    return sum / s->shared.n;
}

/* The ball's mean radius after `ticks` iterations on a target. */
static double after(const smr_volume *target, float smoothing, uint32_t ticks)
{
    const smr_volume reference = image(1, 1.0e6f);
    const smr_mesh mesh = rig_ball(RADIUS, 13, 20, none);
    smr_prepare_config p = rig_radii(2, 20, 10, 0);
    smr_config c = smr_config_default();
    p.reference = &reference;
    c.image.fill = smoothing;
    const smr_model *model = rig_model(&mesh, 1, &p);
    smr *s = rig_init(model, &c, NULL);
    assert_int_equal(SMR_OK, smr_set_volume(s, target));
    (void)rig_run(s, ticks);
    assert_true(rig_finite(rig_positions(s, model), s->shared.n));
    return mean_radius(s, model);
}

static void test_missing_shrinks(void **state)
{
    const smr_volume part = image(3, 1.0e6f);
    (void)state;
    const double unsmoothed = after(&part, 0.0f, 8), half = after(&part, 0.5f, 8), whole = after(&part, 1.0f, 8);
    assert_true(fabs(unsmoothed - (double)RADIUS) < 1.5);
    assert_true(half < unsmoothed - 0.1);
    assert_true(whole < half - 0.1);
    assert_true(whole > 0.7 * (double)RADIUS);
}

/* A structure that is not there at all stays: nothing says where to shrink to. */
static void test_absent_stays(void **state)
{
    const smr_volume nothing = image(0, 1.0e6f);
    (void)state;
    assert_true(fabs(after(&nothing, 1.0f, 10000) - (double)RADIUS) < 0.01);
}

static void test_seen_stays(void **state)
{
    const smr_volume ball = image(1, 1.0e6f);
    (void)state;
    const double r = after(&ball, 1.0f, 10000);
    assert_true(fabs(r - (double)RADIUS) < 0.1);
}

/* One value everywhere says nothing either. */
static void test_constant_stays(void **state)
{
    const smr_volume nothing = image(2, 1.0e6f);
    (void)state;
    assert_true(fabs(after(&nothing, 1.0f, 20) - (double)RADIUS) < 0.01);
}

/* Where the image ends it says nothing: no goal, and no smoothing either. */
static void test_unseen_stays(void **state)
{
    const smr_volume dark = image(0, -1.0e6f);
    (void)state;
    assert_true(fabs(after(&dark, 1.0f, 20) - (double)RADIUS) < 0.01);
}

/* Who does not search has not seen either. */
static void test_no_search_stays(void **state)
{
    const smr_volume reference = image(1, 1.0e6f), nothing = image(0, 1.0e6f);
    const smr_mesh mesh = rig_ball(RADIUS, 13, 20, none);
    smr_prepare_config p = rig_radii(2, 20, 10, 0);
    smr_config c = smr_config_default();
    (void)state;
    p.reference = &reference;
    c.image.profile_mm = c.image.profile_end_mm = c.image.gradient_mm = c.image.gradient_end_mm = 0.0f;
    const smr_model *model = rig_model(&mesh, 1, &p);
    smr *s = rig_init(model, &c, NULL);
    assert_int_equal(SMR_OK, smr_set_volume(s, &nothing));
    (void)rig_run(s, 10000);
    assert_true(fabs(mean_radius(s, model) - (double)RADIUS) < 0.01);
}

static void test_range(void **state)
{
    const smr_volume reference = image(1, 1.0e6f);
    const smr_mesh mesh = rig_ball(RADIUS, 13, 20, none);
    smr_prepare_config p = rig_radii(1, 20, 0, 0);
    smr_config c = smr_config_default();
    size_t bytes = 0;
    (void)state;
    p.reference = &reference;
    const smr_model *model = rig_model(&mesh, 1, &p);
    static const float bad[] = {-0.1f, 1.1f, NAN};
    for (uint32_t i = 0; i < 3u; i++) {
        c.image.fill = bad[i];
        assert_int_equal(SMR_E_CONFIG, smr_arena_bytes(model, &c, &bytes));
    }
    c.image.fill = 0.0f;
    assert_int_equal(SMR_OK, smr_arena_bytes(model, &c, &bytes));
}

/* How far profiles are sought: farther than half a radius where few of those that look have a goal. */
static float reach(uint32_t seen, uint32_t missing, uint32_t blind, float flat)
{
    const smr_volume reference = image(1, 1.0e6f);
    const smr_mesh mesh = rig_ball(RADIUS, 13, 20, none);
    smr_prepare_config p = rig_radii(2, 20, 10, 0);
    const smr_config c = smr_config_default_image();
    p.reference = &reference;
    smr *s = rig_init(rig_model(&mesh, 1, &p), &c, NULL);
    assert_int_equal(SMR_OK, smr_set_volume(s, &reference));
    assert_true(seen + missing + blind <= s->shared.n);
    for (uint32_t v = 0; v < s->shared.n; v++)
        smr_at3(s->shape.x, v)[2] *= flat;
    for (uint32_t v = 0; v < s->shared.n; v++)
        s->forces.found_last[v] = (uint8_t)(v < seen ? 1 : v < seen + missing ? 2 : v < seen + missing + blind ? 3 : 0);
    smr_schedule_begin(s);
    smr_fill_sum(&s->forces.image, 0, 0);
    assert_true(s->schedule.profile_mm == 10.0f); /* half a radius */
    return smr_max(s->schedule.profile_mm, s->forces.image.structure[0].wide_mm);
}

static void test_lost_looks_farther(void **state)
{
    (void)state;
    assert_true(reach(0, 0, 0, 1) == 10.0f);
    assert_true(reach(100, 0, 0, 1) == 10.0f);
    assert_true(reach(90, 10, 0, 1) == 10.0f);
    assert_true(reach(65, 35, 0, 1) > 12.0f && reach(65, 35, 0, 1) < 18.0f);
    assert_true(reach(40, 60, 0, 1) == 20.0f);                 /* a whole one */
    assert_true(fabsf(reach(40, 60, 0, 0.4f) - 12.0f) < 0.5f); /* half of what is 24 mm thick */
    assert_true(reach(40, 5, 100, 1) == 10.0f);                /* who cannot see is not lost */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_teardown(test_missing_shrinks, tidy), cmocka_unit_test_teardown(test_absent_stays, tidy),
        cmocka_unit_test_teardown(test_seen_stays, tidy),      cmocka_unit_test_teardown(test_lost_looks_farther, tidy),
        cmocka_unit_test_teardown(test_constant_stays, tidy),  cmocka_unit_test_teardown(test_unseen_stays, tidy),
        cmocka_unit_test_teardown(test_no_search_stays, tidy), cmocka_unit_test_teardown(test_range, tidy),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
