/* test_schedule.c: from radius to radius: how many iterations run, when x^r follows x, when the schedule settles.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include <string.h>
#include "property/rig_ball_image.h"
#include "property/rig_cloud.h"
#include "registration/schedule_radius.h"

static const float none[3] = {0, 0, 0};

/* Every triangle twice: four at each edge, so that there are no hinges. */
static smr_mesh without_hinges(const smr_mesh *mesh)
{
    const size_t bytes = 3u * (size_t)mesh->n_triangles * sizeof(uint32_t);
    uint32_t *twice = rig_alloc(2u * bytes);
    memcpy(twice, mesh->triangles, bytes);
    memcpy(twice + 3u * (size_t)mesh->n_triangles, mesh->triangles, bytes);
    return (smr_mesh){mesh->xyz, twice, mesh->n_vertices, 2u * mesh->n_triangles};
}

/* No hinges, so nothing is repaired, when faces is 0. */
static smr *start(const smr_config *config, int with_target, int faces)
{
    const float off[3] = {5, -4, 3};
    smr_mesh mesh = rig_ball(30, 6, 9, none);
    const smr_mesh goal = rig_ball(36, 9, 14, off);
    const smr_prepare_config radii = rig_radii(3, 40, 25, 15);
    mesh = faces ? mesh : without_hinges(&mesh);
    smr *s = rig_init(rig_model(&mesh, 1, &radii), config, NULL);
    if (with_target)
        assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, rig_surface(&goal)));
    return s;
}

static smr_config steady(void)
{
    smr_config c = smr_config_default();
    c.motion.settle_um = c.motion.plastic_um = 0.0f;
    c.motion.plastic_every = 0;
    c.forces.curvature = 0.0f;
    return c;
}

TEST(test_iterations_of_each_radius)
{
    for (uint32_t first = 0; first < 3u; first++) {
        for (uint32_t last = first; last < 4u; last++) {
            smr_config c = steady();
            uint32_t at[3] = {0, 0, 0}, total = 0;
            smr_tick_report report = {0};
            c.schedule.radius_first = first;
            c.schedule.radius_last = last == 3u ? SMR_FINEST : last;
            c.basic.iterations = 4;
            c.basic.iterations_last = 7;
            smr *s = start(&c, 1, 0);
            while (!report.done && total < 100u) {
                const uint32_t radius = s->schedule.radius;
                assert_int_equal(SMR_OK, smr_tick(s, 0, &report));
                at[radius]++;
                total++;
                assert_int_equal(total, report.iteration);
            }
            for (uint32_t r = 0; r < 3u; r++) {
                const uint32_t end = last == 3u ? 2u : last;
                assert_int_equal(r < first || r > end ? 0 : r == end ? 7 : 4, at[r]);
            }
        }
    }
}

/* With an image the first of several radii has twice as many iterations, and progress goes on evenly. */
TEST(test_first_radius_with_an_image)
{
    const smr_volume image = rig_ball_image(RIG_BALL_MM, rig_nowhere);
    const smr_model *model = rig_ball_model(&image);
    smr_model_info info;
    assert_int_equal(SMR_OK, smr_model_get_info(model, &info));
    assert_true(info.n_radii > 1u);
    for (uint32_t last = 0; last < info.n_radii; last++) {
        smr_config c = steady();
        c.schedule.radius_last = last;
        c.basic.iterations = 4;
        c.basic.iterations_last = 7;
        smr *s = rig_init(model, &c, NULL);
        assert_int_equal(SMR_OK, smr_set_volume(s, &image));
        const uint32_t want = last == 0u ? 7u : 8u + 4u * (last - 1u) + 7u;
        smr_tick_report report = {0};
        for (uint32_t i = 1; i <= want; i++) {
            assert_int_equal(0, report.done);
            assert_int_equal(SMR_OK, smr_tick(s, 0, &report));
            assert_true(fabsf(report.progress - (float)i / (float)want) < 1.0e-5f);
        }
        assert_int_equal(1, report.done);
    }
}

/* Onto a cloud the first radius has three times as many iterations; it is repeated once where the cloud grows. */
TEST(test_first_radius_onto_a_cloud)
{
    const smr_mesh goal = rig_ball(36, 9, 14, none);
    for (uint32_t grows = 0; grows < 2u; grows++) {
        smr_config c = steady();
        smr_points *cloud = rig_cloud(goal.n_vertices);
        uint32_t at[3] = {0, 0, 0};
        c.basic.iterations = 4;
        c.basic.iterations_last = 7;
        c.basic.n_target_vertices = goal.n_vertices;
        smr *s = start(&c, 0, 0);
        for (uint32_t first = 0; !s->schedule.done && at[2] < 100u; at[s->report.details.radius]++) {
            const uint32_t n = s->schedule.iteration == 0u ? 60u : grows && first == 60u ? 30u : 0u;
            assert_int_equal(SMR_OK, smr_points_add(cloud, goal.xyz + 3u * first, NULL, NULL, n));
            assert_int_equal(SMR_OK, smr_set_points(s, SMR_ALL, cloud));
            assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
            first += n;
        }
        assert_true(at[0] == (grows ? 24u : 12u) && at[1] == 4u && at[2] == 7u);
    }
}

/* At the first radius as few active vertices suffice for a cloud as for a mesh, but not once the cloud grows. */
TEST(test_few_suffice_for_a_cloud)
{
    const smr_mesh mesh = rig_ball(30, 50, 60, none), goal = rig_ball(36, 9, 14, (const float[3]){5, -4, 3});
    const smr_prepare_config radii = rig_radii(2, 60, 15, 0);
    const smr_model *model = rig_model(&mesh, 1, &radii);
    smr_config c = smr_config_default();
    uint32_t few = 0;
    c.basic.n_target_vertices = goal.n_vertices;
    for (uint32_t with_cloud = 0; with_cloud < 2u; with_cloud++) {
        smr *s = rig_init(model, &c, NULL);
        smr_points *cloud = rig_cloud(goal.n_vertices);
        smr_tick_report report;
        for (uint32_t i = 0; i < 4u; i++) {
            assert_int_equal(SMR_OK, smr_points_add(cloud, goal.xyz, NULL, NULL, i == 0u || i == 3u ? 50u : 0u));
            assert_int_equal(SMR_OK,
                             with_cloud ? smr_set_points(s, 0, cloud) : smr_set_surface(s, 0, rig_surface(&goal)));
            assert_int_equal(SMR_OK, smr_tick(s, 0, &report));
            few = few == 0u ? report.details.n_wanted : few;
            assert_int_equal(with_cloud && i == 3u ? mesh.n_vertices : few, report.details.n_wanted);
        }
    }
    assert_true(few < mesh.n_vertices);
}

TEST(test_settles)
{
    smr_config c = steady();
    c.motion.settle_um = 20.0f;
    smr *s = start(&c, 0, 0); /* nothing moves: one iteration for each radius */
    smr_tick_report report = rig_run(s, 100);
    assert_int_equal(3, report.iteration);
    assert_int_equal(1, report.done);
    assert_int_equal(0, report.converged); /* without forces nothing is */
    c.basic.iterations_last = 1000;
    c.basic.even = 0.0f;
    s = start(&c, 1, 0);
    report = rig_run(s, 2000);
    assert_true(report.done && report.converged && report.details.radius_iteration < 1000u);
    assert_true(report.displacement_max_mm < 0.02f);
    c.basic.even = 0.5f; /* evening out takes the whole last radius */
    s = start(&c, 1, 0);
    report = rig_run(s, 2000);
    assert_true(report.done && report.displacement_max_mm < 0.02f);
    assert_int_equal(1000, report.details.radius_iteration);
    c.motion.settle_um = 0.0f;
    c.basic.iterations = c.basic.iterations_last = 1;
    s = start(&c, 1, 0);
    report = rig_run(s, 2000);
    assert_int_equal(1, report.done);
    assert_int_equal(0, report.converged); /* it still moved */
}

/* A radius ends when a step falls below settle_share of the distance to goals; at half of it with other bodies or
 * clouds. */
TEST(test_progress_with_unreached_goals)
{
    smr_config c = smr_config_default();
    smr_tick_report report;
    c.motion.settle_share = 0.1f;
    smr *s = start(&c, 1, 0);
    assert_int_equal(SMR_OK, smr_tick(s, 0, &report));
    const float goals = (float)s->forces.totals.n_forces / (float)s->schedule.n_active;
    for (uint32_t k = 1; k < 12u; k++) {
        if (k == 5u || k == 10u) /* as near as rounding */
            continue;
        s->evolve.mean_mm = 0.01f * (float)k * s->forces.totals.goal_mean * goals;
        s->schedule.others = 0;
        assert_int_equal(k < 10u, smr_ending_of(s, 3).spent);
        s->schedule.others = 1;
        assert_int_equal(k < 5u, smr_ending_of(s, 3).spent);
        s->schedule.others = 0;
        s->forces.surface.n_clouds_at_begin = 1;
        assert_int_equal(k < 5u, smr_ending_of(s, 3).spent);
        s->forces.surface.n_clouds_at_begin = 0;
    }
}

TEST(test_plasticity)
{
    for (uint32_t every = 0; every < 4u; every++) {
        smr_config c = steady();
        smr_tick_report report = {0};
        uint32_t since = 0;
        float before[3000];
        c.motion.plastic_every = every;
        c.basic.iterations_last = 12;
        c.schedule.radius_first = 2;
        c.motion.momentum_last = 0.5f; /* without it the ball comes to rest to the last bit */
        c.basic.slide = 1.0f;
        smr *s = start(&c, 1, 0);
        for (uint32_t i = 0; i < 11u; i++) {
            const uint32_t updates = report.details.plastic_updates;
            const int follows = smr_plastic_follows(s);
            memcpy(before, s->shape.x, 3u * s->shared.n * sizeof(float));
            assert_int_equal(SMR_OK, smr_tick(s, 0, &report));
            assert_true(!follows || memcmp(before, s->shape.x_ref, 3u * s->shared.n * sizeof(float)) == 0);
            since++;
            const int due = every > 0u && since == every;
            assert_int_equal(updates + (due ? 1u : 0u), report.details.plastic_updates);
            assert_int_equal(due, smr_plastic_follows(s));
            assert_int_equal(due, s->reference.stale);
            since = due ? 0u : since;
        }
    }
}

/* The radius of tracking, an index. radius_mm 0: the default. */
static uint32_t tracks_at(uint32_t n_structures, float separate_below_mm, float radius_mm)
{
    const float aside[3] = {50, 0, 0};
    const smr_mesh balls[2] = {rig_ball(20, 14, 20, none), rig_ball(20, 14, 20, aside)}; /* mean edges of 5 mm */
    smr_prepare_config radii = smr_prepare_config_default();
    smr_config c = steady();
    smr_tick_report report = {0};
    radii.separate_below_mm = separate_below_mm;
    radii.n_radii = 4;
    for (uint32_t i = 0; i < 4u; i++)
        radii.radius_mm[i] = (float)(i < 3u ? 32u >> i : 3u);
    c.basic.iterations = c.basic.iterations_last = 1;
    c.track.mode = SMR_TRACK_REPORT;
    c.track.radius_mm = radius_mm;
    smr *s = rig_init(rig_model(balls, n_structures, &radii), &c, NULL);
    assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, rig_surface(&balls[0])));
    for (uint32_t i = 0; i < 100u && !report.details.tracking; i++)
        assert_int_equal(SMR_OK, smr_tick(s, 0, &report));
    return s->schedule.radius;
}

/* Six edges, or the first radius below that keeps structures apart, but none below an edge; or what is asked for. */
TEST(test_radius_of_tracking)
{
    static const struct {
        uint32_t n_structures;
        float separate_below_mm, radius_mm;
        uint32_t radius;
    } all[] = {{1, 20, 0, 0},  {1, 4, 0, 0},   {2, 100, 0, 0}, {2, 20, 0, 1},     {2, 10, 0, 2},
               {2, 4, 0, 0},   {2, 0, 0, 0},   {2, 20, 30, 0}, {2, 10, 23, 0},    {2, 10, 22, 1},
               {1, 10, 12, 1}, {1, 10, 11, 2}, {2, 100, 5, 2}, {2, 100, 4.8f, 3}, {2, 100, 0.1f, 3}};
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++)
        assert_int_equal(all[i].radius, tracks_at(all[i].n_structures, all[i].separate_below_mm, all[i].radius_mm));
}

/* A ball that is drawn out onto a long target. Returns the longest of its edges / length at rest; *v: its verdict. */
static float drawn_out(float strain_most, smr_verdict *v, uint64_t *hash)
{
    smr_config c = smr_config_default();
    smr_tick_report report = {0};
    smr_mesh goal = rig_ball(36, 9, 14, none);
    float *xyz = rig_alloc(3u * (size_t)goal.n_vertices * sizeof *xyz), most = 0.0f;
    for (uint32_t i = 0; i < 3u * goal.n_vertices; i++)
        xyz[i] = goal.xyz[i] * (i % 3u == 2u ? 2.0f : 0.7f);
    goal.xyz = xyz;
    c.motion.strain_most = strain_most;
    smr *s = start(&c, 0, 1);
    assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, rig_surface(&goal)));
    while (!report.done)
        assert_int_equal(SMR_OK, smr_tick(s, 0, &report));
    for (uint32_t k = 0; k < s->shared.n_triangles; k++) {
        const uint32_t *t = smr_model_triangle(&s->shared, k);
        const float now = smr_length(smr_sub(smr_get3(s->shape.x, t[0]), smr_get3(s->shape.x, t[1])));
        const float rest = smr_length(smr_sub(smr_rest(&s->shared, t[0]), smr_rest(&s->shared, t[1])));
        most = smr_max(most, now / smr_max(rest, smr_le_float(s->shared.model->edge_mm)));
    }
    assert_int_equal(SMR_OK, smr_get_verdict(s, SMR_ALL, v));
    *hash = report.state_hash;
    return most;
}

/* Checks the edges with n vertices moved away. Returns 1 when the verdict is to tell of them. */
static uint32_t many_beyond(smr *s, uint32_t n)
{
    memcpy(s->shape.x_next, s->shape.x, 3u * (size_t)s->shared.n * sizeof(float));
    for (uint32_t v = 0; v < n; v++)
        s->shape.x_next[3u * (s->shared.n / 2u + v)] += 100.0f;
    s->reference.n_sweeps = 1;
    for (uint32_t task = 0; task * SMR_TRIANGLE_CHUNK < s->shared.n_triangles; task++)
        smr_strain_limit(s, task, 0);
    assert_true(n == 0u || s->reference.n_over > 0u);
    return s->reference.many_over;
}

/* A few stretched edges of thousands are no reason to doubt the whole; a thousandth of them is. */
TEST(test_few_edges_beyond_the_bound)
{
    const smr_config c = smr_config_default();
    const smr_mesh mesh = rig_ball(30, 80, 120, none);
    const smr_prepare_config radii = rig_radii(3, 40, 25, 15);
    smr *s = rig_init(rig_model(&mesh, 1, &radii), &c, NULL);
    assert_int_equal(1, many_beyond(s, 60));
    assert_int_equal(0, many_beyond(s, 1));
    assert_int_equal(0, many_beyond(s, 0));
}

/* The bound changes no bit that it does not reach, shortens edges where it is reached, and the verdict tells. */
TEST(test_bound_of_strain)
{
    smr_verdict v;
    uint64_t free_hash, hash;
    const float longest = drawn_out(0.0f, &v, &free_hash);
    assert_int_equal(0, v.reasons & SMR_REASON_BOUND);
    (void)drawn_out(100.0f, &v, &hash);
    assert_true(hash == free_hash && (v.reasons & SMR_REASON_BOUND) == 0u);
    const float bounded = drawn_out(0.1f, &v, &hash);
    assert_true((v.reasons & SMR_REASON_BOUND) != 0u && v.level != SMR_VERDICT_GOOD);
    if (!(bounded < 0.8f * longest))
        fail_msg("edges %g times as long, without a bound %g", (double)bounded, (double)longest);
}
