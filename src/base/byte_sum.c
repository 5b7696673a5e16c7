/* byte_sum.c: a checksum that a change of one word always changes, at half an instruction a byte.
 * Method: each of four lanes turns its sum by five bits and adds a word. Both can be undone, so one other word always
 * gives another sum. The lanes are joined in the same way.
 * SPDX-License-Identifier: MIT */
#include "base/bytes.h"

/* Four words at once, of any type. */
typedef uint32_t four_words __attribute__((vector_size(16), aligned(4), may_alias));

static uint32_t add(uint32_t sum, uint32_t word) { return (sum << 5 | sum >> 27) + word; }

/* The address sanitiser would report red zones between slots, which sums of whole memories include. */
__attribute__((no_sanitize_address)) uint32_t smr_byte_sum(uint32_t sum, const void *data, size_t n)
{
    const unsigned char *p = data;
    four_words lane = {0, 0, 0, 0};
    if ((uintptr_t)p % 4u == 0u) /* voxels of one byte may lie anywhere */
        for (; n >= sizeof lane; n -= sizeof lane, p += sizeof lane)
            lane = (lane << 5 | lane >> 27) + *(const four_words *)(const void *)p;
    for (uint32_t k = 0; k < 4u; k++)
        sum = add(sum, lane[k]);
    for (; n > 0u; n--, p++)
        sum = add(sum, *p);
    return sum;
}
