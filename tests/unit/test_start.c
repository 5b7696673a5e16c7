/* test_start.c: where a registration starts: rest shape, pose, given positions; starting over forgets everything
 * before.
 * SPDX-License-Identifier: MIT */
#include "cmocka_first.h"

#include <math.h>
#include <string.h>

#include "property/rig.h"
#include "registration/registration.h"

static int tidy(void **state)
{
    (void)state;
    rig_free_all();
    return 0;
}

static const float none[3] = {0, 0, 0};

static smr *start(const smr_mesh *mesh, const smr_model **model)
{
    const smr_prepare_config radii = rig_radii(1, 15, 0, 0);
    const smr_config config = smr_config_default();
    *model = rig_model(mesh, 1, &radii);
    return rig_init(*model, &config, NULL);
}

static void test_rest_shape(void **state)
{
    const float at[3] = {123.4f, -567.8f, 901.2f};
    const smr_mesh mesh = rig_ball(20, 6, 9, at);
    const smr_model *model;
    const smr *s = start(&mesh, &model);
    (void)state;
    assert_true(rig_far(mesh.xyz, rig_positions(s, model), mesh.n_vertices) <= 1.3e-4f); /* roundings at 1,000 mm */
    assert_memory_equal(s->shape.x, s->shape.x_ref, 3u * s->shared.n * sizeof(float));
    assert_memory_equal(s->shape.x, s->shape.x_next, 3u * s->shared.n * sizeof(float));
    assert_memory_equal(s->shape.x, s->shape.start, 3u * s->shared.n * sizeof(float));
    assert_true(s->shape.origin.x == floorf(s->shape.origin.x) && s->shape.origin.z == floorf(s->shape.origin.z));
    for (uint32_t i = 0; i < 3u * s->shared.n; i++) {
        assert_true(fabsf(s->shape.x[i]) < 30.0f); /* near the origin: no digits are lost */
        assert_true(s->forces.force[i] == 0.0f);
    }
}

static void test_pose(void **state)
{
    const float at[3] = {30, -50, 90};
    const smr_mesh mesh = rig_ball(20, 6, 9, at);
    const smr_model *model;
    smr *s = start(&mesh, &model);
    float m[9];
    (void)state;
    for (uint32_t k = 0; k < 5u; k++) {
        const float t[3] = {600.0f * (float)k, -70, 3.25f * (float)k}, scale = 1.0f + 0.2f * (float)k;
        smr_pose pose;
        rig_rotation(1, (float)k - 2.0f, 0.5f, 50.0f * (float)k, m);
        for (uint32_t i = 0; i < 12u; i++)
            pose.m[i / 4u][i % 4u] = i % 4u == 3u ? t[i / 4u] : scale * m[3u * (i / 4u) + i % 4u];
        for (uint32_t i = 0; i < 9u; i++)
            m[i] *= scale;
        const smr_mesh expected = rig_moved(&mesh, m, t);
        assert_int_equal(SMR_OK, smr_set_pose(s, &pose));
        assert_true(rig_far(expected.xyz, rig_positions(s, model), mesh.n_vertices) < 4.0e-4f);
        /* a similarity of the rest shape: fitted says which */
        const smr_vec column =
            smr_v(s->shape.rest_pose.m[0][0], s->shape.rest_pose.m[1][0], s->shape.rest_pose.m[2][0]);
        assert_true(fabsf(smr_length(column) - scale) < 1.0e-4f);
    }
}

static void test_normals_follow_the_pose(void **state)
{
    const smr_mesh mesh = rig_ball(20, 6, 9, none);
    const smr_model *model;
    smr *s = start(&mesh, &model);
    const smr_pose quarter = {{{0, -1, 0, 5}, {1, 0, 0, 0}, {0, 0, 1, 0}}};
    float before[3 * 64], after[3 * 64];
    (void)state;
    assert_int_equal(SMR_OK, smr_get_normals(s, 0, before));
    assert_int_equal(SMR_OK, smr_set_pose(s, &quarter));
    assert_int_equal(SMR_OK, smr_get_normals(s, 0, after));
    for (uint32_t v = 0; v < mesh.n_vertices; v++) {
        const smr_vec x = smr_unit(smr_load(mesh.xyz + 3u * v));
        assert_true(smr_dot(x, smr_load(before + 3u * v)) > 0.9f); /* a ball's normals look outwards */
        assert_true(fabsf(after[3u * v] + before[3u * v + 1u]) < 1.0e-6f);
        assert_true(fabsf(after[3u * v + 1u] - before[3u * v]) < 1.0e-6f);
        assert_true(fabsf(after[3u * v + 2u] - before[3u * v + 2u]) < 1.0e-6f);
    }
}

static void test_positions_in_the_callers_order(void **state)
{
    const float off[3] = {60, 0, 0};
    const smr_mesh mesh[2] = {rig_ball(20, 6, 9, none), rig_ball(15, 4, 5, off)};
    const smr_prepare_config radii = rig_radii(1, 15, 0, 0);
    const smr_config config = smr_config_default();
    const smr_model *model = rig_model(mesh, 2, &radii);
    smr *s = rig_init(model, &config, NULL);
    float given[3 * 64], got[3 * 64], other[2][3 * 64];
    uint32_t seed = 3;
    (void)state;
    assert_int_equal(SMR_OK, smr_get_positions(s, 0, other[0]));
    for (uint32_t i = 0; i < 3u * mesh[1].n_vertices; i++)
        given[i] = (float)(int32_t)rig_random(&seed, 200000) / 1024.0f;
    assert_int_equal(SMR_OK, smr_set_positions(s, 1, given));
    assert_int_equal(SMR_OK, smr_get_positions(s, 1, got));
    assert_true(rig_far(given, got, mesh[1].n_vertices) < 5.0e-5f);
    assert_int_equal(SMR_OK, smr_get_positions(s, 0, other[1]));
    assert_true(rig_far(other[0], other[1], mesh[0].n_vertices) < 5.0e-5f); /* the origin may have moved: a rounding */
    assert_memory_equal(s->shape.x, s->shape.x_ref, 3u * s->shared.n * sizeof(float));
}

static void test_starts_over(void **state)
{
    const float off[3] = {3, 2, 1};
    const smr_mesh mesh = rig_ball(20, 6, 9, none), goal = rig_ball(24, 6, 9, off);
    const smr_pose same = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    const smr_model *model;
    smr *s = start(&mesh, &model);
    (void)state;
    assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, rig_surface(&goal)));
    const float *start_x = rig_positions(s, model);
    (void)rig_run(s, 10);
    const uint64_t hash = smr_state_hash(s);
    assert_int_equal(SMR_OK, smr_set_pose(s, &same));
    assert_int_equal(0, s->schedule.iteration);
    assert_int_equal(0, s->schedule.plastic_updates);
    assert_memory_equal(start_x, rig_positions(s, model), 3u * s->shared.n * sizeof(float));
    (void)rig_run(s, 10); /* the target is still there */
    assert_true(hash == smr_state_hash(s));
    (void)rig_run(s, 1000);
    assert_int_equal(SMR_OK, smr_set_positions(s, 0, start_x));
    assert_int_equal(0, s->schedule.done);
    (void)rig_run(s, 10);
    assert_true(hash == smr_state_hash(s));
}

/* Origins are whole millimetres. In a forged model, or when others are set, positions can be as large as floats
 * go, or non-finite. */
static void test_whole_numbers(void **state)
{
    const float limit = 1073741824.0f;
    const struct {
        float given, whole;
    } table[] = {{0.4f, 0},           {0.5f, 1},           {-0.5f, -1},      {-2.4f, -2},
                 {100000.4f, 100000}, {limit, limit},      {4.8e12f, limit}, {-FLT_MAX, -limit},
                 {INFINITY, limit},   {-INFINITY, -limit}, {NAN, -limit}};
    (void)state;
    for (size_t i = 0; i < sizeof table / sizeof table[0]; i++) {
        const smr_vec got = smr_whole(smr_v(table[i].given, 0, table[i].given));
        assert_true(got.x == table[i].whole && got.y == 0.0f && got.z == table[i].whole);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_teardown(test_rest_shape, tidy),
        cmocka_unit_test_teardown(test_pose, tidy),
        cmocka_unit_test_teardown(test_normals_follow_the_pose, tidy),
        cmocka_unit_test_teardown(test_positions_in_the_callers_order, tidy),
        cmocka_unit_test_teardown(test_starts_over, tidy),
        cmocka_unit_test(test_whole_numbers),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
