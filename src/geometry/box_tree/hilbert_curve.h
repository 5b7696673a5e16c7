/* hilbert_curve.h: the space-filling curve along which a model's vertices are numbered, and sorts by 32-bit keys.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_HILBERT_CURVE_H
#define SMR_HILBERT_CURVE_H

#include "base/vec.h"

#define SMR_FAR 1.0e15f /* mm: coordinate that marks an empty box; the square still fits a float */

/* An axis-aligned box, mm. */
typedef struct smr_box {
    smr_vec lo, hi;
} smr_box;

/* Returns a box without points, whose low corner lies above the high one. */
static inline smr_box smr_no_box(void)
{
    return (smr_box){{SMR_FAR, SMR_FAR, SMR_FAR}, {-SMR_FAR, -SMR_FAR, -SMR_FAR}};
}

/* Extends the box by the point p, mm. */
static inline void smr_box_grow(smr_box *box, smr_vec p)
{
    box->lo = smr_low(box->lo, p);
    box->hi = smr_high(box->hi, p);
}

/* Returns 1 when p lies in the box or at most `reach` mm from it along each axis. */
static inline int smr_box_reaches(const smr_box *box, smr_vec p, float reach)
{
    return p.x >= box->lo.x - reach && p.y >= box->lo.y - reach && p.z >= box->lo.z - reach &&
           p.x <= box->hi.x + reach && p.y <= box->hi.y + reach && p.z <= box->hi.z + reach;
}

smr_box smr_box_of(const float *xyz, uint32_t n); /* returns the bounding box of n >= 1 points xyz [n][3], mm */
/* Returns the position of p on a Hilbert curve of 10 bits per axis through the cube around box: 0 .. 2^30 - 1. */
uint32_t smr_curve_key(smr_box box, smr_vec p);

#define SMR_SORT_SMALL 88u  /* largest number of items for which insertion is faster than radix passes */
#define SMR_SORT_BYTES 256u /* number of values of a byte */
#define SMR_SORT_PASSES 4u  /* passes of a radix sort, one a byte of the key, the lowest byte first */

/* Sorts key[n] ascending and item[n] along with it, stable, in place. tmp: [2 n] scratch. */
void smr_curve_sort(uint32_t *key, uint32_t *item, uint32_t *tmp, uint32_t n);

/* A radix sort in steps: each pass counts all items, then moves all items, from the index `from` up to `to`. */
typedef struct smr_sort {
    uint32_t *key, *item, *tmp; /* key [n]: sort keys; item [n]: numbers sorted by key; tmp [2 n]: scratch */
    uint32_t *count;            /* [SMR_SORT_BYTES] scratch: number, then place, of the items with each byte */
    uint32_t n;
} smr_sort;

void smr_sort_count(const smr_sort *s, uint32_t pass, uint32_t from, uint32_t to);
void smr_sort_move(const smr_sort *s, uint32_t pass, uint32_t from, uint32_t to);

#endif
