/* test_tangent_evening.c: at the last radius a vertex moves along the surface towards where its displacement is its
 * neighbours' mean; the fraction fades, and nothing moves where evening is not allowed.
 * SPDX-License-Identifier: MIT */
#include "cmocka_first.h"

#include <math.h>
#include <string.h>

#include "property/rig.h"
#include "registration/registration.h"

static int tidy(void **state)
{
    (void)state;
    rig_free_all();
    return 0;
}

static const float none[3] = {0, 0, 0};

static smr *start(const smr_config *config, const smr_model **model, int with_target)
{
    const smr_mesh mesh = rig_ball(30, 9, 12, none), goal = rig_ball(31, 12, 16, none);
    const smr_prepare_config radii = rig_radii(2, 18, 0.01f, 0);
    *model = rig_model(&mesh, 1, &radii);
    smr *s = rig_init(*model, config, NULL);
    if (with_target)
        assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, rig_surface(&goal)));
    return s;
}

static smr_config quiet(void)
{
    smr_config c = smr_config_default();
    c.motion.fold_guard = 0;
    c.motion.settle_um = 0.0f;
    c.basic.iterations = 2;
    return c;
}

/* One vertex displaced along the surface by `off`: how far it still is off after each iteration of the last radius. */
static void spike(float even, uint32_t radius_first, int with_target, float *left, uint32_t n)
{
    smr_config c = quiet();
    const smr_model *model;
    const uint32_t v = 50;
    const smr_mesh mesh = rig_ball(30, 9, 12, none);
    float *xyz = rig_alloc(mesh.n_vertices * 3u * sizeof *xyz);
    c.basic.even = even;
    c.schedule.radius_first = radius_first;
    c.basic.attraction = 0.0f;
    smr *s = start(&c, &model, with_target);
    const smr_vec p = smr_load(mesh.xyz + 3u * v), along = smr_unit(smr_v(-p.y, p.x, 0));
    memcpy(xyz, mesh.xyz, mesh.n_vertices * 3u * sizeof *xyz);
    smr_store(xyz + 3u * v, smr_add(p, along)); /* by 1 mm */
    assert_int_equal(SMR_OK, smr_set_positions(s, 0, xyz));
    for (uint32_t i = 0; i < n; i++) {
        (void)rig_run(s, 1);
        const smr_vec at = smr_load(rig_positions(s, model) + 3u * v);
        left[i] = smr_dot(smr_sub(at, p), along);
    }
}

static void test_spike_goes(void **state)
{
    float plain[40], even[40];
    (void)state;
    spike(0.0f, 1, 1, plain, 40);
    spike(0.5f, 1, 1, even, 40);
    assert_true(plain[39] > 0.8f);                  /* nothing else brings it back */
    assert_true(even[0] > 0.4f && even[0] < 0.65f); /* half of the way in the first iteration */
    assert_true(even[1] < even[0] && even[39] < 0.12f);
}

/* Not before the last radius, and not without a target. */
static void test_where(void **state)
{
    float plain[2], even[2];
    (void)state;
    for (uint32_t k = 0; k < 2u; k++) {
        spike(0.0f, k, k == 0u, plain, 2);
        spike(1.0f, k, k == 0u, even, 2);
        assert_memory_equal(plain, even, sizeof plain);
    }
}

/* Against a formula: the step is the share of the way to the neighbours' mean, without its part along the normal. */
static void test_step(void **state)
{
    smr_config c = quiet();
    const smr_model *model;
    (void)state;
    c.basic.even = 0.8f;
    c.schedule.radius_first = 1;
    c.basic.iterations_last = 10;
    c.basic.attraction = 0.0f;
    smr *s = start(&c, &model, 1);
    for (uint32_t i = 0; i < 3u * s->shared.n; i++)
        s->shape.x[i] += 0.01f * (float)(i * 7u % 13u);
    s->schedule.radius_iteration = 5;
    s->forces.surface.target[0].had_target = 1;
    smr_tangent_begin(&s->evolve.tangent_smooth);
    assert_true(fabsf(s->evolve.tangent_smooth.share - 0.8f * 0.25f) < 1.0e-6f);
    for (uint32_t t = 0; t < smr_tangent_tasks(&s->evolve.tangent_smooth); t++)
        smr_tangent_clear(&s->evolve.tangent_smooth, t, 0);
    for (uint32_t t = 0; t < smr_tangent_sum_tasks(&s->evolve.tangent_smooth); t++)
        smr_tangent_sum(&s->evolve.tangent_smooth, t, 0);
    for (uint32_t v = 0; v < s->shared.n; v += 11u) {
        double sum[3] = {0, 0, 0}, n = 0.0, way[3], along = 0.0;
        for (uint32_t k = 0; k < 3u * s->shared.n_triangles; k++) {
            for (uint32_t j = 1; s->shared.triangle[k] == v && j < 3u; j++) {
                const uint32_t w = s->shared.triangle[k / 3u * 3u + (k + j) % 3u];
                for (uint32_t a = 0; a < 3u; a++)
                    sum[a] += (double)(s->shape.x[3u * w + a] - s->shape.start[3u * w + a]);
                n += 1.0;
            }
        }
        for (uint32_t a = 0; a < 3u; a++) {
            way[a] = sum[a] / n - (double)(s->shape.x[3u * v + a] - s->shape.start[3u * v + a]);
            along += way[a] * (double)s->shape.normal[3u * v + a];
        }
        const smr_vec step = smr_tangent_displacement(&s->evolve.tangent_smooth, v);
        const double got[3] = {(double)step.x, (double)step.y, (double)step.z};
        for (uint32_t a = 0; a < 3u; a++)
            assert_true(fabs(got[a] - 0.2 * (way[a] - along * (double)s->shape.normal[3u * v + a])) < 1.0e-5);
        s->evolve.tangent_smooth.limited[v] =
            51; /* where the fold guard held back a fifth of a step, four fifths of it are left */
        assert_true(fabs((double)smr_length(smr_tangent_displacement(&s->evolve.tangent_smooth, v)) -
                         0.8 * (double)smr_length(step)) < 1.0e-6);
        s->evolve.tangent_smooth.limited[v] = 255; /* where it held back all of it nothing is evened out any more */
        assert_true(smr_length(smr_tangent_displacement(&s->evolve.tangent_smooth, v)) == 0.0f);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_teardown(test_spike_goes, tidy),
        cmocka_unit_test_teardown(test_where, tidy),
        cmocka_unit_test_teardown(test_step, tidy),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
