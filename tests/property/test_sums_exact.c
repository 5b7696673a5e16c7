/* test_sums_exact.c: sums along the forest, along the paper's breadth-first chain, and directly over whole clusters
 * are the same numbers at every vertex, however long the run. Clusters are found again by comparing all pairs.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include <string.h>
#include "property/model_lists.h"
#include "property/rig_data.h"
#include "registration/registration.h"

static const float none[3] = {0, 0, 0};

/* What the boundary adds to a cluster's sum of one word: a part of the records of vertices about a radius away. */
static int64_t boundary_of(const smr *s, uint32_t v, uint32_t w)
{
    int64_t sum = 0;
    for (uint32_t i = 0; i < s->schedule.lists.n_boundary; i++) {
        const uint32_t first = smr_le32(s->schedule.lists.boundary[i].first),
                       second = smr_le32(s->schedule.lists.boundary[i].second);
        if (first == v || second == v) {
            const double record =
                (double)(int32_t)s->overlay.record[SMR_WORDS * (size_t)(first == v ? second : first) + w];
            const double part = (double)smr_le32(s->schedule.lists.boundary[i].share) / SMR_BOUNDARY_UNITS - 0.5;
            sum += (int64_t)floor(record * part + 0.5);
        }
    }
    return sum;
}

/* Direct sums of the records over whole clusters, with the boundary or without, against the registration's own; returns
 * vertices that differ. */
static uint32_t n_different(const smr *s, const rig_lists *l, uint32_t words, int boundary)
{
    uint32_t wrong = 0;
    for (uint32_t v = 0; v < s->shared.n; v++) {
        uint32_t sum[SMR_WORDS] = {0};
        for (uint32_t k = l->zeta_start[v]; k < l->zeta_start[v + 1u]; k++) {
            const uint32_t *r = s->overlay.record + SMR_WORDS * (size_t)l->zeta[k];
            for (uint32_t w = 0; w < words; w++)
                sum[w] += r[w];
        }
        for (uint32_t w = 0; boundary && w < words; w++)
            sum[w] += (uint32_t)boundary_of(s, v, w);
        wrong += memcmp(sum, s->sums.sum + SMR_WORDS * (size_t)v, words * sizeof *sum) != 0;
    }
    return wrong;
}

static void run_all(void *stage, uint32_t n_tasks, smr_task run)
{
    for (uint32_t t = 0; t < n_tasks; t++)
        run(stage, t, 0);
}

/* Sums of records that fill all 32 bits, so that partial sums wrap, for every number of words in use. */
static void check_any_records(smr *s, const rig_lists *l)
{
    static const uint32_t in_use[] = {6, 10, 12};
    uint32_t seed = 11;
    for (size_t i = 0; i < SMR_WORDS * (size_t)s->shared.n; i++) {
        seed = seed * 1664525u + 1013904223u;
        s->overlay.record[i] = seed ^ seed >> 15;
    }
    for (uint32_t i = 0; i < 3u; i++) {
        s->sums.words = in_use[i];
        memset(s->sums.sum, 0x55, SMR_WORDS * (size_t)s->shared.n * sizeof *s->sums.sum);
        run_all(&s->sums, smr_block_tasks(&s->sums), smr_sums_forest);
        assert_int_equal(0, n_different(s, l, in_use[i], 0));
    }
    smr_guard_close(s);
}

/* The sums that iterations leave behind. */
static void check_iterations(smr *s, const rig_lists *l, uint32_t n)
{
    for (uint32_t i = 0; i < n; i++) {
        assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
        assert_int_equal(12, s->sums.words);
        assert_int_equal(0, n_different(s, l, 12, 1));
    }
}

static smr *start(const smr_model *model, const smr_surface *target, uint32_t method)
{
    smr_config config = smr_config_default();
    config.basic.method = method;
    config.motion.settle_um = 0.0f;
    config.basic.even = 0.0f; /* it sums over neighbours where the records were */
    config.basic.iterations = config.basic.iterations_last = 100000;
    smr *s = rig_init(model, &config, NULL);
    if (target != NULL)
        assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, target));
    return s;
}

/* One radius of a model: both orders hold the clusters that all pairs give, and sum alike. */
static void check_radius(const smr_mesh *mesh, uint32_t n_structures, float radius, float separate,
                         const smr_surface *target)
{
    smr_prepare_config config = rig_radii(1, radius, 0, 0);
    uint64_t hash[2];
    rig_lists by_pairs;
    memset(&by_pairs, 0, sizeof by_pairs);
    config.separate_below_mm = separate;
    for (uint32_t order = 0; order < 2u; order++) {
        config.order = order;
        const smr_model *model = rig_model(mesh, n_structures, &config);
        smr_model_info info;
        assert_int_equal(SMR_OK, smr_model_get_info(model, &info));
        if (order == 0u)
            by_pairs = rig_decode(model, 0, radius >= info.edge_mm, 1);
        const rig_lists chain = rig_decode(model, 0, 0, 0);
        assert_memory_equal(by_pairs.zeta_start, chain.zeta_start, (chain.n + 1u) * sizeof(uint32_t));
        assert_memory_equal(by_pairs.zeta, chain.zeta, chain.zeta_start[chain.n] * sizeof(uint32_t));
        smr *s = start(model, target, order); /* either method */
        check_any_records(s, &by_pairs);
        check_iterations(s, &by_pairs, 2);
        s = start(model, target, SMR_METHOD_RIGID);
        (void)rig_run(s, 3);
        hash[order] = smr_state_hash(s);
    }
    assert_true(hash[0] == hash[1]);
}

TEST(test_bone)
{
    static const float radii[] = {10, 30, 50};
    smr_mesh source, target;
    rig_bone(9000u, 1.0f, &source, &target);
    const smr_surface *surface = rig_surface(&target);
    for (uint32_t i = 0; i < 3u; i++)
        check_radius(&source, 1, radii[i], 0.0f, surface);
}

TEST(test_several_structures)
{
    const float a[3] = {0, 0, 0}, b[3] = {70, 5, 3}, c[3] = {35, 60, -2};
    const smr_mesh mesh[3] = {rig_ball(38, 9, 14, a), rig_ball(36, 8, 15, b), rig_ball(30, 3, 3, c)};
    for (float radius = 3.0f; radius < 130.0f; radius *= 1.7f) {
        check_radius(mesh, 3, radius, 0.0f, NULL);
        check_radius(mesh, 3, radius, 1000.0f, NULL);
    }
}

TEST(test_thigh)
{
    static const float radii[] = {10, 30, 50};
    static smr_mesh mesh[RIG_STRUCTURES_MAX];
    const uint32_t n = rig_folder("hip_thigh_vhm", mesh, NULL);
    if (n != 24u) {
        print_message("skipped: the 24-structure model ../shared/data/hip_thigh_vhm is not there\n");
        skip();
    }
    for (uint32_t i = 0; i < rig_times(3u); i++) {
        check_radius(mesh, n, radii[i], 0.0f, NULL);
        rig_free_all(); /* clusters at 50 mm take 100 MB */
        (void)rig_folder("hip_thigh_vhm", mesh, NULL);
    }
}

TEST(test_no_drift_at_rest)
{
    const smr_mesh mesh = rig_ball(30, 6, 10, none);
    const smr_prepare_config radii = rig_radii(1, 18, 0, 0);
    const smr_model *model = rig_model(&mesh, 1, &radii);
    const rig_lists l = rig_decode(model, 0, 1, 1);
    for (uint32_t method = 0; method < 2u; method++) {
        smr *s = start(model, NULL, method);
        const float *before = rig_positions(s, model);
        smr_tick_report report;
        for (uint32_t i = 0; i < rig_times(30000u); i++)
            (void)smr_tick(s, 0, &report);
        assert_int_equal(rig_times(30000u), report.iteration);
        assert_memory_equal(before, rig_positions(s, model), mesh.n_vertices * 3u * sizeof(float));
        assert_int_equal(0, n_different(s, &l, 12, 1));
    }
}

TEST(test_no_drift_with_target)
{
    const float off[3] = {3, -2, 1};
    const smr_mesh mesh = rig_ball(30, 6, 10, none), other = rig_ball(33, 9, 8, off);
    const smr_prepare_config radii = rig_radii(1, 18, 0, 0);
    const smr_model *model = rig_model(&mesh, 1, &radii);
    const rig_lists l = rig_decode(model, 0, 1, 1);
    smr *s = start(model, rig_surface(&other), SMR_METHOD_RIGID);
    smr_tick_report report;
    for (uint32_t i = 0; i < rig_times(29990u); i++)
        (void)smr_tick(s, 0, &report);
    assert_int_equal(rig_times(29990u), report.iteration);
    check_iterations(s, &l, 9);
    assert_true(rig_finite(rig_positions(s, model), mesh.n_vertices));
    check_any_records(s, &l);
}

/* The scales leave room for the largest final sum: as 64-bit numbers the sums are the same. */
TEST(test_final_sums_fit)
{
    const smr_prepare_config radii = rig_radii(1, 60, 0, 0);
    smr_mesh source, target;
    rig_bone(12000u, 2.0f, &source, &target);
    const smr_model *model = rig_model(&source, 1, &radii);
    const rig_lists l = rig_decode(model, 0, 1, 1);
    for (uint32_t method = 0; method < 2u; method++) {
        smr *s = start(model, rig_surface(&target), method);
        for (uint32_t i = 0; i < 10u; i++) {
            assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
            int64_t largest = 0;
            for (uint32_t v = 0; v < s->shared.n; v++) {
                for (uint32_t w = 0; w < 12u; w++) {
                    int64_t sum = boundary_of(s, v, w);
                    for (uint32_t k = l.zeta_start[v]; k < l.zeta_start[v + 1u]; k++)
                        sum += (int32_t)s->overlay.record[SMR_WORDS * (size_t)l.zeta[k] + w];
                    assert_true(sum == (int32_t)s->sums.sum[SMR_WORDS * (size_t)v + w]);
                    largest = sum > largest ? sum : largest;
                    largest = -sum > largest ? -sum : largest;
                }
            }
            /* the first iteration may be one without forces; later ones use the room */
            assert_true((i == 0u || largest > 1 << 24) && largest <= INT64_C(1) << 30);
        }
    }
}
