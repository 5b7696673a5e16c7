/* test_start.c: where a registration starts: a pose, given positions; starting over forgets everything before.
 * SPDX-License-Identifier: MIT */
#include "suite.h"

#include <math.h>
#include <string.h>

#include "registration/registration.h"

static const float none[3] = {0, 0, 0};

static smr *start(const smr_mesh *mesh, const smr_model **model)
{
    const smr_prepare_config radii = rig_radii(1, 15, 0, 0);
    const smr_config config = smr_config_default();
    *model = rig_model(mesh, 1, &radii);
    return rig_init(*model, &config, NULL);
}

TEST(test_pose)
{
    const float at[3] = {30, -50, 90};
    const smr_mesh mesh = rig_ball(20, 6, 9, at);
    const smr_model *model;
    smr *s = start(&mesh, &model);
    float m[9];
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

TEST(test_starts_over)
{
    const float off[3] = {3, 2, 1};
    const smr_mesh mesh = rig_ball(20, 6, 9, none), goal = rig_ball(24, 6, 9, off);
    const smr_pose same = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    const smr_model *model;
    smr *s = start(&mesh, &model);
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

int main(void) { return suite_run(NULL, NULL); }
