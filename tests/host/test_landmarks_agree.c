/* test_landmarks_agree.c: pairs of landmarks that cannot be meant are told from those that two people have.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include <string.h>
#include "files/gzip_write.h"
#include "register/register_job.h"
#include "unit/oracle.h"

enum { PAIRS = 12, RUNS = 200 };

typedef struct pairs {
    float from[PAIRS][3], to[PAIRS][3];
} pairs;

/* Landmarks over 400 mm, turned and scaled by 0.9, each moved by up to `noise` mm along each axis. */
static pairs make(oracle_random *r, double noise)
{
    const double axis[3] = {0.6, 0.0, 0.8};
    double turn[9];
    pairs p;
    oracle_turn(axis, 0.7, turn);
    for (int i = 0; i < PAIRS; i++)
        for (int c = 0; c < 3; c++)
            p.from[i][c] = (float)oracle_uniform(r, -200.0, 200.0);
    for (int i = 0; i < PAIRS; i++)
        for (int c = 0; c < 3; c++)
            p.to[i][c] = (float)(0.9 * (turn[3 * c] * (double)p.from[i][0] + turn[3 * c + 1] * (double)p.from[i][1] +
                                        turn[3 * c + 2] * (double)p.from[i][2]) +
                                 50.0 + oracle_uniform(r, -noise, noise));
    return p;
}

TEST(people_agree)
{
    oracle_random r = oracle_seed(1);
    for (int run = 0; run < RUNS; run++) {
        const pairs p = make(&r, 20.0);
        const host_landmark_doubt doubt = host_landmarks_agree(p.from[0], p.to[0], PAIRS);
        assert_int_equal(doubt.kind, HOST_LANDMARKS_AGREE);
        assert_true(doubt.scale > 0.8 && doubt.scale < 1.0);
    }
}

TEST(finds_an_exchange)
{
    oracle_random r = oracle_seed(2);
    int run = 0, found = 0;
    for (run = 0; run < RUNS; run++) {
        pairs p = make(&r, 10.0);
        float keep[3];
        memcpy(keep, p.to[3], sizeof keep);
        memcpy(p.to[3], p.to[8], sizeof keep);
        memcpy(p.to[8], keep, sizeof keep);
        const host_landmark_doubt doubt = host_landmarks_agree(p.from[0], p.to[0], PAIRS);
        found += doubt.kind == HOST_LANDMARKS_SWAPPED && doubt.first == 3 && doubt.second == 8;
    }
    assert_true(found > RUNS * 95 / 100); /* not those that lie beside each other */
}

TEST(finds_one_far_off)
{
    oracle_random r = oracle_seed(3);
    int run = 0, found = 0;
    for (run = 0; run < RUNS; run++) {
        pairs p = make(&r, 5.0);
        p.to[4][run % 3] += 90.0f;
        const host_landmark_doubt doubt = host_landmarks_agree(p.from[0], p.to[0], PAIRS);
        found += doubt.kind == HOST_LANDMARK_OFF && doubt.first == 4 && fabs(doubt.off_mm - 90.0) < 20.0;
    }
    assert_true(found > RUNS * 95 / 100);
}

TEST(finds_sets_that_do_not_fit)
{
    oracle_random r = oracle_seed(4);
    pairs p = make(&r, 0.0);
    const pairs other = make(&r, 0.0);
    assert_int_equal(host_landmarks_agree(p.from[0], other.to[0], PAIRS).kind, HOST_LANDMARKS_APART);
    assert_int_equal(host_landmarks_agree(p.from[0], other.to[0], 4).kind, HOST_LANDMARKS_AGREE); /* too few to tell */
    memset(p.from, 0, sizeof p.from);
    assert_true(!(host_landmarks_agree(p.from[0], p.to[0], PAIRS).scale > 0.0));
}

/* The check value of the standard, in one piece and in two. */
TEST(checksum_is_the_standard_one)
{
    static host_crc32 crc;
    host_crc32_start(&crc);
    assert_int_equal(host_crc32_end(&crc), 0);
    host_crc32_add(&crc, "12345", 5);
    host_crc32_add(&crc, "6789", 4);
    assert_int_equal(host_crc32_end(&crc), 0xcbf43926u);
    host_crc32_start(&crc);
    host_crc32_add(&crc, "123456789", 9);
    assert_int_equal(host_crc32_end(&crc), 0xcbf43926u);
}
