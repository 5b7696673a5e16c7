/* test_rodrigues.c: rotations from rotation vectors. Accuracy against double precision: sin(a)/a and (1-cos a)/a^2
 * 2e-7, cosine of degrees 3e-7, entries of R - I 3e-7, and R is a rotation within 1e-6 for every vector.
 * SPDX-License-Identifier: MIT */
#include "cmocka_first.h"

#include <float.h>
#include <math.h>

#include "geometry/rotation/rotation.h"
#include "oracle.h"

static double wide(const float m[9], double r[9])
{
    oracle_widen(m, r, 9);
    for (int i = 0; i < 9; i += 4)
        r[i] += 1.0;
    return oracle_not_rotation(r);
}

static void polynomials(void **state)
{
    double worst_s = 0.0, worst_c = 0.0;
    (void)state;
    for (uint32_t i = 0; i <= 200000; i++) {
        const float a2 = (float)i * (SMR_ANGLE_MAX * SMR_ANGLE_MAX / 200000.0f);
        const double a = sqrt((double)a2);
        float s, c;
        smr_sinc(a2, &s, &c);
        const double half = sin(0.5 * a);
        worst_s = fmax(worst_s, fabs((double)s - (a > 0.0 ? sin(a) / a : 1.0)));
        worst_c = fmax(worst_c, fabs((double)c - (a > 0.0 ? 2.0 * half * half / (a * a) : 0.5)));
    }
    assert_true(oracle_within("sinc: sin(a)/a", worst_s, 2e-7));
    assert_true(oracle_within("sinc: (1-cos a)/a^2", worst_c, 2e-7));
}

static void cosine_of_degrees(void **state)
{
    double worst = 0.0;
    float last = 2.0f;
    (void)state;
    for (uint32_t i = 0; i <= 18000; i++) {
        const float d = (float)i * 0.01f, got = smr_cos_degrees(d);
        worst = fmax(worst, fabs((double)got - cos((double)d * (3.14159265358979323846 / 180.0))));
        assert_true(got <= last + 2e-7f);
        last = got;
    }
    assert_true(smr_cos_degrees(90.0f) == 0.0f);
    assert_true(oracle_within("cosine of degrees", worst, 3e-7));
}

static void equals_double(void **state)
{
    oracle_random r = oracle_seed(30);
    double worst = 0.0, worst_rotation = 0.0, worst_relative = 0.0;
    (void)state;
    for (uint32_t i = 0; i < 50000u; i++) {
        double m[9], got[9], axis[3], w[3];
        float out[9];
        const double angle = i % 2u ? oracle_uniform(&r, 0.0, 1.499) : pow(10.0, oracle_uniform(&r, -18.0, 0.0));
        oracle_rotation(&r, m);
        for (int k = 0; k < 3; k++)
            axis[k] = m[k];
        smr_vec v = smr_v((float)(axis[0] * angle), (float)(axis[1] * angle), (float)(axis[2] * angle));
        w[0] = (double)v.x, w[1] = (double)v.y, w[2] = (double)v.z;
        const double a = sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
        smr_rodrigues(v, out);
        worst_rotation = fmax(worst_rotation, wide(out, got));
        oracle_turn(w, a, m);
        worst = fmax(worst, oracle_difference(got, m, 9));
        const double skew =
            fabs(((double)out[3] - (double)out[1]) * 0.5 - sin(a) / a * w[2]); /* small angles keep digits */
        worst_relative = fmax(worst_relative, skew / a);
    }
    assert_true(oracle_within("rodrigues: entries", worst, 3e-7));
    assert_true(oracle_within("rodrigues: is a rotation", worst_rotation, 1e-6));
    assert_true(oracle_within("rodrigues: small angles, relative", worst_relative, 3e-7));
}

/* Longer vectors are shortened to SMR_ANGLE_MAX, along the same axis; none of them is too long. */
static void long_vectors(void **state)
{
    static const float lengths[] = {1.5f, 1.501f, 3.2f, 100.0f, 1e8f, 1e15f, 1e19f, 1e25f, 1e37f, FLT_MAX};
    oracle_random r = oracle_seed(31);
    double worst = 0.0, worst_rotation = 0.0;
    (void)state;
    for (uint32_t i = 0; i < 10000u; i++) {
        double turn[9], got[9], want[9];
        float out[9];
        const double l = (double)lengths[i % 10u];
        oracle_rotation(&r, turn);
        smr_rodrigues(smr_v((float)(turn[0] * l), (float)(turn[1] * l), (float)(turn[2] * l)), out);
        worst_rotation = fmax(worst_rotation, wide(out, got));
        oracle_turn(turn, (double)SMR_ANGLE_MAX, want);
        worst = fmax(worst, oracle_difference(got, want, 9));
    }
    assert_true(oracle_within("rodrigues: long vectors", worst, 1e-6));
    assert_true(oracle_within("rodrigues: long vectors, rotation", worst_rotation, 1e-6));
}

static void nothing_turns_nothing(void **state)
{
    const float zero[9] = {0};
    float out[9];
    (void)state;
    smr_rodrigues(smr_v(0, 0, 0), out);
    for (int i = 0; i < 9; i++)
        assert_true(out[i] == zero[i]);
    smr_rodrigues(smr_v(FLT_MIN, -FLT_MIN, 1e-42f), out);
    for (int i = 0; i < 9; i++)
        assert_true(fabsf(out[i]) <= FLT_MIN);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(polynomials),  cmocka_unit_test(cosine_of_degrees),     cmocka_unit_test(equals_double),
        cmocka_unit_test(long_vectors), cmocka_unit_test(nothing_turns_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
