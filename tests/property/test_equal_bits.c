/* test_equal_bits.c: what holds for any registration to the last bit: nothing moves without a target, and neither
 * threads nor schedulers matter.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
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
