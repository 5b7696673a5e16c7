/* test_edge_values.c: values at which the core's small functions refuse, or take a way of their own, one at a time.
 * SPDX-License-Identifier: MIT */
#include "suite.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "geometry/linear_solve/eigen_jacobi.h"
#include "geometry/rotation/rotation.h"
#include "image/intensity_profile.h"
#include "image/tangential_shift.h"
#include "registration/surface_goals/closest_point_goals.h"

TEST(sides_of_the_box)
{
    smr_config c = smr_config_default();
    static const float most[3] = {10, 20, 30};
    c.forces.use_box = 1;
    for (uint32_t a = 0; a < 3u; a++) {
        c.forces.box_min[a] = -most[a];
        c.forces.box_max[a] = most[a];
    }
    assert_int_equal(0, smr_reject_outside(&c, smr_v(10, -20, 30)));
    for (uint32_t side = 0; side < 6u; side++) {
        float p[3] = {1, 2, 3};
        p[side % 3u] = most[side % 3u] * (side < 3u ? 1.001f : -1.001f);
        c.forces.use_box = 1;
        assert_int_equal(1, smr_reject_outside(&c, smr_load(p)));
        c.forces.use_box = 0;
        assert_int_equal(0, smr_reject_outside(&c, smr_load(p)));
    }
}

TEST(coordinates_within)
{
    for (uint32_t a = 0; a < 3u; a++) {
        float p[3] = {5, -5, 5};
        assert_int_equal(1, smr_within3(smr_load(p), 5));
        p[a] = a == 1u ? NAN : -5.1f;
        assert_int_equal(0, smr_within3(smr_load(p), 5));
    }
    assert_true(smr_reject_limit(&(smr_config){.forces.reject_deviations = 2}, 0, 3, 9) == 0.0f);
    assert_true(smr_reject_limit(&(smr_config){.forces.reject_deviations = 2}, 4, 3, 10) == 5.0f);
}

/* No goal from a profile or a line of a wrong length. */
TEST(lengths_of_profiles)
{
    static uint8_t value[SMR_PROFILE_MAX + 1u];
    static float line[SMR_LINE_MAX + 1u];
    static const smr_similarity how = {.kind = SMR_SIMILARITY_NCC};
    static const struct {
        uint32_t n, m;
        float range;
    } wrong[] = {{21, 50, 0},
                 {21, 20, 1},
                 {2, 50, 1},
                 {SMR_PROFILE_MAX + 1u, SMR_PROFILE_MAX + 9u, 1},
                 {21, SMR_LINE_MAX + 1u, 1},
                 {21, 2, 1}};
    for (uint32_t i = 0; i <= SMR_LINE_MAX; i++)
        line[i] = i < 25u ? 0.0f : 1.0f;
    for (uint32_t i = 0; i <= SMR_PROFILE_MAX; i++)
        value[i] = i < 10u ? 0u : 255u;
    for (uint32_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        const smr_profile p = {value, 0, wrong[i].range, wrong[i].n};
        const smr_place place = {.reference = &p};
        const smr_peak none = smr_profile_match(&p, line, NULL, wrong[i].m, &how);
        assert_true(none.confidence == 0.0f);
        if (i != 1u && i != 3u)
            assert_true(smr_profile_edge(&p, 10, line, NULL, wrong[i].m, 25, 9).confidence == 0.0f);
        if (wrong[i].n > SMR_PROFILE_MAX)
            assert_true(smr_tangential_shift(NULL, &place).x == 0.0f);
    }
    const smr_profile p = {value, 0, 1, 21};
    assert_true(smr_profile_match(&p, line, NULL, 50, &how).confidence > 0.5f);
    assert_true(smr_profile_edge(&p, 10, line, NULL, 50, 25, 9).confidence > 0.5f);
}

/* Directions without strength get no inverse: below the floor, or below what a float can invert. */
TEST(inverses_without_strength)
{
    static const struct {
        float s[6], floor, out[3];
    } row[] = {
        {{2, 0, 0, 4, 0, 8}, 1.0e-4f, {0.5f, 0.25f, 0.125f}},
        {{2, 0, 0, 4, 0, 8}, 0.4f, {0, 0.25f, 0.125f}},
        {{1.0e-22f, 0, 0, 1.0e-22f, 0, 1.0e-22f}, 1.0e-4f, {0, 0, 0}},
        {{1.0e16f, 0, 0, 1.0e16f, 0, 1.0e16f}, 1.0e-4f, {1.0e-16f, 1.0e-16f, 1.0e-16f}},
    };
    for (uint32_t i = 0; i < sizeof row / sizeof row[0]; i++) {
        float out[6];
        smr_pseudo_inverse(row[i].s, row[i].floor, out);
        for (uint32_t a = 0; a < 3u; a++) /* the diagonal */
            assert_true(fabsf(out[a == 0u ? 0u : a == 1u ? 3u : 5u] - row[i].out[a]) <= 1.0e-6f * row[i].out[a]);
    }
}

TEST(rotations_of_nothing)
{
    static const float half[9] = {0, 0, 0, 0, -2, 0, 0, 0, -2}; /* R - I */
    float m[9];
    for (uint32_t i = 0; i < 9u; i++)
        m[i] = NAN;
    smr_vec w = smr_rotation_log(m);
    assert_true(w.x == 0.0f && w.y == 0.0f && w.z == 0.0f);
    w = smr_rotation_log(half);
    assert_true(fabsf(w.x - 3.1415927f) < 1e-5f && fabsf(w.y) < 1e-5f && fabsf(w.z) < 1e-5f);
}

/* A matrix that turns one direction round and flattens all others: some rotation by half a turn takes it there. */
TEST(directions_turned_round)
{
    static const float direction[][3] = {{1, 0, 0},       {0, 1, 0},       {0, 0, 1},
                                         {0.6f, 0.8f, 0}, {0.6f, 0, 0.8f}, {0, 0.6f, 0.8f}};
    for (uint32_t k = 0; k < sizeof direction / sizeof direction[0]; k++) {
        float a[9], v[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, m[9];
        const float *d = direction[k];
        for (uint32_t i = 0; i < 9u; i++)
            a[i] = -d[i / 3u] * d[i % 3u];
        smr_polar(a, v, m);
        for (uint32_t i = 0; i < 3u; i++) /* R d = -d */
            assert_true(fabsf(m[3u * i] * d[0] + m[3u * i + 1u] * d[1] + m[3u * i + 2u] * d[2] + 2.0f * d[i]) < 1e-4f);
    }
}
