/* hilbert_curve.c: positions along a Hilbert curve, and a radix sort by such keys.
 * Source: J. Skilling, "Programming the Hilbert curve", AIP Conf. Proc. 707 (2004): axes to transpose.
 * Bounds: a sort is 4 passes over n items.
 * SPDX-License-Identifier: MIT */
#include "geometry/box_tree/hilbert_curve.h"

#define SMR_CURVE_BITS 10u /* per axis */

smr_box smr_box_of(const float *xyz, uint32_t n)
{
    smr_box b = {smr_load(xyz), smr_load(xyz)};
    for (uint32_t i = 1; i < n; i++) {
        smr_vec p = smr_get3(xyz, i);
        b.lo = smr_low(b.lo, p);
        b.hi = smr_high(b.hi, p);
    }
    return b;
}

/* Index of the grid cell at distance v from the box's lower side, 0 .. 2^10 - 1. */
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
        for (int i = 0; i < 3; i++) {
            if (x[i] & q) {
                x[0] ^= mask;
            } else {
                uint32_t t = (x[0] ^ x[i]) & mask;
                x[0] ^= t;
                x[i] ^= t;
            }
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

void smr_curve_sort(uint32_t *key, uint32_t *item, uint32_t *tmp, uint32_t n)
{
    uint32_t *key2 = tmp, *item2 = tmp + n;
    for (uint32_t shift = 0; shift < 32u; shift += 8u) {
        uint32_t start[256] = {0};
        for (uint32_t i = 0; i < n; i++)
            start[(key[i] >> shift) & 255u]++;
        uint32_t sum = 0;
        for (uint32_t d = 0; d < 256u; d++) {
            uint32_t c = start[d];
            start[d] = sum;
            sum += c;
        }
        for (uint32_t i = 0; i < n; i++) {
            uint32_t to = start[(key[i] >> shift) & 255u]++;
            key2[to] = key[i];
            item2[to] = item[i];
        }
        uint32_t *swap = key;
        key = key2;
        key2 = swap;
        swap = item;
        item = item2;
        item2 = swap;
    } /* after an even number of passes the result is in the caller's arrays */
}
