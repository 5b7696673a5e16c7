/* test_targets.c: room for target surfaces: no more vertices than the configuration says, and a surface that several
 * structures share counts once.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include <string.h>
#include "registration/registration.h"

static smr_mesh ball[3];
static const smr_surface *surface[3];

static smr *start(uint32_t n_target_vertices)
{
    const smr_prepare_config radii = rig_radii(1, 15, 0, 0);
    smr_config config = smr_config_default();
    config.basic.n_target_vertices = n_target_vertices;
    config.motion.settle_um = 0.0f; /* nothing to do is no reason to end */
    for (uint32_t i = 0; i < 3u; i++) {
        const float at[3] = {50.0f * (float)i, 0, 0};
        ball[i] = rig_ball(20, 6, 9 + 10 * i, at);
        surface[i] = rig_surface(&ball[i]);
    }
    return rig_init(rig_model(ball, 3, &radii), &config, NULL);
}

TEST(test_room)
{
    smr *s = start(0);
    const uint32_t room = ball[0].n_vertices + ball[2].n_vertices;
    for (uint32_t i = 0; i < 3u; i++) /* without attraction any size will do */
        assert_int_equal(SMR_OK, smr_set_surface(s, i, surface[i]));
    s = start(room);
    assert_int_equal(SMR_OK, smr_set_surface(s, 0, surface[0]));
    assert_int_equal(SMR_OK, smr_set_surface(s, 2, surface[2]));
    assert_int_equal(SMR_OK, smr_set_surface(s, 1, surface[2])); /* known already */
    const uint64_t before = smr_state_hash(s);
    assert_int_equal(SMR_E_ARENA, smr_set_surface(s, 1, surface[1]));
    assert_ptr_equal(surface[2], s->forces.surface.target[1].surface);
    assert_int_equal(2, s->forces.surface.n_goals);
    assert_true(before == smr_state_hash(s));
    assert_int_equal(SMR_OK, smr_set_surface(s, 0, NULL));
    assert_int_equal(SMR_OK, smr_set_surface(s, 1, surface[0]));
}
