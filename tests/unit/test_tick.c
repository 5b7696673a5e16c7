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
