/* boundary.c: members about a radius from their cluster's vertex count with a share of their mass (boundary_pairs.c): what that differs
 * from the sums by lists is added to these. In whole numbers, too, so that the order makes no difference.
 * Bounds: one pass over the radius' boundary.
 * SPDX-License-Identifier: MIT */
#include "runtime/state.h"

#define SMR_BOUNDARY_CHUNK 16u /* pairs of a task */

uint32_t smr_boundary_tasks(smr *s) { return smr_ceil_div(s->lists.n_boundary, SMR_BOUNDARY_CHUNK); }
uint32_t smr_boundary_reference_tasks(smr *s) { return s->reference_stale ? smr_boundary_tasks(s) : 0u; }

static void add_record(smr *s, uint32_t to, uint32_t from, int32_t share)
{
    uint32_t *sum = s->sum + SMR_WORDS * (size_t)to;
    const uint32_t *record = s->record + SMR_WORDS * (size_t)from;
    for (uint32_t i = 0; i < s->sum_words; i++)
        sum[i] += smr_boundary_part((int64_t)smr_signed(record[i]) * share);
}

static void add_pairs(smr *s, uint32_t task, void (*add)(smr *s, uint32_t to, uint32_t from, int32_t share))
{
    const uint32_t last = smr_min_u32((task + 1u) * SMR_BOUNDARY_CHUNK, s->lists.n_boundary);
    for (uint32_t i = task * SMR_BOUNDARY_CHUNK; i < last; i++) {
        const smr_stored_boundary *pair = s->lists.boundary + i;
        const uint32_t a = smr_le32(pair->first), b = smr_le32(pair->second);
        const int32_t share = (int32_t)smr_le32(pair->share) - SMR_BOUNDARY_UNITS / 2;
        if (smr_active(s, b))
            add(s, a, b, share);
        if (smr_active(s, a))
            add(s, b, a, share);
    }
}

/* After the forest has summed; pairs share vertices: one task after the other. */
void smr_boundary_reference(void *arg, uint32_t task, uint32_t worker)
{
    (void)worker;
    add_pairs(arg, task, smr_reference_add);
}

void smr_boundary_sums(void *arg, uint32_t task, uint32_t worker)
{
    (void)worker;
    add_pairs(arg, task, add_record);
}
