/* test_hostile_save.c: a save is forged word by word and by many words at once, with a right checksum: it is refused,
 * or the registration runs on and every position stays finite.
 * SPDX-License-Identifier: MIT */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include <stdlib.h>
#include <string.h>

#include "base/bytes.h"
#include "fuzz/fuzz_save.c"

static int tidy(void **state)
{
    (void)state;
    rig_free_all();
    return 0;
}

static const uint32_t hostile[] = {
    0xffffffffu, 0x7fc00000u, 0x7f800000u, 0xff800000u, 0x7f7fffffu,
    0x00000001u, 0x80000000u, 0x49f42400u, 0xc9f42400u, /* +-2e6, the farthest */
    0x3f800000u, 0x000000ffu, 0x0000ffffu, 0x00989680u,
};

#define HOSTILE (sizeof hostile / sizeof hostile[0])

static void put(unsigned char *to, uint32_t word)
{
    word = smr_le32(word);
    memcpy(to, &word, sizeof word);
}

/* Of the arrays every STRIDE-th word, of the fields behind them each one. */
#define STRIDE 61u

static void test_words(void **state)
{
    static unsigned char values[UNIT_SAVE_BYTES];
    size_t end = 0;
    uint32_t ran = 0, refused = 0;
    const unit_save *u = fuzz_saved();
    const size_t first = unit_save_values(u->saved, &end), n = end - first, fields = n - 400u;
    (void)state;
    for (size_t at = 0; at + 4u <= n; at += at < fields ? 4u * STRIDE : 4u) {
        for (uint32_t k = at < fields ? (uint32_t)(at / 4u % 3u) : 0u; k < HOSTILE; k += at < fields ? 3u : 1u) {
            memcpy(values, u->saved + first, n);
            put(values + at, hostile[k]);
            const int result = fuzz_save(values, n);
            if (result < 0)
                fail_msg("word %zu as %08x", at / 4u, (unsigned)hostile[k]);
            ran += (uint32_t)result;
            refused += !result;
        }
    }
    if (getenv("SMR_TEST_SHOW") != NULL)
        print_message("%u forged saves ran, %u were refused\n", ran, refused);
    assert_true(ran > 100u && refused > 300u);
}

/* Whole runs of words at once, at the ends of their ranges. */
static void test_runs_of_words(void **state)
{
    static unsigned char values[UNIT_SAVE_BYTES];
    static const uint32_t legal[] = {0x49f42400u, 0xc9f42400u, 0, 0x49742400u, 1, 0xffffffffu};
    size_t end = 0;
    uint32_t seed = 5, ran = 0;
    const unit_save *u = fuzz_saved();
    const size_t first = unit_save_values(u->saved, &end), n = end - first;
    (void)state;
    for (uint32_t i = 0; i < 300u; i++) {
        memcpy(values, u->saved + first, n);
        for (uint32_t k = 0; k < 1u + i % 4u; k++) {
            const uint32_t from = rig_random(&seed, (uint32_t)n / 4u - 200u), mix = rig_random(&seed, 2);
            uint32_t word = legal[rig_random(&seed, 6)];
            for (uint32_t j = 0; j < 200u; j++) {
                word = mix ? legal[rig_random(&seed, 6)] : word;
                put(values + 4u * (size_t)(from + j), word);
            }
        }
        const int result = fuzz_save(values, n);
        assert_true(result >= 0);
        ran += (uint32_t)result;
    }
    if (getenv("SMR_TEST_SHOW") != NULL)
        print_message("%u forged saves ran\n", ran);
    assert_true(ran > 12u);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_words), cmocka_unit_test(test_runs_of_words)};
    return cmocka_run_group_tests(tests, NULL, tidy);
}
