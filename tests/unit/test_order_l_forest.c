/* test_order_l_forest.c: cluster sums along the forest, along the paper's order L and summed directly have the same
 * bits, for random 32-bit records that wrap around, with both index widths. The forest's zeta lists are as short as
 * possible.
 * SPDX-License-Identifier: MIT */
#include "cmocka_first.h"

#include <string.h>

#include "unit_lists.h"

/* Direct sums by looking at every pair, in stored order of this image. */
static void direct_sums(const smr_model *m, const unit_rule *rule, const uint32_t *record, uint32_t *sum)
{
    const uint32_t n = smr_le32(m->n_vertices);
    unsigned char *member = unit_memory((size_t)n * n);
    unit_brute_sets(m, rule, member);
    for (uint32_t a = 0; a < n; a++) {
        sum[a] = 0;
        for (uint32_t b = 0; b < n; b++)
            sum[a] += member[(size_t)a * n + b] ? record[b] : 0u;
    }
    unit_free(member);
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
            uint32_t *sum = unit_memory(4u * (size_t)n);
            for (uint32_t q = 0; q < 3u; q++) {
                unit_chain_sums(image.model, q, record, sum);
                if (k == 0u) {
                    const unit_rule rule = {info.radius_mm[q], geodesic, (int)info.separate[q],
                                            c.ring && info.radius_mm[q] >= info.edge_mm};
                    want[q] = unit_memory(4u * (size_t)n);
                    direct_sums(image.model, &rule, record, want[q]);
                }
                assert_memory_equal(sum, want[q], 4u * (size_t)n);
            }
            unit_free(sum);
            unit_image_free(&image);
        }
        unit_free(record);
        for (uint32_t q = 0; q < 3u; q++)
            unit_free(want[q]);
    }
}

static void forest_breadth_and_direct_agree(void **state)
{
    oracle_random r = oracle_seed(141);
    (void)state;
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

/* More than 65,535 vertices: indexes of 4 bytes. A lattice, so that neighbours are known without comparing all
 * pairs. */
static void wide_indexes(void **state)
{
    enum { SIDE = 41, N = SIDE * SIDE * SIDE }; /* 68,921 */
    oracle_random r = oracle_seed(142);
    unit_mesh m = unit_mesh_new(N, 0);
    smr_prepare_config c = smr_prepare_config_default();
    (void)state;
    for (uint32_t i = 0; i < N; i++) {
        m.xyz[3u * i] = 3.0f * (float)(i % SIDE);
        m.xyz[3u * i + 1u] = 3.0f * (float)(i / SIDE % SIDE);
        m.xyz[3u * i + 2u] = 3.0f * (float)(i / SIDE / SIDE);
    }
    c.n_radii = 1;
    c.radius_mm[0] = 3.5f; /* the six neighbours */
    c.block_vertices = 64; /* few rows: quick */
    const smr_structure one = {"lattice", unit_view(&m)};
    size_t scratch_bytes;
    assert_int_equal(smr_prepare_bytes(&one, 1, &c, &scratch_bytes), SMR_OK);
    void *scratch = unit_memory(scratch_bytes);
    unit_image image = {NULL, (size_t)16 << 20, NULL}; /* large enough at once: one pass */
    image.bytes = unit_memory(image.size);
    assert_int_equal(smr_prepare(&one, 1, &c, scratch, scratch_bytes, image.bytes, image.size, &image.size), SMR_OK);
    unit_free(scratch);
    assert_int_equal(smr_model_open(image.bytes, image.size, &image.model), SMR_OK);
    assert_int_equal(smr_le32(image.model->index_bytes), 4);
    uint32_t *record = unit_records(&r, N), *sum = unit_memory(4u * (size_t)N);
    unit_chain_sums(image.model, 0, record, sum);
    for (int i = 0; i < N; i++) {
        const int at[3] = {i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE};
        static const int stride[3] = {1, SIDE, SIDE * SIDE};
        uint32_t want = record[smr_model_position(image.model, (uint32_t)i)];
        for (int k = 0; k < 3; k++) {
            want += at[k] > 0 ? record[smr_model_position(image.model, (uint32_t)(i - stride[k]))] : 0u;
            want += at[k] < SIDE - 1 ? record[smr_model_position(image.model, (uint32_t)(i + stride[k]))] : 0u;
        }
        assert_int_equal(sum[smr_model_position(image.model, (uint32_t)i)], want);
    }
    unit_free(record);
    unit_free(sum);
    unit_image_free(&image);
    unit_mesh_free(&m);
}

/* Never longer than direct sums, nor than the paper's chain cut into nothing but seeds; a tree of one block is not
 * longer than many blocks' trees together. */
static void is_short(void **state)
{
    unit_mesh m = unit_bone(0);
    smr_prepare_config c = smr_prepare_config_default();
    smr_model_info one, many, chain;
    (void)state;
    c.n_radii = 2;
    c.radius_mm[0] = 60.0f;
    c.radius_mm[1] = 30.0f;
    c.block_vertices = 65536;
    unit_image image = unit_prepare_mesh(&m, &c);
    assert_int_equal(smr_model_get_info(image.model, &one), SMR_OK);
    unit_image_free(&image);
    c.block_vertices = 64;
    image = unit_prepare_mesh(&m, &c);
    assert_int_equal(smr_model_get_info(image.model, &many), SMR_OK);
    unit_image_free(&image);
    c.order = SMR_ORDER_BREADTH_FIRST;
    image = unit_prepare_mesh(&m, &c);
    assert_int_equal(smr_model_get_info(image.model, &chain), SMR_OK);
    unit_image_free(&image);
    for (uint32_t k = 0; k < 2u; k++) {
        assert_true(one.n_blocks[k] == 1u && chain.n_blocks[k] == 1u && many.n_blocks[k] > 1u);
        assert_true(one.indexes_per_cluster[k] <= many.indexes_per_cluster[k]);
        assert_true(many.indexes_per_cluster[k] < one.direct_per_cluster[k]);
        assert_true(one.indexes_per_cluster[k] <= 0.75f * chain.indexes_per_cluster[k]);
    }
    unit_mesh_free(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(forest_breadth_and_direct_agree),
        cmocka_unit_test(wide_indexes),
        cmocka_unit_test(is_short),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
