/* test_dynamics_runs.c: a model with mass in time, drawn to surfaces, thrown and weighed between ticks: the same bits
 * for any number of threads, order of tasks and budget, from its log, and saved and restored between any two calls; and
 * forged inputs of the log are found.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include <string.h>
#include "log/record/log_format.h"
#include "options/dynamics/dynamics.h"

enum { CALLS = 60, ROOM = 60000 };

static struct scene {
    smr_mesh bone, target;
    const smr_model *model;
    const smr_surface *surface;
    smr_config config;
    uint32_t n;
    float *mass, *speed;
    smr_motion motion[2];
    uint32_t which; /* input of the replay: motion[which] comes next */
} e;

BEFORE_EACH_TEST()
{
    const float none[3] = {0, 0, 0}, flat[9] = {1, 0, 0, 0, 0.7f, 0, 0, 0, 1.6f};
    const smr_prepare_config radii = rig_radii(2, 40, 18, 0);
    const smr_mesh ball = rig_ball(25, 11, 16, none);
    memset(&e, 0, sizeof e);
    e.bone = rig_moved(&ball, flat, none);
    e.target = rig_ball(27, 9, 14, none);
    e.model = rig_model(&e.bone, 1, &radii);
    e.surface = rig_surface(&e.target);
    e.config = smr_config_default();
    e.config.basic.n_workers = 4;
    e.config.basic.n_target_vertices = e.target.n_vertices;
    e.config.dynamics.mode = SMR_DYNAMICS_ON;
    e.config.dynamics.gravity[2] = -9810.0f;
    e.config.dynamics.step_ms = 4.0f;
    e.config.track.radius_mm = 18.0f;
    e.n = e.bone.n_vertices;
    e.mass = rig_alloc(e.n * sizeof *e.mass);
    e.speed = rig_alloc(3u * (size_t)e.n * sizeof *e.speed);
    for (uint32_t i = 0; i < e.n; i++) {
        e.mass[i] = i < 4u ? INFINITY : 0.5f + 0.3f * (float)(i % 4u);
        for (uint32_t c = 0; c < 3u; c++)
            e.speed[3u * i + c] = i < 4u ? 0.0f : e.bone.xyz[3u * i + (c + 1u) % 3u] * 4.0f;
    }
    e.motion[0] = (smr_motion){e.mass, NULL};
    e.motion[1] = (smr_motion){NULL, e.speed};
}

/* Call number c; budgets only count where there is a clock. */
static smr_status make(smr *s, uint32_t c, uint64_t budget)
{
    switch (c) {
    case 0:
    case 39: return smr_set_motion(s, 0, e.mass, NULL);
    case 15: return smr_set_motion(s, 0, NULL, e.speed);
    case 25: return smr_set_surface(s, SMR_ALL, e.surface);
    case 47: return smr_set_surface(s, SMR_ALL, NULL);
    default: return smr_tick(s, budget, NULL);
    }
}

static void same(const smr *a, const smr *b)
{
    float *const speed = rig_alloc(6u * (size_t)e.n * sizeof *speed);
    smr_energy one, two;
    assert_true(smr_state_hash(a) == smr_state_hash(b));
    assert_int_equal(SMR_OK, smr_get_velocities(a, 0, speed));
    assert_int_equal(SMR_OK, smr_get_velocities(b, 0, speed + 3u * (size_t)e.n));
    assert_memory_equal(speed, speed + 3u * (size_t)e.n, 3u * (size_t)e.n * sizeof *speed);
    assert_int_equal(SMR_OK, smr_get_energy(a, &one));
    assert_int_equal(SMR_OK, smr_get_energy(b, &two));
    assert_memory_equal(&one, &two, sizeof one);
    assert_memory_equal(a->shape.dynamics->spare, b->shape.dynamics->spare, sizeof(float));
    assert_memory_equal(a->shape.dynamics->bent, b->shape.dynamics->bent, sizeof(float));
    assert_int_equal(a->shape.dynamics->weighed, b->shape.dynamics->weighed);
}

static smr *plain_run(const smr_port *port)
{
    smr *s = rig_init(e.model, &e.config, port);
    for (uint32_t c = 0; c < CALLS; c++)
        assert_int_equal(SMR_OK, make(s, c, 0));
    return s;
}

TEST(test_threads)
{
    for (uint32_t method = 0; method < 2u; method++) {
        e.config.basic.method = method;
        const smr *first = plain_run(NULL);
        for (uint32_t k = 0; k < RIG_SCHEDULERS; k++) {
            const smr_port port = rig_port(k, 1u + k % 4u);
            same(first, plain_run(&port));
        }
    }
}

static const void *input(void *ctx, const smr_log_record *record)
{
    (void)ctx;
    return record->kind == SMR_LOG_MOTION ? (const void *)&e.motion[e.which++ % 2u] : e.surface;
}

/* The record of this kind in a log. */
static size_t find(const unsigned char *log, size_t bytes, uint32_t kind)
{
    size_t at = SMR_LOG_HEADER;
    while (at < bytes && log[at] != kind)
        at += smr_log_get32(log + at) >> 8;
    return at;
}

/* Inputs come while iterations are under way, which ticks of a clock cut anywhere. */
TEST(test_budget_and_replay)
{
    static unsigned char log[SMR_LOG_BYTES(4000, 10)];
    rig_jitter clock = {11, 1000000u};
    const smr_port port = {&clock, 3, NULL, rig_jitter_read};
    smr_replay_report report = {0};
    smr_log_state wrote;
    smr_replay replay;
    uint32_t seed = 9, partial = 0;
    smr *s = rig_init(e.model, &e.config, &port);
    assert_int_equal(SMR_OK, smr_set_log(s, log, sizeof log));
    for (uint32_t tick = 0; tick < 1200u; tick++) {
        if (tick % 300u == 0u)
            assert_int_equal(SMR_OK, make(s, tick % 600u == 0u ? 0u : 15u, 0));
        if (tick == 500u)
            assert_int_equal(SMR_OK, make(s, 25, 0));
        partial += smr_tick(s, 20000u + rig_random(&seed, 100000u), NULL) == SMR_PARTIAL;
    }
    assert_true(partial > 300u && partial < 1150u);
    assert_int_equal(SMR_OK, smr_get_log(s, &wrote));
    smr *twin = rig_init(e.model, &e.config, NULL);
    assert_int_equal(1200, rig_replays(s, log, input, NULL, twin, NULL));
    while (smr_tick(s, 0, NULL) == SMR_PARTIAL) {
    }
    assert_int_equal(SMR_OK, smr_tick(twin, 0, NULL));
    same(s, twin);
    e.which = 1; /* masses and velocities in the wrong order */
    assert_int_equal(SMR_OK,
                     smr_replay_start(rig_init(e.model, &e.config, NULL), log, wrote.bytes, input, NULL, &replay));
    assert_int_equal(SMR_E_INPUT, smr_replay_tick(&replay, &report));
    const size_t at = find(log, wrote.bytes, SMR_LOG_MOTION);
    smr_log_put32(log + at + 4u, 1); /* of another structure */
    smr_log_put32(log + at + 16u, smr_crc32(smr_log_get32(log + at - 4u), log + at, 16));
    e.which = 0;
    assert_int_equal(SMR_OK, smr_replay_start(rig_init(e.model, &e.config, NULL), log, at + 20u, input, NULL, &replay));
    assert_int_equal(SMR_E_LOG, smr_replay_tick(&replay, &report));
}

/* Forces of an iteration that masses or velocities abandon leave nothing: neither what of the model the target shows,
 * nor a limit of displacements. A replay does not know that there were any. */
TEST(test_abandoned_forces)
{
    static unsigned char log[SMR_LOG_BYTES(400, 4)];
    const float beside[3] = {0, 0, 30};
    const smr_mesh part = rig_ball(9, 9, 14, beside);
    for (uint32_t kind = 0; kind < 4u; kind++) {
        rig_clock clock;
        const smr_port port = rig_clock_port(&clock, RIG_CLOCK_STEADY, 1000);
        smr_tick_report r = {0};
        e.surface = rig_surface(&part);
        e.config.forces.reject_deviations = (kind & 1u) != 0u ? 0.5f : 0.0f;
        e.which = 1; /* velocities */
        smr *s = rig_init(e.model, &e.config, &port);
        assert_int_equal(SMR_OK, smr_set_log(s, log, sizeof log));
        assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, e.surface));
        for (uint32_t i = 0; i < (kind & 2u); i++)
            assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
        do
            assert_int_equal(SMR_PARTIAL, smr_tick(s, 3000, &r));
        while (r.details.phase == SMR_PHASE_FORCES);
        assert_int_equal(SMR_OK, smr_set_motion(s, 0, NULL, e.speed));
        for (uint32_t i = 0; i < 12u; i++)
            assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
        smr *twin = rig_init(e.model, &e.config, NULL);
        assert_true(rig_replays(s, log, input, NULL, twin, NULL) > 12u);
        same(s, twin);
    }
}

TEST(test_saves)
{
    static unsigned char saved[ROOM];
    const smr *last = plain_run(NULL);
    for (uint32_t cut = 1; cut < CALLS; cut += 5u) {
        const smr_port port = rig_port(RIG_SHUFFLE, 4);
        smr *s = rig_init(e.model, &e.config, NULL), *twin = NULL;
        size_t bytes, needed;
        for (uint32_t c = 0; c < cut; c++)
            assert_int_equal(SMR_OK, make(s, c, 0));
        assert_int_equal(SMR_OK, smr_save_bytes(s, &bytes));
        assert_true(bytes <= sizeof saved);
        assert_int_equal(SMR_OK, smr_save(s, saved, bytes));
        assert_int_equal(SMR_OK, smr_arena_bytes(e.model, &e.config, &needed));
        assert_int_equal(SMR_OK, smr_restore(e.model, NULL, &port, saved, bytes, rig_alloc(needed), needed, &twin));
        same(s, twin);
        if (cut > 25u && cut <= 47u) {
            assert_int_equal(SMR_E_STATE, smr_set_motion(twin, 0, e.mass, NULL)); /* the surface is awaited */
            assert_int_equal(SMR_OK, smr_set_surface(twin, SMR_ALL, e.surface));
        }
        for (uint32_t c = cut; c < CALLS; c++)
            assert_int_equal(SMR_OK, make(twin, c, 0));
        same(last, twin);
    }
}
