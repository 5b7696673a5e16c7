/* test_clusters_geodesic.c: geodesic clusters equal shortest paths over edges from another algorithm, and are
 * symmetric.
 * SPDX-License-Identifier: MIT */
#include "cmocka_first.h"

#include <string.h>

#include "unit_lists.h"

static void check(const smr_structure *structures, uint32_t n_structures, smr_prepare_config *c)
{
    c->distance = SMR_DISTANCE_GEODESIC;
    unit_image image = unit_prepare(structures, n_structures, c);
    const uint32_t n = smr_le32(image.model->n_vertices);
    unsigned char *got = unit_memory((size_t)n * n), *want = unit_memory((size_t)n * n);
    smr_model_info info;
    assert_int_equal(smr_model_get_info(image.model, &info), SMR_OK);
    for (uint32_t k = 0; k < info.n_radii; k++) {
        const unit_rule rule = {info.radius_mm[k], 1, (int)info.separate[k],
                                c->ring && info.radius_mm[k] >= info.edge_mm};
        assert_true(unit_chain_sets(image.model, k, got));
        for (uint32_t a = 0; a < n; a++)
            for (uint32_t b = 0; b < a; b++)
                assert_int_equal(got[(size_t)a * n + b], got[(size_t)b * n + a]);
        unit_brute_sets(image.model, &rule, want);
        assert_memory_equal(got, want, (size_t)n * n);
    }
    unit_free(got);
    unit_free(want);
    unit_image_free(&image);
}

static void equals_shortest_paths(void **state)
{
    oracle_random r = oracle_seed(130);
    unit_mesh m[4] = {unit_sphere(2, 30.0f, 5.0f), unit_grid(9, 7, 3.0f), unit_soup(&r, 120, 40.0f, 1),
                      unit_soup(&r, 40, 40.0f, 0)};
    (void)state;
    for (uint32_t i = 0; i < 8u; i++) {
        const smr_structure one = {"m", unit_view(&m[i % 4u])};
        smr_prepare_config c = smr_prepare_config_default();
        c.n_radii = 3;
        c.radius_mm[0] = 45.0f;
        c.radius_mm[1] = 14.0f;
        c.radius_mm[2] = 0.4f;
        c.ring = i % 3u == 0u;
        c.order = i / 4u;
        c.block_vertices = i % 2u ? 16u : 0u;
        check(&one, 1, &c);
    }
    for (int i = 0; i < 4; i++)
        unit_mesh_free(&m[i]);
}

/* A flat lattice and a radius of whole edges: paths as long as the radius are in. */
static void exact_ties_are_in(void **state)
{
    unit_mesh m = unit_grid(6, 5, 2.0f);
    smr_prepare_config c = smr_prepare_config_default();
    (void)state;
    for (uint32_t i = 0; i < m.nv; i++)
        m.xyz[3u * i + 2u] = 0.0f;
    const smr_structure one = {"m", unit_view(&m)};
    c.n_radii = 2;
    c.radius_mm[0] = 6.0f;
    c.radius_mm[1] = 2.0f;
    c.ring = 0;
    check(&one, 1, &c);
    unit_mesh_free(&m);
}

/* The two shores of a slit are near in space and far along the surface: only the geodesic tells them apart. */
static void does_not_jump_a_slit(void **state)
{
    unit_mesh a = unit_grid(6, 3, 2.0f), b = unit_grid(6, 3, 2.0f);
    smr_prepare_config c = smr_prepare_config_default();
    (void)state;
    for (uint32_t i = 0; i < b.nv; i++)
        b.xyz[3u * i + 2u] += 0.25f;
    const smr_structure two[2] = {{"a", unit_view(&a)}, {"b", unit_view(&b)}};
    c.n_radii = 1;
    c.radius_mm[0] = 5.0f;
    c.separate_below_mm = 0.0f;
    check(two, 2, &c);
    unit_image image = unit_prepare(two, 2, &c);
    const uint32_t n = smr_le32(image.model->n_vertices);
    unsigned char *got = unit_memory((size_t)n * n);
    assert_true(unit_chain_sets(image.model, 0, got));
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t k = 0; k < n; k++)
            assert_true(!got[(size_t)i * n + k] || smr_model_owner(image.model, i) == smr_model_owner(image.model, k));
    unit_free(got);
    unit_image_free(&image);
    unit_mesh_free(&a);
    unit_mesh_free(&b);
}

static void points_without_edges_are_alone(void **state)
{
    oracle_random r = oracle_seed(131);
    unit_mesh m = unit_points(&r, 50, 0.0f, 5.0f);
    smr_prepare_config c = smr_prepare_config_default();
    const smr_structure one = {"m", unit_view(&m)};
    (void)state;
    c.n_radii = 1;
    c.radius_mm[0] = SMR_COORD_MAX;
    check(&one, 1, &c);
    unit_mesh_free(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(equals_shortest_paths),
        cmocka_unit_test(exact_ties_are_in),
        cmocka_unit_test(does_not_jump_a_slit),
        cmocka_unit_test(points_without_edges_are_alone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
