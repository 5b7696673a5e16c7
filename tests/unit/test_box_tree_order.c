/* test_box_tree_order.c: the order of triangles for the box tree is a permutation, the same each time, and compact.
 * SPDX-License-Identifier: MIT */
#include "cmocka_first.h"

#include <math.h>
#include <string.h>

#include "geometry/surface/mesh.h"
#include "geometry/box_tree/box_tree.h"
#include "unit_mesh.h"

static uint32_t *order_of(const unit_mesh *m)
{
    const smr_mesh view = unit_view(m);
    uint32_t *order = unit_memory(4u * (size_t)m->nt), *key = unit_memory(4u * (size_t)m->nt);
    uint32_t *tmp = unit_memory(8u * (size_t)m->nt);
    float *centre = unit_memory(12u * (size_t)m->nt);
    smr_mesh_order(&view, order, centre, key, tmp);
    unit_free(key);
    unit_free(tmp);
    unit_free(centre);
    return order;
}

static void check_permutation(const uint32_t *order, uint32_t n)
{
    unsigned char *seen = unit_memory(n);
    memset(seen, 0, n);
    for (uint32_t i = 0; i < n; i++) {
        assert_true(order[i] < n && !seen[order[i]]);
        seen[order[i]] = 1;
    }
    unit_free(seen);
}

static void permutation_of_every_size(void **state)
{
    oracle_random r = oracle_seed(60);
    (void)state;
    for (uint32_t n = 1; n < 5000u; n = n < 140u ? n + 1u : n + n / 3u) {
        unit_mesh m = unit_soup(&r, n, 50.0f, (int)(n % 2u));
        uint32_t *order = order_of(&m), *again = order_of(&m);
        check_permutation(order, n);
        assert_memory_equal(order, again, 4u * (size_t)n);
        unit_free(order);
        unit_free(again);
        unit_mesh_free(&m);
    }
}

/* All triangles alike: every tie falls back to the caller's order, and nothing is lost. */
static void all_the_same(void **state)
{
    (void)state;
    for (uint32_t n = 1; n < 700u; n = n * 3u + 1u) {
        unit_mesh m = unit_mesh_new(3, n);
        memset(m.xyz, 0, 9u * sizeof(float));
        for (uint32_t i = 0; i < 3u * n; i++)
            m.triangles[i] = i % 3u;
        uint32_t *order = order_of(&m);
        check_permutation(order, n);
        unit_free(order);
        unit_mesh_free(&m);
    }
}

/* Sum over groups of `group` triangles in a row of the diagonal of their box. */
static double spread(const unit_mesh *m, const uint32_t *order, uint32_t group)
{
    double sum = 0.0;
    for (uint32_t from = 0; from < m->nt; from += group) {
        double lo[3] = {1e9, 1e9, 1e9}, hi[3] = {-1e9, -1e9, -1e9}, d2 = 0.0;
        for (uint32_t i = from; i < from + group && i < m->nt; i++)
            for (uint32_t k = 0; k < 9u; k++) {
                const double v = (double)m->xyz[3u * (size_t)m->triangles[3u * order[i] + k / 3u] + k % 3u];
                lo[k % 3u] = fmin(lo[k % 3u], v);
                hi[k % 3u] = fmax(hi[k % 3u], v);
            }
        for (int c = 0; c < 3; c++)
            d2 += (hi[c] - lo[c]) * (hi[c] - lo[c]);
        sum += sqrt(d2);
    }
    return sum;
}

/* On a sheet whose triangles come in random order: leaves of 8 triangles are 2 by 2 quads or so, nodes of 64 about
 * three times as wide. The ideal diagonal of a leaf is sqrt(8) steps; twice that is asked for. */
static void check_compact(uint32_t turn)
{
    oracle_random r = oracle_seed(61);
    unit_mesh m = unit_grid(32, 32, 1.0f);
    for (uint32_t i = 0; i < m.nv; i++) { /* the sheet in the xy, yz or zx plane */
        const float x = m.xyz[3u * i], y = m.xyz[3u * i + 1u];
        m.xyz[3u * i + turn] = x;
        m.xyz[3u * i + (turn + 1u) % 3u] = y;
        m.xyz[3u * i + (turn + 2u) % 3u] = 0.0f;
    }
    for (uint32_t i = 0; i < m.nt; i++) {
        uint32_t t[3];
        const uint32_t k = oracle_below(&r, m.nt);
        memcpy(t, m.triangles + 3u * i, sizeof t);
        memcpy(m.triangles + 3u * i, m.triangles + 3u * k, sizeof t);
        memcpy(m.triangles + 3u * k, t, sizeof t);
    }
    uint32_t *order = order_of(&m);
    assert_true(oracle_within("tree order: diagonal of a leaf, steps", spread(&m, order, 8) / (m.nt / 8.0), 5.7));
    assert_true(oracle_within("tree order: diagonal of a node of 64", spread(&m, order, 64) / (m.nt / 64.0), 12.0));
    unit_free(order);
    unit_mesh_free(&m);
}

static void nodes_are_compact(void **state)
{
    (void)state;
    for (uint32_t turn = 0; turn < 3u; turn++)
        check_compact(turn);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(permutation_of_every_size),
        cmocka_unit_test(all_the_same),
        cmocka_unit_test(nodes_are_compact),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
