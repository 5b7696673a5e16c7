/* test_combinations.c: whatever is switched on together, of contact, fixed surfaces, volumes, smoothing, dynamics,
 * tracking and fusing by logarithms, positions stay finite, and are the same bits with one and with three threads, in
 * any order of tasks, by ticks that a clock cuts, when every task and search stops often, and when local volumes are
 * asked for in between. A combination is refused or runs. A port that breaks its contract, in any of them, is told from
 * one that does not (SMR_TEST_CHAOS: runs of each combination, instead of 2).
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <stdlib.h>
#include <string.h>
#include "property/rig_chaos.h"
#include "property/rig_parts.h"
#include "registration/tick/iteration_steps.h"
#include "smr_pthread.h"

#define ITERATIONS 12u
#define TICKS_MAX 200000u

enum { LOOKS = 1, PIECES = 2 };
enum { CONTACT = 1, VOLUME = 2, SMOOTH = 4, DYNAMICS = 8, TRACK = 16, LIE = 32, COMBINATIONS = 64 };

static struct world {
    rig_parts of;
    const smr_surface *goal[RIG_PARTS], *fixed;
    smr_port threads;
    uint32_t stops; /* number of searches that stopped */
} world;

BEFORE_EACH_TEST()
{
    const float beside[3] = {30, 34, 0};
    const smr_volume image = rig_parts_image(0.0f);
    const smr_mesh fixed = rig_ball(16.0f, 9, 13, beside);
    for (uint32_t i = 0; i < RIG_PARTS; i++) {
        const smr_mesh goal = rig_parts_goal(i);
        world.goal[i] = rig_surface(&goal);
    }
    world.fixed = rig_surface(&fixed);
    world.of = rig_parts_make(&image);
}

static smr_config config_of(uint32_t what)
{
    smr_config c = smr_config_default();
    c.basic.n_workers = 3;
    c.basic.n_target_vertices = what & DYNAMICS ? 0u : 1200u;
    c.basic.iterations = 2;
    c.basic.iterations_last = 5;
    c.motion.settle_um = 0.0f;
    c.basic.method = (what ^ what >> 1 ^ what >> 3 ^ what >> 5) & 1u;
    c.motion.fusing = what & LIE ? SMR_FUSING_LIE : SMR_FUSING_LINEAR;
    c.contact.share = what & CONTACT ? 0.9f : 0.0f;
    c.contact.gap_mm = what & CONTACT ? 0.5f : 0.0f;
    c.contact.n_fixed = what & CONTACT ? 1u : 0u;
    c.contact.volume = what & VOLUME ? 0.8f : 0.0f;
    c.contact.smooth = what & SMOOTH ? 0.3f : 0.0f;
    c.track.mode = what & TRACK ? SMR_TRACK_RECOVER : SMR_TRACK_OFF;
    c.dynamics.mode = what & DYNAMICS ? SMR_DYNAMICS_ON : SMR_DYNAMICS_OFF;
    c.dynamics.gravity[2] = what & DYNAMICS ? -9810.0f : 0.0f;
    return c;
}

static smr *start(uint32_t what, const smr_config *config, const smr_port *port)
{
    smr *s = rig_init(world.of.model[0], config, port);
    for (uint32_t i = 0; i < RIG_PARTS; i++)
        assert_int_equal(SMR_OK, smr_set_surface(s, i, world.goal[what & LIE ? 0u : i]));
    if (what & CONTACT)
        assert_int_equal(SMR_OK, smr_set_fixed(s, 0, world.fixed));
    if (what & VOLUME)
        assert_int_equal(SMR_OK, smr_set_volume_ratio(s, 1, 0.9f));
    assert_int_equal(SMR_OK, smr_set_active(s, SMR_ALL)); /* whatever the clock says */
    return s;
}

/* What is read between ticks, in memory that is free then. */
static void look(smr *s)
{
    float ratio[RIG_PARTS * RIG_PART_VERTICES];
    smr_verdict verdict;
    assert_int_equal(SMR_OK, smr_get_local_volume(s, SMR_ALL, 0, ratio));
    assert_int_equal(SMR_OK, smr_get_verdict(s, SMR_ALL, &verdict));
}

/* An iteration whose tasks stop after little work, also within searches, lists and contacts. */
static smr_status run_in_pieces(smr *s, uint32_t *seed)
{
    smr_worker *w = s->shared.worker;
    if (smr_idle(&s->schedule))
        return SMR_OK;
    smr_schedule_begin(s);
    for (s->step = 0; s->step < smr_n_steps; s->step++) {
        const smr_step *step = &smr_steps[s->step];
        const uint32_t some = smr_step_tasks(s, step);
        for (w->next = 0; w->next < smr_step_tasks(s, step);) {
            w->pause.kept = 0;
            w->pause.left = rig_random(seed, 8) == 0u ? SMR_WORK_MOST : w->pause.after + rig_random(seed, 4000);
            step->run(smr_stage_of(s, step), w->next, 0);
            world.stops += w->pause.in_search;
            if (w->pause.kept)
                continue;
            w->at = w->index = w->within = 0;
            w->next++;
        }
        w->pause.left = SMR_ENDLESS;
        if (some > 0u && step->end != NULL)
            step->end(s);
    }
    s->step = 0;
    smr_guard_close(s);
    return SMR_OK;
}

/* State hashes of ITERATIONS complete iterations. */
static void run(uint32_t what, const smr_config *config, const smr_port *port, uint64_t budget, int how,
                uint64_t hash[ITERATIONS])
{
    smr *s = start(what, config, port);
    smr_tick_report report = {0};
    uint32_t done = 0, seed = 1;
    for (uint32_t tick = 0; tick < TICKS_MAX && done < ITERATIONS; tick++) {
        const smr_status status = how == PIECES ? run_in_pieces(s, &seed) : smr_tick(s, budget, &report);
        if (status == SMR_PARTIAL && budget > 0u)
            continue;
        assert_int_equal(SMR_OK, status);
        hash[done++] = smr_state_hash(s);
        if (how == LOOKS)
            look(s);
    }
    assert_int_equal(ITERATIONS, done);
    assert_true(rig_finite(rig_positions(s, world.of.model[0]), world.of.n_vertices));
}

static int runs_alike(uint32_t what)
{
    const smr_config config = config_of(what);
    const smr_port shuffled = rig_port(RIG_SHUFFLE, 3);
    uint64_t plain[ITERATIONS], other[ITERATIONS];
    rig_clock clock;
    size_t bytes;
    if (smr_arena_bytes(world.of.model[0], &config, &bytes) == SMR_E_CONFIG)
        return 0;
    const smr_port cut = rig_clock_port(&clock, RIG_CLOCK_STEADY, 700);
    const struct {
        const char *name;
        const smr_port *port;
        uint64_t budget;
        int how;
    } way[] = {{"three threads", &world.threads, 0, 0},
               {"another order", &shuffled, 0, LOOKS},
               {"a clock", &cut, 100000, 0},
               {"pieces", NULL, 0, PIECES}};
    run(what, &config, NULL, 0, 0, plain);
    for (uint32_t k = 0; k < sizeof way / sizeof way[0]; k++) {
        run(what, &config, way[k].port, way[k].budget, way[k].how, other);
        for (uint32_t i = 0; i < ITERATIONS; i++)
            if (plain[i] != other[i])
                fail_msg("combination %u: %s differs in iteration %u", what, way[k].name, i);
    }
    return 1;
}

TEST(test_combinations)
{
    smr_pthread *pool = NULL;
    const size_t pool_bytes = smr_pthread_bytes(3);
    uint32_t legal = 0;
    assert_int_equal(SMR_OK, smr_pthread_create(&pool, rig_alloc(pool_bytes), pool_bytes, 3));
    world.threads = smr_pthread_port(pool);
    for (uint32_t what = 0; what < COMBINATIONS; what++) {
        const int ran = runs_alike(what);
        legal += (uint32_t)ran;
        assert_true(ran || (what & DYNAMICS)); /* only dynamics excludes others */
    }
    smr_pthread_destroy(pool);
    if (getenv("SMR_TEST_SHOW") != NULL)
        print_message("%u of %u combinations are legal, %u stops\n", legal, (uint32_t)COMBINATIONS, world.stops);
    assert_true(legal > COMBINATIONS / 2u && world.stops > 100000u);
}

/* A tick whose port broke its contract, or did not: refused, with the last positions, or with the bits of the twin. */
static void tick_in_chaos(rig_chaos *chaos, smr *s, smr *twin, uint64_t budget)
{
    static const smr_pose same = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    const uint32_t before = chaos->broken;
    const smr_status status = smr_tick(s, budget, NULL);
    if (chaos->broken > before) {
        const float *x = rig_positions(s, world.of.model[0]), *y = rig_positions(twin, world.of.model[0]);
        assert_int_equal(SMR_E_STATE, status);
        assert_memory_equal(x, y, 3u * world.of.n_vertices * sizeof *x);
        assert_int_equal(SMR_E_STATE, smr_tick(s, budget, NULL));
        assert_int_equal(SMR_OK, smr_set_pose(s, &same));
        assert_int_equal(SMR_OK, smr_set_pose(twin, &same));
        return;
    }
    assert_true(status == SMR_OK || status == SMR_PARTIAL);
    if (status == SMR_OK)
        assert_int_equal(SMR_OK, smr_tick(twin, 0, NULL));
    assert_true(smr_state_hash(s) == smr_state_hash(twin));
}

/* A verdict in steps: refused, or that of the twin. */
static void ask_in_chaos(rig_chaos *chaos, const smr_port *port, smr *s, smr *twin)
{
    smr_verdict found, wanted;
    smr_job job;
    const uint32_t before = chaos->broken;
    memset(&found, 0, sizeof found);
    memset(&wanted, 0, sizeof wanted);
    smr_status status = smr_verdict_begin(s, SMR_ALL, &found, &job);
    if (status == SMR_OK)
        for (status = SMR_PARTIAL; status == SMR_PARTIAL;)
            status = smr_job_step(&job, 0, port, 50000);
    const int answers = smr_get_verdict(twin, SMR_ALL, &wanted) == SMR_OK;
    assert_true(status == SMR_OK || status == SMR_E_STATE);
    if (status == SMR_OK)
        assert_true(answers && chaos->broken == before && memcmp(&found, &wanted, sizeof found) == 0);
}

TEST(test_ports_and_clocks_in_chaos)
{
    const char *const more = getenv("SMR_TEST_CHAOS");
    const uint32_t runs = COMBINATIONS * (more != NULL ? (uint32_t)atoi(more) : 2u);
    uint32_t broken = 0, seed = 5;
    for (uint32_t k = 0; k < runs; k++) {
        const uint32_t what = k % COMBINATIONS;
        const smr_config config = config_of(what);
        size_t bytes;
        rig_chaos chaos;
        if (smr_arena_bytes(world.of.model[0], &config, &bytes) != SMR_OK)
            continue;
        const smr_port port = rig_chaos_port(&chaos, 77u + k, 3, 60);
        smr *s = start(what, &config, &port), *twin = start(what, &config, NULL);
        for (uint32_t i = 0; i < 12u; i++) {
            tick_in_chaos(&chaos, s, twin, k / COMBINATIONS % 2u ? 0u : (uint64_t)1 << (10u + rig_random(&seed, 14)));
            if (rig_random(&seed, 4) == 0u)
                ask_in_chaos(&chaos, &port, s, twin);
        }
        broken += chaos.broken;
        rig_free(s);
        rig_free(twin);
    }
    if (getenv("SMR_TEST_SHOW") != NULL)
        print_message("%u loops broke the contract\n", broken);
    assert_true(broken > COMBINATIONS);
}
