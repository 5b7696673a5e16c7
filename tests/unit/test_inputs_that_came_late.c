/* test_inputs_that_came_late.c: what is set at an awkward moment counts all the same, and surfaces the wrong way
 * round or mirrored do no harm.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include "oracle.h"
#include "registration/registration.h"

static const float at_origin[3] = {0, 0, 0}, beside[3] = {2, 0, 0};

static smr_mesh flipped(smr_mesh mesh, int flip)
{
    uint32_t *const t = rig_alloc(3u * sizeof *t * mesh.n_triangles);
    for (uint32_t i = 0; i < 3u * mesh.n_triangles; i++)
        t[i] = mesh.triangles[flip ? i - i % 3u + (3u - i % 3u) % 3u : i];
    mesh.triangles = t;
    return mesh;
}

/* A target that is set when the schedule's last iteration has its forces is the first that tracking follows. */
TEST(test_last_iteration)
{
    const smr_mesh ball = rig_ball(20, 14, 20, at_origin), goal = rig_ball(20.5f, 16, 24, at_origin),
                   next = rig_ball(20.5f, 16, 24, beside);
    const smr_model *model = rig_model(&ball, 1, NULL);
    const smr_pose same = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    smr_config config = smr_config_default();
    rig_clock clock = {0};
    const smr_port port = rig_clock_port(&clock, RIG_CLOCK_STEADY, 1000);
    smr_tick_report r = {0};
    uint32_t n = 0;
    config.track.mode = SMR_TRACK_REPORT;
    config.motion.settle_um = 0.0f; /* as many iterations in the second run as in the first */
    config.basic.n_target_vertices = goal.n_vertices;
    smr *s = rig_init(model, &config, &port);
    assert_int_equal(SMR_OK, smr_set_surface(s, 0, rig_surface(&goal)));
    for (; !r.details.tracking; n++)
        assert_int_equal(SMR_OK, smr_tick(s, 0, &r));
    assert_int_equal(SMR_OK, smr_set_pose(s, &same));
    while (n-- > 1u)
        assert_int_equal(SMR_OK, smr_tick(s, 0, &r));
    assert_int_equal(0, r.details.tracking);
    do
        assert_int_equal(SMR_PARTIAL, smr_tick(s, 20000, &r));
    while (r.details.phase == SMR_PHASE_FORCES);
    assert_int_equal(SMR_OK, smr_set_surface(s, 0, rig_surface(&next)));
    assert_int_equal(SMR_OK, smr_tick(s, 0, &r));
    const uint32_t before = r.iteration;
    for (uint32_t i = 0; i < 5u; i++)
        assert_int_equal(SMR_OK, smr_tick(s, 0, &r));
    assert_true(r.details.tracking && r.iteration == before + 5u);
}

/* A noisy target that replaces a clean one when an iteration at the last radius has its forces does not change it. */
TEST(test_noisy_replacement)
{
    const smr_mesh ball = rig_ball(20, 14, 20, at_origin), goal = rig_ball(20.5f, 16, 24, beside),
                   noisy = rig_ball(20.5f, 16, 24, beside);
    const smr_model *model = rig_model(&ball, 1, NULL);
    rig_clock clock = {0};
    const smr_port port = rig_clock_port(&clock, RIG_CLOCK_STEADY, 1000);
    oracle_random random = oracle_seed(1);
    smr_config config = smr_config_default();
    const float *after[2];
    for (uint32_t i = 0; i < 3u * noisy.n_vertices; i++)
        ((float *)(uintptr_t)noisy.xyz)[i] += oracle_uniformf(&random, -2, 2);
    config.basic.iterations = 3;
    config.basic.n_target_vertices = goal.n_vertices;
    for (uint32_t replaced = 0; replaced < 2u; replaced++) {
        const smr_surface *const next = rig_surface(&noisy);
        smr_tick_report r = {0};
        smr *s = rig_init(model, &config, &port);
        assert_true(next->noise_mm > 0.3f);
        assert_int_equal(SMR_OK, smr_set_surface(s, 0, rig_surface(&goal)));
        while (!smr_at_last_radius(&s->shared, &s->schedule))
            assert_int_equal(SMR_OK, smr_tick(s, 0, &r));
        do
            assert_int_equal(SMR_PARTIAL, smr_tick(s, 20000, &r));
        while (r.details.phase == SMR_PHASE_FORCES);
        if (replaced)
            assert_int_equal(SMR_OK, smr_set_surface(s, 0, next));
        assert_int_equal(SMR_OK, smr_tick(s, 0, &r));
        after[replaced] = rig_positions(s, model);
    }
    assert_true(rig_far(after[0], after[1], model->n_vertices) <= 0.0f);
}

/* Structures 1 mm apart, each on its target: one that looks inwards is nothing to keep out of. */
TEST(test_inwards_in_contact)
{
    const float left[3] = {-10.5f, 0, 0}, right[3] = {10.5f, 0, 0};
    for (int flip = 0; flip < 2; flip++) {
        const smr_mesh ball[2] = {flipped(rig_ball(10, 16, 20, left), flip), rig_ball(10, 16, 20, right)};
        smr_config config = smr_config_default();
        config.contact.share = 1.0f;
        config.basic.n_target_vertices = ball[0].n_vertices + ball[1].n_vertices;
        const smr_model *model = rig_model(ball, 2, NULL);
        smr *s = rig_init(model, &config, NULL);
        assert_int_equal(SMR_OK, smr_set_surface(s, 0, rig_surface(&ball[0])));
        assert_int_equal(SMR_OK, smr_set_surface(s, 1, rig_surface(&ball[1])));
        const float *before = rig_positions(s, model);
        (void)rig_run(s, 400);
        assert_true(rig_far(before, rig_positions(s, model), s->shared.n) < 0.01f);
    }
}

/* A mirrored start keeps its volume, not the volume's opposite. */
TEST(test_mirrored_volume)
{
    static const float mirror[9] = {-1, 0, 0, 0, 1, 0, 0, 0, 1};
    const smr_mesh ball = rig_ball(20, 14, 20, at_origin);
    const smr_model *model = rig_model(&ball, 1, NULL);
    smr_config config = smr_config_default();
    smr_structure_volume volume;
    config.contact.volume = 1.0f;
    config.contact.smooth = 0.3f;
    smr *s = rig_init(model, &config, NULL);
    assert_int_equal(SMR_OK, smr_set_positions(s, 0, rig_moved(&ball, mirror, at_origin).xyz));
    (void)rig_run(s, 400);
    assert_int_equal(SMR_OK, smr_get_structure_volume(s, 0, &volume));
    assert_true(volume.closed && volume.ratio > 0.999f && volume.ratio < 1.001f);
}
