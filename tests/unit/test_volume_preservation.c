/* test_volume_preservation.c: what encloses a volume, how large it is, and that it comes to what is asked for: without
 * a target, against one, with any port or budget, replayed and restored.
 * SPDX-License-Identifier: MIT */
#include "cmocka_first.h"

#include <math.h>
#include <string.h>

#include "property/rig.h"
#include "registration/registration.h"

enum { LOG = 65536 };

static const float none[3] = {0, 0, 0};
static const smr_model *model;

static int tidy(void **state)
{
    (void)state;
    rig_free_all();
    return 0;
}

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

static void test_closed(void **state)
{
    const smr_config off = config_of(0.0f), on = config_of(1.0f);
    const float unit[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, far[3] = {5000, -8000, 300};
    const smr_mesh ball = rig_ball(30, 12, 16, none), away = rig_moved(&ball, unit, far);
    smr_mesh other = ball;
    (void)state;
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

static void test_refused(void **state)
{
    const smr_config off = config_of(0.0f), on = config_of(0.5f);
    const smr_mesh ball = rig_ball(30, 12, 16, none);
    smr_mesh open = ball;
    smr_structure_volume v;
    (void)state;
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

static void test_bytes(void **state)
{
    const smr_config off = config_of(0.0f), on = config_of(1.0f);
    const smr_mesh ball = rig_ball(30, 12, 16, none);
    size_t least = 0, most = 0, save[2] = {0, 0};
    (void)state;
    assert_int_equal(SMR_OK, smr_save_bytes(start(&ball, &off, NULL), &save[0]));
    assert_int_equal(SMR_OK, smr_save_bytes(start(&ball, &on, NULL), &save[1]));
    assert_int_equal(SMR_SAVE_VOLUME_BYTES(1), save[1] - save[0]);
    assert_int_equal(SMR_OK, smr_arena_bytes(model, &off, &least));
    assert_int_equal(SMR_OK, smr_arena_bytes(model, &on, &most));
    assert_true(most > least);
#if !defined(__SANITIZE_ADDRESS__)
    assert_true(most <= least + SMR_ARENA_VOLUME_BYTES(1));
#endif
}

/* Without a target, from any start; also asked for in the scale of the start. */
static void test_reached(void **state)
{
    static const float ratio[] = {0.8f, 0.95f, 1.0f, 1.1f, 1.25f, 3.0f};
    const smr_config on = config_of(1.0f);
    smr_mesh source, target;
    (void)state;
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
static void test_against_a_target(void **state)
{
    const smr_mesh ball = rig_ball(30, 12, 16, none), large = rig_ball(31.5f, 14, 20, none);
    float ratio[3];
    (void)state;
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

/* Inputs moved together give the moved result. */
static void test_moved(void **state)
{
    float m[9], t[3] = {300, -90, 45}, *xyz[2];
    smr_config c = config_of(1.0f);
    smr_mesh source, target;
    (void)state;
    rig_bone(9000, 1.0f, &source, &target);
    rig_rotation(1, 2, 3, 65, m);
    c.basic.n_target_vertices = target.n_vertices;
    c.contact.smooth = 0.2f;
    for (uint32_t i = 0; i < 2u; i++) {
        const smr_mesh from = i == 0u ? source : rig_moved(&source, m, t),
                       to = i == 0u ? target : rig_moved(&target, m, t);
        smr *s = start(&from, &c, NULL);
        assert_int_equal(SMR_OK, smr_set_surface(s, 0, rig_surface(&to)));
        assert_int_equal(SMR_OK, smr_set_volume_ratio(s, 0, 1.05f));
        (void)rig_run(s, 1000);
        assert_float_equal(volume_of(s).ratio, 1.05f, 0.005f);
        xyz[i] = rig_positions(s, model);
    }
    smr_mesh first = source;
    first.xyz = xyz[0];
    first = rig_moved(&first, m, t);
    assert_true(rig_far(first.xyz, xyz[1], source.n_vertices) < 0.01f);
}

/* Ticks under a clock, ratios set within iterations, and a log: the state at the end. */
static uint64_t run(const smr_mesh *ball, const smr_surface *target, const smr_port *port, unsigned char *log,
                    size_t *bytes)
{
    smr_config c = config_of(1.0f);
    smr_log_state wrote;
    uint32_t seed = 5, partial = 0;
    c.basic.n_target_vertices = 1000;
    c.contact.smooth = 0.3f;
    smr *s = start(ball, &c, port);
    assert_int_equal(SMR_OK, smr_set_log(s, log, LOG));
    assert_int_equal(SMR_OK, smr_set_surface(s, 0, target));
    for (uint32_t tick = 0; tick < 150u; tick++) {
        if (tick % 9u == 4u)
            assert_int_equal(SMR_OK, smr_set_volume_ratio(s, SMR_ALL, 0.9f + 0.01f * (float)(tick % 20u)));
        partial += smr_tick(s, 9000u + rig_random(&seed, 90000u), NULL) == SMR_PARTIAL;
    }
    assert_true(partial > 20u);
    assert_int_equal(SMR_OK, smr_get_log(s, &wrote));
    assert_int_equal(0, wrote.full);
    *bytes = wrote.bytes;
    return smr_state_hash(s);
}

static const void *input(void *ctx, const smr_log_record *record)
{
    (void)record;
    return ctx;
}

static void test_replay(void **state)
{
    static unsigned char log[LOG];
    const smr_mesh ball = rig_ball(30, 12, 16, none), large = rig_ball(31.5f, 14, 20, none);
    smr_surface *target = rig_surface(&large);
    smr_config c = config_of(1.0f);
    rig_clock clock;
    const smr_port timed = rig_clock_port(&clock, RIG_CLOCK_STEADY, 1000), plain = rig_port(RIG_SHUFFLE, 1);
    smr_replay replay;
    smr_replay_report report = {0};
    size_t bytes = 0;
    (void)state;
    const uint64_t hash = run(&ball, target, &timed, log, &bytes);
    c.basic.n_target_vertices = 1000;
    c.contact.smooth = 0.3f;
    smr *s = start(&ball, &c, &plain);
    assert_int_equal(SMR_OK, smr_replay_start(s, log, bytes, input, target, &replay));
    while (!report.ended) {
        assert_int_equal(SMR_OK, smr_replay_tick(&replay, &report));
        assert_int_equal(0, report.differs);
    }
    assert_int_equal(150, report.tick);
    assert_true(smr_state_hash(s) == hash);
}

/* On the way to a ratio saved and restored. */
static void test_saved(void **state)
{
    static unsigned char save[1 << 20];
    const smr_mesh ball = rig_ball(30, 12, 16, none);
    const smr_config c = config_of(1.0f);
    smr *s = start(&ball, &c, NULL), *again = NULL;
    const smr_pose pose = {{{1.2f, 0, 0, 10}, {0, 1.2f, 0, 0}, {0, 0, 1.2f, 5}}};
    size_t bytes = 0, arena = 0;
    (void)state;
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

static void test_any_port(void **state)
{
    const smr_mesh ball = rig_ball(30, 20, 30, none), large = rig_ball(31.5f, 14, 20, none);
    const smr_surface *target = rig_surface(&large);
    uint64_t hash[RIG_SCHEDULERS];
    (void)state;
    for (uint32_t k = 0; k < RIG_SCHEDULERS; k++) {
        smr_config c = config_of(1.0f);
        const smr_port port = rig_port(k, 5);
        c.basic.n_workers = 5;
        c.basic.n_target_vertices = 1000;
        c.contact.smooth = 0.4f;
        smr *s = start(&ball, &c, &port);
        assert_int_equal(SMR_OK, smr_set_surface(s, 0, target));
        assert_int_equal(SMR_OK, smr_set_volume_ratio(s, 0, 0.9f));
        (void)rig_run(s, 25);
        hash[k] = smr_state_hash(s);
        assert_true(hash[k] == hash[0]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test_teardown(test_closed, tidy),
                                       cmocka_unit_test_teardown(test_refused, tidy),
                                       cmocka_unit_test_teardown(test_bytes, tidy),
                                       cmocka_unit_test_teardown(test_reached, tidy),
                                       cmocka_unit_test_teardown(test_against_a_target, tidy),
                                       cmocka_unit_test_teardown(test_moved, tidy),
                                       cmocka_unit_test_teardown(test_replay, tidy),
                                       cmocka_unit_test_teardown(test_saved, tidy),
                                       cmocka_unit_test_teardown(test_any_port, tidy)};
    return cmocka_run_group_tests_name("volume_preservation", tests, NULL, NULL);
}
