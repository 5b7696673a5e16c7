/* test_input_checksum.c: any single bit of any input changes its checksum, and so do counts, order, mask and type.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <string.h>
#include "log/record/log_format.h"

TEST(test_points)
{
    float xyz[3 * 7], other[3 * 7];
    for (uint32_t i = 0; i < 21u; i++)
        xyz[i] = 1.5f * (float)i - 7.0f;
    const uint64_t sum = smr_points_checksum(xyz, 7);
    assert_true(sum != 0u);
    for (size_t bit = 0; bit < 8u * sizeof xyz; bit++) {
        memcpy(other, xyz, sizeof xyz);
        ((unsigned char *)other)[bit / 8u] ^= (unsigned char)(1u << bit % 8u);
        assert_true(smr_points_checksum(other, 7) != sum);
    }
    assert_true(smr_points_checksum(xyz, 6) != sum);
    memcpy(other, xyz + 3, 3u * sizeof(float)); /* the first two change places */
    memcpy(other + 3, xyz, 3u * sizeof(float));
    memcpy(other + 6, xyz + 6, 15u * sizeof(float));
    assert_true(smr_points_checksum(other, 7) != sum);
}

TEST(test_surfaces)
{
    const float centre[3] = {100, 0, 0};
    const smr_mesh ball = rig_ball(20, 5, 8, centre);
    const uint64_t sum = smr_surface_checksum(rig_surface(&ball));
    assert_true(smr_surface_checksum(rig_surface(&ball)) == sum); /* elsewhere in memory */
    for (uint32_t i = 0; i < 3u * ball.n_vertices; i++) {
        float *xyz = rig_alloc(ball.n_vertices * 3u * sizeof *xyz);
        smr_mesh other = ball;
        memcpy(xyz, ball.xyz, ball.n_vertices * 3u * sizeof *xyz);
        xyz[i] += 0.0625f;
        other.xyz = xyz;
        assert_true(smr_surface_checksum(rig_surface(&other)) != sum);
    }
    for (uint32_t k = 0; k < ball.n_triangles; k++) { /* a triangle turned over */
        uint32_t *triangles = rig_alloc(ball.n_triangles * 3u * sizeof *triangles);
        smr_mesh other = ball;
        memcpy(triangles, ball.triangles, ball.n_triangles * 3u * sizeof *triangles);
        triangles[3u * k] = ball.triangles[3u * k + 1u];
        triangles[3u * k + 1u] = ball.triangles[3u * k];
        other.triangles = triangles;
        assert_true(smr_surface_checksum(rig_surface(&other)) != sum);
    }
}

/* Voxels of every type: sizes that do not fill the last word. */
TEST(test_volumes)
{
    static const uint32_t bytes[] = {1, 1, 2, 2, 4};
    static _Alignas(8) unsigned char voxels[4 * 3 * 3 * 3], mask[27];
    for (uint32_t type = 0; type < 5u; type++) {
        smr_volume v = {voxels, NULL, type, {3, 3, 3}, {1, 2, 3}, {1, 1, 2}, {1, 0, 0, 0, 1, 0, 0, 0, 1}};
        for (size_t i = 0; i < sizeof voxels; i++)
            voxels[i] = (unsigned char)(i * 37u % 60u);
        const uint64_t sum = smr_volume_checksum(&v);
        for (size_t bit = 0; bit < 8u * 27u * bytes[type]; bit++) {
            voxels[bit / 8u] ^= (unsigned char)(1u << bit % 8u);
            assert_true(smr_volume_checksum(&v) != sum);
            voxels[bit / 8u] ^= (unsigned char)(1u << bit % 8u);
        }
        assert_true(smr_volume_checksum(&v) == sum);
        v.mask = mask;
        memset(mask, 1, sizeof mask);
        const uint64_t masked = smr_volume_checksum(&v);
        assert_true(masked != sum);
        mask[26] = 0;
        assert_true(smr_volume_checksum(&v) != masked);
        v.mask = NULL;
        v.spacing[1] = 1.5f;
        assert_true(smr_volume_checksum(&v) != sum);
        v.spacing[1] = 1.0f;
        v.size[0] = 1;
        v.size[1] = 9;
        assert_true(smr_volume_checksum(&v) != sum);
    }
}

/* A changed coordinate or weight of a goal, and the absence of weights, change the checksum of goals. */
TEST(test_goals)
{
    float xyz[3 * 4] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}, weights[4] = {1, 1, 0.5f, 1};
    const smr_goals goals = {.xyz = xyz, .weights = weights}, bare = {.xyz = xyz};
    const uint64_t sum = smr_log_checksum(SMR_LOG_GOALS, &goals, 4),
                   without = smr_log_checksum(SMR_LOG_GOALS, &bare, 4);
    assert_true(sum != without);
    for (uint32_t i = 0; i < 12u; i++) {
        xyz[i] += 0.5f;
        assert_true(smr_log_checksum(SMR_LOG_GOALS, &goals, 4) != sum);
        assert_true(smr_log_checksum(SMR_LOG_GOALS, &bare, 4) != without);
        xyz[i] -= 0.5f;
    }
    weights[3] = 0.25f;
    assert_true(smr_log_checksum(SMR_LOG_GOALS, &goals, 4) != sum);
}

/* Masses and velocities have different checksums, alone and together, whatever their values: those that earlier
 * versions wrote into logs. */
TEST(test_motions)
{
    static const float values[3 * 4] = {0};
    const smr_motion motion[4] = {{0}, {.mass = values}, {.velocity = values}, {.mass = values, .velocity = values}};
    for (uint32_t a = 0; a < 4u; a++)
        for (uint32_t b = 0; b < a; b++)
            assert_true(smr_log_checksum(SMR_LOG_MOTION, &motion[a], 4) !=
                        smr_log_checksum(SMR_LOG_MOTION, &motion[b], 4));
    assert_true(smr_log_checksum(SMR_LOG_MOTION, &motion[3], 4) == 0xc18c1197800ebd8fu);
}
