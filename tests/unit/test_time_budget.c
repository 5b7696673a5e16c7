/* test_time_budget.c: the controller under clocks whose every reading is known: each reading, and so each task, takes
 * a fixed number of nanoseconds. Ticks end in time and use it, and long iterations span several ticks.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <string.h>
#include "registration/tick/iteration_steps.h"

#define STEP_NS 50000u /* of a reading: so long that the least work between two readings is the most */

static const float none[3] = {0, 0, 0};
static const smr_model *model;
static const smr_surface *surface;

static void set_up(void)
{
    const smr_mesh ball = rig_ball(40, 31, 40, none), goal = rig_ball(43, 17, 24, none);
    const smr_prepare_config radii = rig_radii(1, 18, 0, 0);
    model = rig_model(&ball, 1, &radii);
    surface = rig_surface(&goal);
}

static smr *start(rig_clock *clock, uint64_t step_ns)
{
    const smr_port port = rig_clock_port(clock, RIG_CLOCK_STEADY, step_ns);
    smr_config c = smr_config_default();
    c.basic.iterations_last = 100000;
    c.motion.settle_um = 0.0f;
    c.motion.fold_guard = 0;
    c.basic.even = 0.0f;
    smr *s = rig_init(model, &c, step_ns > 0u ? &port : NULL);
    assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, surface));
    return s;
}

typedef struct outcome {
    uint64_t longest, sum;
    uint32_t whole, fewest, most, late; /* complete ticks, vertices taken by them; ticks longer than the budget */
} outcome;

static outcome run(smr *s, rig_clock *clock, uint64_t budget, uint32_t ticks)
{
    outcome o = {.fewest = SMR_ALL};
    for (uint32_t i = 0; i < ticks; i++) {
        smr_tick_report r;
        const uint64_t before = clock->time;
        const smr_status status = smr_tick(s, budget, &r);
        const uint64_t time = clock->time - before;
        assert_true(status == SMR_OK || status == SMR_PARTIAL);
        o.longest = time > o.longest ? time : o.longest;
        o.sum += time;
        o.late += time > budget;
        o.whole += status == SMR_OK;
        if (status == SMR_OK) {
            assert_true(r.details.n_taken >= s->schedule.lists.active_min && r.details.n_taken <= r.details.n_wanted &&
                        r.details.n_wanted == s->shared.n);
            o.fewest = r.details.n_taken < o.fewest ? r.details.n_taken : o.fewest;
            o.most = r.details.n_taken > o.most ? r.details.n_taken : o.most;
        }
    }
    return o;
}

/* What an iteration of all vertices takes, once their searches start near their goals. */
static uint64_t full_time(uint64_t step_ns)
{
    rig_clock clock;
    smr *s = start(&clock, step_ns);
    (void)run(s, &clock, UINT64_MAX / 2u, 5);
    const outcome o = run(s, &clock, UINT64_MAX / 2u, 3);
    assert_int_equal(3, o.whole);
    assert_true(o.fewest == s->shared.n);
    return o.longest;
}

TEST(test_in_time_and_not_idle)
{
    set_up();
    const uint64_t full = full_time(STEP_NS);
    uint32_t before = 0;
    for (uint32_t percent = 85; percent <= 160u; percent += 15u) {
        rig_clock clock;
        smr *s = start(&clock, STEP_NS);
        const uint64_t budget = full * percent / 100u;
        (void)run(s, &clock, budget, 20);
        const outcome o = run(s, &clock, budget, 60);
        assert_true(o.longest <= budget + 3u * STEP_NS);
        assert_true(o.whole >= 57u);
        assert_true(o.most >= before);
        assert_true(o.most == s->shared.n || o.sum >= 60u * (budget * 8u / 10u));
        before = o.fewest;
    }
}

/* The first thing that is learnt is nonsense. */
TEST(test_a_clock_that_is_set)
{
    set_up();
    const uint64_t budget = full_time(STEP_NS) * 19u / 20u;
    rig_clock clock;
    smr *s = start(&clock, STEP_NS);
    clock.step_ns = (uint64_t)1 << 50;
    (void)run(s, &clock, budget, 300); /* a group each */
    clock.step_ns = STEP_NS;
    (void)run(s, &clock, budget, 400);
    const outcome o = run(s, &clock, budget, 40);
    assert_true(o.longest <= budget + 3u * STEP_NS && o.whole >= 36u);
    assert_true(4u * o.most >= 3u * s->shared.n);
}

TEST(test_several_ticks)
{
    set_up();
    const uint64_t budget = full_time(STEP_NS) / 10u;
    rig_clock clock;
    smr *s = start(&clock, STEP_NS);
    (void)run(s, &clock, budget, 200);
    const outcome o = run(s, &clock, budget, 300);
    assert_true(o.longest <= budget + 3u * STEP_NS);
    assert_true(o.whole >= 300u / 13u && o.fewest == s->shared.n); /* nothing is left out, */
    assert_true(o.sum >= 300u * (budget * 7u / 10u));              /* no tick goes to waste, */
    assert_true(o.late < 30u); /* and a stretch that would end behind the budget mostly waits for the next tick */
    for (s->step = s->next_task = 0; smr_steps[s->step].work != SMR_WORK_LISTS; s->step++) {
    }
    assert_true(smr_budget_ahead(s, 9, SMR_WORK_MOST) > 0u);
    assert_true(smr_budget_ahead(s, 0, SMR_WORK_MOST) == 0u); /* nothing is left */
}

/* Cluster sums, and steps over the active vertices, are predicted to take as long in many tasks as in few; other steps
 * take longer the more tasks they have. */
TEST(test_what_times_are_of)
{
    set_up();
    rig_clock clock;
    smr *s = start(&clock, STEP_NS);
    smr_budget_start(s);
    s->budget.pace = 1.0e6f;
    for (s->step = 0; s->step < smr_n_steps; s->step++) {
        const uint32_t work = smr_steps[s->step].work, factor = work == SMR_WORK_TASKS ? 3u : 1u;
        s->budget.spent = 1000000u;
        smr_budget_learn(s, 4);
        const uint64_t few = smr_budget_ahead(s, 4, SMR_WORK_MOST), many = smr_budget_ahead(s, 12, SMR_WORK_MOST);
        assert_true(work == SMR_WORK_FOLDS || (few > 999000u && few < 1001000u));
        assert_true(many + 1000u > factor * few && many < factor * few + 1000u);
    }
}

/* One long time among short ones raises what is predicted by half, or by half of a sixteenth of an iteration. */
TEST(test_one_long_time)
{
    set_up();
    rig_clock clock;
    smr *s = start(&clock, STEP_NS);
    for (uint32_t i = 0; i < 2u; i++) {
        const uint64_t want = i == 0u ? 1500000u : 6000000u;
        smr_budget_start(s);
        s->budget.pace = 1.0e6f;
        s->budget.whole = i == 0u ? 0.0f : 1.6e8f;
        for (s->step = 0; s->step < smr_n_steps; s->step++) {
            for (uint64_t spent = 1000000u; spent <= 1000000000u; spent *= 1000u) {
                s->budget.spent = spent;
                smr_budget_learn(s, 4);
            }
            const uint64_t ahead = smr_budget_ahead(s, 4, SMR_WORK_MOST);
            assert_true(smr_steps[s->step].work == SMR_WORK_FOLDS || (ahead > want - 2000u && ahead < want + 2000u));
        }
    }
}

/* Vertices for which there was time, those of 15 us but at least 16, are searched without another look at the time
 * that is left; the look comes right after them. */
TEST(test_looks_at_the_time)
{
    set_up();
    rig_clock clock;
    smr *s = start(&clock, STEP_NS);
    for (s->step = 0; !smr_seeks_forces(&smr_steps[s->step]); s->step++) {
    }
    for (uint32_t i = 0; i < 2u; i++) {
        const uint32_t first = s->schedule.lists.active_min + 100u * i;
        uint32_t more = 1;
        s->budget.rate[s->step] = i == 0u ? 5000.0f : 500.0f; /* ns a vertex */
        assert_int_equal(0, smr_budget_reached(s, UINT64_MAX, first));
        while (more < 100u && !smr_budget_reached(s, 0, first + more))
            more++;
        assert_int_equal(i == 0u ? 16u : 30u, more);
    }
}

TEST(test_nothing_is_left_out_at_the_end)
{
    set_up();
    const uint64_t budget = full_time(STEP_NS) * 3u / 4u;
    rig_clock clock;
    smr *s = start(&clock, STEP_NS);
    smr_tick_report r = {0};
    uint32_t cut = 0;
    s->shared.config.basic.iterations_last = 30;
    smr_guard_close(s);
    for (uint32_t i = 0; i < 200u && !r.done; i++) {
        if (smr_tick(s, budget, &r) == SMR_OK) {
            cut += r.details.n_taken < s->shared.n;
            assert_true(r.details.radius_iteration <= 10u || r.details.n_taken == s->shared.n);
        }
    }
    assert_true(r.done && cut >= 8u);
}

/* The first iteration, whose costs are unknown, spans ticks with all vertices. With budget_exact each iteration does,
 * and the result has the bits of ticks without a clock. */
TEST(test_a_budget_leaves_the_result)
{
    set_up();
    const uint64_t full = full_time(STEP_NS);
    static const uint32_t cut[] = {5, 80, 125}; /* percent of an iteration: not even the least fits; a part; all */
    for (uint32_t i = 0; i < 6u; i++) {
        const uint32_t percent = cut[i / 2u], exact = i % 2u;
        rig_clock clock, never;
        smr *s = start(&clock, STEP_NS), *plain = start(&never, 0);
        smr_tick_report r = {0}, want = {0};
        uint32_t fewest = SMR_ALL;
        s->shared.config.basic.budget_exact = exact;
        smr_guard_close(s);
        for (uint32_t n = 0; n<30u; n += r.iteration> n) {
            if (smr_tick(s, full * percent / 100u, &r) != SMR_OK)
                continue;
            assert_true(r.iteration > 1u || r.details.n_taken == s->shared.n);
            fewest = r.details.n_taken < fewest ? r.details.n_taken : fewest;
            assert_int_equal(SMR_OK, smr_tick(plain, 0, &want));
        }
        assert_true((fewest == s->shared.n) == (exact || percent != 80u));
        assert_true((r.state_hash == want.state_hash) == (fewest == s->shared.n));
    }
}

/* Neither do repairs of folds leave out vertices then: the rejection of later iterations starts from their goals. */
TEST(test_exact_repairs)
{
    const smr_mesh ball = rig_ball(40, 31, 40, none), goal = rig_ball(43, 17, 24, none);
    const smr_prepare_config radii = rig_radii(3, 40, 18, 9);
    const smr_model *three = rig_model(&ball, 1, &radii);
    smr_config c = smr_config_default();
    c.basic.budget_exact = 1;
    c.forces.reject_deviations = 1.0f;
    rig_clock clock;
    const smr_port port = rig_clock_port(&clock, RIG_CLOCK_STEADY, STEP_NS);
    smr *s = rig_init(three, &c, &port), *plain = rig_init(three, &c, NULL);
    smr_tick_report r = {0}, want = {0};
    uint32_t repairs = 0;
    assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, rig_surface(&goal)));
    assert_int_equal(SMR_OK, smr_set_surface(plain, SMR_ALL, rig_surface(&goal)));
    while (!want.done) {
        repairs += s->schedule.repairing > 0u;
        assert_int_equal(SMR_OK, smr_tick(plain, 0, &want));
        while (smr_tick(s, 3000u * STEP_NS, &r) == SMR_PARTIAL) {
        }
        assert_int_equal(s->shared.n, r.details.n_taken);
        assert_true(r.state_hash == want.state_hash);
    }
    assert_true(repairs > 0u);
}

TEST(test_set_active)
{
    set_up();
    rig_clock clock;
    smr *s = start(&clock, STEP_NS), *free_one = start(&clock, 0);
    smr_tick_report r;
    assert_int_equal(SMR_E_NULL, smr_set_active(NULL, 1));
    assert_int_equal(SMR_OK, smr_set_active(s, 333));
    while (smr_tick(s, 20u * STEP_NS, &r) == SMR_PARTIAL) { /* not the controller's to change */
    }
    assert_int_equal(333, r.details.n_taken);
    assert_int_equal(SMR_OK, smr_set_active(s, 1));
    assert_int_equal(SMR_OK, smr_tick(s, 0, &r));
    assert_int_equal(s->schedule.lists.active_min, r.details.n_taken);
    assert_int_equal(SMR_OK, smr_set_active(s, SMR_ALL));
    assert_int_equal(SMR_OK, smr_tick(s, 0, &r));
    assert_int_equal(s->shared.n, r.details.n_taken);
    assert_int_equal(SMR_OK, smr_set_active(s, 444));
    assert_int_equal(SMR_OK, smr_set_active(s, 0)); /* the configuration's again */
    assert_int_equal(SMR_OK, smr_tick(s, 0, &r));
    assert_int_equal(s->shared.n, r.details.n_taken);
    s->magic = 0;
    assert_int_equal(SMR_E_STATE, smr_set_active(s, 1));
    assert_int_equal(SMR_OK, smr_tick(free_one, 1, &r)); /* no clock, no budget */
    assert_int_equal(free_one->shared.n, r.details.n_taken);
}
