/* test_replay_late.c: inputs set within an iteration that decide how it ends, replayed to the last bit: what they say
 * of targets is read in several steps, which in the recording all came after the input.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include "property/rig_parts.h"
#include "registration/registration.h"

enum { INPUTS = 4, TICKS = 4000 };

/* A recorded run: what was set, in order, for the replay. */
typedef struct run {
    smr *s;
    const smr_model *model;
    smr_config config;
    rig_clock clock;
    const void *given[INPUTS];
    uint32_t n, next;
} run;

static unsigned char log_of_run[SMR_LOG_BYTES(TICKS, INPUTS)];
static rig_parts parts;
static smr_volume volume[2];

BEFORE_EACH_TEST()
{
    for (uint32_t i = 0; i < 2u; i++)
        volume[i] = rig_parts_image(4.0f * (float)i);
    parts = rig_parts_make(&volume[0]);
}

static const void *next_input(void *ctx, SMR_UNUSED const smr_log_record *record)
{
    run *r = ctx;
    return r->next < r->n ? r->given[r->next++] : NULL;
}

static void begin(run *r, const smr_model *model, const smr_config *config)
{
    r->model = model;
    r->config = *config;
    r->n = r->next = 0;
    const smr_port port = rig_clock_port(&r->clock, RIG_CLOCK_STEADY, 1000);
    r->s = rig_init(model, config, &port);
    assert_int_equal(SMR_OK, smr_set_log(r->s, log_of_run, sizeof log_of_run));
}

static void set_surface(run *r, uint32_t structure, const smr_surface *surface)
{
    assert_int_equal(SMR_OK, smr_set_surface(r->s, structure, surface));
    r->given[r->n++] = surface;
}

static void set_volume(run *r, uint32_t which)
{
    assert_int_equal(SMR_OK, smr_set_volume(r->s, &volume[which]));
    r->given[r->n++] = &volume[which];
}

static smr_tick_report tick(run *r, uint32_t n)
{
    smr_tick_report report = {0};
    for (uint32_t i = 0; i < n; i++)
        assert_int_equal(SMR_OK, smr_tick(r->s, 0, &report));
    return report;
}

/* Ticks until an iteration has its forces, and `more` times after that. Returns 0 when it ends before. */
static int go_within(run *r, uint64_t budget, uint32_t more)
{
    smr_tick_report report;
    smr_status status = smr_tick(r->s, budget, &report);
    while (status == SMR_PARTIAL && report.details.phase == SMR_PHASE_FORCES)
        status = smr_tick(r->s, budget, &report);
    for (; status == SMR_PARTIAL && more > 0u; more--)
        status = smr_tick(r->s, budget, &report);
    return status == SMR_PARTIAL;
}

/* Ends the run, and replays it. */
static void end(run *r)
{
    tick(r, 4);
    assert_true(rig_replays(r->s, log_of_run, next_input, r, rig_init(r->model, &r->config, NULL), NULL) > 4u);
    rig_free(r->s);
}

/* Other bodies in the target end a radius early; a target that is set again has none yet. */
TEST(test_target_with_other_bodies)
{
    const float far[3] = {10, 120, 0};
    const smr_mesh two[2] = {rig_parts_goal(0), rig_ball(30, 9, 14, far)}, both = rig_joined(two, 2);
    const smr_surface *surface = rig_surface(&both);
    const smr_prepare_config radii = rig_radii(3, 40.0f, 25.0f, 12.0f);
    const smr_model *model = rig_model(parts.part, 1, &radii);
    smr_config config = smr_config_default();
    uint32_t with_others = 0;
    config.basic.n_target_vertices = 800;
    config.basic.iterations = 20;
    config.motion.plastic_every = 0;
    config.motion.plastic_um = 0.0f;
    config.schedule.active_enough = 0;
    for (uint32_t n = 2; n < 9u; n++) {
        for (uint32_t share = 2; share < 50u; share++) {
            run r;
            config.motion.settle_share = 0.02f * (float)share;
            begin(&r, model, &config);
            set_surface(&r, SMR_ALL, surface);
            tick(&r, n);
            if (go_within(&r, 3000, 0)) {
                with_others += r.s->forces.surface.target[0].others;
                set_surface(&r, SMR_ALL, surface);
            }
            end(&r);
        }
    }
    assert_true(with_others > 100u);
}

/* A target that shows a part gets fewer iterations at a radius. */
TEST(test_open_target_after_a_closed_one)
{
    const float up[3] = {0, 0, 1};
    const smr_mesh whole = rig_parts_goal(0), open = rig_seen_from(&whole, up);
    const smr_surface *surface[2] = {rig_surface(&whole), rig_surface(&open)};
    smr_config config = smr_config_default();
    config.basic.n_target_vertices = 800;
    config.basic.iterations = 60;
    config.motion.settle_um = 0.0f;
    config.motion.plastic_every = 0;
    config.motion.plastic_um = 0.0f;
    for (uint32_t n = 26; n < 58u; n += 3u) {
        run r;
        begin(&r, parts.model[0], &config);
        set_surface(&r, SMR_ALL, surface[0]);
        tick(&r, n);
        assert_true(go_within(&r, 3000, 0));
        set_surface(&r, SMR_ALL, surface[1]);
        end(&r);
    }
}

/* An image abandons an iteration of tracking, which may have fitted the poses that the next prediction starts from. */
TEST(test_image_within_tracking)
{
    smr_config config = smr_config_default_image();
    config.track.mode = SMR_TRACK_REPORT;
    config.track.ahead = 0.5f;
    config.track.iterations = 4;
    config.basic.iterations = 1;
    config.basic.iterations_last = 4;
    uint32_t more = 0;
    for (int within = 1; within; more++) {
        run r;
        begin(&r, parts.model[1], &config);
        set_volume(&r, 0);
        while (!tick(&r, 1).details.tracking)
            ;
        set_volume(&r, 1);
        tick(&r, 2);
        within = go_within(&r, 1500, more);
        set_volume(&r, 0);
        end(&r);
    }
    assert_true(more > 9u);
}

/* The share of vertices with a goal does not depend on how many vertices an abandoned iteration had chosen. */
TEST(test_fewer_active_vertices)
{
    const smr_mesh goal = rig_parts_goal(2);
    const smr_surface *surface = rig_surface(&goal);
    smr_config config = smr_config_default_image();
    config.basic.n_target_vertices = 800;
    config.basic.iterations = 1;
    config.basic.iterations_last = 4;
    config.track.mode = SMR_TRACK_RECOVER;
    config.track.iterations = 20;
    for (uint32_t jump = 1; jump < 20u; jump++) {
        run r;
        config.track.jump_mm = 0.1f * (float)jump;
        begin(&r, parts.model[1], &config);
        set_volume(&r, 0);
        while (!tick(&r, 1).details.tracking)
            ;
        set_volume(&r, 1);
        tick(&r, 3);
        assert_int_equal(SMR_OK, smr_set_active(r.s, 60));
        assert_int_equal(SMR_PARTIAL, smr_tick(r.s, 3000, NULL));
        set_surface(&r, 0, surface);
        end(&r);
    }
}
