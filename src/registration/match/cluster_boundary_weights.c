/* cluster_boundary_weights.c: fractional weights of vertices near a cluster's boundary: adds to the sums the difference
 * from the weight 0 or 1 of the order L. The sums are integers, so the order of the pairs does not matter.
 * Bounds: one pass over the radius' boundary pairs.
 * SPDX-License-Identifier: MIT */
#include "registration/match/cluster_match.h"

#define SMR_BOUNDARY_CHUNK 16u /* number of boundary pairs in a task */

uint32_t smr_boundary_tasks(const void *arg)
{
    return smr_ceil_div(((const smr_sums *)arg)->schedule->lists.n_boundary, SMR_BOUNDARY_CHUNK);
}

uint32_t smr_reference_boundary_tasks(const void *r) { return smr_boundary_tasks(((const smr_reference *)r)->sums); }

/* Adds share / SMR_BOUNDARY_UNITS of the record (r not NULL: moments) of vertex `from` to the sum of `to`'s cluster. */
SMR_SHARED static void add(smr_sums *s, smr_reference *r, uint32_t to, uint32_t from, int32_t share)
{
    if (r != NULL) {
        smr_reference_add(r, to, from, share);
        return;
    }
    uint32_t *sum = s->sum + SMR_WORDS * (size_t)to;
    const uint32_t *record = s->record + SMR_WORDS * (size_t)from, words = s->words;
    for (uint32_t i = 0; i < words; i++)
        sum[i] += smr_boundary_part((int64_t)smr_signed(record[i]) * share);
}

/* For each boundary pair of a task: adds each vertex' share to the other's cluster sum. r not NULL: sums moments. */
static void add_pairs(smr_sums *s, smr_reference *r, uint32_t task)
{
    const smr_schedule *schedule = s->schedule;
    const smr_lists *l = &schedule->lists;
    const uint32_t last = smr_min_u32((task + 1u) * SMR_BOUNDARY_CHUNK, l->n_boundary);
    for (uint32_t i = task * SMR_BOUNDARY_CHUNK; i < last; i++) {
        const smr_stored_boundary *const pair = &l->boundary[i];
        const uint32_t a = smr_index(smr_le32(pair->first), l->n), b = smr_index(smr_le32(pair->second), l->n);
        const int32_t share = (int32_t)(smr_le32(pair->share) - SMR_BOUNDARY_UNITS / 2);
        if (smr_active(schedule, b))
            add(s, r, a, b, share);
        if (smr_active(schedule, a))
            add(s, r, b, a, share);
    }
}

/* Adds boundary pairs' shares to cluster sums. Pairs share vertices, so tasks run one after the other. */
void smr_boundary_sums(void *arg, uint32_t task, SMR_UNUSED uint32_t worker) { add_pairs(arg, NULL, task); }

void smr_boundary_reference(void *arg, uint32_t task, SMR_UNUSED uint32_t worker)
{
    add_pairs(((smr_reference *)arg)->sums, arg, task);
}
