/* test_target_serial.c: positions tell the number of the target that they follow, over budgets, saves and replays; no
 * result is good before a new target was followed or while a jump is recovered from; the first tick gives a rigid pose
 * and how far the target is from it; a noisy cloud that moves settles.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include "log/record/log_format.h"
#include "unit_moving_bone.h"

enum { LOG = SMR_LOG_BYTES(4000, 60), CLOUD = 500, FRAMES = 9 };

static smr *started(const scene *e, const smr_port *port)
{
    smr *s = rig_init(e->model, &e->config, port);
    smr_tick_report r = {0};
    assert_int_equal(SMR_OK, smr_tick(s, 0, &r));
    assert_int_equal(0, r.details.target_serial); /* no target was set */
    assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, e->at[0]));
    assert_int_equal(1, until_settled(s, 1000).details.target_serial);
    return s;
}

static smr_verdict verdict_of(smr *s)
{
    smr_verdict v;
    assert_int_equal(SMR_OK, smr_get_verdict(s, 0, &v));
    assert_true(v.level != SMR_VERDICT_GOOD || v.reasons == 0u);
    return v;
}

static int recovers(smr *s) { return (verdict_of(s).reasons & SMR_REASON_RECOVERING) != 0u; }

/* A copy by way of a save, with its target set again. */
static smr *restored(const smr *s, const scene *e, const smr_surface *target)
{
    smr *copy = rig_restored(s, e->model, &e->config);
    assert_int_equal(SMR_OK, smr_set_surface(copy, SMR_ALL, target));
    return copy;
}

/* Partial ticks leave the number of the former target. A target that comes when the forces are complete waits for the
 * next iteration, an earlier one does not. */
TEST(test_partial_ticks)
{
    const scene e = make(SMR_TRACK_REPORT);
    rig_clock clock = {0};
    const smr_port port = rig_clock_port(&clock, RIG_CLOCK_STEADY, 1000);
    smr_tick_report r = {0};
    smr *s = started(&e, &port);
    uint32_t partial = 0;
    for (uint32_t late = 0; late < 2u; late++) {
        const uint32_t number = late ? 3u : 1u;
        assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, e.at[1]));
        do {
            assert_int_equal(SMR_PARTIAL, smr_tick(s, 10000, &r));
            assert_int_equal(number, r.details.target_serial);
            partial++;
        } while (late && r.details.phase == SMR_PHASE_FORCES);
        assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, e.at[0]));
        assert_int_equal(SMR_OK, smr_tick(s, 0, &r));
        assert_int_equal(late ? number + 1u : number + 2u, r.details.target_serial);
        assert_int_equal(late, recovers(s));
        assert_int_equal(SMR_OK, smr_tick(s, 0, &r));
        assert_int_equal(number + 2u, r.details.target_serial);
        assert_false(recovers(s));
    }
    assert_true(partial > 2u);
}

/* Each call that sets targets counts, a refused one does not; the start follows none. */
TEST(test_counts)
{
    scene e = make(SMR_TRACK_REPORT);
    const smr_pose same = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    smr_tick_report r = {0};
    e.config.caller.goals = 1;
    smr *s = started(&e, NULL);
    assert_int_equal(SMR_E_INPUT, smr_set_surface(s, 1, e.at[1]));
    assert_int_equal(SMR_E_INPUT, smr_set_goals(s, 1, e.source.xyz, NULL));
    assert_int_equal(SMR_OK, smr_set_goals(s, 0, e.source.xyz, NULL));
    assert_int_equal(SMR_OK, smr_set_goals(s, 0, NULL, NULL));
    assert_int_equal(SMR_OK, smr_set_landmarks(s, NULL, 0));
    assert_int_equal(SMR_OK, smr_set_points(s, 0, NULL));
    assert_int_equal(SMR_OK, smr_set_surface(s, 0, e.at[1]));
    assert_true(recovers(s));
    assert_int_equal(SMR_OK, smr_tick(s, 0, &r));
    assert_int_equal(6, r.details.target_serial);
    assert_int_equal(SMR_OK, smr_set_pose(s, &same));
    assert_true(recovers(s));
    assert_int_equal(SMR_OK, smr_tick(s, 0, &r));
    assert_int_equal(6, r.details.target_serial);
}

/* The field and the verdict: from the tick that finds the jump up to the end of the coarser radii, saved in between. */
TEST(test_recovering)
{
    scene e = make(SMR_TRACK_RECOVER);
    smr_tick_report r = {0}, twin_report = {0};
    smr *s = started(&e, NULL);
    uint32_t n = 0;
    const uint32_t radius = s->schedule.radius;
    assert_int_equal(SMR_VERDICT_GOOD, verdict_of(s).level);
    assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, e.at[2]));
    smr *twin = restored(s, &e, e.at[2]);
    for (; !r.details.settled; n += r.details.recovering) {
        assert_int_equal(recovers(s), recovers(twin));
        assert_int_equal(SMR_OK, smr_tick(s, 0, &r));
        assert_int_equal(SMR_OK, smr_tick(twin, 0, &twin_report));
        assert_memory_equal(&r, &twin_report, sizeof r);
        assert_int_equal(2, r.details.target_serial);
        assert_int_equal(r.details.recovering, recovers(s));
        assert_int_equal(r.details.recovering, s->schedule.radius < radius);
        if (r.details.recovering && n % 8u == 3u)
            twin = restored(s, &e, e.at[2]);
    }
    assert_true(n > 10u && r.details.jumped && !recovers(s));
    twin = restored(s, &e, e.at[2]);
    assert_false(recovers(twin));
    assert_int_equal(SMR_OK, smr_tick(twin, 0, &r)); /* nothing is left to do */
    assert_int_equal(2, r.details.target_serial);
}

static const void *input_of(void *ctx, const smr_log_record *record)
{
    const scene *e = ctx;
    for (uint32_t i = 0; i < 3u; i++)
        if (smr_surface_checksum(e->at[i]) == record->checksum)
            return e->at[i];
    return NULL;
}

/* A run of short budgets, whose targets come at any moment, and its replay have the same numbers. */
TEST(test_replays)
{
    scene e = make(SMR_TRACK_RECOVER);
    rig_clock clock = {0};
    const smr_port port = rig_clock_port(&clock, RIG_CLOCK_STEADY, 50000);
    smr *s = rig_init(e.model, &e.config, &port);
    unsigned char *log = rig_alloc(LOG);
    uint32_t partial = 0, serial[200], recovering[200], n = 0;
    smr_tick_report r = {0};
    assert_int_equal(SMR_OK, smr_set_log(s, log, LOG));
    for (uint32_t i = 0; i < 200u; i++) {
        if (i % 21u == 0u)
            assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, e.at[i % 3u]));
        partial += smr_tick(s, i < 100u ? 0u : 1000000u + 35000u * (i % 30u), &r) == SMR_PARTIAL;
        serial[i] = r.details.target_serial;
        recovering[i] = r.details.recovering;
    }
    smr *twin = rig_init(e.model, &e.config, NULL);
    smr_replay replay;
    smr_replay_report report;
    assert_int_equal(SMR_OK, smr_replay_start(twin, log, LOG, input_of, &e, &replay));
    for (; n < 200u; n++) {
        assert_int_equal(SMR_OK, smr_replay_tick(&replay, &report));
        assert_int_equal(0, report.differs);
        if (report.record.complete) {
            assert_int_equal(serial[n], twin->report.details.target_serial);
            assert_int_equal(recovering[n], twin->report.details.recovering);
        }
    }
    assert_true(partial > 20u && serial[199] > 5u);
}

/* Mean distance of the rest shape in a pose to the target. */
static float off(const smr *s, const scene *e, const smr_surface *target)
{
    smr_pose pose;
    smr_closest hit;
    float mm, sum = 0.0f;
    assert_int_equal(SMR_OK, smr_get_pose(s, 0, &pose, &mm));
    for (uint32_t v = 0; v < e->source.n_vertices; v++) {
        float p[3];
        smr_put3(p, 0, smr_pose_apply(&pose, smr_load(e->source.xyz + 3u * (size_t)v)));
        assert_int_equal(SMR_OK, smr_surface_closest(target, p, NULL, -1.0f, 1000.0f, &hit));
        sum += hit.distance;
    }
    return sum / (float)e->source.n_vertices;
}

/* While no iteration after the start or a new target is complete, the pose is the former one, and nothing tells how far
 * off it is. */
static void assert_former_pose(const smr *s, const smr_pose *former)
{
    smr_pose pose;
    float mm;
    assert_int_equal(SMR_OK, smr_get_pose(s, 0, &pose, &mm));
    assert_true(mm == -1.0f);
    assert_memory_equal(former, &pose, sizeof pose);
}

/* The model is its own target's shape, so that a rigid pose says all: after one tick, and at rest. */
TEST(test_pose)
{
    scene e = make(SMR_TRACK_REPORT);
    rig_clock clock = {0};
    const smr_port port = rig_clock_port(&clock, RIG_CLOCK_STEADY, 1000);
    const smr_mesh there = turned(&e.source, 2, 1.5f);
    smr_pose pose, all;
    float mm[3];
    smr_tick_report r;
    e.at[0] = rig_surface(&e.source);
    e.at[1] = rig_surface(&there);
    e.config.basic.attract = 0;
    smr *s = started(&e, &port);
    assert_int_equal(SMR_E_NULL, smr_get_pose(s, 0, NULL, mm));
    assert_int_equal(SMR_E_NULL, smr_get_pose(s, 0, &pose, NULL));
    assert_int_equal(SMR_E_INPUT, smr_get_pose(s, 1, &pose, mm));
    assert_int_equal(SMR_OK, smr_get_pose(s, 0, &pose, mm));
    assert_true(mm[0] >= 0.0f && mm[0] < 0.05f && fabsf(pose.m[0][3]) < 0.05f && fabsf(pose.m[0][0] - 1.0f) < 1.0e-3f);
    assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, e.at[1]));
    assert_former_pose(s, &pose);
    assert_int_equal(SMR_PARTIAL, smr_tick(s, 10000, NULL));
    assert_former_pose(s, &pose);
    assert_int_equal(SMR_OK, smr_tick(s, 0, &r));
    assert_int_equal(SMR_OK, smr_get_pose(s, 0, &pose, &mm[0]));
    const float first = off(s, &e, e.at[1]);
    (void)until_settled(s, 1000);
    assert_int_equal(SMR_OK, smr_get_pose(s, SMR_ALL, &all, &mm[1]));
    const float last = off(s, &e, e.at[1]);
    print_message("first pose: %.3f mm, %.3f mm off; at rest %.3f, %.3f\n", (double)mm[0], (double)first, (double)mm[1],
                  (double)last);
    assert_true(fabsf(mm[0] - first) < 0.2f * first && first < r.residual_mean_mm);
    assert_true(fabsf(mm[1] - last) < 0.05f && last < 0.1f);
    smr *twin = rig_restored(s, e.model, &e.config);
    assert_int_equal(SMR_E_STATE, smr_get_pose(twin, 0, &pose, mm));
    assert_int_equal(SMR_OK, smr_set_surface(twin, SMR_ALL, e.at[1]));
    assert_former_pose(twin, &all);
}

/* A finished schedule never follows goals that come later: no result is good on them, whatever was measured before. */
TEST(test_goals_after_the_end)
{
    scene e = make(SMR_TRACK_OFF);
    const smr_mesh near = turned(&e.source, 1, 1), away = turned(&e.source, 0, 60);
    e.config.caller.goals = 1;
    smr *s = rig_init(e.model, &e.config, NULL);
    assert_int_equal(SMR_OK, smr_set_goals(s, 0, near.xyz, NULL));
    assert_true(rig_run(s, 1000).done && verdict_of(s).level == SMR_VERDICT_GOOD);
    assert_int_equal(SMR_OK, smr_set_goals(s, 0, away.xyz, NULL));
    assert_true(verdict_of(s).level != SMR_VERDICT_GOOD && recovers(s));
}

/* A residual is measured by each complete iteration: on the target itself, within its noise, in repairs of folds. */
TEST(test_pose_without_forces)
{
    for (uint32_t noise = 0; noise < 2u; noise++) {
        scene e = make(SMR_TRACK_OFF);
        const smr_mesh there = turned(&e.source, 0, noise ? 0.5f : 0.0f);
        smr_pose pose;
        smr_tick_report r = {0};
        uint32_t repairs = 0;
        e.config.partial.noise_mm = noise ? 2.0f : 0.0f;
        smr *s = rig_init(e.model, &e.config, NULL);
        assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, rig_surface(&there)));
        while (!r.done) {
            float mm;
            repairs += s->schedule.repairing > 0u;
            assert_int_equal(SMR_OK, smr_tick(s, 0, &r));
            assert_int_equal(SMR_OK, smr_get_pose(s, SMR_ALL, &pose, &mm));
            assert_true(mm >= 0.0f && fabsf(mm - r.residual_mean_mm) < 0.01f);
        }
        assert_true(repairs > 0u && (r.residual_mean_mm > 0.1f) == noise);
    }
}

/* Follows clouds with noise on a bone that moves by 2 mm a frame, at most so many ticks each. Returns the mean error of
 * the last frame's vertices; *median: ticks of a frame. */
static float follow_cloud(uint32_t ticks, uint32_t *median)
{
    scene e = make(SMR_TRACK_REPORT);
    uint32_t count[FRAMES], seed = 7;
    float sum = 0.0f;
    smr_points *const cloud = rig_cloud(CLOUD);
    e.config.basic.n_target_vertices = CLOUD;
    smr *s = rig_init(e.model, &e.config, NULL);
    for (uint32_t i = 0; i < FRAMES; i++) {
        const smr_mesh now = turned(&e.source, 0.3f * (float)i, 1.2f * (float)i);
        smr_tick_report r = {0};
        assert_int_equal(SMR_OK, smr_points_clear(cloud));
        for (uint32_t k = 0; k < CLOUD; k++) {
            const float *const at = now.xyz + 3u * (size_t)rig_random(&seed, now.n_vertices);
            const float p[3] = {at[0] + rig_between(&seed, -0.6f, 0.6f), at[1] + rig_between(&seed, -0.6f, 0.6f),
                                at[2] + rig_between(&seed, -0.6f, 0.6f)};
            assert_int_equal(SMR_OK, smr_points_add(cloud, p, NULL, NULL, 1));
        }
        assert_int_equal(SMR_OK, smr_set_points(s, 0, cloud));
        for (count[i] = 0; count[i] < (i == 0u ? 1000u : ticks) && !r.details.settled; count[i]++)
            assert_int_equal(SMR_OK, smr_tick(s, 0, &r));
        const float *const xyz = rig_positions(s, e.model);
        for (uint32_t v = 0; v < now.n_vertices && i + 4u >= FRAMES; v++)
            sum += rig_far(now.xyz + 3u * (size_t)v, xyz + 3u * (size_t)v, 1) / (4.0f * (float)now.n_vertices);
    }
    for (uint32_t i = 1; i < FRAMES; i++) /* the median of frames 1 .. FRAMES - 1 */
        for (uint32_t k = i; k > 1u && count[k] < count[k - 1u]; k--) {
            const uint32_t more = count[k - 1u];
            count[k - 1u] = count[k];
            count[k] = more;
        }
    *median = count[FRAMES / 2u];
    return sum;
}

TEST(test_noise_settles)
{
    uint32_t median, most;
    const float soon = follow_cloud(12, &median), late = follow_cloud(30, &most);
    print_message("%u ticks, %.3f mm; with at most 12: %.3f mm\n", (unsigned)most, (double)late, (double)soon);
    assert_true(most <= 12u && soon <= 1.05f * late);
}
