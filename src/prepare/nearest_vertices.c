/* nearest_vertices.c: the k vertices nearest to a vertex, by search in the box tree over vertices: depth first, and
 * boxes beyond the k-th best distance so far are skipped.
 * Bounds: every node at most once; SMR_NEAREST insertions for each vertex tested.
 * SPDX-License-Identifier: MIT */
#include "prepare/prepare_plan.h"

/* The nearest vertices so far, nearest first. */
typedef struct candidates {
    float d2[SMR_NEAREST];
    uint32_t *found; /* [k] */
    uint32_t n, k;
} candidates;

/* 1 when the list is full and d2 is not below its last distance. */
static int too_far(const candidates *c, float d2) { return c->n == c->k && d2 >= c->d2[c->k - 1u]; }

/* Inserts a vertex at its place; the farthest one drops out of a full list. */
static void insert(candidates *c, uint32_t vertex, float d2)
{
    uint32_t i = c->n < c->k ? c->n++ : c->k - 1u;
    for (; i > 0u && c->d2[i - 1u] > d2; i--) {
        c->d2[i] = c->d2[i - 1u];
        c->found[i] = c->found[i - 1u];
    }
    c->d2[i] = d2;
    c->found[i] = vertex;
}

uint32_t smr_nearest(const smr_plan *p, uint32_t v, uint32_t first, uint32_t last, uint32_t k, uint32_t *found,
                     float *distance2)
{
    const smr_vec centre = smr_get3(p->xyz, v);
    candidates best = {.found = found, .k = k};
    float d2[SMR_TREE_WIDTH];
    smr_visit stack[SMR_TREE_LEVELS * SMR_TREE_WIDTH];
    uint32_t top = 0;
    stack[top++] = (smr_visit){0.0f, p->points.n_levels - 1u, 0u};
    while (top > 0u) {
        const smr_visit at = stack[--top];
        if (too_far(&best, at.d2))
            continue;
        const smr_node *node = &p->points.node[p->points.level[at.level] + at.index];
        (void)smr_box_distances(node, centre, FLT_MAX, d2);
        for (uint32_t c = 0; c < SMR_TREE_WIDTH; c++) {
            /* the child that holds v is pushed last and opened first: small distances are found early */
            const uint32_t child =
                at.index * SMR_TREE_WIDTH + (at.level > 0u ? (c + 1u + (v >> (3u * at.level))) % SMR_TREE_WIDTH : c);
            const float child2 = d2[child % SMR_TREE_WIDTH];
            const uint64_t from = (uint64_t)child << (3u * at.level), to = (uint64_t)(child + 1u) << (3u * at.level);
            if (from >= last || to <= first || from >= p->n || too_far(&best, child2))
                continue;
            if (at.level > 0u)
                stack[top++] = (smr_visit){child2, at.level - 1u, child};
            else if (child != v && !smr_kept_apart(p, child, v))
                insert(&best, child, child2);
        }
    }
    if (distance2 != NULL)
        memcpy(distance2, best.d2, best.n * sizeof best.d2[0]);
    return best.n;
}
