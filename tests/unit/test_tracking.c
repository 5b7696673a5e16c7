/* test_tracking.c: after the schedule a registration follows targets that are replaced: elastic about the schedule's
 * result, saying what jumped.
 * SPDX-License-Identifier: MIT */
#include "suite.h"

#include <math.h>
#include <string.h>

#include "options/track/track.h"
#include "registration/schedule_radius.h"
#include "registration/tick/iteration_steps.h"
#include "unit_moving_bone.h"

static smr *started(const scene *e, const smr_port *port)
{
    smr *s = rig_init(e->model, &e->config, port);
    assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, e->at[0]));
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
        const smr_mesh next = turned(&e->target, 1.5f * by, by);
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

TEST(test_goes_ahead)
{
    scene e = make(SMR_TRACK_REPORT);
    const double behind = lag_of(&e, 0);
    e.config.track.ahead = 1.0f;
    const double ahead = lag_of(&e, 0);
    print_message("lag %.3f mm, going ahead %.3f mm\n", behind, ahead);
    assert_true(ahead < 0.5 * behind);
    assert_true(lag_of(&e, 1) == ahead);
}

/* Most iterations for one target: also with a limit that is never reached. */
/* Searches narrow over half of the iterations, of which one does, and no further; the first has narrowed by 0.3. */
TEST(test_narrows)
{
    static const float progress[][4] = {{0.3f, 1, 1, 1},
                                        {0.3f, 0.65f, 1, 1}}; /* of 1 or 4 iterations, after 0, 1, 2, 9 */
    scene e = make(SMR_TRACK_REPORT);
    for (uint32_t k = 0; k < 2u; k++) {
        e.config.track.iterations = k == 0u ? 1u : 4u;
        smr *s = started(&e, NULL);
        for (uint32_t i = 0; i < 4u; i++) {
            s->schedule.radius_iteration = i < 3u ? i : 9u;
            assert_true(fabsf(smr_tracking_progress(s) - progress[k][i]) < 1.0e-6f);
        }
    }
}

TEST(test_gives_up)
{
    scene e = make(SMR_TRACK_REPORT);
    e.config.track.settle_um = 0.0f;
    e.config.track.iterations = 7;
    smr *s = started(&e, NULL);
    const uint32_t before = s->schedule.iteration;
    const smr_mesh next = turned(&e.target, 2, 1);
    const smr_tick_report r = set(s, &next, 100);
    assert_int_equal(1, r.details.settled);
    assert_int_equal(before + 7u, r.iteration);
}

/* Through 40 degrees in steps: x^r stays the schedule's result but for a rigid motion, and the model follows. */
TEST(test_follows)
{
    const scene e = make(SMR_TRACK_REPORT);
    float m[9], far = 0.0f;
    smr *s = started(&e, NULL);
    const uint32_t n = e.source.n_vertices;
    float *before = rig_positions(s, e.model), *held = rig_alloc(3u * (size_t)n * sizeof(float));
    memcpy(held, s->shape.x, 3u * (size_t)n * sizeof(float));
    for (uint32_t i = 1; i <= 20u; i++) {
        const smr_mesh next = turned(&e.target, 2.0f * (float)i, 0.25f * (float)i);
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

/* Ticks that end within an iteration, from before tracking starts: the state is that of the last complete iteration,
 * and what an abandoned iteration has done to x^r is undone. Counts pauses with a part of x^r exchanged,
 * before and in tracking. `whole` runs ticks without a budget; NULL: iterations are abandoned, three times each. */
static void run_in_pieces(const scene *e, smr *s, smr *whole, uint32_t within[2])
{
    const size_t bytes = 3u * (size_t)e->source.n_vertices * sizeof(float);
    float *const before = rig_alloc(bytes);
    for (uint32_t after = 0; after < 4u; after += s->schedule.tracking) {
        const smr_surface *const at = e->at[after % 2u];
        const int plastic = smr_plastic_follows(s);
        assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, at));
        assert_int_equal(SMR_OK, whole != NULL ? smr_set_surface(whole, SMR_ALL, at) : SMR_OK);
        const uint64_t hash = smr_state_hash(s);
        memcpy(before, s->shape.x_ref, bytes);
        for (smr_status status; (status = smr_tick(s, 1, NULL)) != SMR_OK;) {
            assert_true(status == SMR_PARTIAL && smr_state_hash(s) == hash);
            if (smr_exchanged(s) == 0u || s->evolve.ref_next == SMR_REF_STAYS)
                continue;
            assert_true(plastic || memcmp(before, s->shape.x_ref, bytes) != 0);
            if (++within[s->schedule.tracking] > 3u || whole != NULL)
                continue;
            smr_abandon_iteration(s); /* as a new image or a motion does */
            smr_guard_close(s);
            assert_true(smr_state_hash(s) == hash && (plastic || memcmp(before, s->shape.x_ref, bytes) == 0));
        }
        assert_int_equal(SMR_OK, whole != NULL ? smr_tick(whole, 0, NULL) : SMR_OK);
        assert_true(whole == NULL || smr_state_hash(s) == smr_state_hash(whole));
    }
    assert_true(within[0] > 0u && within[1] > 0u);
}

TEST(test_reference_within_iterations)
{
    scene e = make(SMR_TRACK_REPORT);
    e.config.basic.budget_exact = 1;
    rig_clock clock;
    const smr_port port = rig_clock_port(&clock, RIG_CLOCK_STEADY, 1000);
    smr *s = rig_init(e.model, &e.config, &port), *whole = rig_init(e.model, &e.config, NULL);
    run_in_pieces(&e, s, whole, (uint32_t[2]){0, 0});
    const smr_track_rest *const a = s->shape.track_rest, *const b = whole->shape.track_rest;
    assert_memory_equal(s->shape.track_rest_x, whole->shape.track_rest_x, 12u * e.source.n_vertices);
    assert_memory_equal(&a->box, &b->box, sizeof a->box);
    const smr_box box = smr_box_of(s->shape.track_rest_x, e.source.n_vertices);
    assert_memory_equal(&a->box, &box, sizeof box);
    run_in_pieces(&e, rig_init(e.model, &e.config, &port), NULL, (uint32_t[2]){0, 0});
}

TEST(test_jumps)
{
    for (uint32_t track = SMR_TRACK_REPORT; track <= SMR_TRACK_RECOVER; track++) {
        const scene e = make(track);
        smr *s = started(&e, NULL);
        const uint32_t radius = s->schedule.radius;
        const smr_mesh near = turned(&e.target, 1, 0.5f), away = turned(&e.target, 12, 20),
                       lost = turned(&e.target, 0, 900);
        smr_tick_report r = set(s, &near, 100);
        const float most = 1.05f * r.residual_mean_mm; /* as near as without a jump */
        assert_int_equal(0, r.details.jumped);
        assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, rig_surface(&away)));
        assert_int_equal(SMR_OK, smr_tick(s, 0, &r));
        assert_int_equal(1, r.details.jumped);
        assert_int_equal(track == SMR_TRACK_RECOVER && radius > 0u ? 0u : radius, s->schedule.radius);
        r = until_settled(s, 200);
        assert_true(r.details.settled && r.details.jumped && s->schedule.radius == radius);
        assert_true(track == SMR_TRACK_REPORT || r.residual_mean_mm < most);
        /* beyond all reach: said, and nothing lost */
        r = set(s, &lost, 200);
        assert_true(r.details.jumped && r.details.settled && r.n_forces == 0u && r.residual_mean_mm == -1.0f);
        r = set(s, &away, 200);
        assert_true(track == SMR_TRACK_REPORT || r.residual_mean_mm < most);
    }
}

/* A near target that comes while the model recovers from a jump is followed at the radius of tracking from then on. */
TEST(test_recovery_ends_with_a_target)
{
    scene e = make(SMR_TRACK_RECOVER);
    e.config.track.jump_mm = 8.0f;
    smr *s = started(&e, NULL);
    const uint32_t radius = s->schedule.radius;
    smr_tick_report r;
    assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, e.at[2]));
    assert_int_equal(SMR_OK, smr_tick(s, 0, &r));
    assert_true(r.details.recovering && radius > 0u);
    for (uint32_t i = 0; i < 2u; i++) {
        assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, e.at[i]));
        assert_int_equal(SMR_OK, smr_tick(s, 0, &r));
        assert_true(!r.details.recovering && r.details.radius == radius && s->schedule.radius == radius);
    }
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
TEST(test_jumps_with_its_side)
{
    static const float away[3] = {-40, 3, -2};
    scene e = make(SMR_TRACK_RECOVER);
    const uint32_t n = e.source.n_vertices;
    smr_tick_report report = {0};
    smr_points *const cloud = rig_cloud(n);
    float turn[9];
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

/* A ball that goes ahead with each tick is held back by a fixed one in its way: what was known of the distance between
 * them no longer holds. */
TEST(test_goes_ahead_into_contact)
{
    static const float from[3] = {0, 0, 0}, way[3] = {60.5f, 0, 0};
    const smr_mesh ball = rig_ball(20, 12, 20, from), fixed = rig_ball(20, 12, 20, way);
    const smr_prepare_config radii = rig_radii(2, 25, 12, 0);
    scene e = make(SMR_TRACK_REPORT);
    const float *x[2];
    e.model = rig_model(&ball, 1, &radii);
    e.at[0] = rig_surface(&ball);
    e.config.track.ahead = 1.0f;
    e.config.contact.n_fixed = 1;
    for (uint32_t k = 0; k < 2u; k++) {
        e.config.contact.share = (float)k;
        smr *s = started(&e, NULL);
        assert_int_equal(SMR_OK, smr_set_fixed(s, 0, rig_surface(&fixed)));
        for (uint32_t i = 1; i <= 10u; i++) {
            const smr_mesh next = rig_ball(20, 12, 20, (const float[3]){3.0f * (float)i, 0, 0});
            assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, rig_surface(&next)));
            assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
        }
        x[k] = rig_positions(s, e.model);
    }
    assert_true(rig_far(x[0], x[1], ball.n_vertices) > 0.7f);
}

/* Points that scatter by more than what counts as a jump, and by no more than those before, have not jumped. */
TEST(test_noise_is_no_jump)
{
    scene e = make(SMR_TRACK_REPORT);
    const uint32_t n = e.source.n_vertices;
    smr_points *const cloud = rig_cloud(n);
    e.config.basic.n_target_vertices = n;
    e.config.track.jump_mm = 0.5f;
    smr *s = rig_init(e.model, &e.config, NULL);
    smr_tick_report r = {0};
    for (uint32_t k = 0, seed = 7; k < 2u; k++) {
        assert_int_equal(SMR_OK, smr_points_clear(cloud));
        for (uint32_t v = 0; v < n; v++) {
            float p[3];
            rig_within(&seed, -2, 2, p);
            smr_store(p, smr_add(smr_load(p), smr_load(e.target.xyz + 3u * (size_t)v)));
            assert_int_equal(SMR_OK, smr_points_add(cloud, p, NULL, NULL, 1));
        }
        assert_int_equal(SMR_OK, smr_set_points(s, 0, cloud));
        if (k == 0u)
            assert_int_equal(1, until_settled(s, 1000).details.tracking);
    }
    assert_int_equal(SMR_OK, smr_tick(s, 0, &r));
    assert_int_equal(0, r.details.jumped);
}
