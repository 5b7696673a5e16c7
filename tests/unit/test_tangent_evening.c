/* test_tangent_evening.c: at the last radius a spike goes to where its neighbours' mean is, across the surface where
 * noisy points show the whole, and nothing moves where evening is not allowed.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <string.h>
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

/* Across the surface a spike goes by the share of goals that is noise, where points show the whole, and never along. */
TEST(test_across)
{
    smr_config c = quiet();
    const smr_model *model;
    smr *s = start(&c, &model, 1);
    smr_tangent_smooth *e = &s->evolve.tangent_smooth;
    const uint32_t v = 50;
    const smr_vec n = smr_get3(s->shape.normal, v);
    s->forces.surface.target[0].had_target = 1;
    e->share = 1.0e-6f;
    for (uint32_t task = 0; task < s->shared.n_tasks; task++)
        smr_tangent_clear(e, task, 0);
    for (uint32_t i = 0; i < s->shared.n; i++)
        smr_put3(e->rings.displacement, i, smr_v(0, 0, 0));
    smr_put3(e->rings.displacement, v, smr_add(n, smr_v(0.1f, 0.2f, 0.3f)));
    for (uint32_t task = 0; task < smr_tangent_sum_tasks(e); task++)
        smr_tangent_sum(e, task, 0);
    for (uint32_t whole = 0; whole < 2u; whole++)
        for (uint32_t i = 0; i <= 4u; i++) {
            const float noise = 0.25f * (float)i, out = 1.0f + smr_dot(n, smr_v(0.1f, 0.2f, 0.3f));
            s->forces.surface.points_show_all = whole;
            s->forces.surface.target[0].share = 1.0f - noise;
            const smr_vec moved = smr_tangent_displacement(e, v);
            const smr_vec expected = smr_scale(n, whole ? -0.25f * noise * out : 0.0f);
            assert_true(smr_length(smr_sub(moved, expected)) < 1.0e-5f);
        }
}

/* Without noise an iteration leaves the share of goals at 1, also behind clouds that were noisy. */
TEST(test_share_begins_at_one)
{
    smr_config c = quiet();
    const smr_model *model;
    smr *s = start(&c, &model, 1);
    s->forces.surface.target[0].share = 0.0f;
    smr_guard_close(s);
    (void)rig_run(s, 1);
    assert_true(s->forces.surface.target[0].share == 1.0f);
}
