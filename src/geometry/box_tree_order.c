/* box_tree_order.c: the tree order of triangles, which makes the nodes of the box tree compact.
 * Method: a k-d tree. A range is sorted along the longest side of its box and split near the middle, where the left
 * half is a whole number of nodes, down to single leaves.
 * Bounds: every level sorts each range once; at most 3 levels of splits for each level of the box tree.
 * SPDX-License-Identifier: MIT */
#include "geometry/hilbert_curve.h"
#include "geometry/mesh.h"
#include "geometry/box_tree.h"

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

/* Sorts order[first .. last-1] by the triangles' centres, along the longest side of the box around these centres. */
static void sort_range(const float *centre, uint32_t *order, uint32_t first, uint32_t last, uint32_t *key,
                       uint32_t *tmp)
{
    const uint32_t n = last - first;
    float lo[3], hi[3];
    for (uint32_t a = 0; a < 3u; a++)
        lo[a] = hi[a] = centre[3u * (size_t)order[first] + a];
    for (uint32_t i = first; i < last; i++) {
        for (uint32_t a = 0; a < 3u; a++) {
            lo[a] = smr_min(lo[a], centre[3u * (size_t)order[i] + a]);
            hi[a] = smr_max(hi[a], centre[3u * (size_t)order[i] + a]);
        }
    }
    uint32_t axis = hi[1] - lo[1] > hi[0] - lo[0] ? 1u : 0u;
    if (hi[2] - lo[2] > hi[axis] - lo[axis])
        axis = 2u;
    for (uint32_t i = 0; i < n; i++)
        key[i] = sortable(centre[3u * (size_t)order[first + i] + axis]);
    if (n > 128u)
        smr_curve_sort(key, order + first, tmp, n);
    else
        insertion_sort(key, order + first, n);
}

void smr_mesh_order(const smr_mesh *mesh, uint32_t *order, float *centre, uint32_t *key, uint32_t *tmp)
{
    uint32_t stack[2u * 3u * SMR_TREE_LEVELS + 2u], top = 0;
    for (uint32_t k = 0; k < mesh->n_triangles; k++) {
        const uint32_t *t = mesh->triangles + 3u * (size_t)k;
        const smr_vec sum =
            smr_add(smr_load(mesh->xyz + 3u * (size_t)t[0]),
                    smr_add(smr_load(mesh->xyz + 3u * (size_t)t[1]), smr_load(mesh->xyz + 3u * (size_t)t[2])));
        smr_store(centre + 3u * (size_t)k, sum);
        order[k] = k;
    }
    stack[top++] = 0;
    stack[top++] = mesh->n_triangles;
    while (top > 0u) {
        const uint32_t last = stack[--top], first = stack[--top], n = last - first;
        uint32_t node = SMR_TREE_WIDTH;
        if (n <= SMR_TREE_WIDTH)
            continue;
        while (n / SMR_TREE_WIDTH >= node && n > node * SMR_TREE_WIDTH)
            node *= SMR_TREE_WIDTH;
        const uint32_t children = smr_ceil_div(n, node);
        const uint32_t middle = first + (children + 1u) / 2u * node;
        sort_range(centre, order, first, last, key, tmp);
        stack[top++] = middle;
        stack[top++] = last;
        stack[top++] = first;
        stack[top++] = middle;
    }
}
