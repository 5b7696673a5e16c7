/* test_thin_plate_spline.c: thin-plate splines interpolate landmarks (1e-3 mm for bodies of 600 mm), reproduce affine
 * maps, repeat bit for bit, and agree with a spline in double precision.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include <string.h>
#include "geometry/linear_solve/thin_plate_solve.h"
#include "unit_mesh.h"
#include "unit_warp.h"

TEST(passes_through_landmarks)
{
    oracle_random r = oracle_seed(301);
    double worst = 0.0, large = 0.0;
    for (uint32_t n = 4; n <= SMR_LANDMARKS_MAX; n++)
        for (uint32_t k = 0; k < 6u; k++) {
            uint32_t kind;
            const unit_landmarks s = unit_warp_random(&r, n, k % 2u ? 400.0 : 0.0, k < 4u ? 60.0 : 200.0);
            smr_warp *w = unit_warp_fit(&s, 0.0f, &kind);
            if (n > 5u)
                assert_int_equal(kind, SMR_WARP_SPLINE);
            if (kind == SMR_WARP_SPLINE && k < 4u)
                worst = fmax(worst, unit_warp_miss(w, &s));
            else if (kind == SMR_WARP_SPLINE)
                large = fmax(large, unit_warp_miss(w, &s));
            rig_free(w);
        }
    assert_true(oracle_within("warp: landmarks, bent by 60 mm", worst, 1e-3));
    assert_true(oracle_within("warp: landmarks, bent by 200 mm", large, 2e-3));
}

TEST(agrees_with_double_precision)
{
    static const float smoothing[] = {0.0f, 0.1f, 5.0f, 300.0f, 1e5f};
    oracle_random r = oracle_seed(302);
    double worst = 0.0;
    oracle_spline *o = rig_rough(sizeof *o);
    for (uint32_t n = 6; n <= SMR_LANDMARKS_MAX; n += 2u)
        for (uint32_t k = 0; k < 5u; k++) {
            uint32_t kind;
            const unit_landmarks s = unit_warp_random(&r, n, 100.0, 40.0);
            smr_warp *w = unit_warp_fit(&s, smoothing[k], &kind);
            assert_int_equal(kind, SMR_WARP_SPLINE);
            oracle_spline_fit(o, &s, (double)smoothing[k]);
            for (uint32_t i = 0; i < 50u; i++) {
                float p[3], q[3];
                double e[3];
                for (int c = 0; c < 3; c++)
                    p[c] = q[c] = oracle_uniformf(&r, -350, 550);
                assert_int_equal(smr_warp_apply(w, q, 1), SMR_OK);
                oracle_spline_apply(o, p, e);
                for (int c = 0; c < 3; c++)
                    worst = fmax(worst, fabs((double)q[c] - e[c]));
            }
            rig_free(w);
        }
    assert_true(oracle_within("warp: against double precision", worst, 2e-3));
}

TEST(keeps_affine_maps)
{
    oracle_random r = oracle_seed(304);
    double worst = 0.0, same = 0.0;
    for (uint32_t k = 0; k < 120u; k++) {
        uint32_t kind;
        unit_landmarks s = unit_warp_random(&r, 6u + k % 59u, 0.0, 0.0);
        const unit_affine a = unit_warp_affine(&r);
        for (uint32_t i = 0; i < s.n; i++)
            if (k % 2u)
                unit_affine_carry(&a, s.from + 3 * i, s.to + 3 * i);
            else
                memcpy(s.to + 3 * i, s.from + 3 * i, 3 * sizeof(float));
        smr_warp *w = unit_warp_fit(&s, k % 4u < 2u ? 0.0f : 10.0f, &kind);
        assert_int_equal(kind, SMR_WARP_SPLINE);
        for (uint32_t i = 0; i < 50u; i++) {
            float p[3], q[3], e[3];
            for (int c = 0; c < 3; c++)
                p[c] = q[c] = e[c] = oracle_uniformf(&r, -600, 600);
            if (k % 2u)
                unit_affine_carry(&a, p, e);
            assert_int_equal(smr_warp_apply(w, q, 1), SMR_OK);
            if (k % 2u)
                worst = fmax(worst, unit_apart(q, e));
            else
                same = fmax(same, unit_apart(q, e));
        }
        rig_free(w);
    }
    assert_true(oracle_within("warp: identity, twice the size around", same, 1.5e-3));
    assert_true(oracle_within("warp: affine maps, twice the size around", worst, 3e-3));
}

/* Equations with a condition number of 5e5 (Hilbert's matrix): three right-hand sides whose solution is known,
 * because all products and sums of the integers with these entries fit a float. */
TEST(solves_hard_equations)
{
    enum { N = 5 };
    float a[N * N], b[N * 3], x[N * 3], lu[N * N], rest[N * 3];
    uint32_t pivot[N];
    const smr_system s = {N, a, b, x, lu, rest, pivot};
    double worst = 0.0;
    for (int i = 0; i < N; i++)
        for (int j = 0; j < N; j++)
            a[N * i + j] = 2520.0f / (float)(i + j + 1) / 4096.0f; /* 2520 / 1..9 are whole numbers */
    for (int i = 0; i < N; i++)
        for (int c = 0; c < 3; c++) {
            b[3 * i + c] = 0.0f;
            for (int j = 0; j < N; j++)
                b[3 * i + c] += a[N * i + j] * (float)((j * 7 + c * 3) % 11 - 5);
        }
    assert_int_equal(smr_system_solve(&s), 1);
    for (int j = 0; j < N; j++)
        for (int c = 0; c < 3; c++)
            worst = fmax(worst, fabs((double)x[3 * j + c] - (double)((j * 7 + c * 3) % 11 - 5)));
    assert_true(oracle_within("warp: hard equations", worst, 1e-6));
    for (int j = 0; j < N; j++) /* two rows alike: no inverse */
        a[N + j] = a[j];
    assert_int_equal(smr_system_solve(&s), 0);
}

/* Equations with a condition number of 8e5: the last correction, too, is needed for the last digits of a float. */
TEST(solves_equations_that_need_all_corrections)
{
    static const int row[4][4] = {
        {-381, -718, 650, 469}, {-871, 935, 435, -397}, {-941, -583, 126, -964}, {-451, -2235, 341, -98}};
    static const int want[12] = {-4, -1, 5, 1, 3, 5, 5, 2, 5, 5, -3, 4};
    float a[16], b[12] = {0}, x[12], lu[16], rest[12];
    uint32_t pivot[4];
    const smr_system s = {4, a, b, x, lu, rest, pivot};
    for (int i = 0; i < 16; i++) {
        a[i] = (float)row[i / 4][i % 4] / 4096.0f;
        for (int c = 0; c < 3; c++) /* exact: integers / 4096 */
            b[3 * (i / 4) + c] += a[i] * (float)want[3 * (i % 4) + c];
    }
    assert_int_equal(smr_system_solve(&s), 1);
    for (int i = 0; i < 12; i++)
        assert_true(fabs((double)x[i] - want[i]) < 5e-7);
}

/* The warp does not depend on what lay in memory, nor do carried points on their company. */
TEST(repeats_bit_for_bit)
{
    oracle_random r = oracle_seed(311);
    uint32_t kind;
    const unit_landmarks s = unit_warp_random(&r, 40, 0.0, 30.0);
    size_t bytes = 0;
    assert_int_equal(smr_warp_bytes(s.n, &bytes), SMR_OK);
    void *memory = rig_rough(bytes);
    float p[300], q[300];
    smr_warp *w = NULL;
    for (int i = 0; i < 300; i++)
        p[i] = q[i] = oracle_uniformf(&r, -300, 300);
    assert_int_equal(smr_warp_fit(s.from, s.to, s.n, 2.0f, memory, bytes, &w, &kind), SMR_OK);
    assert_int_equal(smr_warp_apply(w, p, 100), SMR_OK);
    memory = rig_rough(bytes);
    memset(memory, 0xff, bytes);
    assert_int_equal(smr_warp_fit(s.from, s.to, s.n, 2.0f, memory, bytes, &w, &kind), SMR_OK);
    for (uint32_t i = 0; i < 100u; i++)
        assert_int_equal(smr_warp_apply(w, q + 3 * i, 1), SMR_OK);
    assert_memory_equal(p, q, sizeof p);
}
