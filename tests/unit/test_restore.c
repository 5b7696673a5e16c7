/* test_restore.c: what a restored registration waits for, and how it goes on: with the same inputs only, shared by
 * the same structures, and with the same log. A registration also resumes from its log alone.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <string.h>
#include "log/record/log_format.h"
#include "registration/registration.h"
#include "unit/unit_log.h"
#include "unit/unit_save.h"

static unit_save u;

BEFORE_ALL_TESTS()
{
    unit_save_make(&u, UNIT_SAVE_ALL);
    unit_log_make(&unit_recorded);
}

static smr *restored(void)
{
    smr_status status;
    smr *s = unit_save_restored(&u, u.saved, u.bytes, 0, &status);
    assert_int_equal(SMR_OK, status);
    return s;
}

static void awaits(const smr *s, uint32_t expected)
{
    uint32_t n = 77;
    assert_int_equal(SMR_OK, smr_get_awaited(s, &n));
    assert_int_equal(expected, n);
}

/* Both come to the same end. */
static void ends_alike(smr *a, smr *b)
{
    const smr_tick_report x = rig_run(a, 1000), y = rig_run(b, 1000);
    assert_true(x.done && y.done && x.iteration == y.iteration && x.state_hash == y.state_hash);
    assert_true(smr_state_hash(a) == smr_state_hash(b));
}

TEST(test_waits)
{
    static float xyz[2][3 * 200];
    static unsigned char memory[UNIT_LOG_BYTES];
    smr *s = restored(), *before = unit_save_begin(&u, 7);
    const smr_pose pose = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    smr_verdict verdict;
    smr_structure_report part;
    smr_replay replay;
    awaits(s, 2);
    for (uint32_t round = 0; round < 2u; round++) { /* nothing, then the surface alone, is there */
        assert_int_equal(SMR_E_STATE, smr_tick(s, 0, NULL));
        assert_int_equal(SMR_E_STATE, smr_set_pose(s, &pose));
        assert_int_equal(SMR_E_STATE, smr_set_positions(s, 0, u.ball[0].xyz));
        assert_int_equal(SMR_E_STATE, smr_set_active(s, 10));
        assert_int_equal(SMR_E_STATE, smr_set_surface(s, SMR_ALL, NULL));
        assert_int_equal(SMR_E_STATE, smr_set_volume(s, NULL));
        assert_int_equal(SMR_E_STATE, smr_set_log(s, memory, sizeof memory));
        assert_int_equal(SMR_E_STATE, smr_get_verdict(s, 0, &verdict));
        assert_int_equal(SMR_E_STATE, smr_get_expected_error(s, 0, xyz[0]));
        assert_int_equal(SMR_E_STATE, smr_get_local_volume(s, 0, 0, xyz[0]));
        assert_int_equal(SMR_E_STATE, smr_get_visible(s, 0, memory));
        assert_int_equal(SMR_E_STATE, smr_get_structure_report(s, 0, &part));
        assert_int_equal(SMR_E_STATE, smr_replay_start(s, unit_recorded.log, unit_recorded.bytes, NULL, NULL, &replay));
        for (uint32_t i = 0; i < 2u; i++) {
            assert_int_equal(SMR_OK, smr_get_positions(s, i, xyz[0]));
            assert_int_equal(SMR_OK, smr_get_positions(before, i, xyz[1]));
            assert_memory_equal(xyz[0], xyz[1], 12u * u.ball[i].n_vertices);
        }
        if (round == 0u)
            assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, u.copy));
    }
    assert_int_equal(SMR_OK, smr_set_volume(s, &u.volume));
    awaits(s, 0);
    ends_alike(s, before);
}

/* A different input is refused, and so is one twice or where there was none. */
TEST(test_other_inputs)
{
    smr *s = restored();
    smr_volume changed = u.volume;
    changed.voxels = NULL;
    assert_int_equal(SMR_E_NULL, smr_set_volume(s, &changed));
    assert_int_equal(SMR_E_INPUT, smr_set_surface(s, 0, u.other));
    assert_int_equal(SMR_E_INPUT, smr_set_surface(s, SMR_ALL, u.other));
    assert_int_equal(SMR_E_INPUT, smr_set_surface(s, 1, u.surface));
    assert_int_equal(SMR_E_INPUT, smr_set_surface(s, 2, u.surface));
    assert_int_equal(SMR_E_INPUT, smr_set_volume(s, &u.other_volume));
    awaits(s, 2);
    assert_int_equal(SMR_OK, smr_set_surface(s, 0, u.copy));
    assert_int_equal(SMR_E_INPUT, smr_set_surface(s, 0, u.copy));
    awaits(s, 1);
    assert_int_equal(SMR_OK, smr_set_volume(s, &u.volume));
    ends_alike(s, unit_save_begin(&u, 7));
    s = restored();
    assert_int_equal(SMR_OK, smr_set_volume(s, &u.volume));
    assert_int_equal(SMR_E_INPUT, smr_set_volume(s, &u.volume));
}

/* A save of both balls onto these surfaces after three ticks, restored. */
static smr *both(const smr_surface *first, const smr_surface *second, smr **before)
{
    static unsigned char saved[UNIT_SAVE_BYTES];
    smr_status status;
    smr *s = rig_init(u.model, &u.config, NULL);
    assert_int_equal(SMR_OK, smr_set_surface(s, 0, first));
    assert_int_equal(SMR_OK, smr_set_surface(s, 1, second));
    for (uint32_t i = 0; i < 3u; i++)
        assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
    assert_int_equal(SMR_OK, smr_save(s, saved, sizeof saved));
    *before = s;
    s = unit_save_restored(&u, saved, sizeof saved, 0, &status);
    awaits(s, 2);
    return s;
}

/* Structures that shared a surface share it again, others do not, though the surfaces be alike. */
TEST(test_shared)
{
    smr *before = NULL, *s = both(u.surface, u.surface, &before);
    assert_int_equal(SMR_OK, smr_set_surface(s, 1, u.copy));
    assert_int_equal(SMR_E_INPUT, smr_set_surface(s, 0, u.surface));
    assert_int_equal(SMR_E_INPUT, smr_set_surface(s, SMR_ALL, u.surface));
    assert_int_equal(SMR_OK, smr_set_surface(s, 0, u.copy));
    ends_alike(s, before);
    s = both(u.surface, u.surface, &before);
    assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, u.surface));
    ends_alike(s, before);
    s = both(u.surface, u.copy, &before);
    assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, u.copy)); /* the first's */
    awaits(s, 1);
    assert_int_equal(SMR_E_INPUT, smr_set_surface(s, 1, u.copy));
    assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, u.surface));
    ends_alike(s, before);
}

static void refused_now(unsigned char *saved, size_t bytes)
{
    smr_status status;
    unit_save_seal(saved, bytes);
    assert_null(unit_save_restored(&u, saved, bytes, 0, &status));
    assert_int_equal(SMR_E_SAVE, status);
}

/* Values that no registration has, with a right checksum: a pose that is no similarity, by how it mixes the columns of
 * a rotation, and a surface that is shared with a structure without one, or waited for although it is shared. */
TEST(test_forged_values)
{
    static const float mix[][9] = {{1, 0, 0, 0, 2, 0, 0, 0, 1},
                                   {1, 0, 0, 0, 1, 0, 0, 0, 2},
                                   {1, 0.6f, 0, 0, 0.8f, 0, 0, 0, 1},
                                   {1, 0, 0, 0, 1, 0.6f, 0, 0, 0.8f},
                                   {1, 0, 0.6f, 0, 1, 0, 0, 0, 0.8f}};
    static unsigned char saved[UNIT_SAVE_BYTES];
    smr *before = unit_save_begin(&u, 7);
    const smr_pose pose = before->shape.rest_pose;
    memcpy(saved, u.saved, u.bytes);
    unsigned char *at = unit_save_find(saved, &pose, sizeof pose);
    for (uint32_t i = 0; i < sizeof mix / sizeof mix[0]; i++) {
        smr_pose forged = pose;
        for (uint32_t k = 0; k < 9u; k++) {
            const float *row = pose.m[k / 3u], *m = mix[i] + k % 3u;
            forged.m[k / 3u][k % 3u] = row[0] * m[0] + row[1] * m[3] + row[2] * m[6];
        }
        memcpy(at, &forged, sizeof forged);
        refused_now(saved, u.bytes);
    }
    memcpy(saved, u.saved, u.bytes);
    for (size_t cut = 4; cut < 200u; cut += 4u) { /* ends before its last values do */
        smr_log_put32(saved + 8, (uint32_t)(u.bytes - cut));
        refused_now(saved, u.bytes - cut);
    }
    (void)both(u.surface, u.surface, &before);
    size_t bytes;
    assert_int_equal(SMR_OK, smr_save_bytes(before, &bytes));
    assert_int_equal(SMR_OK, smr_save(before, saved, sizeof saved));
    uint32_t list[6] = {0, 0, 0, 0, 0, 0}; /* the structure with the same surface, and checksums */
    const uint64_t sum = smr_target_checksum(u.surface);
    list[1] = (uint32_t)sum;
    list[2] = (uint32_t)(sum >> 32);
    at = unit_save_find(saved, list, sizeof list);
    list[4] = 1;
    memcpy(at, list, sizeof list);
    refused_now(saved, bytes);
    const uint32_t none[6] = {SMR_NONE, 0, 0, 0, 0, 0};
    memcpy(at, none, sizeof none);
    refused_now(saved, bytes);
}

/* ---- logs */

static const void *give(void *ctx, const smr_log_record *record)
{
    const unit_save *from = ctx;
    return record->kind == SMR_LOG_SURFACE ? (const void *)from->surface : (const void *)&from->volume;
}

/* Runs with a log, which is of UNIT_LOG_BYTES. */
static smr_log_state logged(smr *s, unsigned char *log, uint32_t ticks)
{
    smr_log_state at;
    assert_int_equal(SMR_OK, smr_set_log(s, log, UNIT_LOG_BYTES));
    assert_int_equal(SMR_OK, smr_set_surface(s, 0, u.surface));
    assert_int_equal(SMR_OK, smr_set_volume(s, &u.volume));
    (void)rig_run(s, ticks);
    assert_int_equal(SMR_OK, smr_get_log(s, &at));
    return at;
}

/* The log of the interrupted run replays as a whole. */
TEST(test_log_goes_on)
{
    static unsigned char saved[UNIT_SAVE_BYTES], log[UNIT_LOG_BYTES], other[UNIT_LOG_BYTES];
    smr *s = rig_init(u.model, &u.config, NULL);
    smr_log_state at;
    smr_status status;
    smr_replay replay;
    smr_replay_report report = {0};
    at = logged(s, log, 5);
    assert_int_equal(SMR_OK, smr_save(s, saved, sizeof saved));
    s = unit_save_restored(&u, saved, sizeof saved, 1, &status);
    awaits(s, 1);
    assert_int_equal(SMR_E_STATE, smr_tick(s, 0, NULL));
    assert_int_equal(SMR_E_LOG, smr_set_log(s, other, sizeof other));
    assert_int_equal(SMR_E_ARENA, smr_set_log(s, log, at.bytes));
    assert_int_equal(SMR_E_ARENA, smr_set_log(s, log, at.bytes - 1u));
    memcpy(other, log, at.bytes);
    assert_int_equal(SMR_OK, smr_set_log(s, other, sizeof other));
    assert_int_equal(SMR_E_STATE, smr_set_log(s, log, sizeof log));
    (void)rig_run(s, 1000);
    assert_int_equal(SMR_OK, smr_get_log(s, &at));
    assert_int_equal(SMR_OK, smr_replay_start(rig_init(u.model, &u.config, NULL), other, at.bytes, give, &u, &replay));
    while (!report.ended) {
        assert_int_equal(SMR_OK, smr_replay_tick(&replay, &report));
        assert_int_equal(0, report.differs);
    }
    assert_true(report.tick == at.n_ticks && smr_state_hash(replay.s) == smr_state_hash(s));
    s = unit_save_restored(&u, saved, sizeof saved, 1, &status); /* without it */
    assert_int_equal(SMR_OK, smr_set_log(s, NULL, 0));
    assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
    assert_int_equal(SMR_OK, smr_get_log(s, &at));
    assert_true(at.bytes == 0u);
}

/* With budget_exact, which a save or log holds only where it is 1: both are of that configuration and no other. */
TEST(test_exact_budgets)
{
    static unsigned char saved[UNIT_SAVE_BYTES], log[UNIT_LOG_BYTES];
    static _Alignas(SMR_ALIGN) unsigned char arena[1u << 18];
    smr_config config = u.config;
    smr_saved_info info;
    smr_log_state at;
    smr_replay replay;
    smr_replay_report report = {0};
    config.basic.budget_exact = 1;
    smr *s = rig_init(u.model, &config, NULL), *again;
    assert_int_equal(SMR_E_ARENA, smr_set_log(s, log, SMR_LOG_HEADER + SMR_LOG_FULL_BYTES));
    at = logged(s, log, 3);
    assert_int_equal(SMR_E_CONFIG,
                     smr_replay_start(rig_init(u.model, &u.config, NULL), log, at.bytes, give, &u, &replay));
    again = rig_init(u.model, &config, NULL);
    assert_int_equal(SMR_OK, smr_replay_start(again, log, at.bytes, give, &u, &replay));
    while (!report.ended)
        assert_int_equal(SMR_OK, smr_replay_tick(&replay, &report));
    assert_true(smr_state_hash(again) == smr_state_hash(s));
    assert_int_equal(SMR_OK, smr_save(again, saved, sizeof saved));
    assert_int_equal(SMR_OK, smr_save_info(saved, sizeof saved, &info));
    assert_int_equal(1, info.config.basic.budget_exact);
    assert_int_equal(SMR_E_CONFIG,
                     smr_restore(u.model, &u.config, NULL, saved, sizeof saved, arena, sizeof arena, &again));
    assert_int_equal(SMR_OK, smr_restore(u.model, &config, NULL, saved, sizeof saved, arena, sizeof arena, &again));
    assert_int_equal(SMR_OK, smr_restore(u.model, NULL, NULL, saved, sizeof saved, arena, sizeof arena, &again));
}

/* One that was saved right after smr_init() is as smr_init() leaves it: a log can start. */
TEST(test_fresh)
{
    static unsigned char saved[UNIT_SAVE_BYTES], log[UNIT_LOG_BYTES];
    smr *s = rig_init(u.model, &u.config, NULL);
    smr_status status;
    assert_int_equal(SMR_OK, smr_save(s, saved, sizeof saved));
    s = unit_save_restored(&u, saved, sizeof saved, 0, &status);
    awaits(s, 0);
    assert_int_equal(SMR_OK, smr_set_log(s, log, sizeof log));
    s = unit_save_restored(&u, u.saved, u.bytes, 1, &status);
    assert_int_equal(SMR_E_STATE, smr_set_log(s, log, sizeof log));
}

/* Without a save: the replay of a log up to its end, then ticks. */
TEST(test_resumes_from_a_log)
{
    static unsigned char log[UNIT_LOG_BYTES];
    smr *s = rig_init(u.model, &u.config, NULL), *again = rig_init(u.model, &u.config, NULL);
    smr_log_state at;
    smr_replay replay;
    smr_replay_report report = {0};
    at = logged(s, log, 8);
    assert_int_equal(SMR_OK, smr_replay_start(again, log, at.bytes, give, &u, &replay));
    while (!report.ended)
        assert_int_equal(SMR_OK, smr_replay_tick(&replay, &report));
    assert_int_equal(SMR_OK, smr_set_active(again, 0)); /* configuration and budget decide again */
    ends_alike(again, s);
}

/* A restored registration does not go on with a start that was begun in its memory before. */
TEST(test_start_begun_before)
{
    const smr_pose pose = {{{1, 0, 0, 5}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    size_t bytes = 0;
    smr *s = NULL;
    smr_job job;
    assert_int_equal(SMR_OK, smr_arena_bytes(u.model, &u.config, &bytes));
    void *const arena = rig_alloc(bytes);
    assert_int_equal(SMR_OK, smr_init(u.model, &u.config, NULL, arena, bytes, &s));
    assert_int_equal(SMR_OK, smr_set_pose_begin(s, &pose, &job));
    assert_int_equal(SMR_OK, smr_restore(u.model, NULL, NULL, u.saved, u.bytes, arena, bytes, &s));
    const uint64_t hash = smr_state_hash(s);
    assert_int_equal(SMR_E_STATE, smr_job_step(&job, 0, NULL, 0));
    assert_true(hash == smr_state_hash(s));
    awaits(s, 2);
}
