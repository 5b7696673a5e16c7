/* test_volume_preservation.c: what encloses a volume, how large it is, and that it comes to what is asked for, with a
 * target or without, and after a save.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include <string.h>
#include "registration/registration.h"

enum { LOG = 65536 };

static const float none[3] = {0, 0, 0};
static const smr_model *model;

static smr_config config_of(float volume)
{
    smr_config c = smr_config_default();
    c.contact.volume = volume;
    c.basic.iterations = 6;
    c.basic.iterations_last = 30;
    return c;
}

/* A registration of one mesh with three radii. */
static smr *start(const smr_mesh *mesh, const smr_config *config, const smr_port *port)
{
    const smr_prepare_config radii = rig_radii(3, 40, 15, 0.1f);
    model = rig_model(mesh, 1, &radii);
    return rig_init(model, config, port);
}

static smr_structure_volume volume_of(const smr *s)
{
    smr_structure_volume v;
    assert_int_equal(SMR_OK, smr_get_structure_volume(s, 0, &v));
    return v;
}

/* By cones in double precision. */
static double volume_in_double(const float *xyz, const smr_mesh *mesh)
{
    double sum = 0.0;
    for (uint32_t k = 0; k < mesh->n_triangles; k++) {
        double p[3][3];
        for (uint32_t c = 0; c < 3u; c++)
            for (uint32_t a = 0; a < 3u; a++)
                p[c][a] = (double)xyz[3u * mesh->triangles[3u * k + c] + a] - (double)xyz[a];
        sum += p[0][0] * (p[1][1] * p[2][2] - p[1][2] * p[2][1]) + p[0][1] * (p[1][2] * p[2][0] - p[1][0] * p[2][2]) +
               p[0][2] * (p[1][0] * p[2][1] - p[1][1] * p[2][0]);
    }
    return sum / 6.0;
}

TEST(test_closed)
{
    const smr_config off = config_of(0.0f), on = config_of(1.0f);
    const float unit[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, far[3] = {5000, -8000, 300};
    const smr_mesh ball = rig_ball(30, 12, 16, none), away = rig_moved(&ball, unit, far);
    smr_mesh other = ball;
    smr_structure_volume v = volume_of(start(&away, &off, NULL));
    assert_true(v.closed && v.asked_mm3 == 0.0f && v.asked_ratio == 0.0f);
    assert_float_equal(v.rest_mm3, (float)volume_in_double(away.xyz, &away), 1e-4f * v.rest_mm3);
    assert_float_equal(v.ratio, 1.0f, 1e-5f);
    other.n_triangles--; /* a hole */
    v = volume_of(start(&other, &on, NULL));
    assert_true(!v.closed && v.rest_mm3 == 0.0f && v.present_mm3 == 0.0f);
    uint32_t *turned = rig_alloc(3u * (size_t)ball.n_triangles * sizeof(uint32_t));
    memcpy(turned, ball.triangles, 3u * (size_t)ball.n_triangles * sizeof(uint32_t));
    other = ball;
    other.triangles = turned;
    turned[0] = ball.triangles[1]; /* one triangle the other way round */
    turned[1] = ball.triangles[0];
    assert_false(volume_of(start(&other, &on, NULL)).closed);
    for (uint32_t k = 0; k < ball.n_triangles; k++) { /* all of them: inside out */
        turned[3u * k] = ball.triangles[3u * k + 1u];
        turned[3u * k + 1u] = ball.triangles[3u * k];
    }
    smr *s = start(&other, &on, NULL);
    v = volume_of(s);
    assert_true(v.closed && v.rest_mm3 > 0.0f && v.ratio > 0.999f);
    assert_int_equal(SMR_OK, smr_set_volume_ratio(s, 0, 0.9f));
    (void)rig_run(s, 1000);
    assert_float_equal(volume_of(s).ratio, 0.9f, 1e-4f);
}

TEST(test_refused)
{
    const smr_config off = config_of(0.0f), on = config_of(0.5f);
    const smr_mesh ball = rig_ball(30, 12, 16, none);
    smr_mesh open = ball;
    smr_structure_volume v;
    smr *s = start(&ball, &off, NULL);
    assert_int_equal(SMR_E_ARENA, smr_set_volume_ratio(s, 0, 1.0f));
    s = start(&ball, &on, NULL);
    assert_int_equal(SMR_E_NULL, smr_set_volume_ratio(NULL, 0, 1.0f));
    assert_int_equal(SMR_E_INPUT, smr_set_volume_ratio(s, 1, 1.0f));
    assert_int_equal(SMR_E_INPUT, smr_set_volume_ratio(s, 0, 0.099f));
    assert_int_equal(SMR_E_INPUT, smr_set_volume_ratio(s, 0, 10.01f));
    assert_int_equal(SMR_E_INPUT, smr_set_volume_ratio(s, SMR_ALL, NAN));
    assert_int_equal(SMR_OK, smr_set_volume_ratio(s, SMR_ALL, 10.0f));
    assert_float_equal(volume_of(s).asked_ratio, 10.0f, 0.0f);
    assert_int_equal(SMR_E_INPUT, smr_get_structure_volume(s, 1, &v));
    assert_int_equal(SMR_E_NULL, smr_get_structure_volume(s, 0, NULL));
    open.n_triangles -= 2u;
    s = start(&open, &on, NULL);
    assert_int_equal(SMR_E_INPUT, smr_set_volume_ratio(s, 0, 1.0f));
    assert_int_equal(SMR_OK, smr_set_volume_ratio(s, SMR_ALL, 2.0f)); /* of each that is closed: of none */
    const uint64_t before = smr_state_hash(s);
    (void)rig_run(s, 5);
    assert_true(smr_state_hash(s) == before);
}

/* Without a target, from any start; also asked for in the scale of the start. */
TEST(test_reached)
{
    static const float ratio[] = {0.8f, 0.95f, 1.0f, 1.1f, 1.25f, 3.0f};
    const smr_config on = config_of(1.0f);
    smr_mesh source, target;
    rig_bone(9000, 1.0f, &source, &target);
    for (uint32_t i = 0; i < sizeof ratio / sizeof ratio[0]; i++) {
        smr *s = start(&source, &on, NULL);
        const smr_pose twice = {{{0, -2, 0, 10}, {2, 0, 0, 0}, {0, 0, 2, -30}}};
        const float rest = volume_of(s).rest_mm3;
        if (i % 2u != 0u)
            assert_int_equal(SMR_OK, smr_set_pose(s, &twice));
        assert_int_equal(SMR_OK, smr_set_volume_ratio(s, SMR_ALL, ratio[i]));
        assert_int_equal(1, rig_run(s, 1000).done);
        const smr_structure_volume v = volume_of(s);
        assert_float_equal(v.rest_mm3, (i % 2u != 0u ? 8.0f * rest : rest), 1e-3f * v.rest_mm3);
        assert_float_equal(v.ratio, ratio[i], 1e-3f * ratio[i]);
        assert_float_equal(v.present_mm3, (float)volume_in_double(rig_positions(s, model), &source),
                           1e-4f * v.present_mm3);
    }
}

/* Against a target that is larger: the volume stays, equally far from the target all over; half as much is in between.
 * What a target may ask for is not in its way. */
TEST(test_against_a_target)
{
    const smr_mesh ball = rig_ball(30, 12, 16, none), large = rig_ball(31.5f, 14, 20, none);
    float ratio[3];
    for (uint32_t i = 0; i < 3u; i++) {
        smr_config c = config_of(0.5f * (float)i);
        c.basic.n_target_vertices = 1000;
        smr *s = start(&ball, &c, NULL);
        assert_int_equal(SMR_OK, smr_set_surface(s, 0, rig_surface(&large)));
        (void)rig_run(s, 1000);
        ratio[i] = volume_of(s).ratio;
        const float *xyz = rig_positions(s, model);
        float low = 100.0f, high = 0.0f;
        for (uint32_t v = 0; v < ball.n_vertices; v++) {
            const float r = smr_length(smr_load(xyz + 3u * (size_t)v));
            low = smr_min(low, r);
            high = smr_max(high, r);
        }
        assert_true(high - low < 0.5f);
    }
    assert_true(ratio[0] > 1.1f && ratio[1] > 1.02f && ratio[1] < ratio[0] - 0.02f);
    assert_float_equal(ratio[2], 1.0f, 1e-3f);
}

/* A ratio that is set once tracking has settled wakes it, and is reached. */
TEST(test_reached_from_rest)
{
    const smr_mesh ball = rig_ball(30, 12, 16, none);
    smr_config c = config_of(1.0f);
    c.track.mode = SMR_TRACK_REPORT;
    smr *s = start(&ball, &c, NULL);
    for (uint32_t i = 0; i < 3u; i++) {
        static const float ratio[] = {1.0f, 1.2f, 0.9f};
        smr_tick_report report;
        assert_int_equal(SMR_OK, smr_set_volume_ratio(s, 0, ratio[i]));
        report = rig_run(s, 300);
        assert_true(report.details.tracking && report.details.settled);
        assert_float_equal(volume_of(s).ratio, ratio[i], 1e-3f * ratio[i]);
    }
}

/* Tracking does not rest before the ratio is reached: neither where large displacements count as rest, nor where the
 * ratio is set before the schedule's last iterations. */
TEST(test_no_rest_before)
{
    const smr_mesh ball = rig_ball(30, 12, 16, none);
    smr_config c = config_of(1.0f);
    c.track.mode = SMR_TRACK_REPORT;
    c.motion.settle_um = 0.0f;
    for (uint32_t ticks = 34; ticks < 44u; ticks++) {
        c.track.settle_um = ticks % 2u ? 1000.0f : 20.0f;
        smr *s = start(&ball, &c, NULL);
        (void)rig_run(s, ticks);
        assert_int_equal(SMR_OK, smr_set_volume_ratio(s, 0, 1.2f));
        assert_true(rig_run(s, 50).details.settled);
        assert_float_equal(volume_of(s).ratio, 1.2f, 1e-3f);
    }
}

/* On the way to a ratio saved and restored. */
TEST(test_saved)
{
    static unsigned char save[1 << 20];
    const smr_mesh ball = rig_ball(30, 12, 16, none);
    const smr_config c = config_of(1.0f);
    smr *s = start(&ball, &c, NULL), *again = NULL;
    const smr_pose pose = {{{1.2f, 0, 0, 10}, {0, 1.2f, 0, 0}, {0, 0, 1.2f, 5}}};
    size_t bytes = 0, arena = 0;
    assert_int_equal(SMR_OK, smr_set_pose(s, &pose));
    assert_int_equal(SMR_OK, smr_set_volume_ratio(s, 0, 1.3f));
    (void)rig_run(s, 4);
    assert_int_equal(SMR_OK, smr_save_bytes(s, &bytes));
    assert_int_equal(SMR_OK, smr_save(s, save, sizeof save));
    assert_int_equal(SMR_OK, smr_arena_bytes(model, &c, &arena));
    assert_int_equal(SMR_OK, smr_restore(model, NULL, NULL, save, bytes, rig_alloc(arena), arena, &again));
    assert_float_equal(volume_of(again).asked_ratio, 1.3f, 0.0f);
    (void)rig_run(s, 1000);
    (void)rig_run(again, 1000);
    assert_true(smr_state_hash(s) == smr_state_hash(again));
    assert_float_equal(volume_of(again).ratio, 1.3f, 1e-3f);
}
