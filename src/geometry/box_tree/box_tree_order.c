/* box_tree_order.c: sorts triangles, at once or in steps, into the tree order, which makes the box tree's nodes
 * compact.
 * Method: a k-d tree. A range is sorted along the longest side of its box and split near the middle, where the left
 * half is a whole number of nodes, down to single leaves.
 * Bounds: every level sorts each range once; at most 3 levels of splits for each level of the box tree.
 * SPDX-License-Identifier: MIT */
#include "base/bytes.h"
#include "geometry/box_tree/box_tree.h"
#include "geometry/box_tree/hilbert_curve.h"
#include "geometry/box_tree/triangle.h"

/* Returns the sort key of v: unsigned keys are in the order of their floats, and the keys of -0 and 0 are equal. */
static uint32_t sortable(float v)
{
    const uint32_t bits = smr_float_bits(v + 0.0f); /* + 0 turns -0 into 0 */
    return bits & 0x80000000u ? ~bits : bits | 0x80000000u;
}

void smr_order_start(smr_order *o, uint32_t n, const float *centre, uint32_t *order, uint32_t *key, uint32_t *tmp,
                     uint32_t *count)
{
    *o = (smr_order){.centre = centre, .order = order, .key = key, .tmp = tmp, .count = count, .n = n};
    o->stack[1] = n; /* the first range to sort is 0 .. n - 1, all triangles */
    o->top = 2;
}

/* Pops the next range to sort, larger than a leaf, and pushes that range's halves. Returns 0 when no range is left. */
static int next_range(smr_order *o)
{
    while (o->top > 0u) {
        const uint32_t last = o->stack[--o->top], first = o->stack[--o->top], n = last - first;
        uint32_t node = SMR_TREE_WIDTH;
        if (n <= SMR_TREE_WIDTH)
            continue;
        while (n / SMR_TREE_WIDTH >= node && n > node * SMR_TREE_WIDTH)
            node *= SMR_TREE_WIDTH;
        const uint32_t middle = first + (smr_ceil_div(n, node) + 1u) / 2u * node; /* end of half of the nodes */
        o->stack[o->top++] = middle;
        o->stack[o->top++] = last;
        o->stack[o->top++] = first;
        o->stack[o->top++] = middle;
        o->first = first;
        o->size = n;
        return 1;
    }
    return 0;
}

static const float *point_of(const smr_order *o, uint32_t i)
{
    return o->centre + 3u * (size_t)smr_index(o->order[o->first + i], o->n);
}

static void grow_box(smr_order *o, uint32_t from, uint32_t to)
{
    for (uint32_t a = 0; from == 0u && a < 3u; a++)
        o->lo[a] = o->hi[a] = point_of(o, 0)[a];
    for (uint32_t i = from; i < to; i++) {
        const smr_vec p = smr_load(point_of(o, i));
        smr_store(o->lo, smr_low(smr_load(o->lo), p));
        smr_store(o->hi, smr_high(smr_load(o->hi), p));
    }
}

/* Writes sort keys from .. to-1 of the range: the centres' coordinates along the longest side of the range's box. */
static void make_keys(smr_order *o, uint32_t from, uint32_t to)
{
    uint32_t axis = o->hi[1] - o->lo[1] > o->hi[0] - o->lo[0] ? 1u : 0u;
    if (o->hi[2] - o->lo[2] > o->hi[axis] - o->lo[axis])
        axis = 2u;
    for (uint32_t i = from; i < to; i++)
        o->key[i] = sortable(point_of(o, i)[axis]);
}

#define SMR_ORDER_COST 3u /* cost of sorting a small range at once, in visits to each triangle of the range */

/* Stages of sorting a range: find the box, make the keys, then count and move for each byte of the keys. */
enum { SMR_ORDER_BOX = 0, SMR_ORDER_KEYS, SMR_ORDER_SORT, SMR_ORDER_SORTED = SMR_ORDER_SORT + 2 * SMR_SORT_PASSES };

/* Advances to the next stage of the range. A small range is sorted completely once its keys are made. */
static void advance(smr_order *o)
{
    o->at = 0;
    o->stage++;
    if (o->stage == SMR_ORDER_SORT && o->size <= SMR_SORT_SMALL) {
        smr_curve_sort(o->key, o->order + o->first, o->tmp, o->size);
        o->stage = SMR_ORDER_SORTED;
    }
    if (o->stage == SMR_ORDER_SORTED)
        o->size = 0;
}

int smr_order_step(smr_order *o, uint32_t most)
{
    while (most > 0u) {
        if (o->size == 0u) {
            if (!next_range(o))
                return 1;
            o->stage = o->at = 0;
        }
        const uint32_t to = smr_min_u32(o->size, o->at + smr_min_u32(most, o->size)), done = to - o->at;
        const smr_sort sort = {o->key, o->order + o->first, o->tmp, o->count, o->size};
        if (o->stage == SMR_ORDER_BOX)
            grow_box(o, o->at, to);
        else if (o->stage == SMR_ORDER_KEYS)
            make_keys(o, o->at, to);
        else if (o->stage % 2u == 0u)
            smr_sort_count(&sort, (o->stage - SMR_ORDER_SORT) / 2u, o->at, to);
        else
            smr_sort_move(&sort, (o->stage - SMR_ORDER_SORT) / 2u, o->at, to);
        o->at = to;
        most -= done;
        if (to < o->size)
            continue;
        advance(o);
        if (o->size == 0u && done <= SMR_SORT_SMALL) /* a small range was sorted at once */
            most -= smr_min_u32(most, SMR_ORDER_COST * done);
    }
    return 0;
}

void smr_mesh_centres(const smr_mesh *mesh, float *centre, uint32_t *order, uint32_t first, uint32_t last)
{
    for (uint32_t k = first; k < last; k++) {
        const smr_corner_values v = smr_corners_of(mesh->xyz, mesh->triangles + 3u * (size_t)k);
        smr_put3(centre, k, smr_add(v.a, smr_add(v.b, v.c)));
        order[k] = k;
    }
}

void smr_mesh_order(const smr_mesh *mesh, uint32_t *order, float *centre, uint32_t *key, uint32_t *tmp)
{
    uint32_t count[SMR_SORT_BYTES];
    smr_order o;
    smr_mesh_centres(mesh, centre, order, 0, mesh->n_triangles);
    smr_order_start(&o, mesh->n_triangles, centre, order, key, tmp, count);
    while (!smr_order_step(&o, UINT32_MAX)) {
    }
}
