/* model_open_lists.c: checks of lists, and of those of a model's radii: indexes, counts, pairs at boundaries, and that
 * each vertex of a block has exactly one entry.
 * Work: one pass over each array, and over a radius' entries once per SMR_WINDOW vertices of a block.
 * SPDX-License-Identifier: MIT */
#include "model/model_open.h"

SMR_SHARED int smr_floats_within(const uint32_t *stored, size_t n, float lo, float hi)
{
    int legal = 1;
    for (size_t i = 0; i < n; i++)
        legal &= smr_le_float(stored[i]) >= lo && smr_le_float(stored[i]) <= hi;
    return legal;
}

SMR_SHARED int smr_all_below(const void *list, uint32_t width, size_t n, uint32_t limit)
{
    int legal = 1;
    for (size_t i = 0; i < n; i++)
        legal &= smr_index_at(list, width, i) < limit;
    return legal;
}

static smr_entry32 entry_at(const smr_lists *l, uint32_t i)
{
    const uint32_t width = l->index_bytes;
    const size_t at = 4u * (size_t)i;
    return (smr_entry32){smr_index_at(l->entry, width, at), smr_index_at(l->entry, width, at + 1u),
                         smr_index_at(l->entry, width, at + 2u), smr_index_at(l->entry, width, at + 3u)};
}

/* The radius that is checked now. */
static const smr_stored_radius *radius_of(const void *job)
{
    return smr_model_radius(smr_opened(job), ((const smr_opening *)job)->k);
}
static smr_lists lists_of(const void *job) { return smr_model_lists(smr_opened(job), ((const smr_opening *)job)->k); }

/* Begins a radius, whose sections lie in the model. */
void smr_open_radius(void *job, SMR_UNUSED uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_opening *j = job;
    const smr_stored_radius *r = radius_of(j);
    const uint32_t n = smr_le32(j->m->n_vertices), n_blocks = smr_le32(r->n_blocks);
    const smr_lists l = lists_of(j);
    j->block = j->i = 0;
    j->lo = SMR_NONE;
    j->used = 0;
    smr_open_require(j, n_blocks >= 1u && n_blocks <= n && smr_floats_within(&r->radius, 1, FLT_MIN, SMR_COORD_MAX) &&
                            smr_floats_within(&r->reach, 1, 0.0f, 4.0f * SMR_COORD_MAX) &&
                            smr_floats_within(&r->mean, 1, 0.0f, 1.0e7f) && smr_le32(r->largest) >= 1u &&
                            smr_le32(r->largest) <= n && smr_le32(r->active_min) >= 1u &&
                            smr_le32(r->active_min) <= n && l.members <= n && l.active_min <= l.members &&
                            smr_le32(l.block[0].first) == 0u && smr_le32(l.block[0].first_index) == 0u &&
                            smr_le32(l.block[n_blocks].first) == n &&
                            smr_le32(l.block[n_blocks].first_index) == smr_le32(r->n_indexes));
}

uint32_t smr_open_boundary_tasks(const void *job) { return smr_open_pieces(smr_le32(radius_of(job)->n_boundary)); }

void smr_open_boundary(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    const uint32_t n = smr_le32(smr_opened(job)->n_vertices);
    const smr_stored_boundary *b = smr_at(smr_opened(job), radius_of(job)->at_boundary);
    const smr_piece p = smr_piece_of(task, SMR_OPEN_PIECE, smr_le32(radius_of(job)->n_boundary));
    int legal = 1;
    for (uint32_t i = p.first; i < p.last; i++)
        legal &= smr_le32(b[i].first) < n && smr_le32(b[i].second) < n && smr_le32(b[i].share) <= SMR_BOUNDARY_UNITS;
    smr_open_require(job, legal);
}

uint32_t smr_open_index_tasks(const void *job)
{
    return smr_ceil_div(smr_le32(radius_of(job)->n_indexes), SMR_OPEN_WORDS);
}

void smr_open_indexes(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    const smr_lists l = lists_of(job);
    const smr_piece p = smr_piece_of(task, SMR_OPEN_WORDS, smr_le32(radius_of(job)->n_indexes));
    const unsigned char *from = (const unsigned char *)l.index + (size_t)p.first * l.index_bytes;
    smr_open_require(job, smr_all_below(from, l.index_bytes, p.last - p.first, l.members));
}

void smr_open_counts(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    const smr_lists l = lists_of(job);
    const smr_piece p = smr_piece_of(task, SMR_OPEN_PIECE, smr_le32(smr_opened(job)->n_vertices));
    int legal = 1;
    for (uint32_t v = p.first; v < p.last; v++)
        legal &= smr_list_count(&l, v) != 0u && smr_list_count(&l, v) <= smr_le32(radius_of(job)->largest);
    smr_open_require(job, legal);
}

/* Checks entry i of the current block, `first` .. `last`-1 along the curve. */
static int check_entry(smr_opening *j, const smr_lists *l, uint32_t first, uint32_t last, uint32_t i)
{
    const smr_entry32 e = entry_at(l, i);
    j->used += (uint64_t)e.n_plus + e.n_minus;
    return e.vertex < smr_le32(j->m->n_vertices) && smr_model_along(j->m, e.vertex) - first < last - first &&
           e.parent <= i - first;
}

/* Marks the vertex of entry i when the window holds it. Returns 0 when it is marked already. */
static int mark_entry(smr_opening *j, const smr_lists *l, uint32_t i)
{
    const uint32_t v = smr_model_along(j->m, entry_at(l, i).vertex) - j->lo, bit = 1u << (v % 32u);
    if (v >= SMR_WINDOW)
        return 1;
    const uint32_t known = j->visited[v / 32u] & bit;
    j->visited[v / 32u] |= bit;
    return known == 0u;
}

/* Goes on behind the entries of a block: to its first window, the next one or the next block. */
static int next_window(smr_opening *j, uint32_t first, uint32_t last, uint64_t n_indexes)
{
    const int legal = j->lo != SMR_NONE || j->used == n_indexes;
    memset(j->visited, 0, sizeof j->visited);
    j->i = 0;
    j->lo = j->lo == SMR_NONE ? first : j->lo + SMR_WINDOW;
    if (j->lo < last)
        return legal;
    j->block++;
    j->lo = SMR_NONE;
    j->used = 0;
    return legal;
}

/* Checks a piece of the blocks: each vertex of a block has exactly one entry, found window by window. */
SMR_SELDOM void smr_open_blocks(void *job, SMR_UNUSED uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_opening *j = job;
    const smr_lists l = lists_of(j);
    const uint32_t n = smr_le32(j->m->n_vertices), n_blocks = smr_le32(radius_of(j)->n_blocks);
    int legal = 1;
    for (uint32_t left = SMR_OPEN_PIECE; legal && left > 0u && j->block < n_blocks; left--) {
        const smr_stored_block *b = &l.block[j->block];
        const uint32_t first = smr_le32(b[0].first), last = smr_le32(b[1].first);
        const uint32_t from = smr_le32(b[0].first_index), to = smr_le32(b[1].first_index);
        if (first >= last || last > n || from > to || to > smr_le32(radius_of(j)->n_indexes)) {
            legal = 0;
            break;
        }
        for (; left > 1u && j->i < last - first && legal; left--, j->i++)
            legal = j->lo == SMR_NONE ? check_entry(j, &l, first, last, first + j->i) : mark_entry(j, &l, first + j->i);
        if (j->i == last - first)
            legal &= next_window(j, first, last, to - from);
    }
    smr_open_require(j, legal);
    if (j->block < n_blocks)
        smr_job_again(&j->head);
}
