/* cluster_sums.c: fixed-point records of each vertex and their sums over every cluster, along the order L (paper 2.2):
 * Sum_i = Sum_parent + Sum over zeta+ - Sum over zeta-. The sums are exact (base/fixed_point.h). Blocks are tasks.
 * Bounds: one pass over a block's entries and indexes; with a budget a worker may stop within the list of an entry.
 * SPDX-License-Identifier: MIT */
#include "registration/match/cluster_match.h"

/* Instructions at most for an entry or an index, alone and for each word of the records. */
#define SMR_WORK_ENTRY 100u
#define SMR_WORK_WORD 10u
#define SMR_WORK_SOME 8000u /* least work for which some of a long list is summed */

SMR_SELDOM void smr_sums_expect(smr_sums *s, uint32_t words, float largest0, float largest1)
{
    s->scale[0] = smr_fixed_scale((float)s->schedule->lists.largest * largest0);
    s->scale[1] = smr_fixed_scale((float)s->schedule->lists.largest * largest1);
    s->words = words;
}

uint32_t smr_method_words(const smr_shared *c) { return c->config.basic.method == SMR_METHOD_RIGID ? 6u : 12u; }

uint32_t smr_block_tasks(const void *arg) { return ((const smr_sums *)arg)->schedule->lists.n_blocks; }

uint32_t smr_sums_record_tasks(const void *arg) { return smr_active_tasks(((const smr_sums *)arg)->schedule); }

/* Writes records of u = x + f^e - x^r: m u (m: mass), then m x^r x u (rigid, 3 words) or m u x^r^T (polar, 9). */
void smr_sums_record(void *arg, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_sums *s = arg;
    for (uint32_t v = task * SMR_CHUNK; v < smr_active_end(s->schedule, task); v++) {
        uint32_t *r = s->record + SMR_WORDS * (size_t)v;
        const smr_vec ref = smr_get3(s->forces->shape->x_ref, v);
        const smr_vec u = smr_scale(smr_match_displacement(s->forces, v), smr_mass(s->shared, v));
        r[0] = smr_fixed(u.x * s->scale[0]);
        r[1] = smr_fixed(u.y * s->scale[0]);
        r[2] = smr_fixed(u.z * s->scale[0]);
        if (s->shared->config.basic.method == SMR_METHOD_RIGID) {
            const smr_vec l = smr_cross(ref, u);
            r[3] = smr_fixed(l.x * s->scale[1]);
            r[4] = smr_fixed(l.y * s->scale[1]);
            r[5] = smr_fixed(l.z * s->scale[1]);
        } else {
            const float a[3] = {u.x * s->scale[1], u.y * s->scale[1], u.z * s->scale[1]}, b[3] = {ref.x, ref.y, ref.z};
            for (uint32_t i = 0; i < 9u; i++)
                r[3u + i] = smr_fixed(a[i / 3u] * b[i % 3u]);
        }
    }
}

/* Four words for four additions at once: not all compilers vectorise a loop over words. */
typedef uint32_t lanes __attribute__((vector_size(16)));

static inline lanes load_lanes(const uint32_t *from)
{
    lanes l;
    memcpy(&l, from, sizeof l);
    return l;
}

static inline void store_lanes(uint32_t *to, lanes l) { memcpy(to, &l, sizeof l); }

/* Adds (+=) or subtracts (-=) a vertex' record to acc. n_lanes and the index width are constants at each call, so the
 * compiler makes a loop for each. Lists ascend, so the first inactive vertex (`limit` or above) ends a list. */
#define SMR_ADD(operation, vertex)                                                                                     \
    {                                                                                                                  \
        const uint32_t *r = record + SMR_WORDS * (size_t)(vertex);                                                     \
        for (uint32_t k = 0; k < n_lanes; k++)                                                                         \
            acc[k] operation load_lanes(r + 4u * k);                                                                   \
    }

/* A piece of a block: entries from .. to - 1 of those from `first` on; `index` is the first index of entry `from`. */
typedef struct piece {
    uint32_t first, from, to, index;
} piece;

#define SMR_DEFINE_CHAIN(name, index_type, entry_type, load)                                                           \
    static inline uint32_t name(const smr_lists *l, piece p, uint32_t limit, const uint32_t *record, uint32_t *sum,    \
                                const uint32_t n_lanes)                                                                \
    {                                                                                                                  \
        const entry_type *entry = (const entry_type *)l->entry + p.first;                                              \
        const index_type *index = (const index_type *)l->index + p.index;                                              \
        const index_type *const end = (const index_type *)l->index + l->n_indexes;                                     \
        const uint32_t n = l->n;                                                                                       \
        const int all = limit >= n;                                                                                    \
        for (uint32_t e = p.from; e < p.to; e++) {                                                                     \
            const uint32_t parent = smr_min_u32(load(entry[e].parent), e);                                             \
            const uint32_t *from = sum + SMR_WORDS * (size_t)smr_index(load(entry[parent].vertex), n);                 \
            const index_type *const minus = index + smr_min_u32(load(entry[e].n_plus), (uint32_t)(end - index));       \
            const index_type *const next = minus + smr_min_u32(load(entry[e].n_minus), (uint32_t)(end - minus));       \
            lanes acc[SMR_WORDS / 4u] = {{0}};                                                                         \
            for (uint32_t k = 0; parent != e && k < n_lanes; k++)                                                      \
                acc[k] = load_lanes(from + 4u * k);                                                                    \
            if (all || index == minus || load(minus[-1]) < limit)                                                      \
                for (; index < minus; index++)                                                                         \
                    SMR_ADD(+=, smr_index(load(*index), n))                                                            \
            else                                                                                                       \
                for (; load(*index) < limit; index++)                                                                  \
                    SMR_ADD(+=, load(*index))                                                                          \
            index = minus;                                                                                             \
            if (all || index == next || load(next[-1]) < limit)                                                        \
                for (; index < next; index++)                                                                          \
                    SMR_ADD(-=, smr_index(load(*index), n))                                                            \
            else                                                                                                       \
                for (; load(*index) < limit; index++)                                                                  \
                    SMR_ADD(-=, load(*index))                                                                          \
            index = next;                                                                                              \
            for (uint32_t k = 0; k < n_lanes; k++)                                                                     \
                store_lanes(sum + SMR_WORDS * (size_t)smr_index(load(entry[e].vertex), n) + 4u * k, acc[k]);           \
        }                                                                                                              \
        return (uint32_t)(index - (const index_type *)l->index);                                                       \
    }

SMR_DEFINE_CHAIN(chain16, uint16_t, smr_entry16, smr_le16)
SMR_DEFINE_CHAIN(chain32, uint32_t, smr_entry32, smr_le32)

/* Computes the cluster sums of one piece of the order L. Returns the index after the last index of the piece. */
static uint32_t chain(const smr_sums *s, piece p)
{
    const smr_lists *l = &s->schedule->lists;
    const uint32_t active = s->schedule->n_active, *record = s->record;
    const int narrow = l->index_bytes == 2u;
    if (s->words <= 8u)
        return narrow ? chain16(l, p, active, record, s->sum, 2u) : chain32(l, p, active, record, s->sum, 2u);
    if (s->words <= 12u)
        return narrow ? chain16(l, p, active, record, s->sum, 3u) : chain32(l, p, active, record, s->sum, 3u);
    return narrow ? chain16(l, p, active, record, s->sum, 4u) : chain32(l, p, active, record, s->sum, 4u);
}

/* Returns entry e of a piece as four words, limited to legal values in case of a fault. */
static smr_entry32 entry_of(const smr_lists *l, const piece *p, uint32_t e)
{
    const smr_entry16 *narrow = (const smr_entry16 *)l->entry + p->first + e;
    const smr_entry32 *wide = (const smr_entry32 *)l->entry + p->first + e;
    const smr_entry32 r = l->index_bytes == 2u ? (smr_entry32){smr_le16(narrow->vertex), smr_le16(narrow->parent),
                                                               smr_le16(narrow->n_plus), smr_le16(narrow->n_minus)}
                                               : (smr_entry32){smr_le32(wide->vertex), smr_le32(wide->parent),
                                                               smr_le32(wide->n_plus), smr_le32(wide->n_minus)};
    const uint32_t plus = smr_min_u32(r.n_plus, l->n_indexes - p->index);
    return (smr_entry32){smr_index(r.vertex, l->n), smr_min_u32(r.parent, e), plus,
                         smr_min_u32(r.n_minus, l->n_indexes - p->index - plus)};
}

/* Returns the work, in instructions at most, for an entry or an index. */
static uint32_t work_of(const smr_sums *s) { return SMR_WORK_ENTRY + SMR_WORK_WORD * s->words; }

/* Returns the work, in instructions at most, for entry e of a piece and its indexes. */
static uint64_t work_at(const smr_sums *s, const piece *p, uint32_t e)
{
    const smr_entry32 entry = entry_of(&s->schedule->lists, p, e);
    return (uint64_t)work_of(s) * (1u + entry.n_plus + entry.n_minus);
}

/* Returns the end of the entries from p->from on for which work is left, and subtracts their work. */
static uint32_t entries_for(const smr_sums *s, const piece *p, uint32_t length, smr_pause *pause)
{
    uint32_t to = p->from;
    if (pause->left == SMR_ENDLESS)
        return length;
    for (; to < length; to++) {
        const uint64_t work = work_at(s, p, to);
        if (work > pause->left)
            break;
        pause->left -= (uint32_t)work;
    }
    return to;
}

/* Adds as many indexes of entry p->from to the entry's sum as there is work left for. */
static void add_some(const smr_sums *s, piece *p, smr_worker *w)
{
    const smr_lists *l = &s->schedule->lists;
    const smr_entry32 entry = entry_of(l, p, p->from), parent = entry_of(l, p, entry.parent);
    const uint32_t length = entry.n_plus + entry.n_minus, n = smr_min_u32(w->pause.left / work_of(s), length);
    const uint32_t last = smr_min_u32(length, w->within + n);
    uint32_t *sum = s->sum + SMR_WORDS * (size_t)entry.vertex;
    for (uint32_t k = 0; w->within == 0u && k < s->words; k++)
        sum[k] = entry.parent == p->from ? 0u : s->sum[SMR_WORDS * (size_t)parent.vertex + k];
    for (uint32_t i = w->within; i < last; i++) {
        const uint32_t at = p->index + i, v = l->index_bytes == 2u ? smr_le16(((const uint16_t *)l->index)[at])
                                                                   : smr_le32(((const uint32_t *)l->index)[at]);
        const uint32_t *const r = s->record + SMR_WORDS * (size_t)smr_index(v, l->n);
        for (uint32_t k = 0; smr_active(s->schedule, v) && k < s->words; k++)
            sum[k] += i < entry.n_plus ? r[k] : 0u - r[k];
    }
    smr_work(&w->pause, n * work_of(s));
    w->within = last < length ? last : 0u;
    p->from += last == length;
    p->index += last == length ? length : 0u;
}

void smr_sums_forest(void *arg, uint32_t block, uint32_t worker)
{
    smr_sums *s = arg;
    smr_worker *w = &s->shared->worker[worker];
    const smr_lists *l = &s->schedule->lists;
    const smr_stored_block *b = &l->block[block];
    const uint32_t begin = smr_min_u32(smr_le32(b[0].first), l->n), end = smr_min_u32(smr_le32(b[1].first), l->n);
    const uint32_t length = end > begin ? end - begin : 0u, first = smr_min_u32(smr_le32(b->first_index), l->n_indexes);
    piece p = {begin, w->at, 0, smr_min_u32(first + w->index, l->n_indexes)};
    while (p.from < length) {
        p.to = w->within > 0u ? p.from : entries_for(s, &p, length, &w->pause);
        if (p.to > p.from) {
            p.index = chain(s, p);
            p.from = p.to;
        } else if (w->pause.left >= SMR_WORK_SOME && work_at(s, &p, p.from) > SMR_WORK_MOST / 2u) {
            add_some(s, &p, w);
        } else {
            w->index = p.index - first;
            (void)smr_worker_stop(w, p.from);
            return;
        }
    }
}

int smr_sums_some(smr_sums *s, uint32_t *block)
{
    smr_worker *w = &s->shared->worker[0];
    w->pause.left = SMR_WORK_MOST;
    w->pause.kept = 0;
    smr_sums_forest(s, *block, 0);
    if (!w->pause.kept) {
        smr_worker_start(w);
        ++*block;
    }
    return *block < smr_block_tasks(s);
}
