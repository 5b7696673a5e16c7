/* unit_moving_ball.h: a ball that moves through computed images, and a registration that follows it.
 * SPDX-License-Identifier: MIT */
#ifndef UNIT_MOVING_BALL_H
#define UNIT_MOVING_BALL_H

#include "cmocka_first.h"
#include "property/rig_ball_image.h"
#include "registration/registration.h"

enum { FRAMES = 6 };

typedef struct scene {
    const smr_model *model;
    smr_config config;
    smr_volume frame[FRAMES + 1];
    float centre[FRAMES + 1][3];
} scene;

/* The ball goes 3.6 mm in each frame, and 14 mm in the last one. */
static scene make(uint32_t track)
{
    scene e;
    const smr_volume reference = rig_ball_image(RIG_BALL_MM, rig_nowhere);
    e.model = rig_ball_model(&reference);
    e.config = smr_config_default_image();
    e.config.basic.n_workers = 4;
    e.config.track.mode = track;
    for (uint32_t i = 0; i <= FRAMES; i++) {
        const float way = i < FRAMES ? 2.0f * (float)i : 2.0f * (float)(FRAMES - 1u) - 8.0f;
        e.centre[i][0] = 1.0f * way;
        e.centre[i][1] = -1.2f * way;
        e.centre[i][2] = 0.9f * way - 4.0f;
        e.frame[i] = rig_ball_image(RIG_BALL_MM, e.centre[i]);
    }
    return e;
}

static smr_tick_report until_settled(smr *s)
{
    smr_tick_report r = {0};
    uint32_t most = 1000;
    do
        assert_int_equal(SMR_OK, smr_tick(s, 0, &r));
    while (!r.details.settled && !r.done && --most > 0u);
    return r;
}

/* Farthest that a vertex is from the ball's surface, mm. */
static float off_ball(const smr *s, const scene *e, uint32_t frame)
{
    const float *xyz = rig_positions(s, e->model);
    const smr_vec centre = smr_load(e->centre[frame]);
    float far = 0.0f;
    for (uint32_t v = 0; v < s->shared.n; v++) {
        const float d = smr_length(smr_sub(smr_load(xyz + 3u * (size_t)v), centre)) - RIG_BALL_MM;
        far = smr_max(far, d < 0.0f ? -d : d);
    }
    return far;
}

/* A copy by way of a save, with its image set again. */
static smr *restored(const scene *e, const smr *s, uint32_t frame)
{
    smr *copy = rig_restored(s, e->model, &e->config);
    assert_int_equal(SMR_OK, smr_set_volume(copy, &e->frame[frame]));
    return copy;
}

#endif
