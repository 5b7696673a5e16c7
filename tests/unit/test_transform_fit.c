/* test_transform_fit.c: least-squares rigid and scaled transforms. Accuracy against double precision: known rotations
 * 5e-6 in each entry, scales 2e-6 relative, positions 2e-6 of the spread (and 5e-7 of the coordinates when far from
 * 0).
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include "geometry/rotation/similarity_fit.h"
#include "oracle.h"

enum { POINTS = 60 };

typedef struct planted {
    double turn[9], scale, shift[3];
} planted;

static planted plant(oracle_random *r, int scaled, double far)
{
    planted p;
    oracle_rotation(r, p.turn);
    p.scale = scaled ? pow(10.0, oracle_uniform(r, -0.8, 0.8)) : 1.0;
    for (int k = 0; k < 3; k++)
        p.shift[k] = oracle_uniform(r, -far, far);
    return p;
}

static void apply(const planted *p, const double x[3], double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] =
            p->scale * (p->turn[3 * k] * x[0] + p->turn[3 * k + 1] * x[1] + p->turn[3 * k + 2] * x[2]) + p->shift[k];
}

static double determinant(const smr_pose *p, double *not_rotation)
{
    double m[9];
    for (int i = 0; i < 9; i++)
        m[i] = (double)p->m[i / 3][i % 3];
    const double s = cbrt(oracle_determinant(m));
    for (int i = 0; i < 9; i++)
        m[i] /= s;
    *not_rotation = oracle_not_rotation(m);
    return s;
}

TEST(finds_planted_poses)
{
    oracle_random r = oracle_seed(90);
    double worst = 0.0, worst_scale = 0.0, worst_at = 0.0;
    for (uint32_t i = 0; i < 2000u; i++) {
        const int scaled = (int)(i % 2u), planar = i % 3u == 0u;
        const double far = i % 5u == 0u ? 5e4 : 100.0;
        const planted p = plant(&r, scaled, far);
        double at[3], from[3];
        for (uint32_t c = 0; c < 3u; c++) {
            at[c] = oracle_uniform(&r, -far, far);
            from[c] = floor(at[c]);
        }
        double to[3];
        apply(&p, from, to);
        smr_fit f;
        smr_fit_start(&f, smr_v((float)from[0], (float)from[1], (float)from[2]),
                      smr_v((float)to[0], (float)to[1], (float)to[2]));
        for (uint32_t k = 0; k < POINTS; k++) {
            double x[3], y[3];
            for (int c = 0; c < 3; c++) /* floats of few digits, so that far-away points are still exact */
                x[c] = (double)(float)floor(at[c]) + 0.0625 * floor(oracle_uniform(&r, -800, 800));
            if (planar)
                x[2] = floor(at[2]);
            apply(&p, x, y);
            smr_fit_add(&f, smr_v((float)x[0], (float)x[1], (float)x[2]), smr_v((float)y[0], (float)y[1], (float)y[2]),
                        oracle_uniformf(&r, 0.1f, 2.0f));
        }
        const smr_pose got = smr_fit_solve(&f, scaled);
        const double rounding = far > 1e3 ? 20.0 : 1.0; /* y was rounded to floats of that size */
        for (int c = 0; c < 9; c++)
            worst = fmax(worst, fabs((double)got.m[c / 3][c % 3] / p.scale - p.turn[c]) / rounding);
        double off;
        worst_scale = fmax(worst_scale, fabs(determinant(&got, &off) / p.scale - 1.0) / rounding);
        double want[3];
        apply(&p, at, want);
        for (int c = 0; c < 3; c++) {
            const double x = (double)got.m[c][0] * at[0] + (double)got.m[c][1] * at[1] + (double)got.m[c][2] * at[2] +
                             (double)got.m[c][3];
            const double budget = 2e-6 * 50.0 * p.scale + 5e-7 * far * fmax(1.0, p.scale) * 2.0;
            worst_at = fmax(worst_at, fabs(x - want[c]) / budget);
        }
    }
    assert_true(oracle_within("fit: rotation", worst, 5e-6));
    assert_true(oracle_within("fit: scale, relative", worst_scale, 2e-6));
    assert_true(oracle_within("fit: position, of its budget", worst_at, 1.0));
}

/* With noise: no small turn, scale or shift of the answer does better. */
TEST(is_the_least_square)
{
    oracle_random r = oracle_seed(91);
    double worst = 0.0;
    for (uint32_t i = 0; i < 100u; i++) {
        const planted p = plant(&r, 0, 50.0);
        static double x[POINTS][3], y[POINTS][3];
        smr_fit f;
        smr_fit_start(&f, smr_v(0, 0, 0), smr_v(0, 0, 0));
        for (uint32_t k = 0; k < POINTS; k++) {
            for (int c = 0; c < 3; c++)
                x[k][c] = (double)oracle_uniformf(&r, -50, 50);
            apply(&p, x[k], y[k]);
            for (int c = 0; c < 3; c++)
                y[k][c] = (double)(float)(y[k][c] + oracle_uniform(&r, -5, 5));
            smr_fit_add(&f, smr_v((float)x[k][0], (float)x[k][1], (float)x[k][2]),
                        smr_v((float)y[k][0], (float)y[k][1], (float)y[k][2]), 1.0f);
        }
        const smr_pose got = smr_fit_solve(&f, 0);
        double best = 0.0;
        for (uint32_t trial = 0; trial < 60u; trial++) {
            double turn[9], axis[3], sum = 0.0, shift[3];
            for (int c = 0; c < 3; c++) {
                axis[c] = oracle_uniform(&r, -1, 1);
                shift[c] = trial == 0u ? 0.0 : oracle_uniform(&r, -0.02, 0.02);
            }
            oracle_turn(axis, trial == 0u ? 0.0 : oracle_uniform(&r, -1e-3, 1e-3), turn);
            for (uint32_t k = 0; k < POINTS; k++) {
                double z[3], t[3];
                for (int c = 0; c < 3; c++)
                    z[c] =
                        (double)got.m[c][0] * x[k][0] + (double)got.m[c][1] * x[k][1] + (double)got.m[c][2] * x[k][2];
                for (int c = 0; c < 3; c++) {
                    t[c] = turn[3 * c] * z[0] + turn[3 * c + 1] * z[1] + turn[3 * c + 2] * z[2] + (double)got.m[c][3] +
                           shift[c];
                    sum += (t[c] - y[k][c]) * (t[c] - y[k][c]);
                }
            }
            if (trial == 0u)
                best = sum;
            else
                worst = fmax(worst, (best - sum) / best);
        }
    }
    assert_true(oracle_within("fit: a neighbour is better by, relative", worst, 1e-8));
}

TEST(degenerate_pairs_have_an_answer)
{
    oracle_random r = oracle_seed(92);
    double worst = 0.0;
    smr_fit f;
    smr_fit_start(&f, smr_v(0, 0, 0), smr_v(0, 0, 0));
    smr_pose none = smr_fit_solve(&f, 1);
    for (int i = 0; i < 12; i++)
        assert_true(none.m[i / 4][i % 4] == (i % 5 == 0 ? 1.0f : 0.0f));
    for (uint32_t i = 0; i < 2000u; i++) {
        const uint32_t kind = i % 5u, n = kind == 0u ? 1u : (kind == 1u ? 2u : 10u);
        smr_fit_start(&f, smr_v(0, 0, 0), smr_v(0, 0, 0));
        for (uint32_t k = 0; k < n; k++) {
            float p[3];
            oracle_within_box(&r, -9, 9, p);
            smr_vec a = smr_load(p), b = a;
            if (kind == 2u) /* collinear to collinear */
                a = smr_v((float)k, (float)k, 1), b = smr_v(0, (float)k, 2);
            if (kind == 3u) /* all the same */
                a = smr_v(1, 2, 3), b = smr_v(-3, 2, 9);
            if (kind == 4u) /* reflected */
                b = smr_v(-a.x, a.y, a.z);
            smr_fit_add(&f, a, b, 1.0f);
        }
        const smr_pose p = smr_fit_solve(&f, (int)(i / 5u % 2u));
        double off;
        assert_true(determinant(&p, &off) > 0.0);
        worst = fmax(worst, off);
        for (int k = 0; k < 3; k++)
            assert_true(fabsf(p.m[k][3]) < 1e3f);
    }
    assert_true(oracle_within("fit: degenerate pairs, rotation", worst, 3e-6));
}
