/* test_save_runs.c: random registrations of several structures to whole and open surfaces and images are saved between
 * any two iterations and restored in an arena full of rubbish, with other numbers of workers, other task orders and
 * copies of the inputs. From there on both get the same calls, and come to the same bits, reports, verdicts and logs.
 * Clocks cut iterations before the save. SMR_TEST_SHOW=1 prints what was met.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <stdlib.h>
#include <string.h>
#include "base/arena.h"
#include "property/rig_cloud.h"
#include "property/rig_parts.h"

#define RUNS 60u
#define BEFORE 40u /* calls before the save, at most */
#define AFTER 40u
#define PARTS RIG_PARTS
#define SURFACES 4u
#define CLOUD SURFACES /* the number of the cloud, behind the surfaces */
#define CLOUD_ROOM 60u
#define LANDMARKS 4u
#define VERTICES_MAX RIG_PART_VERTICES
#define ARENA (1u << 19)
#define LOG_BYTES SMR_LOG_BYTES(BEFORE + AFTER + 40u, BEFORE + AFTER)

static struct world {
    rig_parts of;
    const smr_surface *surface[2][SURFACES]; /* and copies; the last is open */
    smr_points *cloud[2];
    smr_volume volume[2][2];
} world;

BEFORE_ALL_TESTS()
{
    for (uint32_t i = 0; i < 2u * SURFACES; i++) {
        const uint32_t which = i % SURFACES;
        smr_mesh goal = rig_parts_goal(which);
        if (which == SURFACES - 1u)
            goal.n_triangles = goal.n_triangles * 3u / 5u;
        world.surface[i / SURFACES][which] = rig_surface(&goal);
    }
    for (uint32_t i = 0; i < 4u; i++)
        world.volume[i / 2u][i % 2u] = rig_parts_image(3.0f * (float)(i % 2u));
    for (uint32_t i = 0; i < 2u; i++)
        assert_non_null(world.cloud[i] = rig_cloud(CLOUD_ROOM));
    world.of = rig_parts_make(&world.volume[0][0]);
    for (uint32_t i = 0; i < PARTS; i++)
        assert_true(world.of.part[i].n_vertices <= VERTICES_MAX);
}

static smr_config random_config(uint32_t *seed)
{
    smr_config c = rig_parts_config(seed);
    c.basic.n_target_vertices = rig_random(seed, 3) ? 1000u : 0u;
    c.partial.n_landmarks = rig_random(seed, 2) ? LANDMARKS : 0u;
    c.caller.goals = rig_random(seed, 3) == 0u;
    c.caller.force = rig_random(seed, 3) == 0u ? SMR_CALLER_CHECKED : SMR_CALLER_OFF;
    c.partial.coverage = rig_random(seed, 3);
    c.motion.plastic_um = rig_random(seed, 3) ? 50.0f : 1.0e5f; /* whatever moves has converged */
    c.schedule.active_first = rig_random(seed, 2) ? 1.0f : 0.3f;
    if (rig_random(seed, 2)) { /* the search in images ends before the schedule does */
        c.image.profile_mm = c.image.gradient_mm = rig_between(seed, 0.26f, 0.6f);
        c.image.profile_end_mm = c.image.gradient_end_mm = 0.0f;
    }
    c.track.mode = rig_random(seed, 3) ? SMR_TRACK_OFF : SMR_TRACK_REPORT + rig_random(seed, 2);
    c.track.radius_mm = 18.0f;
    c.track.ahead = (float)(*seed >> 9 & 1u);
    c.track.iterations = 4;
    if (c.track.mode != SMR_TRACK_OFF)
        c.basic.iterations = c.basic.iterations_last = 1u + rig_random(seed, 2);
    c.contact.volume = *seed >> 11 & 1u ? 0.8f : 0.0f;
    c.contact.smooth = *seed >> 12 & 1u ? 0.4f : 0.0f;
    rig_parts_forces(&c, *seed);
    return c;
}

/* A call that two registrations get alike. */
enum { CALL_TICK, CALL_SURFACE, CALL_VOLUME, CALL_POSE, CALL_POSITIONS, CALL_ACTIVE, CALL_LANDMARKS, CALL_POINTS };
typedef struct call {
    uint32_t kind, structure, which; /* which: of the inputs, or a number of vertices */
    uint64_t budget;
    smr_pose pose;
    float xyz[3 * VERTICES_MAX];
    smr_landmark landmark[LANDMARKS];
} call;

typedef struct run {
    uint32_t seed, model, done;
    uint32_t has[PARTS], image; /* which surface, and the image, is set; SMR_NONE */
    call now;
    smr_tick_report report[2];
    size_t log_bytes; /* of memory */
    unsigned char log[2][LOG_BYTES];
} run;

static struct met {
    uint32_t surfaces, clouds, shared, images, cuts, repairs, landmarks, polar, logs, ended, tracking;
} met;

/* A spring to a plane. */
static void spring(void *ctx, const smr_force_view *view, float *way, float *weight)
{
    for (uint32_t i = 0; i < view->n; i++) {
        way[3u * i + 2u] += 0.2f * (*(const float *)ctx - view->xyz[3u * i + 2u]);
        weight[i] += view->structure[i] == 2u ? 0.5f : 0.0f;
    }
}

/* The caller's own goals, which pull the second part aside, and force, where there is room for them. Each of the two
 * registrations has its own memory of them. */
static void set_own(smr *s, const smr_config *config, uint32_t copy)
{
    static float xyz[2][3 * VERTICES_MAX], plane[2] = {3.0f, 3.0f};
    for (uint32_t i = 0; i < 3u * world.of.part[1].n_vertices; i++)
        xyz[copy][i] = world.of.part[1].xyz[i] + 2.0f;
    if (config->caller.goals != 0u)
        assert_int_equal(SMR_OK, smr_set_goals(s, 1, xyz[copy], NULL));
    if (config->caller.force != SMR_CALLER_OFF)
        assert_int_equal(SMR_OK, smr_set_force(s, spring, &plane[copy]));
}

/* Some vertices, and points at rest on a surface and beside it. */
static void choose_landmarks(run *r)
{
    for (uint32_t i = 0; i < LANDMARKS; i++) {
        smr_landmark *l = &r->now.landmark[i];
        l->structure = rig_random(&r->seed, PARTS);
        const uint32_t v = rig_random(&r->seed, world.of.part[l->structure].n_vertices);
        l->vertex = rig_random(&r->seed, 2) ? v : SMR_NONE;
        l->hard = rig_random(&r->seed, 3) == 0u;
        l->weight = rig_between(&r->seed, 0.1f, 3.0f);
        for (uint32_t c = 0; c < 3u; c++) {
            l->rest[c] = world.of.part[l->structure].xyz[3u * v + c] + (float)(i % 2u) * rig_between(&r->seed, -4, 4);
            l->place[c] = l->rest[c] + rig_between(&r->seed, -4, 4);
        }
    }
}

/* Points around the surface of a ball, more and more of them. */
static void choose_points(run *r)
{
    for (uint32_t i = 0; i < 20u; i++) {
        const uint32_t v = rig_random(&r->seed, world.of.part[1].n_vertices);
        for (uint32_t c = 0; c < 3u; c++)
            r->now.xyz[3u * i + c] = world.of.part[1].xyz[3u * v + c] + rig_between(&r->seed, -3, 3);
    }
}

static void choose(run *r, uint32_t step, int timed)
{
    call *c = &r->now;
    const uint32_t what = rig_random(&r->seed, r->done ? 14u : 40u);
    c->structure = rig_random(&r->seed, PARTS + 1u);
    c->kind = step == 0u || what < 3u ? CALL_SURFACE : (step == 1u || what == 3u ? CALL_VOLUME : CALL_TICK);
    c->kind = step > 1u && what > 3u && what < 9u ? CALL_POSE + what - 4u : c->kind;
    if (c->kind == CALL_VOLUME && r->model == 0u)
        c->kind = CALL_TICK;
    if (c->kind == CALL_POSITIONS)
        c->structure %= PARTS;
    choose_landmarks(r);
    if (c->kind == CALL_POINTS)
        choose_points(r);
    c->which = rig_random(&r->seed, c->kind == CALL_ACTIVE ? 500u : (c->kind == CALL_VOLUME ? 3u : SURFACES + 2u));
    c->budget = !timed || rig_random(&r->seed, 2) == 0u
                    ? 0u
                    : (uint64_t)(500u + rig_random(&r->seed, 1000)) << rig_random(&r->seed, 20);
    c->pose = (smr_pose){{{1, 0, 0, rig_between(&r->seed, -3, 3)}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    for (uint32_t i = 0; c->kind == CALL_POSITIONS && i < 3u * world.of.part[c->structure].n_vertices; i++)
        c->xyz[i] = world.of.part[c->structure].xyz[i] + rig_between(&r->seed, -1, 1);
}

/* A surface, the cloud, or nothing. */
static smr_status set_target(smr *s, uint32_t structure, uint32_t which, uint32_t copy)
{
    if (which == CLOUD)
        return smr_set_points(s, structure, world.cloud[copy]);
    return smr_set_surface(s, structure, which < SURFACES ? world.surface[copy][which] : NULL);
}

/* More points, and the cloud again for those that have it. */
static smr_status add_points(run *r, smr *s, uint32_t copy)
{
    smr_status status = smr_points_add(world.cloud[copy], r->now.xyz, NULL, NULL, 20);
    for (uint32_t i = 0; status == SMR_OK && i < PARTS; i++)
        if (r->has[i] == CLOUD)
            status = smr_set_points(s, i, world.cloud[copy]);
    return status;
}

/* Makes the call; copy 1 has the inputs' copies. */
static smr_status make(run *r, smr *s, uint32_t copy)
{
    const call *c = &r->now;
    const uint32_t structure = c->structure < PARTS ? c->structure : SMR_ALL;
    switch (c->kind) {
    case CALL_TICK: return smr_tick(s, c->budget, &r->report[copy]);
    case CALL_SURFACE: return set_target(s, structure, c->which, copy);
    case CALL_LANDMARKS: return smr_set_landmarks(s, c->landmark, c->which % (LANDMARKS + 1u));
    case CALL_POINTS: return add_points(r, s, copy);
    case CALL_VOLUME: return smr_set_volume(s, c->which < 2u ? &world.volume[copy][c->which] : NULL);
    case CALL_POSE: return smr_set_pose(s, &c->pose);
    case CALL_POSITIONS: return smr_set_positions(s, c->structure, c->xyz);
    default: return smr_set_active(s, c->which);
    }
}

static void note(run *r, smr_status status)
{
    const call *c = &r->now;
    for (uint32_t i = 0; i < PARTS && c->kind == CALL_SURFACE && status == SMR_OK; i++)
        if (c->structure >= PARTS || c->structure == i)
            r->has[i] = c->which <= CLOUD ? c->which : SMR_NONE;
    if (c->kind == CALL_VOLUME)
        r->image = c->which < 2u ? c->which : SMR_NONE;
    r->done = c->kind == CALL_TICK ? r->report[0].done : 0u;
}

/* Calls until an iteration is complete somewhere, and perhaps another call. */
static void run_before(run *r, smr *s)
{
    const uint32_t n = 2u + rig_random(&r->seed, BEFORE - 4u);
    for (uint32_t i = 0; i < n; i++) {
        choose(r, i, 1);
        const smr_status status = make(r, s, 0);
        assert_true(status == SMR_OK || status == SMR_PARTIAL ||
                    (status == SMR_E_ARENA && (r->now.kind == CALL_SURFACE || r->now.kind == CALL_LANDMARKS)));
        if (r->now.kind == CALL_POINTS)
            assert_int_equal(SMR_OK, smr_points_add(world.cloud[1], r->now.xyz, NULL, NULL, 20));
        note(r, status);
        met.landmarks += r->now.kind == CALL_LANDMARKS && status == SMR_OK;
        met.cuts += r->now.kind == CALL_TICK && status == SMR_OK &&
                    r->report[0].details.n_taken < r->report[0].details.n_wanted;
    }
    memset(&r->now, 0, sizeof r->now);
    while (make(r, s, 0) == SMR_PARTIAL) {
    }
    note(r, SMR_OK);
    choose(r, 0, 0);
    if (r->now.which % 4u == 0u)
        note(r, make(r, s, 0));
}

/* Sets again what was set: each structure for itself, or all that shared a surface at once. */
static void set_again(run *r, smr *twin, const smr_config *config)
{
    const uint32_t each = rig_random(&r->seed, 2);
    uint32_t n = 0;
    for (uint32_t i = 0; i < PARTS; i++) {
        uint32_t first = 0;
        while (r->has[first] != r->has[i])
            first++;
        met.surfaces += r->has[i] != SMR_NONE;
        met.clouds += r->has[i] == CLOUD;
        met.shared += r->has[i] != SMR_NONE && first < i;
        if (r->has[i] == SMR_NONE || (!each && first < i))
            continue;
        assert_int_equal(SMR_E_STATE, smr_tick(twin, 0, NULL));
        assert_int_equal(SMR_OK, set_target(twin, each ? i : SMR_ALL, r->has[i], 1));
    }
    set_own(twin, config, 1);
    met.images += r->image != SMR_NONE;
    if (r->image != SMR_NONE)
        assert_int_equal(SMR_OK, smr_set_volume(twin, &world.volume[1][r->image]));
    assert_int_equal(SMR_OK, smr_get_awaited(twin, &n));
    assert_int_equal(0, n);
}

static smr *twin_of(run *r, const smr *s, const smr_config *config, const smr_port *port, void *memory)
{
    static unsigned char saved[ARENA];
    smr_config others = *config;
    smr *twin = NULL;
    smr_saved_info info;
    smr_log_state log;
    size_t bytes = 0, arena_bytes = 0;
    assert_int_equal(SMR_OK, smr_save_bytes(s, &bytes));
    assert_true(bytes <= SMR_SAVE_BYTES(PARTS * VERTICES_MAX, PARTS, 1000, LANDMARKS, SMR_METHOD_POLAR) +
                             SMR_SAVE_TRACK_BYTES(PARTS * VERTICES_MAX) + SMR_SAVE_AHEAD_BYTES(PARTS) +
                             SMR_SAVE_DYNAMICS_BYTES(PARTS * VERTICES_MAX, PARTS));
    assert_int_equal(SMR_OK, smr_save(s, saved, bytes));
    assert_int_equal(SMR_OK, smr_save_info(saved, sizeof saved, &info));
    assert_true(info.bytes == bytes && info.config.basic.n_workers == config->basic.n_workers);
    others.basic.n_workers = port->n_workers;
    assert_int_equal(SMR_OK, smr_arena_bytes(world.of.model[r->model], &others, &arena_bytes));
    assert_true(arena_bytes <= ARENA);
    smr_arena_release(memory, ARENA); /* red zones of the run before */
    for (uint32_t i = 0; i < ARENA; i++)
        ((unsigned char *)memory)[i] = (unsigned char)rig_random(&r->seed, 256);
    assert_int_equal(SMR_OK,
                     smr_restore(world.of.model[r->model], &others, port, saved, bytes, memory, arena_bytes, &twin));
    assert_true(smr_state_hash(s) == smr_state_hash(twin));
    memset(saved, 0, sizeof saved);
    assert_int_equal(SMR_OK, smr_get_log(s, &log));
    memcpy(r->log[1], r->log[0], sizeof r->log[0]);
    if (log.bytes > 0u && !log.full)
        assert_int_equal(SMR_OK, smr_set_log(twin, r->log[1], r->log_bytes));
    met.logs += log.bytes > 0u;
    met.tracking += r->report[0].details.tracking;
    set_again(r, twin, config);
    return twin;
}

static void same_report(run *r, uint32_t number, uint32_t step)
{
    for (uint32_t i = 0; i < 2u; i++)
        memset(r->report[i].details.phase_ns, 0, sizeof r->report[i].details.phase_ns);
    if (memcmp(&r->report[0], &r->report[1], sizeof r->report[0]) != 0)
        fail_msg("run %u, step %u after the save: radius %u, iteration %u: another report", number, step,
                 r->report[0].details.radius, r->report[0].iteration);
}

/* All that can be read of both. */
static void same_results(run *r, smr *s, smr *twin)
{
    for (uint32_t i = 0; i < PARTS; i++) {
        static float xyz[2][3 * VERTICES_MAX];
        static unsigned char seen[2][VERTICES_MAX];
        smr_verdict verdict[2];
        smr_structure_report part[2];
        smr *const both[2] = {s, twin};
        const size_t n = world.of.part[i].n_vertices;
        for (uint32_t k = 0; k < 2u; k++) {
            memset(&verdict[k], 0, sizeof verdict[k]);
            assert_int_equal(SMR_OK, smr_get_verdict(both[k], i, &verdict[k]));
            assert_int_equal(SMR_OK, smr_get_structure_report(both[k], i, &part[k]));
            assert_int_equal(SMR_OK, smr_get_visible(both[k], i, seen[k]));
            assert_int_equal(SMR_OK, smr_get_normals(both[k], i, xyz[k]));
        }
        assert_memory_equal(&verdict[0], &verdict[1], sizeof verdict[0]);
        assert_memory_equal(&part[0], &part[1], sizeof part[0]);
        assert_memory_equal(seen[0], seen[1], n);
        assert_memory_equal(xyz[0], xyz[1], 3u * n * sizeof(float));
    }
    smr_log_state log[2];
    assert_int_equal(SMR_OK, smr_get_log(s, &log[0]));
    assert_int_equal(SMR_OK, smr_get_log(twin, &log[1]));
    assert_memory_equal(&log[0], &log[1], sizeof log[0]);
    assert_memory_equal(r->log[0], r->log[1], log[0].bytes);
    assert_true(smr_state_hash(s) == smr_state_hash(twin));
}

static void run_after(run *r, smr *s, smr *twin, uint32_t number)
{
    if (rig_random(&r->seed, 2))
        same_results(r, s, twin);
    for (uint32_t i = 0; i < AFTER; i++) {
        choose(r, 2, 0);
        const smr_status status = make(r, s, 0);
        assert_int_equal(status, make(r, twin, 1));
        note(r, status);
        if (r->now.kind == CALL_TICK)
            same_report(r, number, i);
        met.repairs += r->now.kind == CALL_TICK && r->report[0].details.n_guarded > 0u;
        met.ended += r->report[0].done;
    }
    same_results(r, s, twin);
}

TEST(test_saves)
{
    static _Alignas(SMR_ALIGN) unsigned char memory[2][ARENA];
    static run r;
    uint32_t seed = 11;
    for (uint32_t n = 0; n < RUNS; n++) {
        rig_jitter clock = {rig_random(&seed, 1u << 27), 1000000u};
        const smr_port other = rig_port(n % RIG_SCHEDULERS, 1u + n / 4u % 4u);
        const smr_port saving = {&clock, 1u + n % 4u, NULL, rig_jitter_read};
        smr *s = NULL;
        size_t bytes = 0;
        memset(&r, 0, sizeof r);
        r.seed = rig_random(&seed, 1u << 27);
        for (uint32_t i = 0; i < 2u; i++)
            assert_int_equal(SMR_OK, smr_points_clear(world.cloud[i]));
        r.model = n % 2u;
        r.image = r.has[0] = r.has[1] = r.has[2] = SMR_NONE;
        const smr_config config = random_config(&r.seed);
        met.polar += config.basic.method == SMR_METHOD_POLAR;
        assert_int_equal(SMR_OK, smr_arena_bytes(world.of.model[r.model], &config, &bytes));
        assert_true(bytes <= ARENA);
        assert_int_equal(SMR_OK, smr_init(world.of.model[r.model], &config, &saving, memory[0], bytes, &s));
        r.log_bytes = n % 3u == 1u ? sizeof r.log[0] : 1500u;
        if (n % 3u != 0u)
            assert_int_equal(SMR_OK, smr_set_log(s, r.log[0], r.log_bytes));
        set_own(s, &config, 0);
        if (config.contact.volume > 0.0f)
            assert_int_equal(SMR_OK, smr_set_volume_ratio(s, SMR_ALL, 1.2f));
        run_before(&r, s);
        run_after(&r, s, twin_of(&r, s, &config, &other, memory[1]), n);
    }
    if (getenv("SMR_TEST_SHOW") != NULL)
        print_message(
            "%u runs: %u polar, %u tracking, %u calls with landmarks, %u targets, %u of them clouds, %u shared, "
            "%u images, %u cut iterations, %u logs; after it %u guarded and %u ended ticks\n",
            RUNS, met.polar, met.tracking, met.landmarks, met.surfaces, met.clouds, met.shared, met.images, met.cuts,
            met.logs, met.repairs, met.ended);
    assert_true(met.surfaces > RUNS && met.shared > RUNS / 4u && met.images > RUNS / 8u && met.cuts > RUNS / 2u &&
                met.repairs > RUNS / 4u && met.ended > RUNS && met.tracking > 3u);
}
