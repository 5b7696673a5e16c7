/* prove_lists.c: sums along the order L read and write nothing outside records, sums and lists, whatever a fault wrote
 * into entries and indexes. One entry from each index on, with each length of its two lists, suffices: the next entry
 * starts at an index that this one has reached. A vector of four words is one word here, because frama-c has no
 * vectors, and records are three words shorter instead.
 * SPDX-License-Identifier: MIT */
#define vector_size(bytes) aligned(4)
#include "registration/match/cluster_sums.c"
#include "prove.h"

#define PROVE_N 3u
#define PROVE_INDEXES 3u

static uint32_t record[SMR_WORDS * PROVE_N - 3u], sum[SMR_WORDS * PROVE_N - 3u], list[PROVE_INDEXES];
static smr_entry32 entry[2];
static smr_worker worker;
static smr_schedule schedule;
static smr_shared shared;
static smr_forces forces;
static smr_shape shape;
static float mass[PROVE_N];

/* Entry 1 of a block that begins at index `at`: list lengths are numbers of 0 .. PROVE_INDEXES or any larger ones. */
static void any_entry(uint32_t width, uint32_t at, uint32_t n_plus, uint32_t n_minus, uint32_t n_active)
{
    const piece p = {0, 1, 2, at};
    smr_entry16 *narrow = (smr_entry16 *)entry;
    smr_lists *l = &schedule.lists;
    smr_sums s = {.schedule = &schedule, .record = record, .sum = sum, .words = 13};
    *l = (smr_lists){.entry = entry, .n = PROVE_N, .n_indexes = PROVE_INDEXES, .index_bytes = width};
    l->index = width == 2u ? (const unsigned char *)list + 2u * PROVE_INDEXES : (const unsigned char *)list;
    schedule.n_active = n_active;
    PROVE_HOSTILE(entry, sizeof entry);
    if (width == 2u) {
        narrow[1].n_plus = (uint16_t)(n_plus <= PROVE_INDEXES ? n_plus : PROVE_ANY(PROVE_INDEXES + 1u, 65535));
        narrow[1].n_minus = (uint16_t)(n_minus <= PROVE_INDEXES ? n_minus : PROVE_ANY(PROVE_INDEXES + 1u, 65535));
        (void)chain16(l, p, n_active, record, sum, 4);
    } else {
        entry[1].n_plus = PROVE_WORD(n_plus, PROVE_INDEXES + 1u);
        entry[1].n_minus = PROVE_WORD(n_minus, PROVE_INDEXES + 1u);
        (void)chain32(l, p, n_active, record, sum, 4);
    }
    for (uint32_t within = 0; within <= PROVE_INDEXES; within++) {
        piece q = p;
        worker.within = within;
        worker.pause.left = PROVE_ANY(0, UINT32_MAX - 1u);
        add_some(&s, &q, &worker);
        //@ assert q.index <= PROVE_INDEXES;
    }
}

int main(void)
{
    PROVE_HOSTILE(record, sizeof record);
    PROVE_HOSTILE(sum, sizeof sum);
    PROVE_HOSTILE(list, sizeof list);
    for (uint32_t at = 0; at <= PROVE_INDEXES; at++)
        for (uint32_t n_plus = 0; n_plus <= PROVE_INDEXES + 1u; n_plus++)
            for (uint32_t n_minus = 0; n_minus <= PROVE_INDEXES + 1u; n_minus++)
                for (uint32_t width = 2; width <= 4u; width += 2u)
                    for (uint32_t n_active = PROVE_N - 1u; n_active <= PROVE_N; n_active++)
                        any_entry(width, at, n_plus, n_minus, n_active);
    return 0;
}
