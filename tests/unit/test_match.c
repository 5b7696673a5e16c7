/* test_match.c: clusters find the rotation that they were given, and whatever they are given, the answer is a
 * rotation.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include "registration/registration.h"

static const float none[3] = {0, 0, 0};

static smr *start(uint32_t method, const smr_mesh *mesh, float radius)
{
    const smr_prepare_config prepare = rig_radii(1, radius, 0, 0);
    smr_config config = smr_config_default();
    config.basic.method = method;
    config.motion.momentum = 0.0f;
    config.motion.fold_guard = 0;
    config.motion.plastic_every = 0;
    config.motion.plastic_um = config.motion.settle_um = 0.0f;
    smr *s = rig_init(rig_model(mesh, 1, &prepare), &config, NULL);
    assert_int_equal(SMR_OK, smr_tick(s, 0, NULL)); /* for the reference's own figures */
    return s;
}

static void run_all(void *stage, uint32_t n, smr_task run)
{
    for (uint32_t t = 0; t < n; t++)
        run(stage, t, 0);
}

/* Forces that carry x^r to m x^r + t, and the transforms that clusters make of them. */
static void drive(smr *s, const float m[9], smr_vec t)
{
    float u_max = 0.0f, l_max = 0.0f;
    for (uint32_t v = 0; v < s->shared.n; v++) {
        const smr_vec x = smr_load(smr_at3(s->shape.x, v)), f = smr_sub(smr_add(smr_mul(m, x), t), x);
        smr_store(smr_at3(s->forces.force, v), f);
        u_max = fmaxf(u_max, smr_length(f));
        l_max = fmaxf(l_max, 2.0f * smr_length(f) * smr_length(x));
    }
    s->sums.scale[0] = exp2f(floorf(log2f(1.0e9f / ((float)s->schedule.lists.largest * (u_max + 1.0e-9f)))));
    s->sums.scale[1] = exp2f(floorf(log2f(1.0e9f / ((float)s->schedule.lists.largest * (l_max + 1.0e-9f)))));
    s->sums.words = 12;
    run_all(&s->sums, s->shared.n_tasks, smr_sums_record);
    run_all(&s->sums, smr_block_tasks(&s->sums), smr_sums_forest);
    run_all(&s->match, smr_match_cluster_tasks(&s->match), smr_match_clusters);
}

static const float *transform_of(const smr *s, uint32_t v) { return (float *)(s->sums.sum + SMR_WORDS * (size_t)v); }

/* Largest distance between where clusters carry their own vertex and where it should go. */
static float miss(const smr *s, const float m[9], smr_vec t)
{
    float worst = 0.0f;
    for (uint32_t v = 0; v < s->shared.n; v++) {
        const float *own = transform_of(s, v);
        const smr_vec x = smr_load(smr_at3(s->shape.x_ref, v));
        const smr_vec got = smr_add(x, smr_add(smr_mul(own, x), smr_load(own + 9)));
        worst = fmaxf(worst, smr_length(smr_sub(got, smr_add(smr_mul(m, x), t))));
    }
    return worst;
}

static float not_rotation(const float *r_minus_i)
{
    float worst = 0.0f;
    for (uint32_t i = 0; i < 9u; i++) {
        float dot = 0.0f;
        for (uint32_t k = 0; k < 3u; k++) {
            const float a = r_minus_i[3u * k + i / 3u] + (k == i / 3u ? 1.0f : 0.0f);
            const float b = r_minus_i[3u * k + i % 3u] + (k == i % 3u ? 1.0f : 0.0f);
            dot += a * b;
        }
        worst = fmaxf(worst, fabsf(dot - (i % 4u == 0u ? 1.0f : 0.0f)));
    }
    return worst;
}

TEST(test_polar_finds_any_rotation)
{
    const smr_mesh mesh = rig_ball(30, 9, 12, none);
    smr *s = start(SMR_METHOD_POLAR, &mesh, 18);
    for (uint32_t k = 0; k < 8u; k++) {
        float m[9];
        rig_rotation(1, (float)k - 3.0f, 0.3f, 22.0f * (float)k, m); /* up to 154 degrees */
        drive(s, m, smr_v(3, -2, (float)k));
        assert_true(miss(s, m, smr_v(3, -2, (float)k)) < 5.0e-3f);
    }
}

/* Whatever pulls, the answer is a rotation. */
TEST(test_always_a_rotation)
{
    static float line[30], plane[30], point[30];
    const smr_mesh ball = rig_ball(30, 5, 6, none);
    uint32_t seed = 8;
    for (uint32_t i = 0; i < 10u; i++) {
        line[3u * i + 1u] = 3.0f * (float)i;
        plane[3u * i] = 3.0f * (float)(i % 3u);
        plane[3u * i + 2u] = 3.0f * (float)(i / 3u);
    }
    const smr_mesh shapes[] = {
        ball, {line, NULL, 10, 0}, {plane, NULL, 10, 0}, {point, NULL, 10, 0}, {line, NULL, 2, 0}, {line, NULL, 1, 0}};
    for (uint32_t k = 0; k < 12u; k++) {
        smr *s = start(k % 2u, &shapes[k / 2u], 18);
        for (uint32_t round = 0; round < 20u; round++) {
            float m[9];
            for (uint32_t i = 0; i < 9u; i++) /* any linear map: reflections, flattening, and nothing at all */
                m[i] = round % 5u == 4u ? 0.0f : rig_between(&seed, -3, 3);
            drive(s, m, smr_v(rig_between(&seed, -9, 9), 2, 1));
            for (uint32_t v = 0; v < s->shared.n; v++) {
                for (uint32_t i = 0; i < 12u; i++)
                    assert_true(isfinite(transform_of(s, v)[i]));
                assert_true(not_rotation(transform_of(s, v)) < 1.0e-4f);
            }
        }
    }
}
