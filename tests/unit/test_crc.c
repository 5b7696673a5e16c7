/* test_crc.c: the table-driven checksum equals the bitwise one, over all bytes at once and continued over several
 * calls.
 * SPDX-License-Identifier: MIT */
#include "cmocka_first.h"

#include "base/bytes.h"
#include "oracle.h"

static void known_values(void **state)
{
    (void)state;
    assert_int_equal(smr_crc32(0, "123456789", 9), 0xcbf43926u);
    assert_int_equal(smr_crc32(0, "", 0), 0);
    assert_int_equal(smr_crc32(0, "\0\0\0\0", 4), 0x2144df1cu);
    assert_int_equal(smr_crc32(0, "a", 1), 0xe8b7be43u);
}

static void equals_bitwise(void **state)
{
    unsigned char data[513];
    oracle_random r = oracle_seed(1);
    (void)state;
    for (size_t i = 0; i < sizeof data; i++)
        data[i] = (unsigned char)oracle_next(&r);
    for (size_t n = 0; n <= sizeof data; n++)
        assert_int_equal(smr_crc32(0, data, n), oracle_crc(data, n));
}

static void pieces_equal_the_whole(void **state)
{
    unsigned char data[257];
    oracle_random r = oracle_seed(2);
    (void)state;
    for (size_t i = 0; i < sizeof data; i++)
        data[i] = (unsigned char)oracle_next(&r);
    const uint32_t whole = smr_crc32(0, data, sizeof data);
    for (size_t cut = 0; cut <= sizeof data; cut++)
        assert_int_equal(smr_crc32(smr_crc32(0, data, cut), data + cut, sizeof data - cut), whole);
}

static void sees_every_single_bit(void **state)
{
    unsigned char data[128] = {0};
    (void)state;
    const uint32_t clean = smr_crc32(0, data, sizeof data);
    for (size_t bit = 0; bit < 8u * sizeof data; bit++) {
        data[bit / 8u] ^= (unsigned char)(1u << bit % 8u);
        assert_int_not_equal(smr_crc32(0, data, sizeof data), clean);
        data[bit / 8u] ^= (unsigned char)(1u << bit % 8u);
    }
}

static void little_endian_helpers(void **state)
{
    const unsigned char two[2] = {0x34, 0x12}, four[4] = {0x78, 0x56, 0x34, 0x12};
    uint16_t a;
    uint32_t b;
    (void)state;
    memcpy(&a, two, sizeof a);
    memcpy(&b, four, sizeof b);
    assert_int_equal(smr_le16(a), 0x1234);
    assert_int_equal(smr_le32(b), 0x12345678);
    assert_true(smr_le_float(smr_le32(smr_float_bits(-1.25f))) == -1.25f);
    assert_int_equal(smr_float_bits(1.0f), 0x3f800000);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(known_values),           cmocka_unit_test(equals_bitwise),
        cmocka_unit_test(pieces_equal_the_whole), cmocka_unit_test(sees_every_single_bit),
        cmocka_unit_test(little_endian_helpers),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
