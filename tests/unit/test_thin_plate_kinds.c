/* test_thin_plate_kinds.c: landmark warps of sets that determine no spline, with unusual numbers, wrong calls, and
 * too little memory.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include <string.h>
#include "unit_mesh.h"
#include "unit_warp.h"

enum { GUARD = 256 };

/* Random landmarks of rank 0..3 (a place, a line, a plane, space), moved by a similarity with this scale. */
static unit_landmarks flat_set(oracle_random *r, uint32_t n, int rank, double scale, unit_affine *map)
{
    unit_landmarks s;
    double turn[9];
    memset(&s, 0, sizeof s);
    s.n = n;
    oracle_rotation(r, turn);
    oracle_rotation(r, map->m);
    for (int i = 0; i < 9; i++)
        map->m[i] *= scale;
    for (int c = 0; c < 3; c++)
        map->t[c] = oracle_uniform(r, -200, 200);
    for (uint32_t i = 0; i < n; i++) {
        double q[3] = {0, 0, 0};
        for (int c = 0; c < rank; c++) /* the first three are well apart */
            q[c] = i < 3u ? (i == (uint32_t)c ? 250.0 : -100.0) : oracle_uniform(r, -300, 300);
        if (rank == 1)
            q[0] = 40.0 * (double)i;
        for (int c = 0; c < 3; c++)
            s.from[3 * i + (uint32_t)c] =
                (float)(turn[3 * c] * q[0] + turn[3 * c + 1] * q[1] + turn[3 * c + 2] * q[2] + 30.0 * (double)c);
        unit_affine_carry(map, s.from + 3 * i, s.to + 3 * i);
    }
    return s;
}

TEST(weaker_sets_get_weaker_kinds)
{
    oracle_random r = oracle_seed(307);
    double worst = 0.0, solid = 0.0;
    for (uint32_t k = 0; k < 800u; k++) {
        const uint32_t n = 1u + k % 12u;
        const int rank = (int)(k / 12u % 3u);
        unit_affine map;
        uint32_t kind, expected = SMR_WARP_RIGID;
        if (n == 1u || rank == 0)
            expected = SMR_WARP_TRANSLATION;
        else if (rank == 2 && n >= 3u)
            expected = SMR_WARP_SCALED;
        const unit_landmarks s = flat_set(&r, n, rank, expected == SMR_WARP_SCALED ? 1.3 : 1.0, &map);
        smr_warp *w = unit_warp_fit(&s, k % 2u ? 7.0f : 0.0f, &kind);
        assert_int_equal(kind, expected);
        worst = fmax(worst, unit_warp_miss(w, &s));
        float p[3], q[3], a[3], b[3];
        for (int c = 0; c < 3; c++) {
            p[c] = a[c] = oracle_uniformf(&r, -300, 300);
            q[c] = b[c] = oracle_uniformf(&r, -300, 300);
        }
        assert_int_equal(smr_warp_apply(w, a, 1), SMR_OK);
        assert_int_equal(smr_warp_apply(w, b, 1), SMR_OK);
        const double size = expected == SMR_WARP_SCALED ? 1.3 : 1.0;
        solid = fmax(solid, fabs(unit_apart(a, b) - size * unit_apart(p, q)));
        if (expected == SMR_WARP_SCALED) { /* a plane fixes the whole map */
            float e[3];
            unit_affine_carry(&map, p, e);
            worst = fmax(worst, unit_apart(a, e));
        }
        rig_free(w);
    }
    assert_true(oracle_within("warp: weaker kinds at exact landmarks", worst, 5e-3));
    assert_true(oracle_within("warp: weaker kinds keep shape", solid, 5e-3));
}

/* Goals in one place: a plane or a line would collapse, so it keeps its size; a full set goes where it is told. */
TEST(collapsed_goals)
{
    oracle_random r = oracle_seed(312);
    for (int rank = 1; rank <= 3; rank++) {
        unit_affine map;
        uint32_t kind;
        unit_landmarks s = flat_set(&r, 8, rank, 1.0, &map);
        for (uint32_t i = 0; i < 3u * s.n; i++)
            s.to[i] = 10.0f * (float)(i % 3u);
        smr_warp *w = unit_warp_fit(&s, 0.0f, &kind);
        assert_int_equal(kind, rank == 3 ? SMR_WARP_SPLINE : SMR_WARP_TRANSLATION);
        float a[] = {0, 0, 0}, b[] = {100, 0, 0};
        assert_int_equal(smr_warp_apply(w, a, 1), SMR_OK);
        assert_int_equal(smr_warp_apply(w, b, 1), SMR_OK);
        assert_true(fabs(unit_apart(a, b) - (rank == 3 ? 0.0 : 100.0)) < 1e-3);
        rig_free(w);
    }
}

/* Nothing legal makes a number that is not finite: tiny, huge, far, thin and collapsed sets. */
TEST(odd_sets_stay_finite)
{
    static const float size[] = {0.0f, 1e-38f, 1e-20f, 1e-6f, 1e-4f, 1e-3f, 1.0f, 1e3f, 1e5f};
    oracle_random r = oracle_seed(308);
    for (uint32_t k = 0; k < 6000u; k++) {
        unit_landmarks s;
        uint32_t kind;
        memset(&s, 0, sizeof s);
        s.n = 1u + oracle_below(&r, k % 10u ? 9u : SMR_LANDMARKS_MAX);
        float a[3], b[3];
        for (int c = 0; c < 3; c++) {
            a[c] = size[oracle_below(&r, 9)];
            b[c] = size[oracle_below(&r, 9)];
        }
        for (uint32_t i = 0; i < 3u * s.n; i++) {
            s.from[i] = a[i % 3u] * oracle_uniformf(&r, -1, 1);
            s.to[i] = b[i % 3u] * oracle_uniformf(&r, -1, 1);
        }
        smr_warp *w = unit_warp_fit(&s, k % 3u ? 0.0f : size[oracle_below(&r, 9)], &kind);
        assert_true(kind <= SMR_WARP_TRANSLATION);
        float p[] = {0, 0, 0, 1e5f, 1e5f, 1e5f, -1e5f, 3, 1e-30f};
        assert_int_equal(smr_warp_apply(w, p, 3), SMR_OK);
        assert_true(unit_finite(p, 9, 1e30f));
        assert_int_equal(smr_warp_apply(w, s.from, s.n), SMR_OK);
        assert_true(unit_finite(s.from, 3u * (size_t)s.n, 1e30f));
        rig_free(w);
    }
}

/* ---------------------------------------------------------------- border */

TEST(refuses_and_leaves_alone)
{
    static const float bad[] = {NAN, INFINITY, -INFINITY, 1.1e5f, -1.1e5f};
    oracle_random r = oracle_seed(309);
    unit_landmarks s = unit_warp_random(&r, 9, 0.0, 10.0);
    size_t bytes = 0;
    assert_int_equal(smr_warp_bytes(s.n, &bytes), SMR_OK);
    unsigned char *memory = rig_rough(bytes + SMR_ALIGN);
    smr_warp *const mark = (smr_warp *)(void *)&s, *w = mark;
    uint32_t kind = 77u;
    assert_int_equal(smr_warp_fit(s.from, s.to, s.n, 0, NULL, bytes, &w, &kind), SMR_E_NULL);
    assert_int_equal(smr_warp_fit(NULL, s.to, s.n, 0, memory, bytes, &w, &kind), SMR_E_NULL);
    assert_int_equal(smr_warp_fit(s.from, NULL, s.n, 0, memory, bytes, &w, &kind), SMR_E_NULL);
    assert_int_equal(smr_warp_fit(s.from, s.to, s.n, 0, memory, bytes, NULL, &kind), SMR_E_NULL);
    assert_int_equal(smr_warp_fit(s.from, s.to, s.n, 0, memory, bytes, &w, NULL), SMR_E_NULL);
    for (size_t off = 1; off < SMR_ALIGN; off++)
        assert_int_equal(smr_warp_fit(s.from, s.to, s.n, 0, memory + off, bytes, &w, &kind), SMR_E_ALIGN);
    assert_int_equal(smr_warp_fit(s.from, s.to, s.n, 0, memory, bytes - 1u, &w, &kind), SMR_E_ARENA);
    assert_int_equal(smr_warp_fit(s.from, s.to, s.n, 0, memory, 0, &w, &kind), SMR_E_ARENA);
    assert_int_equal(smr_warp_fit(s.from, s.to, 0, 0, memory, bytes, &w, &kind), SMR_E_INPUT);
    assert_int_equal(smr_warp_fit(s.from, s.to, SMR_LANDMARKS_MAX + 1u, 0, memory, bytes, &w, &kind), SMR_E_INPUT);
    assert_int_equal(smr_warp_fit(s.from, s.to, s.n, -1e-9f, memory, bytes, &w, &kind), SMR_E_INPUT);
    assert_int_equal(smr_warp_fit(s.from, s.to, s.n, NAN, memory, bytes, &w, &kind), SMR_E_INPUT);
    assert_int_equal(smr_warp_fit(s.from, s.to, s.n, INFINITY, memory, bytes, &w, &kind), SMR_E_INPUT);
    for (uint32_t i = 0; i < 5u; i++) {
        unit_landmarks t = s;
        t.from[3u * s.n - 1u] = bad[i];
        assert_int_equal(smr_warp_fit(t.from, t.to, t.n, 0, memory, bytes, &w, &kind), SMR_E_INPUT);
        t = s;
        t.to[i] = bad[i];
        assert_int_equal(smr_warp_fit(t.from, t.to, t.n, 0, memory, bytes, &w, &kind), SMR_E_INPUT);
    }
    assert_ptr_equal(w, mark);
    assert_int_equal(kind, 77);
    for (size_t i = 0; i < bytes + SMR_ALIGN; i++)
        assert_int_equal(memory[i], 0xa5);
    float p[] = {1, 2, 3, 4, 5, 6};
    assert_int_equal(smr_warp_fit(s.from, s.to, s.n, 0, memory, bytes, &w, &kind), SMR_OK);
    assert_int_equal(smr_warp_fit(s.from, s.to, s.n, 0, memory, bytes, &w, &kind), SMR_OK); /* the same memory again */
    assert_int_equal(smr_warp_apply(NULL, p, 2), SMR_E_NULL);
    assert_int_equal(smr_warp_apply(w, NULL, 2), SMR_E_NULL);
    for (uint32_t i = 0; i < 5u; i++) {
        p[5] = bad[i];
        assert_int_equal(smr_warp_apply(w, p, 2), SMR_E_INPUT);
    }
    assert_int_equal(smr_warp_apply(w, p, 0), SMR_OK);
    for (int i = 0; i < 5; i++)
        assert_true(p[i] == (float)(i + 1));
    memset(memory, 0, sizeof(uint32_t)); /* no longer a warp */
    assert_int_equal(smr_warp_apply(w, p, 1), SMR_E_STATE);
}

TEST(memory_is_exact)
{
    oracle_random r = oracle_seed(310);
    size_t bytes = 77;
    assert_int_equal(smr_warp_bytes(0, &bytes), SMR_E_INPUT);
    assert_int_equal(smr_warp_bytes(SMR_LANDMARKS_MAX + 1u, &bytes), SMR_E_INPUT);
    assert_int_equal(smr_warp_bytes(UINT32_MAX, &bytes), SMR_E_INPUT);
    assert_int_equal(smr_warp_bytes(1, NULL), SMR_E_NULL);
    assert_int_equal(bytes, 77);
    for (uint32_t n = 1; n <= SMR_LANDMARKS_MAX; n++) {
        const unit_landmarks s = unit_warp_random(&r, n, 0.0, 10.0);
        assert_int_equal(smr_warp_bytes(n, &bytes), SMR_OK);
        unsigned char *memory = rig_rough(bytes + 2u * GUARD);
        smr_warp *w = NULL;
        uint32_t kind;
        assert_true(bytes > 0u && bytes % SMR_ALIGN == 0u && bytes < 65536u);
        assert_int_equal(smr_warp_fit(s.from, s.to, n, 1.0f, memory + GUARD, bytes, &w, &kind), SMR_OK);
        for (size_t i = 0; i < GUARD; i++) {
            assert_int_equal(memory[i], 0xa5);
            assert_int_equal(memory[GUARD + bytes + i], 0xa5);
        }
        rig_free(memory);
    }
}
