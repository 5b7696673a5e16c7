/* test_triangle.c: closest point on one triangle. Accuracy against double precision, relative to the largest of the
 * distance and the sides: distance 1e-6 for sound triangles, slivers, segments and points alike;
 * weights add to 1 within 3e-7 and are never below -2e-6.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include "geometry/box_tree/triangle.h"
#include "oracle.h"

typedef struct residuals {
    double distance, own, sum, low;
} residuals;

static smr_vec narrow(const double p[3]) { return smr_v((float)p[0], (float)p[1], (float)p[2]); }

static void compare(const double p[4][3], double scale, residuals *worst)
{
    float w[3];
    double exact[4][3];
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 3; k++)
            exact[i][k] = (double)(float)p[i][k];
    const double d = sqrt((double)smr_triangle_closest(narrow(p[0]), narrow(p[1]), narrow(p[2]), narrow(p[3]), w));
    const double want = sqrt(oracle_triangle(exact[0], exact[1], exact[2], exact[3]));
    worst->distance = fmax(worst->distance, fabs(d - want) / scale);
    double own = 0.0;
    for (int k = 0; k < 3; k++) {
        const double at = (double)w[0] * exact[1][k] + (double)w[1] * exact[2][k] + (double)w[2] * exact[3][k];
        own += (at - exact[0][k]) * (at - exact[0][k]);
    }
    worst->own = fmax(worst->own, fabs(sqrt(own) - d) / scale);
    worst->sum = fmax(worst->sum, fabs((double)w[0] + (double)w[1] + (double)w[2] - 1.0));
    for (int k = 0; k < 3; k++)
        worst->low = fmax(worst->low, -(double)w[k]);
}

static void check(const residuals *worst, double budget)
{
    assert_true(oracle_within("triangle: distance", worst->distance, budget));
    assert_true(oracle_within("triangle: weights name that point", worst->own, budget));
    assert_true(oracle_within("triangle: weights add to 1", worst->sum, 3e-7));
    assert_true(oracle_within("triangle: negative weight", worst->low, 2e-6));
}

TEST(slivers_and_points)
{
    oracle_random r = oracle_seed(41);
    residuals worst = {0, 0, 0, 0};
    for (uint32_t i = 0; i < 100000u; i++) {
        double p[4][3], m[9];
        const double thin = i % 4u == 0u ? 0.0 : pow(10.0, oracle_uniform(&r, -9.0, -1.0)),
                     at = oracle_uniform(&r, -1, 2);
        oracle_rotation(&r, m);
        for (int k = 0; k < 3; k++) {
            p[0][k] = oracle_uniform(&r, -20, 20);
            p[1][k] = 0.0;
            p[2][k] = i % 8u == 4u ? 0.0 : 10.0 * m[k];
            p[3][k] = i % 8u == 4u ? p[i % 3u][k] * 0.0 : 10.0 * at * m[k] + 10.0 * thin * m[3 + k];
        }
        compare((const double(*)[3])p, 30.0, &worst);
    }
    check(&worst, 1e-6);
}

/* Points on corners, edges and inside: distance 0 and the weights are those points'. */
TEST(points_of_the_triangle)
{
    oracle_random r = oracle_seed(42);
    double worst = 0.0;
    const smr_vec a = smr_v(1, 2, 3), b = smr_v(4, 2, 3), c = smr_v(1, 6, 3);
    float w[3];
    assert_true(smr_triangle_closest(a, a, b, c, w) == 0.0f && w[0] == 1.0f && w[1] == 0.0f && w[2] == 0.0f);
    assert_true(smr_triangle_closest(b, a, b, c, w) == 0.0f && w[1] == 1.0f && w[0] == 0.0f && w[2] == 0.0f);
    assert_true(smr_triangle_closest(c, a, b, c, w) == 0.0f && w[2] == 1.0f && w[0] == 0.0f && w[1] == 0.0f);
    const smr_vec tiny = smr_v(1e-8f, 0, 0), other = smr_v(0, 1e-8f, 0), within = smr_v(2e-9f, 2e-9f, 0);
    assert_true(smr_triangle_closest(within, smr_v(0, 0, 0), tiny, other, w) < 1e-16f); /* products below any float */
    for (uint32_t i = 0; i < 10000u; i++) {
        double u = oracle_uniform(&r, 0, 1), v = oracle_uniform(&r, 0, 1);
        if (u + v > 1.0)
            u = 1.0 - u, v = 1.0 - v;
        if (i % 3u == 0u)
            u = 0.0;
        const double want[3] = {1.0 - u - v, u, v};
        const smr_vec p = smr_v((float)(1.0 + 3.0 * u), (float)(2.0 + 4.0 * v), 3.0f);
        const float d2 = smr_triangle_closest(p, a, b, c, w);
        worst = fmax(worst, sqrt((double)d2));
        for (int k = 0; k < 3; k++)
            worst = fmax(worst, fabs((double)w[k] - want[k]));
    }
    assert_true(oracle_within("triangle: its own points", worst, 2e-6));
}
