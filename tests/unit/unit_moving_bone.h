/* unit_moving_bone.h: a bone, targets of it that move, and a registration that follows them.
 * SPDX-License-Identifier: MIT */
#ifndef UNIT_MOVING_BONE_H
#define UNIT_MOVING_BONE_H

#include "cmocka_first.h"
#include "property/rig_cloud.h"
#include "registration/registration.h"

typedef struct scene {
    smr_mesh source, target;
    const smr_model *model;
    smr_config config;
    smr_surface *at[3]; /* the target; the target moved; beyond a jump */
} scene;

/* The mesh turned about an axis through the origin, and shifted. */
static smr_mesh turned(const smr_mesh *mesh, float degrees, float shift)
{
    const float t[3] = {shift, 0.5f * shift, -0.5f * shift};
    float m[9];
    rig_rotation(1, 2, 0.5f, degrees, m);
    return rig_moved(mesh, m, t);
}

static scene make(uint32_t track)
{
    const smr_prepare_config radii = rig_radii(3, 110, 60, 35);
    scene e;
    rig_bone(12000, 1.0f, &e.source, &e.target);
    const smr_mesh near = turned(&e.target, 2, 1), away = turned(&e.target, 12, 20);
    e.at[0] = rig_surface(&e.target);
    e.at[1] = rig_surface(&near);
    e.at[2] = rig_surface(&away);
    e.model = rig_model(&e.source, 1, &radii);
    e.config = smr_config_default();
    e.config.basic.n_workers = 4;
    e.config.basic.n_target_vertices = e.target.n_vertices;
    e.config.track.mode = track;
    return e;
}

static smr_tick_report until_settled(smr *s, uint32_t most)
{
    smr_tick_report r = {0};
    do
        assert_int_equal(SMR_OK, smr_tick(s, 0, &r));
    while (!r.details.settled && !r.done && --most > 0u);
    return r;
}

#endif
