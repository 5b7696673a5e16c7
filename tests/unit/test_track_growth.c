/* test_track_growth.c: a cloud that grows beside an image that is followed: the image is of now as long as no point
 * has moved, also after a save, and what is lost is looked for.
 * SPDX-License-Identifier: MIT */
#include "suite.h"

#include <string.h>

#include "unit_moving_ball.h"

enum { CLOUD = 200 };

/* Adds points of the upper half of the ball in a frame, first to end of CLOUD, and sets the cloud. */
static void show(smr *s, const scene *e, smr_points *cloud, uint32_t frame, uint32_t first, uint32_t end)
{
    float xyz[CLOUD][3];
    for (uint32_t i = first; i < end; i++) {
        uint32_t seed = i + 1u;
        const float x = rig_between(&seed, -1, 1), y = rig_between(&seed, -1, 1);
        const smr_vec n = smr_unit(smr_v(x, y, rig_between(&seed, 0, 1)));
        smr_store(xyz[i - first], smr_add(smr_load(e->centre[frame]), smr_scale(n, RIG_BALL_MM)));
    }
    assert_int_equal(SMR_OK, smr_points_add(cloud, xyz[0], NULL, NULL, end - first));
    assert_int_equal(SMR_OK, smr_set_points(s, SMR_ALL, cloud));
}

static smr_points *empty_cloud(void *memory)
{
    smr_points *cloud = NULL;
    return smr_points_open(CLOUD, memory, SMR_POINTS_BYTES(CLOUD), &cloud) == SMR_OK ? cloud : NULL;
}

/* While a cloud grows beside an image the image is of now, also when the cloud is set again as it was or weighed
 * otherwise; its search goes on and does not start over. Other points in the same memory are newer. */
TEST(test_cloud_that_grows)
{
    scene e = make(SMR_TRACK_REPORT);
    smr_tick_report report;
    uint32_t n = 0;
    e.config.basic.n_target_vertices = CLOUD;
    void *memory = rig_alloc(SMR_POINTS_BYTES(CLOUD));
    smr_points *cloud = empty_cloud(memory);
    smr *s = rig_init(e.model, &e.config, NULL);
    assert_int_equal(SMR_OK, smr_set_volume(s, &e.frame[0]));
    show(s, &e, cloud, 0, 0, CLOUD);
    assert_int_equal(1, until_settled(s).details.tracking);
    cloud = empty_cloud(memory);
    assert_int_equal(SMR_OK, smr_set_volume(s, &e.frame[1]));
    for (; n < CLOUD; n += 5u) {
        show(s, &e, cloud, 1, n, n + 5u);
        assert_int_equal(SMR_OK, smr_tick(s, 0, &report));
        assert_int_equal(SMR_IMAGE_CURRENT, s->schedule.image_age);
        assert_int_equal(smr_min_u32(n / 5u, e.config.track.iterations / 2u) + 1u, s->schedule.radius_iteration);
    }
    assert_int_equal(SMR_OK, smr_points_weigh(cloud, 0, 0.5f));
    assert_int_equal(SMR_OK, smr_set_points(s, SMR_ALL, cloud));
    (void)until_settled(s);
    assert_true(s->schedule.image_age == SMR_IMAGE_CURRENT && off_ball(s, &e, 1) < 0.8f);
    show(s, &e, empty_cloud(memory), 2, 0, CLOUD);
    (void)until_settled(s);
    assert_true(s->schedule.image_age == SMR_IMAGE_PAST && off_ball(s, &e, 2) < 0.8f);
}

/* An image that shows nothing has lost the ball; the first points of a cloud beside it are far off: a jump, too. */
TEST(test_lost_while_growing)
{
    scene e = make(SMR_TRACK_REPORT);
    smr_tick_report r = {0};
    e.config.basic.n_target_vertices = CLOUD;
    e.config.track.jump_mm = 1.0f;
    smr_points *cloud = empty_cloud(rig_alloc(SMR_POINTS_BYTES(CLOUD)));
    smr *s = rig_init(e.model, &e.config, NULL);
    smr_volume nothing = e.frame[0];
    const size_t bytes = 4u * (size_t)nothing.size[0] * nothing.size[1] * nothing.size[2];
    nothing.voxels = memset(rig_alloc(bytes), 0, bytes);
    assert_int_equal(SMR_OK, smr_set_volume(s, &e.frame[0]));
    assert_int_equal(SMR_OK, smr_set_points(s, SMR_ALL, cloud));
    assert_int_equal(1, until_settled(s).details.tracking);
    assert_int_equal(SMR_OK, smr_set_volume(s, &nothing));
    assert_true(smr_tick(s, 0, &r) == SMR_OK && r.details.jumped);
    show(s, &e, cloud, FRAMES - 1u, 0, 5);
    assert_true(smr_tick(s, 0, &r) == SMR_OK && r.details.jumped && s->schedule.radius_iteration == 1u);
}

/* What a cloud was when it was saved is known after it is restored. */
TEST(test_restores_growth)
{
    scene e = make(SMR_TRACK_REPORT);
    e.config.basic.n_target_vertices = CLOUD;
    smr_points *cloud = empty_cloud(rig_alloc(SMR_POINTS_BYTES(CLOUD)));
    smr *run[2] = {rig_init(e.model, &e.config, NULL), NULL};
    assert_int_equal(SMR_OK, smr_set_volume(run[0], &e.frame[0]));
    show(run[0], &e, cloud, 0, 0, 20);
    assert_int_equal(1, until_settled(run[0]).details.tracking);
    run[1] = restored(&e, run[0], 0);
    assert_int_equal(SMR_OK, smr_set_points(run[1], 0, cloud));
    show(run[1], &e, cloud, 0, 20, 40);
    assert_int_equal(SMR_OK, smr_set_points(run[0], SMR_ALL, cloud));
    for (uint32_t i = 0; i < 2u; i++)
        (void)until_settled(run[i]);
    assert_true(run[0]->schedule.image_age == SMR_IMAGE_CURRENT && smr_state_hash(run[0]) == smr_state_hash(run[1]));
}
