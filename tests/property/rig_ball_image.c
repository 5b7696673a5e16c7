/* rig_ball_image.c: a ball and its computed image.
 * SPDX-License-Identifier: MIT */
#include "property/rig_ball_image.h"

#include <math.h>

const float rig_nowhere[3] = {0, 0, 0}, rig_shift[3] = {2, -1, 2};

/* The image of a ball: bright inside, dark outside, with an edge some millimetres wide. */
smr_volume rig_ball_image(float radius, const float centre[3])
{
    float *voxels;
    const smr_volume v = rig_cube(RIG_BALL_SIDE, RIG_BALL_SPACING, &voxels);
    for (uint32_t i = 0; i < RIG_BALL_SIDE * RIG_BALL_SIDE * RIG_BALL_SIDE; i++) {
        const uint32_t at[3] = {i % RIG_BALL_SIDE, i / RIG_BALL_SIDE % RIG_BALL_SIDE,
                                i / RIG_BALL_SIDE / RIG_BALL_SIDE};
        double d2 = 0.0;
        for (uint32_t a = 0; a < 3u; a++) {
            const double d = (double)(v.origin[a] + RIG_BALL_SPACING * (float)at[a] - centre[a]);
            d2 += d * d;
        }
        voxels[i] = (float)(500.0 + 400.0 * tanh(((double)radius - sqrt(d2)) / 2.0));
    }
    return v;
}

/* A model of the ball that was prepared with its own image, or without any. */
const smr_model *rig_ball_model(const smr_volume *reference)
{
    const smr_mesh mesh = rig_ball(RIG_BALL_MM, 13, 20, rig_nowhere);
    smr_prepare_config c = rig_radii(2, 20, 10, 0);
    c.reference = reference;
    return rig_model(&mesh, 1, &c);
}
