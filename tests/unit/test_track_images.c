/* test_track_images.c: after the schedule a registration follows images that are replaced, as it follows surfaces,
 * also from a log or a save. The target is a ball that moves through computed images.
 * SPDX-License-Identifier: MIT */
#include "suite.h"

#include "log/record/log_format.h"
#include "registration/registration.h"
#include "unit_moving_ball.h"

enum { MARKS = 6, LOG = SMR_LOG_BYTES(2000, 60) };

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

/* In tracking every vertex searches in every iteration: none keeps a goal when the image turns to one brightness. */
TEST(test_keeps_no_goals)
{
    const size_t bytes = (size_t)RIG_BALL_SIDE * RIG_BALL_SIDE * RIG_BALL_SIDE * sizeof(float);
    const scene e = make(SMR_TRACK_REPORT);
    smr *s = rig_init(e.model, &e.config, NULL);
    assert_int_equal(SMR_OK, smr_set_volume(s, &e.frame[0]));
    (void)until_settled(s);
    smr_volume image = e.frame[1];
    float *voxels = memcpy(rig_alloc(bytes), image.voxels, bytes);
    image.voxels = voxels;
    assert_int_equal(SMR_OK, smr_set_volume(s, &image));
    assert_true(rig_run(s, 6).n_forces > 0u);
    memset(voxels, 0, bytes);
    const smr_tick_report r = rig_run(s, 1);
    assert_true(r.details.tracking && r.n_forces == 0u);
}

TEST(test_follows)
{
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

/* Images by their checksums. */
static const void *by_checksum(void *ctx, const smr_log_record *record)
{
    const scene *e = ctx;
    for (uint32_t i = 0; i < 4u; i++)
        if (smr_volume_checksum(&e->frame[i]) == record->checksum)
            return &e->frame[i];
    return NULL;
}

TEST(test_replays)
{
    static unsigned char memory[LOG];
    scene e = make(SMR_TRACK_RECOVER);
    rig_clock clock = {0};
    uint32_t partial = 0;
    e.config.partial.n_landmarks = MARKS;
    const smr_port port = rig_clock_port(&clock, RIG_CLOCK_STEADY, 50000);
    smr *s = rig_init(e.model, &e.config, &port);
    assert_int_equal(SMR_OK, smr_set_log(s, memory, sizeof memory));
    sequence(&e, s, 3000000);
    assert_int_equal(1, s->schedule.tracking);
    assert_int_equal(SMR_IMAGE_PAST, s->schedule.image_age);
    smr *again = rig_init(e.model, &e.config, NULL);
    assert_true(rig_replays(s, memory, by_checksum, &e, again, &partial) > 0u);
    assert_true(partial > 10u);
    assert_true(smr_state_hash(s) == smr_state_hash(again));
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
TEST(test_old_image)
{
    scene e = make(SMR_TRACK_REPORT);
    smr_verdict verdict;
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

/* Where the image was left behind is kept. */
TEST(test_restores_old_image)
{
    scene e = make(SMR_TRACK_REPORT);
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

/* Without an image before there is nothing to go on from, and without one afterwards nothing to follow. */
TEST(test_starts_over)
{
    const scene e = make(SMR_TRACK_RECOVER);
    smr_tick_report r;
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

/* Each image that is set counts as a target: the verdict waits until positions follow it, and ticks tell its number. */
TEST(test_each_image_counts)
{
    const scene e = make(SMR_TRACK_REPORT);
    smr_verdict verdict;
    smr *s = rig_init(e.model, &e.config, NULL);
    for (uint32_t i = 0; i < 2u; i++) {
        assert_int_equal(SMR_OK, smr_set_volume(s, &e.frame[i]));
        assert_int_equal(SMR_OK, smr_get_verdict(s, 0, &verdict));
        assert_true((verdict.reasons & SMR_REASON_RECOVERING) != 0u && verdict.level != SMR_VERDICT_GOOD);
        assert_int_equal(i + 1u, until_settled(s).details.target_serial);
        assert_int_equal(SMR_OK, smr_get_verdict(s, 0, &verdict));
        assert_int_equal(0, verdict.reasons & SMR_REASON_RECOVERING);
    }
}
