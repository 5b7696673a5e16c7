/* test_track_images.c: after the schedule a registration follows images that are replaced, as it follows surfaces: the
 * same bits for any threads, and from a log. The target is a ball that moves through computed images.
 * SPDX-License-Identifier: MIT */
#include "cmocka_first.h"

#include "log/record/log_format.h"
#include "registration/registration.h"
#include "unit_moving_ball.h"

enum { MARKS = 6, LOG = SMR_LOG_BYTES(2000, 60) };

static int tidy(void **state)
{
    (void)state;
    rig_free_all();
    return 0;
}

static void follow(uint32_t track)
{
    const scene e = make(track);
    smr_tick_report r;
    smr *s = rig_init(e.model, &e.config, NULL);
    for (uint32_t i = 0; i < FRAMES; i++) {
        assert_int_equal(SMR_OK, smr_set_volume(s, &e.frame[i]));
        r = until_settled(s);
        const float off = off_ball(s, &e, i);
        assert_true(r.details.tracking && r.details.settled && off < 0.8f);
    }
    assert_int_equal(SMR_OK, smr_set_volume(s, &e.frame[FRAMES]));
    r = until_settled(s);
    assert_true(r.details.tracking && r.details.jumped && off_ball(s, &e, FRAMES) < 0.8f);
}

static void test_follows(void **state)
{
    (void)state;
    follow(SMR_TRACK_RECOVER);
    follow(SMR_TRACK_REPORT);
}

/* Points of the ball, all around it, where they are in a frame. */
static void set_marks(smr *s, const scene *e, uint32_t frame)
{
    smr_landmark mark[MARKS] = {{0}};
    for (uint32_t i = 0; i < MARKS; i++) {
        mark[i] = (smr_landmark){0, SMR_NONE, {0}, {0}, 1.0f, 0};
        mark[i].rest[i / 2u] = i % 2u == 0u ? RIG_BALL_MM : -RIG_BALL_MM;
        for (uint32_t c = 0; c < 3u; c++)
            mark[i].place[c] = mark[i].rest[c] + e->centre[frame][c];
    }
    assert_int_equal(SMR_OK, smr_set_landmarks(s, mark, MARKS));
}

/* What is set while ticks are cut by the clock: images, and marks that leave them behind. */
static void sequence(const scene *e, smr *s, uint64_t budget)
{
    for (uint32_t i = 0; i < 4u; i++) {
        assert_int_equal(SMR_OK, smr_set_volume(s, &e->frame[i]));
        for (uint32_t k = 0; k < (i == 0u ? 2000u : 57u); k++) {
            if (k == 30u && i > 0u)
                set_marks(s, e, i + 1u);
            const smr_status status = smr_tick(s, budget, NULL);
            assert_true(status == SMR_OK || status == SMR_PARTIAL);
        }
    }
}

static void test_same_bits(void **state)
{
    scene e = make(SMR_TRACK_RECOVER);
    uint64_t hash = 0;
    (void)state;
    e.config.partial.n_landmarks = MARKS;
    for (uint32_t k = 0; k < RIG_SCHEDULERS; k++) {
        const smr_port port = rig_port(k, 4);
        smr *s = rig_init(e.model, &e.config, &port);
        sequence(&e, s, 0);
        if (k == 0u)
            hash = smr_state_hash(s);
        assert_true(hash == smr_state_hash(s) && s->schedule.image_age == SMR_IMAGE_PAST);
    }
}

/* Images by their checksums. */
static const void *by_checksum(void *ctx, const smr_log_record *record)
{
    const scene *e = ctx;
    for (uint32_t i = 0; i < 4u; i++)
        if (smr_volume_checksum(&e->frame[i]) == record->checksum)
            return &e->frame[i];
    return NULL;
}

static void test_replays(void **state)
{
    static unsigned char memory[LOG];
    scene e = make(SMR_TRACK_RECOVER);
    rig_clock clock = {0};
    uint32_t partial = 0;
    (void)state;
    e.config.partial.n_landmarks = MARKS;
    const smr_port port = rig_clock_port(&clock, RIG_CLOCK_STEADY, 1000);
    smr *s = rig_init(e.model, &e.config, &port);
    assert_int_equal(SMR_OK, smr_set_log(s, memory, sizeof memory));
    sequence(&e, s, 60000);
    assert_int_equal(1, s->schedule.tracking);
    assert_int_equal(SMR_IMAGE_PAST, s->schedule.image_age);
    smr *again = rig_init(e.model, &e.config, NULL);
    assert_true(rig_replays(s, memory, by_checksum, &e, again, &partial) > 0u);
    assert_true(partial > 10u);
    assert_true(smr_state_hash(s) == smr_state_hash(again));
}

/* Saved between two ticks and restored: what the image showed last is kept, for the field begins from it. */
static void test_restores(void **state)
{
    const scene e = make(SMR_TRACK_RECOVER);
    smr *run[2] = {rig_init(e.model, &e.config, NULL), NULL};
    (void)state;
    assert_int_equal(SMR_OK, smr_set_volume(run[0], &e.frame[0]));
    assert_int_equal(1, until_settled(run[0]).details.tracking);
    assert_int_equal(SMR_OK, smr_set_volume(run[0], &e.frame[1]));
    for (uint32_t k = 0; k < 4u; k++)
        assert_int_equal(SMR_OK, smr_tick(run[0], 0, NULL));
    run[1] = restored(&e, run[0], 1);
    for (uint32_t i = 0; i < 2u; i++) {
        (void)until_settled(run[i]);
        assert_int_equal(SMR_OK, smr_set_volume(run[i], &e.frame[2]));
        (void)until_settled(run[i]);
    }
    assert_true(smr_state_hash(run[0]) == smr_state_hash(run[1]));
}

/* The image is as old as its marks: they are set in the same tick. */
static smr *at_first_frame(const scene *e)
{
    smr *s = rig_init(e->model, &e->config, NULL);
    assert_int_equal(SMR_OK, smr_set_volume(s, &e->frame[0]));
    set_marks(s, e, 0);
    assert_int_equal(1, until_settled(s).details.tracking);
    return s;
}

/* Marks go on by 3.6 mm a frame and images do not: the old one does not hold the ball back, nor is it lost when marks
 * stand still. The next one counts again. */
static void test_old_image(void **state)
{
    scene e = make(SMR_TRACK_REPORT);
    smr_verdict verdict;
    (void)state;
    e.config.partial.n_landmarks = MARKS;
    smr *s = at_first_frame(&e);
    for (uint32_t i = 1; i < 4u; i++) {
        set_marks(s, &e, i);
        assert_int_equal(1, until_settled(s).details.settled);
        assert_true(off_ball(s, &e, i) < 0.8f);
    }
    assert_int_equal(SMR_OK, smr_get_verdict(s, SMR_ALL, &verdict)); /* profiles are not where the old image has them */
    assert_int_equal(0, verdict.reasons & SMR_REASON_SIMILARITY);
    set_marks(s, &e, 3);
    (void)until_settled(s);
    assert_true(off_ball(s, &e, 3) < 0.8f);
    assert_int_equal(SMR_OK, smr_set_landmarks(s, NULL, 0));
    (void)until_settled(s);
    assert_true(off_ball(s, &e, 3) < 0.8f);
    assert_int_equal(SMR_OK, smr_set_volume(s, &e.frame[4]));
    (void)until_settled(s);
    assert_true(off_ball(s, &e, 4) < 0.8f);
}

/* Goals of the caller's own leave no image behind, nor does what is taken away: the image is sought in as before. */
static void test_goals_leave_no_image(void **state)
{
    scene e = make(SMR_TRACK_REPORT);
    (void)state;
    e.config.partial.n_landmarks = MARKS;
    e.config.caller.goals = 1;
    smr *s = at_first_frame(&e);
    float *goal = rig_positions(s, e.model), *weight = rig_alloc(4u * (size_t)s->shared.n);
    assert_int_equal(SMR_OK, smr_set_goals(s, 0, goal, weight));
    assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
    assert_int_equal(SMR_IMAGE_CURRENT, s->schedule.image_age);
    assert_int_equal(SMR_OK, smr_set_landmarks(s, NULL, 0));
    assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
    assert_int_equal(SMR_IMAGE_CURRENT, s->schedule.image_age);
}

/* Where the image was left behind is kept. */
static void test_restores_old_image(void **state)
{
    scene e = make(SMR_TRACK_REPORT);
    (void)state;
    e.config.partial.n_landmarks = MARKS;
    smr *run[2] = {at_first_frame(&e), NULL};
    set_marks(run[0], &e, 1);
    for (uint32_t k = 0; k < 3u; k++)
        assert_int_equal(SMR_OK, smr_tick(run[0], 0, NULL));
    run[1] = restored(&e, run[0], 0);
    for (uint32_t i = 0; i < 2u; i++) {
        (void)until_settled(run[i]);
        assert_true(off_ball(run[i], &e, 1) < 0.8f);
        set_marks(run[i], &e, 2);
        (void)until_settled(run[i]);
        assert_true(off_ball(run[i], &e, 2) < 0.8f);
    }
    assert_true(smr_state_hash(run[0]) == smr_state_hash(run[1]));
}

/* The ball's surface in a frame, as far as it lies above. */
static const smr_surface *cap(const scene *e, uint32_t frame)
{
    smr_mesh ball = rig_ball(RIG_BALL_MM, 11, 18, e->centre[frame]);
    uint32_t *t = rig_alloc(3u * (size_t)ball.n_triangles * sizeof *t), n = 0;
    for (uint32_t k = 0; k < ball.n_triangles; k++) {
        const uint32_t *corner = ball.triangles + 3u * (size_t)k;
        float low = ball.xyz[3u * corner[0] + 2u];
        for (uint32_t c = 1; c < 3u; c++)
            low = smr_min(low, ball.xyz[3u * corner[c] + 2u]);
        if (low > e->centre[frame][2] + 5.0f)
            memcpy(t + 3u * (size_t)n++, corner, 3u * sizeof *t);
    }
    ball.triangles = t;
    ball.n_triangles = n;
    return rig_surface(&ball);
}

/* Of a partial view and an image beside it the image shows the rest. When it is left behind fewer vertices have goals:
 * that is no jump, and the rest goes along. */
static void test_rest_by_image(void **state)
{
    scene e = make(SMR_TRACK_REPORT);
    (void)state;
    e.config.track.jump_mm = 2.2f; /* a frame's way is 1.8 in the mean, along normals */
    smr *s = rig_init(e.model, &e.config, NULL);
    for (uint32_t i = 0; i < 5u; i++) {
        if (i < 2u)
            assert_int_equal(SMR_OK, smr_set_volume(s, &e.frame[i]));
        assert_int_equal(SMR_OK, smr_set_surface(s, 0, cap(&e, i)));
        const smr_tick_report r = until_settled(s);
        const float off = off_ball(s, &e, i);
        if (r.details.jumped || !(off < 1.0f))
            print_error("frame %u: jumped %u, %g mm off, goals %g\n", i, r.details.jumped, (double)off,
                        (double)r.details.matched_share);
        assert_true(r.details.tracking && !r.details.jumped && off < 1.0f);
        assert_true(i < 2u ? r.details.matched_share > 0.9f : r.details.matched_share < 0.7f);
    }
}

/* Without an image before there is nothing to go on from, and without one afterwards nothing to follow. */
static void test_starts_over(void **state)
{
    const scene e = make(SMR_TRACK_RECOVER);
    smr_tick_report r;
    (void)state;
    smr *s = rig_init(e.model, &e.config, NULL);
    assert_int_equal(SMR_OK, smr_set_volume(s, &e.frame[0]));
    assert_int_equal(1, until_settled(s).details.tracking);
    assert_int_equal(SMR_OK, smr_set_volume(s, NULL));
    assert_int_equal(SMR_OK, smr_tick(s, 0, &r));
    assert_true(r.details.radius == 0u && !r.details.tracking);
    assert_int_equal(SMR_OK, smr_set_volume(s, &e.frame[1]));
    assert_int_equal(1, until_settled(s).details.tracking);
    assert_true(off_ball(s, &e, 1) < 0.8f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_teardown(test_follows, tidy),
        cmocka_unit_test_teardown(test_starts_over, tidy),
        cmocka_unit_test_teardown(test_rest_by_image, tidy),
        cmocka_unit_test_teardown(test_same_bits, tidy),
        cmocka_unit_test_teardown(test_replays, tidy),
        cmocka_unit_test_teardown(test_restores, tidy),
        cmocka_unit_test_teardown(test_old_image, tidy),
        cmocka_unit_test_teardown(test_goals_leave_no_image, tidy),
        cmocka_unit_test_teardown(test_restores_old_image, tidy),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
