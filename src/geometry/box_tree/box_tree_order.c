/* box_tree_order.c: the tree order of triangles, which makes the nodes of the box tree compact.
 * Method: a k-d tree. A range is sorted along the longest side of its box and split near the middle, where the left
 * half is a whole number of nodes, down to single leaves.
 * It can be cut into steps, which makes no difference to the order.
 * Bounds: every level sorts each range once; at most 3 levels of splits for each level of the box tree.
 * SPDX-License-Identifier: MIT */
#include "geometry/box_tree/box_tree.h"

/* An unsigned integer with the same order as the float; -0 equals 0. */
static uint32_t sortable(float v)
{
    uint32_t bits;
    v += 0.0f; /* turns -0 into 0 */
    memcpy(&bits, &v, sizeof bits);
    return bits & 0x80000000u ? ~bits : bits | 0x80000000u;
}

/* Sorts item[n] by key[n], stable; for small n. */
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

void smr_order_start(smr_order *o, uint32_t n, const float *centre, uint32_t *order, uint32_t *key, uint32_t *tmp,
                     uint32_t *count)
{
    *o = (smr_order){.centre = centre, .order = order, .key = key, .tmp = tmp, .count = count, .n = n};
    o->stack[1] = n; /* the first range: 0 .. n - 1 */
    o->top = 2;
}

/* Takes the next range to be split from the stack. Returns 0 when there is none. */
static int next_range(smr_order *o)
{
    while (o->top > 0u) {
        const uint32_t last = o->stack[--o->top], first = o->stack[--o->top], n = last - first;
        uint32_t node = SMR_TREE_WIDTH;
        if (n <= SMR_TREE_WIDTH)
            continue;
        while (n / SMR_TREE_WIDTH >= node && n > node * SMR_TREE_WIDTH)
            node *= SMR_TREE_WIDTH;
        const uint32_t children = smr_ceil_div(n, node);
        const uint32_t middle = first + (children + 1u) / 2u * node;
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

static const float *centre_of(const smr_order *o, uint32_t i)
{
    return o->centre + 3u * (size_t)o->order[o->first + i];
}

/* The box around the range's centres. */
static void grow_box(smr_order *o, uint32_t from, uint32_t to)
{
    for (uint32_t a = 0; from == 0u && a < 3u; a++)
        o->lo[a] = o->hi[a] = centre_of(o, 0)[a];
    for (uint32_t i = from; i < to; i++) {
        for (uint32_t a = 0; a < 3u; a++) {
            o->lo[a] = smr_min(o->lo[a], centre_of(o, i)[a]);
            o->hi[a] = smr_max(o->hi[a], centre_of(o, i)[a]);
        }
    }
}

/* Sort keys along the longest side. */
static void make_keys(smr_order *o, uint32_t from, uint32_t to)
{
    uint32_t axis = o->hi[1] - o->lo[1] > o->hi[0] - o->lo[0] ? 1u : 0u;
    if (o->hi[2] - o->lo[2] > o->hi[axis] - o->lo[axis])
        axis = 2u;
    for (uint32_t i = from; i < to; i++)
        o->key[i] = sortable(centre_of(o, i)[axis]);
}

/* Radix sort by bytes, the lowest first, between key and order, and tmp. Pass p counts, then moves. */
static void count_bytes(smr_order *o, uint32_t pass, uint32_t from, uint32_t to)
{
    const uint32_t *const key = pass % 2u == 0u ? o->key : o->tmp;
    for (uint32_t d = 0; from == 0u && d < SMR_ORDER_BYTES; d++)
        o->count[d] = 0;
    for (uint32_t i = from; i < to; i++)
        o->count[(key[i] >> 8u * pass) & 255u]++;
    uint32_t sum = 0;
    for (uint32_t d = 0; to == o->size && d < SMR_ORDER_BYTES; d++) {
        const uint32_t c = o->count[d];
        o->count[d] = sum;
        sum += c;
    }
}

static void move_items(smr_order *o, uint32_t pass, uint32_t from, uint32_t to)
{
    uint32_t *const own_item = o->order + o->first, *const other_item = o->tmp + o->size;
    const uint32_t *const key = pass % 2u == 0u ? o->key : o->tmp;
    const uint32_t *const item = pass % 2u == 0u ? own_item : other_item;
    uint32_t *const to_key = pass % 2u == 0u ? o->tmp : o->key, *const to_item =
                                                                    pass % 2u == 0u ? other_item : own_item;
    for (uint32_t i = from; i < to; i++) {
        const uint32_t at = o->count[(key[i] >> 8u * pass) & 255u]++;
        to_key[at] = key[i];
        to_item[at] = item[i];
    }
}

#define SMR_ORDER_SORTING 3u /* visits of a triangle that sorting a small range at once is worth */

/* Stages of a range: its box, its keys, then counting and moving for each byte. Small ranges are sorted with the
 * keys. */
enum { SMR_ORDER_BOX = 0, SMR_ORDER_KEYS, SMR_ORDER_SORT, SMR_ORDER_SORTED = SMR_ORDER_SORT + 8 };

static void advance(smr_order *o)
{
    o->at = 0;
    o->stage++;
    if (o->stage == SMR_ORDER_SORT && o->size <= SMR_ORDER_SMALL) {
        insertion_sort(o->key, o->order + o->first, o->size);
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
        if (o->stage == SMR_ORDER_BOX)
            grow_box(o, o->at, to);
        else if (o->stage == SMR_ORDER_KEYS)
            make_keys(o, o->at, to);
        else if (o->stage % 2u == 0u)
            count_bytes(o, (o->stage - SMR_ORDER_SORT) / 2u, o->at, to);
        else
            move_items(o, (o->stage - SMR_ORDER_SORT) / 2u, o->at, to);
        o->at = to;
        most -= done;
        if (to < o->size)
            continue;
        advance(o);
        if (o->size == 0u && done <= SMR_ORDER_SMALL) /* a small range was sorted at once */
            most -= smr_min_u32(most, SMR_ORDER_SORTING * done);
    }
    return o->size == 0u && o->top == 0u;
}

void smr_mesh_centres(const smr_mesh *mesh, float *centre, uint32_t *order, uint32_t first, uint32_t last)
{
    for (uint32_t k = first; k < last; k++) {
        const uint32_t *t = mesh->triangles + 3u * (size_t)k;
        const smr_vec sum =
            smr_add(smr_get3(mesh->xyz, t[0]), smr_add(smr_get3(mesh->xyz, t[1]), smr_get3(mesh->xyz, t[2])));
        smr_put3(centre, k, sum);
        order[k] = k;
    }
}

void smr_mesh_order(const smr_mesh *mesh, uint32_t *order, float *centre, uint32_t *key, uint32_t *tmp)
{
    uint32_t count[SMR_ORDER_BYTES];
    smr_order o;
    smr_mesh_centres(mesh, centre, order, 0, mesh->n_triangles);
    smr_order_start(&o, mesh->n_triangles, centre, order, key, tmp, count);
    while (!smr_order_step(&o, UINT32_MAX)) {
    }
}
