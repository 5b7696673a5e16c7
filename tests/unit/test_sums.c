/* test_sums.c: records are the rounded quantities, and chains with 16-bit and 32-bit indexes sum them alike.
 * SPDX-License-Identifier: MIT */
#include "cmocka_first.h"

#include <math.h>
#include <string.h>

#include "base/fixed_point.h"
#include "property/model_lists.h"
#include "property/rig.h"
#include "registration/registration.h"

static int tidy(void **state)
{
    (void)state;
    rig_free_all();
    return 0;
}

static const float none[3] = {0, 0, 0};

static smr *start(uint32_t method, const smr_model **model)
{
    const float off[3] = {4, 3, -2};
    const smr_mesh mesh = rig_ball(30, 9, 12, none), goal = rig_ball(34, 12, 16, off);
    const smr_prepare_config radii = rig_radii(1, 18, 0, 0);
    smr_config config = smr_config_default();
    config.basic.method = method;
    config.motion.plastic_every = 0;
    config.motion.momentum = 0.0f;
    *model = rig_model(&mesh, 1, &radii);
    smr *s = rig_init(*model, &config, NULL);
    assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, rig_surface(&goal)));
    (void)rig_run(s, 4);
    return s;
}

static void run_all(void *stage, uint32_t n, smr_task run)
{
    for (uint32_t t = 0; t < n; t++)
        run(stage, t, 0);
}

static double rounded(double v, float scale) { return floor(v * (double)scale + 0.5); }

/* The quantities of each method, again in double. */
static void test_records(void **state)
{
    (void)state;
    for (uint32_t method = 0; method < 2u; method++) {
        const smr_model *model;
        smr *s = start(method, &model);
        s->sums.scale[0] = 1024.0f;
        s->sums.scale[1] = 64.0f;
        run_all(&s->sums, s->shared.n_tasks, smr_sums_record);
        for (uint32_t v = 0; v < s->shared.n; v++) {
            const uint32_t *r = s->overlay.record + SMR_WORDS * (size_t)v;
            double u[3], ref[3];
            for (uint32_t a = 0; a < 3u; a++) {
                ref[a] = (double)smr_at3(s->shape.x_ref, v)[a];
                u[a] = (double)smr_at3(s->shape.x, v)[a] + (double)smr_at3(s->forces.force, v)[a] - ref[a];
                u[a] += (double)s->schedule.momentum *
                        ((double)smr_at3(s->shape.x, v)[a] - (double)smr_at3(s->shape.x_next, v)[a]);
                assert_true(fabs(rounded(u[a], 1024.0f) - (double)(int32_t)r[a]) <= 1.0);
            }
            for (uint32_t i = 0; i < (method == SMR_METHOD_RIGID ? 3u : 9u); i++) {
                const uint32_t b = (i + 1u) % 3u, c = (i + 2u) % 3u;
                const double q = method == SMR_METHOD_RIGID ? ref[b] * u[c] - ref[c] * u[b] : u[i / 3u] * ref[i % 3u];
                assert_true(fabs(rounded(q, 64.0f) - (double)(int32_t)r[3u + i]) <= 1.0);
            }
        }
    }
}

static void test_average_records(void **state)
{
    const smr_model *model;
    smr *s = start(0, &model);
    (void)state;
    s->sums.scale[0] = 1048576.0f;
    s->sums.scale[1] = 4096.0f;
    run_all(&s->match, s->shared.n_tasks, smr_average_record);
    for (uint32_t v = 0; v < s->shared.n; v++) {
        for (uint32_t i = 0; i < 12u; i++) {
            const float want = s->match.transform[12u * (size_t)v + i] * s->sums.scale[i < 9u ? 0 : 1];
            assert_true(fabsf((float)(int32_t)s->overlay.record[SMR_WORDS * (size_t)v + i] - want) <= 0.5f);
        }
    }
}

/* The same lists with 32-bit numbers, as models of more than 65,535 vertices have them. */
static smr_lists widened(const smr_lists *l, uint32_t n)
{
    const smr_entry16 *e = l->entry;
    const uint16_t *index = l->index;
    const uint32_t n_indexes = smr_le32(l->block[l->n_blocks].first_index);
    smr_entry32 *entry = rig_alloc(n * sizeof *entry);
    uint32_t *wide = rig_alloc(n_indexes * sizeof *wide), *count = rig_alloc(n * sizeof *count);
    smr_lists out = *l;
    for (uint32_t i = 0; i < n; i++) {
        entry[i] = (smr_entry32){smr_le32(smr_le16(e[i].vertex)), smr_le32(smr_le16(e[i].parent)),
                                 smr_le32(smr_le16(e[i].n_plus)), smr_le32(smr_le16(e[i].n_minus))};
        count[i] = smr_le32(smr_list_count(l, i));
    }
    for (uint32_t i = 0; i < n_indexes; i++)
        wide[i] = smr_le32(smr_le16(index[i]));
    out.entry = entry;
    out.count = count;
    out.index = wide;
    out.index_bytes = 4;
    return out;
}

static void test_both_widths(void **state)
{
    static const uint32_t words[] = {6, 8, 10, 12};
    const smr_model *model;
    smr *s = start(0, &model);
    const size_t n_words = SMR_WORDS * (size_t)s->shared.n;
    uint32_t seed = 9, *sum = rig_alloc(n_words * sizeof *sum);
    const smr_lists narrow = s->schedule.lists, wide = widened(&s->schedule.lists, s->shared.n);
    const rig_lists l = rig_decode(model, 0, 1, 1);
    (void)state;
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

/* Any order of blocks and any worker number. */
static void test_blocks_are_independent(void **state)
{
    const smr_mesh mesh = rig_ball(30, 12, 30, none);
    smr_prepare_config prepare = rig_radii(1, 12, 0, 0);
    const smr_config config = smr_config_default();
    prepare.block_vertices = 16;
    smr *s = rig_init(rig_model(&mesh, 1, &prepare), &config, NULL);
    const size_t n_words = SMR_WORDS * (size_t)s->shared.n;
    uint32_t *sum = rig_alloc(n_words * sizeof *sum), n = smr_block_tasks(&s->sums);
    (void)state;
    assert_true(n > 20u);
    for (size_t i = 0; i < n_words; i++)
        s->overlay.record[i] = (uint32_t)i * 2654435761u;
    s->sums.words = 12;
    run_all(&s->sums, n, smr_sums_forest);
    memcpy(sum, s->sums.sum, n_words * sizeof *sum);
    memset(s->sums.sum, 0, n_words * sizeof *sum);
    for (uint32_t t = n; t > 0u; t--)
        smr_sums_forest(&s->sums, t - 1u, t % 7u);
    assert_memory_equal(sum, s->sums.sum, n_words * sizeof *sum);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_teardown(test_records, tidy),
        cmocka_unit_test_teardown(test_average_records, tidy),
        cmocka_unit_test_teardown(test_both_widths, tidy),
        cmocka_unit_test_teardown(test_blocks_are_independent, tidy),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
