/* test_smooth.c: smoothing takes noise off a surface; what stands out at rest stays, no motion is resisted, and an
 * open border keeps its place.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include <string.h>
#include "registration/registration.h"

static const float none[3] = {0, 0, 0};
static const smr_model *model;

static smr_config config_of(float smooth)
{
    smr_config c = smr_config_default();
    c.contact.smooth = smooth;
    c.schedule.radius_first = 1;
    c.motion.settle_um = 0.0f;
    c.basic.iterations_last = 30;
    return c;
}

static smr *start(const smr_mesh *mesh, const smr_config *config)
{
    const smr_prepare_config radii = rig_radii(2, 20, 0.1f, 0);
    model = rig_model(mesh, 1, &radii);
    return rig_init(model, config, NULL);
}

/* The mesh's vertices, each moved by noise of +-1 mm along the line from the origin. */
static float *noisy(const smr_mesh *mesh)
{
    float *xyz = rig_alloc(3u * (size_t)mesh->n_vertices * sizeof(float));
    uint32_t seed = 11;
    for (uint32_t i = 0; i < mesh->n_vertices; i++) {
        const smr_vec p = smr_load(mesh->xyz + 3u * (size_t)i);
        smr_store(xyz + 3u * (size_t)i, smr_add(p, smr_scale(smr_unit(p), rig_between(&seed, -1.0f, 1.0f))));
    }
    return xyz;
}

/* Deviation of the distances from the origin, over vertices whose z is at least `above`; *mean of them. */
static float rough(const float *xyz, uint32_t n, const smr_mesh *rest, float above, float *mean)
{
    float sum = 0.0f, sum2 = 0.0f, count = 0.0f;
    for (uint32_t i = 0; i < n; i++) {
        if (rest->xyz[3u * (size_t)i + 2u] < above)
            continue;
        const float r = smr_length(smr_load(xyz + 3u * (size_t)i));
        sum += r;
        sum2 += r * r;
        count += 1.0f;
    }
    *mean = sum / count;
    return sqrtf(smr_max(sum2 / count - *mean * *mean, 0.0f));
}

/* Of noise, without a target: more of it goes the larger the share. */
TEST(test_noise_falls)
{
    static const float share[] = {0.0f, 0.1f, 0.5f, 1.0f};
    const smr_mesh ball = rig_ball(30, 14, 20, none);
    const float *xyz = noisy(&ball);
    float mean, before = rough(xyz, ball.n_vertices, &ball, -100.0f, &mean), last = 1.0f;
    for (uint32_t i = 0; i < 4u; i++) {
        const smr_config c = config_of(share[i]);
        smr *s = start(&ball, &c);
        assert_int_equal(SMR_OK, smr_set_positions(s, 0, xyz));
        (void)rig_run(s, 4);
        const float left = rough(rig_positions(s, model), ball.n_vertices, &ball, -100.0f, &mean) / before;
        assert_true(i == 0u ? left > 0.999f : left < last);
        assert_float_equal(mean, 30.0f, 0.2f);
        last = left;
    }
    assert_true(last < 0.5f);
}

/* At rest, turned and scaled nothing moves, whatever stands out there. */
TEST(test_motion_is_free)
{
    smr_mesh bone, target;
    float m[9];
    smr_pose pose = {{{0, 0, 0, 40}, {0, 0, 0, -7}, {0, 0, 0, 300}}};
    const smr_config c = config_of(1.0f);
    rig_bone(9000, 1.0f, &bone, &target);
    rig_rotation(3, 1, -2, 110, m);
    for (uint32_t i = 0; i < 9u; i++)
        pose.m[i / 3u][i % 3u] = 1.3f * m[i];
    smr *s = start(&bone, &c);
    assert_int_equal(SMR_OK, smr_set_pose(s, &pose));
    const float *before = rig_positions(s, model);
    (void)rig_run(s, 20);
    assert_true(rig_far(rig_positions(s, model), before, bone.n_vertices) < 0.02f);
}

/* A ball's upper half: its open border stays where it is, noisy or not. */
TEST(test_border)
{
    const smr_mesh ball = rig_ball(30, 14, 20, none);
    smr_mesh half = ball;
    const smr_config c = config_of(0.6f);
    uint32_t *kept = rig_alloc(3u * (size_t)ball.n_triangles * sizeof(uint32_t));
    float mean = 0.0f, least = 100.0f;
    half.triangles = kept;
    half.n_triangles = 0;
    for (uint32_t k = 0; k < ball.n_triangles; k++) {
        const uint32_t *t = ball.triangles + 3u * (size_t)k;
        if (ball.xyz[3u * t[0] + 2u] < -1.0f || ball.xyz[3u * t[1] + 2u] < -1.0f || ball.xyz[3u * t[2] + 2u] < -1.0f)
            continue;
        memcpy(kept + 3u * (size_t)half.n_triangles++, t, 3u * sizeof *t);
    }
    assert_true(half.n_triangles > 100u && half.n_triangles < ball.n_triangles);
    smr *s = start(&half, &c);
    (void)rig_run(s, 25);
    assert_true(rig_far(rig_positions(s, model), ball.xyz, ball.n_vertices) < 0.001f);
    const float *xyz = noisy(&ball);
    assert_int_equal(SMR_OK, smr_set_positions(s, 0, xyz));
    const float before = rough(xyz, ball.n_vertices, &ball, -1.0f, &mean);
    (void)rig_run(s, 25);
    xyz = rig_positions(s, model);
    assert_true(rough(xyz, ball.n_vertices, &ball, -1.0f, &mean) < 0.5f * before);
    for (uint32_t i = 0; i < ball.n_vertices; i++)
        if (ball.xyz[3u * i + 2u] >= -1.0f)
            least = smr_min(least, xyz[3u * i + 2u]);
    assert_float_equal(mean, 30.0f, 0.3f);
    assert_true(least < 1.0f + 2.0f); /* the lowest circle is still there */
}
