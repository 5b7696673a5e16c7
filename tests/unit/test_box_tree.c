/* test_box_tree.c: the box tree finds the same triangle as a search of all triangles: the squared distance agrees to
 * 4e-7 relative (boxes and triangles round differently), and ties go to the smallest index in tree order.
 * SPDX-License-Identifier: MIT */
#include "cmocka_first.h"

#include <math.h>
#include <string.h>

#include "unit_tree.h"

static void same(const smr_hit *got, const smr_hit *want, double *worst)
{
    if (want->triangle == SMR_NONE || got->triangle == SMR_NONE) {
        assert_int_equal(got->triangle, want->triangle);
        return;
    }
    assert_true(got->d2 >= want->d2);
    *worst = fmax(*worst, ((double)got->d2 - (double)want->d2) / fmax((double)want->d2, 1e-6));
    if (got->d2 == want->d2) {
        assert_int_equal(got->triangle, want->triangle);
        assert_memory_equal(got->weight, want->weight, sizeof want->weight);
    }
}

static void equals_brute_force(void **state)
{
    static const uint32_t sizes[] = {1, 2, 7, 8, 9, 63, 64, 65, 200, 512, 513, 1500};
    static const float reach[] = {1e12f, 400.0f, 25.0f, 0.0f};
    oracle_random r = oracle_seed(70);
    double worst = 0.0;
    (void)state;
    for (uint32_t k = 0; k < 24u; k++) {
        unit_mesh m = unit_soup(&r, sizes[k % 12u], 100.0f, k % 3u == 0u);
        uint32_t *triangles;
        smr_box_tree f = unit_plant(&m, &triangles);
        for (uint32_t i = 0; i < 240u; i++) {
            const smr_query q = unit_query(&r, &m, i);
            smr_hit got = {reach[i % 4u], SMR_NONE, {0, 0, 0}}, want = got;
            smr_tree_closest(&f, &q, &got);
            unit_closest(&f, &q, &want);
            same(&got, &want, &worst);
        }
        unit_uproot(&f, triangles);
        unit_mesh_free(&m);
    }
    assert_true(oracle_within("tree: d2 beyond brute force, relative", worst, 4e-7));
}

/* Against double precision, on triangles that all have an area. */
static void equals_double(void **state)
{
    oracle_random r = oracle_seed(71);
    unit_mesh m = unit_sphere(3, 50.0f, 20.0f);
    uint32_t *triangles;
    smr_box_tree f = unit_plant(&m, &triangles);
    double worst = 0.0;
    (void)state;
    for (uint32_t i = 0; i < 1500u; i++) {
        const smr_query q = {
            smr_v(oracle_uniformf(&r, -90, 140), oracle_uniformf(&r, -90, 140), oracle_uniformf(&r, -90, 140)),
            smr_v(0, 0, 0), -2.0f, UINT32_MAX, SMR_NONE};
        const double p[3] = {(double)q.point.x, (double)q.point.y, (double)q.point.z};
        smr_hit hit = {1e12f, SMR_NONE, {0, 0, 0}};
        double want = HUGE_VAL;
        smr_tree_closest(&f, &q, &hit);
        for (uint32_t k = 0; k < m.nt; k++) {
            double c[9];
            for (uint32_t j = 0; j < 9u; j++)
                c[j] = (double)m.xyz[3u * (size_t)m.triangles[3u * k + j / 3u] + j % 3u];
            want = fmin(want, oracle_triangle(p, c, c + 3, c + 6));
        }
        worst = fmax(worst, fabs(sqrt((double)hit.d2) - sqrt(want)));
    }
    assert_true(oracle_within("tree: distance against double, mm", worst, 3e-5));
    unit_uproot(&f, triangles);
    unit_mesh_free(&m);
}

/* More nodes never give a worse answer; as many as there are give the exact one; none gives the warm start alone. */
static void node_budgets(void **state)
{
    oracle_random r = oracle_seed(72);
    unit_mesh m = unit_soup(&r, 700, 100.0f, 0);
    uint32_t *triangles;
    smr_box_tree f = unit_plant(&m, &triangles);
    (void)state;
    for (uint32_t i = 0; i < 300u; i++) {
        smr_query q = unit_query(&r, &m, i);
        smr_hit full = {1e12f, SMR_NONE, {0, 0, 0}}, last = full, warm = full;
        smr_tree_closest(&f, &q, &full);
        q.node_budget = 0;
        smr_tree_closest(&f, &q, &warm);
        assert_true(warm.triangle == SMR_NONE || warm.triangle == q.warm);
        for (uint32_t budget = 1; budget <= smr_tree_nodes(m.nt); budget += budget / 2u + 1u) {
            smr_hit hit = {1e12f, SMR_NONE, {0, 0, 0}};
            q.node_budget = budget;
            smr_tree_closest(&f, &q, &hit);
            assert_true(hit.d2 <= last.d2 && hit.d2 >= full.d2);
            last = hit;
        }
        q.node_budget = smr_tree_nodes(m.nt);
        smr_hit hit = {1e12f, SMR_NONE, {0, 0, 0}};
        smr_tree_closest(&f, &q, &hit);
        assert_memory_equal(&hit, &full, sizeof hit);
    }
    unit_uproot(&f, triangles);
    unit_mesh_free(&m);
}

/* Two levels: one node is the root, which has no triangles of its own; the second is the nearest leaf. */
static void a_budget_is_a_number_of_nodes(void **state)
{
    oracle_random r = oracle_seed(75);
    unit_mesh m = unit_soup(&r, 60, 100.0f, 0);
    uint32_t *triangles;
    smr_box_tree f = unit_plant(&m, &triangles);
    (void)state;
    for (uint32_t i = 0; i < 200u; i++) {
        smr_query q = {
            smr_v(oracle_uniformf(&r, -40, 140), oracle_uniformf(&r, -40, 140), oracle_uniformf(&r, -40, 140)),
            smr_v(0, 0, 0), -2.0f, 1u, SMR_NONE};
        smr_hit hit = {1e12f, SMR_NONE, {0, 0, 0}};
        smr_tree_closest(&f, &q, &hit);
        assert_int_equal(hit.triangle, SMR_NONE);
        q.node_budget = 2u;
        smr_tree_closest(&f, &q, &hit);
        assert_true(hit.triangle < m.nt);
    }
    unit_uproot(&f, triangles);
    unit_mesh_free(&m);
}

static void nothing_found_changes_nothing(void **state)
{
    oracle_random r = oracle_seed(73);
    unit_mesh m = unit_soup(&r, 100, 10.0f, 0);
    uint32_t *triangles;
    smr_box_tree f = unit_plant(&m, &triangles), none;
    (void)state;
    const smr_query far_away = {smr_v(500, 500, 500), smr_v(0, 0, 0), -2.0f, UINT32_MAX, 3u};
    smr_hit hit = {4.0f, 77u, {0.25f, 0.5f, 0.25f}};
    const smr_hit was = hit;
    smr_tree_closest(&f, &far_away, &hit);
    assert_memory_equal(&hit, &was, sizeof hit);
    memset(&none, 0, sizeof none);
    smr_tree_shape(&none, 0);
    assert_int_equal(none.n_levels, 0);
    smr_tree_closest(&none, &far_away, &hit);
    assert_memory_equal(&hit, &was, sizeof hit);
    unit_uproot(&f, triangles);
    unit_mesh_free(&m);
}

/* Moving the mesh and refitting, a few leaves at a time, is the same as planting anew. */
static void refit_follows_the_mesh(void **state)
{
    oracle_random r = oracle_seed(74);
    unit_mesh m = unit_soup(&r, 333, 100.0f, 1);
    uint32_t *triangles;
    smr_box_tree f = unit_plant(&m, &triangles);
    double worst = 0.0;
    (void)state;
    for (uint32_t i = 0; i < 3u * m.nv; i++)
        m.xyz[i] = m.xyz[i] * 0.7f + oracle_uniformf(&r, -30, 30);
    const uint32_t leaves = smr_tree_leaves(&f);
    smr_tree_refit_leaves(&f, leaves / 2u, leaves);
    smr_tree_refit_leaves(&f, 0, leaves / 2u);
    smr_tree_refit_upper(&f);
    for (uint32_t i = 0; i < 300u; i++) {
        const smr_query q = unit_query(&r, &m, i);
        smr_hit got = {1e12f, SMR_NONE, {0, 0, 0}}, want = got;
        smr_tree_closest(&f, &q, &got);
        unit_closest(&f, &q, &want);
        same(&got, &want, &worst);
    }
    assert_true(oracle_within("tree: after a refit, relative", worst, 4e-7));
    unit_uproot(&f, triangles);
    unit_mesh_free(&m);
}

/* A forged model's positions can come to be no numbers, or lie where empty boxes do: the search stays in the tree. */
static void points_that_are_nowhere(void **state)
{
    const float nowhere[] = {NAN, -NAN, INFINITY, -INFINITY, SMR_FAR, -SMR_FAR, FLT_MAX, 1.0e9f};
    smr_box_tree f;
    (void)state;
    memset(&f, 0, sizeof f);
    smr_tree_shape(&f, 262145u); /* most children of its top nodes are empty */
    const size_t n_nodes = smr_tree_nodes(f.n_triangles), nt = f.n_triangles;
    smr_node *node = unit_memory(n_nodes * sizeof *node);
    float *normal = unit_memory(12u * nt), xyz[3] = {0, 0, 0};
    uint32_t *triangle = unit_memory(12u * nt);
    memset(triangle, 0, 12u * nt);
    f.node = node;
    f.normal = normal;
    f.xyz = xyz;
    f.triangle = triangle;
    smr_tree_refit_leaves(&f, 0, smr_tree_leaves(&f));
    smr_tree_refit_upper(&f);
    for (size_t i = 0; i < sizeof nowhere / sizeof nowhere[0]; i++) {
        const smr_query q = {smr_v(nowhere[i], nowhere[i], nowhere[i]), smr_v(0, 0, 0), -2.0f, 100000u, SMR_NONE};
        smr_hit hit = {3600.0f, SMR_NONE, {0, 0, 0}};
        smr_tree_closest(&f, &q, &hit);
        assert_true(hit.triangle == SMR_NONE && hit.d2 == 3600.0f);
    }
    unit_free(node);
    unit_free(normal);
    unit_free(triangle);
}

static void shape_adds_up(void **state)
{
    static const struct {
        uint32_t triangles, nodes, levels;
    } table[] = {{0, 0, 0},    {1, 1, 1},    {8, 1, 1},
                 {9, 3, 2},    {64, 9, 2},   {65, 12, 3},
                 {512, 73, 3}, {513, 77, 4}, {SMR_TRIANGLES_MAX, 1142860, 8}};
    (void)state;
    for (size_t i = 0; i < sizeof table / sizeof table[0]; i++) {
        smr_box_tree f;
        smr_tree_shape(&f, table[i].triangles);
        assert_int_equal(smr_tree_nodes(table[i].triangles), table[i].nodes);
        assert_int_equal(f.n_levels, table[i].levels);
        assert_true(f.n_levels <= SMR_TREE_LEVELS);
        for (uint32_t l = 1; l < f.n_levels; l++)
            assert_true(f.level[l] > f.level[l - 1u] && f.level[l] < table[i].nodes);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(equals_brute_force),
        cmocka_unit_test(equals_double),
        cmocka_unit_test(node_budgets),
        cmocka_unit_test(nothing_found_changes_nothing),
        cmocka_unit_test(a_budget_is_a_number_of_nodes),
        cmocka_unit_test(refit_follows_the_mesh),
        cmocka_unit_test(shape_adds_up),
        cmocka_unit_test(points_that_are_nowhere),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
