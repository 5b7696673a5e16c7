/* cluster_bit_rows.h: a set of vertices as a row of bits, bit v for the vertex with the number v along the curve.
 * Clusters are computed as such rows.
 * A row of `words` 64-bit words has one more word behind it: first | last << 32. Only the words first .. last - 1 may
 * hold bits, so small clusters cost little in large models.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_CLUSTER_BIT_ROWS_H
#define SMR_CLUSTER_BIT_ROWS_H

#include "base/base.h"

static inline uint32_t smr_row_first(const uint64_t *row, uint32_t words) { return (uint32_t)row[words]; }
static inline uint32_t smr_row_last(const uint64_t *row, uint32_t words) { return (uint32_t)(row[words] >> 32); }

/* Extends the range of words that may hold bits by the words first .. last - 1. */
static inline void smr_row_cover(uint64_t *row, uint32_t words, uint32_t first, uint32_t last)
{
    first = smr_min_u32(first, smr_row_first(row, words));
    last = smr_max_u32(last, smr_row_last(row, words));
    row[words] = (uint64_t)last << 32 | first;
}

/* Adds the vertex `bit` to the row. */
static inline void smr_row_set(uint64_t *row, uint32_t words, uint32_t bit)
{
    row[bit / 64u] |= (uint64_t)1 << (bit % 64u);
    smr_row_cover(row, words, bit / 64u, bit / 64u + 1u);
}

/* Empties the row. */
static inline void smr_row_clear(uint64_t *row, uint32_t words)
{
    for (uint32_t w = smr_row_first(row, words); w < smr_row_last(row, words); w++)
        row[w] = 0;
    row[words] = words;
}

/* Number of vertices in the row: |zeta|. */
uint32_t smr_row_count(const uint64_t *row, uint32_t words);

/* Number of vertices in exactly one of the rows a and b: |zeta+| + |zeta-|. */
uint32_t smr_row_difference_count(const uint64_t *a, const uint64_t *b, uint32_t words);

#endif
