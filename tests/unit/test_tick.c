/* test_tick.c: an iteration's report, and the phase at which a tick resumes.
 * SPDX-License-Identifier: MIT */
#include "suite.h"

#include <math.h>
#include <string.h>

#include "registration/tick/iteration_steps.h"

static const float none[3] = {0, 0, 0};

static smr *start(const smr_config *config, const smr_port *port)
{
    const float off[3] = {5, 3, -2};
    const smr_mesh mesh = rig_ball(30, 9, 12, none), goal = rig_ball(35, 12, 16, off);
    const smr_prepare_config radii = rig_radii(2, 25, 15, 0);
    smr *s = rig_init(rig_model(&mesh, 1, &radii), config, port);
    assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, rig_surface(&goal)));
    return s;
}

TEST(test_report)
{
    smr_config c = smr_config_default();
    smr_tick_report report;
    uint32_t n = 0, next_radius = 0;
    smr *s = start(&c, NULL);
    do {
        const uint32_t radius = s->schedule.radius, at = s->schedule.radius_iteration,
                       repairs = s->schedule.repairing > 0u;
        memset(&report, 0xee, sizeof report);
        assert_int_equal(SMR_OK, smr_tick(s, 0, &report));
        assert_int_equal(++n, report.iteration);
        assert_int_equal(0, report.details.phase);
        assert_int_equal(radius, report.details.radius); /* also where it was the last one there */
        assert_int_equal(repairs ? 0u : at + 1u, report.details.radius_iteration);
        next_radius += s->schedule.radius != radius;
        assert_int_equal(s->shared.n, report.details.n_active);
        assert_int_equal(s->shared.n, report.n_forces + report.details.n_rejected);
        assert_true(report.residual_mean_mm <= report.details.residual_rms_mm * 1.0001f);
        assert_true(report.details.residual_rms_mm <= report.details.residual_max_mm * 1.0001f);
        assert_true(report.progress > 0.0f || s->schedule.repairing > 0u || report.details.radius_iteration == 0u);
        for (uint32_t i = 0; i < SMR_PHASES; i++)
            assert_true(report.details.phase_ns[i] == 0u); /* no clock */
    } while (!report.done && n < 500u);
    assert_int_equal(1, report.done);
    assert_int_equal(1, next_radius);
    assert_int_equal(SMR_OK, smr_tick(s, 0, &report)); /* nothing to do */
    assert_true(report.details.radius == 1u && report.details.radius_iteration == s->schedule.radius_iteration &&
                report.iteration == n);
    assert_true(report.residual_mean_mm < 1.0f); /* and it did get there: 6 mm at first */
}

typedef struct targets {
    const smr_surface *surface[2];
    uint32_t next;
} targets;

static const void *next_target(void *ctx, SMR_UNUSED const smr_log_record *record)
{
    targets *t = ctx;
    return t->surface[t->next++];
}

/* Replays the log, whose ticks must have the recorded results. */
static void replay(const smr_model *model, const smr_config *config, const void *log, size_t bytes, targets *t)
{
    smr_replay run;
    smr_replay_report report = {0};
    smr *s = rig_init(model, config, NULL);
    t->next = 0;
    assert_int_equal(SMR_OK, smr_replay_start(s, log, bytes, next_target, t, &run));
    while (!report.ended) {
        assert_int_equal(SMR_OK, smr_replay_tick(&run, &report));
        assert_true(report.ended || !report.differs);
    }
}

/* A target set while results of forces are stored, a task after the other, finds all of them stored, as one set before
 * or after does, and as a replay does. Readers find results that are not stored yet. */
TEST(test_target_between_forces_and_match)
{
    const float off[3] = {-4, 2, 3};
    const smr_mesh mesh = rig_ball(30, 15, 22, none), goal = rig_ball(33, 12, 16, off);
    const smr_prepare_config radii = rig_radii(2, 25, 15, 0);
    const smr_model *model = rig_model(&mesh, 1, &radii);
    targets t = {{rig_surface(&mesh), rig_surface(&goal)}, 0};
    const smr_surface *target = t.surface[0], *other = t.surface[1];
    smr_config c = smr_config_default();
    static unsigned char log[100000], visible[1000];
    uint64_t end[3];
    c.partial.coverage = SMR_COVERAGE_PARTIAL;
    for (uint32_t done = 0; done < 3u; done++) {
        smr *s = rig_init(model, &c, NULL);
        smr_tick_report report;
        smr_structure_report structure;
        smr_log_state kept;
        assert_int_equal(SMR_OK, smr_set_log(s, log, sizeof log));
        assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, target));
        assert_int_equal(SMR_PARTIAL, smr_tick_until(s, smr_sources_keep));
        assert_int_equal(SMR_OK, smr_get_structure_report(s, 0, &structure));
        assert_int_equal(SMR_OK, smr_get_visible(s, 0, visible));
        assert_true(structure.n_forces == s->shared.n && structure.matched_share == 1.0f);
        for (uint32_t v = 0; v < s->shared.n; v++)
            assert_true(visible[v]);
        assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
        const uint32_t n = smr_sources_keep_tasks(&s->forces), first = done == 2u ? n : done;
        assert_true(n > 1u);
        for (uint32_t i = 0; i < 2u; i++)
            assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
        assert_int_equal(SMR_PARTIAL, smr_tick_until(s, smr_sources_keep));
        while (s->next_task < first)
            smr_sources_keep(&s->forces, s->next_task++, 0);
        smr_guard_close(s);
        if (done < 2u)
            s->forces.found_last[(n - 1u) * SMR_CHUNK] = SMR_FOUND_UNDECIDED; /* not stored as yet */
        assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, other));
        assert_true(smr_steps[s->step - 1u].run == smr_sources_keep && s->next_task == 0u);
        assert_memory_equal(s->forces.found, s->forces.found_last, s->shared.n);
        for (uint32_t v = 0; v < s->shared.n; v++)
            assert_int_equal(SMR_NONE, s->forces.surface.warm[v]);
        for (uint32_t i = 0; i < 4u; i++)
            assert_int_equal(SMR_OK, smr_tick(s, 0, &report));
        end[done] = smr_state_hash(s);
        assert_int_equal(SMR_OK, smr_get_log(s, &kept));
        replay(model, &c, log, (size_t)kept.bytes, &t);
    }
    assert_true(end[0] == end[1] && end[0] == end[2]);
}

TEST(test_resumes_at_the_phase_it_says)
{
    smr_config c = smr_config_default();
    rig_clock clock;
    const smr_port port = rig_clock_port(&clock, RIG_CLOCK_STEADY, 1000);
    smr *s = start(&c, &port);
    smr_tick_report report = {0};
    uint32_t seen = 0, partial = 0;
    for (uint32_t i = 0; i < 2000u && report.iteration < 4u; i++) {
        const smr_status status = smr_tick(s, 2000, &report);
        assert_true(status == SMR_OK ? report.details.phase == 0u && s->step == 0u : status == SMR_PARTIAL);
        seen |= 1u << report.details.phase;
        partial += status == SMR_PARTIAL;
    }
    assert_int_equal(4, report.iteration);
    assert_int_equal((1u << SMR_PHASES) - 1u, seen);
    assert_true(partial > 20u);
}
