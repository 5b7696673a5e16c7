/* test_hilbert_curve.c: the Hilbert curve and the stable sort by it.
 * SPDX-License-Identifier: MIT */
#include "cmocka_first.h"

#include <math.h>
#include <stdlib.h>

#include "geometry/box_tree/hilbert_curve.h"
#include "oracle.h"
#include "unit_mesh.h"

static const smr_box cube = {{0, 0, 0}, {1024, 1024, 1024}};

/* Aligned sub-cubes of 16 cells a side: each is one run of keys, and successive keys are neighbouring cells. */
static void successive_keys_are_neighbours(void **state)
{
    enum { SIDE = 16, CELLS = SIDE * SIDE * SIDE };
    static int cell[CELLS];
    oracle_random r = oracle_seed(50);
    (void)state;
    for (uint32_t round = 0; round < 60u; round++) {
        uint32_t at[3];
        for (int k = 0; k < 3; k++)
            at[k] = round == 0 ? 0u : (round == 1 ? 1008u : oracle_below(&r, 64u) * SIDE);
        for (int i = 0; i < CELLS; i++)
            cell[i] = -1;
        uint32_t base = UINT32_MAX;
        for (int i = 0; i < CELLS; i++) {
            const smr_vec p =
                smr_v((float)at[0] + (float)(i % SIDE) + 0.5f, (float)at[1] + (float)(i / SIDE % SIDE) + 0.5f,
                      (float)at[2] + (float)(i / SIDE / SIDE) + 0.5f);
            const uint32_t key = smr_curve_key(cube, p);
            assert_true(key < 1u << 30);
            if (base == UINT32_MAX)
                base = key / CELLS;
            assert_int_equal(key / CELLS, base);
            assert_int_equal(cell[key % CELLS], -1); /* each key once */
            cell[key % CELLS] = i;
        }
        for (int k = 1; k < CELLS; k++) {
            const int a = cell[k - 1], b = cell[k];
            assert_int_equal(abs(a % SIDE - b % SIDE) + abs(a / SIDE % SIDE - b / SIDE % SIDE) +
                                 abs(a / SIDE / SIDE - b / SIDE / SIDE),
                             1);
        }
    }
}

/* The ends of neighbouring sub-cubes meet too: the whole of a coarse 32^3 curve is one walk. */
static void coarse_curve_is_one_walk(void **state)
{
    enum { SIDE = 32, CELLS = SIDE * SIDE * SIDE };
    static int cell[CELLS];
    (void)state;
    for (int i = 0; i < CELLS; i++) {
        const smr_vec p = smr_v(32.0f * (float)(i % SIDE) + 16.0f, 32.0f * (float)(i / SIDE % SIDE) + 16.0f,
                                32.0f * (float)(i / SIDE / SIDE) + 16.0f);
        cell[smr_curve_key(cube, p) >> 15] = i;
    }
    for (int k = 1; k < CELLS; k++) {
        const int a = cell[k - 1], b = cell[k];
        assert_int_equal(abs(a % SIDE - b % SIDE) + abs(a / SIDE % SIDE - b / SIDE % SIDE) +
                             abs(a / SIDE / SIDE - b / SIDE / SIDE),
                         1);
    }
}

/* Boxes of no size, of denormal size, flat ones, and points outside: always a key, never undefined. */
static void odd_boxes(void **state)
{
    static const float sizes[] = {0.0f, 1e-45f, 1e-38f, 1e-10f, 1.0f, 2e5f};
    static const float at[] = {0.0f, -1e5f, 1e5f, 3.0f, 1e9f, -1e9f};
    (void)state;
    for (size_t i = 0; i < 6u; i++)
        for (size_t k = 0; k < 6u; k++) {
            const smr_box box = {{0, 0, 0}, {sizes[i], k % 2u ? sizes[i] : 0.0f, 0}};
            assert_true(smr_curve_key(box, smr_v(at[k], at[(k + 1u) % 6u], at[(k + 2u) % 6u])) < 1u << 30);
        }
}

static void box_holds_everything(void **state)
{
    oracle_random r = oracle_seed(51);
    unit_mesh m = unit_points(&r, 1000, -30.0f, 77.0f);
    (void)state;
    const smr_box b = smr_box_of(m.xyz, m.nv);
    const float lo[3] = {b.lo.x, b.lo.y, b.lo.z}, hi[3] = {b.hi.x, b.hi.y, b.hi.z};
    for (uint32_t c = 0; c < 3u; c++) {
        int low = 0, high = 0;
        for (uint32_t i = 0; i < m.nv; i++) {
            const float v = m.xyz[3u * i + c];
            assert_true(v >= lo[c] && v <= hi[c]);
            low |= v == lo[c];
            high |= v == hi[c];
        }
        assert_true(low && high);
    }
    unit_mesh_free(&m);
}

static void sorts_stable(void **state)
{
    oracle_random r = oracle_seed(52);
    (void)state;
    for (uint32_t n = 0; n < 3000u; n = n < 20u ? n + 1u : n * 2u + 1u) {
        uint32_t *key = unit_memory(4u * (size_t)n), *item = unit_memory(4u * (size_t)n);
        uint32_t *tmp = unit_memory(8u * (size_t)n);
        uint64_t sum = 0, sorted_sum = 0;
        for (uint32_t i = 0; i < n; i++) {
            key[i] = n % 2u ? oracle_below(&r, 7u) * 0x10204081u : oracle_next(&r);
            item[i] = i;
            sum += key[i];
        }
        uint32_t *was = unit_memory(4u * (size_t)n);
        memcpy(was, key, 4u * (size_t)n);
        smr_curve_sort(key, item, tmp, n);
        for (uint32_t i = 0; i < n; i++) {
            assert_int_equal(key[i], was[item[i]]); /* items stay with their keys */
            sorted_sum += key[i];
            if (i > 0u)
                assert_true(key[i - 1u] < key[i] || (key[i - 1u] == key[i] && item[i - 1u] < item[i]));
        }
        assert_true(sum == sorted_sum);
        unit_free(key);
        unit_free(item);
        unit_free(tmp);
        unit_free(was);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(successive_keys_are_neighbours),
        cmocka_unit_test(coarse_curve_is_one_walk),
        cmocka_unit_test(odd_boxes),
        cmocka_unit_test(box_holds_everything),
        cmocka_unit_test(sorts_stable),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
