/* test_equal_bits.c: what holds for any registration to the last bit: nothing moves without a target, and neither
 * threads, schedulers nor what searches remember matter.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include "registration/registration.h"
#include "smr_pthread.h"

/* About 900 vertices. */
#define CELL 10000u

TEST(test_rest_stays)
{
    const float centre[3] = {301.3f, -12.7f, 44.4f};
    for (uint32_t k = 0; k < 8u; k++) {
        const smr_mesh mesh = rig_ball(30.0f, 9, 12, centre);
        const smr_prepare_config radii = rig_radii(2, 25.0f, 12.0f, 0);
        const smr_model *model = rig_model(&mesh, 1, &radii);
        smr_config config = smr_config_default();
        smr_tick_report report;
        config.basic.method = k % 2u;
        config.basic.iterations = config.basic.iterations_last = 100000;
        config.motion.settle_um = 0.0f; /* nothing moves, so nothing else would keep the schedule from ending */
        config.motion.plastic_um = k & 2u ? 0.0f : 50.0f;
        config.motion.plastic_every = k & 2u ? 0u : 1u;
        config.motion.fusing = k >> 2;
        smr *s = rig_init(model, &config, NULL);
        float *before = rig_positions(s, model);
        for (uint32_t tick = 0; tick < rig_times(3000); tick++)
            assert_int_equal(SMR_OK, smr_tick(s, 0, &report));
        assert_int_equal(rig_times(3000), report.iteration);
        assert_int_equal(0, report.done);
        assert_memory_equal(before, rig_positions(s, model), mesh.n_vertices * 3u * sizeof(float));
        assert_true(report.displacement_max_mm == 0.0f);
        assert_true(rig_far(before, mesh.xyz, mesh.n_vertices) <= 3.1e-5f); /* one rounding at 300 mm */
    }
}

static uint64_t hash_with(const smr_model *model, const smr_surface *target, uint32_t method, const smr_port *port)
{
    smr_config config = smr_config_default();
    config.basic.method = method & 1u;
    config.motion.fusing = method >> 1;
    config.basic.n_workers = 8;
    config.basic.n_target_vertices = 4000;
    smr *s = rig_init(model, &config, port);
    assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, target));
    (void)rig_run(s, 12);
    return smr_state_hash(s);
}

TEST(test_workers_and_schedulers)
{
    static const uint32_t workers[] = {1, 2, 3, 4, 8};
    smr_mesh source, target;
    rig_bone(CELL, 1.0f, &source, &target);
    const smr_prepare_config radii = rig_radii(2, 60.0f, 15.0f, 0);
    const smr_model *model = rig_model(&source, 1, &radii);
    const smr_surface *surface = rig_surface(&target);
    for (uint32_t method = 0; method < 4u; method++) { /* those of 2 and 3 are fused by logarithms */
        const uint64_t expected = hash_with(model, surface, method, NULL);
        for (uint32_t w = method; w < sizeof workers / sizeof workers[0]; w++) {
            smr_pthread *pool = NULL;
            const size_t bytes = smr_pthread_bytes(workers[w]);
            assert_int_equal(SMR_OK, smr_pthread_create(&pool, rig_alloc(bytes), bytes, workers[w]));
            const smr_port threads = smr_pthread_port(pool);
            const uint64_t hash = hash_with(model, surface, method, &threads);
            smr_pthread_destroy(pool);
            assert_true(hash == expected);
            for (uint32_t scheduler = 0; scheduler < RIG_SCHEDULERS; scheduler++) {
                const smr_port port = rig_port(scheduler, workers[w]);
                assert_true(hash_with(model, surface, method, &port) == expected);
            }
        }
    }
}

/* What searches remember of other triangles saves work and nothing else: a bone that comes to rest beside a ball that
 * moves on, with and without it. */
TEST(test_certainties)
{
    static const float there[3] = {150.0f, 20.0f, 0.0f}, moved[3] = {158.0f, 26.0f, 3.0f};
    smr_mesh mesh[2], target;
    rig_bone(CELL, 1.0f, &mesh[0], &target);
    mesh[1] = rig_ball(20.0f, 9, 12, there);
    const smr_mesh ball = rig_ball(21.0f, 8, 13, moved);
    const smr_prepare_config radii = rig_radii(2, 60.0f, 15.0f, 0);
    const smr_model *model = rig_model(mesh, 2, &radii);
    const smr_surface *surface[2] = {rig_surface(&target), rig_surface(&ball)};
    smr_config config = smr_config_default();
    smr *s[2];
    uint32_t n_known = 0, n_known_of_targets = 0;
    config.basic.n_workers = 2;
    config.basic.n_target_vertices = target.n_vertices + ball.n_vertices;
    for (uint32_t k = 0; k < 2u; k++) {
        const smr_port port = rig_port(RIG_SHUFFLE, 2);
        s[k] = rig_init(model, &config, &port);
        for (uint32_t i = 0; i < 2u; i++)
            assert_int_equal(SMR_OK, smr_set_surface(s[k], i, surface[i]));
    }
    for (uint32_t tick = 0; tick < 150u; tick++) {
        smr_certainties_clear(&s[1]->forces.surface);
        smr_guard_close(s[1]);
        (void)rig_run(s[0], 1);
        (void)rig_run(s[1], 1);
        if (smr_state_hash(s[0]) != smr_state_hash(s[1]))
            fail_msg("other bits in iteration %u", tick);
        for (uint32_t v = 0; v < s[0]->shared.n; v++)
            n_known += s[0]->forces.surface.other[v] > 0u;
        for (uint32_t k = 0; k < config.basic.n_target_vertices; k++)
            n_known_of_targets += s[0]->forces.surface.target_other[k] > 0.0f;
    }
    assert_true(n_known > 1000u && n_known_of_targets > 1000u); /* there was something to remember */
}
