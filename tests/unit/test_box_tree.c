/* test_box_tree.c: the box tree finds the same triangle as a search of all triangles: the squared distance agrees to
 * 4e-7 relative (boxes and triangles round differently), and ties go to the smallest index in tree order.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include <string.h>
#include "geometry/surface/surface.h"
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

TEST(equals_brute_force)
{
    static const uint32_t sizes[] = {1, 2, 7, 8, 9, 63, 64, 65, 200, 512, 513, 1500};
    static const float reach[] = {1e12f, 400.0f, 25.0f, 0.0f};
    oracle_random r = oracle_seed(70);
    double worst = 0.0;
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

/* More nodes never give a worse answer; as many as there are give the exact one; none gives the warm start alone. */
TEST(node_budgets)
{
    oracle_random r = oracle_seed(72);
    unit_mesh m = unit_soup(&r, 700, 100.0f, 0);
    uint32_t *triangles;
    smr_box_tree f = unit_plant(&m, &triangles);
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
}

/* Moving the mesh and refitting, a few leaves at a time, is the same as planting anew. */
TEST(refit_follows_the_mesh)
{
    oracle_random r = oracle_seed(74);
    unit_mesh m = unit_soup(&r, 333, 100.0f, 1);
    uint32_t *triangles;
    smr_box_tree f = unit_plant(&m, &triangles);
    double worst = 0.0;
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
}

/* A forged model's positions can come to be no numbers, or lie where empty boxes do: the search stays in the tree. */
TEST(points_that_are_nowhere)
{
    const float nowhere[] = {NAN, -NAN, INFINITY, -INFINITY, SMR_FAR, -SMR_FAR, FLT_MAX, 1.0e9f};
    smr_box_tree f;
    memset(&f, 0, sizeof f);
    smr_tree_shape(&f, 262145u); /* most children of its top nodes are empty */
    const size_t n_nodes = smr_tree_nodes(f.n_triangles), nt = f.n_triangles;
    smr_node *node = rig_rough(n_nodes * sizeof *node);
    float *normal = rig_rough(12u * nt), xyz[3] = {0, 0, 0};
    uint32_t *triangle = rig_rough(12u * nt);
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
        smr_query group[2] = {{smr_v(500, 0, 0), smr_v(0, 0, 0), -2.0f, 100000u, SMR_NONE}, q};
        smr_hit found[2] = {hit, hit};
        smr_closest_group(&f, NULL, group, 2, found);
        assert_true(found[0].triangle == SMR_NONE && found[1].triangle == SMR_NONE);
    }
}
