/* test_budget.c: ticks that run out of time. Whatever the clock does, a tick makes progress, the last complete
 * positions stay readable, and complete iterations with all vertices active have the same bits as without a clock.
 * The controller itself is tested in test_time_budget.c.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <string.h>

#define ITERATIONS 12u
#define TICKS_MAX 20000u /* an iteration of this model has a few hundred groups of tasks */

static smr_mesh source, target, other;
static const smr_model *model;
static const smr_surface *target_surface, *other_surface;

BEFORE_EACH_TEST()
{
    const float centre[3] = {0, 0, 0}, off[3] = {4, -3, 5};
    const smr_prepare_config radii = rig_radii(3, 40.0f, 20.0f, 8.0f);
    source = rig_ball(40.0f, 15, 24, centre);
    target = rig_ball(43.0f, 16, 25, off);
    other = rig_ball(36.0f, 17, 23, off);
    model = rig_model(&source, 1, &radii);
    target_surface = rig_surface(&target);
    other_surface = rig_surface(&other);
}

static smr *start(uint32_t method, const smr_port *port)
{
    smr_config config = smr_config_default();
    config.basic.method = method;
    config.motion.fusing = method; /* the polar method's rotations by their logarithms */
    config.basic.iterations = 4;
    config.motion.settle_um = 0.0f;
    config.basic.n_target_vertices = 500;
    smr *s = rig_init(model, &config, port);
    assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, target_surface));
    assert_int_equal(SMR_OK, smr_set_active(s, SMR_ALL)); /* whatever the budget */
    return s;
}

/* Positions after 0, 1, ... complete iterations, without a clock. */
static float **plain_run(uint32_t method)
{
    float **x = rig_alloc((ITERATIONS + 1u) * sizeof *x);
    smr *s = start(method, NULL);
    x[0] = rig_positions(s, model);
    for (uint32_t i = 1; i <= ITERATIONS; i++) {
        smr_tick_report report;
        assert_int_equal(SMR_OK, smr_tick(s, 0, &report));
        assert_int_equal(i, report.iteration);
        x[i] = rig_positions(s, model);
    }
    return x;
}

/* Runs to the last iteration; returns how many ticks were partial. */
static uint32_t budget_run(smr *s, uint64_t budget, float **plain, uint32_t n_iterations)
{
    static float now[3 * 512], normal[3 * 512];
    const uint32_t bytes = source.n_vertices * 3u * (uint32_t)sizeof(float);
    uint32_t partial = 0, iteration = 0;
    assert_true(bytes <= sizeof now);
    for (uint32_t tick = 0; tick < TICKS_MAX && iteration < n_iterations; tick++) {
        smr_tick_report report;
        const smr_status status = smr_tick(s, budget, &report);
        assert_true(status == SMR_OK || status == SMR_PARTIAL);
        partial += status == SMR_PARTIAL;
        assert_int_equal(iteration + (status == SMR_OK ? 1u : 0u), report.iteration);
        iteration = report.iteration;
        assert_true(report.details.phase < SMR_PHASES);
        assert_int_equal(SMR_OK, smr_get_positions(s, 0, now));
        assert_memory_equal(plain[iteration], now, bytes);
        assert_int_equal(SMR_OK, smr_get_normals(s, 0, now));
        assert_true(status == SMR_OK || tick == 0u || memcmp(normal, now, bytes) == 0);
        memcpy(normal, now, bytes);
    }
    assert_int_equal(n_iterations, iteration); /* otherwise ticks stopped making progress */
    return partial;
}

TEST(test_any_clock_any_budget)
{
    static const uint64_t budgets[] = {1, 1000, 100000, 10000000, 1000000000, UINT64_MAX / 2u, UINT64_MAX};
    static const uint64_t steps[] = {1, 700, 50000, 3000000};
    for (uint32_t method = 0; method < 2u; method++) {
        float **plain = plain_run(method);
        uint32_t partial = 0;
        for (uint32_t kind = 0; kind < RIG_CLOCKS; kind++) {
            for (uint32_t i = 0; i < sizeof budgets / sizeof budgets[0]; i++) {
                for (uint32_t k = method; k < sizeof steps / sizeof steps[0]; k += 2u) {
                    rig_clock clock;
                    const smr_port port = rig_clock_port(&clock, kind, steps[k]);
                    partial += budget_run(start(method, &port), budgets[i], plain, i == 0u ? 3u : ITERATIONS);
                }
            }
        }
        assert_true(partial > 1000u); /* the budgets were short enough to mean something */
    }
}

TEST(test_clock_near_its_end)
{
    float **plain = plain_run(0);
    for (uint64_t budget = 1; budget <= 1000000u; budget *= 1000u) {
        rig_clock clock;
        const smr_port port = rig_clock_port(&clock, RIG_CLOCK_STEADY, 50);
        smr *s = start(0, &port);
        clock.time = UINT64_MAX - 1000000000u;
        (void)budget_run(s, budget, plain, 3);
    }
}

TEST(test_short_budget_means_short_ticks)
{
    rig_clock clock;
    const smr_port port = rig_clock_port(&clock, RIG_CLOCK_STEADY, 1000);
    smr *s = start(0, &port);
    for (uint32_t tick = 0; tick < 500u; tick++) {
        const uint64_t before = clock.time;
        (void)smr_tick(s, 20000, NULL);
        assert_true(clock.time - before <= 40000u); /* readings between groups of tasks and between steps */
    }
}

TEST(test_times_by_phase)
{
    rig_clock clock;
    const smr_port port = rig_clock_port(&clock, RIG_CLOCK_STEADY, 1000);
    smr *s = start(0, &port);
    smr_tick_report report;
    uint64_t sum = 0;
    const uint64_t before = clock.time;
    assert_int_equal(SMR_OK, smr_tick(s, 0, &report));
    for (uint32_t i = 0; i < SMR_PHASES; i++) {
        assert_true(report.details.phase_ns[i] > 0u);
        sum += report.details.phase_ns[i];
    }
    assert_true(sum <= clock.time - before);
    const smr_port backwards = rig_clock_port(&clock, RIG_CLOCK_BACKWARDS, 1000);
    s = start(0, &backwards);
    assert_int_equal(SMR_OK, smr_tick(s, 0, &report));
    for (uint32_t i = 0; i < SMR_PHASES; i++)
        assert_true(report.details.phase_ns[i] == 0u);
    s = start(0, NULL);
    assert_int_equal(SMR_OK, smr_tick(s, 0, &report));
    for (uint32_t i = 0; i < SMR_PHASES; i++)
        assert_true(report.details.phase_ns[i] == 0u);
}

/* A replaced target counts at the latest from the next complete iteration: the run equals an unbudgeted one that was
 * given the new target before iteration `from` or after it. */
TEST(test_target_replaced_in_the_middle)
{
    const uint32_t n = source.n_vertices;
    uint32_t tried = 0;
    for (uint32_t stop = 1; stop < 200u; stop += rig_times(20) < 20u ? 12u : 3u) {
        rig_clock clock;
        const smr_port port = rig_clock_port(&clock, RIG_CLOCK_STEADY, 1000);
        smr *s = start(stop % 2u, &port), *before = start(stop % 2u, NULL), *after = start(stop % 2u, NULL);
        smr_tick_report report = {0};
        (void)rig_run(s, 3);
        (void)rig_run(before, 3);
        (void)rig_run(after, 4);
        uint32_t partial = 0;
        while (partial < stop && smr_tick(s, 2000, &report) == SMR_PARTIAL)
            partial++;
        if (partial < stop) /* the iteration has no so many stops */
            break;
        const float *last = rig_positions(s, model);
        assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, other_surface));
        assert_int_equal(SMR_OK, smr_set_surface(before, SMR_ALL, other_surface));
        assert_int_equal(SMR_OK, smr_set_surface(after, SMR_ALL, other_surface));
        assert_memory_equal(last, rig_positions(s, model), n * 3u * sizeof(float));
        (void)rig_run(s, 3);
        (void)rig_run(before, 3);
        (void)rig_run(after, 2);
        const float *x = rig_positions(s, model);
        assert_true(rig_finite(x, n));
        if (memcmp(x, rig_positions(before, model), n * 3u * sizeof(float)) != 0 &&
            memcmp(x, rig_positions(after, model), n * 3u * sizeof(float)) != 0) {
            fail_msg("after stop %u: %g mm from the one, %g mm from the other", stop,
                     (double)rig_far(x, rig_positions(before, model), n),
                     (double)rig_far(x, rig_positions(after, model), n));
        }
        tried++;
    }
    assert_true(tried > rig_times(20) / 2u);
}

/* Everything may be read, and a start over asked for, while an iteration is under way. */
TEST(test_start_over_in_the_middle)
{
    float **plain = plain_run(0);
    const uint32_t bytes = source.n_vertices * 3u * (uint32_t)sizeof(float);
    const smr_pose same = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    for (uint32_t stop = 1; stop < 60u; stop += rig_times(20) < 20u ? 20u : 5u) {
        rig_clock clock;
        const smr_port port = rig_clock_port(&clock, RIG_CLOCK_STEADY, 1000);
        smr *s = start(0, &port);
        for (uint32_t i = 0; i < stop; i++)
            (void)smr_tick(s, 2000, NULL);
        assert_int_equal(SMR_OK, smr_set_pose(s, &same));
        assert_memory_equal(plain[0], rig_positions(s, model), bytes);
        (void)rig_run(s, 4);
        assert_memory_equal(plain[4], rig_positions(s, model), bytes);
    }
}
