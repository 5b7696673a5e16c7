/* test_crc.c: the table-driven checksum equals the bitwise one, over all bytes at once and continued over several
 * calls.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include "base/bytes.h"
#include "oracle.h"

TEST(known_values)
{
    assert_int_equal(smr_crc32(0, "123456789", 9), 0xcbf43926u);
    assert_int_equal(smr_crc32(0, "", 0), 0);
    assert_int_equal(smr_crc32(0, "\0\0\0\0", 4), 0x2144df1cu);
    assert_int_equal(smr_crc32(0, "a", 1), 0xe8b7be43u);
}

TEST(equals_bitwise)
{
    unsigned char data[513];
    oracle_random r = oracle_seed(1);
    for (size_t i = 0; i < sizeof data; i++)
        data[i] = (unsigned char)oracle_next(&r);
    for (size_t n = 0; n <= sizeof data; n++)
        assert_int_equal(smr_crc32(0, data, n), oracle_crc(data, n));
}

TEST(pieces_equal_the_whole)
{
    unsigned char data[257];
    oracle_random r = oracle_seed(2);
    for (size_t i = 0; i < sizeof data; i++)
        data[i] = (unsigned char)oracle_next(&r);
    const uint32_t whole = smr_crc32(0, data, sizeof data);
    for (size_t cut = 0; cut <= sizeof data; cut++)
        assert_int_equal(smr_crc32(smr_crc32(0, data, cut), data + cut, sizeof data - cut), whole);
}

TEST(little_endian_helpers)
{
    const unsigned char two[2] = {0x34, 0x12}, four[4] = {0x78, 0x56, 0x34, 0x12};
    uint16_t a;
    uint32_t b;
    memcpy(&a, two, sizeof a);
    memcpy(&b, four, sizeof b);
    assert_int_equal(smr_le16(a), 0x1234);
    assert_int_equal(smr_le32(b), 0x12345678);
    assert_true(smr_le_float(smr_le32(smr_float_bits(-1.25f))) == -1.25f);
    assert_int_equal(smr_float_bits(1.0f), 0x3f800000);
}
