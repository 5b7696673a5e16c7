/* cluster_bit_rows.c: counts the vertices of clusters and of differences between two clusters, as rows of bits.
 * Method: bits are counted side by side within bytes, without a branch.
 * Bounds: the words of the rows' ranges.
 * SPDX-License-Identifier: MIT */
#include "prepare/cluster_bit_rows.h"

#define SMR_TOGETHER 31u /* words whose counts a byte can sum: 8 bits a word, 255 at most */

static uint64_t bits_per_byte(uint64_t x)
{
    x = x - (x >> 1 & 0x5555555555555555u);
    x = (x & 0x3333333333333333u) + (x >> 2 & 0x3333333333333333u);
    return (x + (x >> 4)) & 0x0f0f0f0f0f0f0f0fu;
}

uint32_t smr_row_count(const uint64_t *row, uint32_t words)
{
    uint32_t count = 0;
    for (uint32_t w = smr_row_first(row, words); w < smr_row_last(row, words); w++)
        count += (uint32_t)((bits_per_byte(row[w]) * 0x0101010101010101u) >> 56);
    return count;
}

uint32_t smr_row_difference_count(const uint64_t *a, const uint64_t *b, uint32_t words)
{
    const uint32_t last = smr_max_u32(smr_row_last(a, words), smr_row_last(b, words));
    uint32_t count = 0;
    for (uint32_t w = smr_min_u32(smr_row_first(a, words), smr_row_first(b, words)), end; w < last; w = end) {
        uint64_t bytes = 0;
        end = smr_min_u32(w + SMR_TOGETHER, last);
        for (size_t i = w; i < end; i++)
            bytes += bits_per_byte(a[i] ^ b[i]);
        bytes = (bytes & 0x00ff00ff00ff00ffu) + (bytes >> 8 & 0x00ff00ff00ff00ffu);
        count += (uint32_t)((bytes * 0x0001000100010001u) >> 48);
    }
    return count;
}
