/* test_scrub.c: faults in memory are found: pointers and counts by each call, inputs and arena by smr_set_scrub().
 * SPDX-License-Identifier: MIT */
#include "suite.h"

#include <string.h>

#include "property/rig_ball_image.h"
#include "property/rig_cloud.h"
#include "registration/registration.h"

static const smr_model *model;
static smr_surface *surface;
static float *xyz;

static smr *start_with(uint32_t what, uint32_t dynamics)
{
    static const float middle[3] = {0, 0, 0};
    const smr_mesh ball = dynamics ? rig_ball(20, 30, 40, middle) : rig_ball(20, 9, 12, middle);
    const smr_mesh goal = rig_ball(21, 10, 13, middle);
    const smr_prepare_config radii = rig_radii(3, 25, 12, 3);
    smr_config config = smr_config_default();
    config.basic.n_target_vertices = goal.n_vertices;
    config.basic.iterations_last = 4;
    config.basic.iterations = 2;
    config.dynamics.mode = dynamics;
    model = rig_model(&ball, 1, &radii);
    surface = rig_surface(&goal);
    xyz = rig_alloc(3u * ball.n_vertices * sizeof *xyz);
    smr *s = rig_init(model, &config, NULL);
    assert_int_equal(SMR_OK, smr_set_scrub(s, what));
    assert_int_equal(SMR_OK, smr_set_surface(s, 0, surface));
    assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
    return s;
}

static smr *start(uint32_t what) { return start_with(what, SMR_DYNAMICS_OFF); }

static void flip(const void *at, size_t byte)
{
    unsigned char *bytes = (unsigned char *)(uintptr_t)at; /* what the library may only read, too */
    bytes[byte] ^= 4u;
}

/* A changed pointer or count stops all calls for good; positions stay readable unless they hang on it. */
TEST(what_points_and_counts_is_guarded)
{
    float *then;
    smr *s = start(0);
    const struct {
        const void *at;
        int readable;
    } of[] = {{&s->shared.model, 0},
              {&s->shape.structure, 0},
              {&s->shape.x, 0},
              {&s->shape.structure[0], 0},
              {&model->at_position, 0},
              {&s->port.now_ns, 0},
              {&s->forces.surface.target, 1},
              {&s->folds.rings, 1},
              {&s->forces.surface.target[0].surface, 1},
              {&s->log.write, 1},
              {&s->forces.surface.goal[0], 1}};
    then = rig_positions(s, model);
    for (size_t i = 0; i < sizeof of / sizeof of[0]; i++) {
        flip(of[i].at, 1);
        assert_int_equal(SMR_E_DAMAGED, smr_tick(s, 0, NULL));
        assert_int_equal(SMR_E_DAMAGED, smr_set_active(s, 5));
        assert_int_equal(SMR_E_DAMAGED, smr_set_surface(s, 0, NULL));
        assert_int_equal(of[i].readable ? SMR_OK : SMR_E_DAMAGED, smr_get_positions(s, 0, xyz));
        if (of[i].readable)
            assert_memory_equal(then, xyz, 3u * s->shared.n * sizeof *xyz);
        flip(of[i].at, 1);
        assert_int_equal(SMR_OK, smr_get_positions(s, 0, xyz));
    }
    flip(&surface->triangle, 1); /* a target's header: found where targets are read */
    assert_int_equal(SMR_E_DAMAGED, smr_tick(s, 0, NULL));
    assert_int_equal(SMR_OK, smr_get_positions(s, 0, xyz));
    flip(&surface->triangle, 1);
    assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
}

/* No bit of the two words that can turn the guard off hides another fault, of two bits: the checksum is a sum, in which
 * one bit can stand for another. */
TEST(no_bit_turns_the_guard_off)
{
    smr *s = start(0);
    uint32_t *const word[] = {&s->ticking, &s->guard.closed};
    for (uint32_t i = 0; i < 64u; i++) {
        *word[i / 32u] ^= 1u << i % 32u;
        flip(&s->shape.x, 1);
        flip(&s->shape.x, 2);
        assert_int_equal(SMR_E_DAMAGED, smr_tick(s, 0, NULL));
        assert_int_equal(SMR_E_DAMAGED, smr_get_positions(s, 0, xyz));
        flip(&s->shape.x, 1);
        flip(&s->shape.x, 2);
        assert_int_equal(i < 32u ? SMR_E_DAMAGED : SMR_OK, smr_get_positions(s, 0, xyz));
        *word[i / 32u] ^= 1u << i % 32u;
    }
    assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
}

/* Each byte of each input is in the round, which finds a changed bit; the round is due again after each iteration. */
TEST(a_round_finds_what_has_changed)
{
    smr *s = start(SMR_SCRUB_INPUTS);
    const smr_vec at = smr_get3(surface->xyz, 3);
    smr_verdict v;
    assert_int_equal(SMR_OK, smr_get_verdict(s, 0, &v));
    assert_true((v.reasons & SMR_REASON_UNCHECKED) && v.level != SMR_VERDICT_GOOD);
    assert_int_equal(SMR_OK, smr_scrub(s, 0));
    assert_int_equal(SMR_OK, smr_get_verdict(s, 0, &v));
    assert_int_equal(0, v.reasons & SMR_REASON_UNCHECKED);
    assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
    assert_int_equal(SMR_OK, smr_get_verdict(s, 0, &v));
    assert_true(v.reasons & SMR_REASON_UNCHECKED);
    const uint32_t bytes = smr_le32(model->bytes);
    uint32_t n_readable = 0;
    for (uint32_t i = 0; i < 40u; i++) {
        const void *const part = i % 2u ? (const void *)model : (const void *)surface->normal;
        const size_t byte = i % 2u ? sizeof *model + i * ((bytes - sizeof *model) / 40u) : 7u * i;
        flip(part, byte);
        assert_int_equal(SMR_E_DAMAGED, smr_scrub(s, 0));
        assert_int_equal(SMR_E_DAMAGED, smr_tick(s, 0, NULL));
        n_readable += smr_get_positions(s, 0, xyz) == SMR_OK; /* unless it is a number of the model's vertices */
        flip(part, byte);
        s->scrub.damaged = 0;
        smr_guard_close(s);
        assert_int_equal(SMR_OK, smr_scrub(s, 0));
    }
    assert_true(n_readable >= 30u && n_readable < 40u);
    assert_true(smr_length(smr_sub(at, smr_get3(surface->xyz, 3))) < 1.0e-6f);
    flip(model, sizeof *model + 77u); /* found while ticks go on, too */
    smr_status status = SMR_OK;
    for (uint32_t i = 0; status == SMR_OK && i < 200u; i++)
        status = smr_tick(s, 0, NULL);
    assert_int_equal(SMR_E_DAMAGED, status);
}

/* The whole arena is checked by each call; scratch memory of sums does not count, and results do not change. */
TEST(a_seal_finds_what_has_changed)
{
    smr *s = start(SMR_SCRUB_STATE), *plain = start(0);
    flip(s->shape.x_ref, 10);
    assert_int_equal(SMR_E_DAMAGED, smr_tick(s, 0, NULL));
    assert_int_equal(SMR_E_DAMAGED, smr_get_positions(s, 0, xyz));
    flip(s->shape.x_ref, 10);
    flip(s->overlay.record, 10);
    assert_int_equal(SMR_OK, smr_set_active(s, 0));
    for (uint32_t i = 0; i < 30u; i++) {
        assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
        assert_int_equal(SMR_OK, smr_tick(plain, 0, NULL));
        assert_true(smr_state_hash(s) == smr_state_hash(plain));
    }
    const smr_pose turned = {{{0, -1, 0, 3}, {1, 0, 0, 0}, {0, 0, 1, 0}}};
    assert_int_equal(SMR_OK, smr_set_pose(s, &turned));
    assert_int_equal(SMR_E_STATE, smr_scrub(s, 0)); /* no round is wanted */
    assert_int_equal(SMR_OK, smr_set_scrub(s, SMR_SCRUB_INPUTS + SMR_SCRUB_STATE));
    assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
    assert_int_equal(SMR_E_INPUT, smr_set_scrub(s, 4));
    assert_int_equal(SMR_E_NULL, smr_set_scrub(NULL, 0));
    assert_int_equal(SMR_OK, smr_set_scrub(s, 0));
    flip(s->shape.x_ref, 10);
    assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
}

/* A model that has changed since it was opened is refused. */
TEST(the_model_must_be_whole)
{
    smr *s = start(0);
    flip(model, sizeof *model + 100u);
    assert_int_equal(SMR_E_DAMAGED, smr_set_scrub(s, SMR_SCRUB_INPUTS));
    flip(model, sizeof *model + 100u);
    assert_int_equal(SMR_E_DAMAGED, smr_tick(s, 0, NULL));
}

/* Structures that share a target share its checksum, set at once or one after the other, unless it changed between. */
TEST(targets_are_shared)
{
    static const float at[3][3] = {{0, 0, 0}, {60, 0, 0}, {0, 60, 0}};
    const smr_prepare_config radii = rig_radii(1, 25, 0, 0);
    smr_mesh ball[3];
    smr_config config = smr_config_default();
    for (uint32_t i = 0; i < 3u; i++)
        ball[i] = rig_ball(20, 9, 12, at[i]);
    config.basic.n_target_vertices = 9u * ball[0].n_vertices;
    smr *s = rig_init(rig_model(ball, 3, &radii), &config, NULL);
    smr_surface *one = rig_surface(&ball[0]), *two = rig_surface(&ball[1]);
    assert_int_equal(SMR_OK, smr_set_scrub(s, SMR_SCRUB_INPUTS));
    const smr_target *t = s->forces.surface.target;
    static const struct {
        uint32_t structure, second, refit; /* set one, or the second surface, or one after a refit */
    } set[] = {{SMR_ALL, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}, {2, 1, 0}, {0, 0, 0}, {2, 0, 1}, {SMR_ALL, 0, 0}};
    for (uint32_t i = 0; i < sizeof set / sizeof set[0]; i++) {
        if (set[i].refit)
            assert_int_equal(SMR_OK, smr_surface_refit(one, ball[2].xyz) + smr_surface_step(one, 0, NULL, 0));
        assert_int_equal(SMR_OK, smr_set_surface(s, set[i].structure, set[i].second ? two : one));
        for (uint32_t k = 0; k < 3u; k++)
            for (uint32_t l = 0; l < k; l++)
                if (t[k].surface != NULL && t[l].surface != NULL)
                    assert_int_equal(t[k].surface == t[l].surface && t[k].changes == t[l].changes,
                                     t[k].body == t[l].body);
    }
    smr_points *const cloud = rig_cloud(9);
    assert_int_equal(SMR_OK, smr_points_add(cloud, ball[1].xyz, NULL, NULL, 9));
    assert_int_equal(SMR_OK, smr_set_points(s, 1, cloud));
    assert_int_equal(SMR_OK, smr_scrub(s, 0));
    flip(t[1].surface->xyz, 7);
    assert_int_equal(SMR_E_DAMAGED, smr_scrub(s, 0));
}

/* Voxels and mask are inputs, too. */
TEST(images_are_scrubbed)
{
    const smr_volume reference = rig_ball_image(RIG_BALL_MM, rig_nowhere);
    const smr_config config = smr_config_default_image();
    const smr_model *ball = rig_ball_model(&reference);
    smr_volume image = rig_ball_image(RIG_BALL_MM, rig_shift);
    const size_t n = (size_t)RIG_BALL_SIDE * RIG_BALL_SIDE * RIG_BALL_SIDE;
    unsigned char *const mask = rig_alloc(n);
    memset(mask, 1, n);
    for (uint32_t i = 0; i < 3u; i++) {
        smr *s = rig_init(ball, &config, NULL);
        image.mask = i > 0u ? mask : NULL;
        assert_int_equal(SMR_OK, smr_set_scrub(s, SMR_SCRUB_INPUTS));
        assert_int_equal(SMR_OK, smr_set_volume(s, &image));
        assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
        assert_int_equal(SMR_OK, smr_scrub(s, 0));
        flip(i == 2u ? (const void *)mask : image.voxels, n / 2u);
        assert_int_equal(SMR_E_DAMAGED, smr_scrub(s, 0));
        flip(i == 2u ? (const void *)mask : image.voxels, n / 2u);
    }
}

/* The seal holds whatever is left of an iteration when a tick ends, also in the first step of a time step. */
TEST(the_seal_holds_between_pieces)
{
    for (uint32_t dynamics = SMR_DYNAMICS_OFF; dynamics <= SMR_DYNAMICS_ON; dynamics++) {
        rig_clock clock;
        smr *s = start_with(0, dynamics);
        uint32_t partial = 0, at_first = 0;
        smr_pose pose;
        smr_verdict verdict[2];
        float mm;
        s->port = rig_clock_port(&clock, RIG_CLOCK_STEADY, 1000);
        smr_guard_close(s);
        assert_int_equal(SMR_OK, smr_set_scrub(s, SMR_SCRUB_STATE));
        for (uint32_t i = 0; i < 300u; i++) {
            const smr_status status = smr_tick(s, 1, NULL);
            assert_true(status >= SMR_OK);
            partial += status == SMR_PARTIAL;
            assert_int_equal(SMR_OK, smr_get_pose(s, 0, &pose, &mm));
            if (s->step > 0u || s->next_task > 0u)
                assert_true(mm == -1.0f); /* nothing has been measured from there */
            at_first += s->step == 0u && s->next_task > 0u;
        }
        assert_true(partial > 50u && (at_first > 0u) == (dynamics == SMR_DYNAMICS_ON));
        assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
        for (uint32_t i = 0; i < 2u; i++)
            assert_int_equal(SMR_OK, smr_get_verdict(s, 0, &verdict[i]));
        assert_memory_equal(&verdict[0], &verdict[1], sizeof verdict[0]);
        flip(s->shape.x_ref, 10);
        assert_int_equal(SMR_E_DAMAGED, smr_tick(s, 1, NULL));
    }
}

/* A call with a budget stops early and goes on; ticks take slices under a clock, too. */
TEST(slices_fit_budgets)
{
    rig_clock clock;
    smr *s = start(SMR_SCRUB_INPUTS);
    uint32_t calls = 1;
    s->port = rig_clock_port(&clock, RIG_CLOCK_STEADY, 1000);
    smr_guard_close(s);
    for (; smr_scrub(s, 1500) == SMR_PARTIAL && calls < 1000u; calls++) {
    }
    assert_true(calls > 3u && calls < 1000u && s->scrub.checked);
    assert_true(smr_tick(s, 100000, NULL) >= SMR_OK);
    assert_int_equal(0, s->scrub.checked);
}
