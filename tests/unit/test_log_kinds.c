/* test_log_kinds.c: damaged records of landmarks, of goals and forces of the caller's own, and of clouds, in the log
 * of a registration that tracks, and of masses and velocities in one with dynamics: forged fields with right
 * checksums are refused where they are read or where they are replayed, every flipped bit is, and what was not forged
 * replays.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <string.h>
#include "log/record/log_format.h"
#include "registration/registration.h"
#include "unit/unit_log.h"

static unit_log u;
static unsigned char forged[UNIT_LOG_BYTES];

BEFORE_ALL_TESTS() { unit_log_make_kinds(&u, 0); }

/* What reading the forged log comes to, and how many records of a kind it had up to there. */
static smr_status read_all(uint32_t kind, uint32_t *n)
{
    smr_log_reader reader;
    smr_log_record r;
    smr_status status = smr_log_open(forged, u.bytes, &reader, NULL);
    *n = 0;
    do {
        if (status == SMR_OK)
            status = smr_log_next(&reader, &r);
        *n += status == SMR_OK && r.kind == kind;
    } while (status == SMR_OK && r.kind != 0u);
    return status;
}

/* What replaying it comes to; *differs: the first tick that differs, from 1. */
static smr_status replay_all(smr_log_input input, uint32_t *differs)
{
    smr *s = unit_log_begin(&u, NULL);
    smr_replay replay;
    smr_replay_report report = {0};
    smr_status status = smr_replay_start(s, forged, u.bytes, input, &u, &replay);
    *differs = 0;
    while (status == SMR_OK && !report.ended && *differs == 0u) {
        status = smr_replay_tick(&replay, &report);
        *differs = status == SMR_OK && report.differs ? report.tick : 0u;
    }
    assert_true(rig_finite(rig_positions(s, u.model), u.ball.n_vertices));
    return status;
}

/* The nth record of a kind, from 0. */
static size_t find(uint32_t kind, uint32_t nth)
{
    size_t bytes = 0, at = 0;
    for (uint32_t i = 0; (at = unit_log_record(u.log, u.bytes, i, &bytes)) > 0u; i++)
        if (u.log[at] == kind && nth-- == 0u)
            return at;
    fail_msg("no such record of kind %u", (unsigned)kind);
    return 0;
}

static void put(uint32_t kind, uint32_t nth, uint32_t word, uint32_t value)
{
    smr_log_put32(forged + find(kind, nth) + 4u + 4u * word, value);
}

#define NAN_BITS 0x7fc00000u
#define FAR_BITS 0x48000000u /* 131072 */
#define NEVER SMR_PARTIAL    /* reading refuses it already */

/* Fields of single records. */
static const struct forgery {
    uint32_t kind, nth, word, value;
    smr_status read, replay;
} forgeries[] = {
    {SMR_LOG_LANDMARKS, 0, 0, SMR_LANDMARKS_MAX + 1u, SMR_E_LOG, NEVER},
    {SMR_LOG_LANDMARKS, 0, 0, 0xffffffffu, SMR_E_LOG, NEVER},
    {SMR_LOG_LANDMARKS, 1, 0, 0, SMR_E_LOG, NEVER}, /* number 1 of none */
    {SMR_LOG_LANDMARKS, 2, 1, 3, SMR_E_LOG, NEVER}, /* number 3 of three */
    {SMR_LOG_LANDMARKS, 2, 1, 0xffffffffu, SMR_E_LOG, NEVER},
    {SMR_LOG_LANDMARKS, 0, 11, 2, SMR_E_LOG, NEVER},
    {SMR_LOG_LANDMARKS, 0, 0, 0, SMR_OK, SMR_E_LOG},  /* none, then number 1 of three */
    {SMR_LOG_LANDMARKS, 2, 0, 64, SMR_OK, SMR_E_LOG}, /* another count */
    {SMR_LOG_LANDMARKS, 1, 1, 2, SMR_OK, SMR_E_LOG},  /* number 1 is missing */
    {SMR_LOG_LANDMARKS, 1, 1, 0, SMR_OK, SMR_E_LOG},
    {SMR_LOG_LANDMARKS, 6, 0, 1, SMR_OK, SMR_E_INPUT}, /* a landmark of zeros */
    {SMR_LOG_LANDMARKS, 0, 2, 1, SMR_OK, SMR_E_INPUT},
    {SMR_LOG_LANDMARKS, 0, 2, SMR_ALL, SMR_OK, SMR_E_INPUT}, /* a vertex of no structure */
    {SMR_LOG_LANDMARKS, 0, 3, 100000, SMR_OK, SMR_E_INPUT},
    {SMR_LOG_LANDMARKS, 1, 4, NAN_BITS, SMR_OK, SMR_E_INPUT},
    {SMR_LOG_LANDMARKS, 1, 6, FAR_BITS, SMR_OK, SMR_E_INPUT},
    {SMR_LOG_LANDMARKS, 0, 7, NAN_BITS, SMR_OK, SMR_E_INPUT},
    {SMR_LOG_LANDMARKS, 0, 9, FAR_BITS, SMR_OK, SMR_E_INPUT},
    {SMR_LOG_LANDMARKS, 0, 10, NAN_BITS, SMR_OK, SMR_E_INPUT},
    {SMR_LOG_LANDMARKS, 0, 10, 0, SMR_OK, SMR_E_INPUT},
    {SMR_LOG_GOALS, 0, 0, 1, SMR_OK, SMR_E_LOG},
    {SMR_LOG_GOALS, 0, 0, SMR_ALL, SMR_OK, SMR_E_LOG},
    {SMR_LOG_GOALS, 2, 0, 1, SMR_OK, SMR_E_LOG},
    {SMR_LOG_GOALS, 0, 1, 0, SMR_E_LOG, NEVER},
    {SMR_LOG_GOALS, 0, 1, 2, SMR_E_LOG, NEVER},
    {SMR_LOG_GOALS, 2, 1, 1, SMR_E_LOG, NEVER}, /* set, without a checksum */
    {SMR_LOG_GOALS, 0, 2, 77, SMR_OK, SMR_E_INPUT},
    {SMR_LOG_FORCE, 0, 0, 0xffffffffu, SMR_E_LOG, NEVER},
    {SMR_LOG_FORCE, 0, 0, 3, SMR_E_LOG, NEVER},
    {SMR_LOG_FORCE, 0, 1, 9, SMR_E_LOG, NEVER},
    {SMR_LOG_VOLUME_RATIO, 0, 0, 1, SMR_OK, SMR_E_INPUT},
    {SMR_LOG_VOLUME_RATIO, 1, 1, 0, SMR_OK, SMR_E_INPUT},
    {SMR_LOG_VOLUME_RATIO, 2, 1, NAN_BITS, SMR_OK, SMR_E_INPUT},
    {SMR_LOG_VOLUME_RATIO, 2, 1, 0x41200001u, SMR_OK, SMR_E_INPUT}, /* next above 10 */
    {SMR_LOG_POINTS, 0, 0, 1, SMR_OK, SMR_E_INPUT},
    {SMR_LOG_POINTS, 0, 1, 0, SMR_E_LOG, NEVER},
    {SMR_LOG_POINTS, 0, 1, 2, SMR_E_LOG, NEVER},
    {SMR_LOG_POINTS, 2, 1, 1, SMR_E_LOG, NEVER},
    {SMR_LOG_POINTS, 0, 3, 5, SMR_OK, SMR_E_INPUT},
    {SMR_LOG_FIXED_SURFACE, 0, 0, 1, SMR_OK, SMR_E_INPUT},
    {SMR_LOG_FIXED_SURFACE, 0, 0, SMR_NONE, SMR_OK, SMR_E_INPUT},
    {SMR_LOG_FIXED_SURFACE, 0, 1, 0, SMR_E_LOG, NEVER},
    {SMR_LOG_FIXED_SURFACE, 0, 1, 2, SMR_E_LOG, NEVER},
    {SMR_LOG_FIXED_SURFACE, 1, 1, 1, SMR_E_LOG, NEVER}, /* taken away, without a checksum */
    {SMR_LOG_FIXED_SURFACE, 0, 2, 77, SMR_OK, SMR_E_INPUT},
};

static void forge(const struct forgery *row, uint32_t rows)
{
    for (uint32_t i = 0; i < rows; i++) {
        const struct forgery *f = &row[i];
        uint32_t n, differs;
        memcpy(forged, u.log, sizeof forged);
        put(f->kind, f->nth, f->word, f->value);
        unit_log_seal(forged, u.bytes);
        const smr_status read = read_all(f->kind, &n), replay = replay_all(unit_log_input, &differs);
        if (read != f->read || replay != (f->read == SMR_OK ? f->replay : f->read))
            fail_msg("forgery %u: read %s, replayed %s", (unsigned)i, smr_status_name(read), smr_status_name(replay));
        assert_true(read == SMR_OK || n == f->nth || f->kind == SMR_LOG_FORCE);
    }
}

TEST(test_fields) { forge(forgeries, sizeof forgeries / sizeof forgeries[0]); }

/* A landmark that was announced is missing: the record behind it says so. */
TEST(test_missing_landmark)
{
    size_t bytes;
    const size_t at = find(SMR_LOG_LANDMARKS, 2), whole = u.bytes;
    for (uint32_t i = 0; unit_log_record(u.log, u.bytes, i, &bytes) != at; i++)
        ;
    memcpy(forged, u.log, at);
    memcpy(forged + at, u.log + at + bytes, u.bytes - at - bytes);
    unit_log_seal(forged, u.bytes -= bytes);
    smr_replay replay;
    smr_replay_report report = {0};
    smr_status status = smr_replay_start(unit_log_begin(&u, NULL), forged, u.bytes, unit_log_input, &u, &replay);
    while (status == SMR_OK && !report.ended)
        status = smr_replay_tick(&replay, &report);
    u.bytes = whole;
    assert_int_equal(SMR_E_LOG, status);
    assert_int_equal(u.log[at + bytes], report.record.kind);
}

/* Other sums of what a force gave, or none, are found at their tick. */
TEST(test_what_a_force_gave)
{
    uint32_t differs;
    memcpy(forged, u.log, sizeof forged);
    put(SMR_LOG_FORCE, 2, 1, 12345); /* the first two: it is set, and what it gave first */
    unit_log_seal(forged, u.bytes);
    assert_int_equal(SMR_OK, replay_all(unit_log_input, &differs));
    assert_true(differs > 6u);
    memcpy(forged, u.log, sizeof forged);
    put(SMR_LOG_FORCE, 0, 0, 0); /* it was never set */
    unit_log_seal(forged, u.bytes);
    assert_int_equal(SMR_OK, replay_all(unit_log_input, &differs));
    assert_true(differs > 6u);
}

static const void *no_force(void *ctx, const smr_log_record *record)
{
    static const smr_caller_force none = {NULL, NULL};
    return record->kind == SMR_LOG_FORCE ? &none : unit_log_input(ctx, record);
}

static const void *no_goals(void *ctx, const smr_log_record *record)
{
    static const smr_goals none = {NULL, NULL};
    return record->kind == SMR_LOG_GOALS ? &none : unit_log_input(ctx, record);
}

static const void *no_cloud(void *ctx, const smr_log_record *record)
{
    static const _Alignas(SMR_ALIGN) unsigned char none[1024];
    return record->kind == SMR_LOG_POINTS ? none : unit_log_input(ctx, record);
}

static const void *nothing(void *ctx, const smr_log_record *record)
{
    return record->kind == SMR_LOG_POINTS ? NULL : unit_log_input(ctx, record);
}

TEST(test_inputs_that_are_none)
{
    static const smr_log_input input[] = {no_force, no_goals, no_cloud, nothing};
    uint32_t differs;
    memcpy(forged, u.log, sizeof forged);
    for (uint32_t i = 0; i < sizeof input / sizeof input[0]; i++)
        assert_int_equal(SMR_E_INPUT, replay_all(input[i], &differs));
}

/* Every bit of these records, and every cut within one. */
TEST(test_every_bit)
{
    uint32_t seen;
    for (uint32_t i = 0, n = unit_log_records(u.log, u.bytes); i < n; i++) {
        size_t bytes;
        const size_t at = unit_log_record(u.log, u.bytes, i, &bytes), whole = u.bytes;
        for (size_t bit = 0; u.log[at] >= SMR_LOG_LANDMARKS && bit < 8u * bytes; bit++) {
            memcpy(forged, u.log, sizeof forged);
            forged[at + bit / 8u] = (unsigned char)(forged[at + bit / 8u] ^ 1u << bit % 8u);
            assert_int_equal(SMR_E_LOG, read_all(0, &seen));
        }
        memcpy(forged, u.log, sizeof forged);
        for (u.bytes = at + 1u; u.bytes < at + bytes; u.bytes++)
            assert_int_equal(SMR_E_LOG, read_all(0, &seen));
        u.bytes = whole;
    }
}

static const void *no_motion(void *ctx, const smr_log_record *record)
{
    static const smr_motion none = {NULL, NULL};
    return record->kind == SMR_LOG_MOTION ? &none : unit_log_input(ctx, record);
}

static const void *nothing_moves(void *ctx, const smr_log_record *record)
{
    return record->kind == SMR_LOG_MOTION ? NULL : unit_log_input(ctx, record);
}

/* Masses and velocities, in a log of their own: dynamics goes with little else. */
TEST(test_motion)
{
    static const struct forgery rows[] = {
        {SMR_LOG_MOTION, 0, 0, 1, SMR_OK, SMR_E_LOG},
        {SMR_LOG_MOTION, 1, 0, SMR_ALL, SMR_OK, SMR_E_LOG},
        {SMR_LOG_MOTION, 0, 1, 77, SMR_OK, SMR_E_INPUT},
        {SMR_LOG_MOTION, 1, 2, 77, SMR_OK, SMR_E_INPUT},
    };
    static unit_log kept;
    uint32_t n, differs;
    kept = u;
    unit_log_make_motion(&u);
    memcpy(forged, u.log, sizeof forged);
    assert_int_equal(SMR_OK, read_all(SMR_LOG_MOTION, &n));
    assert_int_equal(2, n);
    assert_int_equal(SMR_OK, replay_all(unit_log_input, &differs));
    assert_int_equal(0, differs);
    assert_int_equal(SMR_E_INPUT, replay_all(no_motion, &differs));
    assert_int_equal(SMR_E_INPUT, replay_all(nothing_moves, &differs));
    forge(rows, sizeof rows / sizeof rows[0]);
    memcpy(forged, u.log, sizeof forged);
    smr_log_put32(forged + find(SMR_LOG_MOTION, 1) + 8u, 0);
    smr_log_put32(forged + find(SMR_LOG_MOTION, 1) + 12u, 0); /* set, without a checksum */
    unit_log_seal(forged, u.bytes);
    assert_int_equal(SMR_E_LOG, read_all(SMR_LOG_MOTION, &n));
    test_every_bit(state);
    u = kept;
}
