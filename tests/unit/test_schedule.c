/* test_schedule.c: from radius to radius: how many iterations run, when x^r follows x, when the schedule ends.
 * SPDX-License-Identifier: MIT */
#include "cmocka_first.h"

#include <math.h>
#include <string.h>

#include "property/rig.h"
#include "registration/registration.h"

static int tidy(void **state)
{
    (void)state;
    rig_free_all();
    return 0;
}

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
    return c;
}

static void test_iterations_of_each_radius(void **state)
{
    (void)state;
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
static void test_first_radius_with_an_image(void **state)
{
    (void)state;
    for (uint32_t last = 0; last < 3u; last++) {
        smr_config c = steady();
        c.schedule.radius_last = last;
        c.basic.iterations = 4;
        c.basic.iterations_last = 7;
        smr *s = start(&c, 1, 0);
        s->forces.image.has_image = 1;
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

static void test_progress(void **state)
{
    smr_config c = steady();
    float before = 0.0f;
    smr_tick_report report = {0};
    (void)state;
    c.basic.iterations = 5;
    c.basic.iterations_last = 10;
    smr *s = start(&c, 1, 0);
    for (uint32_t i = 1; i <= 20u; i++) {
        assert_int_equal(SMR_OK, smr_tick(s, 0, &report));
        assert_true(report.progress > before && fabsf(report.progress - (float)i / 20.0f) < 1.0e-5f);
        before = report.progress;
    }
    assert_int_equal(1, report.done);
    assert_true(report.progress == 1.0f);
}

static void test_done_is_done(void **state)
{
    smr_config c = steady();
    smr_tick_report report, later;
    (void)state;
    c.basic.iterations = c.basic.iterations_last = 2;
    smr *s = start(&c, 1, 1);
    report = rig_run(s, 500);
    assert_int_equal(1, report.done);
    const uint64_t hash = smr_state_hash(s);
    for (uint32_t i = 0; i < 5u; i++) {
        assert_int_equal(SMR_OK, smr_tick(s, 0, &later));
        assert_int_equal(report.iteration, later.iteration);
        assert_int_equal(1, later.done);
        assert_true(later.state_hash == report.state_hash);
    }
    assert_true(hash == smr_state_hash(s));
}

static void test_settles(void **state)
{
    smr_config c = steady();
    smr_tick_report report;
    (void)state;
    c.motion.settle_um = 20.0f;
    smr *s = start(&c, 0, 0); /* nothing moves: one iteration for each radius */
    report = rig_run(s, 100);
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

static void test_plasticity(void **state)
{
    (void)state;
    for (uint32_t every = 0; every < 4u; every++) {
        smr_config c = steady();
        smr_tick_report report = {0};
        uint32_t since = 0;
        c.motion.plastic_every = every;
        c.basic.iterations_last = 12;
        c.schedule.radius_first = 2;
        c.motion.momentum_last = 0.5f; /* without it the ball comes to rest to the last bit */
        c.basic.slide = 1.0f;
        smr *s = start(&c, 1, 0);
        for (uint32_t i = 0; i < 11u; i++) {
            const uint32_t updates = report.details.plastic_updates;
            assert_int_equal(SMR_OK, smr_tick(s, 0, &report));
            since++;
            const int due = every > 0u && since == every;
            assert_int_equal(updates + (due ? 1u : 0u), report.details.plastic_updates);
            assert_int_equal(due, memcmp(s->shape.x, s->shape.x_ref, 3u * s->shared.n * sizeof(float)) == 0);
            assert_int_equal(due, s->reference.stale);
            since = due ? 0u : since;
        }
    }
}

static void test_plastic_when_small(void **state)
{
    smr_config c = steady();
    smr_tick_report report;
    (void)state;
    c.motion.plastic_um = 1.0e8f; /* always small */
    c.basic.iterations_last = 50;
    c.schedule.radius_first = 2;
    smr *s = start(&c, 1, 0);
    report = rig_run(s, 20);
    assert_int_equal(20, report.details.plastic_updates);
}

static void test_search_follows_the_radius(void **state)
{
    smr_config c = steady();
    (void)state;
    c.basic.search_mm = 50.0f;
    c.forces.search_radii = 1.5f;
    c.basic.iterations = 1;
    smr *s = start(&c, 1, 0);
    assert_true(fabsf(s->schedule.search_mm - 50.0f) < 1.0e-4f); /* 60 is more than search_mm */
    (void)rig_run(s, 1);
    assert_true(fabsf(s->schedule.search_mm - 37.5f) < 1.0e-4f);
    (void)rig_run(s, 1);
    assert_true(fabsf(s->schedule.search_mm - 22.5f) < 1.0e-4f);
}

/* Repairing iterations come before a radius and do not count, and there is an end to them. */
static void test_repair_ends(void **state)
{
    smr_config c = steady();
    smr_tick_report report = {0};
    uint32_t extra = 0;
    (void)state;
    c.basic.iterations = c.basic.iterations_last = 3;
    smr *s = start(&c, 1, 1);
    for (uint32_t i = 0; i < 500u && !report.done; i++) {
        extra += s->schedule.repairing > 0u;
        assert_int_equal(SMR_OK, smr_tick(s, 0, &report));
    }
    assert_int_equal(1, report.done);
    assert_int_equal(9u + extra, report.iteration);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_teardown(test_iterations_of_each_radius, tidy),
        cmocka_unit_test_teardown(test_progress, tidy),
        cmocka_unit_test_teardown(test_first_radius_with_an_image, tidy),
        cmocka_unit_test_teardown(test_done_is_done, tidy),
        cmocka_unit_test_teardown(test_settles, tidy),
        cmocka_unit_test_teardown(test_plasticity, tidy),
        cmocka_unit_test_teardown(test_plastic_when_small, tidy),
        cmocka_unit_test_teardown(test_search_follows_the_radius, tidy),
        cmocka_unit_test_teardown(test_repair_ends, tidy),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
