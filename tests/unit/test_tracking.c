/* test_tracking.c: after the schedule a registration follows targets that are replaced: elastic about the schedule's
 * result, settled when there is nothing to do, saying what jumped; the same bits for any threads, and from a log.
 * SPDX-License-Identifier: MIT */
#include "cmocka_first.h"

#include <math.h>
#include <string.h>

#include "property/rig.h"
#include "log/record/log_format.h"
#include "registration/registration.h"

enum { LOG = SMR_LOG_BYTES(4000, 60) };

static int tidy(void **state)
{
    (void)state;
    rig_free_all();
    return 0;
}

/* A bone and targets of it that move. */
typedef struct scene {
    smr_mesh source, target;
    const smr_model *model;
    smr_config config;
} scene;

static scene make(uint32_t track)
{
    const smr_prepare_config radii = rig_radii(3, 110, 60, 35);
    scene e;
    rig_bone(12000, 1.0f, &e.source, &e.target);
    e.model = rig_model(&e.source, 1, &radii);
    e.config = smr_config_default();
    e.config.basic.n_workers = 4;
    e.config.basic.n_target_vertices = e.target.n_vertices;
    e.config.track.mode = track;
    return e;
}

/* The target turned about an axis through the origin, and shifted. */
static smr_mesh turned(const scene *e, float degrees, float shift)
{
    const float t[3] = {shift, 0.5f * shift, -0.5f * shift};
    float m[9];
    rig_rotation(1, 2, 0.5f, degrees, m);
    return rig_moved(&e->target, m, t);
}

static smr_tick_report until_settled(smr *s, uint32_t most)
{
    smr_tick_report r = {0};
    do
        assert_int_equal(SMR_OK, smr_tick(s, 0, &r));
    while (!r.details.settled && !r.done && --most > 0u);
    return r;
}

static smr *started(const scene *e, const smr_port *port)
{
    smr *s = rig_init(e->model, &e->config, port);
    assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, rig_surface(&e->target)));
    const smr_tick_report r = until_settled(s, 1000);
    assert_int_equal(1, r.details.tracking);
    assert_int_equal(1, r.details.settled);
    assert_int_equal(0, r.done);
    assert_true(r.progress == 1.0f);
    return s;
}

static smr_tick_report set(smr *s, const smr_mesh *target, uint32_t most)
{
    assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, rig_surface(target)));
    return until_settled(s, most);
}

static void test_off_costs_nothing(void **state)
{
    scene e = make(SMR_TRACK_OFF);
    size_t off, on;
    (void)state;
    assert_int_equal(SMR_OK, smr_arena_bytes(e.model, &e.config, &off));
    e.config.track.mode = SMR_TRACK_REPORT;
    assert_int_equal(SMR_OK, smr_arena_bytes(e.model, &e.config, &on));
    assert_true(on > off + 12u * e.source.n_vertices && on <= off + SMR_ARENA_TRACK_BYTES(e.source.n_vertices, 1));
    e.config.track.mode = SMR_TRACK_OFF;
    smr *s = rig_init(e.model, &e.config, NULL);
    assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, rig_surface(&e.target)));
    const smr_tick_report r = until_settled(s, 1000);
    assert_true(r.done && !r.details.tracking && !r.details.settled && !r.details.jumped);
}

/* What is settled costs no iteration and changes nothing, until a target is set. */
static void test_settled(void **state)
{
    const scene e = make(SMR_TRACK_REPORT);
    smr_tick_report r;
    (void)state;
    smr *s = started(&e, NULL);
    const uint64_t hash = smr_state_hash(s);
    assert_int_equal(SMR_OK, smr_tick(s, 0, &r));
    const uint32_t before = r.iteration;
    assert_int_equal(SMR_OK, smr_tick(s, 0, &r));
    assert_true(r.iteration == before && r.details.settled && hash == smr_state_hash(s));
    const smr_mesh next = turned(&e, 1, 0);
    assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, rig_surface(&next)));
    assert_int_equal(SMR_OK, smr_tick(s, 0, &r));
    assert_true(r.iteration == before + 1u && !r.details.settled && r.details.tracking);
}

/* Mean distance from where the motion takes the schedule's result, over the last frames of a steady motion, two ticks
 * each. What is set twice, or once more within an iteration, counts once. */
static double lag_of(const scene *e, int twice)
{
    double sum = 0.0;
    smr *s = started(e, NULL);
    const uint32_t n = e->source.n_vertices;
    const smr_mesh before = {rig_positions(s, e->model), e->source.triangles, n, e->source.n_triangles};
    for (uint32_t i = 1; i <= 12u; i++) {
        const float by = (float)i, t[3] = {by, 0.5f * by, -0.5f * by};
        float m[9];
        const smr_mesh next = turned(e, 1.5f * by, by);
        const smr_surface *surface = rig_surface(&next);
        rig_rotation(1, 2, 0.5f, 1.5f * by, m);
        for (int k = 0; k <= twice; k++)
            assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, surface));
        for (uint32_t k = 0; k < 2u; k++)
            assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
        const smr_mesh want = rig_moved(&before, m, t);
        const float *const xyz = rig_positions(s, e->model);
        for (uint32_t v = 0; v < n && i > 6u; v++)
            sum += (double)rig_far(want.xyz + 3u * (size_t)v, xyz + 3u * (size_t)v, 1) / (6.0 * n);
    }
    return sum;
}

static void test_goes_ahead(void **state)
{
    scene e = make(SMR_TRACK_REPORT);
    (void)state;
    const double behind = lag_of(&e, 0);
    e.config.track.ahead = 1.0f;
    const double ahead = lag_of(&e, 0);
    print_message("lag %.3f mm, going ahead %.3f mm\n", behind, ahead);
    assert_true(ahead < 0.5 * behind);
    assert_true(lag_of(&e, 1) == ahead);
}

/* Most iterations for one target: also with a limit that is never reached. */
static void test_gives_up(void **state)
{
    scene e = make(SMR_TRACK_REPORT);
    (void)state;
    e.config.track.settle_um = 0.0f;
    e.config.track.iterations = 7;
    smr *s = started(&e, NULL);
    const uint32_t before = s->schedule.iteration;
    const smr_mesh next = turned(&e, 2, 1);
    const smr_tick_report r = set(s, &next, 100);
    assert_int_equal(1, r.details.settled);
    assert_int_equal(before + 7u, r.iteration);
}

/* Through 40 degrees in steps: x^r stays the schedule's result but for a rigid motion, and the model follows. */
static void test_follows(void **state)
{
    const scene e = make(SMR_TRACK_REPORT);
    float m[9], far = 0.0f;
    (void)state;
    smr *s = started(&e, NULL);
    const uint32_t n = e.source.n_vertices;
    float *before = rig_positions(s, e.model), *held = rig_alloc(3u * (size_t)n * sizeof(float));
    memcpy(held, s->shape.x, 3u * (size_t)n * sizeof(float));
    for (uint32_t i = 1; i <= 20u; i++) {
        const smr_mesh next = turned(&e, 2.0f * (float)i, 0.25f * (float)i);
        const smr_tick_report r = set(s, &next, 100);
        assert_true(r.details.settled && !r.details.jumped && r.residual_mean_mm < 0.5f);
    }
    for (uint32_t v = 1; v < n; v++) {
        const float a = smr_length(smr_sub(smr_load(smr_at3(held, v)), smr_load(smr_at3(held, v - 1u))));
        const float b =
            smr_length(smr_sub(smr_load(smr_at3(s->shape.x_ref, v)), smr_load(smr_at3(s->shape.x_ref, v - 1u))));
        far = fmaxf(far, fabsf(a - b));
    }
    assert_true(far < 1.0e-3f);
    rig_rotation(1, 2, 0.5f, 40, m);
    const float t[3] = {5.0f, 2.5f, -2.5f};
    const smr_mesh want = {before, e.source.triangles, n, e.source.n_triangles};
    const smr_mesh moved = rig_moved(&want, m, t);
    assert_true(rig_far(moved.xyz, rig_positions(s, e.model), n) < 1.5f);
}

static void test_jumps(void **state)
{
    (void)state;
    for (uint32_t track = SMR_TRACK_REPORT; track <= SMR_TRACK_RECOVER; track++) {
        const scene e = make(track);
        smr *s = started(&e, NULL);
        const uint32_t radius = s->schedule.radius;
        const smr_mesh near = turned(&e, 1, 0.5f), away = turned(&e, 12, 20), lost = turned(&e, 0, 900);
        smr_tick_report r = set(s, &near, 100);
        assert_int_equal(0, r.details.jumped);
        assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, rig_surface(&away)));
        assert_int_equal(SMR_OK, smr_tick(s, 0, &r));
        assert_int_equal(1, r.details.jumped);
        assert_int_equal(track == SMR_TRACK_RECOVER && radius > 0u ? 0u : radius, s->schedule.radius);
        r = until_settled(s, 200);
        assert_true(r.details.settled && r.details.jumped && s->schedule.radius == radius);
        assert_true(track == SMR_TRACK_REPORT || r.residual_mean_mm < 0.5f);
        /* beyond all reach: said, and nothing lost */
        r = set(s, &lost, 200);
        assert_true(r.details.jumped && r.details.settled && r.n_forces == 0u && r.residual_mean_mm == -1.0f);
        r = set(s, &away, 200);
        assert_true(track == SMR_TRACK_REPORT || r.residual_mean_mm < 0.5f);
    }
}

/* A pose, positions or an image start over, from the coarsest radius. */
static void test_starts_over(void **state)
{
    static const smr_pose identity = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    const scene e = make(SMR_TRACK_RECOVER);
    smr_tick_report r;
    (void)state;
    smr *s = started(&e, NULL);
    const uint64_t hash = smr_state_hash(s);
    const smr_mesh away = turned(&e, 5, 9);
    (void)set(s, &away, 5);
    assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, rig_surface(&e.target)));
    assert_int_equal(SMR_OK, smr_set_pose(s, &identity));
    assert_int_equal(SMR_OK, smr_tick(s, 0, &r));
    assert_true(r.details.radius == 0u && !r.details.tracking && !r.details.settled && !r.details.jumped);
    r = until_settled(s, 1000);
    assert_true(r.details.tracking && hash == smr_state_hash(s));
}

/* What is set while ticks are cut by the clock. */
static void sequence(const scene *e, smr *s, uint64_t budget)
{
    smr_status status = SMR_OK;
    for (uint32_t i = 0; i < 12u; i++) {
        const smr_mesh next = turned(e, i == 8u ? 14.0f : 1.5f * (float)i, i >= 8u ? 18.0f : 0.4f * (float)i);
        assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, rig_surface(&next)));
        for (uint32_t k = 0; k < (i == 0u ? 1200u : 23u); k++) {
            status = smr_tick(s, budget, NULL);
            assert_true(status == SMR_OK || status == SMR_PARTIAL);
        }
    }
}

static void test_same_bits(void **state)
{
    scene e = make(SMR_TRACK_RECOVER);
    uint64_t hash = 0;
    (void)state;
    e.config.track.ahead = 0.7f;
    for (uint32_t k = 0; k < RIG_SCHEDULERS; k++) {
        const smr_port port = rig_port(k, 4);
        smr *s = rig_init(e.model, &e.config, &port);
        sequence(&e, s, 0);
        if (k == 0u)
            hash = smr_state_hash(s);
        assert_true(hash == smr_state_hash(s) && s->schedule.tracking);
    }
}

/* Targets by their checksums. */
static const void *by_checksum(void *ctx, const smr_log_record *record)
{
    const scene *e = ctx;
    for (uint32_t i = 0; i < 12u; i++) {
        const smr_mesh next = turned(e, i == 8u ? 14.0f : 1.5f * (float)i, i >= 8u ? 18.0f : 0.4f * (float)i);
        const smr_surface *surface = rig_surface(&next);
        if (smr_surface_checksum(surface) == record->checksum)
            return surface;
    }
    return NULL;
}

static void test_replays(void **state)
{
    static unsigned char memory[LOG];
    scene e = make(SMR_TRACK_RECOVER);
    rig_clock clock = {0};
    uint32_t partial = 0;
    (void)state;
    e.config.track.ahead = 1.0f;
    const smr_port port = rig_clock_port(&clock, RIG_CLOCK_STEADY, 1000);
    smr *s = rig_init(e.model, &e.config, &port);
    assert_int_equal(SMR_OK, smr_set_log(s, memory, sizeof memory));
    sequence(&e, s, 40000);
    assert_int_equal(1, s->schedule.tracking);
    smr *again = rig_init(e.model, &e.config, NULL);
    assert_true(rig_replays(s, memory, by_checksum, &e, again, &partial) > 0u);
    print_message("partial %u, tracking %u radius %u\n", partial, s->schedule.tracking, s->schedule.radius);
    assert_true(partial > 10u);
    assert_true(smr_state_hash(s) == smr_state_hash(again));
}

/* The places of a mesh whose normals lie within 78 degrees of the x axis. */
static void see_front(smr_points *cloud, const smr_mesh *mesh)
{
    const smr_surface *surface = rig_surface(mesh);
    assert_int_equal(SMR_OK, smr_points_clear(cloud));
    for (uint32_t v = 0; v < mesh->n_vertices; v++)
        if (surface->normal[3u * (size_t)v] > 0.2f)
            assert_int_equal(SMR_OK, smr_points_add(cloud, mesh->xyz + 3u * (size_t)v, NULL, NULL, 1));
}

/* A bone that is followed from one side jumps away by more than its thickness: its points are now nearer to the far
 * side of where it was, but it is known which side they show. */
static void test_jumps_with_its_side(void **state)
{
    static const float away[3] = {-40, 3, -2};
    scene e = make(SMR_TRACK_RECOVER);
    const uint32_t n = e.source.n_vertices;
    void *memory = rig_alloc(SMR_POINTS_BYTES(n));
    smr_tick_report report = {0};
    smr_points *cloud = NULL;
    float turn[9];
    (void)state;
    assert_int_equal(SMR_OK, smr_points_open(n, memory, SMR_POINTS_BYTES(n), &cloud));
    e.config.basic.n_target_vertices = n;
    e.model = rig_model(&e.source, 1, NULL);
    rig_rotation(1, 0, 1, -12, turn);
    const smr_mesh there = rig_moved(&e.source, turn, away);
    smr *s = rig_init(e.model, &e.config, NULL);
    see_front(cloud, &e.source);
    assert_int_equal(SMR_OK, smr_set_points(s, 0, cloud));
    assert_int_equal(1, until_settled(s, 1000).details.tracking);
    see_front(cloud, &there);
    assert_int_equal(SMR_OK, smr_set_points(s, 0, cloud));
    for (uint32_t i = 0; i < 30u; i++)
        assert_int_equal(SMR_OK, smr_tick(s, 0, &report));
    assert_true(report.details.jumped && rig_far(rig_positions(s, e.model), there.xyz, n) < 0.6f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_teardown(test_off_costs_nothing, tidy),
        cmocka_unit_test_teardown(test_settled, tidy),
        cmocka_unit_test_teardown(test_goes_ahead, tidy),
        cmocka_unit_test_teardown(test_gives_up, tidy),
        cmocka_unit_test_teardown(test_follows, tidy),
        cmocka_unit_test_teardown(test_jumps, tidy),
        cmocka_unit_test_teardown(test_starts_over, tidy),
        cmocka_unit_test_teardown(test_same_bits, tidy),
        cmocka_unit_test_teardown(test_replays, tidy),
        cmocka_unit_test_teardown(test_jumps_with_its_side, tidy),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
