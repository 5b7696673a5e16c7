/* test_evolve.c: goal positions are the mean of the clusters' transforms; relaxation, normals, displacement and hash.
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

static smr *start(const smr_config *config, const smr_model **model)
{
    const float off[3] = {5, 3, -2};
    const smr_mesh mesh = rig_ball(30, 9, 12, none), goal = rig_ball(35, 12, 16, off);
    const smr_prepare_config radii = rig_radii(1, 18, 0, 0);
    *model = rig_model(&mesh, 1, &radii);
    smr *s = rig_init(*model, config, NULL);
    assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, rig_surface(&goal)));
    return s;
}

static smr_config quiet(void)
{
    smr_config c = smr_config_default();
    c.motion.fold_guard = 0;
    c.basic.even = 0.0f; /* test_tangent_evening.c */
    c.motion.plastic_every = 0;
    c.motion.plastic_um = c.motion.settle_um = 0.0f;
    return c;
}

/* x~ = x^r + mean over the cluster of (R - I) x^r + t, in double from the transforms; relaxed from the old x. */
static void test_average_and_relaxation(void **state)
{
    (void)state;
    for (uint32_t k = 0; k < 4u; k++) {
        smr_config c = quiet();
        const smr_model *model;
        c.basic.method = k & 1u;
        c.motion.relaxation = k & 2u ? 0.3f : 1.0f;
        smr *s = start(&c, &model);
        const rig_lists l = rig_decode(model, 0, 1, 1);
        (void)rig_run(s, 2);
        float *old = rig_alloc(3u * s->shared.n * sizeof *old), *ref = rig_alloc(3u * s->shared.n * sizeof *ref);
        memcpy(old, s->shape.x, 3u * s->shared.n * sizeof *old);
        memcpy(ref, s->shape.x_ref, 3u * s->shared.n * sizeof *ref);
        smr_tick_report report;
        assert_int_equal(SMR_OK, smr_tick(s, 0, &report));
        double moved = 0.0;
        for (uint32_t v = 0; v < s->shared.n; v++) {
            double mean[12] = {0}, step2 = 0.0;
            const double n = (double)(l.zeta_start[v + 1u] - l.zeta_start[v]);
            for (uint32_t j = l.zeta_start[v]; j < l.zeta_start[v + 1u]; j++)
                for (uint32_t i = 0; i < 12u; i++)
                    mean[i] += (double)s->match.transform[12u * (size_t)l.zeta[j] + i] / n;
            for (uint32_t a = 0; a < 3u; a++) {
                double goal = (double)ref[3u * v + a] + mean[9u + a], x = (double)old[3u * v + a];
                for (uint32_t b = 0; b < 3u; b++)
                    goal += mean[3u * a + b] * (double)ref[3u * v + b];
                x += (double)c.motion.relaxation * (goal - x);
                assert_true(fabs(x - (double)smr_at3(s->shape.x, v)[a]) < 2.0e-5);
                step2 += (x - (double)old[3u * v + a]) * (x - (double)old[3u * v + a]);
            }
            moved = fmax(moved, sqrt(step2));
        }
        assert_true(moved > 0.05 && fabs(moved - (double)report.displacement_max_mm) < 1.0e-4);
    }
}

/* Carried normals stay near those of the triangles; exact ones are those. */
static void test_normals(void **state)
{
    (void)state;
    for (uint32_t exact = 0; exact < 2u; exact++) {
        smr_config c = quiet();
        const smr_model *model;
        c.motion.normals = exact;
        smr *s = start(&c, &model);
        float *expected = rig_alloc(3u * s->shared.n * sizeof *expected);
        (void)rig_run(s, 6);
        for (uint32_t k = 0; k < s->shared.n_triangles; k++) {
            const uint32_t *t = s->shared.triangle + 3u * (size_t)k;
            const smr_vec a = smr_load(smr_at3(s->shape.x, t[0]));
            const smr_vec area = smr_cross(smr_sub(smr_load(smr_at3(s->shape.x, t[1])), a),
                                           smr_sub(smr_load(smr_at3(s->shape.x, t[2])), a));
            for (uint32_t i = 0; i < 3u; i++)
                smr_store(expected + 3u * t[i], smr_add(smr_load(expected + 3u * t[i]), area));
        }
        for (uint32_t v = 0; v < s->shared.n; v++) {
            const float cosine = smr_dot(smr_unit(smr_load(expected + 3u * v)), smr_load(smr_at3(s->shape.normal, v)));
            assert_true(cosine > (exact ? 0.99999f : 0.97f));
        }
    }
}

static void test_hash(void **state)
{
    smr_config c = quiet();
    const smr_model *model;
    smr *s = start(&c, &model), *twin = start(&c, &model);
    (void)state;
    (void)rig_run(s, 3);
    (void)rig_run(twin, 3);
    assert_true(s->report.state_hash == twin->report.state_hash);
    const uint64_t whole = smr_state_hash(s);
    assert_true(whole == smr_state_hash(twin));
    for (uint32_t i = 0; i < 3u * s->shared.n; i += 7u) { /* the last bit of any coordinate counts */
        float *const arrays[] = {s->shape.x, s->shape.x_ref};
        for (uint32_t k = 0; k < 2u; k++) {
            const float keep = arrays[k][i];
            arrays[k][i] = nextafterf(keep, 1.0e9f);
            assert_true(smr_state_hash(s) != whole);
            arrays[k][i] = keep;
        }
    }
    for (uint32_t i = 0; i < 3u; i++) { /* and which vertex it belongs to */
        const float keep = s->shape.x[i];
        s->shape.x[i] = s->shape.x[3u + i];
        s->shape.x[3u + i] = keep;
    }
    assert_true(smr_state_hash(s) != whole);
    const float zero = s->shape.x[0];
    s->shape.x[0] = 0.0f;
    const uint64_t plus = smr_state_hash(s);
    s->shape.x[0] = -0.0f; /* the same position */
    assert_true(smr_state_hash(s) == plus);
    s->shape.x[0] = zero;
}

static void test_report_hash_is_of_the_new_positions(void **state)
{
    smr_config c = quiet();
    const smr_model *model;
    smr *s = start(&c, &model);
    uint64_t last = 0;
    (void)state;
    for (uint32_t i = 0; i < 5u; i++) {
        smr_tick_report report;
        assert_int_equal(SMR_OK, smr_tick(s, 0, &report));
        assert_true(report.state_hash != last);
        last = report.state_hash;
    }
    for (uint32_t t = 0; t < s->shared.n_tasks; t++) { /* x_next = x: nothing moves, the same hash again */
        memcpy(s->shape.x_next, s->shape.x, 3u * s->shared.n * sizeof(float));
        smr_evolve_measure(&s->evolve, t, 0);
    }
    uint64_t sum = 0;
    for (uint32_t t = 0; t < s->shared.n_tasks; t++) {
        sum += s->overlay.tally[t].evolve.hash;
        assert_true(s->overlay.tally[t].evolve.moved2 == 0.0f);
    }
    assert_true(sum == last);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_teardown(test_average_and_relaxation, tidy),
        cmocka_unit_test_teardown(test_normals, tidy),
        cmocka_unit_test_teardown(test_hash, tidy),
        cmocka_unit_test_teardown(test_report_hash_is_of_the_new_positions, tidy),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
