/* test_points.c: registrations onto clouds of points. Clouds that grow between ticks, also partial ones, replay from
 * their logs to the last bit with other numbers of workers and task orders. Moved inputs give the moved result. Many
 * noisy points give a better surface than one of them.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "property/rig_cloud.h"

enum { RUNS = 60, STEPS = 60, PARTS = RIG_PAIR, CLOUDS = 2, CAPACITY = RIG_CLOUD_ROOM, ADDED = 200 };

static smr_mesh part[PARTS];
static const smr_model *model;

BEFORE_EACH_TEST()
{
    const rig_pair pair = rig_pair_make();
    memcpy(part, pair.part, sizeof part);
    model = pair.model;
}

typedef rig_point point;

static void add(smr_points *cloud, const point *p) { assert_int_equal(SMR_OK, rig_cloud_add(cloud, p)); }

/* ---- logs */

/* A set of the log: of which cloud, and how many points it had been given. */
typedef struct given {
    uint32_t cloud, n;
} given;

static struct run {
    smr *s;
    uint32_t seed, ticks, partial, early, late, full;
    int has_forces, gathers;
    point added[CLOUDS][ADDED];
    uint32_t n_added[CLOUDS];
    smr_points *cloud[CLOUDS], *again[CLOUDS]; /* of the run, and of its replay */
    uint32_t n_again[CLOUDS];
    given given[STEPS];
    uint32_t n_given, next;
    unsigned char log[SMR_LOG_BYTES(STEPS, STEPS)];
} r;

/* The replay's own cloud, as far as it had grown when it was set. */
static const void *grown_cloud(void *ctx, const smr_log_record *record)
{
    const given *g = &r.given[r.next++];
    (void)ctx;
    assert_int_equal(SMR_LOG_POINTS, record->kind);
    for (; r.n_again[g->cloud] < g->n; r.n_again[g->cloud]++)
        add(r.again[g->cloud], &r.added[g->cloud][r.n_again[g->cloud]]);
    return r.again[g->cloud];
}

static void set_points(uint32_t which)
{
    const uint32_t structure = rig_random(&r.seed, 4), more = rig_random(&r.seed, 25);
    const int taken = rig_random(&r.seed, 8) == 0u;
    for (uint32_t i = 0; i < more && r.n_added[which] < ADDED; i++) {
        point *p = &r.added[which][r.n_added[which]++];
        *p = rig_cloud_point(&r.seed, which, 25.0f, 1.0f);
        add(r.cloud[which], p);
    }
    r.full += r.n_added[which] > CAPACITY;
    r.late += (uint32_t)r.has_forces;
    r.early += (uint32_t)r.gathers;
    r.gathers = 0;
    /* both, for a cloud that has grown must be set again wherever it is in use */
    for (uint32_t k = 0; k < CLOUDS; k++) {
        const smr_points *cloud = taken && k == which ? NULL : r.cloud[k];
        assert_int_equal(SMR_OK, smr_set_points(r.s, structure == 3u && k == which ? SMR_ALL : k, cloud));
        if (cloud != NULL)
            r.given[r.n_given++] = (given){k, r.n_added[k]};
    }
}

static void tick(uint64_t budget)
{
    smr_tick_report report;
    const smr_status status = smr_tick(r.s, budget, &report);
    assert_true(status == SMR_OK || status == SMR_PARTIAL);
    r.ticks++;
    r.partial += status == SMR_PARTIAL;
    r.has_forces = status == SMR_PARTIAL && report.details.phase != SMR_PHASE_FORCES;
    r.gathers = status == SMR_PARTIAL && report.details.phase == SMR_PHASE_FORCES;
}

static void begin_run(uint32_t seed)
{
    memset(&r, 0, sizeof r);
    r.seed = seed;
    for (uint32_t k = 0; k < CLOUDS; k++) {
        r.cloud[k] = rig_cloud(CAPACITY);
        r.again[k] = rig_cloud(CAPACITY);
    }
}

static void replay(smr *twin)
{
    assert_int_equal(r.ticks, rig_replays(r.s, r.log, grown_cloud, NULL, twin, NULL));
    assert_true(smr_state_hash(twin) == smr_state_hash(r.s));
}

TEST(test_growth_replays)
{
    uint32_t seed = 5, partial = 0, early = 0, late = 0, full = 0;
    const uint32_t runs = rig_times(RUNS);
    for (uint32_t n = 0; n < runs; n++) {
        rig_jitter clock = {rig_random(&seed, 1u << 27), 1000000u};
        const smr_port recording = {&clock, 1u + n % 4u, NULL, rig_jitter_read};
        const smr_port other = rig_port(n % RIG_SCHEDULERS, 1u + n / 4u % 4u);
        begin_run(rig_random(&seed, 1u << 27));
        smr_config config = rig_cloud_config(&r.seed);
        config.track.mode = rig_random(&r.seed, 3);
        config.track.iterations = 2u + rig_random(&r.seed, 8);
        r.s = rig_init(model, &config, &recording);
        assert_int_equal(SMR_OK, smr_set_log(r.s, r.log, sizeof r.log));
        for (uint32_t step = 0; step < STEPS / 2u; step++) {
            if (rig_random(&r.seed, 3) == 0u)
                set_points(rig_random(&r.seed, CLOUDS));
            tick(rig_random(&r.seed, 4) == 0u ? 0u
                                              : (uint64_t)(10u + rig_random(&r.seed, 1000)) << rig_random(&r.seed, 12));
        }
        config.basic.n_workers = other.n_workers;
        replay(rig_init(model, &config, &other));
        partial += r.partial;
        early += r.early;
        late += r.late;
        full += r.full;
    }
    assert_true(partial > 5u * runs && early > runs / 2u && late > runs / 4u && full > runs / 4u);
}

/* A cloud that has changed is not taken for set because another one is. */
TEST(test_each_is_set_again)
{
    begin_run(7);
    smr_config config = rig_cloud_config(&r.seed);
    r.s = rig_init(model, &config, NULL);
    for (uint32_t k = 0; k < CLOUDS; k++) {
        add(r.cloud[k], &(point){{22, 0, 0}, {1, 0, 0}, 1});
        assert_int_equal(SMR_OK, smr_set_points(r.s, k, r.cloud[k]));
    }
    tick(0);
    for (uint32_t k = 0; k < CLOUDS; k++)
        add(r.cloud[k], &(point){{0, 22, 0}, {0, 1, 0}, 1});
    for (uint32_t k = 0; k < CLOUDS; k++) {
        assert_int_equal(SMR_E_STATE, smr_tick(r.s, 0, NULL));
        assert_int_equal(SMR_OK, smr_set_points(r.s, k, r.cloud[k]));
    }
    tick(0);
}

/* A replay that gets another cloud says so. */
TEST(test_another_cloud_is_told)
{
    smr_replay again;
    smr_replay_report report;
    smr_log_state log;
    begin_run(3);
    smr_config config = rig_cloud_config(&r.seed);
    r.s = rig_init(model, &config, NULL);
    assert_int_equal(SMR_OK, smr_set_log(r.s, r.log, sizeof r.log));
    add(r.cloud[0], &(point){{22, 0, 0}, {1, 0, 0}, 1});
    assert_int_equal(SMR_OK, smr_set_points(r.s, SMR_ALL, r.cloud[0]));
    tick(0);
    r.given[0] = (given){0, 1};
    r.added[0][0] = (point){{22, 0, 0}, {1, 0, 0}, 1.5f}; /* another weight */
    assert_int_equal(SMR_OK, smr_get_log(r.s, &log));
    assert_int_equal(SMR_OK,
                     smr_replay_start(rig_init(model, &config, NULL), r.log, log.bytes, grown_cloud, NULL, &again));
    assert_int_equal(SMR_E_INPUT, smr_replay_tick(&again, &report));
    assert_int_equal(SMR_LOG_POINTS, report.record.kind);
}

/* ---- what is reached */

static smr *run_onto(const smr_points *cloud, uint32_t n, const smr_port *port, uint32_t workers)
{
    smr_config c = smr_config_default();
    c.basic.n_target_vertices = n;
    c.basic.n_workers = workers;
    smr *s = rig_init(model, &c, port);
    assert_int_equal(SMR_OK, smr_set_points(s, 0, cloud));
    assert_int_equal(1, rig_run(s, 1000).done);
    return s;
}

static void radii_of(const smr *s, float *radius)
{
    float *xyz = rig_alloc(3u * part[0].n_vertices * sizeof *xyz);
    assert_int_equal(SMR_OK, smr_get_positions(s, 0, xyz));
    for (uint32_t v = 0; v < part[0].n_vertices; v++) {
        const float *p = xyz + 3u * (size_t)v;
        radius[v] = sqrtf(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
    }
}

static float mean_difference(const float *a, const float *b)
{
    float sum = 0.0f;
    for (uint32_t v = 0; v < part[0].n_vertices; v++)
        sum += fabsf(a[v] - b[v]);
    return sum / (float)part[0].n_vertices;
}

/* Radii that a ball has by n points of noise mm. */
static float *radii_by(uint32_t n, uint32_t seed, float noise)
{
    smr_points *cloud = rig_cloud(n);
    float *radius = rig_alloc(part[0].n_vertices * sizeof(float));
    smr_verdict verdict;
    for (uint32_t i = 0; i < n; i++) {
        const point p = rig_cloud_point(&seed, 0, 24.0f, noise);
        add(cloud, &p);
    }
    smr *s = run_onto(cloud, n, NULL, 1);
    radii_of(s, radius);
    assert_int_equal(SMR_OK, smr_get_verdict(s, 0, &verdict));
    assert_true(verdict.visible_share > 0.95f && verdict.target_covered > 0.95f && verdict.normals_agree > 0.95f);
    assert_true(!(noise > 0.0f) || (verdict.residual_mm > 0.3f && verdict.residual_mm < 0.9f));
    return radius;
}

/* Returns the mean difference, mm, that noise of 1 mm makes: a point is 0.5 off in the mean. */
static float apart_by(uint32_t n)
{
    float apart = 0.0f;
    for (uint32_t seed = 9; seed < 12u; seed++) {
        const float *clean = radii_by(n, seed, 0.0f);
        apart += mean_difference(clean, radii_by(n, seed, 1.0f)) / 3.0f;
        for (uint32_t v = 0; v < part[0].n_vertices; v++)
            assert_true(clean[v] > 24.0f && clean[v] < 26.0f);
    }
    return apart;
}

/* Against points without noise: vertices of a coarse ball lie outside the sphere that its facets are laid onto. */
TEST(test_noise_averages)
{
    assert_true(apart_by(1500) < 0.075f); /* 0.079 and 0.20 if the model follows points that others do not confirm */
    assert_true(apart_by(200) < 0.17f);
}

TEST(test_workers_change_no_bit)
{
    smr_points *cloud = rig_cloud(CAPACITY);
    uint32_t seed = 11;
    uint64_t hash = 0;
    for (uint32_t i = 0; i < CAPACITY; i++) {
        const point p = rig_cloud_point(&seed, 0, 24.0f, 0.5f);
        add(cloud, &p);
    }
    for (uint32_t k = 0; k < RIG_SCHEDULERS; k++) {
        const smr_port port = rig_port(k, 1u + k);
        const uint64_t now = smr_state_hash(run_onto(cloud, CAPACITY, &port, 1u + k));
        assert_true(k == 0u || now == hash);
        hash = now;
    }
}

/* Within its noise a point pulls nothing. */
TEST(test_noise_pulls_nothing)
{
    smr_points *cloud = rig_cloud(CAPACITY);
    smr_config c = smr_config_default();
    smr_tick_report report = {0};
    float *radius[3];
    uint32_t seed = 2;
    for (uint32_t k = 0; k < 3u; k++)
        radius[k] = rig_alloc(part[0].n_vertices * sizeof(float));
    for (uint32_t i = 0; i < CAPACITY; i++) {
        const point p = rig_cloud_point(&seed, 0, 22.5f, 0.0f);
        add(cloud, &p);
    }
    c.basic.n_target_vertices = CAPACITY;
    c.partial.coverage = SMR_COVERAGE_WHOLE;
    radii_of(rig_init(model, &c, NULL), radius[2]);
    for (uint32_t k = 0; k < 2u; k++) {
        c.partial.noise_mm = k == 0u ? 0.0f : 5.0f;
        smr *s = rig_init(model, &c, NULL);
        assert_int_equal(SMR_OK, smr_set_points(s, 0, cloud));
        do
            assert_int_equal(SMR_OK, smr_tick(s, 0, &report));
        while (!report.done);
        radii_of(s, radius[k]);
    }
    assert_true(mean_difference(radius[0], radius[2]) > 0.2f && mean_difference(radius[1], radius[2]) < 1e-4f);
}

/* The mean error across the surface that n points of an ellipsoid leave, mm. */
static float expected_across(uint32_t n)
{
    smr_points *cloud = rig_cloud(n);
    float *across = rig_alloc(part[0].n_vertices * sizeof(float)), sum = 0.0f;
    uint32_t seed = 7;
    for (uint32_t i = 0; i < n; i++) {
        point p = rig_cloud_point(&seed, 0, 24.0f, 0.0f);
        p.xyz[0] *= 1.15f;
        add(cloud, &p);
    }
    assert_int_equal(SMR_OK, smr_get_expected_parts(run_onto(cloud, n, NULL, 1), 0, across, NULL));
    for (uint32_t v = 0; v < part[0].n_vertices; v++)
        sum += across[v];
    return sum / (float)part[0].n_vertices;
}

TEST(test_few_points_leave_more_open)
{
    smr_points *cloud = rig_cloud(5);
    smr_verdict verdict;
    uint32_t seed = 7;
    for (uint32_t i = 0; i < 5u; i++) {
        const point p = rig_cloud_point(&seed, 0, 25.0f, 0.0f);
        add(cloud, &p);
    }
    assert_int_equal(SMR_OK, smr_get_verdict(run_onto(cloud, 5, NULL, 1), 0, &verdict));
    assert_true(verdict.expected_error_mm < 0.0f && verdict.level != SMR_VERDICT_GOOD);
    const float few = expected_across(40), many = expected_across(1500);
    assert_true(few > 1.8f * many);
}

/* The largest distance from a ball's surface, mm: nothing tells how far it turned about its middle. */
static float off_ball(const float *xyz, const smr_mesh *ball)
{
    double middle[3] = {0, 0, 0}, most = 0;
    for (uint32_t i = 0; i < 3u * ball->n_vertices; i++)
        middle[i % 3u] += (double)ball->xyz[i] / ball->n_vertices;
    for (uint32_t v = 0; v < ball->n_vertices; v++) {
        double is = 0, was = 0;
        for (uint32_t k = 0; k < 3u; k++) {
            const double a = (double)xyz[3u * v + k] - middle[k], b = (double)ball->xyz[3u * v + k] - middle[k];
            is += a * a;
            was += b * b;
        }
        most = fmax(most, fabs(sqrt(is) - sqrt(was)));
    }
    return (float)most;
}

/* Some 20 points hold one side; the far side follows, and is not said to be seen. */
TEST(test_one_side)
{
    static const float turn[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, shift[3] = {3, 1, -2};
    smr_points *cloud = rig_cloud(CAPACITY);
    unsigned char *seen = rig_alloc(part[0].n_vertices);
    const smr_mesh truth = rig_moved(&part[0], turn, shift);
    float *xyz = rig_alloc(3u * part[0].n_vertices * sizeof *xyz);
    uint32_t front = 0, back = 0, n = 0;
    for (uint32_t v = 0; v < truth.n_vertices; v++) {
        const float *p = truth.xyz + 3u * (size_t)v;
        if (p[2] > 3.0f && n++ < CAPACITY)
            add(cloud, &(point){{p[0], p[1], p[2]}, {0, 0, 0}, 1});
    }
    smr *s = run_onto(cloud, CAPACITY, NULL, 1);
    assert_int_equal(SMR_OK, smr_get_positions(s, 0, xyz));
    assert_int_equal(SMR_OK, smr_get_visible(s, 0, seen));
    for (uint32_t v = 0; v < part[0].n_vertices; v++) {
        front += seen[v] && part[0].xyz[3u * (size_t)v + 2u] > 5.0f;
        back += seen[v] && part[0].xyz[3u * (size_t)v + 2u] < -15.0f;
    }
    assert_true(front > 20u && back == 0u);
    assert_true(off_ball(xyz, &truth) < 2.0f);
}

/* A bone, for a ball could turn about itself. */
TEST(test_moved_inputs)
{
    static const float far[3] = {120, -35, 64};
    enum { BONE = 2000 };
    smr_mesh bone, goal;
    float turn[9], *xyz[2];
    rig_bone(9000, 1.0f, &bone, &goal);
    rig_rotation(1, 2, -1, 40, turn);
    const smr_mesh moved_goal = rig_moved(&goal, turn, far);
    const smr_model *one = rig_model(&bone, 1, NULL);
    const smr_pose pose = {{{turn[0], turn[1], turn[2], far[0]},
                            {turn[3], turn[4], turn[5], far[1]},
                            {turn[6], turn[7], turn[8], far[2]}}};
    for (uint32_t k = 0; k < 2u; k++) {
        smr_points *cloud = rig_cloud(BONE);
        smr_config c = smr_config_default();
        c.basic.n_target_vertices = BONE;
        c.partial.coverage =
            SMR_COVERAGE_WHOLE; /* which vertices are controls of what is unseen depends on last bits */
        for (uint32_t i = 0; i < BONE && i < goal.n_vertices; i++)
            assert_int_equal(
                SMR_OK, smr_points_add(cloud, (k == 0u ? &goal : &moved_goal)->xyz + 3u * (size_t)i, NULL, NULL, 1));
        smr *s = rig_init(one, &c, NULL);
        if (k == 1u)
            assert_int_equal(SMR_OK, smr_set_pose(s, &pose));
        assert_int_equal(SMR_OK, smr_set_points(s, 0, cloud));
        assert_int_equal(1, rig_run(s, 1000).done);
        xyz[k] = rig_positions(s, one);
    }
    const smr_mesh first = {xyz[0], NULL, bone.n_vertices, 0};
    const float apart = rig_far(rig_moved(&first, turn, far).xyz, xyz[1], bone.n_vertices);
    if (getenv("SMR_TEST_SHOW") != NULL)
        print_message("%u vertices, moved inputs: %.4f mm apart\n", bone.n_vertices, (double)apart);
    assert_true(apart < 0.002f);
}
