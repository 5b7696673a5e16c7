/* test_replay.c: a replay finds one changed number of the log or one changed byte of an input at the tick where it
 * is; other models, configurations and inputs are distinguished from a replay that differs.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <string.h>
#include "log/record/log_format.h"
#include "unit/unit_log.h"

/* Surfaces in the order in which they were set. */
typedef struct given {
    const smr_surface *surface[2];
    uint32_t next;
} given;

static const void *next_surface(void *ctx, const smr_log_record *record)
{
    given *g = ctx;
    assert_true(record->kind == SMR_LOG_SURFACE && record->present == 1u && record->checksum != 0u);
    return g->next < 2u ? g->surface[g->next++] : NULL;
}

/* The first tick that differs, 0 for none; *status: how it ended. */
static uint32_t first_difference(const unsigned char *log, size_t bytes, given g, smr_status *status)
{
    smr_replay replay;
    smr_replay_report report = {0};
    *status = smr_replay_start(unit_log_begin(&unit_recorded, NULL), log, bytes, next_surface, &g, &replay);
    while (*status == SMR_OK && !report.ended) {
        *status = smr_replay_tick(&replay, &report);
        if (*status == SMR_OK && report.differs)
            return report.tick;
    }
    return *status == SMR_OK ? 0u : report.tick;
}

/* Record i, and the tick that it is. */
static size_t tick_record(uint32_t tick, size_t *bytes)
{
    const uint32_t inputs = tick <= 20u ? 2u : 3u;
    return unit_log_record(unit_recorded.log, unit_recorded.bytes, tick - 1u + inputs, bytes);
}

/* Each word of each complete tick, changed alone. */
TEST(test_one_number_changed)
{
    static unsigned char log[UNIT_LOG_BYTES];
    const given g = {{unit_recorded.surface[0], unit_recorded.surface[1]}, 0};
    smr_status status;
    size_t bytes;
    uint32_t tried = 0;
    for (uint32_t tick = 1; tick <= unit_recorded.ticks; tick++) {
        const size_t at = tick_record(tick, &bytes);
        if (smr_log_get32(unit_recorded.log + at) != (SMR_LOG_TICK | 40u << 8) ||
            (unit_recorded.log[at + 4u] & 1u) == 0u)
            continue; /* a partial tick did not take so many vertices yet */
        for (uint32_t word = 0; word < 8u; word++) {
            if (word == 3u)
                continue; /* n_evaluated tells only */
            memcpy(log, unit_recorded.log, unit_recorded.bytes);
            unsigned char *p = log + at + 4u + 4u * word;
            const uint32_t v = smr_log_get32(p);
            smr_log_put32(p,
                          word == 0u ? v ^ 2u : (word == 2u ? v - 8u : v + 1u)); /* n_taken: a chunk of forces less */
            unit_log_seal(log, unit_recorded.bytes);
            assert_int_equal(tick, first_difference(log, unit_recorded.bytes, g, &status));
            assert_int_equal(SMR_OK, status);
            tried++;
        }
    }
    assert_true(tried >= 7u * 3u);
}

/* The second target with one bit of one coordinate changed. */
static const smr_surface *spoiled(void)
{
    smr_mesh mesh = unit_recorded.goal[1];
    float *xyz = rig_alloc(mesh.n_vertices * 3u * sizeof *xyz);
    memcpy(xyz, mesh.xyz, mesh.n_vertices * 3u * sizeof *xyz);
    ((unsigned char *)xyz)[2] ^= 1u;
    mesh.xyz = xyz;
    return rig_surface(&mesh);
}

/* Where the target counts, its checksum is found to be another; where that is forged, the bits are. */
TEST(test_one_byte_of_a_target_changed)
{
    static unsigned char log[UNIT_LOG_BYTES];
    const given g = {{unit_recorded.surface[0], spoiled()}, 0};
    smr_status status;
    size_t bytes, at;
    uint32_t whole = 21;
    const uint32_t found = first_difference(unit_recorded.log, unit_recorded.bytes, g, &status);
    assert_int_equal(SMR_E_INPUT, status);
    memcpy(log, unit_recorded.log, unit_recorded.bytes);
    at = unit_log_record(log, unit_recorded.bytes, 22, &bytes);
    assert_int_equal(SMR_LOG_SURFACE, log[at]);
    const uint64_t sum = smr_surface_checksum(g.surface[1]);
    smr_log_put32(log + at + 12u, (uint32_t)sum);
    smr_log_put32(log + at + 16u, (uint32_t)(sum >> 32));
    unit_log_seal(log, unit_recorded.bytes);
    const uint32_t differs = first_difference(log, unit_recorded.bytes, g, &status);
    assert_int_equal(SMR_OK, status);
    /* A new mesh pulls from its second iteration on, when the scale of its residuals is known. The iteration under way
     * when it was set may have its forces already: it is none of them then. */
    at = tick_record(20, &bytes);
    const int has_forces = (unit_recorded.log[at + 4u] & 1u) == 0u && unit_recorded.log[at + 5u] != SMR_PHASE_FORCES;
    for (uint32_t passed = 0; whole <= unit_recorded.ticks; whole++) {
        at = tick_record(whole, &bytes);
        passed += unit_recorded.log[at + 4u] & 1u;
        if (passed == 2u + (uint32_t)has_forces)
            break;
    }
    assert_true(differs >= 21u && differs <= whole); /* closest points on the mesh may differ before */
    assert_true(found >= 20u && found <= differs);
}

TEST(test_not_these_inputs)
{
    const given swapped = {{unit_recorded.surface[1], unit_recorded.surface[0]}, 0}, missing = {{NULL, NULL}, 0};
    given g = {{unit_recorded.surface[0], unit_recorded.surface[1]}, 0};
    smr_status status;
    smr_replay replay;
    smr_replay_report report;
    smr_config config = unit_recorded.config;
    const smr_prepare_config radii = rig_radii(1, 20.0f, 0.0f, 0.0f);
    assert_int_equal(1, first_difference(unit_recorded.log, unit_recorded.bytes, swapped, &status));
    assert_int_equal(SMR_E_INPUT, status);
    assert_int_equal(1, first_difference(unit_recorded.log, unit_recorded.bytes, missing, &status));
    assert_int_equal(SMR_E_INPUT, status);
    assert_int_equal(SMR_OK, smr_replay_start(unit_log_begin(&unit_recorded, NULL), unit_recorded.log,
                                              unit_recorded.bytes, NULL, NULL, &replay));
    assert_int_equal(SMR_E_INPUT, smr_replay_tick(&replay, &report));
    assert_int_equal(SMR_LOG_SURFACE, report.record.kind);
    smr *other = rig_init(rig_model(&unit_recorded.ball, 1, &radii), &config, NULL);
    assert_int_equal(SMR_E_MODEL,
                     smr_replay_start(other, unit_recorded.log, unit_recorded.bytes, next_surface, &g, &replay));
    config.motion.relaxation = 0.5f;
    other = rig_init(unit_recorded.model, &config, NULL);
    assert_int_equal(SMR_E_CONFIG,
                     smr_replay_start(other, unit_recorded.log, unit_recorded.bytes, next_surface, &g, &replay));
    config = unit_recorded.config;
    config.basic.n_workers = 7;
    other = rig_init(unit_recorded.model, &config, NULL);
    assert_int_equal(SMR_OK,
                     smr_replay_start(other, unit_recorded.log, unit_recorded.bytes, next_surface, &g, &replay));
}

static const void *any_input(void *ctx, const smr_log_record *record)
{
    static const uint8_t voxels[8] = {0};
    static const smr_volume volume = {
        voxels, NULL, SMR_VOXEL_UINT8, {2, 2, 2}, {0, 0, 0}, {1, 1, 1}, {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    uint32_t *turn = ctx;
    if (record->kind == SMR_LOG_VOLUME)
        return &volume;
    return record->kind == SMR_LOG_POSITIONS ? (const void *)unit_recorded.ball.xyz
                                             : unit_recorded.surface[(*turn)++ % 2u];
}

/* Numbers of a log changed at random, its checksums made right: it is refused or repeated, and nothing breaks. */
TEST(test_forged_logs_are_harmless)
{
    static unsigned char log[UNIT_LOG_BYTES];
    float xyz[3 * 128];
    uint32_t seed = 11, ended = 0, refused = 0;
    assert_true(unit_recorded.ball.n_vertices <= 128u);
    smr *s = NULL;
    size_t arena_bytes = 0;
    assert_int_equal(SMR_OK, smr_arena_bytes(unit_recorded.model, &unit_recorded.config, &arena_bytes));
    void *arena = rig_alloc(arena_bytes);
    for (uint32_t i = 0; i < 600u; i++) {
        smr_replay replay;
        smr_replay_report report = {0};
        uint32_t turn = 0;
        memcpy(log, unit_recorded.log, unit_recorded.bytes);
        for (uint32_t k = 1u + rig_random(&seed, 4); k > 0u; k--) {
            const uint32_t at = SMR_LOG_HEADER + rig_random(&seed, (uint32_t)(unit_recorded.bytes - SMR_LOG_HEADER));
            log[at] = (unsigned char)(rig_random(&seed, 2) ? rig_random(&seed, 256) : log[at] + 1u);
        }
        unit_log_seal(log, unit_recorded.bytes);
        assert_int_equal(SMR_OK, smr_init(unit_recorded.model, &unit_recorded.config, NULL, arena, arena_bytes, &s));
        smr_status status = smr_replay_start(s, log, unit_recorded.bytes, any_input, &turn, &replay);
        for (uint32_t tick = 0; status == SMR_OK && !report.ended; tick++) {
            assert_true(tick <= unit_recorded.ticks);
            status = smr_replay_tick(&replay, &report);
        }
        assert_true(status == SMR_OK || status == SMR_E_LOG || status == SMR_E_INPUT || status == SMR_E_STATE);
        ended += status == SMR_OK;
        refused += status != SMR_OK;
        assert_int_equal(SMR_OK, smr_get_positions(s, 0, xyz));
        assert_true(rig_finite(xyz, unit_recorded.ball.n_vertices));
    }
    assert_true(ended > 100u && refused > 100u);
}

/* A log that became full ends with its last tick, and says so each time. */
TEST(test_full)
{
    static unsigned char log[SMR_LOG_BYTES(3, 0)];
    smr *s = unit_log_begin(&unit_recorded, NULL), *twin = unit_log_begin(&unit_recorded, NULL);
    smr_log_state recorded;
    smr_replay replay;
    smr_replay_report report = {0};
    assert_int_equal(SMR_OK, smr_set_log(s, log, sizeof log));
    for (uint32_t i = 0; i < 9u; i++)
        assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
    assert_int_equal(SMR_OK, smr_get_log(s, &recorded));
    assert_true(recorded.full && recorded.n_ticks >= 3u && recorded.n_ticks < 9u);
    assert_int_equal(SMR_OK, smr_replay_start(twin, log, recorded.bytes, NULL, NULL, &replay));
    for (uint32_t i = 0; i < recorded.n_ticks + 2u; i++) {
        assert_int_equal(SMR_OK, smr_replay_tick(&replay, &report));
        assert_int_equal(i >= recorded.n_ticks, report.ended);
        assert_int_equal(i >= recorded.n_ticks, report.full);
    }
    assert_int_equal(recorded.n_ticks, report.tick);
}

TEST(test_refusals)
{
    static _Alignas(SMR_ALIGN) unsigned char zeros[8192];
    smr *s = unit_log_begin(&unit_recorded, NULL);
    smr_replay replay;
    smr_replay_report report;
    assert_int_equal(SMR_E_NULL, smr_replay_start(s, unit_recorded.log, unit_recorded.bytes, NULL, NULL, NULL));
    assert_int_equal(SMR_E_NULL, smr_replay_start(NULL, unit_recorded.log, unit_recorded.bytes, NULL, NULL, &replay));
    assert_int_equal(SMR_E_NULL, smr_replay_start(s, NULL, unit_recorded.bytes, NULL, NULL, &replay));
    assert_int_equal(SMR_E_STATE, smr_replay_start((smr *)(void *)zeros, unit_recorded.log, unit_recorded.bytes, NULL,
                                                   NULL, &replay));
    assert_int_equal(SMR_E_LOG, smr_replay_start(s, unit_recorded.log, 30, NULL, NULL, &replay));
    static unsigned char log[UNIT_LOG_BYTES]; /* with another number of vertices */
    memcpy(log, unit_recorded.log, unit_recorded.bytes);
    smr_log_put32(log + 20, smr_log_get32(log + 20) + 1u);
    smr_log_put32(log + smr_log_get32(log + 8) - 4u, smr_crc32(0, log, smr_log_get32(log + 8) - 4u));
    assert_int_equal(SMR_E_MODEL, smr_replay_start(s, log, unit_recorded.bytes, NULL, NULL, &replay));
    assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
    assert_int_equal(SMR_E_STATE, smr_replay_start(s, unit_recorded.log, unit_recorded.bytes, NULL, NULL, &replay));
    assert_int_equal(SMR_E_NULL, smr_replay_tick(NULL, &report));
    assert_int_equal(SMR_E_NULL, smr_replay_tick(&replay, NULL));
}

int main(void) { return suite_run(unit_log_set_up, unit_log_tidy); }
