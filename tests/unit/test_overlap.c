/* test_overlap.c: which targets are taken as whole, and which as partial; a target that is met exactly.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <string.h>
#include "property/rig_parts.h"
#include "registration/tick/iteration_steps.h"

#define STEP 5.0f    /* mm, of the sheets */
#define RADIUS 20.0f /* mm, of the clusters */
#define APART 4.0f   /* mm, of the sheets */

enum { SIDE = 21, ROUNDED = 3 };

/* A flat sheet from x = 0 to `width`, y = 0 to 100, at z. */
static smr_mesh sheet(float width, float z)
{
    const uint32_t nv = SIDE * SIDE, nt = 2u * (SIDE - 1u) * (SIDE - 1u);
    float *xyz = rig_alloc(3u * nv * sizeof *xyz);
    uint32_t *t = rig_alloc(3u * nt * sizeof *t);
    for (uint32_t i = 0; i < nv; i++) {
        xyz[3u * i] = width * (float)(i % SIDE) / (float)(SIDE - 1u);
        xyz[3u * i + 1u] = STEP * (float)(i / SIDE);
        xyz[3u * i + 2u] = z;
    }
    for (uint32_t k = 0; k < nt; k++) {
        const uint32_t a = k / 2u / (SIDE - 1u) * SIDE + k / 2u % (SIDE - 1u);
        const uint32_t corner[2][3] = {{a, a + 1u, a + SIDE}, {a + SIDE + 1u, a + SIDE, a + 1u}};
        memcpy(t + 3u * k, corner[k % 2u], sizeof corner[0]);
    }
    return (smr_mesh){xyz, t, nv, nt};
}

/* The sheet of 100 x 100 mm after one iteration towards a narrower one above it: judged at its start. */
static smr *judged(float width, uint32_t coverage)
{
    const smr_mesh mesh = sheet(100.0f, 0.0f), goal = sheet(width, APART);
    const smr_prepare_config radii = rig_radii(1, RADIUS, 0, 0);
    smr_config c = smr_config_default();
    c.partial.coverage = coverage;
    c.basic.n_target_vertices = goal.n_vertices;
    smr *s = rig_init(rig_model(&mesh, 1, &radii), &c, NULL);
    assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, rig_surface(&goal)));
    (void)rig_run(s, 1);
    return s;
}

/* An open target is seen in part; not so when it is said to be whole, nor a closed one that is covered. */
TEST(which_targets_are_partial)
{
    static const float centre[3] = {0, 0, 0}, aside[3] = {20, 0, 0};
    smr *s = judged(50.0f, SMR_COVERAGE_AUTO);
    assert_int_equal(s->forces.surface.partial, 1);
    s = judged(50.0f, SMR_COVERAGE_WHOLE);
    assert_null(s->forces.surface.visibility);
    smr_config plain = smr_config_default();
    plain.partial.coverage = SMR_COVERAGE_WHOLE;
    plain.track.mode = SMR_TRACK_RECOVER; /* which needs no step for parts either, without images */
    assert_int_equal(0, rig_init(s->shared.model, &plain, NULL)->shared.parts & SMR_PART_PARTIAL);
    assert_int_equal(s->forces.surface.partial, 0);
    for (uint32_t k = 0; k < 3u; k++) {
        const smr_mesh ball = rig_ball(30.0f, 13, 20, centre), goal = rig_ball(30.0f, 15, 22, k == 1u ? aside : centre);
        const smr_prepare_config radii = rig_radii(1, RADIUS, 0, 0);
        smr_config c = smr_config_default();
        c.partial.coverage = k == 2u ? SMR_COVERAGE_PARTIAL : SMR_COVERAGE_AUTO;
        c.basic.n_target_vertices = goal.n_vertices;
        s = rig_init(rig_model(&ball, 1, &radii), &c, NULL);
        assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, rig_surface(&goal)));
        (void)rig_run(s, 1);
        assert_int_equal(s->forces.surface.partial, k > 0u); /* aside, not all of it finds mutual goals */
        assert_true(s->forces.surface.target[0].n_judged == ball.n_vertices);
        assert_true((s->forces.surface.target[0].n_visible > 9u * ball.n_vertices / 10u) == (k != 1u));
        for (uint32_t left = 0; left <= SMR_REPAIRED && k == 0u; left++) { /* after a repair of folds it waits */
            s->schedule.radius_iteration = left > 0u ? SMR_REPAIRED - left : 1u;
            s->schedule.repaired = left;
            assert_int_equal(left == 1u, smr_visibility_judged(&s->forces.surface, 0));
        }
    }
}

/* A ball of more vertices than a task counts is seen in part while it lies aside, as whole once it has moved there, and
 * what was seen at the judgement stays known. */
TEST(until_it_is_covered)
{
    static const float centre[3] = {0, 0, 0}, aside[3] = {20, 0, 0};
    const smr_mesh ball = rig_ball(30.0f, 30, 40, centre), goal = rig_ball(30.0f, 15, 22, aside);
    const smr_prepare_config radii = rig_radii(2, RADIUS, RADIUS / 2.0f, 0);
    smr_config c = smr_config_default();
    c.basic.n_target_vertices = goal.n_vertices;
    smr *s = rig_init(rig_model(&ball, 1, &radii), &c, NULL);
    const smr_target *const target = s->forces.surface.target;
    assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, rig_surface(&goal)));
    for (uint32_t i = 0; i < 200u && (i == 0u || s->forces.surface.partial); i++) {
        (void)rig_run(s, 1);
        assert_int_equal(target->n_judged, ball.n_vertices);
        assert_int_equal(s->forces.surface.partial, target->partial);
    }
    const uint32_t shown = target->n_visible;
    (void)rig_run(s, 1);
    assert_true(shown > 9u * ball.n_vertices / 10u && shown <= ball.n_vertices);
    assert_int_equal(target->n_visible, shown);
}

/* Where a model that was shifted lies exactly on its target, with neither noise nor a bend to measure, expected errors
 * are numbers. */
TEST(expected_without_noise)
{
    float mm[2 * SIDE * SIDE];
    static const float over[9] = {1, 0, 0, 0, 1, 0, 0, 0, -1}, below[3] = {0, 0, -40};
    const smr_mesh goal = sheet(100.0f, 0.0f), two[2] = {goal, rig_moved(&goal, over, below)};
    const smr_mesh mesh = rig_joined(two, 2);
    const smr_prepare_config radii = rig_radii(1, RADIUS, 0, 0);
    smr_config c = smr_config_default();
    c.basic.n_target_vertices = goal.n_vertices;
    smr *s = rig_init(rig_model(&mesh, 1, &radii), &c, NULL);
    assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, rig_surface(&goal)));
    (void)rig_run(s, 1);
    for (uint32_t v = 0; v < mesh.n_vertices; v++)
        s->shape.start[3u * v + 2u] -= 8.0f; /* as if it had come from there */
    assert_int_equal(SMR_OK, smr_get_expected_error(s, 0, mm));
    for (uint32_t v = 0; v < mesh.n_vertices; v++)
        assert_true(mm[v] >= 0.0f && mm[v] < 100.0f);
}
