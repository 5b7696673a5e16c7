/* test_start.c: where a registration starts: a pose, given positions; starting over forgets everything before.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include <string.h>
#include "log/record/log_format.h"
#include "registration/registration.h"
#include "unit/unit_log.h"

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

/* A copy on whole 64ths of a millimetre, shifted, which floats hold exactly up to 131 m. */
static smr_mesh on_a_grid(const smr_mesh *mesh, const float shift[3])
{
    float *xyz = rig_alloc(3u * (size_t)mesh->n_vertices * sizeof *xyz);
    for (uint32_t i = 0; i < 3u * mesh->n_vertices; i++)
        xyz[i] = roundf(64.0f * mesh->xyz[i]) / 64.0f + shift[i % 3u];
    return (smr_mesh){xyz, mesh->triangles, mesh->n_vertices, mesh->n_triangles};
}

/* Positions that are given far from the origin run like near ones: floats there round nothing but what is read. */
TEST(test_positions_far_from_the_origin)
{
    static const float far[3] = {65536, -70000, 81920}, half_bit = 1.0f / 256.0f, off[3] = {3, 2, 1};
    const smr_mesh mesh = rig_ball(20, 6, 8, none), goal = rig_ball(24, 7, 10, off);
    const float *x[2];
    for (uint32_t i = 0; i < 2u; i++) {
        const smr_mesh from = on_a_grid(&mesh, i ? far : none), to = on_a_grid(&goal, i ? far : none);
        const smr_model *model;
        smr *s = start(&mesh, &model);
        assert_int_equal(SMR_OK, smr_set_positions(s, 0, from.xyz));
        assert_memory_equal(from.xyz, rig_positions(s, model), 3u * from.n_vertices * sizeof(float));
        assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, rig_surface(&to)));
        assert_true(rig_run(s, 1000).done);
        x[i] = rig_positions(s, model);
    }
    for (uint32_t i = 0; i < 3u * mesh.n_vertices; i++)
        assert_true(fabsf(x[1][i] - far[i % 3u] - x[0][i]) <= half_bit);
}

/* Nor does the scale of residuals stay that tracking has. */
TEST(test_starts_over_from_tracking)
{
    const float off[3] = {3, 2, 1};
    const smr_mesh mesh = rig_ball(20, 11, 15, none), goal = rig_ball(24, 11, 15, off);
    const smr_pose same = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    smr_config config = smr_config_default();
    config.basic.n_target_vertices = goal.n_vertices;
    config.track.mode = SMR_TRACK_REPORT;
    smr *s = rig_init(rig_model(&mesh, 1, NULL), &config, NULL);
    assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, rig_surface(&goal)));
    (void)rig_run(s, 10);
    const uint64_t hash = smr_state_hash(s);
    (void)rig_run(s, 1000);
    assert_int_equal(1, s->schedule.tracking);
    assert_int_equal(SMR_OK, smr_set_pose(s, &same));
    (void)rig_run(s, 10);
    assert_true(hash == smr_state_hash(s));
}

/* A pose or positions that bring any vertex beyond SMR_COORD_MAX, or are no numbers, change nothing. */
TEST(test_ranges)
{
    static const float bad[] = {NAN, INFINITY, -INFINITY, 2.0f * SMR_COORD_MAX, -2.0f * SMR_COORD_MAX};
    static const struct {
        float scale, x;
        smr_status status;
    } all[] = {{1, SMR_COORD_MAX - 21.0f, SMR_OK},
               {1, 21.0f - SMR_COORD_MAX, SMR_OK},
               {1, SMR_COORD_MAX - 18.0f, SMR_E_INPUT},
               {1, 18.0f - SMR_COORD_MAX, SMR_E_INPUT},
               {1, SMR_COORD_MAX, SMR_E_INPUT},
               {0.01f, SMR_COORD_MAX - 0.3f, SMR_OK},
               {900, SMR_COORD_MAX - 18500.0f, SMR_OK},
               {900, SMR_COORD_MAX - 16000.0f, SMR_E_INPUT},
               {1001, 0, SMR_E_INPUT},
               {0, 0, SMR_E_INPUT},
               {-1, 0, SMR_E_INPUT}};
    const float flat[9] = {1, 0, 0, 0, 1, 0, 0, 0, 0}; /* of a flat model the entries for z count all the same */
    const smr_mesh mesh = rig_ball(20, 6, 9, none), disc = rig_moved(&mesh, flat, none);
    const smr_model *model;
    smr *plane = start(&disc, &model), *s = start(&mesh, &model);
    const uint64_t hash = smr_state_hash(s);
    for (uint32_t i = 0; i < 5u; i++) {
        smr_pose pose = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
        for (uint32_t k = 0; k < 12u; k++) {
            const float was = pose.m[k / 4u][k % 4u];
            pose.m[k / 4u][k % 4u] = bad[i];
            assert_int_equal(SMR_E_INPUT, smr_set_pose(s, &pose));
            assert_int_equal(SMR_E_INPUT, smr_set_pose(plane, &pose));
            pose.m[k / 4u][k % 4u] = was;
        }
        float *x = rig_positions(s, model);
        for (uint32_t k = 0; k < 3u * mesh.n_vertices; k++) {
            const float was = x[k];
            x[k] = bad[i];
            assert_int_equal(SMR_E_INPUT, smr_set_positions(s, 0, x));
            x[k] = was;
        }
    }
    assert_true(hash == smr_state_hash(s));
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++)
        for (uint32_t axis = 0; axis < 3u; axis++) {
            smr_pose pose = {{{all[i].scale, 0, 0, 0}, {0, all[i].scale, 0, 0}, {0, 0, all[i].scale, 0}}};
            pose.m[axis][3] = all[i].x;
            assert_int_equal(all[i].status, smr_set_pose(s, &pose));
        }
}

static const void *all_positions(void *ctx, const smr_log_record *record)
{
    assert_true(record->kind == SMR_LOG_ALL_POSITIONS && record->structure == SMR_ALL);
    return ctx;
}

/* Positions of all structures at once are those of one after another, also in a replay. */
TEST(test_all_structures_at_once)
{
    static unsigned char log[20000];
    smr_mesh ball[3];
    float xyz[900], *at = xyz;
    for (uint32_t i = 0; i < 3u; i++) {
        const float from[3] = {40.0f * (float)i, 0, 0}, to[3] = {40.0f * (float)i + 2.0f, (float)i, 5};
        const smr_mesh moved = rig_ball(15.0f + (float)i, 5, 7 + i, to);
        ball[i] = rig_ball(15, 5, 7 + i, from);
        memcpy(at, moved.xyz, 3u * moved.n_vertices * sizeof *at);
        at += 3u * moved.n_vertices;
    }
    const smr_config config = smr_config_default();
    const smr_model *model = rig_model(ball, 3, NULL);
    smr *one = rig_init(model, &config, NULL), *all = rig_init(model, &config, NULL);
    smr *again = rig_init(model, &config, NULL);
    assert_int_equal(SMR_OK, smr_set_log(all, log, sizeof log));
    const float last = at[-1];
    at[-1] = NAN;
    assert_int_equal(SMR_E_INPUT, smr_set_positions(all, SMR_ALL, xyz));
    at[-1] = last;
    assert_int_equal(SMR_E_INPUT, smr_set_positions(all, 3, xyz));
    assert_int_equal(SMR_OK, smr_set_positions(all, SMR_ALL, xyz));
    for (uint32_t i = 0, k = 0; i < 3u; k += 3u * ball[i++].n_vertices)
        assert_int_equal(SMR_OK, smr_set_positions(one, i, xyz + k));
    (void)rig_run(one, 5);
    (void)rig_run(all, 5);
    assert_true(smr_state_hash(one) == smr_state_hash(all));
    smr_log_state written;
    smr_replay replay;
    smr_replay_report report = {0};
    assert_int_equal(SMR_OK, smr_get_log(all, &written));
    assert_int_equal(SMR_OK, smr_replay_start(again, log, written.bytes, all_positions, xyz, &replay));
    while (!report.ended) {
        assert_int_equal(SMR_OK, smr_replay_tick(&replay, &report));
        assert_int_equal(0, report.differs);
    }
    assert_int_equal(5, report.tick);
    const uint32_t head = SMR_LOG_ALL_POSITIONS | 20u << 8;
    size_t record = 0;
    while (record < written.bytes && smr_log_get32(log + record) != head)
        record += 4u;
    assert_true(record < written.bytes);
    for (uint32_t forged = 0; forged < 2u; forged++) { /* all as the positions of one, and one as those of all */
        smr_log_put32(log + record, forged ? head : SMR_LOG_POSITIONS | 20u << 8);
        smr_log_put32(log + record + 4u, forged ? 0u : SMR_ALL);
        unit_log_seal(log, written.bytes);
        again = rig_init(model, &config, NULL);
        assert_int_equal(SMR_OK, smr_replay_start(again, log, written.bytes, all_positions, xyz, &replay));
        assert_int_equal(SMR_E_LOG, smr_replay_tick(&replay, &report));
    }
    smr_log_put32(log + record + 4u, SMR_ALL);
    unit_log_seal(log, written.bytes);
    at[-1] += 1.0f;
    again = rig_init(model, &config, NULL);
    assert_int_equal(SMR_OK, smr_replay_start(again, log, written.bytes, all_positions, xyz, &replay));
    assert_int_equal(SMR_E_INPUT, smr_replay_tick(&replay, &report));
}
