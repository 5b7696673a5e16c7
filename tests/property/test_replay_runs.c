/* test_replay_runs.c: random registrations of several structures to surfaces and images replay from their logs to the
 * last bit: with other numbers of workers, other task orders, and without a clock. Clocks cut iterations and inputs
 * are set between partial ticks. Searches may open so few tree nodes that the place they start from matters.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <stdlib.h>
#include <string.h>
#include "property/rig_parts.h"

#define RUNS 480u
#define STEPS 70u
#define PARTS RIG_PARTS
#define SURFACES 3u
#define VERTICES_MAX RIG_PART_VERTICES

static struct world {
    rig_parts of;
    const smr_surface *surface[SURFACES];
    smr_volume volume[2];
} world;

BEFORE_EACH_TEST()
{
    for (uint32_t i = 0; i < SURFACES; i++) {
        const smr_mesh goal = rig_parts_goal(i);
        world.surface[i] = rig_surface(&goal);
    }
    for (uint32_t i = 0; i < 2u; i++)
        world.volume[i] = rig_parts_image(3.0f * (float)i);
    world.of = rig_parts_make(&world.volume[0]);
    for (uint32_t i = 0; i < PARTS; i++)
        assert_true(world.of.part[i].n_vertices <= VERTICES_MAX);
}

static smr_config random_config(uint32_t *seed)
{
    smr_config c = rig_parts_config(seed);
    c.basic.n_target_vertices = rig_random(seed, 3) ? 800u : 0u;
    c.track.mode = rig_random(seed, 3);
    c.track.iterations = 2u + rig_random(seed, 8);
    if (c.track.mode != SMR_TRACK_OFF) { /* soon */
        c.schedule.radius_first = 1u + rig_random(seed, 2);
        c.basic.iterations_last = 4u;
    }
    rig_parts_forces(&c, *seed);
    return c;
}

/* What was set, in order, for the replay. */
typedef struct inputs {
    const void *given[STEPS];
    uint32_t n, next;
} inputs;

static const void *next_input(void *ctx, const smr_log_record *record)
{
    inputs *all = ctx;
    (void)record;
    return all->next < all->n ? all->given[all->next++] : NULL;
}

typedef struct run {
    smr *s;
    uint32_t seed, model, ticks, partial, cut, early, late, done;
    int has_forces, gathers; /* an iteration is under way, and has its forces, or not yet */
    inputs all;
    float xyz[STEPS][3 * VERTICES_MAX];
    unsigned char log[SMR_LOG_BYTES(STEPS, STEPS)];
} run;

static uint64_t random_budget(uint32_t *seed)
{
    const uint32_t i = rig_random(seed, 12);
    return i == 0u ? 0u : (i == 1u ? 1u : (uint64_t)(10u + rig_random(seed, 1000)) << rig_random(seed, 12));
}

static void tick(run *r)
{
    smr_tick_report report;
    const smr_status status = smr_tick(r->s, random_budget(&r->seed), &report);
    assert_true(status == SMR_OK || status == SMR_PARTIAL);
    r->ticks++;
    r->partial += status == SMR_PARTIAL;
    r->cut += status == SMR_OK && report.details.n_taken < report.details.n_wanted;
    r->has_forces = status == SMR_PARTIAL && report.details.phase != SMR_PHASE_FORCES;
    r->gathers = status == SMR_PARTIAL && report.details.phase == SMR_PHASE_FORCES;
    r->done = report.done;
}

static void give(run *r, const void *input)
{
    if (input != NULL)
        r->all.given[r->all.n++] = input;
}

static void set_surface(run *r)
{
    const uint32_t which = rig_random(&r->seed, SURFACES + 1u), structure = rig_random(&r->seed, PARTS + 1u);
    const smr_surface *surface = which < SURFACES ? world.surface[which] : NULL;
    r->late += (uint32_t)r->has_forces;
    r->early += (uint32_t)r->gathers;
    r->gathers = 0;
    assert_int_equal(SMR_OK, smr_set_surface(r->s, structure < PARTS ? structure : SMR_ALL, surface));
    give(r, surface);
}

static void start_over(run *r, uint32_t step)
{
    const uint32_t what = step == 1u ? 2u : rig_random(&r->seed, 3), structure = rig_random(&r->seed, PARTS);
    const smr_pose pose = {{{1, 0, 0, rig_between(&r->seed, -3, 3)}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    r->has_forces = r->gathers = 0;
    if (what == 0u) {
        assert_int_equal(SMR_OK, smr_set_pose(r->s, &pose));
    } else if (what == 1u) {
        const smr_mesh *mesh = &world.of.part[structure];
        for (uint32_t i = 0; i < 3u * mesh->n_vertices; i++)
            r->xyz[step][i] = mesh->xyz[i] + rig_between(&r->seed, -1, 1);
        assert_int_equal(SMR_OK, smr_set_positions(r->s, structure, r->xyz[step]));
        give(r, r->xyz[step]);
    } else if (r->model == 1u) {
        const uint32_t which = rig_random(&r->seed, 3);
        const smr_volume *volume = which < 2u ? &world.volume[which] : NULL;
        assert_int_equal(SMR_OK, smr_set_volume(r->s, volume));
        give(r, volume);
    }
}

static smr *begin(const run *r, const smr_config *config, const smr_port *port, void *arena, size_t bytes)
{
    smr *s = NULL;
    assert_int_equal(SMR_OK, smr_init(world.of.model[r->model], config, port, arena, bytes, &s));
    return s;
}

static void record(run *r)
{
    assert_int_equal(SMR_OK, smr_set_log(r->s, r->log, sizeof r->log));
    for (uint32_t i = 0; i < STEPS; i++) {
        const uint32_t what = rig_random(&r->seed, 40);
        if (i == 0u || ((what < 5u || (r->gathers && what < 15u)) && i > 1u)) {
            set_surface(r);
        } else if (i == 1u || what == 5u || (r->has_forces && what < 9u && what > 6u) || (r->done && what < 20u)) {
            start_over(r, i);
            r->done = 0;
        } else if (what == 6u) {
            assert_int_equal(SMR_OK, smr_set_active(r->s, rig_random(&r->seed, 500)));
        } else {
            tick(r);
        }
    }
}

static void replay(run *r, smr *twin, uint32_t number)
{
    smr_log_state state;
    smr_replay again;
    smr_replay_report report;
    assert_int_equal(SMR_OK, smr_get_log(r->s, &state));
    assert_true(state.n_ticks == r->ticks && state.full == 0u);
    assert_int_equal(SMR_OK, smr_replay_start(twin, r->log, state.bytes, next_input, &r->all, &again));
    for (uint32_t i = 1; i <= r->ticks; i++) {
        assert_int_equal(SMR_OK, smr_replay_tick(&again, &report));
        assert_true(report.tick == i && report.ended == 0u);
        if (report.differs) {
            print_message("run %u, tick %u: iteration %u, %u vertices\n", number, i, report.record.iteration,
                          report.record.n_taken);
        }
        assert_int_equal(0, report.differs);
    }
    assert_int_equal(SMR_OK, smr_replay_tick(&again, &report));
    assert_true(report.ended == 1u && report.full == 0u && report.tick == r->ticks);
    assert_true(smr_state_hash(twin) == smr_state_hash(r->s));
}

/* A new image abandons an iteration that has fitted the rest pose, which smoothing takes the heights at rest from. */
TEST(test_abandoned_rest_pose)
{
    static unsigned char log[SMR_LOG_BYTES(400, 4)];
    smr_config config = smr_config_default_image();
    config.basic.iterations = 1;
    config.contact.smooth = 0.3f;
    for (uint32_t n = 0; n < 6u; n++) {
        rig_clock clock;
        const smr_port port = rig_clock_port(&clock, RIG_CLOCK_STEADY, 1000);
        inputs all = {{&world.volume[0], &world.volume[1]}, 2, 0};
        smr_tick_report report = {0};
        smr *s = rig_init(world.of.model[1], &config, &port);
        assert_int_equal(SMR_OK, smr_set_log(s, log, sizeof log));
        assert_int_equal(SMR_OK, smr_set_volume(s, &world.volume[0]));
        for (uint32_t i = 0; i < n; i++)
            assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
        do
            assert_int_equal(SMR_PARTIAL, smr_tick(s, 3000, &report));
        while (report.details.phase < SMR_PHASE_MATCH);
        assert_int_equal(SMR_OK, smr_set_volume(s, &world.volume[1]));
        for (uint32_t i = 0; i < 2u; i++)
            assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
        assert_true(rig_replays(s, log, next_input, &all, rig_init(world.of.model[1], &config, NULL), NULL) > n);
    }
}

TEST(test_replays)
{
    static _Alignas(SMR_ALIGN) unsigned char memory[2][1u << 19];
    static run r;
    const uint32_t runs = rig_times(RUNS);
    uint32_t seed = 7, ticks = 0, partial = 0, cut = 0, early = 0, late = 0;
    for (uint32_t n = 0; n < runs; n++) {
        rig_jitter clock = {rig_random(&seed, 1u << 27), 1000000u};
        const smr_port other = rig_port(n % RIG_SCHEDULERS, 1u + n / 4u % 4u);
        const smr_port recording = {&clock, 1u + n % 4u, NULL, rig_jitter_read};
        size_t bytes = 0;
        memset(&r, 0, sizeof r);
        r.seed = rig_random(&seed, 1u << 27);
        r.model = n % 2u;
        const smr_config config = random_config(&r.seed);
        smr_config others = config;
        others.basic.n_workers = other.n_workers;
        assert_int_equal(SMR_OK, smr_arena_bytes(world.of.model[r.model], &config, &bytes));
        assert_true(bytes <= sizeof memory[0]);
        r.s = begin(&r, &config, &recording, memory[0], bytes);
        record(&r);
        replay(&r, begin(&r, &others, &other, memory[1], bytes), n);
        ticks += r.ticks;
        partial += r.partial;
        cut += r.cut;
        early += r.early;
        late += r.late;
    }
    if (getenv("SMR_TEST_SHOW") != NULL) {
        print_message(
            "%u runs: %u ticks, %u partial, %u cut; surfaces set while forces were gathered: %u, after that: %u\n",
            runs, ticks, partial, cut, early, late);
    }
    assert_true(partial > 10u * runs && cut > runs / 8u && early > runs &&
                late > runs / 2u); /* the clock meant something */
}

static void push(void *ctx, const smr_force_view *view, float *way, float *weight)
{
    for (uint32_t i = 0; i < view->n; i++) {
        way[3u * i] += 0.5f * *(const float *)ctx;
        weight[i] += 0.5f;
    }
}

/* Runs the given inputs, takes the last surface away within an iteration that already has its forces, and replays. */
static void surface_goes_late(run *r, const smr_config *config, uint32_t ticks, smr_tick_report *report)
{
    static _Alignas(SMR_ALIGN) unsigned char memory[2][1u << 19];
    static float way = 2.0f;
    static const smr_caller_force force = {push, &way};
    rig_jitter clock = {3, 1000000u};
    const smr_port port = {&clock, 1, NULL, rig_jitter_read};
    size_t bytes = 0;
    assert_int_equal(SMR_OK, smr_arena_bytes(world.of.model[r->model], config, &bytes));
    assert_true(bytes <= sizeof memory[0]);
    r->s = begin(r, config, &port, memory[0], bytes);
    assert_int_equal(SMR_OK, smr_set_log(r->s, r->log, sizeof r->log));
    if (r->model == 1u) {
        assert_int_equal(SMR_OK, smr_set_volume(r->s, &world.volume[1]));
        give(r, &world.volume[1]);
    }
    assert_int_equal(SMR_OK, smr_set_surface(r->s, 0, world.surface[0]));
    give(r, world.surface[0]);
    if (config->caller.force != SMR_CALLER_OFF) {
        assert_int_equal(SMR_OK, smr_set_force(r->s, force.force, force.ctx));
        give(r, &force);
    }
    assert_int_equal(SMR_OK, smr_tick(r->s, 0, report));
    assert_int_equal(config->schedule.radius_first, report->details.radius);
    for (r->ticks = 1; report->details.phase == SMR_PHASE_FORCES; r->ticks++)
        assert_int_equal(SMR_PARTIAL, smr_tick(r->s, 20000, report));
    assert_true(report->details.radius == config->schedule.radius_first && report->iteration == 1u && !report->done);
    assert_int_equal(SMR_OK, smr_set_surface(r->s, SMR_ALL, NULL));
    assert_int_equal(SMR_PARTIAL, smr_tick(r->s, 1, report));
    r->ticks++;
    for (uint32_t i = 0; i < ticks; i++, r->ticks++)
        assert_int_equal(SMR_OK, smr_tick(r->s, 0, report));
    replay(r, begin(r, config, NULL, memory[1], bytes), 0);
}

/* In the iteration that ends the first radius: whether the next one starts with a repair is decided in that iteration,
 * where the surface still counts. */
TEST(test_last_surface_goes_late)
{
    static run r;
    smr_config config = smr_config_default_image();
    smr_tick_report report = {0};
    r.model = 1;
    config.basic.iterations = 1; /* twice as many at the first radius */
    config.motion.settle_um = 0.0f;
    surface_goes_late(&r, &config, 5, &report);
}

/* In an iteration of the last radius: whether evening out ends it early is decided where the surface still counts. */
TEST(test_last_surface_goes_before_the_end)
{
    static run r;
    smr_config config = smr_config_default();
    smr_tick_report report = {0};
    config.schedule.radius_first = 2;
    config.motion.settle_um = 1.0e6f; /* whatever moves is settled */
    surface_goes_late(&r, &config, 3, &report);
    assert_int_equal(1, report.done); /* the iteration after it had no target and ended the schedule */
}

/* A force of the caller gives its sum behind the surface that goes late, which is no input. */
TEST(test_last_surface_goes_late_under_a_force)
{
    static run r;
    smr_config config = smr_config_default();
    smr_tick_report report = {0};
    config.caller.force = SMR_CALLER_ON;
    surface_goes_late(&r, &config, 3, &report);
}

/* A record that is damaged between two ticks is found by the tick that reads it. */
TEST(test_log_damaged_meanwhile)
{
    static run r;
    smr_config config = smr_config_default();
    smr_tick_report report = {0};
    smr_log_state log;
    smr_replay again;
    smr_replay_report found = {0};
    smr_status status = SMR_OK;
    surface_goes_late(&r, &config, 3, &report);
    assert_int_equal(SMR_OK, smr_get_log(r.s, &log));
    r.all.next = 0;
    smr *const twin = rig_init(world.of.model[0], &config, NULL);
    assert_int_equal(SMR_OK, smr_replay_start(twin, r.log, log.bytes, next_input, &r.all, &again));
    while (status == SMR_OK && !found.ended) {
        status = smr_replay_tick(&again, &found);
        if (!found.record.complete)
            r.log[again.reader.at + 5u] ^= 1u;
    }
    assert_int_equal(SMR_E_LOG, status);
}
