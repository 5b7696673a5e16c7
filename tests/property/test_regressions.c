/* test_regressions.c: faults once found by review: a target rebuilt in place, normals of half an iteration, goals
 * counted wrong, poses beyond the limits, edges shared by many triangles, and large models with small clusters.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <string.h>

static const float none[3] = {0, 0, 0};

/* A registration of one ball onto another, slightly larger one. */
static smr *start(const smr_surface **target, const smr_port *port)
{
    const smr_mesh ball = rig_ball(20, 8, 12, none), larger = rig_ball(22, 8, 12, none);
    const smr_prepare_config radii = rig_radii(1, 12, 0, 0);
    smr_config config = smr_config_default();
    config.basic.n_target_vertices = larger.n_vertices;
    smr *s = rig_init(rig_model(&ball, 1, &radii), &config, port);
    *target = rig_surface(&larger);
    assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, *target));
    return s;
}

TEST(test_target_rebuilt_in_place)
{
    const smr_mesh small = rig_ball(22, 4, 6, none), large = rig_ball(22, 20, 30, none);
    size_t bytes = 0;
    assert_int_equal(SMR_OK, smr_surface_bytes(large.n_vertices, large.n_triangles, &bytes));
    void *memory = rig_alloc(bytes);
    const smr_prepare_config radii = rig_radii(1, 12, 0, 0);
    smr_config config = smr_config_default();
    smr_surface *target;
    config.basic.n_target_vertices = small.n_vertices;
    smr *s = rig_init(rig_model(&small, 1, &radii), &config, NULL);
    assert_int_equal(SMR_OK, smr_surface_build(&small, memory, bytes, &target));
    assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, target));
    assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
    const uint64_t before = smr_state_hash(s);
    assert_int_equal(SMR_OK, smr_surface_build(&large, memory, bytes, &target));
    assert_int_equal(SMR_E_STATE, smr_tick(s, 0, NULL));
    assert_true(before == smr_state_hash(s));
    assert_int_equal(SMR_E_ARENA, smr_set_surface(s, SMR_ALL, target));
}

/* Between partial ticks positions and normals stay those of the last complete iteration. */
TEST(test_normals_of_complete_iterations)
{
    rig_clock clock;
    const smr_port port = rig_clock_port(&clock, RIG_CLOCK_STEADY, 1000);
    const smr_surface *target;
    smr *s = start(&target, &port);
    smr_tick_report report;
    float now[3 * 256], last[3 * 256];
    uint32_t partial = 0;
    assert_int_equal(SMR_OK, smr_tick(s, 0, &report));
    assert_int_equal(SMR_OK, smr_get_normals(s, 0, last));
    for (uint32_t i = 0; i < 400u; i++) {
        const uint32_t iteration = report.iteration;
        const smr_status status = smr_tick(s, 1, &report);
        assert_int_equal(SMR_OK, smr_get_normals(s, 0, now));
        if (report.iteration == iteration && !report.done) {
            assert_int_equal(SMR_PARTIAL, status);
            assert_memory_equal(now, last, sizeof(float) * 3u * 86u);
            partial++;
        }
        memcpy(last, now, sizeof last);
    }
    assert_true(partial > 50u);
}

/* The same where the vertices are so many that ticks end amid the exchange of normals. */
TEST(test_normals_of_many_vertices)
{
    rig_clock clock;
    const smr_port port = rig_clock_port(&clock, RIG_CLOCK_STEADY, 1000);
    const smr_mesh ball = rig_ball(20, 50, 50, none), larger = rig_ball(22, 20, 30, none);
    const smr_prepare_config radii = rig_radii(1, 4, 0, 0);
    const smr_config config = smr_config_default();
    const size_t bytes = 3u * (size_t)ball.n_vertices * sizeof(float);
    float *const now = rig_alloc(bytes), *const before = rig_alloc(bytes);
    smr *s = rig_init(rig_model(&ball, 1, &radii), &config, &port);
    assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, rig_surface(&larger)));
    assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
    assert_int_equal(SMR_OK, smr_get_normals(s, 0, before));
    while (smr_tick(s, 1, NULL) == SMR_PARTIAL) {
        assert_int_equal(SMR_OK, smr_get_normals(s, 0, now));
        assert_memory_equal(now, before, bytes);
    }
    assert_int_equal(SMR_OK, smr_get_normals(s, 0, now));
    assert_memory_not_equal(now, before, bytes);
}

/* A vertex that already lies on its goal has one. */
TEST(test_goals_are_counted)
{
    const smr_mesh ball = rig_ball(20, 8, 12, none);
    const smr_prepare_config radii = rig_radii(1, 12, 0, 0);
    smr_config config = smr_config_default();
    smr_tick_report report;
    smr_structure_report part;
    smr *s = rig_init(rig_model(&ball, 1, &radii), &config, NULL);
    assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, rig_surface(&ball)));
    assert_int_equal(SMR_OK, smr_tick(s, 0, &report));
    assert_int_equal(SMR_OK, smr_get_structure_report(s, 0, &part));
    assert_int_equal(ball.n_vertices, report.n_forces);
    assert_int_equal(report.n_forces, part.n_forces);
    assert_int_equal(report.details.n_rejected, part.n_rejected);
}

TEST(test_pose_beyond_the_border)
{
    const float far[3] = {99000, 0, 0};
    const smr_mesh ball = rig_ball(20, 8, 12, far);
    const smr_prepare_config radii = rig_radii(1, 12, 0, 0);
    const smr_config config = smr_config_default();
    const smr_pose huge = {{{1.0e5f, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    smr *s = rig_init(rig_model(&ball, 1, &radii), &config, NULL);
    const uint64_t before = smr_state_hash(s);
    assert_int_equal(SMR_E_INPUT, smr_set_pose(s, &huge));
    assert_true(before == smr_state_hash(s));
}

/* 60,000 triangles on one edge, and as many copies of one triangle. Quadratic work would take minutes here and exceed
 * the time limit of the checks. */
TEST(test_crowded_triangles)
{
    enum { N = 60000 };
    float *xyz = rig_alloc(3u * (N + 2u) * sizeof *xyz);
    uint32_t *book = rig_alloc(3u * N * sizeof *book), *pile = rig_alloc(3u * N * sizeof *pile);
    smr_closest hit;
    const float point[3] = {1, 2, 3};
    for (uint32_t i = 0; i < N + 2u; i++) {
        xyz[3u * i] = i < 2u ? (float)i : 0.5f;
        xyz[3u * i + 1u] = i < 2u ? 0.0f : 1.0f + (float)i * 1.0e-3f;
        xyz[3u * i + 2u] = 0.0f;
    }
    for (uint32_t k = 0; k < N; k++) {
        const uint32_t one[3] = {0, 1, k + 2u}, same[3] = {0, 1, 2};
        memcpy(book + 3u * k, one, sizeof one);
        memcpy(pile + 3u * k, same, sizeof same);
    }
    const smr_mesh meshes[2] = {{xyz, book, N + 2u, N}, {xyz, pile, N + 2u, N}};
    for (uint32_t m = 0; m < 2u; m++) {
        const smr_surface *surface = rig_surface(&meshes[m]);
        for (uint32_t i = 0; i < 200u; i++) {
            assert_int_equal(SMR_OK, smr_surface_closest(surface, point, NULL, -1, 1.0e4f, &hit));
            assert_true(hit.triangle < N);
        }
    }
}

/* 200,000 vertices whose clusters are themselves: likewise. */
TEST(test_large_model_of_small_clusters)
{
    enum { SIDE = 448, N = SIDE * SIDE };
    float *xyz = rig_alloc(3u * N * sizeof *xyz);
    const smr_mesh mesh = {xyz, NULL, N, 0};
    const smr_prepare_config radii = rig_radii(1, 0.5f, 0, 0);
    smr_model_info info;
    for (uint32_t i = 0; i < N; i++) {
        xyz[3u * i] = (float)(i % SIDE);
        xyz[3u * i + 1u] = (float)(i / SIDE);
        xyz[3u * i + 2u] = 0.0f;
    }
    assert_int_equal(SMR_OK, smr_model_get_info(rig_model(&mesh, 1, &radii), &info));
    assert_true(info.largest_cluster[0] == 1u);
}

/* Without `attract` room counts for nothing: bytes, what is accepted and results are those of no room. */
TEST(test_attraction_switched_off)
{
    const smr_mesh goal = rig_ball(33, 9, 12, none), mesh = rig_ball(30, 9, 12, none);
    const smr_prepare_config radii = rig_radii(1, 18, 0, 0);
    const smr_model *model = rig_model(&mesh, 1, &radii);
    smr_config c = smr_config_default();
    smr_tick_report report[2];
    size_t bytes[2];
    for (uint32_t off = 0; off < 2u; off++) {
        c.basic.attract = !off;
        c.basic.n_target_vertices = off ? goal.n_vertices - 1u : 0u;
        assert_int_equal(SMR_OK, smr_arena_bytes(model, &c, &bytes[off]));
        smr *s = rig_init(model, &c, NULL);
        assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, rig_surface(&goal)));
        for (uint32_t i = 0; i < 5u; i++)
            assert_int_equal(SMR_OK, smr_tick(s, 0, &report[off]));
    }
    assert_int_equal(bytes[0], bytes[1]);
    assert_true(report[0].state_hash == report[1].state_hash && report[1].details.attraction_used == 0.0f);
}
