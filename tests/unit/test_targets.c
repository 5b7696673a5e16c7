/* test_targets.c: which structure is attracted by which surface, and what a new surface resets.
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

static smr_mesh ball[3];
static const smr_surface *surface[3];

static smr *start(uint32_t n_target_vertices)
{
    const smr_prepare_config radii = rig_radii(1, 15, 0, 0);
    smr_config config = smr_config_default();
    config.basic.n_target_vertices = n_target_vertices;
    config.motion.settle_um = 0.0f; /* nothing to do is no reason to end */
    for (uint32_t i = 0; i < 3u; i++) {
        const float at[3] = {50.0f * (float)i, 0, 0};
        ball[i] = rig_ball(20, 6, 9 + 10 * i, at);
        surface[i] = rig_surface(&ball[i]);
    }
    return rig_init(rig_model(ball, 3, &radii), &config, NULL);
}

static void test_goals(void **state)
{
    smr *s = start(400);
    const uint32_t nv[3] = {ball[0].n_vertices, ball[1].n_vertices, ball[2].n_vertices};
    (void)state;
    assert_int_equal(0, s->forces.surface.n_goals);
    assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, surface[2]));
    assert_int_equal(1, s->forces.surface.n_goals); /* shared, searched once */
    assert_int_equal(smr_ceil_div(nv[2], SMR_FORCE_CHUNK), s->forces.surface.n_tasks);
    assert_int_equal(SMR_OK, smr_set_surface(s, 1, surface[0]));
    assert_int_equal(2, s->forces.surface.n_goals);
    assert_ptr_equal(surface[2], s->forces.surface.goal[0].surface);
    assert_ptr_equal(surface[0], s->forces.surface.goal[1].surface);
    assert_int_equal(nv[2], s->forces.surface.goal[1].first_warm);
    assert_int_equal(smr_ceil_div(nv[2], SMR_FORCE_CHUNK), s->forces.surface.goal[1].first_task);
    assert_int_equal(SMR_OK, smr_set_surface(s, 0, surface[1]));
    assert_int_equal(3, s->forces.surface.n_goals);
    assert_int_equal(SMR_OK, smr_set_surface(s, 2, NULL));
    assert_int_equal(2, s->forces.surface.n_goals);
    assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, NULL));
    assert_int_equal(0, s->forces.surface.n_goals);
    assert_int_equal(0, s->forces.surface.n_tasks);
}

static void test_room(void **state)
{
    smr *s = start(0);
    const uint32_t room = ball[0].n_vertices + ball[2].n_vertices;
    (void)state;
    for (uint32_t i = 0; i < 3u; i++) /* without attraction any size will do */
        assert_int_equal(SMR_OK, smr_set_surface(s, i, surface[i]));
    s = start(room);
    assert_int_equal(SMR_OK, smr_set_surface(s, 0, surface[0]));
    assert_int_equal(SMR_OK, smr_set_surface(s, 2, surface[2]));
    assert_int_equal(SMR_OK, smr_set_surface(s, 1, surface[2])); /* known already */
    const uint64_t before = smr_state_hash(s);
    assert_int_equal(SMR_E_ARENA, smr_set_surface(s, 1, surface[1]));
    assert_ptr_equal(surface[2], s->forces.surface.target[1].surface);
    assert_int_equal(2, s->forces.surface.n_goals);
    assert_true(before == smr_state_hash(s));
    assert_int_equal(SMR_OK, smr_set_surface(s, 0, NULL));
    assert_int_equal(SMR_OK, smr_set_surface(s, 1, surface[0]));
}

static void test_forgets_warm_starts(void **state)
{
    smr *s = start(400);
    (void)state;
    for (uint32_t i = 0; i < 3u; i++)
        assert_int_equal(SMR_OK, smr_set_surface(s, i, surface[i]));
    (void)rig_run(s, 3);
    assert_int_equal(SMR_OK, smr_set_surface(s, 1, surface[1]));
    for (uint32_t v = 0; v < s->shared.n; v++) {
        const int here = smr_model_owner(s->shared.model, v) == 1u;
        assert_true(here ? s->forces.surface.warm[v] == SMR_NONE : s->forces.surface.warm[v] < ball[2].n_triangles);
    }
    for (uint32_t j = 0; j < 400u; j++)
        assert_true(s->forces.surface.target_warm[j] == SMR_NONE);
    assert_true(s->forces.surface.limit == 0.0f);
}

/* A surface counts from the next iteration on, whatever there was before. */
static void test_late_target(void **state)
{
    smr *s = start(400), *early = start(400);
    const float off[3] = {4, 0, 0}, plain[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    const smr_mesh moved = rig_moved(&ball[0], plain, off);
    const smr_surface *goal = rig_surface(&moved);
    (void)state;
    (void)rig_run(s, 3); /* nothing to do: the rest shape stays */
    (void)rig_run(early, 3);
    assert_int_equal(SMR_OK, smr_set_surface(s, 0, goal));
    assert_int_equal(SMR_OK, smr_set_surface(early, SMR_ALL, surface[1]));
    assert_int_equal(SMR_OK, smr_set_surface(early, SMR_ALL, NULL));
    assert_int_equal(SMR_OK, smr_set_surface(early, 0, goal));
    (void)rig_run(s, 1);
    (void)rig_run(early, 1);
    assert_true(smr_state_hash(s) == smr_state_hash(early));
    assert_true(s->report.n_forces > 0u);
}

/* Boxes of a structure that moved without a target are up to date when it gets one. */
static void test_trees_move_without_target(void **state)
{
    const float off[3] = {12, 0, 0}, plain[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    smr *s = start(400);
    const smr_mesh moved = rig_moved(&ball[0], plain, off);
    (void)state;
    assert_int_equal(SMR_OK, smr_set_surface(s, 0, rig_surface(&moved)));
    (void)rig_run(s, 8);
    for (uint32_t i = 0; i < 3u; i++) {
        const smr_box_tree *f = &s->shape.structure[i].tree;
        const smr_node *root = &f->node[f->level[f->n_levels - 1u]];
        for (uint32_t k = 0; k < 3u * f->n_triangles; k++) {
            const float *p = smr_at3(s->shape.x, f->triangle[k]);
            int inside = 0;
            for (uint32_t c = 0; c < SMR_TREE_WIDTH; c++) {
                inside |= p[0] >= root->lo[0][c] && p[0] <= root->hi[0][c] && p[1] >= root->lo[1][c] &&
                          p[1] <= root->hi[1][c] && p[2] >= root->lo[2][c] && p[2] <= root->hi[2][c];
            }
            assert_true(inside);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_teardown(test_goals, tidy),
        cmocka_unit_test_teardown(test_room, tidy),
        cmocka_unit_test_teardown(test_forgets_warm_starts, tidy),
        cmocka_unit_test_teardown(test_late_target, tidy),
        cmocka_unit_test_teardown(test_trees_move_without_target, tidy),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
