/* prepare_plan_layout.c: the arrays of smr_plan in the caller's scratch memory; the same code measures and places them.
 * SPDX-License-Identifier: MIT */
#include "prepare/prepare_plan.h"

void smr_plan_layout(smr_arena *a, smr_plan *p)
{
    const size_t n = p->n, nt = p->nt, u = sizeof(uint32_t);
    const size_t pairs = (size_t)p->block_size * (SMR_NEAREST + SMR_NEIGHBOURS_TRIED + 1u);
    size_t most = n > 6u * nt ? n : 6u * nt; /* neighbours of all vertices before duplicates are removed */
    most = most > pairs ? most : pairs;
    const int geodesic = p->config->distance == SMR_DISTANCE_GEODESIC;
    p->xyz = smr_arena_take(a, n, 3u * sizeof(float));
    p->mass = smr_arena_take(a, n, sizeof(float));
    p->owner = smr_arena_take(a, n, sizeof(uint16_t));
    p->position = smr_arena_take(a, n, u);
    p->original = smr_arena_take(a, n, u);
    p->triangle = smr_arena_take(a, nt, 3u * u);
    p->triangle_index = smr_arena_take(a, nt, u);
    p->neighbour_start = smr_arena_take(a, n + 1u, u);
    p->neighbour = smr_arena_take(a, nt, 6u * u);
    p->dihedral = smr_arena_take(a, nt + (nt + 1u) / 2u, sizeof(smr_stored_dihedral));
    const int image = p->config->reference != NULL;
    p->profile = image ? smr_arena_take(a, n, p->config->profile_samples) : NULL;
    p->range = image ? smr_arena_take(a, n, 2u * sizeof(float)) : NULL;
    p->normal = image ? smr_arena_take(a, n, 3u * sizeof(float)) : NULL;
    smr_tree_shape(&p->points, p->n);
    p->points.node = smr_arena_take(a, smr_tree_nodes(p->n), sizeof(smr_node));
    p->priority.list = smr_arena_take(a, n, u);
    p->priority.place = smr_arena_take(a, n, u);
    p->priority.witness = smr_arena_take(a, n, u);
    p->priority.next = smr_arena_take(a, n, u);
    p->member = p->priority.witness;
    p->level = p->priority.next;
    p->priority.bucket = smr_arena_take(a, n + 1u, u);
    p->stored = smr_arena_take(a, n, u);
    p->along = smr_arena_take(a, n, u);
    p->row = smr_arena_take(a, p->n_rows, (p->words + (size_t)1u) * sizeof(uint64_t));
    p->count = smr_arena_take(a, n, u);
    p->entry = smr_arena_take(a, n, u);
    p->n_outside = p->entry;
    p->triangle_centre = smr_arena_take(a, nt, 3u * sizeof(float));
    p->key = smr_arena_take(a, most, u);
    p->item = smr_arena_take(a, most, u);
    p->tmp = smr_arena_take(a, most, 2u * u);
    p->forest.nearest = smr_arena_take(a, n, SMR_NEAREST * u);
    p->forest.edge_a = smr_arena_take(a, pairs, u);
    p->forest.edge_b = smr_arena_take(a, pairs, u);
    p->forest.parent = smr_arena_take(a, (size_t)p->block_size + 1u, u);
    p->forest.link_start = smr_arena_take(a, (size_t)p->block_size + 2u, u);
    p->forest.link = smr_arena_take(a, (size_t)p->block_size + 1u, 2u * u);
    p->queue = smr_arena_take(a, n + 1u, u);
    p->geo_distance = geodesic ? smr_arena_take(a, n, u) : NULL;
    p->geo_heap = geodesic ? smr_arena_take(a, 6u * nt + 1u, 2u * u) : NULL;
}
