/* unit_save.c: a small registration of two structures and its save.
 * SPDX-License-Identifier: MIT */
#include "unit/unit_save.h"
#include <string.h>
#include "base/bytes.h"
#include "property/rig.h"
#include "log/record/log_format.h"

#define SIDE_MM 90.0f

/* A bright ball around (38, 0, 0) + shift. side: number of voxels along each axis. */
static smr_volume image_of(float shift, uint32_t side)
{
    float *voxels = NULL;
    const float step = SIDE_MM / (float)side;
    smr_volume v = rig_cube(side, step, &voxels);
    v.origin[0] += 38.0f;
    for (uint32_t i = 0; i < side * side * side; i++) {
        const float x = v.origin[0] + step * (float)(i % side) - 38.0f - shift,
                    y = v.origin[1] + step * (float)(i / side % side),
                    z = v.origin[2] + step * (float)(i / side / side);
        voxels[i] = x * x + y * y + z * z < 400.0f ? 200.0f : 20.0f;
    }
    return v;
}

void unit_save_make(unit_save *u, uint32_t what)
{
    const float at[2][3] = {{0, 0, 0}, {38, 0, 0}}, off[3] = {2, -2, 1};
    const int small = what != UNIT_SAVE_ALL;
    const uint32_t side = small ? 12u : 30u;
    smr_prepare_config prepare = rig_radii(2, 40.0f, 15.0f, 0.0f);
    memset(u, 0, sizeof *u);
    u->what = what;
    for (uint32_t i = 0; i < 2u; i++)
        u->ball[i] = rig_ball(20.0f, small ? 4u : 7u, small ? 6u : 10u, at[i]);
    const smr_mesh goal = rig_ball(22.0f, 8, 11, off), other = rig_ball(21.0f, 8, 11, off);
    u->surface = rig_surface(&goal);
    u->copy = rig_surface(&goal);
    u->other = rig_surface(&other);
    u->volume = image_of(2.0f, side);
    u->other_volume = image_of(1.0f, side);
    const smr_volume reference = image_of(0.0f, side);
    if (what != UNIT_SAVE_SURFACES)
        prepare.reference = &reference;
    u->model = rig_model(u->ball, 2, &prepare);
    u->config = what == UNIT_SAVE_SURFACES ? smr_config_default() : smr_config_default_image();
    u->config.basic.n_target_vertices = 400;
    u->config.basic.iterations = 6;
    u->config.basic.iterations_last = 9;
    u->config.basic.method = SMR_METHOD_POLAR;
    u->config.partial.n_landmarks = 2;
    smr *s = unit_save_begin(u, 7);
    (void)smr_save_bytes(s, &u->bytes);
    (void)smr_save(s, u->saved, sizeof u->saved);
}

smr *unit_save_begin(const unit_save *u, uint32_t ticks)
{
    const smr_landmark landmark[2] = {{0, 5, {0, 0, 0}, {1, 2, 19}, 2.0f, 0},
                                      {1, SMR_NONE, {38, 0, 24}, {39, 0, 25}, 0.0f, 1}};
    smr *s = rig_init(u->model, &u->config, NULL);
    (void)smr_set_landmarks(s, landmark, 2);
    (void)smr_set_surface(s, 0, u->surface);
    (void)(u->what == UNIT_SAVE_SURFACES ? smr_set_surface(s, 1, u->surface) : smr_set_volume(s, &u->volume));
    for (uint32_t i = 0; i < ticks; i++)
        (void)smr_tick(s, 0, NULL);
    return s;
}

smr *unit_save_restored(const unit_save *u, const unsigned char *saved, size_t bytes, int all, smr_status *status)
{
    static _Alignas(SMR_ALIGN) unsigned char arena[8][1u << 18]; /* the last eight of them stay */
    static uint32_t next;
    smr *s = NULL;
    *status = smr_restore(u->model, NULL, NULL, saved, bytes, arena[next % 8u], sizeof arena[0], &s);
    if (*status != SMR_OK)
        return NULL;
    next++;
    if (all)
        *status = smr_set_surface(s, 0, u->surface);
    if (all && *status == SMR_OK)
        *status = smr_set_volume(s, &u->volume);
    return s;
}

size_t unit_save_values(const unsigned char *saved, size_t *end)
{
    *end = smr_log_get32(saved + 8) - 4u;
    return 32u + 4u * (size_t)smr_log_get32(saved + 28);
}

unsigned char *unit_save_find(unsigned char *saved, const void *what, size_t n)
{
    while (memcmp(saved, what, n) != 0)
        saved++;
    return saved;
}

void unit_save_seal(unsigned char *saved, size_t bytes)
{
    smr_log_put32(saved + bytes - 4u, smr_crc32(0, saved, bytes - 4u));
}
