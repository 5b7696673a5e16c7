/* test_rodrigues.c: rotations from rotation vectors. Accuracy against double precision: entries of R - I 3e-7, and R
 * is a rotation within 1e-6 for every vector.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
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

TEST(equals_double)
{
    oracle_random r = oracle_seed(30);
    double worst = 0.0, worst_rotation = 0.0, worst_relative = 0.0;
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
TEST(long_vectors)
{
    static const float lengths[] = {1.5f, 1.501f, 3.2f, 100.0f, 1e8f, 1e15f, 1e19f, 1e25f, 1e37f, FLT_MAX};
    oracle_random r = oracle_seed(31);
    double worst = 0.0, worst_rotation = 0.0;
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
