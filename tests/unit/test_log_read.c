/* test_log_read.c: reading a log trusts nothing. Logs cut at every length, with every bit flipped, or forged with
 * correct checksums are refused or read within their limits; nothing outside the bytes is touched, and reading ends.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <stdlib.h>
#include <string.h>
#include "log/record/log_format.h"
#include "unit/unit_log.h"

/* Reads the whole log from memory of exactly its size, so that a sanitiser sees any read beyond it. Returns the
 * number of records, or -1 when refused; *seen counts the records before that. */
static int read_all(const unsigned char *log, size_t bytes, uint32_t *seen)
{
    unsigned char *copy = malloc(bytes + 1u);
    smr_log_reader reader;
    smr_log_record r;
    int n = -1;
    *seen = 0;
    assert_non_null(copy);
    memcpy(copy, log, bytes);
    if (smr_log_open(copy, bytes, &reader, NULL) == SMR_OK) {
        for (n = 0; n >= 0;) {
            const size_t before = reader.at;
            const smr_status status = smr_log_next(&reader, &r);
            if (status != SMR_OK) {
                assert_true(status == SMR_E_LOG && r.kind == 0u && reader.at == before);
                n = -1;
                break;
            }
            if (r.kind == 0u)
                break;
            assert_true(reader.at > before && reader.at <= bytes && r.kind <= SMR_LOG_FIXED_SURFACE);
            assert_true(r.present <= 1u && r.phase < SMR_PHASES && r.complete <= 1u && r.done <= 1u);
            n++;
            ++*seen;
        }
    }
    free(copy);
    return n;
}

TEST(test_whole)
{
    uint32_t seen;
    assert_int_equal(43, read_all(unit_recorded.log, unit_recorded.bytes, &seen)); /* 40 ticks, a pose, two surfaces */
}

/* Cut between two records it is a shorter log; anywhere else it is damaged. */
TEST(test_cut)
{
    uint32_t seen, whole = 0;
    for (size_t bytes = 0; bytes < unit_recorded.bytes; bytes++) {
        const int n = read_all(unit_recorded.log, bytes, &seen);
        whole += n >= 0;
        assert_true(n < 0 || (uint32_t)n + 1u == whole);
    }
    assert_int_equal(43, whole);
}

TEST(test_every_bit)
{
    static unsigned char log[UNIT_LOG_BYTES];
    uint32_t seen;
    for (size_t bit = 0; bit < 8u * unit_recorded.bytes; bit++) {
        memcpy(log, unit_recorded.log, unit_recorded.bytes);
        log[bit / 8u] = (unsigned char)(log[bit / 8u] ^ 1u << bit % 8u);
        assert_int_equal(-1, read_all(log, unit_recorded.bytes, &seen));
    }
}

/* Any byte replaced by any of a few values, all checksums made right: the checks of fields are alone now. */
TEST(test_forged)
{
    static const unsigned char value[] = {0, 1, 2, 3, 7, 8, 12, 0x28, 0x7f, 0x80, 0xff};
    static unsigned char log[UNIT_LOG_BYTES];
    uint32_t seen, refused = 0;
    for (size_t at = 0; at < unit_recorded.bytes; at++) {
        for (size_t k = 0; k < sizeof value; k++) {
            memcpy(log, unit_recorded.log, unit_recorded.bytes);
            log[at] = value[k];
            unit_log_seal(log, unit_recorded.bytes);
            const int fails = read_all(log, unit_recorded.bytes, &seen) < 0;
            assert_true(fails || at >= 4u || log[at] == unit_recorded.log[at]); /* the first word names a log */
            refused += (uint32_t)fails;
        }
    }
    assert_true(refused > unit_recorded.bytes); /* heads, lengths, kinds, flags */
}

/* ---------------------------------------------------------------- the configuration in the header */

/* A log without records: these words as its configuration. Returns what opening it says. */
static smr_status open_header(uint32_t version, const uint32_t *word, uint32_t n_words, smr_config *config)
{
    static unsigned char log[4096];
    const uint32_t bytes = SMR_LOG_FIXED + 4u * n_words + 4u;
    const uint32_t fixed[SMR_LOG_FIXED / 4u] = {SMR_LOG_MAGIC, version, bytes, 1, 2, 3, n_words};
    smr_log_reader reader;
    smr_log_record r;
    smr_log_info info;
    assert_true(bytes <= sizeof log);
    for (uint32_t i = 0; i < SMR_LOG_FIXED / 4u; i++)
        smr_log_put32(log + 4u * i, fixed[i]);
    for (uint32_t i = 0; i < n_words; i++)
        smr_log_put32(log + SMR_LOG_FIXED + 4u * i, word[i]);
    smr_log_put32(log + bytes - 4u, smr_crc32(0, log, bytes - 4u));
    const smr_status status = smr_log_open(log, bytes, &reader, &info);
    if (status == SMR_OK) {
        assert_int_equal(1, info.library);
        assert_int_equal(2, info.model_checksum);
        assert_int_equal(3, info.n_vertices);
        assert_int_equal(SMR_OK, smr_log_next(&reader, &r));
        assert_int_equal(0, r.kind);
        *config = info.config;
    }
    return status;
}

static uint32_t bits(float v)
{
    uint32_t word;
    memcpy(&word, &v, sizeof word);
    return word;
}

/* Settings have their number: in any order, and what is not there has its default, or 0 where older logs lack it. */
TEST(test_settings_by_number)
{
    smr_config standard = smr_config_default();
    standard.motion.settle_share = standard.motion.strain_most = 0.0f;
    standard.image.rest = 0;
    standard.forces.curvature = 0.0f;
    const uint32_t word[] = {1u << 16 | 44u, 7, 3u << 16 | 16u, bits(1), bits(2), bits(3), 1u << 16 | 3u, bits(0.25f)};
    const uint32_t unknown[] = {1u << 16 | 65535u, 7}, longer[] = {2u << 16 | 44u, 7, 7},
                   twice[] = {word[0], 7, word[0], 7};
    smr_config c, want = standard;
    assert_int_equal(SMR_OK, open_header(SMR_LOG_VERSION, word, 8, &c));
    want.basic.iterations_last = 7;
    want.forces.box_max[0] = 1;
    want.forces.box_max[1] = 2;
    want.forces.box_max[2] = 3;
    want.forces.stiffness = 0.25f;
    assert_memory_equal(&c, &want, sizeof c);
    assert_int_equal(SMR_OK, open_header(SMR_LOG_VERSION, word, 0, &c));
    assert_memory_equal(&c, &standard, sizeof c);
    assert_int_equal(SMR_OK, open_header(2, word, 0, &c)); /* before targets could show parts */
    assert_int_equal(SMR_COVERAGE_WHOLE, c.partial.coverage);
    for (uint32_t n = 1; n < 8u; n++)
        assert_int_equal(n == 2u || n == 6u ? SMR_OK : SMR_E_LOG, open_header(SMR_LOG_VERSION, word, n, &c));
    assert_int_equal(SMR_E_LOG, open_header(SMR_LOG_VERSION, unknown, 2, &c));
    assert_int_equal(SMR_E_LOG, open_header(SMR_LOG_VERSION, longer, 3, &c));
    assert_int_equal(SMR_E_LOG, open_header(SMR_LOG_VERSION, twice, 4, &c));
}

/* Version 1 is the struct of library 0.1: the cookie, then 44 words in an order that stays. */
TEST(test_version_1)
{
    uint32_t word[46] = {0x520100b4u};
    smr_config c;
    for (uint32_t i = 1; i < 46u; i++)
        word[i] = 100u + i;
    word[3] = bits(0.5f);
    word[15] = bits(15.0f);
    word[28] = bits(28.0f);
    assert_int_equal(SMR_OK, open_header(1, word, 45, &c));
    assert_true(c.cookie == smr_config_default().cookie && c.basic.n_workers == 101u &&
                c.basic.n_target_vertices == 102u);
    assert_true(c.forces.stiffness == 0.5f && c.forces.box_min[2] == 15.0f && c.image.fill == 28.0f &&
                c.basic.iterations_last == 144u);
    assert_int_equal(SMR_COVERAGE_WHOLE, c.partial.coverage); /* there was nothing else */
    assert_true(c.forces.node_budget == 119u && c.basic.method == 129u && c.schedule.radius_last == 142u);
    for (uint32_t version = 0; version < 9u; version++)
        for (uint32_t n = 44; n <= 46u; n++)
            assert_int_equal(version == 1u && n == 45u ? SMR_OK : SMR_E_LOG, open_header(version, word, n, &c));
}

/* Lengths in the header that do not agree, with a right checksum where one would be read. */
TEST(test_header_lengths)
{
    static const uint32_t value[] = {0, 4, 27, 28, 32, 36, 211, 212, 1000, 4096, 0x40000000u, 0x7fffffffu, 0xffffffffu};
    static unsigned char log[UNIT_LOG_BYTES];
    smr_log_reader reader;
    for (size_t i = 0; i < sizeof value / sizeof value[0]; i++) {
        for (size_t k = 0; k < sizeof value / sizeof value[0]; k++) {
            memcpy(log, unit_recorded.log, unit_recorded.bytes);
            smr_log_put32(log + 8, value[i]);
            smr_log_put32(log + 24, value[k]);
            if (value[i] >= 32u && value[i] <= unit_recorded.bytes)
                smr_log_put32(log + value[i] - 4u, smr_crc32(0, log, value[i] - 4u));
            const int empty = value[i] == 32u && value[k] == 0u;
            assert_int_equal(empty ? SMR_OK : SMR_E_LOG, smr_log_open(log, unit_recorded.bytes, &reader, NULL));
        }
    }
}

TEST(test_refusals)
{
    smr_log_reader reader = {NULL, 0, 0, 0}, untouched = reader;
    smr_log_record r;
    smr_log_info info;
    assert_int_equal(SMR_E_NULL, smr_log_open(NULL, 9, &reader, &info));
    assert_int_equal(SMR_E_NULL, smr_log_open(unit_recorded.log, unit_recorded.bytes, NULL, &info));
    assert_int_equal(SMR_E_LOG, smr_log_open(unit_recorded.log, 3, &reader, &info));
    assert_memory_equal(&reader, &untouched, sizeof reader);
    assert_int_equal(SMR_E_NULL, smr_log_next(NULL, &r));
    assert_int_equal(SMR_E_NULL, smr_log_next(&reader, NULL));
    assert_int_equal(SMR_E_LOG, smr_log_next(&reader, &r)); /* not opened */
    assert_int_equal(SMR_OK, smr_log_open(unit_recorded.log, unit_recorded.bytes, &reader, &info));
    assert_memory_equal(&info.config, &unit_recorded.config, sizeof info.config);
    assert_int_equal(unit_recorded.ball.n_vertices, info.n_vertices);
    reader.at = reader.bytes + 1u; /* a reader that somebody moved */
    assert_int_equal(SMR_E_LOG, smr_log_next(&reader, &r));
}

int main(void) { return suite_run(unit_log_set_up, unit_log_tidy); }
