/* test_measured.c: a report never shows a residual, a share or a convergence that nothing has measured: without
 * forces, with a target that no iteration has looked at, or where the search in an image has ended.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include <string.h>
#include "property/rig_ball_image.h"
#include "registration/tick/iteration_steps.h"

static const float none[3] = {0, 0, 0};

/* Two balls 60 mm apart, and surfaces a little larger; far: out of reach. */
static smr *start(const smr_port *port, const smr_surface *goal[2], const smr_surface **far)
{
    const smr_prepare_config radii = rig_radii(2, 15, 8, 0);
    smr_config config = smr_config_default();
    smr_mesh ball[2], larger;
    for (uint32_t i = 0; i < 2u; i++) {
        const float at[3] = {60.0f * (float)i, 0, 0};
        ball[i] = rig_ball(20, 6, 9, at);
        larger = rig_ball(22, 12, 18, at);
        goal[i] = rig_surface(&larger);
    }
    const float away[3] = {0, 900, 0};
    larger = rig_ball(22, 12, 18, away);
    *far = rig_surface(&larger);
    config.motion.plastic_um = 1000.0f; /* at rest by then */
    config.forces.curvature = 0.0f;
    return rig_init(rig_model(ball, 2, &radii), &config, port);
}

static smr_structure_report part_of(const smr *s, uint32_t structure)
{
    smr_structure_report part;
    assert_int_equal(SMR_OK, smr_get_structure_report(s, structure, &part));
    return part;
}

static void is_unmeasured(const smr_tick_report *r)
{
    assert_int_equal(0, r->converged);
    assert_int_equal(0, r->n_forces);
    assert_true(r->residual_mean_mm == -1.0f && r->details.residual_rms_mm == -1.0f &&
                r->details.residual_max_mm == -1.0f);
}

static void part_is_unmeasured(const smr_structure_report *part)
{
    assert_int_equal(0, part->n_forces + part->n_rejected);
    assert_true(part->residual_mean_mm == -1.0f && part->residual_max_mm == -1.0f && part->matched_share == -1.0f);
}

TEST(test_without_forces)
{
    const smr_surface *goal[2], *far;
    smr *s = start(NULL, goal, &far);
    smr_tick_report r = rig_run(s, 1000);
    assert_int_equal(1, r.done);
    is_unmeasured(&r);
    assert_true(r.details.matched_share == -1.0f);
    s = start(NULL, goal, &far);
    assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, far));
    r = rig_run(s, 1000);
    assert_int_equal(1, r.done);
    is_unmeasured(&r);
    assert_true(r.details.n_rejected > 0u && r.details.matched_share == 0.0f && part_of(s, 0).matched_share == 0.0f);
}

/* After the end a new target is not looked at; the other structure's figures stay. */
TEST(test_target_after_the_end)
{
    const smr_surface *goal[2], *far;
    smr *s = start(NULL, goal, &far);
    assert_int_equal(SMR_OK, smr_set_surface(s, 0, goal[0]));
    assert_int_equal(SMR_OK, smr_set_surface(s, 1, goal[1]));
    smr_tick_report r = rig_run(s, 1000);
    const smr_structure_report before = part_of(s, 1);
    assert_true(r.done && r.converged && r.details.matched_share > 0.9f && r.residual_mean_mm >= 0.0f);
    assert_int_equal(SMR_OK, smr_tick(s, 0, &r)); /* nothing new: the figures are still those of the last iteration */
    assert_true(r.done && r.converged && r.n_forces > 0u && r.residual_mean_mm >= 0.0f);
    assert_int_equal(SMR_OK, smr_set_surface(s, 0, far));
    assert_int_equal(SMR_OK, smr_tick(s, 0, &r));
    assert_int_equal(1, r.done);
    assert_int_equal(0, r.details.n_active + r.details.n_rejected);
    is_unmeasured(&r);
    assert_true(r.details.matched_share == -1.0f && !(r.details.attraction_used > 0.0f));
    smr_structure_report part = part_of(s, 0);
    part_is_unmeasured(&part);
    part = part_of(s, 1);
    assert_memory_equal(&before, &part, sizeof part);
    assert_int_equal(SMR_OK, smr_set_surface(s, 1, NULL));
    part = part_of(s, 1);
    part_is_unmeasured(&part);
}

/* Within an iteration figures are of the iteration before, but for a target that came since. */
TEST(test_target_within_an_iteration)
{
    const smr_surface *goal[2], *far;
    rig_clock clock;
    const smr_port port = rig_clock_port(&clock, RIG_CLOCK_STEADY, 100);
    smr *s = start(&port, goal, &far);
    smr_tick_report r;
    assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, goal[0]));
    while (s->schedule.repairing > 0u || s->schedule.iteration < 2u)
        (void)rig_run(s, 1);
    assert_int_equal(SMR_PARTIAL, smr_tick(s, 1, &r));
    assert_true(smr_forces_pending(s) && r.n_forces > 0u && r.residual_mean_mm >= 0.0f);
    assert_int_equal(SMR_OK, smr_set_surface(s, 0, goal[0]));
    assert_int_equal(SMR_PARTIAL, smr_tick(s, 1, &r));
    is_unmeasured(&r);
    while (smr_forces_pending(s))
        assert_int_equal(SMR_PARTIAL, smr_tick(s, 1, &r));
    assert_true(r.n_forces > 0u && r.residual_mean_mm >= 0.0f);
    assert_int_equal(SMR_OK, smr_set_surface(s, 0, goal[0])); /* the forces are found: they are about the old one */
    while (smr_tick(s, 1, &r) == SMR_PARTIAL)
        is_unmeasured(&r);
    is_unmeasured(&r);
    r = rig_run(s, 1);
    assert_true(r.n_forces > 0u && r.residual_mean_mm >= 0.0f);
}

static float similarity(smr *s)
{
    smr_verdict v;
    assert_int_equal(SMR_OK, smr_get_verdict(s, 0, &v));
    return v.image_similarity;
}

static float seen_share(const smr *s)
{
    unsigned char seen[400];
    uint32_t n = 0;
    assert_int_equal(SMR_OK, smr_get_visible(s, 0, seen));
    for (uint32_t v = 0; v < s->shared.n; v++)
        n += seen[v];
    return (float)n / (float)s->shared.n;
}

TEST(test_search_that_ends)
{
    static const smr_landmark mark = {0, SMR_NONE, {28, 0, 0}, {30, 0, 0}, 1.0f, 0};
    const smr_volume reference = rig_ball_image(28, rig_nowhere), target = rig_ball_image(30, rig_nowhere);
    const smr_mesh mesh = rig_ball(28, 9, 14, none);
    smr_prepare_config prepare = rig_radii(2, 20, 10, 0);
    smr_config c = smr_config_default_image();
    smr_tick_report r = {0};
    float last = -1.0f, share = -1.0f;
    uint32_t idle = 0;
    prepare.reference = &reference;
    c.image.profile_mm = 6.0f;
    c.image.gradient_mm = 2.0f;
    c.image.profile_end_mm = c.image.gradient_end_mm = 0.0f;
    c.partial.n_landmarks = 1;
    smr *s = rig_init(rig_model(&mesh, 1, &prepare), &c, NULL);
    assert_int_equal(SMR_OK, smr_set_volume(s, &target));
    while (r.done == 0u) {
        r = rig_run(s, 1);
        share = (float)r.n_forces / (float)(r.n_forces + r.details.n_rejected);
        if (smr_image_seeks(&s->forces.image, 0)) {
            assert_true(r.details.matched_share == share && part_of(s, 0).matched_share == share);
            last = share;
        } else {
            idle++;
            assert_true(share == 0.0f && r.residual_mean_mm == -1.0f);
            assert_true(r.details.matched_share == last && part_of(s, 0).matched_share == last);
        }
    }
    assert_true(idle > 0u && last > 0.5f);
    assert_true(seen_share(s) > 0.95f && similarity(s) > 0.5f); /* compared where the vertices are now */
    c.track.mode = SMR_TRACK_RECOVER;
    smr *tracks = rig_init(s->shared.model, &c, NULL);
    assert_int_equal(SMR_OK, smr_set_volume(tracks, &target));
    while (!tracks->schedule.tracking)
        (void)rig_run(tracks, 1);
    assert_int_equal(SMR_OK, smr_set_landmarks(tracks, &mark, 1));
    assert_int_equal(SMR_OK, smr_set_landmarks(tracks, NULL, 0)); /* gone before an iteration has seen them */
    (void)rig_run(tracks, 1);
    assert_int_equal(SMR_IMAGE_CURRENT, tracks->schedule.image_age);
    assert_int_equal(SMR_OK, smr_set_landmarks(tracks, &mark, 1)); /* newer than the image, whose goals stay */
    (void)rig_run(tracks, 100);
    assert_true(tracks->schedule.image_age == SMR_IMAGE_PAST && seen_share(tracks) > 0.9f);
    c.track.mode = SMR_TRACK_OFF;
    c.image.profile_mm = c.image.gradient_mm = 0.0f; /* never sought at all */
    s = rig_init(s->shared.model, &c, NULL);
    assert_int_equal(SMR_OK, smr_set_volume(s, &target));
    r = rig_run(s, 1000);
    assert_int_equal(1, r.done);
    is_unmeasured(&r);
    assert_true(r.details.matched_share == -1.0f && part_of(s, 0).matched_share == -1.0f);
    assert_true(similarity(s) > 0.5f);
    float *const point = rig_alloc(3u * sizeof *point * mesh.n_vertices); /* all in one place, without normals */
    assert_int_equal(SMR_OK, smr_set_positions(s, 0, point));
    assert_true(similarity(s) == 0.0f && seen_share(s) == 0.0f);
}

/* A model on a part of itself, or on all of a larger one; as points, which have no normals, with goals: a pose from
 * what has a goal; expected errors where normals say what is seen, also where nothing has moved at all. */
TEST(test_pose_of_a_part)
{
    for (uint32_t k = 0; k < 3u; k++) {
        smr_mesh ball = rig_ball(20, 9, 14, none), goal = rig_ball(k > 0u ? 21 : 20, 9, 14, none);
        const smr_prepare_config radii = rig_radii(2, 15, 8, 0);
        smr_config config = smr_config_default();
        float mm, expected[400];
        smr_pose pose;
        config.caller.goals = k == 2u;
        config.partial.coverage = k == 0u ? SMR_COVERAGE_PARTIAL : SMR_COVERAGE_AUTO;
        goal.n_triangles /= k == 0u ? 2u : 1u;
        ball.n_triangles = k < 2u ? ball.n_triangles : 0u;
        smr *s = rig_init(rig_model(&ball, 1, &radii), &config, NULL);
        assert_int_equal(SMR_OK,
                         k < 2u ? smr_set_surface(s, 0, rig_surface(&goal)) : smr_set_goals(s, 0, goal.xyz, NULL));
        for (uint32_t i = 0; i < 40u; i++) {
            assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
            assert_int_equal(SMR_OK, smr_get_pose(s, 0, &pose, &mm));
            assert_true(mm >= 0.0f && mm < 1.1f && fabsf(pose.m[0][0] - 1.0f) < 0.01f && fabsf(pose.m[2][3]) < 0.1f);
        }
        if (k == 0u)
            memcpy(s->shape.x, s->shape.start, 3u * s->shared.n * sizeof *s->shape.x);
        assert_int_equal(SMR_OK, smr_get_expected_error(s, 0, expected));
        for (uint32_t v = 0; v < ball.n_vertices; v++)
            assert_true(k < 2u ? expected[v] >= 0.0f && expected[v] < 40.0f : expected[v] == -1.0f);
    }
}

/* A mesh's noise has made vertices slide. */
TEST(test_noisy_mesh)
{
    const smr_surface *goal[2], *far;
    smr_verdict v[2];
    for (uint32_t k = 0; k < 2u; k++) {
        smr *s = start(NULL, goal, &far);
        ((smr_surface *)(uintptr_t)goal[0])->noise_mm = (float)k;
        assert_int_equal(SMR_OK, smr_set_surface(s, 0, goal[0]));
        (void)rig_run(s, 40);
        for (uint32_t i = 0; i < 3u * s->shared.n; i++) /* uneven */
            s->shape.x[i] += 0.2f * (float)(i * 7u % 5u);
        smr_guard_close(s);
        assert_int_equal(SMR_OK, smr_get_verdict(s, 0, &v[k]));
    }
    assert_true(v[1].expected_along_mm > 1.001f * v[0].expected_along_mm);
}

/* Structures that have turned far against each other are in doubt together, but not in tracking. */
TEST(test_structures_turned_apart)
{
    const smr_surface *goal[2], *far;
    smr *s = start(NULL, goal, &far);
    smr_verdict v;
    float m[9];
    rig_rotation(1, 0, 0, 100, m);
    for (uint32_t i = 0; i < 2u; i++)
        assert_int_equal(SMR_OK, smr_set_surface(s, i, goal[i]));
    for (uint32_t turned = 0; turned < 3u; turned++) { /* not yet; turned; likewise in tracking */
        assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
        for (uint32_t i = 0; i < s->shared.n && turned > 0u; i++)
            if (smr_model_owner(s->shared.model, i) == 1u)
                smr_put3(s->shape.x, i, smr_mul(m, smr_get3(s->shape.start, i)));
        s->schedule.tracking = turned == 2u;
        smr_guard_close(s);
        assert_int_equal(SMR_OK, smr_get_verdict(s, SMR_ALL, &v));
        assert_int_equal(turned == 1u, (v.reasons & SMR_REASON_ROTATION) != 0u);
        s->schedule.tracking = 0;
        smr_guard_close(s);
    }
}

/* Expected errors are found anew after ticks, also where recording has ended since, and as many changes lie behind its
 * end as before. */
TEST(test_after_the_end_of_a_log)
{
    const smr_surface *goal[2], *far;
    float one[64], other[64];
    smr *s = start(NULL, goal, &far), *twin = start(NULL, goal, &far);
    const size_t bytes = s->shape.structure[0].n_vertices * sizeof *one;
    assert_true(bytes <= sizeof one);
    assert_int_equal(SMR_OK, smr_set_surface(s, 0, goal[0]));
    assert_int_equal(SMR_OK, smr_set_surface(twin, 0, goal[0]));
    (void)rig_run(s, 3);
    assert_int_equal(SMR_OK, smr_get_expected_error(s, 0, one));
    assert_int_equal(SMR_OK, smr_set_log(s, NULL, 0));
    (void)rig_run(s, 5);
    (void)rig_run(twin, 8);
    assert_int_equal(SMR_OK, smr_get_expected_error(s, 0, one));
    assert_int_equal(SMR_OK, smr_get_expected_error(twin, 0, other));
    assert_true(smr_state_hash(s) == smr_state_hash(twin));
    assert_memory_equal(one, other, bytes);
}

/* How a structure has moved since the start is told of itself, not of all structures together. */
TEST(test_motion_of_a_structure)
{
    const smr_surface *goal[2], *far;
    smr *s = start(NULL, goal, &far);
    smr_verdict v;
    float m[9];
    rig_rotation(0, 0, 1, 30, m);
    for (uint32_t i = 0; i < s->shared.n; i++)
        if (smr_model_owner(s->shared.model, i) == 1u)
            smr_put3(s->shape.x, i, smr_scale(smr_mul(m, smr_get3(s->shape.start, i)), 1.5f));
    smr_guard_close(s);
    for (uint32_t i = 0; i < 2u; i++) {
        assert_int_equal(SMR_OK, smr_get_verdict(s, i, &v));
        assert_true(fabsf(v.turned_deg - 30.0f * (float)i) < 0.1f && fabsf(v.scale - (i ? 1.5f : 1.0f)) < 1.0e-3f);
    }
}
