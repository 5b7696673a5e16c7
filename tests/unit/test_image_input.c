/* test_image_input.c: volumes that are set, set again, taken away and refused, whatever they hold.
 * SPDX-License-Identifier: MIT */
#include "suite.h"

#include <math.h>
#include <string.h>

#include "property/rig_ball_image.h"
#include "registration/schedule_radius.h"

TEST(test_needs_profiles)
{
    const smr_volume target = rig_ball_image(RIG_BALL_MM, rig_nowhere);
    const smr_model *model = rig_ball_model(NULL);
    const smr_config c = smr_config_default();
    smr *s = rig_init(model, &c, NULL);
    const uint64_t hash = smr_state_hash(s);
    assert_int_equal(SMR_E_STATE, smr_set_volume(s, &target));
    assert_int_equal(SMR_OK, smr_set_volume(s, NULL));
    assert_int_equal(SMR_E_NULL, smr_set_volume(NULL, &target));
    assert_int_equal(SMR_E_NULL, smr_set_volume(NULL, NULL));
    assert_true(hash == smr_state_hash(s));
    assert_int_equal(0, s->forces.image.has_image);
    assert_int_equal(0, rig_run(s, 1).details.n_active);
    s->magic = 0;
    assert_int_equal(SMR_E_STATE, smr_set_volume(s, &target));
    assert_int_equal(SMR_E_STATE, smr_set_volume(s, NULL));
}

static void refuse_all(smr *s, const smr_volume *good)
{
    static const float bad[] = {0.0f, -1.0f, (float)NAN, (float)INFINITY};
    smr_volume v = *good;
    v.voxels = NULL;
    assert_int_equal(SMR_E_NULL, smr_set_volume(s, &v));
    v = *good;
    v.voxels = (const char *)good->voxels + 2;
    assert_int_equal(SMR_E_INPUT, smr_set_volume(s, &v));
    v = *good;
    v.type = SMR_VOXEL_FLOAT + 1u;
    assert_int_equal(SMR_E_INPUT, smr_set_volume(s, &v));
    v = *good;
    memset(v.direction, 0, sizeof v.direction);
    assert_int_equal(SMR_E_INPUT, smr_set_volume(s, &v));
    for (uint32_t a = 0; a < 3u; a++) {
        v = *good;
        v.size[a] = 0;
        assert_int_equal(SMR_E_INPUT, smr_set_volume(s, &v));
        v.size[a] = 65537;
        assert_int_equal(SMR_E_INPUT, smr_set_volume(s, &v));
        v = *good;
        v.origin[a] = (float)NAN;
        assert_int_equal(SMR_E_INPUT, smr_set_volume(s, &v));
        for (uint32_t k = 0; k < 4u; k++) {
            v = *good;
            v.spacing[a] = bad[k];
            assert_int_equal(SMR_E_INPUT, smr_set_volume(s, &v));
        }
    }
}

/* A refused volume leaves positions, schedule and the image in use as they were. */
TEST(test_refused)
{
    const smr_volume reference = rig_ball_image(RIG_BALL_MM, rig_nowhere),
                     target = rig_ball_image(RIG_BALL_MM + 2.0f, rig_shift);
    const smr_model *model = rig_ball_model(&reference);
    const smr_config c = smr_config_default();
    uint64_t end[2];
    for (uint32_t refused = 0; refused < 2u; refused++) {
        smr *s = rig_init(model, &c, NULL);
        if (refused) {
            refuse_all(s, &target);
            assert_int_equal(0, s->forces.image.has_image);
        }
        assert_int_equal(SMR_OK, smr_set_volume(s, &target));
        const smr_tick_report before = rig_run(s, 5);
        if (refused) {
            const uint64_t hash = smr_state_hash(s);
            refuse_all(s, &target);
            assert_true(hash == smr_state_hash(s));
            assert_int_equal(1, s->forces.image.has_image);
        }
        const smr_tick_report after = rig_run(s, 5);
        assert_int_equal(before.iteration + 5u, after.iteration);
        end[refused] = smr_state_hash(s);
    }
    assert_true(end[0] == end[1]);
}

/* Taking away an image that is not there changes nothing, not even the schedule; one that is there is taken away. */
TEST(test_take_away)
{
    const smr_volume reference = rig_ball_image(RIG_BALL_MM, rig_nowhere),
                     target = rig_ball_image(RIG_BALL_MM + 2.0f, rig_shift);
    const smr_mesh goal = rig_ball(RIG_BALL_MM + 2.0f, 15, 22, rig_shift);
    const smr_surface *surface = rig_surface(&goal);
    const smr_model *model = rig_ball_model(&reference);
    const smr_config c = smr_config_default();
    uint64_t end[2];
    for (uint32_t asked = 0; asked < 2u; asked++) {
        smr *s = rig_init(model, &c, NULL);
        assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, surface));
        const uint32_t before = rig_run(s, 3).iteration;
        if (asked) {
            const uint64_t hash = smr_state_hash(s);
            assert_int_equal(SMR_OK, smr_set_volume(s, NULL));
            assert_true(hash == smr_state_hash(s));
        }
        const smr_tick_report r = rig_run(s, 3);
        assert_int_equal(before + 3u, r.iteration);
        end[asked] = smr_state_hash(s);
    }
    assert_true(end[0] == end[1]);
    smr *s = rig_init(model, &c, NULL);
    assert_int_equal(SMR_OK, smr_set_volume(s, &target));
    assert_true(rig_run(s, 2).n_forces > 0u);
    assert_int_equal(SMR_OK, smr_set_volume(s, NULL));
    const smr_tick_report r = rig_run(s, 1);
    assert_int_equal(0, r.details.n_active);
    assert_int_equal(0, r.n_forces);
}

/* A new volume finds the reference shape that plasticity has just set, whose copy the next iteration would make. */
TEST(test_after_plasticity)
{
    const smr_volume reference = rig_ball_image(RIG_BALL_MM, rig_nowhere),
                     target = rig_ball_image(RIG_BALL_MM + 2.0f, rig_shift);
    smr_config c = smr_config_default();
    c.motion.plastic_every = 2;
    smr *s = rig_init(rig_ball_model(&reference), &c, NULL);
    assert_int_equal(SMR_OK, smr_set_volume(s, &target));
    while (!smr_plastic_follows(s))
        (void)rig_run(s, 1);
    const uint64_t hash = smr_state_hash(s);
    assert_true(memcmp(s->shape.x, s->shape.x_ref, 3u * s->shared.n * sizeof(float)) != 0);
    assert_int_equal(SMR_OK, smr_set_volume(s, &target));
    assert_memory_equal(s->shape.x, s->shape.x_ref, 3u * s->shared.n * sizeof(float));
    assert_memory_equal(s->shape.normal, s->shape.normal_ref, 3u * s->shared.n * sizeof(float));
    assert_true(hash == smr_state_hash(s));
}

/* Whatever a volume may hold, the model that is prepared with it can be opened. */
TEST(test_extreme_reference)
{
    for (uint32_t k = 0; k < 2u; k++) {
        const smr_volume source = rig_ball_image(RIG_BALL_MM, rig_nowhere);
        float *voxels = rig_alloc(RIG_BALL_SIDE * RIG_BALL_SIDE * RIG_BALL_SIDE * sizeof *voxels);
        smr_volume reference = source;
        for (uint32_t i = 0; i < RIG_BALL_SIDE * RIG_BALL_SIDE * RIG_BALL_SIDE;
             i++) /* -0.99 .. 0.99 of the limit, and next to nothing */
            voxels[i] = (((const float *)source.voxels)[i] - 500.0f) / 400.0f * (k == 0u ? 0.99e30f : 1.0e-37f);
        reference.voxels = voxels;
        const smr_model *model = rig_ball_model(&reference); /* ends the program when it cannot be opened */
        const smr_config c = smr_config_default();
        smr *s = rig_init(model, &c, NULL);
        assert_int_equal(SMR_OK, smr_set_volume(s, &reference));
        (void)rig_run(s, 10000);
        assert_true(rig_finite(rig_positions(s, model), s->shared.n));
    }
}

/* Another volume in the midst of an iteration: how far that had come does not matter. */
TEST(test_abandoned)
{
    const smr_volume reference = rig_ball_image(RIG_BALL_MM, rig_nowhere),
                     first = rig_ball_image(RIG_BALL_MM + 2.0f, rig_shift),
                     second = rig_ball_image(RIG_BALL_MM - 1.0f, rig_shift);
    const smr_model *model = rig_ball_model(&reference);
    uint32_t n_partial = 0;
    for (uint32_t method = 0; method < 2u; method++) {
        uint64_t undisturbed = 0;
        smr_status status = SMR_PARTIAL;
        for (uint32_t cut = 0; cut < 2000u && status == SMR_PARTIAL; cut += 9u) {
            rig_clock clock;
            smr_config c = smr_config_default();
            smr_tick_report report;
            c.basic.method = method;
            c.basic.iterations = c.basic.iterations_last = 3;
            const smr_port port = rig_clock_port(&clock, RIG_CLOCK_STEADY, 50000);
            smr *s = rig_init(model, &c, &port);
            assert_int_equal(SMR_OK, smr_set_volume(s, &first));
            assert_int_equal(SMR_OK, smr_tick(s, 0, &report));
            if (cut > 0u)
                status = smr_tick(s, 50000u * (uint64_t)cut, &report);
            assert_int_equal(SMR_OK, smr_set_volume(s, &second));
            (void)rig_run(s, 100);
            if (cut == 0u)
                undisturbed = smr_state_hash(s);
            assert_true(status != SMR_PARTIAL || smr_state_hash(s) == undisturbed);
            n_partial += cut > 0u && status == SMR_PARTIAL;
        }
        assert_int_equal(SMR_OK, status); /* up to the last place to stop at */
    }
    assert_true(n_partial > 5u);
}
