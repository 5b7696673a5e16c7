/* test_log.c: what recording writes, byte by byte; what it refuses; what happens when its memory is full; and that it
 * changes nothing else.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <string.h>
#include "log/record/log_format.h"
#include "unit/unit_log.h"

/* The header as docs/SPEC.md has it, without the code's own names. */
TEST(test_header)
{
    static const unsigned char magic[] = {'S', 'M', 'R', 'L', 3, 0, 0, 0};
    uint32_t word[256];
    smr_model_info info;
    assert_memory_equal(magic, unit_recorded.log, sizeof magic);
    uint32_t rows, settings = 0, n = 0; /* a head and the words of each setting */
    const smr_setting *table = smr_config_settings(&rows);
    for (uint32_t i = 0; i < rows; i++) {
        const int late =
            table[i].number == 54u || table[i].number == 77u || table[i].number == 78u; /* not held at their defaults */
        const int held = table[i].kind != SMR_SETTING_GROUP && table[i].number > 0u && !late;
        settings += (uint32_t)held;
        n += held ? 1u + table[i].bytes / 4u : 0u;
    }
    assert_true(settings >= 40u && n >= 84u);
    for (uint32_t i = 0; i < 7u + n + 1u; i++) {
        const unsigned char *p = unit_recorded.log + 4u * i;
        word[i] = (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
    }
    assert_int_equal(SMR_OK, smr_model_get_info(unit_recorded.model, &info));
    assert_int_equal(28u + 4u * n + 4u, word[2]);
    assert_int_equal(SMR_VERSION_MAJOR << 16 | SMR_VERSION_MINOR << 8 | SMR_VERSION_PATCH, word[3]);
    assert_int_equal(info.checksum, word[4]);
    assert_int_equal(info.n_vertices, word[5]);
    assert_int_equal(n, word[6]);
    uint32_t iterations = 0, target_vertices = 0, at = 7;
    for (uint32_t k = 0; k < settings; k++, at += 1u + (word[at] >> 16)) {
        iterations += word[at] == (1u << 16 | 43u) && word[at + 1u] == unit_recorded.config.basic.iterations;
        target_vertices += word[at] == (1u << 16 | 2u) && word[at + 1u] == unit_recorded.config.basic.n_target_vertices;
    }
    assert_true(iterations == 1u && target_vertices == 1u && at == 7u + n);
    assert_int_equal(smr_crc32(0, unit_recorded.log, 28u + 4u * n), word[7u + n]);
}

/* The inputs and ticks of unit_log_make, in order; partial ticks, whole ones and cut ones among them. */
TEST(test_records)
{
    smr_log_reader reader;
    smr_log_record r;
    uint32_t ticks = 0, partial = 0, cut = 0, surfaces = 0, iteration = 0;
    assert_int_equal(SMR_OK, smr_log_open(unit_recorded.log, unit_recorded.bytes, &reader, NULL));
    assert_int_equal(SMR_OK, smr_log_next(&reader, &r));
    assert_int_equal(SMR_LOG_POSE, r.kind);
    assert_true(r.pose.m[0][3] == 1.5f && r.pose.m[1][3] == -0.5f && r.pose.m[2][2] == 1.0f);
    for (;;) {
        assert_int_equal(SMR_OK, smr_log_next(&reader, &r));
        if (r.kind == 0u)
            break;
        if (r.kind == SMR_LOG_SURFACE) {
            assert_true(r.structure == SMR_ALL && r.present == 1u);
            assert_true(r.checksum == smr_surface_checksum(unit_recorded.surface[surfaces]));
            assert_int_equal(20u * surfaces++, ticks);
            continue;
        }
        assert_int_equal(SMR_LOG_TICK, r.kind);
        ticks++;
        partial += !r.complete;
        iteration += r.complete;
        cut += r.complete && r.n_taken < unit_recorded.ball.n_vertices;
        assert_int_equal(iteration, r.iteration);
        assert_true(r.n_evaluated <= r.n_taken && (r.complete ? r.n_evaluated == r.n_taken : 1));
    }
    assert_true(ticks == 40u && unit_recorded.ticks == 40u && surfaces == 2u && partial > 0u && iteration > 2u &&
                cut > 0u);
}

/* Every length from nothing to enough: what was recorded is a part of the whole, the rest goes on as without a log. */
TEST(test_memory_ends)
{
    static unsigned char log[UNIT_LOG_BYTES];
    smr_log_state is;
    const smr_pose pose = {{{1, 0, 0, 1}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    smr *plain = unit_log_begin(&unit_recorded, NULL);
    assert_int_equal(SMR_OK, smr_set_pose(plain, &pose));
    assert_int_equal(SMR_OK, smr_set_surface(plain, 0, unit_recorded.surface[0]));
    (void)rig_run(plain, 4);
    for (size_t bytes = 0; bytes < SMR_LOG_HEADER + 320u; bytes += 7u) {
        smr *s = unit_log_begin(&unit_recorded, NULL);
        memset(log, 0xa5, sizeof log);
        const smr_status status = smr_set_log(s, log + 1, bytes); /* of any alignment */
        assert_int_equal(bytes < SMR_LOG_HEADER + SMR_LOG_FULL_BYTES ? SMR_E_ARENA : SMR_OK, status);
        assert_int_equal(SMR_OK, smr_set_pose(s, &pose));
        assert_int_equal(SMR_OK, smr_set_surface(s, 0, unit_recorded.surface[0]));
        (void)rig_run(s, 4);
        assert_true(smr_state_hash(s) == smr_state_hash(plain));
        assert_int_equal(SMR_OK, smr_get_log(s, &is));
        assert_true(is.bytes <= bytes && is.n_ticks <= 4u && is.full == (status == SMR_OK && is.n_ticks < 4u));
        for (size_t i = 1u + is.bytes; i < sizeof log; i++)
            assert_int_equal(0xa5, log[i]); /* nothing behind it was written */
        if (status != SMR_OK)
            continue;
        smr_log_reader reader;
        smr_log_record r = {0};
        uint32_t ticks = 0;
        assert_int_equal(SMR_OK, smr_log_open(log + 1, is.bytes, &reader, NULL));
        do {
            assert_int_equal(SMR_OK, smr_log_next(&reader, &r));
            ticks += r.kind == SMR_LOG_TICK;
        } while (r.kind != 0u && r.kind != SMR_LOG_FULL);
        assert_true(ticks == is.n_ticks && (r.kind == SMR_LOG_FULL) == (is.full == 1u));
    }
}

TEST(test_bytes_macro)
{
    assert_true(SMR_LOG_BYTES(40, 3) >= unit_recorded.bytes);
    assert_true(SMR_LOG_BYTES(1, 0) - SMR_LOG_BYTES(0, 0) >= SMR_LOG_FRAME + 4u * smr_log_words(SMR_LOG_TICK));
    for (uint32_t kind = SMR_LOG_SURFACE; kind <= SMR_LOG_FIXED_SURFACE; kind++) {
        assert_true(SMR_LOG_BYTES(0, 1) - SMR_LOG_BYTES(0, 0) >= SMR_LOG_FRAME + 4u * smr_log_words(kind));
        assert_true(smr_log_words(kind) >= 1u && smr_log_words(kind) <= SMR_LOG_WORDS);
    }
    assert_int_equal(0, smr_log_words(0));
    assert_int_equal(0, smr_log_words(99));
}

TEST(test_refusals)
{
    static unsigned char log[UNIT_LOG_BYTES];
    static _Alignas(SMR_ALIGN) unsigned char zeros[8192];
    smr *not_one = (smr *)(void *)zeros, *s = unit_log_begin(&unit_recorded, NULL);
    smr_log_state is = {1, 1, 1};
    assert_int_equal(SMR_E_NULL, smr_set_log(NULL, log, sizeof log));
    assert_int_equal(SMR_E_STATE, smr_set_log(not_one, log, sizeof log));
    assert_int_equal(SMR_E_NULL, smr_get_log(NULL, &is));
    assert_int_equal(SMR_E_NULL, smr_get_log(s, NULL));
    assert_int_equal(SMR_E_STATE, smr_get_log(not_one, &is));
    assert_int_equal(SMR_OK, smr_get_log(s, &is));
    assert_true(is.bytes == 0u && is.n_ticks == 0u && is.full == 0u);
    assert_int_equal(SMR_OK, smr_set_log(s, log, sizeof log));
    assert_int_equal(SMR_OK, smr_set_log(s, log, sizeof log)); /* still right after smr_init */
    assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
    assert_int_equal(SMR_E_STATE, smr_set_log(s, log, sizeof log));
    assert_int_equal(SMR_OK, smr_get_log(s, &is));
    assert_int_equal(1, is.n_ticks);
    assert_int_equal(SMR_E_INPUT,
                     smr_set_surface(s, 7, unit_recorded.surface[0])); /* what is refused is not recorded */
    const size_t before = is.bytes;
    assert_int_equal(SMR_OK, smr_get_log(s, &is));
    assert_int_equal(before, is.bytes);
    assert_int_equal(SMR_OK, smr_set_log(s, NULL, 0));
    assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
    assert_int_equal(SMR_OK, smr_get_log(s, &is));
    assert_int_equal(0, is.bytes);
}

int main(void) { return suite_run(unit_log_set_up, unit_log_tidy); }
