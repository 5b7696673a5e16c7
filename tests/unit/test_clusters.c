/* test_clusters.c: clusters in a model equal the sets found by testing every pair of vertices: Euclidean and along
 * edges, shared and separate, with and without mesh neighbours, for meshes and for points with exact ties.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include <string.h>
#include "registration/registration.h"
#include "unit_lists.h"
#include "unit_save.h"

/* Compares every radius of the image with brute force. */
static void check_image(const unit_image *image, int geodesic, int ring)
{
    const uint32_t n = smr_le32(image->model->n_vertices);
    unsigned char *got = rig_rough((size_t)n * n), *want = rig_rough((size_t)n * n);
    smr_model_info info;
    assert_int_equal(smr_model_get_info(image->model, &info), SMR_OK);
    for (uint32_t k = 0; k < info.n_radii; k++) {
        const unit_rule rule = {info.radius_mm[k], geodesic, (int)info.separate[k],
                                ring && info.radius_mm[k] >= info.edge_mm};
        unit_brute_sets(image->model, &rule, want);
        assert_true(unit_chain_sets(image->model, k, got));
        assert_memory_equal(got, want, (size_t)n * n);
        uint64_t members = 0;
        uint32_t largest = 0, smallest = SMR_ALL;
        for (uint32_t a = 0; a < n; a++) {
            uint32_t count = 0;
            assert_int_equal(want[(size_t)a * n + a], 1); /* a vertex is in its own cluster */
            for (uint32_t b = 0; b < n; b++)
                count += want[(size_t)a * n + b];
            members += count;
            largest = count > largest ? count : largest;
            smallest = count < smallest ? count : smallest;
        }
        assert_int_equal(info.largest_cluster[k], largest);
        assert_int_equal(info.smallest_cluster[k], smallest);
        assert_true(info.direct_per_cluster[k] > (float)members / (float)n - 0.01f &&
                    info.direct_per_cluster[k] < (float)members / (float)n + 0.01f);
    }
    rig_free(got);
    rig_free(want);
}

/* Returns a number whose sums tell sets of vertices apart. */
static uint64_t mark(uint32_t v) { return (v + 1u) * (uint64_t)0x9e3779b97f4a7c15u; }

/* Compares the marks' sums along the order L with sums over the first `members` stored vertices within the radius. */
static void check_coarse(const smr_model *m, uint32_t radius)
{
    const smr_lists l = smr_model_lists(m, radius);
    uint64_t *sum = rig_rough(8u * (size_t)l.n);
    for (uint32_t b = 0, at = 0; b < l.n_blocks; b++) {
        const uint32_t first = smr_le32(l.block[b].first), last = smr_le32(l.block[b + 1u].first);
        for (uint32_t e = first; e < last; e++) {
            uint32_t field[4];
            for (uint32_t i = 0; i < 4u; i++)
                field[i] = smr_index_at(l.entry, l.index_bytes, 4u * (size_t)e + i);
            const uint32_t parent = smr_index_at(l.entry, l.index_bytes, 4u * (size_t)(first + field[1]));
            sum[field[0]] = field[1] == e - first ? 0u : sum[parent];
            for (uint32_t i = 0; i < field[2] + field[3]; i++, at++) {
                const uint32_t v = smr_index_at(l.index, l.index_bytes, at);
                assert_true(v < l.members);
                sum[field[0]] += i < field[2] ? mark(v) : 0u - mark(v);
            }
        }
    }
    const uint32_t *const rest = smr_at(m, m->at_rest);
    for (uint32_t a = 0; a < l.n; a += rig_times(20) < 20u ? 37u : 1u) {
        uint32_t count = 0;
        for (uint32_t v = 0; v < l.members; v++) {
            float d2 = 0.0f;
            for (uint32_t i = 0; i < 3u; i++) {
                const float d = smr_le_float(rest[3u * v + i]) - smr_le_float(rest[3u * a + i]);
                d2 += d * d;
            }
            count += d2 <= l.radius * l.radius;
            sum[a] -= d2 <= l.radius * l.radius ? mark(v) : 0u;
        }
        assert_int_equal(count, smr_list_count(&l, a));
        assert_true(sum[a] == 0u && count >= 3u);
    }
    rig_free(sum);
}

/* Dynamics needs a last radius whose clusters hold all vertices. */
static void moves_all_vertices(const smr_model *model, uint32_t coarse)
{
    smr_config config = smr_config_default();
    size_t bytes;
    config.dynamics.mode = SMR_DYNAMICS_ON;
    for (config.schedule.radius_last = coarse - 1u; config.schedule.radius_last <= coarse;
         config.schedule.radius_last++)
        assert_int_equal(config.schedule.radius_last < coarse ? SMR_E_CONFIG : SMR_OK,
                         smr_arena_bytes(model, &config, &bytes));
}

/* A save in which more vertices are active than the clusters of the radius hold. */
static void refuses_too_many(const smr_model *model)
{
    const smr_config config = smr_config_default();
    size_t bytes, needed;
    smr *s = rig_init(model, &config, NULL), *again = NULL;
    assert_int_equal(SMR_OK,
                     smr_tick(s, 0, NULL) + smr_save_bytes(s, &bytes) + smr_arena_bytes(model, &config, &needed));
    unsigned char *const saved = rig_alloc(bytes), *const arena = rig_alloc(needed);
    assert_int_equal(SMR_OK, smr_save(s, saved, bytes));
    const smr_schedule *p = &s->schedule;
    const uint32_t words[] = {p->n_active, p->n_active_chosen, p->n_set, p->serial}, more = p->lists.members + 1u;
    memcpy(unit_save_find(saved, words, sizeof words), &more, sizeof more);
    unit_save_seal(saved, bytes);
    assert_int_equal(SMR_E_SAVE, smr_restore(model, NULL, NULL, saved, bytes, arena, needed, &again));
}

/* One cluster of so many vertices that weights in the usual unit would add up beyond what centres allow: it falls. */
static void falls(const unit_mesh *m)
{
    const smr_prepare_config one = rig_radii(1, 200, 0, 0);
    smr_config config = smr_config_default();
    unit_image image = unit_prepare_mesh(m, &one);
    config.dynamics.mode = SMR_DYNAMICS_ON;
    config.dynamics.gravity[2] = -9810.0f;
    smr *s = rig_init(image.model, &config, NULL);
    (void)rig_run(s, 2u * SMR_SWEEPS);
    const float *const x = rig_positions(s, image.model);
    for (uint32_t v = 0; v < m->nv; v++)
        assert_true(x[3u * v + 2u] < m->xyz[3u * v + 2u] && fabsf(x[3u * v] - m->xyz[3u * v]) < 1.0e-3f);
    unit_image_free(&image);
}

/* In a dense structure clusters of coarse radii hold the most important vertices only. */
TEST(dense_structures)
{
    unit_mesh m = unit_sphere(6, 60.0f, 0.0f);
    const smr_prepare_config c = smr_prepare_config_default();
    unit_image image = unit_prepare_mesh(&m, &c);
    const uint32_t coarse = smr_le32(image.model->coarse_radii);
    assert_in_range(coarse, 2, smr_le32(image.model->n_radii) - 3u);
    assert_true(smr_le32(image.model->coarse_vertices) < m.nv / 2u);
    for (uint32_t k = 0; k < coarse; k++)
        check_coarse(image.model, k);
    assert_int_equal(smr_model_lists(image.model, coarse).members, m.nv);
    moves_all_vertices(image.model, coarse);
    refuses_too_many(image.model);
    unit_image_free(&image);
    falls(&m);
    m.nt = 0; /* points may be anything */
    image = unit_prepare_mesh(&m, &c);
    assert_int_equal(0, smr_le32(image.model->coarse_radii));
    unit_image_free(&image);
    unit_mesh_free(&m);
}

/* On a lattice many distances equal the radius exactly: they are in. */
TEST(lattice_has_exact_ties)
{
    unit_mesh m = unit_mesh_new(6u * 6u * 6u, 0);
    smr_prepare_config c = smr_prepare_config_default();
    for (uint32_t i = 0; i < m.nv; i++) {
        m.xyz[3u * i] = 2.0f * (float)(i % 6u);
        m.xyz[3u * i + 1u] = 2.0f * (float)(i / 6u % 6u);
        m.xyz[3u * i + 2u] = 2.0f * (float)(i / 36u);
    }
    c.n_radii = 3;
    c.radius_mm[0] = 10.0f; /* 3-4-5 times 2 */
    c.radius_mm[1] = 6.0f;
    c.radius_mm[2] = 2.0f;
    unit_image image = unit_prepare_mesh(&m, &c);
    check_image(&image, 0, 1);
    smr_model_info info;
    assert_int_equal(smr_model_get_info(image.model, &info), SMR_OK);
    assert_int_equal(info.largest_cluster[2], 7);
    assert_int_equal(info.smallest_cluster[2], 4);
}

/* Two interleaved structures with triangles: all switches, both orders and distances. */
TEST(two_structures_all_switches)
{
    oracle_random r = oracle_seed(121);
    unit_mesh grid = unit_grid(11, 9, 4.0f), soup = unit_soup(&r, 70, 40.0f, 1);
    const smr_structure two[2] = {{"grid", unit_view(&grid)}, {"soup", unit_view(&soup)}};
    for (uint32_t i = 0; i < 32u; i += rig_times(20) < 20u ? 5u : 1u) {
        smr_prepare_config c = smr_prepare_config_default();
        c.n_radii = 4;
        c.radius_mm[0] = 30.0f;
        c.radius_mm[1] = 12.0f;
        c.radius_mm[2] = 9.0f;
        c.radius_mm[3] = 3.0f;
        c.ring = i & 1u;
        c.order = i >> 1 & 1u;
        c.mass = i >> 2 & 1u;
        c.distance = i >> 4 & 1u;
        c.separate_below_mm = i >> 3 & 1u ? 0.0f : 12.0f; /* 12 itself is shared still */
        c.block_vertices = i % 3u == 0u ? 16u : 0u;
        unit_image image = unit_prepare(two, 2, &c);
        smr_model_info info;
        assert_int_equal(smr_model_get_info(image.model, &info), SMR_OK);
        for (uint32_t k = 0; k < 4u; k++)
            assert_int_equal(info.separate[k], c.separate_below_mm > 0.0f && k >= 2u);
        check_image(&image, (int)c.distance, (int)c.ring);
        unit_image_free(&image);
    }
}
