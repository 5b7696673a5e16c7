/* hilbert_curve.c: positions along a Hilbert curve, and stable sorts by insertion or by radix.
 * Source: J. Skilling, "Programming the Hilbert curve", AIP Conf. Proc. 707 (2004): axes to transpose.
 * Bounds: a sort is 4 passes over n items.
 * SPDX-License-Identifier: MIT */
#include "geometry/box_tree/hilbert_curve.h"

#define SMR_CURVE_BITS 10u /* bits of a position on the curve that each axis gives */

smr_box smr_box_of(const float *xyz, uint32_t n)
{
    smr_box b = {smr_load(xyz), smr_load(xyz)};
    for (uint32_t i = 1; i < n; i++)
        smr_box_grow(&b, smr_get3(xyz, i));
    return b;
}

/* Returns the index of the grid cell at distance v, mm, from the box's lower side, 0 .. 2^10 - 1. */
static uint32_t cell(float v, float scale)
{
    return (uint32_t)smr_clamp(v * scale, 0.0f, (float)((1u << SMR_CURVE_BITS) - 1u));
}

uint32_t smr_curve_key(smr_box box, smr_vec p)
{
    smr_vec size = smr_sub(box.hi, box.lo);
    float side = smr_max(size.x, smr_max(size.y, size.z));
    float scale = side > 0.0f ? (float)(1u << SMR_CURVE_BITS) / side : 0.0f;
    uint32_t x[3] = {cell(p.x - box.lo.x, scale), cell(p.y - box.lo.y, scale), cell(p.z - box.lo.z, scale)};
    for (uint32_t q = 1u << (SMR_CURVE_BITS - 1u); q > 1u; q >>= 1) {
        uint32_t mask = q - 1u;
        for (int i = 0; i < 3; i++)
            if (x[i] & q) {
                x[0] ^= mask;
            } else {
                uint32_t t = (x[0] ^ x[i]) & mask;
                x[0] ^= t;
                x[i] ^= t;
            }
    }
    x[1] ^= x[0];
    x[2] ^= x[1];
    uint32_t t = 0;
    for (uint32_t q = 1u << (SMR_CURVE_BITS - 1u); q > 1u; q >>= 1)
        if (x[2] & q)
            t ^= q - 1u;
    uint32_t key = 0;
    for (uint32_t bit = SMR_CURVE_BITS; bit-- > 0u;)
        for (int i = 0; i < 3; i++)
            key = key << 1 | (((x[i] ^ t) >> bit) & 1u);
    return key;
}

/* Sorts key[n] ascending and item[n] along with it by insertion, stable; fast for small n only. */
static void insertion_sort(uint32_t *key, uint32_t *item, uint32_t n)
{
    for (uint32_t i = 1; i < n; i++) {
        const uint32_t k = key[i], v = item[i];
        uint32_t j = i;
        for (; j > 0u && key[j - 1u] > k; j--) {
            key[j] = key[j - 1u];
            item[j] = item[j - 1u];
        }
        key[j] = k;
        item[j] = v;
    }
}

void smr_sort_count(const smr_sort *s, uint32_t pass, uint32_t from, uint32_t to)
{
    const uint32_t *const key = pass % 2u == 0u ? s->key : s->tmp;
    uint32_t *const count = s->count, sum = 0;
    if (from == 0u)
        memset(count, 0, SMR_SORT_BYTES * sizeof *count);
    for (uint32_t i = from; i < to; i++)
        count[(key[i] >> 8u * pass) & 255u]++;
    for (uint32_t d = 0; to == s->n && d < SMR_SORT_BYTES; d++) { /* count[d] becomes the first place of byte d */
        const uint32_t c = count[d];
        count[d] = sum;
        sum += c;
    }
}

void smr_sort_move(const smr_sort *s, uint32_t pass, uint32_t from, uint32_t to)
{
    const int back = pass % 2u != 0u; /* odd passes move from tmp to the caller's arrays, even ones into tmp */
    uint32_t *const other = s->tmp + s->n, *const count = s->count;
    const uint32_t *const key = back ? s->tmp : s->key, *const item = back ? other : s->item;
    uint32_t *const to_key = back ? s->key : s->tmp, *const to_item = back ? s->item : other;
    for (uint32_t i = from; i < to; i++) {
        const uint32_t at = smr_index(count[(key[i] >> 8u * pass) & 255u]++, s->n); /* a key may have changed since */
        to_key[at] = key[i];
        to_item[at] = item[i];
    }
}

void smr_curve_sort(uint32_t *key, uint32_t *item, uint32_t *tmp, uint32_t n)
{
    uint32_t count[SMR_SORT_BYTES];
    const smr_sort s = {key, item, tmp, count, n};
    if (n <= SMR_SORT_SMALL)
        insertion_sort(key, item, n);
    for (uint32_t pass = 0; n > SMR_SORT_SMALL && pass < SMR_SORT_PASSES; pass++) {
        smr_sort_count(&s, pass, 0, n);
        smr_sort_move(&s, pass, 0, n);
    }
}
