/* test_moving_triangles.c: normals and boxes of triangles follow the model, task by task as well as all at once.
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

static smr *start(uint32_t n_target_vertices)
{
    const float off[3] = {70, 0, 0};
    const smr_mesh mesh[3] = {
        rig_ball(30, 12, 20, none), rig_ball(20, 3, 4, off), {rig_ball(5, 2, 3, off).xyz, NULL, 8, 0}};
    const smr_prepare_config radii = rig_radii(1, 18, 0, 0);
    smr_config config = smr_config_default();
    config.basic.n_target_vertices = n_target_vertices;
    return rig_init(rig_model(mesh, 3, &radii), &config, NULL);
}

static void scramble(smr *s, uint32_t seed)
{
    for (uint32_t i = 0; i < 3u * s->shared.n; i++)
        s->shape.x_next[i] = s->shape.x[i] + rig_between(&seed, -4, 4);
}

static int within(const smr_node *node, uint32_t k, const float *p)
{
    return p[0] >= node->lo[0][k] && p[0] <= node->hi[0][k] && p[1] >= node->lo[1][k] && p[1] <= node->hi[1][k] &&
           p[2] >= node->lo[2][k] && p[2] <= node->hi[2][k];
}

static void test_normals_and_boxes(void **state)
{
    smr *s = start(10);
    (void)state;
    for (uint32_t round = 1; round < 4u; round++) {
        scramble(s, round);
        smr_triangles_follow(&s->shape, s->shape.x_next);
        for (uint32_t t = smr_triangles_tasks(&s->shape); t > 0u; t--)
            smr_triangles_refit(&s->shape, t - 1u, 0);
        smr_triangles_end(&s->shape);
        for (uint32_t i = 0; i < s->shared.n_structures; i++) {
            const smr_box_tree *f = &s->shape.structure[i].tree;
            for (uint32_t k = 0; k < f->n_triangles; k++) {
                const float *p[3];
                for (uint32_t c = 0; c < 3u; c++)
                    p[c] = smr_at3(s->shape.x_next, f->triangle[3u * k + c]);
                const smr_vec n = smr_unit(
                    smr_cross(smr_sub(smr_load(p[1]), smr_load(p[0])), smr_sub(smr_load(p[2]), smr_load(p[0]))));
                assert_true(smr_length(smr_sub(n, smr_load(f->normal + 3u * k))) < 1.0e-5f);
                for (uint32_t level = 0, at = k; level < f->n_levels; level++) {
                    const smr_node *node = &f->node[f->level[level] + at / SMR_TREE_WIDTH];
                    for (uint32_t c = 0; c < 3u; c++)
                        assert_true(within(node, at % SMR_TREE_WIDTH, p[c]));
                    at /= SMR_TREE_WIDTH;
                }
            }
        }
    }
}

static void test_all_at_once_is_the_same(void **state)
{
    smr *s = start(10), *twin = start(10);
    (void)state;
    scramble(s, 77);
    smr_triangles_follow(&s->shape, s->shape.x_next);
    for (uint32_t t = 0; t < smr_triangles_tasks(&s->shape); t++)
        smr_triangles_refit(&s->shape, t, 0);
    smr_triangles_end(&s->shape);
    memcpy(twin->shape.x, s->shape.x_next, 3u * s->shared.n * sizeof(float));
    smr_triangles_now(&twin->shape);
    assert_memory_equal(s->shape.triangle_normal, twin->shape.triangle_normal,
                        3u * s->shared.n_triangles * sizeof(float));
    assert_memory_equal(s->shape.node, twin->shape.node, s->shape.n_nodes * sizeof *s->shape.node);
}

static void test_each_leaf_in_one_task(void **state)
{
    smr *s = start(0);
    (void)state;
    assert_null(s->shape.node);
    scramble(s, 5);
    smr_triangles_follow(&s->shape, s->shape.x_next);
    for (uint32_t t = 0; t < smr_triangles_tasks(&s->shape); t++) {
        uint32_t changed = 0;
        float *before = rig_alloc(3u * s->shared.n_triangles * sizeof *before);
        memcpy(before, s->shape.triangle_normal, 3u * s->shared.n_triangles * sizeof *before);
        smr_triangles_refit(&s->shape, t, 0);
        for (uint32_t k = 0; k < s->shared.n_triangles; k++)
            changed += memcmp(before + 3u * k, s->shape.triangle_normal + 3u * k, 3u * sizeof *before) != 0;
        assert_true(changed > 0u && changed <= 256u); /* bounded work, and none in vain */
    }
    smr_triangles_end(&s->shape); /* nothing above leaves that do not exist */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_teardown(test_normals_and_boxes, tidy),
        cmocka_unit_test_teardown(test_all_at_once_is_the_same, tidy),
        cmocka_unit_test_teardown(test_each_leaf_in_one_task, tidy),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
