/* test_target_attraction.c: target vertices pull the model's triangles: weights, sums over workers, and what is
 * cleared.
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

static smr *start(uint32_t workers, const smr_mesh *goal, float attraction)
{
    const smr_mesh mesh = rig_ball(30, 9, 12, none);
    const smr_prepare_config radii = rig_radii(1, 18, 0, 0);
    smr_config c = smr_config_default();
    c.basic.n_workers = workers;
    c.basic.n_target_vertices = goal->n_vertices;
    c.basic.attraction = attraction;
    c.forces.normal_deg = 180.0f;
    c.forces.node_budget = 1000000;
    smr *s = rig_init(rig_model(&mesh, 1, &radii), &c, NULL);
    assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, rig_surface(goal)));
    return s;
}

static void test_on_and_off(void **state)
{
    const smr_mesh goal = rig_ball(33, 9, 12, none);
    (void)state;
    smr *s = start(1, &goal, 0.5f);
    assert_true(smr_attraction_on(&s->forces.surface) &&
                smr_attract_tasks(&s->forces.surface) == smr_ceil_div(goal.n_vertices, SMR_FORCE_CHUNK));
    assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, NULL));
    assert_true(!smr_attraction_on(&s->forces.surface) && smr_attract_tasks(&s->forces.surface) == 0u);
    s = start(1, &goal, 0.0f);
    assert_true(!smr_attraction_on(&s->forces.surface) && smr_attract_tasks(&s->forces.surface) == 0u);
}

/* The report says what was used, not what was asked for: 0.5 does nothing while n_target_vertices is 0. */
static void test_report_says_what_was_used(void **state)
{
    const smr_mesh goal = rig_ball(33, 9, 12, none), mesh = rig_ball(30, 9, 12, none);
    const smr_prepare_config radii = rig_radii(1, 18, 0, 0);
    smr_config c = smr_config_default();
    smr_tick_report report;
    (void)state;
    smr *s = start(1, &goal, 0.25f);
    assert_true(s->schedule.repairing > 0u);
    assert_int_equal(SMR_OK, smr_tick(s, 0, &report));
    assert_true(report.details.attraction_used == 0.0f); /* forces do not act while folds are repaired */
    while (s->schedule.repairing > 0u)
        assert_int_equal(SMR_OK, smr_tick(s, 0, &report));
    assert_int_equal(SMR_OK, smr_tick(s, 0, &report));
    assert_true(report.details.attraction_used == 0.25f);
    assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, NULL));
    assert_int_equal(SMR_OK, smr_tick(s, 0, &report));
    assert_true(report.details.attraction_used == 0.0f);
    s = start(1, &goal, 0.0f);
    assert_int_equal(SMR_OK, smr_tick(s, 0, &report));
    assert_true(report.details.attraction_used == 0.0f);
    assert_true(c.basic.attraction == 0.5f && c.basic.n_target_vertices == 0u);
    s = rig_init(rig_model(&mesh, 1, &radii), &c, NULL);
    assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, rig_surface(&goal)));
    assert_int_equal(SMR_OK, smr_tick(s, 0, &report));
    assert_true(report.n_forces > 0u && report.details.attraction_used == 0.0f);
}

/* Without `attract` room counts for nothing: bytes, what is accepted and results are those of no room. */
static void test_switched_off(void **state)
{
    const smr_mesh goal = rig_ball(33, 9, 12, none), mesh = rig_ball(30, 9, 12, none);
    const smr_prepare_config radii = rig_radii(1, 18, 0, 0);
    const smr_model *model = rig_model(&mesh, 1, &radii);
    smr_config c = smr_config_default();
    smr_tick_report report[2];
    size_t bytes[2];
    (void)state;
    for (uint32_t off = 0; off < 2u; off++) {
        c.basic.attract = !off;
        c.basic.n_target_vertices = off ? goal.n_vertices - 1u : 0u;
        assert_int_equal(SMR_OK, smr_arena_bytes(model, &c, &bytes[off]));
        smr *s = rig_init(model, &c, NULL);
        assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, rig_surface(&goal)));
        for (uint32_t i = 0; i < 5u; i++)
            assert_int_equal(SMR_OK, smr_tick(s, 0, &report[off]));
    }
    assert_int_equal(bytes[0], bytes[1]);
    assert_true(report[0].state_hash == report[1].state_hash && report[1].details.attraction_used == 0.0f);
}

/* One small triangle over the middle of a facet: its three corners feel it, towards it, by barycentric weight. */
static void test_one_triangle(void **state)
{
    float xyz[9];
    const uint32_t corners[3] = {0, 1, 2};
    const smr_mesh mesh = rig_ball(30, 9, 12, none);
    const uint32_t *t = mesh.triangles + 3u * 40u;
    smr_vec middle = smr_v(0, 0, 0);
    uint32_t felt = 0;
    float whole = 0.0f;
    (void)state;
    for (uint32_t c = 0; c < 3u; c++)
        middle = smr_add(middle, smr_scale(smr_load(mesh.xyz + 3u * t[c]), 1.0f / 3.0f));
    const smr_vec out = smr_unit(smr_cross(smr_sub(smr_load(mesh.xyz + 3u * t[1]), smr_load(mesh.xyz + 3u * t[0])),
                                           smr_sub(smr_load(mesh.xyz + 3u * t[2]), smr_load(mesh.xyz + 3u * t[0]))));
    for (uint32_t c = 0; c < 3u;
         c++) { /* half a millimetre outside, so that no other facet is near; 1 % of the facet's size */
        const smr_vec p = smr_add(smr_scale(middle, 0.99f), smr_scale(smr_load(mesh.xyz + 3u * t[c]), 0.01f));
        smr_store(xyz + 3u * c, smr_add(p, smr_scale(out, 0.5f)));
    }
    const smr_mesh goal = {xyz, corners, 3, 1};
    smr *s = start(1, &goal, 0.5f);
    for (uint32_t task = 0; task < smr_attract_tasks(&s->forces.surface); task++)
        smr_attract_search(&s->forces.surface, task, 0);
    for (uint32_t v = 0; v < mesh.n_vertices; v++) {
        const uint32_t at = smr_model_position(s->shared.model, v);
        const int64_t weight = s->forces.surface.pull[4u * (size_t)at + 3u];
        smr_vec mean;
        const float share = smr_pull_take(&s->forces.surface, at, &mean);
        const int corner = v == t[0] || v == t[1] || v == t[2];
        assert_int_equal(corner, share > 0.0f);
        assert_true(share >= 0.0f && share <= 1.0f);
        if (corner) {
            felt++;
            whole += (float)weight / SMR_PULL_SCALE;
            assert_true(fabsf((float)weight / SMR_PULL_SCALE - 1.0f) < 0.02f); /* three vertices, a third each */
            assert_true(smr_length(smr_sub(mean, smr_scale(out, 0.5f))) < 0.05f);
        }
        assert_true(smr_pull_take(&s->forces.surface, at, &mean) == 0.0f); /* cleared */
    }
    assert_int_equal(3, felt);
    assert_true(fabsf(whole - 3.0f) < 1.0e-3f); /* area in mean areas: nothing is lost */
}

/* Weights add up to the target's area, however the tasks were shared out, and the sums have the same bits. */
static void test_workers(void **state)
{
    const float off[3] = {2, 1, 0};
    const smr_mesh goal = rig_ball(33, 20, 25, off);
    smr *one = start(1, &goal, 0.5f), *many = start(5, &goal, 0.5f);
    double sum = 0.0;
    (void)state;
    assert_true(smr_attract_tasks(&one->forces.surface) > 3u);
    for (uint32_t t = 0; t < smr_attract_tasks(&one->forces.surface); t++) {
        smr_attract_search(&one->forces.surface, t, 0);
        smr_attract_search(&many->forces.surface, smr_attract_tasks(&many->forces.surface) - 1u - t, t % 5u);
    }
    for (uint32_t v = 0; v < one->shared.n; v++) {
        smr_vec a = smr_v(0, 0, 0), b = a;
        sum += (double)one->forces.surface.pull[4u * (size_t)v + 3u] / (double)SMR_PULL_SCALE;
        const float wa = smr_pull_take(&one->forces.surface, v, &a), wb = smr_pull_take(&many->forces.surface, v, &b);
        assert_memory_equal(&wa, &wb, sizeof wa);
        assert_memory_equal(&a, &b, sizeof a);
    }
    assert_true(fabs(sum / (double)goal.n_vertices - 1.0) < 0.01);
    for (size_t i = 0; i < 4u * 5u * (size_t)many->shared.n; i++)
        assert_true(many->forces.surface.pull[i] == 0);
}

/* The closest triangle, by comparing with a search from the outside over the model's own surface. */
static void test_closest_facet(void **state)
{
    const float off[3] = {5, -4, 3};
    const smr_mesh mesh = rig_ball(30, 9, 12, none), goal = rig_ball(33, 7, 9, off);
    smr *s = start(1, &goal, 0.5f);
    const smr_surface *model = rig_surface(&mesh);
    (void)state;
    for (uint32_t t = 0; t < smr_attract_tasks(&s->forces.surface); t++)
        smr_attract_search(&s->forces.surface, t, 0);
    for (uint32_t j = 0; j < goal.n_vertices; j++) {
        smr_closest hit;
        assert_int_equal(SMR_OK,
                         smr_surface_closest(model, goal.xyz + 3u * j, NULL, -2.0f, s->schedule.search_mm, &hit));
        assert_int_equal(hit.triangle == SMR_NONE, s->forces.surface.target_warm[j] == SMR_NONE);
        if (hit.triangle == SMR_NONE)
            continue;
        const uint32_t *t = s->shared.triangle + 3u * (size_t)s->forces.surface.target_warm[j];
        const uint32_t *expected = mesh.triangles + 3u * (size_t)hit.triangle;
        uint32_t same = 0;
        for (uint32_t c = 0; c < 3u; c++)
            same += smr_model_original(s->shared.model, t[c]) == expected[c];
        if (same != 3u) { /* another triangle is right only where both are equally close */
            const smr_vec y = smr_load(goal.xyz + 3u * j);
            float weight = fminf(hit.weight[0], fminf(hit.weight[1], hit.weight[2]));
            assert_true(weight < 1.0e-3f && smr_length(y) > 0.0f);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_teardown(test_on_and_off, tidy),
        cmocka_unit_test_teardown(test_report_says_what_was_used, tidy),
        cmocka_unit_test_teardown(test_switched_off, tidy),
        cmocka_unit_test_teardown(test_one_triangle, tidy),
        cmocka_unit_test_teardown(test_workers, tidy),
        cmocka_unit_test_teardown(test_closest_facet, tidy),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
