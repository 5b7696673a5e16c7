/* test_thin_plate_spline.c: thin-plate splines interpolate landmarks (1e-3 mm for bodies of 600 mm), reproduce affine
 * maps, smooth, average duplicates, repeat bit for bit, and agree with a spline in double precision.
 * SPDX-License-Identifier: MIT */
#include "cmocka_first.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "geometry/linear_solve/thin_plate_solve.h"
#include "unit_mesh.h"
#include "unit_warp.h"

static void passes_through_landmarks(void **state)
{
    oracle_random r = oracle_seed(301);
    double worst = 0.0, large = 0.0;
    (void)state;
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
            unit_free(w);
        }
    assert_true(oracle_within("warp: landmarks, bent by 60 mm", worst, 1e-3));
    assert_true(oracle_within("warp: landmarks, bent by 200 mm", large, 2e-3));
}

static void agrees_with_double_precision(void **state)
{
    static const float smoothing[] = {0.0f, 0.1f, 5.0f, 300.0f, 1e5f};
    oracle_random r = oracle_seed(302);
    double worst = 0.0;
    oracle_spline *o = unit_memory(sizeof *o);
    (void)state;
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
            unit_free(w);
        }
    unit_free(o);
    assert_true(oracle_within("warp: against double precision", worst, 2e-3));
}

/* Carried landmarks 0.05 to 3 mm apart, whose goals differ by less than that: still through all of them. */
static void near_landmarks_stay_apart(void **state)
{
    static const double gap[] = {0.05, 0.3, 3.0};
    oracle_random r = oracle_seed(303);
    double worst = 0.0;
    (void)state;
    for (uint32_t k = 0; k < 60u; k++) {
        uint32_t kind;
        unit_landmarks s = unit_warp_random(&r, 20u + k % 40u, 0.0, 40.0);
        for (uint32_t i = 0; i < 8u; i++)
            for (uint32_t c = 0; c < 3u; c++) {
                const double d = gap[k % 3u] * (c == i % 3u ? 1.0 : 0.2);
                s.from[3 * (i + 8u) + c] = (float)((double)s.from[3 * i + c] + d);
                s.to[3 * (i + 8u) + c] = (float)((double)s.to[3 * i + c] + d * oracle_uniform(&r, -1, 1));
            }
        smr_warp *w = unit_warp_fit(&s, 0.0f, &kind);
        assert_int_equal(kind, SMR_WARP_SPLINE);
        worst = fmax(worst, unit_warp_miss(w, &s));
        unit_free(w);
    }
    assert_true(oracle_within("warp: landmarks close to each other", worst, 2e-3));
}

static void keeps_affine_maps(void **state)
{
    oracle_random r = oracle_seed(304);
    double worst = 0.0, same = 0.0;
    (void)state;
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
        unit_free(w);
    }
    assert_true(oracle_within("warp: identity, twice the size around", same, 1.5e-3));
    assert_true(oracle_within("warp: affine maps, twice the size around", worst, 3e-3));
}

/* The sum of squares at the landmarks grows with smoothing and ends at the least-squares unit_affine map. */
static void smoothing_ends_at_affine(void **state)
{
    static const float smoothing[] = {0.0f, 1.0f, 10.0f, 100.0f, 1e3f, 1e5f, 1e8f, 1e15f, FLT_MAX};
    oracle_random r = oracle_seed(305);
    double worst = 0.0;
    oracle_spline *o = unit_memory(sizeof *o);
    (void)state;
    for (uint32_t k = 0; k < 30u; k++) {
        const unit_landmarks s = unit_warp_random(&r, 8u + k, 0.0, 40.0);
        double before = -1.0;
        oracle_spline_fit(o, &s, 1e10);
        for (uint32_t j = 0; j < sizeof smoothing / sizeof *smoothing; j++) {
            uint32_t kind;
            float at[3 * SMR_LANDMARKS_MAX];
            double sum = 0.0;
            smr_warp *w = unit_warp_fit(&s, smoothing[j], &kind);
            assert_int_equal(kind, SMR_WARP_SPLINE);
            memcpy(at, s.from, sizeof at);
            assert_int_equal(smr_warp_apply(w, at, s.n), SMR_OK);
            for (uint32_t i = 0; i < s.n; i++) {
                double e[3];
                sum += pow(unit_apart(at + 3 * i, s.to + 3 * i), 2.0);
                oracle_spline_apply(o, s.from + 3 * i, e);
                for (uint32_t c = 0; c < 3u && smoothing[j] > 1e9f; c++)
                    worst = fmax(worst, fabs((double)at[3 * i + c] - e[c]));
            }
            assert_true(sum >= before * (1.0 - 1e-5));
            before = sum;
            unit_free(w);
        }
    }
    unit_free(o);
    assert_true(oracle_within("warp: endless smoothing is affine", worst, 1e-3));
}

static void duplicates_are_averaged(void **state)
{
    oracle_random r = oracle_seed(306);
    double worst = 0.0;
    (void)state;
    for (uint32_t k = 0; k < 40u; k++) {
        uint32_t kind;
        unit_landmarks one = unit_warp_random(&r, 8u + k % 20u, 0.0, 30.0), two = one;
        for (uint32_t i = 0; i < one.n; i++) /* pairs of goals around the single one */
            for (uint32_t c = 0; c < 3u; c++) {
                const float d = oracle_uniformf(&r, -5, 5);
                two.from[3 * (one.n + i) + c] = one.from[3 * i + c];
                two.to[3 * (one.n + i) + c] = one.to[3 * i + c] + d;
                two.to[3 * i + c] = one.to[3 * i + c] - d;
            }
        two.n = 2u * one.n;
        smr_warp *w = unit_warp_fit(&two, 0.0f, &kind);
        assert_int_equal(kind, SMR_WARP_SPLINE);
        worst = fmax(worst, unit_warp_miss(w, &one));
        unit_free(w);
        smr_warp *a = unit_warp_fit(&two, 20.0f, &kind),
                 *b = unit_warp_fit(&one, 10.0f, &kind); /* two landmarks pull twice as hard */
        for (uint32_t i = 0; i < 20u; i++) {
            float p[3], q[3];
            for (int c = 0; c < 3; c++)
                p[c] = q[c] = oracle_uniformf(&r, -300, 300);
            assert_int_equal(smr_warp_apply(a, p, 1), SMR_OK);
            assert_int_equal(smr_warp_apply(b, q, 1), SMR_OK);
            worst = fmax(worst, unit_apart(p, q));
        }
        unit_free(a);
        unit_free(b);
    }
    assert_true(oracle_within("warp: duplicates", worst, 1e-3));
}

/* Equations with a condition number of 5e5 (Hilbert's matrix): three right-hand sides whose solution is known,
 * because all products and sums of the integers with these entries fit a float. */
static void solves_hard_equations(void **state)
{
    enum { N = 5 };
    float a[N * N], b[N * 3], x[N * 3], lu[N * N], rest[N * 3];
    uint32_t pivot[N];
    const smr_system s = {N, a, b, x, lu, rest, pivot};
    double worst = 0.0;
    (void)state;
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

/* The warp does not depend on what lay in memory, nor do carried points on their company. */
static void repeats_bit_for_bit(void **state)
{
    oracle_random r = oracle_seed(311);
    uint32_t kind;
    const unit_landmarks s = unit_warp_random(&r, 40, 0.0, 30.0);
    size_t bytes = 0;
    assert_int_equal(smr_warp_bytes(s.n, &bytes), SMR_OK);
    void *memory = unit_memory(bytes);
    float p[300], q[300];
    smr_warp *w = NULL;
    (void)state;
    for (int i = 0; i < 300; i++)
        p[i] = q[i] = oracle_uniformf(&r, -300, 300);
    assert_int_equal(smr_warp_fit(s.from, s.to, s.n, 2.0f, memory, bytes, &w, &kind), SMR_OK);
    assert_int_equal(smr_warp_apply(w, p, 100), SMR_OK);
    unit_free(memory);
    memory = unit_memory(bytes);
    memset(memory, 0xff, bytes);
    assert_int_equal(smr_warp_fit(s.from, s.to, s.n, 2.0f, memory, bytes, &w, &kind), SMR_OK);
    for (uint32_t i = 0; i < 100u; i++)
        assert_int_equal(smr_warp_apply(w, q + 3 * i, 1), SMR_OK);
    assert_memory_equal(p, q, sizeof p);
    unit_free(memory);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(passes_through_landmarks),  cmocka_unit_test(agrees_with_double_precision),
        cmocka_unit_test(near_landmarks_stay_apart), cmocka_unit_test(keeps_affine_maps),
        cmocka_unit_test(smoothing_ends_at_affine),  cmocka_unit_test(duplicates_are_averaged),
        cmocka_unit_test(solves_hard_equations),     cmocka_unit_test(repeats_bit_for_bit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
