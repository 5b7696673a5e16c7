/* test_order_l_forest.c: cluster sums along the forest, along the paper's order L and summed directly have the same
 * bits, for random 32-bit records that wrap around.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <string.h>
#include "unit_lists.h"

/* Direct sums by looking at every pair, in stored order of this image. */
static void direct_sums(const smr_model *m, const unit_rule *rule, const uint32_t *record, uint32_t *sum)
{
    const uint32_t n = smr_le32(m->n_vertices);
    unsigned char *member = rig_rough((size_t)n * n);
    unit_brute_sets(m, rule, member);
    for (uint32_t a = 0; a < n; a++) {
        sum[a] = 0;
        for (uint32_t b = 0; b < n; b++)
            sum[a] += member[(size_t)a * n + b] ? record[b] : 0u;
    }
    rig_free(member);
}

/* All configurations of one model give the same sums for every radius. */
static void check_all(const smr_structure *structures, uint32_t n_structures, int geodesic)
{
    static const uint32_t blocks[] = {0, 16, 17, 65536};
    oracle_random r = oracle_seed(140);
    smr_prepare_config c = smr_prepare_config_default();
    c.distance = geodesic ? SMR_DISTANCE_GEODESIC : SMR_DISTANCE_EUCLIDEAN;
    c.n_radii = 3;
    c.radius_mm[0] = 40.0f;
    c.radius_mm[1] = 15.0f;
    c.radius_mm[2] = 6.0f;
    for (uint32_t i = 0; i < 4u; i++) {
        uint32_t *record = NULL, *want[3] = {NULL, NULL, NULL};
        c.ring = i & 1u;
        c.separate_below_mm = i & 2u ? 20.0f : 0.0f;
        for (uint32_t k = 0; k < 5u; k++) {
            c.order = k == 4u ? SMR_ORDER_BREADTH_FIRST : SMR_ORDER_FOREST;
            c.block_vertices = k == 4u ? 0u : blocks[k];
            unit_image image = unit_prepare(structures, n_structures, &c);
            const uint32_t n = smr_le32(image.model->n_vertices);
            smr_model_info info;
            assert_int_equal(smr_model_get_info(image.model, &info), SMR_OK);
            assert_int_equal(info.order, c.order);
            if (k == 0u)
                record = unit_records(&r, n);
            uint32_t *sum = rig_rough(4u * (size_t)n);
            for (uint32_t q = 0; q < 3u; q++) {
                unit_chain_sums(image.model, q, record, sum);
                if (k == 0u) {
                    const unit_rule rule = {info.radius_mm[q], geodesic, (int)info.separate[q],
                                            c.ring && info.radius_mm[q] >= info.edge_mm};
                    want[q] = rig_rough(4u * (size_t)n);
                    direct_sums(image.model, &rule, record, want[q]);
                }
                assert_memory_equal(sum, want[q], 4u * (size_t)n);
            }
            rig_free(sum);
            unit_image_free(&image);
        }
        rig_free(record);
        for (uint32_t q = 0; q < 3u; q++)
            rig_free(want[q]);
    }
}

/* Lists store what parents do not share: a third of a large cluster, and of a forest less than breadth first. */
TEST(parents_save_indexes)
{
    unit_mesh ball = unit_sphere(4, 40.0f, 0.0f);
    float stored[2];
    for (uint32_t order = 0; order < 2u; order++) {
        smr_prepare_config c = rig_radii(1, 25, 0, 0);
        smr_model_info info;
        c.order = order == 0u ? SMR_ORDER_FOREST : SMR_ORDER_BREADTH_FIRST;
        c.block_vertices = 65536;
        unit_image image = unit_prepare_mesh(&ball, &c);
        assert_int_equal(smr_model_get_info(image.model, &info), SMR_OK);
        stored[order] = info.indexes_per_cluster[0] / info.direct_per_cluster[0];
        unit_image_free(&image);
    }
    assert_true(stored[0] < 0.25f && stored[1] < 0.35f && stored[0] < stored[1]);
}

TEST(forest_breadth_and_direct_agree)
{
    oracle_random r = oracle_seed(141);
    for (uint32_t i = 0; i < 3u; i++) {
        unit_mesh a = i == 0u ? unit_sphere(2, 25.0f, 20.0f) : unit_points(&r, 90u + 77u * i, 0.0f, 60.0f);
        unit_mesh b = unit_soup(&r, 60u + 30u * i, 50.0f, (int)(i % 2u));
        const smr_structure two[2] = {{"a", unit_view(&a)}, {"b", unit_view(&b)}};
        check_all(two, 2, 0);
        if (i < 2u)
            check_all(two, 2, 1);
        unit_mesh_free(&a);
        unit_mesh_free(&b);
    }
}
