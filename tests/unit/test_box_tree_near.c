/* test_box_tree_near.c: the triangles that are nearly the nearest: all of them are found, and their shares add up to
 * 1.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include "registration/surface_goals/closest_point_goals.h"
#include "unit_tree.h"

/* The squared distance of triangle i alone; negative when it is not acceptable. */
static float distance2_of(const smr_box_tree *f, const smr_query *q, uint32_t i)
{
    const smr_box_tree single = {
        f->xyz, f->triangle + 3u * (size_t)i, f->normal + 3u * (size_t)i, NULL, NULL, 1, 0, {0}, f->n_vertices};
    smr_hit one = {1.0e12f, SMR_NONE, {0, 0, 0}};
    unit_closest(&single, q, &one);
    return one.triangle == SMR_NONE ? -1.0f : one.d2;
}

static int has(const smr_near_list *list, uint32_t triangle)
{
    for (uint32_t i = 0; i < list->n; i++)
        if (list->item[i].triangle == triangle)
            return 1;
    return 0;
}

/* All acceptable triangles within a tenth beyond the closest, no shares beyond that, and the shares add up to 1. */
TEST(near_ones_are_all_of_them)
{
    oracle_random r = oracle_seed(75);
    uint32_t several = 0;
    for (uint32_t k = 0; k < 8u; k++) {
        unit_mesh m = k % 2u == 0u ? unit_soup(&r, 40u + 60u * k, 100.0f, k % 4u == 0u) : unit_sphere(2, 50.0f, 20.0f);
        uint32_t *triangles;
        smr_box_tree f = unit_plant(&m, &triangles);
        for (uint32_t round = 0; round < 300u; round++) {
            const smr_query q = unit_query(&r, &m, round);
            smr_hit closest = {1.0e12f, SMR_NONE, {0, 0, 0}}, hit = closest;
            smr_near_list list;
            float sum = 0.0f;
            smr_tree_closest(&f, &q, &closest);
            smr_tree_near(&f, &q, &hit, &list, NULL);
            assert_true(hit.triangle == closest.triangle && hit.d2 == closest.d2);
            assert_true((list.n == 0u) == (hit.triangle == SMR_NONE) && list.n <= SMR_NEAR_MOST);
            for (uint32_t i = 0; i < list.n; i++) {
                const float d2 = distance2_of(&f, &q, list.item[i].triangle);
                assert_true(d2 >= 0.0f && list.item[i].share >= 0.0f);
                assert_true(d2 <= 1.2101f * hit.d2 || list.item[i].share == 0.0f);
                sum += list.item[i].share;
                several += list.item[i].share > 0.0f && list.item[i].triangle != hit.triangle;
            }
            assert_true(list.n == 0u || fabsf(sum - 1.0f) < 1.0e-5f);
            for (uint32_t i = 0; i < m.nt && list.n > 1u && list.n < SMR_NEAR_MOST; i++) {
                const float d2 = distance2_of(&f, &q, i);
                assert_true(d2 < 0.0f || d2 > 1.2099f * hit.d2 || has(&list, i));
            }
        }
        unit_uproot(&f, triangles);
        unit_mesh_free(&m);
    }
    assert_true(several > 300u);
}

/* A search that knows how far other triangles are has the bits of one that does not, while its point wanders. */
TEST(knowing_other_triangles_changes_no_bit)
{
    oracle_random r = oracle_seed(79);
    uint32_t sure = 0;
    for (uint32_t k = 0; k < 8u; k++) {
        unit_mesh m = k % 2u == 0u ? unit_soup(&r, 40u + 60u * k, 100.0f, k % 4u == 0u) : unit_sphere(2, 50.0f, 20.0f);
        uint32_t *triangles;
        smr_box_tree f = unit_plant(&m, &triangles);
        for (uint32_t i = 0; i < 6000u; i++) {
            static smr_query q;
            static smr_certainty known;
            if (i % 30u == 0u)
                q = unit_query(&r, &m, i / 30u);
            known = (smr_certainty){i % 2u == 0u ? 0.1f : 0.0f, i % 30u == 0u ? 0.0f : known.other_mm, 0, NULL};
            smr_hit hit = {1.0e12f, SMR_NONE, {0, 0, 0}}, plain = hit;
            smr_near_list near, all;
            smr_tree_near(&f, &q, &hit, &near, &known);
            smr_tree_near(&f, &q, &plain, &all, NULL);
            assert_memory_equal(&hit, &plain, sizeof hit);
            assert_true(near.n == all.n && (!known.sure || (near.item[0].share == 1.0f && all.item[0].share == 1.0f)));
            const smr_vec step = smr_v(oracle_uniformf(&r, -0.02f, 0.02f), oracle_uniformf(&r, -0.02f, 0.02f), 0.01f);
            q.point = smr_add(q.point, step);
            q.warm = hit.triangle;
            known.other_mm -= 1.0001f * smr_length(step) + 2.5e-5f;
            sure += known.sure;
        }
        unit_uproot(&f, triangles);
        unit_mesh_free(&m);
    }
    assert_true(sure > 5000u);
}

/* With however small a node budget, the nearest known triangle has its share. Where more are near than the list
 * holds, the last bits do not decide which are kept. */
TEST(near_ones_end_where_room_or_budget_do)
{
    oracle_random r = oracle_seed(76);
    unit_mesh m = unit_grid(60, 60, 2.0f);
    uint32_t *triangles, full = 0;
    for (uint32_t i = 0; i < m.nv; i++)
        m.xyz[3u * (size_t)i + 2u] = oracle_uniformf(&r, -0.2f, 0.2f);
    smr_box_tree f = unit_plant(&m, &triangles);
    for (uint32_t k = 0; k < 400u; k++) {
        smr_query q = {smr_v(oracle_uniformf(&r, 20, 100), oracle_uniformf(&r, 20, 100), k % 2u == 0u ? 10.0f : 20.0f),
                       smr_v(0, 0, 0), -2.0f, UINT32_MAX, SMR_NONE};
        smr_hit closest = {1.0e12f, SMR_NONE, {0, 0, 0}}, hit = closest;
        smr_near_list list;
        float most = 0.0f;
        smr_tree_near(&f, &q, &closest, &list, NULL);
        if (list.n == SMR_NEAR_MOST) {
            full++;
            for (uint32_t i = 0; i < list.n; i++) /* the farthest in the list is about to leave it */
                most = fmaxf(most, list.item[i].d2);
            for (uint32_t i = 0; i < list.n; i++)
                assert_true(list.item[i].d2 < most || list.item[i].share < 0.05f);
            assert_true(list.cut2 >= most);
        }
        q.node_budget = 8;
        q.warm = closest.triangle;
        smr_tree_near(&f, &q, &hit, &list, NULL);
        assert_int_equal(closest.triangle, hit.triangle);
        float nearest = 0.0f;
        for (uint32_t i = 0; i < list.n; i++)
            nearest = list.item[i].triangle == hit.triangle ? list.item[i].share : nearest;
        assert_true(nearest > 0.0f);
    }
    assert_true(full > 100u);
}

/* The path that limits what searches know is never shorter than the sum of small displacements, whatever is rounded. */
TEST(path_of_small_steps)
{
    const smr_shared shared = {.n_structures = 1, .config.basic.n_workers = 1};
    smr_target target = {.path = 7.0f};
    smr_goal goal = {.n_vertices = 9};
    smr_surface_goals g = {.shared = &shared, .target = &target, .goal = &goal, .n_goals = 1}; /* without slots */
    double sum = 7.0;
    for (uint32_t i = 0; i < 300000u; i++) {
        const float moved = 1.0e-7f * (float)(i % 7u);
        float most2 = moved * moved;
        smr_certainties_age(&g, &most2);
        sum += (double)moved;
        assert_true((double)target.path >= sum && most2 == 0.0f);
    }
    smr_certainties_age(&g, (float[1]){64});
    assert_true(target.path == 0.0f);
}

/* Copies of a triangle, all at one distance, which may be the search's; and a ball of which others are asked for that
 * lie far from the closest. */
TEST(many_at_one_distance)
{
    unit_mesh copies = unit_mesh_new(3, 1000), ball = unit_sphere(4, 40, 0);
    memcpy(copies.xyz, (const float[9]){0, 0, 0, 8, 0, 0, 0, 8, 0}, 9u * sizeof *copies.xyz);
    for (uint32_t i = 0; i < 3u * copies.nt; i++)
        copies.triangles[i] = i % 3u;
    for (uint32_t k = 0; k < 3u; k++) {
        smr_surface *s = unit_surface(k < 2u ? &copies : &ball);
        const smr_vec at = k < 2u ? smr_v(1, 1, 2) : smr_v(1, 2, 90);
        const smr_query q = {smr_sub(at, s->origin), {0, 0, 0}, -2.0f, UINT32_MAX, SMR_NONE};
        smr_hit hit = {k == 1u ? 4.0f : 10000.0f, SMR_NONE, {0, 0, 0}};
        smr_certainty known = {k < 2u ? -1.0f : 60.0f, 0.0f, 0, NULL};
        assert_int_equal(1, smr_surface_search_known(s, NULL, &q, &hit, &known));
        const float mm = SMR_SQRT(hit.d2);
        assert_true(k < 2u ? mm == 2.0f && known.other_mm == 0.0f : smr_abs(known.other_mm - mm) < 0.1f);
        rig_free(s);
    }
}
