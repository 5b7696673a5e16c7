/* test_align_landmarks.c: the start pose from landmarks. Accuracy: known poses of bodies of 600 mm are found within
 * 1e-3 mm, from few and nearly collinear landmarks within 0.2 mm; with noise the remaining distance is within 1e-4 of
 * the oracle's.
 * SPDX-License-Identifier: MIT */
#include "suite.h"

#include <math.h>
#include <string.h>

#include "oracle.h"
#include "smr.h"

typedef struct pairs {
    float from[SMR_LANDMARKS_MAX][3], to[SMR_LANDMARKS_MAX][3];
    uint32_t n;
} pairs;

/* n points of a body of 600 mm, turned, scaled, shifted, and moved by up to `noise` each. */
static pairs plant(oracle_random *r, uint32_t n, double scale, double noise)
{
    pairs p;
    double turn[9], shift[3];
    memset(&p, 0, sizeof p);
    p.n = n;
    oracle_rotation(r, turn);
    for (int c = 0; c < 3; c++)
        shift[c] = oracle_uniform(r, -300, 300);
    for (uint32_t i = 0; i < n; i++) {
        double x[3];
        for (int c = 0; c < 3; c++) {
            x[c] = oracle_uniform(r, -300, 300);
            p.from[i][c] = (float)x[c];
        }
        for (int c = 0; c < 3; c++)
            p.to[i][c] = (float)(scale * (turn[3 * c] * x[0] + turn[3 * c + 1] * x[1] + turn[3 * c + 2] * x[2]) +
                                 shift[c] + oracle_uniform(r, -noise, noise));
    }
    return p;
}

static double rms_of(const pairs *p, const smr_pose *pose)
{
    double sum = 0.0;
    for (uint32_t i = 0; i < p->n; i++)
        for (int c = 0; c < 3; c++) {
            double d = (double)pose->m[c][3] - (double)p->to[i][c];
            for (int k = 0; k < 3; k++)
                d += (double)pose->m[c][k] * (double)p->from[i][k];
            sum += d * d;
        }
    return sqrt(sum / p->n);
}

TEST(finds_planted_poses)
{
    oracle_random r = oracle_seed(300);
    double worst[2] = {0.0, 0.0}, scales = 0.0;
    for (uint32_t i = 0; i < 2000u; i++) {
        const uint32_t scaled = i % 2u, n = 3u + i % 62u;
        const double scale = scaled ? oracle_uniform(&r, 0.7, 1.4) : 1.0;
        const pairs p = plant(&r, n, scale, 0.0);
        smr_pose pose;
        float rms = -1.0f;
        assert_int_equal(smr_align_landmarks(p.from[0], p.to[0], n, scaled, &pose, &rms), SMR_OK);
        worst[n < 6u] = fmax(worst[n < 6u], fmax(rms_of(&p, &pose), (double)rms));
        scales = fmax(scales, fabs(sqrt((double)(pose.m[0][0] * pose.m[0][0] + pose.m[1][0] * pose.m[1][0] +
                                                 pose.m[2][0] * pose.m[2][0])) -
                                   scale));
    }
    assert_true(oracle_within("landmarks: planted pose, mm", worst[0], 1e-3));
    assert_true(oracle_within("landmarks: planted pose of few, mm", worst[1], 0.2));
    assert_true(oracle_within("landmarks: planted scale", scales, 1e-5));
}

/* A rigid fit of noisy pairs: no worse than the polar factor of their covariance in double precision. */
TEST(is_the_least_square)
{
    oracle_random r = oracle_seed(301);
    double worst = 0.0;
    for (uint32_t i = 0; i < 200u; i++) {
        const pairs p = plant(&r, 15, 1.0, 20.0);
        double middle[2][3] = {{0}}, cross[9] = {0}, turn[9], singular[3];
        smr_pose pose, best;
        float rms = 0.0f;
        for (uint32_t k = 0; k < p.n; k++)
            for (int c = 0; c < 3; c++) {
                middle[0][c] += (double)p.from[k][c] / p.n;
                middle[1][c] += (double)p.to[k][c] / p.n;
            }
        for (uint32_t k = 0; k < p.n; k++)
            for (int c = 0; c < 9; c++)
                cross[c] += ((double)p.to[k][c / 3] - middle[1][c / 3]) * ((double)p.from[k][c % 3] - middle[0][c % 3]);
        oracle_polar(cross, turn, singular);
        for (int c = 0; c < 3; c++) {
            double shift = middle[1][c];
            for (int k = 0; k < 3; k++) {
                best.m[c][k] = (float)turn[3 * c + k];
                shift -= turn[3 * c + k] * middle[0][k];
            }
            best.m[c][3] = (float)shift;
        }
        assert_int_equal(smr_align_landmarks(p.from[0], p.to[0], p.n, 0, &pose, &rms), SMR_OK);
        worst = fmax(worst, fabs((double)rms - rms_of(&p, &best)));
    }
    assert_true(oracle_within("landmarks: remaining distance against the oracle's, mm", worst, 1e-4));
}

TEST(refuses)
{
    oracle_random r = oracle_seed(303);
    pairs p = plant(&r, 5, 1.0, 0.0);
    smr_pose pose, before;
    memset(&pose, 7, sizeof pose);
    before = pose;
    assert_int_equal(smr_align_landmarks(NULL, p.to[0], 5, 0, &pose, NULL), SMR_E_NULL);
    assert_int_equal(smr_align_landmarks(p.from[0], NULL, 5, 0, &pose, NULL), SMR_E_NULL);
    assert_int_equal(smr_align_landmarks(p.from[0], p.to[0], 5, 0, NULL, NULL), SMR_E_NULL);
    assert_int_equal(smr_align_landmarks(p.from[0], p.to[0], 0, 0, &pose, NULL), SMR_E_INPUT);
    assert_int_equal(smr_align_landmarks(p.from[0], p.to[0], SMR_LANDMARKS_MAX + 1u, 0, &pose, NULL), SMR_E_INPUT);
    assert_int_equal(smr_align_landmarks(p.from[0], p.to[0], 5, 2, &pose, NULL), SMR_E_INPUT);
    p.to[4][2] = NAN;
    assert_int_equal(smr_align_landmarks(p.from[0], p.to[0], 5, 0, &pose, NULL), SMR_E_INPUT);
    p.to[4][2] = 2.0f * SMR_COORD_MAX;
    assert_int_equal(smr_align_landmarks(p.from[0], p.to[0], 5, 0, &pose, NULL), SMR_E_INPUT);
    assert_memory_equal(&pose, &before, sizeof pose);
    assert_int_equal(smr_align_landmarks(p.from[0], p.to[0], 4, 0, &pose, NULL), SMR_OK);
}
