/* test_polar_decomposition.c: the rotation nearest to a matrix. Accuracy against double precision: a rotation within
 * 3e-6 for every input; each entry within 1e-6 for condition numbers up to 3, 5e-6 up to 10, 5e-5 up to 30, 5e-4 up
 * to 100 (the error grows with the square of the condition number, because A^T A is rounded).
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "geometry/rotation/rotation.h"
#include "oracle.h"

static const float identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};

static void polar_wide(const float a[9], float v[9], double r[9])
{
    float m[9];
    double wide[9];
    smr_polar(a, v, m);
    oracle_widen(m, r, 9);
    for (int i = 0; i < 9; i += 4)
        r[i] += 1.0;
    oracle_widen(v, wide, 9);
    assert_true(oracle_not_rotation(wide) < 3e-6); /* the warm start stays a rotation */
}

/* U diag(s) W^T */
static void compose(oracle_random *r, const double s[3], float a[9])
{
    double u[9], w[9], d[9] = {s[0], 0, 0, 0, s[1], 0, 0, 0, s[2]};
    oracle_rotation(r, u);
    oracle_rotation(r, w);
    oracle_product(u, d, d);
    oracle_product(d, w, d);
    for (int i = 0; i < 9; i++)
        a[i] = (float)d[i];
}

TEST(equals_double)
{
    static const struct {
        double condition, budget;
    } table[] = {{1.2, 1e-6}, {3, 1e-6}, {10, 5e-6}, {30, 5e-5}, {100, 5e-4}};
    oracle_random r = oracle_seed(20);
    for (size_t k = 0; k < sizeof table / sizeof table[0]; k++) {
        double worst = 0.0, worst_rotation = 0.0;
        for (uint32_t i = 0; i < 4000u; i++) {
            const double size = pow(10.0, oracle_uniform(&r, -8.0, 8.0));
            const double s[3] = {size, size * pow(table[k].condition, -oracle_uniform(&r, 0, 1)),
                                 size / table[k].condition};
            double got[9], want[9], wide[9], singular[3];
            float a[9], v[9];
            compose(&r, s, a);
            memcpy(v, identity, sizeof v);
            polar_wide(a, v, got);
            oracle_widen(a, wide, 9);
            oracle_polar(wide, want, singular);
            worst = fmax(worst, oracle_difference(got, want, 9));
            worst_rotation = fmax(worst_rotation, oracle_not_rotation(got));
        }
        char name[64];
        (void)snprintf(name, sizeof name, "polar: condition %g", table[k].condition);
        assert_true(oracle_within(name, worst, table[k].budget));
        assert_true(oracle_within("polar: is a rotation", worst_rotation, 3e-6));
    }
}

/* Whatever comes in, a rotation comes out. */
TEST(always_a_rotation)
{
    oracle_random r = oracle_seed(23);
    double worst = 0.0;
    for (uint32_t i = 0; i < 40000u; i++) {
        double got[9], s[3] = {1.0, oracle_uniform(&r, 0, 1), 0.0};
        s[2] = oracle_uniform(&r, 0, 1);
        float a[9], v[9];
        const uint32_t kind = i % 8u;
        if (kind == 1) /* planar */
            s[2] = 0.0;
        if (kind == 2) /* collinear */
            s[1] = s[2] = 0.0;
        if (kind == 3) /* coincident */
            s[0] = s[1] = s[2] = 0.0;
        if (kind == 4) /* reflected */
            s[2] = -s[2];
        if (kind == 5) /* near the rank decision */
            s[1] = pow(10.0, oracle_uniform(&r, -4.0, -2.0)), s[2] = s[1] * oracle_uniform(&r, -1, 1);
        const double size = kind == 6 ? pow(10.0, oracle_uniform(&r, 20.0, 38.0))
                                      : (kind == 7 ? pow(10.0, oracle_uniform(&r, -44.0, -15.0)) : 1000.0);
        for (int k = 0; k < 3; k++)
            s[k] *= size;
        compose(&r, s, a);
        memcpy(v, identity, sizeof v);
        polar_wide(a, v, got);
        worst = fmax(worst, oracle_not_rotation(got));
    }
    assert_true(oracle_within("polar: degenerate inputs", worst, 3e-6));
}

TEST(defined_answers)
{
    oracle_random r = oracle_seed(24);
    float v[9], m[9];
    const float zero[9] = {0}, tiny[9] = {1e-25f, 0, 0, 0, 1e-25f, 0, 0, 0, 1e-25f};
    memcpy(v, identity, sizeof v);
    smr_polar(zero, v, m); /* rank 0: no rotation, and the warm start untouched */
    assert_memory_equal(m, zero, sizeof m);
    assert_memory_equal(v, identity, sizeof v);
    smr_polar(tiny, v, m);
    assert_memory_equal(m, zero, sizeof m);
    double worst = 0.0, worst_angle = 0.0;
    for (uint32_t i = 0; i < 3000u; i++) { /* rank 1: b a^T takes a to b by the shortest way */
        double turn[9], got[9];
        float a[9];
        oracle_rotation(&r, turn); /* a: first row, b: second row, or the opposite of a at times */
        double from[3] = {turn[0], turn[1], turn[2]}, to[3] = {turn[3], turn[4], turn[5]};
        for (int k = 0; k < 3; k++)
            to[k] = i % 3u == 0u ? -from[k] : (i % 3u == 1u ? to[k] : from[k] + 0.3 * to[k]);
        double l = sqrt(to[0] * to[0] + to[1] * to[1] + to[2] * to[2]), cosine = 0.0;
        for (int k = 0; k < 3; k++)
            to[k] /= l, cosine += to[k] * from[k];
        for (int k = 0; k < 9; k++)
            a[k] = (float)(to[k / 3] * from[k % 3]);
        memcpy(v, identity, sizeof v);
        polar_wide(a, v, got);
        for (int k = 0; k < 3; k++)
            worst =
                fmax(worst, fabs(got[3 * k] * from[0] + got[3 * k + 1] * from[1] + got[3 * k + 2] * from[2] - to[k]));
        worst_angle = fmax(worst_angle, fabs(0.5 * (got[0] + got[4] + got[8] - 1.0) - cosine));
    }
    assert_true(oracle_within("polar: rank 1 takes a to b", worst, 2e-6));
    assert_true(oracle_within("polar: rank 1 by the shortest way", worst_angle, 2e-6));
}
