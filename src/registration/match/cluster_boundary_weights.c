/* cluster_boundary_weights.c: fractional weights of vertices near a cluster's boundary: adds the difference from the
 * sums by lists. In integers, so that the order does not matter.
 * Bounds: one pass over the radius' boundary pairs.
 * SPDX-License-Identifier: MIT */
#include "registration/match/cluster_reference.h"

#define SMR_BOUNDARY_CHUNK 16u /* pairs of a task */

typedef struct pair {
    uint32_t a, b;
    int32_t share; /* difference from the lists' weight 0 or 1, in 1 / SMR_BOUNDARY_UNITS */
} pair;

static uint32_t pairs_end(const smr_lists *l, uint32_t task)
{
    return smr_min_u32((task + 1u) * SMR_BOUNDARY_CHUNK, l->n_boundary);
}

static pair pair_at(const smr_lists *l, uint32_t i)
{
    const smr_stored_boundary *stored = l->boundary + i;
    return (pair){smr_le32(stored->first), smr_le32(stored->second),
                  (int32_t)smr_le32(stored->share) - SMR_BOUNDARY_UNITS / 2};
}

static void add_record(smr_sums *s, uint32_t to, uint32_t from, int32_t share)
{
    uint32_t *sum = s->sum + SMR_WORDS * (size_t)to;
    const uint32_t *record = s->record + SMR_WORDS * (size_t)from, words = s->words;
    for (uint32_t i = 0; i < words; i++)
        sum[i] += smr_boundary_part((int64_t)smr_signed(record[i]) * share);
}

uint32_t smr_boundary_tasks(const void *arg)
{
    return smr_ceil_div(((const smr_sums *)arg)->schedule->lists.n_boundary, SMR_BOUNDARY_CHUNK);
}

/* Pairs share vertices, so tasks run one after the other. */
void smr_boundary_sums(void *arg, uint32_t task, uint32_t worker)
{
    smr_sums *s = arg;
    (void)worker;
    const smr_schedule *schedule = s->schedule;
    const uint32_t last = pairs_end(&schedule->lists, task);
    for (uint32_t i = task * SMR_BOUNDARY_CHUNK; i < last; i++) {
        const pair p = pair_at(&schedule->lists, i);
        if (smr_active(schedule, p.b))
            add_record(s, p.a, p.b, p.share);
        if (smr_active(schedule, p.a))
            add_record(s, p.b, p.a, p.share);
    }
}

uint32_t smr_reference_boundary_tasks(const void *arg)
{
    const smr_reference *r = arg;
    return smr_reference_due(r) ? smr_boundary_tasks(r->sums) : 0u;
}

void smr_boundary_reference(void *arg, uint32_t task, uint32_t worker)
{
    smr_reference *r = arg;
    (void)worker;
    const smr_schedule *schedule = r->schedule;
    const uint32_t last = pairs_end(&schedule->lists, task);
    for (uint32_t i = task * SMR_BOUNDARY_CHUNK; i < last; i++) {
        const pair p = pair_at(&schedule->lists, i);
        if (smr_active(schedule, p.b))
            smr_reference_add(r, p.a, p.b, p.share);
        if (smr_active(schedule, p.a))
            smr_reference_add(r, p.b, p.a, p.share);
    }
}

void smr_sums_at_once(smr_sums *s)
{
    smr_block_pieces(s, 0);
    for (uint32_t t = 0; t < smr_block_tasks(s); t++)
        smr_sums_forest(s, t, 0);
    for (uint32_t t = 0; t < smr_boundary_tasks(s); t++)
        smr_boundary_sums(s, t, 0);
}
