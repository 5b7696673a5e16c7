/* test_reference.c: centres, masses and spreads of clusters against sums in double; degenerate clusters give a
 * result.
 * SPDX-License-Identifier: MIT */
#include "cmocka_first.h"

#include <math.h>
#include <string.h>

#include "property/model_lists.h"
#include "property/rig.h"
#include "registration/registration.h"

static int tidy(void **state)
{
    (void)state;
    rig_free_all();
    return 0;
}

static const float none[3] = {0, 0, 0};

/* x^r's centres and spreads as the library has them after the reference steps of the next iteration. */
static void settle(smr *s)
{
    s->reference.stale = 1;
    for (uint32_t t = 0; t < smr_reference_tasks(&s->reference); t++)
        smr_reference_reach(&s->reference, t, 0);
    smr_reference_begin(&s->reference);
    for (uint32_t t = 0; t < smr_reference_record_tasks(&s->reference); t++)
        smr_reference_record(&s->reference, t, 0);
    for (uint32_t t = 0; t < smr_reference_block_tasks(&s->reference); t++)
        smr_sums_forest(&s->sums, t, 0);
    for (uint32_t t = 0; t < smr_reference_cluster_tasks(&s->reference); t++)
        smr_reference_cluster(&s->reference, t, 0);
    smr_reference_end(&s->reference);
}

/* A vertex' mass in the sums: an ignored one is out of every cluster. */
static float active_mass(const smr *s, uint32_t v)
{
    return smr_active(&s->schedule, v) ? smr_mass(&s->shared, v) : 0.0f;
}

/* Largest errors, relative to the cluster's size: of the centre, and of the covariance (polar) or of inertia times its
 * inverse (rigid). */
static void compare(const smr *s, const rig_lists *l, double *centre_mm, double *spread)
{
    *centre_mm = *spread = 0.0;
    for (uint32_t v = 0; v < s->shared.n; v++) {
        double mass = 0.0, c[3] = {0, 0, 0}, m[9] = {0}, trace = 0.0;
        for (uint32_t k = l->zeta_start[v]; k < l->zeta_start[v + 1u]; k++) {
            const double w = (double)active_mass(s, l->zeta[k]);
            mass += w;
            for (uint32_t a = 0; a < 3u; a++)
                c[a] += w * (double)smr_at3(s->shape.x_ref, l->zeta[k])[a];
        }
        for (uint32_t k = l->zeta_start[v]; k < l->zeta_start[v + 1u]; k++) {
            for (uint32_t i = 0; i < 9u; i++) {
                const float *x = smr_at3(s->shape.x_ref, l->zeta[k]);
                m[i] += (double)active_mass(s, l->zeta[k]) * ((double)x[i / 3u] - c[i / 3u] / mass) *
                        ((double)x[i % 3u] - c[i % 3u] / mass);
            }
        }
        trace = m[0] + m[4] + m[8];
        assert_true(fabs((double)s->reference.cluster_mass[v] - mass) <= 1.0e-6 * mass);
        for (uint32_t a = 0; a < 3u; a++)
            *centre_mm = fmax(*centre_mm, fabs((double)smr_at3(s->reference.centre, v)[a] - c[a] / mass));
        const float *p = s->reference.spread + 6u * (size_t)v;
        const float full[9] = {p[0], p[1], p[2], p[1], p[3], p[4], p[2], p[4], p[5]};
        for (uint32_t i = 0; i < 9u; i++) {
            double error = ((double)full[i] - m[i]) / trace;
            if (s->shared.config.basic.method == SMR_METHOD_RIGID) {
                error = i % 4u == 0u ? -1.0 : 0.0;
                for (uint32_t k = 0; k < 3u; k++)
                    error += ((k == i / 3u ? trace : 0.0) - m[3u * (i / 3u) + k]) * (double)full[3u * k + i % 3u];
            }
            *spread = fmax(*spread, fabs(error));
        }
    }
}

static void check(uint32_t mass, const float *at, float radius)
{
    smr_prepare_config prepare = rig_radii(1, radius, 0, 0);
    const smr_mesh mesh = rig_ball(40, 11, 17, at);
    prepare.mass = mass;
    const smr_model *model = rig_model(&mesh, 1, &prepare);
    const rig_lists l = rig_decode(model, 0, 1, 1);
    for (uint32_t method = 0; method < 2u; method++) {
        smr_config config = smr_config_default();
        double centre_mm, spread;
        config.basic.method = method;
        smr *s = rig_init(model, &config, NULL);
        settle(s);
        compare(s, &l, &centre_mm, &spread);
        if (centre_mm > 2.0e-3 || spread > 5.0e-3) {
            fail_msg("mass %u radius %g method %u: centre off by %g mm, spread by %g", mass, (double)radius, method,
                     centre_mm, spread);
        }
    }
}

static void test_against_double(void **state)
{
    const float far[3] = {5000, -7000, 9000};
    (void)state;
    for (uint32_t mass = 0; mass < 2u; mass++) {
        check(mass, none, 20);
        check(mass, none, 50);
        check(mass, none, 200); /* everything in every cluster */
        check(mass, far, 35);
    }
}

/* A reference that has been torn far from the rest shape: no sum overflows. */
static void test_deformed(void **state)
{
    const smr_mesh mesh = rig_ball(40, 8, 12, none);
    const smr_prepare_config prepare = rig_radii(1, 30, 0, 0);
    const smr_model *model = rig_model(&mesh, 1, &prepare);
    const rig_lists l = rig_decode(model, 0, 1, 1);
    smr_config config = smr_config_default();
    double centre_mm, spread;
    uint32_t seed = 4;
    (void)state;
    config.basic.method = SMR_METHOD_POLAR;
    smr *s = rig_init(model, &config, NULL);
    float *xyz = rig_alloc(mesh.n_vertices * 3u * sizeof *xyz);
    for (uint32_t i = 0; i < 3u * mesh.n_vertices; i++)
        xyz[i] = rig_between(&seed, -9.0e4f, 9.0e4f);
    assert_int_equal(SMR_OK, smr_set_positions(s, 0, xyz));
    settle(s);
    compare(s, &l, &centre_mm, &spread);
    assert_true(centre_mm < 20.0); /* of 180 m */
    assert_true(spread < 5.0e-3);
}

static void test_degenerate(void **state)
{
    static float line[3 * 12], point[3 * 12];
    (void)state;
    for (uint32_t i = 0; i < 12u; i++) {
        line[3u * i] = (float)i;
        point[3u * i] = 3;
    }
    const float *shape[] = {line, point};
    for (uint32_t k = 0; k < 4u; k++) {
        const smr_mesh mesh = {shape[k / 2u], NULL, k % 2u ? 12u : 2u, 0};
        const smr_prepare_config prepare = rig_radii(1, 30, 0, 0);
        const smr_config config = smr_config_default();
        smr *s = rig_init(rig_model(&mesh, 1, &prepare), &config, NULL);
        settle(s);
        for (uint32_t i = 0; i < 6u * s->shared.n; i++)
            assert_true(isfinite(s->reference.spread[i]) && fabsf(s->reference.spread[i]) < 1.0e9f);
        for (uint32_t v = 0; v < s->shared.n; v++) /* no torque about the line itself */
            assert_true(fabsf(s->reference.spread[6u * v + 0u]) < 1.0e-6f);
    }
}

static void test_only_when_new(void **state)
{
    const smr_mesh mesh = rig_ball(40, 8, 12, none);
    const smr_prepare_config prepare = rig_radii(1, 30, 0, 0);
    const smr_config config = smr_config_default();
    smr *s = rig_init(rig_model(&mesh, 1, &prepare), &config, NULL);
    (void)state;
    assert_int_equal(s->shared.n_tasks, smr_reference_tasks(&s->reference));
    settle(s);
    assert_int_equal(0, smr_reference_tasks(&s->reference));
    assert_int_equal(0, smr_reference_block_tasks(&s->reference));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_teardown(test_against_double, tidy),
        cmocka_unit_test_teardown(test_deformed, tidy),
        cmocka_unit_test_teardown(test_degenerate, tidy),
        cmocka_unit_test_teardown(test_only_when_new, tidy),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
