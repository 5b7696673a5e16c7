/* test_targets.c: room for target surfaces: no more vertices than the configuration says, and a surface that several
 * structures share counts once.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include <string.h>
#include "property/rig_cloud.h"
#include "registration/registration.h"
#include "unit/unit_save.h"

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

/* A cloud pulls the model without attraction, a mesh beside it does not, and a box leaves out vertices of both. */
TEST(test_cloud_beside_a_mesh)
{
    const smr_prepare_config radii = rig_radii(1, 15, 0, 0);
    smr_config config = smr_config_default();
    smr *s = start(0);
    smr_points *const cloud = rig_cloud(ball[2].n_vertices);
    config.basic.attraction = 0.0f;
    config.basic.n_target_vertices = 1000;
    config.forces.use_box = 1;
    for (uint32_t i = 0; i < 3u; i++) {
        config.forces.box_min[i] = -SMR_COORD_MAX;
        config.forces.box_max[i] = i == 1u ? 5.0f : SMR_COORD_MAX;
    }
    s = rig_init(rig_model(ball, 3, &radii), &config, NULL);
    assert_int_equal(SMR_OK, smr_points_add(cloud, ball[2].xyz, NULL, NULL, ball[2].n_vertices));
    assert_int_equal(SMR_OK, smr_set_points(s, 2, cloud));
    assert_int_equal(SMR_OK, smr_set_surface(s, 1, surface[1]));
    for (uint32_t i = 0; i < 3u; i++)
        assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
    for (uint32_t v = 0; v < s->shared.n; v++) {
        const uint32_t owner = smr_model_owner(s->shared.model, v);
        const float y = s->shape.x[3u * v + 1u] + s->shape.origin.y;
        if (smr_abs(y - 5.0f) > 0.5f)
            assert_int_equal(owner > 0u && y < 5.0f, s->forces.found_last[v] == SMR_FOUND_GOAL);
    }
}

/* A save that says that targets which come later were predicted already: nothing moves ahead for them. Nor is anything
 * read that only attraction writes, where the save says that the target has bodies that do not count. */
TEST(test_forged_flags)
{
    smr_config config = smr_config_default();
    smr *s = start(0), *again;
    const smr_mesh later = rig_moved(&ball[0], (const float[9]){1, 0, 0, 0, 1, 0, 0, 0, 1}, (const float[3]){1, 2, 0});
    size_t bytes, needed;
    const uint32_t one = 1;
    smr_verdict verdict;
    config.basic.iterations = config.basic.iterations_last = 2;
    config.track.mode = SMR_TRACK_RECOVER;
    config.track.ahead = 0.5f;
    config.contact.share = 1.0f;
    s = rig_init(s->shared.model, &config, NULL);
    for (uint32_t i = 0; i < 3u; i++)
        assert_int_equal(SMR_OK, smr_set_surface(s, i, surface[i]));
    while (!s->schedule.tracking)
        assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
    assert_int_equal(SMR_OK, smr_save_bytes(s, &bytes) + smr_arena_bytes(s->shared.model, &config, &needed));
    unsigned char *const saved = rig_alloc(bytes), *const arena = rig_alloc(needed);
    assert_int_equal(SMR_OK, smr_save(s, saved, bytes));
    const smr_pose poses[2] = {s->shape.track_pose[0], s->shape.track_pose_last[0]};
    memcpy(unit_save_find(saved, poses, sizeof poses) - sizeof one, &one, sizeof one);
    const smr_target *t = s->forces.surface.target;
    const uint32_t words[] = {t->partial, t->n_visible, t->n_judged, t->measured, 0};
    memcpy(unit_save_find(saved, words, sizeof words) + 4u * sizeof one, &one, sizeof one);
    unit_save_seal(saved, bytes);
    assert_int_equal(SMR_OK, smr_restore(s->shared.model, NULL, NULL, saved, bytes, arena, needed, &again));
    assert_true(again->shape.track_rest->predicted && again->forces.surface.target[0].others);
    for (uint32_t i = 0; i < 3u; i++)
        assert_int_equal(SMR_OK, smr_set_surface(again, i, surface[i]));
    assert_int_equal(SMR_OK, smr_get_verdict(again, 0, &verdict));
    assert_int_equal(SMR_OK, smr_set_surface(again, 0, rig_surface(&later)));
    assert_int_equal(SMR_OK, smr_tick(again, 0, NULL));
    assert_memory_equal(&again->shape.track_pose_last[0], &poses[1], sizeof poses[1]);
}
