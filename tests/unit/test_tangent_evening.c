/* test_tangent_evening.c: at the last radius a spike goes to where its neighbours' mean is, across the surface where
 * noisy points show the whole or a mesh is noisy, and nothing moves where evening is not allowed.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <string.h>
#include "property/rig_cloud.h"
#include "registration/registration.h"

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

TEST(test_spike_goes)
{
    float plain[40], even[40];
    spike(0.0f, 1, 1, plain, 40);
    spike(0.5f, 1, 1, even, 40);
    assert_true(plain[39] > 0.8f);                  /* nothing else brings it back */
    assert_true(even[0] > 0.4f && even[0] < 0.65f); /* half of the way in the first iteration */
    assert_true(even[1] < even[0] && even[39] < 0.12f);
}

/* Not before the last radius, and not without a target. */
TEST(test_where)
{
    float plain[2], even[2];
    for (uint32_t k = 0; k < 2u; k++) {
        spike(0.0f, k, k == 0u, plain, 2);
        spike(1.0f, k, k == 0u, even, 2);
        assert_memory_equal(plain, even, sizeof plain);
    }
}

enum { WHOLE = 0, PART, UNJUDGED, SMALL, SURFACE, AGREED, UNEVEN, ACROSS };

/* Across the surface a spike goes back, too, where a cloud shows the whole of a structure that is not small, or where a
 * mesh is noisy: the more, the larger the noise is beside the model's edges. Expected errors follow for clouds. */
TEST(test_across)
{
    for (uint32_t k = 0; k < ACROSS; k++) {
        smr_config c = quiet();
        const smr_mesh mesh = k == SMALL ? rig_ball(30, 9, 12, none) : rig_ball(30, 16, 24, none);
        const smr_prepare_config radii = rig_radii(2, 18, 0.01f, 0);
        c.basic.n_target_vertices = 1000;
        c.basic.even = k == UNEVEN ? 0.0f : 1.0f;
        c.schedule.radius_first = 1;
        smr *s = rig_init(rig_model(&mesh, 1, &radii), &c, NULL);
        smr_points *cloud = rig_cloud(1000);
        const float edge = smr_le_float(s->shared.model->edge_mm);
        smr_tangent_smooth *e = &s->evolve.tangent_smooth;
        smr_target *t = &s->forces.surface.target[0];
        const uint32_t v = 50;
        assert_int_equal(SMR_OK, k == SURFACE ? smr_set_surface(s, SMR_ALL, rig_surface(&mesh))
                                              : smr_set_points(s, SMR_ALL, cloud));
        t->had_target = 1;
        t->n_judged = k == UNJUDGED ? 0u : 100u;
        t->n_visible = k == UNJUDGED ? 0u : k == PART ? 90u : 91u;
        e->share = 1.0e-6f;
        for (uint32_t task = 0; task < s->shared.n_tasks; task++)
            smr_tangent_clear(e, task, 0);
        const smr_vec n = smr_get3(s->shape.normal, v), off = smr_v(0.1f, 0.2f, 0.3f);
        for (uint32_t i = 0; i < s->shared.n; i++)
            smr_put3(e->rings.displacement, i, i == v ? smr_add(n, off) : smr_v(0, 0, 0));
        for (uint32_t task = 0; task < smr_tangent_sum_tasks(e); task++)
            smr_tangent_sum(e, task, 0);
        for (uint32_t i = 0; i <= 8u; i++) { /* noise of 0 to 0.4 edges, of which points that agree know nothing */
            const float noise = 0.05f * (float)i * edge, share = smr_clamp(0.25f * (float)i - 0.5f, 0.0f, 1.0f);
            t->compared = 10.0f;
            t->pulled = 10.0f * noise * noise;
            t->product = k == AGREED ? t->pulled : 0.0f;
            if (k == SURFACE)
                ((smr_surface *)(uintptr_t)t->surface)->noise_mm = noise;
            t->noise = smr_noise_of(t, edge);
            const int acts = k == WHOLE || k == UNJUDGED;
            const float out = 1.0f + smr_dot(n, off), own = smr_clamp(0.3125f * (float)i - 0.125f, 0.0f, 0.5f);
            const float back = k == SURFACE ? own * out : acts || k == UNEVEN ? 0.25f * share * out : 0.0f;
            const smr_vec moved = smr_tangent_displacement(e, v);
            assert_true(smr_length(smr_add(moved, smr_scale(n, back))) < 1.0e-5f);
            if (k != SURFACE)
                assert_true(smr_abs(smr_noise_smoothed(e, 0) - (acts ? 1.0f + share : 1.0f)) < 1.0e-5f);
        }
    }
}
