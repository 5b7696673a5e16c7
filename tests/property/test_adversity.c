/* test_adversity.c: random runs under clocks that jump, stand still, run backwards or advance in steps of
 * 10 ms, with budgets from a nanosecond to unlimited that change at every tick, targets replaced and calls refused
 * between partial ticks. After each step positions are finite and those of the last complete iteration, and the run
 * repeats without a clock to the last bit.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include <string.h>

#define RUNS 600u
#define STEPS 40u
#define MODELS 4u
#define VERTICES_MAX 512u

typedef struct evil_clock {
    uint32_t seed, kind;
    uint64_t time;
} evil_clock;

/* One reading of a clock that is sane most of the time; kind 0 is always. */
static uint64_t read_evil(void *ctx)
{
    evil_clock *c = ctx;
    const uint32_t dice = rig_random(&c->seed, 100), far = rig_random(&c->seed, 63);
    c->time += rig_random(&c->seed, 5000);
    if (dice < 10u && (c->kind & 1u))
        c->time += (uint64_t)1 << far;
    else if (dice >= 90u && (c->kind & 2u))
        c->time -= (uint64_t)1 << far;
    else if (c->kind & 4u)
        return c->time / 10000000u * 10000000u;
    return c->time;
}

/* Any order is allowed; a number of worker is in use once at a time. */
static void run_backwards(void *ctx, smr_task task, void *arg, uint32_t n_tasks)
{
    (void)ctx;
    for (uint32_t t = n_tasks; t > 0u; t--)
        task(arg, t - 1u, 0);
}

static struct world {
    const smr_model *model[MODELS];
    const smr_surface *surface[2];
} world;

static void set_up(void)
{
    const float none[3] = {0, 0, 0}, off[3] = {6, -3, 4};
    for (uint32_t i = 0; i < MODELS; i++) {
        const smr_mesh ball = rig_ball(30.0f, 8u + 3u * i, 10u + 4u * i, none);
        smr_prepare_config c = rig_radii(1u + i % 3u, 40.0f, 18.0f, 7.0f);
        c.block_vertices = i % 2u ? 150u : 32u; /* in pieces, and whole */
        assert_true(ball.n_vertices <= VERTICES_MAX);
        world.model[i] = rig_model(&ball, 1, &c);
    }
    for (uint32_t i = 0; i < 2u; i++) {
        const smr_mesh goal = rig_ball(33.0f - 6.0f * (float)i, 11, 17, i == 0u ? off : none);
        world.surface[i] = rig_surface(&goal);
    }
}

static smr_config random_config(uint32_t *seed, const smr_model *model)
{
    smr_config c = smr_config_default();
    smr_model_info info;
    assert_int_equal(SMR_OK, smr_model_get_info(model, &info));
    c.basic.method = rig_random(seed, 2);
    c.motion.plastic_every = rig_random(seed, 3);
    c.motion.normals = rig_random(seed, 2);
    c.basic.iterations = 1u + rig_random(seed, 4);
    c.basic.iterations_last = 1u + rig_random(seed, 8);
    c.schedule.radius_first = rig_random(seed, info.n_radii);
    c.basic.active_share = rig_random(seed, 2) ? 1.0f : rig_between(seed, 0, 1);
    c.forces.reject_deviations = rig_random(seed, 3) ? 0.0f : 2.0f;
    c.basic.n_target_vertices = rig_random(seed, 2) ? 400u : 0u;
    c.motion.settle_um = 0.0f;
    c.basic.n_workers = 4;
    return c;
}

/* A run and a twin without a clock that follows it, iteration by iteration. */
typedef struct run_pair {
    smr *s, *twin;
    const smr_model *model;
    smr_config config;
    uint32_t seed, iteration, n_vertices, cut, partial;
    uint32_t pending;         /* 1: an iteration is under way and has its forces */
    uint32_t under_way;       /* 1: an iteration may be under way */
    uint32_t asked;           /* verdicts read out */
    const smr_surface *later; /* for the twin, after this iteration */
    void *arena;
    size_t bytes;
    float last[3 * VERTICES_MAX];
} run_pair;

static void check_positions(const run_pair *p, const float *want)
{
    float now[3 * VERTICES_MAX];
    assert_int_equal(SMR_OK, smr_get_positions(p->s, 0, now));
    assert_true(rig_finite(now, p->n_vertices));
    if (want != NULL)
        assert_memory_equal(want, now, 3u * p->n_vertices * sizeof(float));
    assert_int_equal(SMR_OK, smr_get_normals(p->s, 0, now));
    assert_true(rig_finite(now, p->n_vertices));
}

static uint64_t random_budget(uint32_t *seed)
{
    static const uint64_t special[] = {1, 0, UINT64_MAX, 10000000u};
    const uint32_t i = rig_random(seed, 12);
    return i < 4u ? special[i] : (uint64_t)(1u + rig_random(seed, 1000)) << rig_random(seed, 14);
}

static void tick(run_pair *p)
{
    smr_tick_report report, twin;
    const smr_status status = smr_tick(p->s, random_budget(&p->seed), &report);
    assert_true(status == SMR_OK || status == SMR_PARTIAL);
    assert_true(report.details.n_taken <= report.details.n_wanted);
    p->pending = status == SMR_PARTIAL && report.details.phase != SMR_PHASE_FORCES;
    p->under_way = status == SMR_PARTIAL;
    p->partial += status == SMR_PARTIAL;
    if (report.iteration == p->iteration) { /* within an iteration, or done */
        assert_true(status == SMR_PARTIAL || report.done);
        check_positions(p, p->last);
        return;
    }
    assert_true(status == SMR_OK && report.iteration == p->iteration + 1u);
    p->iteration++;
    p->cut += report.details.n_taken < report.details.n_wanted;
    assert_int_equal(SMR_OK, smr_set_active(p->twin, report.details.n_taken));
    assert_int_equal(SMR_OK, smr_tick(p->twin, 0, &twin));
    assert_true(twin.state_hash == report.state_hash && twin.details.n_taken == report.details.n_taken);
    assert_true(smr_state_hash(p->twin) == smr_state_hash(p->s));
    if (p->later != NULL)
        assert_int_equal(SMR_OK, smr_set_surface(p->twin, SMR_ALL, p->later));
    p->later = NULL;
    assert_int_equal(SMR_OK, smr_get_positions(p->s, 0, p->last));
    check_positions(p, NULL);
}

/* A new target counts in this iteration as long as that has no forces yet. */
static void replace(run_pair *p)
{
    const smr_surface *surface = world.surface[rig_random(&p->seed, 2)];
    assert_int_equal(SMR_OK, smr_set_surface(p->s, SMR_ALL, surface));
    if (p->pending)
        p->later = surface;
    else
        assert_int_equal(SMR_OK, smr_set_surface(p->twin, SMR_ALL, surface));
    check_positions(p, p->last);
}

static void refused(run_pair *p)
{
    float bad[3 * VERTICES_MAX];
    smr_pose pose = {{{1, 0, 0, NAN}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    smr_config c = p->config;
    smr *other = NULL;
    memcpy(bad, p->last, sizeof bad);
    bad[rig_random(&p->seed, 3u * p->n_vertices)] = rig_random(&p->seed, 2) ? INFINITY : 1.0e9f;
    c.motion.relaxation = -1.0f;
    const smr_status status[] = {smr_set_positions(p->s, 0, bad),
                                 smr_set_positions(p->s, 7, p->last),
                                 smr_set_pose(p->s, &pose),
                                 smr_set_surface(p->s, 7, world.surface[0]),
                                 smr_init(p->model, &c, NULL, p->arena, p->bytes, &other),
                                 smr_set_active(NULL, 1),
                                 smr_set_volume(p->s, &(smr_volume){0})};
    for (uint32_t i = 0; i < sizeof status / sizeof status[0]; i++)
        assert_true(status[i] < 0);
    assert_true(other == NULL);
    check_positions(p, p->last);
}

/* The twin is not asked: what is read out changes no bit of what follows. */
static void ask(run_pair *p)
{
    smr_verdict v;
    float mm[VERTICES_MAX];
    unsigned char seen[VERTICES_MAX];
    const smr_status status = smr_get_verdict(p->s, rig_random(&p->seed, 2) ? 0u : SMR_ALL, &v);
    assert_true(status == SMR_OK || (status == SMR_E_STATE && p->under_way));
    assert_int_equal(status, smr_get_expected_error(p->s, 0, mm));
    assert_int_equal(SMR_OK, smr_get_visible(p->s, 0, seen));
    for (uint32_t i = 0; i < p->n_vertices; i++)
        assert_true(seen[i] <= 1u && (status != SMR_OK || mm[i] == -1.0f || (mm[i] >= 0.0f && mm[i] < 1.0e6f)));
    p->asked += status == SMR_OK;
}

static void start_over(run_pair *p)
{
    const smr_pose pose = {{{1, 0, 0, rig_between(&p->seed, -3, 3)}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    smr *both[2] = {p->s, p->twin};
    for (uint32_t i = 0; i < 2u; i++) {
        if (i == 1u && p->later != NULL)
            assert_int_equal(SMR_OK, smr_set_surface(p->twin, SMR_ALL, p->later));
        assert_int_equal(SMR_OK, smr_set_pose(both[i], &pose));
    }
    p->later = NULL;
    p->iteration = p->pending = p->under_way = 0;
    assert_int_equal(SMR_OK, smr_get_positions(p->s, 0, p->last));
    check_positions(p, NULL);
}

TEST(test_many_runs)
{
    set_up();
    const uint32_t runs = rig_times(RUNS);
    uint32_t seed = 41, cut = 0, partial = 0, asked = 0;
    for (uint32_t r = 0; r < runs; r++) {
        evil_clock clock = {rig_random(&seed, 1u << 27), r % 8u, 1000000u};
        const smr_port port = {&clock, 1u + r / 8u % 4u, run_backwards, read_evil};
        run_pair p;
        smr_model_info info;
        memset(&p, 0, sizeof p);
        p.model = world.model[rig_random(&seed, MODELS)];
        p.seed = rig_random(&seed, 1u << 27);
        p.config = random_config(&p.seed, p.model);
        assert_int_equal(SMR_OK, smr_model_get_info(p.model, &info));
        p.n_vertices = info.n_vertices;
        assert_int_equal(SMR_OK, smr_arena_bytes(p.model, &p.config, &p.bytes));
        static _Alignas(SMR_ALIGN) unsigned char memory[2][1u << 20];
        assert_true(p.bytes <= sizeof memory[0]);
        p.arena = memory[0];
        assert_int_equal(SMR_OK, smr_init(p.model, &p.config, &port, memory[0], p.bytes, &p.s));
        assert_int_equal(SMR_OK, smr_init(p.model, &p.config, NULL, memory[1], p.bytes, &p.twin));
        assert_int_equal(SMR_OK, smr_set_surface(p.s, SMR_ALL, world.surface[0]));
        assert_int_equal(SMR_OK, smr_set_surface(p.twin, SMR_ALL, world.surface[0]));
        assert_int_equal(SMR_OK, smr_get_positions(p.s, 0, p.last));
        for (uint32_t i = 0; i < STEPS; i++) {
            const uint32_t what = rig_random(&p.seed, 40);
            if (what < 3u)
                replace(&p);
            else if (what < 5u)
                refused(&p);
            else if (what == 5u)
                start_over(&p);
            else if (what == 6u)
                ask(&p);
            else
                tick(&p);
        }
        cut += p.cut;
        partial += p.partial;
        asked += p.asked;
    }
    assert_true(asked > runs / 10u);
    assert_true(cut > runs / 3u && partial > runs); /* the clocks meant something */
}
