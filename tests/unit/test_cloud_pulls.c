/* test_cloud_pulls.c: sums over the pulls of a cloud's points: which points count, for whom, and in how large pieces.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include "options/partial/partial.h"
#include "property/rig_cloud.h"
#include "registration/registration.h"
#include "registration/tick/iteration_steps.h"

enum { POINTS = 400 };

static rig_pair pair;

BEFORE_EACH_TEST() { pair = rig_pair_make(); }

/* A registration after n iterations onto points about the second ball's far side, `outside` mm outside it. stray:
 * weight of a point on the near side; deviations: config.forces.reject_deviations. */
static smr *run_outside(float outside, uint32_t structure, uint32_t n, float stray, float deviations)
{
    smr_points *cloud = rig_cloud(POINTS);
    smr_config c = smr_config_default();
    rig_point p = {{14, 0, 0}, {0, 0, 0}, stray};
    uint32_t seed = 3;
    c.basic.n_target_vertices = POINTS;
    c.forces.reject_deviations = deviations;
    if (stray > 0.0f)
        assert_int_equal(SMR_OK, rig_cloud_add(cloud, &p));
    for (uint32_t i = 1; i < POINTS; i++) {
        p = rig_cloud_point(&seed, 1, 22.0f + outside, 2.0f);
        if (p.xyz[0] > 42.0f && p.xyz[0] < 58.0f)
            assert_int_equal(SMR_OK, rig_cloud_add(cloud, &p));
    }
    smr *s = rig_init(pair.model, &c, NULL);
    assert_int_equal(SMR_OK, smr_set_points(s, structure, cloud));
    for (uint32_t i = 0; i < n; i++)
        assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
    return s;
}

static smr *run_onto(uint32_t structure, uint32_t n, float stray, float deviations)
{
    return run_outside(0.0f, structure, n, stray, deviations);
}

/* Large clusters average by themselves over noise, also where another structure shares the cloud without its points. */
TEST(test_share_of_a_shared_cloud)
{
    const float alone = run_onto(1, 14, 0.0f, 0.0f)->forces.surface.target[1].share;
    const float shared = run_onto(SMR_ALL, 14, 0.0f, 0.0f)->forces.surface.target[1].share;
    assert_true(alone > 0.9f && alone < 1.0f && smr_abs(alone - shared) < 0.02f);
}

/* A point whose weight rounds to 0 does not hide that the model swings. */
TEST(test_weight_that_rounds_to_0)
{
    const smr *bare = run_onto(1, 1, 0.0f, 0.0f), *stray = run_onto(1, 1, 9.0e-7f, 0.0f);
    assert_true(bare->forces.points.pulls > 0.0f && stray->forces.points.pulls < 1.01f * bare->forces.points.pulls);
}

TEST(test_rejected_points_are_not_compared)
{
    const float all = run_onto(1, 3, 0.0f, 0.0f)->forces.surface.target[1].compared;
    const float near = run_onto(1, 3, 0.0f, 1.0e-3f)->forces.surface.target[1].compared;
    assert_true(near > 0.0f && near < 0.25f * all);
}

/* The mean weight of reached vertices is summed in as many tasks as all vertices are. */
TEST(test_mean_weight_in_pieces)
{
    smr *s = run_onto(1, 1, 0.0f, 0.0f);
    smr_point_spread *p = &s->forces.points;
    uint32_t n = 0;
    s->forces.surface.target[0].spread = s->forces.surface.target[1].spread = -1.0f;
    for (uint32_t task = 0; task < smr_point_spread_tasks(p); task++) {
        smr_point_spread_run(p, task, 0);
        n += s->forces.surface.target[0].spread >= 0.0f;
    }
    assert_true(s->shared.n_tasks > 1u && n == s->shared.n_tasks);
    assert_true(s->forces.surface.target[0].spread == 0.0f && s->forces.surface.target[1].spread == 0.0f);
}

/* Other points show motion, too, and no noise. */
TEST(test_what_points_agree_on)
{
    const smr_target *noise = run_onto(1, 14, 0.0f, 0.0f)->forces.surface.target;
    const smr_target *motion = run_outside(8.0f, 1, 1, 0.0f, 0.0f)->forces.surface.target;
    assert_true(smr_points_agree(&noise[1]) < 0.3f && smr_points_agree(&motion[1]) > 0.8f);
    assert_true(smr_points_in_reach(&noise[1]) > 1.0f && smr_points_in_reach(&noise[1]) < (float)POINTS);
    assert_true(smr_points_agree(&noise[0]) == 1.0f && smr_points_in_reach(&noise[0]) == 0.0f); /* no points */
}

/* A residual that is noise gives no doubt, and does not excuse that of another structure. */
TEST(test_noise_beside_misfit)
{
    smr_verdict part, all;
    static const float centre[RIG_PAIR][3] = {{0, 0, 0}, {40, 0, 0}};
    const smr_mesh fine[RIG_PAIR] = {rig_ball(22.0f, 32, 60, centre[0]), rig_ball(22.0f, 32, 60, centre[1])};
    pair.model = rig_model(fine, RIG_PAIR, NULL);
    smr *s = run_onto(SMR_ALL, 14, 0.0f, 0.0f);
    smr_target *target = s->forces.surface.target;
    for (uint32_t k = 0; k < 4u; k++) { /* whose points agree */
        for (uint32_t i = 0; i < RIG_PAIR; i++) {
            target[i].pulled = 1.0f;
            target[i].product = k >> i & 1u ? 1.0f : 0.0f;
        }
        smr_guard_close(s);
        assert_int_equal(SMR_OK, smr_get_verdict(s, SMR_ALL, &all));
        assert_int_equal(SMR_OK, smr_get_verdict(s, 1, &part));
        assert_int_equal(k > 1u ? SMR_REASON_RESIDUAL : 0u, part.reasons & SMR_REASON_RESIDUAL);
        assert_int_equal(k > 0u ? SMR_REASON_RESIDUAL : 0u, all.reasons & SMR_REASON_RESIDUAL);
    }
}

/* Pulls are smoothed over a share of the smallest structure with a cloud, however dense points are: not where clusters
 * are as large, nor where points show a part. */
TEST(test_reach_of_dense_points)
{
    enum { DENSE = 3000, WHOLE = 0, SMALL, COARSE, HALF, CASES };
    static const float centre[2][3] = {{0, 0, 0}, {50, 0, 0}};
    const smr_mesh part[2] = {rig_ball(22.0f, 32, 60, centre[0]), pair.part[1]};
    const smr_prepare_config fine = rig_radii(1, 4, 4, 4);
    smr_config c = smr_config_default();
    c.basic.n_target_vertices = DENSE;
    for (uint32_t k = 0; k < CASES; k++) {
        smr_points *cloud = rig_cloud(DENSE);
        uint32_t seed = 4;
        for (uint32_t i = 0; i < DENSE; i++) {
            const rig_point p = rig_cloud_point(&seed, 0, 22.0f, 0.1f);
            if (k != HALF || p.xyz[2] > 0.0f)
                assert_int_equal(SMR_OK, rig_cloud_add(cloud, &p));
        }
        smr *s = rig_init(rig_model(part, k == SMALL ? 2u : 1u, k == COARSE ? NULL : &fine), &c, NULL);
        assert_int_equal(SMR_OK, smr_set_points(s, SMR_ALL, cloud));
        assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
        assert_int_equal(k == WHOLE ? 4 : 2, s->forces.points.rounds); /* 61 of 1862 vertices; 19, the least */
    }
}

/* Contact and the bound of the sums use momentum, so it ends before them. */
TEST(test_momentum_ends_before_its_use)
{
    uint32_t spread = 0, contact = 0;
    for (uint32_t k = 0; k < smr_n_steps; k++) {
        spread = smr_steps[k].run == smr_point_spread_run ? k : spread;
        contact = smr_steps[k].run == smr_contact_search ? k : contact;
    }
    assert_true(spread < contact && smr_steps[spread].end != NULL);
    smr *s = run_onto(1, 2, 0.0f, 0.0f);
    s->schedule.momentum = 0.5f;
    s->forces.points.along = -1.0f;
    s->forces.points.pulls = s->forces.points.steps = 1.0f;
    smr_steps[spread].end(s);
    assert_true(s->schedule.momentum == 0.0f);
}

/* Pulls that oppose the last displacements say nothing once the last cloud is taken away. */
TEST(test_swings_need_a_cloud)
{
    smr *s = run_onto(1, 2, 0.0f, 0.0f);
    s->forces.points.along = -1.0e30f;
    assert_true(s->forces.surface.clouds->swings(&s->forces.points));
    s->forces.surface.n_clouds = 0;
    assert_false(s->forces.surface.clouds->swings(&s->forces.points));
}

/* A structure without triangles beside one with them: points attract it, and nothing spreads over it. */
TEST(test_structure_without_triangles)
{
    smr_mesh part[2] = {pair.part[0], pair.part[1]};
    part[0].n_triangles = 0;
    part[0].triangles = NULL;
    const smr_prepare_config radii = rig_radii(3, 60, 30, 12);
    pair.model = rig_model(part, 2, &radii);
    smr *s = run_onto(SMR_ALL, 3, 0.0f, 0.0f);
    assert_int_equal(part[1].n_vertices, s->forces.points.n);
    assert_int_equal(part[1].n_vertices, s->forces.points.n_smallest);
}
