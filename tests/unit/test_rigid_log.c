/* test_rigid_log.c: logarithm and exponential of rigid motions, against double precision: rotation vectors 6e-7 rad,
 * also next to half a turn; places 1e-6 of |turn| |p| + |shift|; small motions keep their digits; blends of two
 * motions stay rigid and go along when all is moved.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <float.h>
#include <math.h>
#include "geometry/rotation/rotation.h"
#include "oracle.h"

#define PI 3.14159265358979323846

static smr_vec narrow(const double p[3]) { return smr_v((float)p[0], (float)p[1], (float)p[2]); }

/* R - I of the turn about the axis, rounded to float. */
static void rounded(const double axis[3], double angle, float m[9])
{
    double r[9];
    oracle_turn(axis, angle, r);
    for (int i = 0; i < 9; i++)
        m[i] = (float)(r[i] - (i % 4 == 0 ? 1.0 : 0.0));
}

static double angle_at(oracle_random *r, uint32_t i)
{
    static const double special[] = {0.0, 0.25 * PI, 0.5 * PI, 0.75 * PI, PI - 1.0e-3, PI - 1.0e-6, PI, 2.0 / 3.0 * PI};
    if (i % 4u == 0u)
        return special[i / 4u % 8u];
    return i % 4u == 1u ? pow(10.0, oracle_uniform(r, -18.0, 0.0)) : oracle_uniform(r, 0.0, PI);
}

/* Half a turn about each axis has an answer, the same one each time; what is no rotation has a bounded one. */
TEST(test_cut_and_nonsense)
{
    static const float large[] = {0.0f, FLT_MIN, -1.0e-30f, 1.0f, -1.0f, -2.0f, 3.0f, 1.0e10f, -1.0e10f};
    oracle_random r = oracle_seed(43);
    for (uint32_t i = 0; i < 30000u; i++) {
        float m[9];
        for (int k = 0; k < 9; k++)
            m[k] = large[oracle_below(&r, 9)];
        const smr_vec w = smr_rotation_log(m);
        assert_true(isfinite(w.x) && isfinite(w.y) && isfinite(w.z) && smr_length(w) <= SMR_HALF_TURN * 1.000001f);
    }
    for (int k = 0; k < 3; k++) {
        float m[9] = {-2, 0, 0, 0, -2, 0, 0, 0, -2};
        m[4 * k] = 0.0f;
        const smr_vec w = smr_rotation_log(m), again = smr_rotation_log(m);
        const float at[3] = {w.x, w.y, w.z};
        assert_true(fabsf(at[k] - SMR_HALF_TURN) < 1.0e-6f && smr_length(w) <= SMR_HALF_TURN);
        assert_true(w.x == again.x && w.y == again.y && w.z == again.z);
    }
}

/* exp(log T) p = T p, in double. */
TEST(test_there_and_back)
{
    oracle_random r = oracle_seed(42);
    double worst = 0.0, worst_normal = 0.0;
    for (uint32_t i = 0; i < 50000u; i++) {
        double axis[9], turn[9], c[3], shift[3], p[3], off = 0.0, size = 0.0, far = 0.0;
        oracle_rotation(&r, axis);
        const double wanted = angle_at(&r, i), reach = pow(10.0, oracle_uniform(&r, -1.0, 3.0));
        const double moves = i % 3u ? pow(10.0, oracle_uniform(&r, -12.0, 3.0)) : 0.0;
        smr_vec w = smr_v((float)(wanted * axis[0]), (float)(wanted * axis[1]), (float)(wanted * axis[2]));
        for (int k = 0; k < 3; k++) {
            c[k] = (double)(float)oracle_uniform(&r, -reach, reach);
            p[k] = (double)(float)oracle_uniform(&r, -reach, reach);
            shift[k] = (double)(float)oracle_uniform(&r, -moves, moves);
        }
        const double exact[3] = {(double)w.x, (double)w.y, (double)w.z};
        const double angle = sqrt(exact[0] * exact[0] + exact[1] * exact[1] + exact[2] * exact[2]);
        oracle_turn(exact, angle, turn);
        smr_vec n = narrow(axis + 3);
        const smr_vec way = smr_twist_move(smr_twist_about(w, narrow(c), narrow(shift)), narrow(p), &n);
        const double got[3] = {(double)way.x, (double)way.y, (double)way.z};
        const double got_n[3] = {(double)n.x, (double)n.y, (double)n.z};
        for (int k = 0; k < 3; k++) {
            double to = c[k] + shift[k] - p[k], normal = 0.0;
            for (int j = 0; j < 3; j++) {
                to += turn[3 * k + j] * (p[j] - c[j]);
                normal += turn[3 * k + j] * axis[3 + j];
            }
            off = fmax(off, fabs(got[k] - to));
            worst_normal = fmax(worst_normal, fabs(got_n[k] - normal));
            far += p[k] * p[k] + c[k] * c[k];
            size += shift[k] * shift[k];
        }
        size = angle * sqrt(far) + sqrt(size);
        /* turns of next to nothing are lost in double, too: p and c are subtracted there */
        worst = fmax(worst, size > 1.0e-9 * sqrt(far) ? off / size : 0.0);
    }
    assert_true(oracle_within("places, relative", worst, 1e-6));
    assert_true(oracle_within("normals", worst_normal, 1.2e-6));
}

/* Where the mean of two motions takes p. */
static smr_vec halfway(smr_twist a, smr_twist b, smr_vec p)
{
    smr_vec n = smr_v(0, 0, 1);
    const smr_twist mean = {smr_scale(smr_add(a.turn, b.turn), 0.5f), smr_scale(smr_add(a.rate, b.rate), 0.5f)};
    return smr_add(p, smr_twist_move(mean, p, &n));
}

/* Means of two motions keep distances, and the means of both moved ones are the moved means. */
TEST(test_mean_is_rigid_and_moves_along)
{
    oracle_random r = oracle_seed(44);
    double worst = 0.0, worst_moved = 0.0;
    for (uint32_t i = 0; i < 5000u; i++) {
        double axis[9];
        float g[9];
        smr_vec w[2], c[2], d[2], p[2];
        oracle_rotation(&r, axis);
        rounded(axis, 2.0, g);
        for (int k = 0; k < 9; k += 4)
            g[k] += 1.0f;
        for (int k = 0; k < 2; k++) {
            oracle_rotation(&r, axis);
            w[k] = smr_scale(narrow(axis), oracle_uniformf(&r, 0.0f, SMR_HALF_TURN));
            c[k] = smr_scale(narrow(axis + 3), 50.0f);
            d[k] = smr_scale(narrow(axis + 6), 10.0f);
            p[k] = smr_scale(narrow(axis + 3), 30.0f);
        }
        const smr_vec o = smr_v(12, -7, 40);
        const smr_twist a = smr_twist_about(w[0], c[0], d[0]), b = smr_twist_about(w[1], c[1], d[1]);
        const smr_twist ga = smr_twist_about(smr_mul(g, w[0]), smr_add(smr_mul(g, c[0]), o), smr_mul(g, d[0]));
        const smr_twist gb = smr_twist_about(smr_mul(g, w[1]), smr_add(smr_mul(g, c[1]), o), smr_mul(g, d[1]));
        const smr_vec x = halfway(a, b, p[0]), y = halfway(a, b, p[1]);
        worst = fmax(worst, fabs((double)smr_length(smr_sub(x, y)) - (double)smr_length(smr_sub(p[0], p[1]))));
        const smr_vec gx = halfway(ga, gb, smr_add(smr_mul(g, p[0]), o));
        worst_moved = fmax(worst_moved, (double)smr_length(smr_sub(gx, smr_add(smr_mul(g, x), o))));
    }
    assert_true(oracle_within("rigid, mm", worst, 1e-4));
    assert_true(oracle_within("moved, mm", worst_moved, 3e-4));
}
