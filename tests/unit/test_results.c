/* test_results.c: readable results: the caller's order, unit normals, figures per structure.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include "registration/registration.h"

static const float none[3] = {0, 0, 0};

/* Two balls apart from each other; the first has a target 3 mm off, the second none. */
static smr *start(float momentum, smr_mesh mesh[2], const smr_model **model)
{
    const float off[3] = {60, 0, 0};
    const smr_prepare_config radii = rig_radii(1, 15, 0, 0);
    smr_config config = smr_config_default();
    mesh[0] = rig_ball(20, 6, 9, none);
    mesh[1] = rig_ball(15, 5, 8, off);
    const smr_mesh goal = rig_ball(23, 12, 18, none);
    config.motion.momentum = momentum;
    *model = rig_model(mesh, 2, &radii);
    smr *s = rig_init(*model, &config, NULL);
    assert_int_equal(SMR_OK, smr_set_surface(s, 0, rig_surface(&goal)));
    return s;
}

TEST(test_order_and_shift)
{
    smr_mesh mesh[2];
    const smr_model *model;
    smr *s = start(0, mesh, &model);
    float xyz[3 * 64];
    for (uint32_t i = 0; i < 2u; i++) {
        assert_int_equal(SMR_OK, smr_get_positions(s, i, xyz));
        assert_true(rig_far(xyz, mesh[i].xyz, mesh[i].n_vertices) < 1.0e-5f);
    }
    (void)rig_run(s, 4);
    assert_int_equal(SMR_OK, smr_get_positions(s, 0, xyz));
    for (uint32_t i = 0; i < mesh[0].n_vertices; i++) /* each vertex went outwards, so it is still the same one */
        assert_true(smr_dot(smr_unit(smr_load(xyz + 3u * i)), smr_unit(smr_load(mesh[0].xyz + 3u * i))) > 0.9f);
}

TEST(test_normals_are_unit)
{
    smr_mesh mesh[2];
    const smr_model *model;
    smr *s = start(0.5f, mesh, &model);
    float n[3 * 64], x[3 * 64];
    for (uint32_t tick = 0; tick < 10u; tick++) {
        assert_int_equal(SMR_OK, smr_get_normals(s, 0, n));
        assert_int_equal(SMR_OK, smr_get_positions(s, 0, x));
        for (uint32_t i = 0; i < mesh[0].n_vertices; i++) {
            assert_true(fabsf(smr_length(smr_load(n + 3u * i)) - 1.0f) < 1.0e-5f);
            assert_true(smr_dot(smr_load(n + 3u * i), smr_unit(smr_load(x + 3u * i))) > 0.8f);
        }
        (void)rig_run(s, 1);
    }
}

static void check_report(float momentum)
{
    smr_mesh mesh[2];
    const smr_model *model;
    smr *s = start(momentum, mesh, &model);
    smr_structure_report part[2];
    float before[3 * 64], after[3 * 64];
    assert_int_equal(SMR_OK, smr_get_positions(s, 0, before));
    for (uint32_t tick = 0; tick < 6u; tick++) {
        smr_tick_report report;
        assert_int_equal(SMR_OK, smr_tick(s, 0, &report));
        if (report.details.plastic_updates == 1u && tick == 0u)
            continue; /* an iteration that only repairs has no forces */
        assert_int_equal(SMR_OK, smr_get_structure_report(s, 0, &part[0]));
        assert_int_equal(SMR_OK, smr_get_structure_report(s, 1, &part[1]));
        assert_int_equal(1, part[0].has_target);
        assert_int_equal(0, part[1].has_target);
        assert_int_equal(report.n_forces, part[0].n_forces + part[1].n_forces);
        assert_int_equal(report.details.n_rejected, part[0].n_rejected + part[1].n_rejected);
        assert_int_equal(0, part[1].n_forces);
        assert_int_equal(0, part[1].n_rejected);
        assert_true(part[1].residual_max_mm == -1.0f); /* not measured */
        assert_true(fabsf(part[0].residual_max_mm - report.details.residual_max_mm) < 1.0e-3f);
        assert_true(fabsf(part[0].residual_mean_mm - report.residual_mean_mm) < 1.0e-3f);
    }
    assert_int_equal(SMR_OK, smr_get_positions(s, 0, after));
    assert_true(fabsf(rig_far(before, after, mesh[0].n_vertices) - part[0].moved_max_mm) < 1.0e-4f);
    assert_true(part[0].moved_mean_mm > 0.5f && part[0].moved_mean_mm <= part[0].moved_max_mm);
    assert_true(part[1].moved_max_mm < 1.0e-3f);
}

TEST(test_structure_report) { check_report(0.0f); }

/* What momentum adds to the forces is no residual. */
TEST(test_structure_report_with_momentum) { check_report(0.8f); }

/* The residual is the distance of visible vertices to the target, not that to goals, which plasticity takes away. The
 * goal is a ball of another mesh, as a whole or open at a third. */
TEST(test_residual_is_the_distance_to_the_target)
{
    const smr_mesh ball = rig_ball(20, 15, 20, none);
    const smr_prepare_config radii = rig_radii(3, 25, 12, 4);
    for (uint32_t open = 0; open < 2u; open++) {
        smr_mesh goal = rig_ball(22, 12, 18, none);
        smr_config config = smr_config_default();
        smr_structure_report part;
        smr_verdict verdict;
        unsigned char visible[1024];
        double sum = 0.0, n = 0.0;
        goal.n_triangles -= open * (goal.n_triangles / 3u);
        config.basic.n_target_vertices = goal.n_vertices;
        smr *s = rig_init(rig_model(&ball, 1, &radii), &config, NULL);
        const smr_surface *target = rig_surface(&goal);
        assert_int_equal(SMR_OK, smr_set_surface(s, 0, target));
        const smr_tick_report r = rig_run(s, 1000);
        const float *x = rig_positions(s, s->shared.model);
        assert_int_equal(SMR_OK, smr_get_visible(s, 0, visible));
        assert_int_equal(SMR_OK, smr_get_verdict(s, 0, &verdict));
        assert_int_equal(SMR_OK, smr_get_structure_report(s, 0, &part));
        for (uint32_t v = 0; v < ball.n_vertices; v++) {
            smr_closest hit;
            assert_int_equal(SMR_OK, smr_surface_closest(target, x + 3u * (size_t)v, NULL, -1.0f, 100.0f, &hit));
            sum += visible[v] ? (double)hit.distance : 0.0;
            n += visible[v] ? 1.0 : 0.0;
        }
        assert_true(r.done && sum / n > 0.01 && n > 150.0 && (open ? n < 250.0 : n > 280.0));
        assert_true(fabs((double)r.residual_mean_mm - sum / n) < 0.02 * sum / n);
        assert_true(fabsf(r.residual_mean_mm - verdict.residual_mm) < 0.02f * verdict.residual_mm);
        assert_true(fabsf(r.residual_mean_mm - part.residual_mean_mm) < 1.0e-4f);
    }
}

/* Within the noise a target surface attracts nothing; beyond, by the excess, and momentum goes on a little. */
TEST(test_noise_of_a_surface)
{
    const smr_mesh ball = rig_ball(20, 15, 20, none), goal = rig_ball(22, 15, 20, none);
    const smr_prepare_config radii = rig_radii(3, 25, 12, 4);
    for (uint32_t i = 0; i < 3u; i++) {
        static const float noise[] = {0.0f, 1.0f, 3.0f}, least[] = {21.95f, 20.95f, 19.99f},
                           most[] = {22.05f, 21.6f, 20.01f};
        smr_config config = smr_config_default();
        double sum = 0.0;
        config.basic.n_target_vertices = goal.n_vertices;
        config.partial.noise_mm = noise[i];
        smr *s = rig_init(rig_model(&ball, 1, &radii), &config, NULL);
        assert_int_equal(SMR_OK, smr_set_surface(s, 0, rig_surface(&goal)));
        assert_true(rig_run(s, 1000).done);
        const float *x = rig_positions(s, s->shared.model);
        for (uint32_t v = 0; v < ball.n_vertices; v++)
            sum += (double)smr_length(smr_load(x + 3u * (size_t)v)) / ball.n_vertices;
        if (!(sum > (double)least[i] && sum < (double)most[i]))
            fail_msg("with noise of %g mm a radius of %g mm", (double)noise[i], sum);
    }
}
