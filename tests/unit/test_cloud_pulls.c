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
    const float all = run_onto(1, 3, 0.0f, 0.0f)->forces.points.compared;
    const float near = run_onto(1, 3, 0.0f, 1.0e-3f)->forces.points.compared;
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
    assert_true(noise[1].agreed < 0.3f && motion[1].agreed > 0.8f && motion[1].agreed <= 1.0f);
    assert_true(noise[0].agreed == 0.0f); /* no target was set */
}

/* Pulls are smoothed over a share of the smallest structure with a cloud, however dense points are. */
TEST(test_reach_of_dense_points)
{
    enum { DENSE = 3000 };
    static const float centre[2][3] = {{0, 0, 0}, {50, 0, 0}};
    const smr_mesh part[2] = {rig_ball(22.0f, 32, 60, centre[0]), pair.part[1]};
    smr_points *cloud = rig_cloud(DENSE);
    smr_config c = smr_config_default();
    uint32_t seed = 4;
    c.basic.n_target_vertices = DENSE;
    for (uint32_t i = 0; i < DENSE; i++) {
        const rig_point p = rig_cloud_point(&seed, 0, 22.0f, 0.1f);
        assert_int_equal(SMR_OK, rig_cloud_add(cloud, &p));
    }
    for (uint32_t all = 0; all < 2u; all++) {
        smr *s = rig_init(rig_model(part, 2, NULL), &c, NULL);
        assert_int_equal(SMR_OK, smr_set_points(s, all ? SMR_ALL : 0u, cloud));
        assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
        assert_int_equal(all ? 2 : 4, s->forces.points.rounds); /* 61 of 1862 vertices, 19 of 100 */
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
