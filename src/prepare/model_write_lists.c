/* model_write_lists.c: writes numbers and sections of the model, little-endian, and the entries of the order L: zeta+
 * and zeta- (paper 2.2, cluster optimisation) as differences between the rows of a cluster and its parent.
 * Bounds: the word range of the rows and their members, SMR_LEVELS_MAX each.
 * SPDX-License-Identifier: MIT */
#include "prepare/prepare_plan.h"

static inline void put_half(unsigned char *to, uint32_t value)
{
    const uint16_t stored = smr_le16((uint16_t)value);
    memcpy(to, &stored, sizeof stored);
}

void smr_put16(smr_writer *w, size_t at, uint32_t value)
{
    if (w->model != NULL && at + 2u <= w->capacity)
        put_half(w->model + at, value);
}

void smr_put32(smr_writer *w, size_t at, uint32_t value)
{
    const uint32_t stored = smr_le32(value);
    if (w->model != NULL && at + sizeof stored <= w->capacity)
        memcpy(w->model + at, &stored, sizeof stored);
}

void smr_put_words(smr_writer *w, size_t at, const uint32_t *word, size_t n)
{
    for (size_t i = 0; i < n; i++)
        smr_put32(w, at + 4u * i, word[i]);
}

size_t smr_put_section(smr_writer *w, size_t bytes)
{
    const size_t at = (w->used + SMR_ALIGN - 1u) / SMR_ALIGN * SMR_ALIGN;
    if (w->model != NULL && w->used < w->capacity)
        memset(w->model + w->used, 0, (at + bytes < w->capacity ? at + bytes : w->capacity) - w->used);
    w->used = at + bytes;
    return at;
}

/* Writes an index, l->index_bytes (2 or 4) wide, at offset `at` of the model. */
static void put_index(const smr_list_writer *l, size_t at, uint32_t value)
{
    if (l->index_bytes == 2u)
        smr_put16(l->w, at, value);
    else
        smr_put32(l->w, at, value);
}

void smr_list_block(smr_list_writer *l)
{
    const size_t at = l->at_blocks + l->n_blocks * sizeof(smr_stored_block);
    smr_put32(l->w, at, l->n_entries);
    smr_put32(l->w, at + 4u, l->n_indexes);
    l->n_blocks++;
}

/* Writes the vertices in `own` but not in `other` (NULL: empty), as stored numbers, ascending, from an index of the
 * list on. Within a level stored numbers ascend along the curve: vertices are sorted by level. Returns their number. */
static uint32_t put_difference(const smr_list_writer *l, const smr_plan *p, size_t index, const uint64_t *own,
                               const uint64_t *other)
{
    const uint32_t first = smr_row_first(own, p->words), last = smr_row_last(own, p->words);
    uint32_t to[SMR_LEVELS_MAX + 1u] = {0}; /* place of each level's next vertex */
    for (uint32_t w = first; w < last; w++)
        for (uint64_t bits = own[w] & ~(other == NULL ? 0u : other[w]); bits != 0u; bits &= bits - 1u)
            to[p->level[smr_bit_vertex(p, w * 64u + (uint32_t)__builtin_ctzll(bits))] + 1u]++;
    for (uint32_t level = 1; level <= p->n_levels; level++)
        to[level] += to[level - 1u];
    const uint32_t n = to[p->n_levels];
    const size_t at = l->at_indexes + index * l->index_bytes;
    const int usual = l->index_bytes == 2u && at + 2u * (size_t)n <= l->w->capacity;
    for (uint32_t w = first; w < last; w++)
        for (uint64_t bits = own[w] & ~(other == NULL ? 0u : other[w]); bits != 0u; bits &= bits - 1u) {
            const uint32_t v = smr_bit_vertex(p, w * 64u + (uint32_t)__builtin_ctzll(bits));
            const size_t place = at + (size_t)to[p->level[v]]++ * l->index_bytes;
            if (usual)
                put_half(l->w->model + place, p->stored[v]);
            else
                put_index(l, place, p->stored[v]);
        }
    return n;
}

uint32_t smr_entry_indexes(const smr_plan *p, const smr_list_entry *e)
{
    return e->parent_row == NULL ? p->count[e->vertex] : smr_row_difference_count(e->own, e->parent_row, p->words);
}

void smr_entry_write(const smr_list_writer *l, const smr_plan *p, const smr_list_entry *e, uint32_t entry, size_t index)
{
    const size_t at = l->at_entries + (size_t)entry * 4u * l->index_bytes;
    if (l->w->model == NULL)
        return; /* no memory for the model: only the size is counted */
    const uint32_t n_plus = put_difference(l, p, index, e->own, e->parent_row);
    const uint32_t n_minus = e->parent_row == NULL ? 0u : put_difference(l, p, index + n_plus, e->parent_row, e->own);
    const uint32_t field[4] = {p->stored[e->vertex], e->parent, n_plus, n_minus};
    for (uint32_t i = 0; i < 4u; i++)
        put_index(l, at + i * l->index_bytes, field[i]);
    put_index(l, l->at_count + (size_t)p->stored[e->vertex] * l->index_bytes, p->count[e->vertex]);
}

void smr_list_append(smr_list_writer *l, uint32_t count, uint32_t n_indexes)
{
    l->n_entries++;
    l->n_indexes += n_indexes;
    l->w->used = l->at_indexes + (size_t)l->n_indexes * l->index_bytes;
    l->n_members += count;
    l->largest = smr_max_u32(l->largest, count);
    l->smallest = l->smallest == 0u ? count : smr_min_u32(l->smallest, count);
}
