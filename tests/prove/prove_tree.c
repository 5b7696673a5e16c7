/* prove_tree.c: a tree and its triangles lead nowhere outside their arrays, whatever a fault wrote into boxes, corners,
 * normals, ranks and groups. The tree has two levels and its last leaf is not full.
 * SPDX-License-Identifier: MIT */
#include <stdint.h>

static int lowest_bit(uint32_t bits);
#define __builtin_ctz lowest_bit
#include "geometry/box_tree/box_tree.c"
#include "geometry/box_tree/box_tree_search.c"
#include "geometry/box_tree/triangle.c"
#include "prove.h"

#define PROVE_TRIANGLES 19u
#define PROVE_VERTICES 5u

static float xyz[3u * PROVE_VERTICES], normal[3u * PROVE_TRIANGLES];
static uint32_t corner[3u * PROVE_TRIANGLES], rank[PROVE_TRIANGLES];
static unsigned char group[PROVE_TRIANGLES], use[256];
static smr_node node[4];
static smr_near_list list;

/* The lowest bit of the set, as the compiler's function of the name gives it. */
static int lowest_bit(uint32_t bits)
{
    int k = 0;
    while (!(bits & 1u)) {
        bits >>= 1;
        k++;
    }
    return k;
}

static void any_leaf(const smr_box_tree *f, const smr_tree_mask *mask, const smr_query *q, uint32_t leaf)
{
    float box_d2[SMR_TREE_WIDTH];
    smr_certainty known = {.slack_mm = 1.0f};
    smr_hit warm = {1.0f, SMR_NONE, {0, 0, 0}}, hit = {1.0f, leaf == 1u ? SMR_NONE : 3u, {0, 0, 0}};
    smr_bounds bounds;
    PROVE_HOSTILE(box_d2, sizeof box_d2);
    PROVE_HOSTILE(&bounds, sizeof bounds);
    for (uint32_t k = 0; k < SMR_TREE_WIDTH; k++)
        (void)search_leaf(f, mask, q, leaf * SMR_TREE_WIDTH, 1u << k, box_d2, &warm, &hit, 1.21f, &list, &bounds,
                          &known);
    const uint32_t number = hit.triangle + 1u; /* 0: SMR_NONE */
    //@ assert number <= PROVE_TRIANGLES;
}

/* All corners are vertices, but those of triangle `bad`, which are any numbers: no triangle reads another one's. */
static void any_triangle(smr_box_tree *f, const smr_tree_mask *mask, const smr_query *q, uint32_t bad)
{
    const uint32_t leaf = bad / SMR_TREE_WIDTH;
    for (uint32_t i = 0; i < 3u * PROVE_TRIANGLES; i++)
        corner[i] = PROVE_ANY(0, PROVE_VERTICES - 1u);
    PROVE_HOSTILE(corner + 3u * bad, 3u * sizeof *corner);
    smr_tree_refit_leaves(f, leaf, leaf + 1u);
    PROVE_HOSTILE(normal, sizeof normal);
    PROVE_HOSTILE(node, sizeof node);
    for (list.n = 0; list.n <= SMR_NEAR_MOST; list.n += SMR_NEAR_MOST / 2u) {
        const uint32_t n = list.n;
        any_leaf(f, mask, q, leaf);
        //@ assert list.n <= SMR_NEAR_MOST;
        list.n = n;
    }
}

int main(void)
{
    smr_box_tree f = {
        .xyz = xyz, .triangle = corner, .normal = normal, .node = node, .rank = rank, .n_vertices = PROVE_VERTICES};
    const smr_tree_mask mask = {group, use};
    smr_query q;
    PROVE_HOSTILE(xyz, sizeof xyz);
    PROVE_HOSTILE(rank, sizeof rank);
    PROVE_HOSTILE(group, sizeof group);
    PROVE_HOSTILE(use, sizeof use);
    PROVE_HOSTILE(node, sizeof node);
    PROVE_HOSTILE(&q, sizeof q);
    smr_tree_shape(&f, PROVE_TRIANGLES);
    for (uint32_t bad = 0; bad < PROVE_TRIANGLES; bad += 9u)
        any_triangle(&f, &mask, &q, bad);
    smr_tree_refit_upper(&f);
    return 0;
}
