/* test_fixed.c: rounding to fixed point and exact sums. Accuracy against double precision: half a unit for a value
 * below 2^22, one unit above (v + 0.5 is rounded there), n half units for a sum of n values. Any order of summation,
 * and any wrap-around within it, gives the same bits.
 * SPDX-License-Identifier: MIT */
#include "cmocka_first.h"

#include <math.h>

#include "base/fixed_point.h"
#include "oracle.h"

static int32_t signed_of(uint32_t v)
{
    int32_t s;
    memcpy(&s, &v, sizeof s);
    return s;
}

static void scale_is_the_largest_power_of_two(void **state)
{
    oracle_random r = oracle_seed(3);
    (void)state;
    assert_true(smr_fixed_scale(0.0f) == 1.0f);
    for (int i = 0; i < 20000; i++) {
        const float bound = (float)ldexp(oracle_uniform(&r, 1.0, 2.0), (int)oracle_below(&r, 86u) - 28);
        const float s = smr_fixed_scale(bound);
        int exponent;
        assert_true(frexpf(s, &exponent) == 0.5f);
        assert_true((double)bound * (double)s <= 1073741824.0);
        assert_true((double)bound * (double)s > 536870912.0);
    }
    for (int e = -149; e <= 127; e++) { /* every power of two: defined, a power of two, never too large */
        const float bound = (float)ldexp(1.0, e), s = smr_fixed_scale(bound);
        int exponent;
        assert_true(frexpf(s, &exponent) == 0.5f);
        assert_true((double)s >= ldexp(1.0, -60) && (double)s <= ldexp(1.0, 60));
        assert_true((double)bound * (double)s <= 1073741824.0 || s == (float)ldexp(1.0, -60));
    }
    assert_true(smr_fixed_scale(FLT_MAX) == (float)ldexp(1.0, -60));
}

static void rounds_to_nearest(void **state)
{
    static const struct {
        float v;
        int32_t want;
    } table[] = {{0.0f, 0},
                 {-0.0f, 0},
                 {0.5f, 1},
                 {-0.5f, -1},
                 {0.49f, 0},
                 {-0.49f, 0},
                 {1.5f, 2},
                 {-1.5f, -2},
                 {2.25f, 2},
                 {1.0e-30f, 0},
                 {-1.0e-40f, 0},
                 {8388610.0f, 8388610},
                 {1.0e9f, 1000000000},
                 {3.0e9f, 1073741824},
                 {-3.0e9f, -1073741824},
                 {1073741824.0f, 1073741824},
                 {-1073741824.0f, -1073741824}};
    oracle_random r = oracle_seed(4);
    double worst = 0.0, worst_large = 0.0;
    (void)state;
    for (size_t i = 0; i < sizeof table / sizeof table[0]; i++)
        assert_int_equal(signed_of(smr_fixed(table[i].v)), table[i].want);
    assert_int_equal(signed_of(smr_fixed(INFINITY)), 1073741824);
    assert_int_equal(signed_of(smr_fixed(-INFINITY)), -1073741824);
    assert_in_range(signed_of(smr_fixed(NAN)) + 1073741824ll, 0, 2147483648ll); /* defined, within the limits */
    for (int i = 0; i < 100000; i++) {
        const float v = oracle_uniformf(&r, -4.0e6f, 4.0e6f); /* finer than a half: the sum v + 0.5 is exact */
        worst = fmax(worst, fabs((double)signed_of(smr_fixed(v)) - (double)v));
        assert_int_equal(signed_of(smr_fixed(-v)), -signed_of(smr_fixed(v)));
    }
    for (int i = 0; i < 100000; i++) {
        const float v = (float)ldexp(oracle_uniform(&r, 1.0, 2.0), 22 + (int)oracle_below(&r, 8u));
        worst_large = fmax(worst_large, fabs((double)signed_of(smr_fixed(v)) - (double)v));
        assert_int_equal(signed_of(smr_fixed(-v)), -signed_of(smr_fixed(v)));
    }
    assert_true(oracle_within("fixed: one value, units", worst, 0.5));
    assert_true(oracle_within("fixed: one large value, units", worst_large, 1.0));
}

static void any_order_any_wrap_same_bits(void **state)
{
    enum { N = 4096 };
    static uint32_t v[N];
    static double exact[N];
    oracle_random r = oracle_seed(5);
    double worst = 0.0;
    (void)state;
    for (int round = 0; round < 40; round++) {
        const double size = ldexp(1.0, (int)oracle_below(&r, 40u) - 20);
        double want = 0.0, bound = 0.0;
        for (int i = 0; i < N; i++) {
            exact[i] = (double)(float)oracle_uniform(&r, -size, size);
            want += exact[i];
            bound += fabs(exact[i]);
        }
        const float scale = smr_fixed_scale((float)bound * 1.001f);
        uint32_t sum = 0;
        for (int i = 0; i < N; i++) {
            v[i] = smr_fixed((float)exact[i] * scale);
            sum += v[i];
        }
        const double got = (double)smr_unfix(sum, 1.0f / scale);
        worst = fmax(worst, fabs(got - want) * (double)scale / (0.5 * N));
        uint32_t other = 0xdeadbeefu; /* start anywhere, take it off at the end */
        for (int i = 0; i < N; i++) {
            const uint32_t k = oracle_below(&r, N), swap = v[i];
            v[i] = v[k];
            v[k] = swap;
        }
        for (int i = 0; i < N; i++)
            other += v[i];
        assert_int_equal(other - 0xdeadbeefu, sum);
        for (int i = 0; i < N; i++)
            sum -= v[i];
        assert_int_equal(sum, 0); /* 4096 updates there and back leave nothing */
    }
    assert_true(oracle_within("fixed: sum of 4096, of n/2 units", worst, 1.0));
}

static void small_helpers(void **state)
{
    (void)state;
    for (float v = -3.0f; v <= 3.0f; v += 0.125f)
        assert_true(smr_positive(v) == (v > 0.0f ? v : 0.0f));
    assert_true(signbit(smr_positive(-0.0f)) == 0);
    assert_true(smr_within(5.0f, 5.0f) && !smr_within(5.0001f, 5.0f) && !smr_within(NAN, 5.0f));
    assert_true(!smr_within(INFINITY, FLT_MAX) && !smr_within(-INFINITY, FLT_MAX));
    assert_int_equal(smr_ceil_div(UINT32_MAX, 2u), 0x80000000u);
    assert_int_equal(smr_ceil_div(0u, 64u), 0u);
    assert_int_equal(smr_ceil_div(65u, 64u), 2u);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(scale_is_the_largest_power_of_two),
        cmocka_unit_test(rounds_to_nearest),
        cmocka_unit_test(any_order_any_wrap_same_bits),
        cmocka_unit_test(small_helpers),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
