/* test_sums.c: chains with 16-bit and 32-bit indexes give the sums over all members of each cluster.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <string.h>
#include "property/model_lists.h"
#include "registration/registration.h"

static const float none[3] = {0, 0, 0};

static smr *start(const smr_model **model)
{
    const smr_mesh mesh = rig_ball(30, 9, 12, none);
    const smr_prepare_config radii = rig_radii(1, 18, 0, 0);
    const smr_config config = smr_config_default();
    *model = rig_model(&mesh, 1, &radii);
    return rig_init(*model, &config, NULL);
}

static void run_all(void *stage, uint32_t n, smr_task run)
{
    for (uint32_t t = 0; t < n; t++)
        run(stage, t, 0);
}

/* The same lists with 32-bit numbers, as models of more than 65,535 vertices have them. Behind the end of their indexes
 * twice as many follow that nothing may read. */
static smr_lists widened(const smr_lists *l, uint32_t n)
{
    const smr_entry16 *e = l->entry;
    const uint16_t *index = l->index;
    const uint32_t n_indexes = smr_le32(l->block[l->n_blocks].first_index);
    smr_entry32 *entry = rig_alloc(n * sizeof *entry);
    uint32_t *wide = rig_alloc(3u * n_indexes * sizeof *wide), *count = rig_alloc(n * sizeof *count);
    smr_lists out = *l;
    for (uint32_t i = 0; i < n; i++) {
        entry[i] = (smr_entry32){smr_le32(smr_le16(e[i].vertex)), smr_le32(smr_le16(e[i].parent)),
                                 smr_le32(smr_le16(e[i].n_plus)), smr_le32(smr_le16(e[i].n_minus))};
        count[i] = smr_le32(smr_list_count(l, i));
    }
    for (uint32_t i = 0; i < 3u * n_indexes; i++)
        wide[i] = smr_le32(smr_le16(index[i % n_indexes]));
    out.entry = entry;
    out.count = count;
    out.index = wide;
    out.index_bytes = 4;
    return out;
}

TEST(test_both_widths)
{
    static const uint32_t words[] = {6, 8, 10, 12};
    const smr_model *model;
    smr *s = start(&model);
    const size_t n_words = SMR_WORDS * (size_t)s->shared.n;
    uint32_t seed = 9, *sum = rig_alloc(n_words * sizeof *sum);
    const smr_lists narrow = s->schedule.lists, wide = widened(&s->schedule.lists, s->shared.n);
    const rig_lists l = rig_decode(model, 0, 1, 1);
    assert_int_equal(2, narrow.index_bytes);
    for (size_t i = 0; i < n_words; i++)
        s->overlay.record[i] = rig_random(&seed, 1u << 28) << 4 ^ (uint32_t)i;
    for (uint32_t i = 0; i < 4u; i++) {
        s->sums.words = words[i];
        for (uint32_t pass = 0; pass < 2u; pass++) {
            s->schedule.lists = pass ? wide : narrow;
            memset(s->sums.sum, 0x77, n_words * sizeof *s->sums.sum);
            run_all(&s->sums, smr_block_tasks(&s->sums), smr_sums_forest);
            for (uint32_t v = 0; v < s->shared.n; v++) {
                for (uint32_t w = 0; w < words[i]; w++) {
                    uint32_t expected = 0;
                    for (uint32_t k = l.zeta_start[v]; k < l.zeta_start[v + 1u]; k++)
                        expected += s->overlay.record[SMR_WORDS * (size_t)l.zeta[k] + w];
                    assert_int_equal(expected, s->sums.sum[SMR_WORDS * (size_t)v + w]);
                }
            }
            if (pass == 0u)
                memcpy(sum, s->sums.sum, n_words * sizeof *sum);
        }
        assert_memory_equal(sum, s->sums.sum, n_words * sizeof *sum);
    }
}

/* A list whose length a fault has changed ends with all lists, summed at once as well as a part at a time. */
TEST(test_list_too_long)
{
    const smr_model *model;
    smr *s = start(&model);
    const size_t n_words = SMR_WORDS * (size_t)s->shared.n;
    uint32_t seed = 9, block = 0, *sum = rig_alloc(n_words * sizeof *sum);
    s->schedule.lists = widened(&s->schedule.lists, s->shared.n);
    s->sums.words = 12;
    s->schedule.n_active = s->shared.n;
    for (size_t i = 0; i < n_words; i++)
        s->overlay.record[i] = rig_random(&seed, 1u << 28);
    smr_entry32 *const entry = (smr_entry32 *)(uintptr_t)s->schedule.lists.entry;
    assert_true(entry[1].n_plus > 0u && s->schedule.lists.n_indexes > 500u);
    entry[1].n_minus = UINT32_MAX;
    memset(s->sums.sum, 0x77, n_words * sizeof *s->sums.sum);
    run_all(&s->sums, smr_block_tasks(&s->sums), smr_sums_forest);
    memcpy(sum, s->sums.sum, n_words * sizeof *sum);
    memset(s->sums.sum, 0x77, n_words * sizeof *s->sums.sum);
    while (smr_sums_some(&s->sums, &block))
        ;
    for (size_t v = 0; v < s->shared.n; v++)
        assert_memory_equal(sum + SMR_WORDS * v, s->sums.sum + SMR_WORDS * v, s->sums.words * sizeof *sum);
}
