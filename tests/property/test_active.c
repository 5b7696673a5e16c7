/* test_active.c: ignored vertices. For any number of active vertices, both index widths and any model, sums along the
 * forest and along the paper's chain equal sums over the active members alone, bit for bit; averages, centres and
 * forces use no ignored vertex; workers and schedulers change no bit; an iteration shortened by a budget can be
 * repeated; positions stay finite.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include <string.h>
#include "property/model_lists.h"
#include "registration/registration.h"

static const float none[3] = {0, 0, 0};

/* Records of all 32 bits; those of ignored vertices must not count, whatever they are. */
static void fill_records(smr *s, uint32_t *seed)
{
    for (size_t i = 0; i < SMR_WORDS * (size_t)s->shared.n; i++) {
        *seed = *seed * 1664525u + 1013904223u;
        s->overlay.record[i] = *seed ^ *seed >> 15;
    }
}

static uint32_t n_different(const smr *s, const rig_lists *l, uint32_t words)
{
    uint32_t wrong = 0;
    for (uint32_t v = 0; v < s->shared.n; v++) {
        uint32_t sum[SMR_WORDS] = {0};
        for (uint32_t k = l->zeta_start[v]; k < l->zeta_start[v + 1u]; k++) {
            const uint32_t *r = s->overlay.record + SMR_WORDS * (size_t)l->zeta[k];
            for (uint32_t w = 0; l->zeta[k] < s->schedule.n_active && w < words; w++)
                sum[w] += r[w];
        }
        wrong += memcmp(sum, s->sums.sum + SMR_WORDS * (size_t)v, words * sizeof *sum) != 0;
    }
    return wrong;
}

static void sum_all(smr *s, uint32_t words)
{
    s->sums.words = words;
    memset(s->sums.sum, 0x55, SMR_WORDS * (size_t)s->shared.n * sizeof *s->sums.sum);
    for (uint32_t t = 0; t < smr_block_tasks(&s->sums); t++)
        smr_sums_forest(&s->sums, t, 0);
}

/* One model of one to three random balls. */
static const smr_model *random_model(uint32_t *seed, smr_prepare_config *c)
{
    smr_mesh mesh[3];
    const uint32_t n = 1u + rig_random(seed, 3);
    for (uint32_t i = 0; i < n; i++) {
        float at[3];
        rig_within(seed, -50, 50, at);
        const float radius = rig_between(seed, 5, 40);
        const uint32_t rings = 2u + rig_random(seed, 7);
        mesh[i] = rig_ball(radius, rings, 3u + rig_random(seed, 12), at);
    }
    *c = rig_radii(1u + rig_random(seed, 3), 0, 0, 0);
    c->radius_mm[0] = rig_between(seed, 30, 90);
    c->radius_mm[1] = rig_between(seed, 12, 30);
    c->radius_mm[2] = rig_between(seed, 3, 12);
    c->separate_below_mm = rig_between(seed, 0, 60);
    c->block_vertices = rig_random(seed, 2) ? 16u : 0u;
    c->order = rig_random(seed, 2);
    c->priority = rig_random(seed, 8) != 0u;
    return rig_model(mesh, n, c);
}

TEST(test_sums_of_active_members)
{
    static const uint32_t in_use[] = {6, 10, 12, 16};
    uint32_t seed = 3;
    for (uint32_t round = 0; round < rig_times(150); round++) {
        smr_prepare_config c;
        const smr_model *model = random_model(&seed, &c);
        smr_config config = smr_config_default();
        for (uint32_t r = 0; r < c.n_radii; r++) {
            config.schedule.radius_first = r;
            smr *s = rig_init(model, &config, NULL);
            smr_model_info info;
            assert_int_equal(SMR_OK, smr_model_get_info(model, &info));
            const rig_lists l = rig_decode(model, r, info.radius_mm[r] >= info.edge_mm, 1); /* by all pairs */
            for (uint32_t i = 0; i < 8u; i++) {
                s->schedule.n_active = i == 0u   ? s->shared.n
                                       : i == 1u ? info.active_min[r]
                                                 : rig_random(&seed, s->shared.n + 1u);
                fill_records(s, &seed);
                sum_all(s, in_use[i % 4u]);
                assert_int_equal(0, n_different(s, &l, in_use[i % 4u]));
            }
        }
        rig_free_all();
    }
}

/* More than 65,535 vertices, indexes of 4 bytes: a lattice whose neighbours are known. */
TEST(test_wide_indexes)
{
    enum { SIDE = 41, N = SIDE * SIDE * SIDE };
    float *xyz = rig_alloc(3u * N * sizeof *xyz);
    const smr_mesh mesh = {xyz, NULL, N, 0};
    smr_prepare_config c = rig_radii(1, 3.5f, 0, 0);
    uint32_t seed = 5;
    for (uint32_t i = 0; i < N; i++) {
        xyz[3u * i] = 3.0f * (float)(i % SIDE);
        xyz[3u * i + 1u] = 3.0f * (float)(i / SIDE % SIDE);
        xyz[3u * i + 2u] = 3.0f * (float)(i / SIDE / SIDE);
    }
    c.block_vertices = 64;
    const smr_model *model = rig_model(&mesh, 1, &c);
    const smr_config config = smr_config_default();
    smr *s = rig_init(model, &config, NULL);
    assert_int_equal(4, s->schedule.lists.index_bytes);
    assert_true(s->schedule.lists.active_min < N);
    for (uint32_t round = 0; round < 6u; round++) {
        s->schedule.n_active = round == 0u ? N : rig_random(&seed, N);
        fill_records(s, &seed);
        sum_all(s, 12);
        for (int i = 0; i < N; i++) {
            const int at[3] = {i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE}, step[3] = {1, SIDE, SIDE * SIDE};
            uint32_t want = 0;
            for (int k = -1; k < 6; k++) { /* itself and six neighbours */
                const int away = k < 0 ? 0 : k % 2 * 2 - 1, axis = k < 0 ? 0 : k / 2;
                const uint32_t v = at[axis] + away < 0 || at[axis] + away >= SIDE
                                       ? SMR_ALL
                                       : smr_model_position(model, (uint32_t)(i + away * step[axis]));
                want += v < s->schedule.n_active ? s->overlay.record[SMR_WORDS * (size_t)v + 11u] : 0u;
            }
            assert_int_equal(want, s->sums.sum[SMR_WORDS * (size_t)smr_model_position(model, (uint32_t)i) + 11u]);
        }
    }
}

/* x~_v of the averaging step, from the transforms that the iteration left, over the active members only. */
static double off_average(const smr *s, const rig_lists *l, uint32_t v)
{
    const float *ref = s->shape.x_ref + 3u * (size_t)v;
    double goal[3] = {0, 0, 0}, off = 0.0;
    uint32_t count = 0;
    for (uint32_t k = l->zeta_start[v]; k < l->zeta_start[v + 1u]; k++) {
        double t[12];
        for (uint32_t i = 0; i < 12u; i++) /* the record is what is averaged */
            t[i] = (double)(int32_t)s->sums.record[SMR_WORDS * (size_t)l->zeta[k] + i] / (double)s->sums.scale[i > 8u];
        if (l->zeta[k] >= s->schedule.n_active)
            continue;
        count++;
        for (uint32_t a = 0; a < 3u; a++) {
            goal[a] += (double)ref[a] + t[9u + a];
            for (uint32_t b = 0; b < 3u; b++)
                goal[a] += t[3u * a + b] * (double)ref[b];
        }
    }
    assert_true(count > 0u && fabs((double)s->reference.share[v] * count - 1.0) < 1e-6);
    for (uint32_t a = 0; a < 3u; a++)
        off = fmax(off, fabs(goal[a] / count - (double)s->shape.x[3u * (size_t)v + a]));
    return off;
}

/* A cluster's centre is that of its active members (unit masses). */
static double off_centre(const smr *s, const rig_lists *l, uint32_t v)
{
    double centre[3] = {0, 0, 0}, off = 0.0;
    uint32_t count = 0;
    for (uint32_t k = l->zeta_start[v]; k < l->zeta_start[v + 1u]; k++) {
        for (uint32_t a = 0; l->zeta[k] < s->schedule.n_active && a < 3u; a++)
            centre[a] += (double)s->shape.x_ref[3u * (size_t)l->zeta[k] + a];
        count += l->zeta[k] < s->schedule.n_active;
    }
    for (uint32_t a = 0; a < 3u; a++)
        off = fmax(off, fabs(centre[a] / count - (double)s->reference.centre[3u * (size_t)v + a]));
    return off;
}

TEST(test_an_iteration)
{
    const float off[3] = {4, -3, 2};
    const smr_mesh mesh = rig_ball(30, 14, 20, none), goal = rig_ball(35, 12, 17, off);
    const smr_prepare_config radii = rig_radii(2, 40, 20, 0);
    const smr_model *model = rig_model(&mesh, 1, &radii);
    const rig_lists l[2] = {rig_decode(model, 0, 1, 1), rig_decode(model, 1, 1, 1)};
    for (uint32_t i = 0; i <= 20u; i++) {
        smr_tick_report report;
        smr_config c = smr_config_default();
        c.basic.method = i % 2u;
        c.schedule.radius_first = i % 3u == 2u;
        c.basic.active_share = (float)i / 20.0f;
        c.basic.n_target_vertices = goal.n_vertices;
        c.motion.fold_guard = c.motion.plastic_every = 0;
        c.motion.plastic_um = c.motion.settle_um = c.basic.even = 0.0f; /* averages alone */
        smr *s = rig_init(model, &c, NULL);
        const uint32_t share = (uint32_t)ceilf(c.basic.active_share * (float)s->shared.n),
                       need = s->schedule.lists.active_min;
        assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, rig_surface(&goal)));
        for (uint32_t k = 0; k < 3u; k++) {
            assert_int_equal(SMR_OK, smr_tick(s, 0, &report));
            assert_int_equal(share > need ? share : need, s->schedule.n_active);
            assert_int_equal(s->schedule.n_active, report.details.n_active);
            for (uint32_t v = 0; v < s->shared.n; v++) {
                assert_true(off_average(s, &l[c.schedule.radius_first], v) < 2e-4);
                if (v < s->schedule.n_active) {
                    assert_true(off_centre(s, &l[c.schedule.radius_first], v) < 2e-3);
                } else { /* no force */
                    assert_true(s->forces.force[3u * v] == 0.0f && s->forces.force[3u * v + 1u] == 0.0f &&
                                s->forces.force[3u * v + 2u] == 0.0f);
                    assert_int_equal(0, s->forces.found[v]);
                }
            }
        }
        assert_true(report.n_forces > 0u && report.n_forces <= s->schedule.n_active &&
                    report.displacement_max_mm > 0.0f);
    }
}

/* The share grows evenly from the first iteration to the last, when x^r is new and now and then when it is not. */
TEST(test_growing_share)
{
    const float off[3] = {4, -3, 2};
    const smr_mesh mesh = rig_ball(30, 14, 20, none), goal = rig_ball(35, 12, 17, off);
    const smr_prepare_config radii = rig_radii(2, 40, 20, 0);
    const smr_model *model = rig_model(&mesh, 1, &radii);
    for (uint32_t elastic = 0; elastic < 2u; elastic++) {
        smr_tick_report report = {0};
        smr_config c = smr_config_default();
        uint32_t last = 0, steps = 0;
        c.schedule.active_first = 0.3f;
        c.basic.active_share = 0.9f;
        c.basic.iterations = 20;
        c.basic.iterations_last = 60;
        c.motion.fold_guard = 0;
        c.motion.settle_um = 0.0f;
        c.motion.plastic_um = 0.0f;
        c.motion.plastic_every = elastic ? 0u : 1u;
        smr *s = rig_init(model, &c, NULL);
        assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, rig_surface(&goal)));
        for (uint32_t i = 0; i < 80u; i++) {
            const float share = (float)s->shared.n * (0.3f + 0.6f * (float)(i + (i == 19u)) /
                                                                 80.0f); /* after the 20th the next radius is set up */
            assert_int_equal(SMR_OK, smr_tick(s, 0, &report));
            const float want = fmaxf(share, (float)s->schedule.lists.active_min);
            assert_true(s->schedule.n_active >= last || i == 19u);
            assert_true((float)s->schedule.n_active < want + 1.1f &&
                        (float)s->schedule.n_active >
                            want - 0.1f - (elastic ? (float)s->shared.n * 0.6f / 10.0f : 0.0f));
            steps += s->schedule.n_active > last;
            last = s->schedule.n_active;
        }
        assert_true(report.done);
        assert_true(elastic ? steps >= 8u && steps <= 14u : steps >= 78u);
    }
}

/* The end of the first level that ends at `least` or above. */
static float level_with(const smr_model_info *info, float least)
{
    for (uint32_t i = 0; i < info->n_levels; i++)
        if ((float)info->level_end[i] >= least)
            return (float)info->level_end[i];
    return (float)info->n_vertices;
}

enum { ENOUGH_ALL = 1000 };

/* Returns the number of active vertices that the radius needs: active_enough of the smallest cluster and ENOUGH_ALL of
 * the whole model, which is larger here, by whole levels; active_share is the upper limit. Counts which one decides. */
static float needed(const smr *s, const smr_model_info *info, uint32_t limited[2])
{
    const smr_config *const c = &s->shared.config;
    const smr_lists *const l = &s->schedule.lists;
    float want = c->basic.active_share * (float)s->shared.n;
    if (c->schedule.active_enough > 0u) { /* whole levels, about as many */
        const float cluster = (float)s->shared.n * (float)c->schedule.active_enough / (float)l->smallest;
        limited[cluster < ENOUGH_ALL]++;
        want = fminf(want, level_with(info, 0.75f * fmaxf(cluster, ENOUGH_ALL)));
    }
    return fmaxf(want, (float)l->active_min);
}

/* Few active vertices suffice at large radii, with an image and without one. */
TEST(test_large_radii_need_few)
{
    enum { SIDE = 24 };
    const float off[3] = {1, 2, -1};
    const smr_mesh mesh = rig_ball(30, 50, 60, none);
    uint32_t limited[2] = {0, 0}; /* how often each of the two decided */
    uint8_t *voxels = rig_alloc(SIDE * SIDE * SIDE);
    smr_volume volume = {
        voxels, NULL, SMR_VOXEL_UINT8, {SIDE, SIDE, SIDE}, {-46, -46, -46}, {4, 4, 4}, {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    smr_prepare_config prepare = rig_radii(2, 60, 15, 0);
    for (uint32_t i = 0; i < SIDE * SIDE * SIDE; i++) {
        const float x = 4.0f * (float)(i % SIDE) - 46.0f, y = 4.0f * (float)(i / SIDE % SIDE) - 46.0f;
        const float z = 4.0f * (float)(i / SIDE / SIDE) - 46.0f, r = sqrtf(x * x + y * y + z * z);
        voxels[i] = (uint8_t)(r < 26.0f ? 200.0f : r > 34.0f ? 40.0f : 200.0f - 20.0f * (r - 26.0f));
    }
    prepare.reference = &volume;
    const smr_model *model = rig_model(&mesh, 1, &prepare);
    smr_model_info info;
    assert_int_equal(SMR_OK, smr_model_get_info(model, &info));
    for (uint32_t i = 0; i < 12u; i++) {
        smr_tick_report report;
        smr_config c = smr_config_default();
        c.schedule.active_enough = i % 3u == 0u ? 0u : 5u * i;
        c.basic.active_share = i < 6u ? 1.0f : 0.25f;
        c.basic.iterations = c.basic.iterations_last = 3;
        smr *s = rig_init(model, &c, NULL);
        const float bare = needed(s, &info, limited);
        assert_true((float)s->schedule.n_active >= bare && (float)s->schedule.n_active < bare + 1.01f);
        smr_volume moved = volume;
        for (uint32_t a = 0; a < 3u; a++)
            moved.origin[a] += off[a];
        assert_int_equal(SMR_OK, smr_set_volume(s, &moved));
        for (uint32_t k = 0; k < 9u; k++) { /* both radii */
            const float want = needed(s, &info, limited);
            const uint32_t n_active = s->schedule.n_active;
            assert_true((float)n_active >= want && (float)n_active < want + 1.01f);
            assert_int_equal(SMR_OK, smr_tick(s, 0, &report));
            assert_int_equal(n_active, report.details.n_active);
            assert_true(report.n_forces > 0u && report.n_forces <= n_active);
        }
    }
    assert_true(limited[0] > 0u && limited[1] > 0u);
}

#define AGAIN UINT64_MAX
static uint32_t taken[16]; /* by the iterations of the last run with a budget */

/* Hash over all iterations of a run. Budget AGAIN: no budget, but as many active vertices as in the last run that had
 * one. */
static uint64_t run(const smr_model *model, const smr_config *c, const smr_port *port, const smr_surface *goal,
                    uint64_t budget)
{
    smr *s = rig_init(model, c, port);
    smr_tick_report report = {0};
    uint64_t hash = 0;
    assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, goal));
    for (uint32_t i = 0; i < 200000u && report.iteration < 12u && !report.done; i++) {
        if (budget == AGAIN)
            assert_int_equal(SMR_OK, smr_set_active(s, taken[report.iteration]));
        if (smr_tick(s, budget == AGAIN ? 0u : budget, &report) == SMR_OK) {
            hash = hash * 31u + report.state_hash;
            taken[report.iteration - 1u] = report.details.n_taken;
        }
    }
    assert_true(rig_finite(rig_positions(s, model), s->shared.n));
    return hash;
}

TEST(test_any_share_same_bits)
{
    uint32_t seed = 17;
    for (uint32_t round = 0; round < rig_times(40); round++) {
        smr_prepare_config prepare;
        const smr_model *model = random_model(&seed, &prepare);
        const smr_mesh goal = rig_ball(rig_between(&seed, 10, 60), 9, 13, none);
        const smr_surface *surface = rig_surface(&goal);
        smr_config c = smr_config_default();
        c.basic.active_share = rig_between(&seed, 0, 1);
        c.schedule.active_first = rig_between(&seed, 0, 1);
        c.basic.method = rig_random(&seed, 2);
        c.motion.plastic_every = rig_random(&seed, 3);
        c.basic.n_workers = 4;
        c.basic.n_target_vertices = rig_random(&seed, 2) ? goal.n_vertices : 0u;
        c.basic.iterations = c.basic.iterations_last = 4;
        const uint64_t plain = run(model, &c, NULL, surface, 0);
        for (uint32_t kind = 0; kind < RIG_SCHEDULERS; kind++) {
            const smr_port port = rig_port(kind, 1u + kind);
            assert_true(plain == run(model, &c, &port, surface, 0));
        }
        rig_clock clock;
        const smr_port port = rig_clock_port(&clock, RIG_CLOCK_STEADY, 1000);
        const uint64_t budgeted = run(model, &c, &port, surface, 3000);
        assert_true(budgeted == run(model, &c, NULL, surface, AGAIN));
        rig_free_all();
    }
}
