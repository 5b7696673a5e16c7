/* test_log_read.c: reading a log trusts nothing: cut at every length, every bit turned, forged with right checksums, noise. It is
 * refused, or what is read is within its limits; nothing outside the bytes is touched, and reading ends.
 * SPDX-License-Identifier: MIT */
#include "cmocka_first.h"

#include <stdlib.h>
#include <string.h>

#include "property/rig.h"
#include "runtime/record/log.h"
#include "unit/unit_log.h"

/* Reads all of it from memory of exactly its size, so that a sanitiser sees a step outside. Returns the records, -1 when
 * refused; *seen counts those before that. */
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
            if (r.kind == 0u) {
                break;
            }
            assert_true(reader.at > before && reader.at <= bytes && r.kind <= SMR_LOG_FULL);
            assert_true(r.present <= 1u && r.phase < SMR_PHASES && r.complete <= 1u && r.done <= 1u);
            n++;
            ++*seen;
        }
    }
    free(copy);
    return n;
}

static void test_whole(void **state)
{
    uint32_t seen;
    (void)state;
    assert_int_equal(43, read_all(unit_recorded.log, unit_recorded.bytes, &seen)); /* 40 ticks, a pose, two surfaces */
}

/* Cut between two records it is a shorter log; anywhere else it is damaged. */
static void test_cut(void **state)
{
    uint32_t seen, whole = 0;
    (void)state;
    for (size_t bytes = 0; bytes < unit_recorded.bytes; bytes++) {
        const int n = read_all(unit_recorded.log, bytes, &seen);
        whole += n >= 0;
        assert_true(n < 0 || (uint32_t)n + 1u == whole);
    }
    assert_int_equal(43, whole);
}

static void test_every_bit(void **state)
{
    static unsigned char log[UNIT_LOG_BYTES];
    uint32_t seen;
    (void)state;
    for (size_t bit = 0; bit < 8u * unit_recorded.bytes; bit++) {
        memcpy(log, unit_recorded.log, unit_recorded.bytes);
        log[bit / 8u] = (unsigned char)(log[bit / 8u] ^ 1u << bit % 8u);
        assert_int_equal(-1, read_all(log, unit_recorded.bytes, &seen));
    }
}

/* Any byte replaced by any of a few values, all checksums made right: the checks of fields are alone now. */
static void test_forged(void **state)
{
    static const unsigned char value[] = {0, 1, 2, 3, 7, 8, 12, 0x28, 0x7f, 0x80, 0xff};
    static unsigned char log[UNIT_LOG_BYTES];
    uint32_t seen, refused = 0;
    (void)state;
    for (size_t at = 0; at < unit_recorded.bytes; at++) {
        for (size_t k = 0; k < sizeof value; k++) {
            memcpy(log, unit_recorded.log, unit_recorded.bytes);
            log[at] = value[k];
            unit_log_seal(log, unit_recorded.bytes);
            refused += read_all(log, unit_recorded.bytes, &seen) < 0;
        }
    }
    assert_true(refused > unit_recorded.bytes); /* heads, lengths, kinds, flags */
}

static void test_swapped_and_noise(void **state)
{
    static unsigned char log[UNIT_LOG_BYTES], one[64];
    uint32_t seen, seed = 3;
    size_t bytes = 0, next = 0;
    (void)state;
    memcpy(
        log, unit_recorded.log,
        unit_recorded.bytes); /* two ticks of equal length change places: each one's checksum knows what came before */
    const size_t a = unit_log_record(log, unit_recorded.bytes, 5, &bytes),
                 b = unit_log_record(log, unit_recorded.bytes, 6, &next);
    assert_true(bytes == next && bytes <= sizeof one && b == a + bytes);
    memcpy(one, log + a, bytes);
    memmove(log + a, log + b, bytes);
    memcpy(log + b, one, bytes);
    assert_int_equal(-1, read_all(log, unit_recorded.bytes, &seen));
    assert_int_equal(5, seen);
    for (uint32_t i = 0; i < 20000u; i++) {
        const size_t n = rig_random(&seed, 400), good = rig_random(&seed, 2) ? SMR_LOG_HEADER : 0u;
        memcpy(log, unit_recorded.log, good);
        for (size_t k = good; k < good + n; k++) {
            log[k] = (unsigned char)rig_random(&seed, 256);
        }
        const int got = read_all(log, good + n, &seen);
        assert_true(got < 0 || (good > 0u && n == 0u && got == 0));
    }
}

static void test_refusals(void **state)
{
    smr_log_reader reader = {NULL, 0, 0, 0}, untouched = reader;
    smr_log_record r;
    smr_log_info info;
    (void)state;
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
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_whole),
        cmocka_unit_test(test_cut),
        cmocka_unit_test(test_every_bit),
        cmocka_unit_test(test_forged),
        cmocka_unit_test(test_swapped_and_noise),
        cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, unit_log_set_up, unit_log_tidy);
}
