/* test_hostile_runtime.c: any input to a registration is refused with a status and changes nothing, or is accepted
 * and keeps every position finite.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const float none[3] = {0, 0, 0};
static smr_mesh ball, other;
static const smr_model *model;
static smr_surface *surface;

BEFORE_EACH_TEST()
{
    const smr_prepare_config radii = rig_radii(2, 25, 12, 0);
    ball = rig_ball(30, 7, 10, none);
    other = rig_ball(33, 8, 11, none);
    model = rig_model(&ball, 1, &radii);
    surface = rig_surface(&other);
}

/* ---- NULL, cookies, ranges */

TEST(test_null)
{
    smr_config config = smr_config_default();
    const smr_pose pose = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    size_t bytes;
    float xyz[3 * 128];
    smr_structure_report part;
    smr *s = rig_init(model, &config, NULL), *out = s;
    assert_int_equal(SMR_E_NULL, smr_arena_bytes(NULL, &config, &bytes));
    assert_int_equal(SMR_E_NULL, smr_arena_bytes(model, NULL, &bytes));
    assert_int_equal(SMR_E_NULL, smr_arena_bytes(model, &config, NULL));
    assert_int_equal(SMR_E_NULL, smr_init(model, &config, NULL, xyz, sizeof xyz, NULL));
    assert_int_equal(SMR_E_NULL, smr_init(NULL, &config, NULL, xyz, sizeof xyz, &out));
    assert_int_equal(SMR_E_NULL, smr_init(model, NULL, NULL, xyz, sizeof xyz, &out));
    assert_int_equal(SMR_E_NULL, smr_init(model, &config, NULL, NULL, 1u << 20, &out));
    assert_ptr_equal(s, out);
    assert_int_equal(SMR_E_NULL, smr_set_positions(NULL, 0, xyz));
    assert_int_equal(SMR_E_NULL, smr_set_positions(s, 0, NULL));
    assert_int_equal(SMR_E_NULL, smr_set_pose(NULL, &pose));
    assert_int_equal(SMR_E_NULL, smr_set_pose(s, NULL));
    assert_int_equal(SMR_E_NULL, smr_set_surface(NULL, 0, surface));
    assert_int_equal(SMR_OK, smr_set_surface(s, 0, NULL));
    assert_int_equal(SMR_E_NULL, smr_tick(NULL, 0, NULL));
    assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
    assert_int_equal(SMR_E_NULL, smr_get_positions(NULL, 0, xyz));
    assert_int_equal(SMR_E_NULL, smr_get_positions(s, 0, NULL));
    assert_int_equal(SMR_E_NULL, smr_get_normals(NULL, 0, xyz));
    assert_int_equal(SMR_E_NULL, smr_get_normals(s, 0, NULL));
    assert_int_equal(SMR_E_NULL, smr_get_structure_report(NULL, 0, &part));
    assert_int_equal(SMR_E_NULL, smr_get_structure_report(s, 0, NULL));
    assert_true(smr_state_hash(NULL) == 0u);
}

TEST(test_not_a_registration)
{
    float xyz[3 * 128];
    unsigned char seen[128];
    smr_structure_report part;
    smr_verdict verdict;
    const smr_pose pose = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    smr *s = rig_alloc(1u << 16); /* zero bytes */
    smr_config config = smr_config_default();
    smr *good = rig_init(model, &config, NULL);
    size_t bytes = 0;
    assert_int_equal(SMR_OK, smr_arena_bytes(model, &config, &bytes));
    unsigned char *copy = rig_alloc(bytes);
    assert_int_equal(SMR_E_STATE, smr_tick(s, 0, NULL));
    assert_int_equal(SMR_E_STATE, smr_set_pose(s, &pose));
    assert_int_equal(SMR_E_STATE, smr_set_positions(s, 0, ball.xyz));
    assert_int_equal(SMR_E_STATE, smr_set_surface(s, 0, surface));
    assert_int_equal(SMR_E_STATE, smr_get_positions(s, 0, xyz));
    assert_int_equal(SMR_E_STATE, smr_get_normals(s, 0, xyz));
    assert_int_equal(SMR_E_STATE, smr_get_structure_report(s, 0, &part));
    assert_int_equal(SMR_E_STATE, smr_get_verdict(s, SMR_ALL, &verdict));
    assert_int_equal(SMR_E_STATE, smr_get_expected_error(s, 0, xyz));
    assert_int_equal(SMR_E_STATE, smr_get_expected_parts(s, 0, xyz, NULL));
    assert_int_equal(SMR_E_STATE, smr_get_local_volume(s, 0, 0, xyz));
    assert_int_equal(SMR_E_STATE, smr_get_visible(s, 0, seen));
    assert_true(smr_state_hash(s) == 0u);
    assert_int_equal(SMR_E_STATE, smr_set_surface(good, 0, (const smr_surface *)rig_alloc(4096)));
    assert_int_equal(SMR_E_INPUT, smr_set_surface(good, 1, surface));
    assert_int_equal(SMR_E_INPUT, smr_set_surface(good, SMR_ALL - 1u, NULL));
    assert_int_equal(SMR_E_INPUT, smr_set_positions(good, 1, ball.xyz));
    assert_int_equal(SMR_E_INPUT, smr_set_positions(good, SMR_ALL - 1u, ball.xyz));
    assert_int_equal(SMR_E_INPUT, smr_get_positions(good, 1, xyz));
    assert_int_equal(SMR_E_INPUT, smr_get_normals(good, SMR_ALL, xyz));
    assert_int_equal(SMR_E_INPUT, smr_get_structure_report(good, 1, &part));
    assert_int_equal(SMR_E_INPUT, smr_get_verdict(good, SMR_ALL - 1u, &verdict));
    assert_int_equal(SMR_E_INPUT, smr_get_expected_error(good, 1, xyz));
    assert_int_equal(SMR_E_INPUT, smr_get_expected_parts(good, 1, NULL, xyz));
    assert_int_equal(SMR_E_NULL, smr_get_expected_parts(good, 0, NULL, NULL));
    assert_int_equal(SMR_E_INPUT, smr_get_local_volume(good, 1, 0, xyz));
    assert_int_equal(SMR_E_INPUT, smr_get_visible(good, SMR_ALL, seen));
    memcpy(copy, good, 1024); /* the head is enough: it says where it was */
    assert_int_equal(SMR_E_STATE, smr_get_verdict((smr *)(void *)copy, 0, &verdict));
    assert_int_equal(SMR_E_STATE, smr_get_expected_error((smr *)(void *)copy, 0, xyz));
    assert_int_equal(SMR_E_STATE, smr_get_local_volume((smr *)(void *)copy, 0, 0, xyz));
    assert_int_equal(SMR_E_STATE, smr_get_visible((smr *)(void *)copy, 0, seen));
}

/* Refused by both calls, with *out and *bytes as they were. */
static void refused(const smr_config *config, const char *field)
{
    unsigned char *memory = rig_alloc(1u << 18);
    smr *const before = (smr *)(void *)memory;
    smr *out = before;
    size_t bytes = 77;
    const smr_status a = smr_arena_bytes(model, config, &bytes);
    const smr_status b = smr_init(model, config, NULL, memory, 1u << 18, &out);
    if (a != SMR_E_CONFIG || b != SMR_E_CONFIG || out != before || bytes != 77u) {
        fail_msg("%s: %s and %s, out %s", field, smr_status_name(a), smr_status_name(b),
                 out == before ? "kept" : "written");
    }
}

/* Each of the values alone. */
#define REFUSE_ALL(field, type, ...)                                                                                   \
    do {                                                                                                               \
        const type value_[] = {__VA_ARGS__};                                                                           \
        for (size_t i_ = 0; i_ < sizeof value_ / sizeof value_[0]; i_++) {                                             \
            smr_config c_ = smr_config_default();                                                                      \
            c_.forces.use_box = 1;                                                                                     \
            c_.field = value_[i_];                                                                                     \
            refused(&c_, #field " of " #__VA_ARGS__);                                                                  \
        }                                                                                                              \
    } while (0)
#define REFUSE(field, ...) REFUSE_ALL(field, uint32_t, __VA_ARGS__)
#define REFUSE_FLOAT(field, ...)                                                                                       \
    REFUSE_ALL(field, float, NAN, INFINITY, -INFINITY, -1.0f, -1.0e-30f, 1.0e30f, __VA_ARGS__)

TEST(test_every_field)
{
    REFUSE(cookie, 0, smr_config_default().cookie + 1u, smr_config_default().cookie ^ 0x10000u,
           smr_prepare_config_default().cookie);
    REFUSE(basic.n_workers, 0, SMR_WORKERS_MAX + 1u, UINT32_MAX);
    REFUSE(basic.n_target_vertices, SMR_VERTICES_MAX + 1u, UINT32_MAX);
    REFUSE_FLOAT(forces.stiffness, 0.0f, 1.001f);
    REFUSE_FLOAT(basic.attraction, 1.001f);
    REFUSE_FLOAT(basic.slide, 1.001f);
    REFUSE_FLOAT(image.sideways, 1.001f);
    REFUSE(image.rest, 61, UINT32_MAX);
    REFUSE_FLOAT(basic.even, 1.001f);
    REFUSE_FLOAT(basic.search_mm, 0.0f, SMR_COORD_MAX * 1.001f);
    REFUSE_FLOAT(forces.search_radii, 0.0f, 1.1e6f);
    REFUSE_FLOAT(forces.normal_deg, 0.0f, 180.01f);
    REFUSE_FLOAT(forces.reject_deviations, -2.0f);
    REFUSE(forces.reject_border, 2);
    REFUSE(forces.use_box, 2);
    REFUSE(forces.node_budget, 7, 1000001, UINT32_MAX);
    REFUSE(basic.method, 2, UINT32_MAX);
}

TEST(test_every_field_of_the_schedule)
{
    REFUSE_FLOAT(motion.relaxation, 0.0f, 1.001f);
    REFUSE_FLOAT(motion.momentum, 1.0f);
    REFUSE_FLOAT(motion.plastic_um, -2.0f);
    REFUSE_FLOAT(motion.settle_um, -2.0f);
    REFUSE(motion.plastic_every, 1001);
    REFUSE(motion.fold_guard, 2);
    REFUSE(motion.normals, 2);
    REFUSE(schedule.radius_first, 2, SMR_ALL); /* the model has radii 0 and 1 */
    REFUSE(schedule.radius_last, 2, SMR_FINEST - 1u);
    REFUSE(basic.iterations, 0, 100001);
    REFUSE(basic.iterations_last, 0, 100001);
    for (uint32_t i = 0; i < 3u; i++) {
        REFUSE_ALL(forces.box_min[i], float, NAN, -INFINITY, 1.0f); /* above the maximum, 0 */
        REFUSE_ALL(forces.box_max[i], float, NAN, INFINITY, 1.0e6f);
    }
    smr_config config = smr_config_default();
    config.schedule.radius_first = 1;
    config.schedule.radius_last = 0;
    refused(&config, "radius_first > radius_last");
    config = smr_config_default();
    config.forces.box_min[0] = NAN; /* not looked at without use_box */
    (void)rig_init(model, &config, NULL);
}

TEST(test_port)
{
    smr_config config = smr_config_default();
    unsigned char *memory = rig_alloc(1u << 18);
    smr_port port = {NULL, 2, NULL, NULL};
    smr *out = NULL;
    assert_int_equal(SMR_E_CONFIG, smr_init(model, &config, &port, memory, 1u << 18, &out)); /* more than n_workers */
    port.n_workers = 0;
    assert_int_equal(SMR_E_CONFIG, smr_init(model, &config, &port, memory, 1u << 18, &out));
    port.n_workers = UINT32_MAX;
    assert_int_equal(SMR_E_CONFIG, smr_init(model, &config, &port, memory, 1u << 18, &out));
    assert_null(out);
    config.basic.n_workers = 3; /* more than the port has is fine */
    port.n_workers = 2;
    assert_int_equal(SMR_OK, smr_init(model, &config, &port, memory, 1u << 18, &out));
}

/* ---- memory */

TEST(test_arena_edges)
{
    for (uint32_t method = 0; method < 2u; method++) {
        for (uint32_t workers = 1; workers <= 5u; workers += 2u) {
            for (uint32_t targets = 0; targets <= 100u; targets += 100u) {
                smr_config config = smr_config_default();
                size_t bytes = 0;
                config.basic.method = method;
                config.basic.n_workers = workers;
                config.basic.n_target_vertices = targets;
                assert_int_equal(SMR_OK, smr_arena_bytes(model, &config, &bytes));
                unsigned char *memory = rig_alloc(bytes + 128u), *copy = rig_alloc(bytes + 128u);
                memset(memory, 0xa5, bytes + 128u);
                memcpy(copy, memory, bytes + 128u);
                smr *mark = (smr *)(void *)memory, *out = mark;
                assert_int_equal(SMR_E_ARENA, smr_init(model, &config, NULL, memory, bytes - 1u, &out));
                assert_int_equal(SMR_E_ARENA, smr_init(model, &config, NULL, memory, 0, &out));
                for (uint32_t off = 1; off < SMR_ALIGN; off++)
                    assert_int_equal(SMR_E_ALIGN, smr_init(model, &config, NULL, memory + off, bytes, &out));
                assert_ptr_equal(mark, out);
                assert_memory_equal(copy, memory, bytes + 128u); /* refused: not a byte written */
                assert_int_equal(SMR_OK, smr_init(model, &config, NULL, memory, bytes, &out));
                assert_int_equal(SMR_OK, smr_set_surface(out, 0, surface));
                (void)rig_run(out, 5);
                assert_memory_equal(copy + bytes, memory + bytes, 128); /* nothing beyond the end */
            }
        }
    }
}

TEST(test_target_larger_than_promised)
{
    smr_config config = smr_config_default();
    config.basic.n_target_vertices = other.n_vertices - 1u;
    smr *s = rig_init(model, &config, NULL);
    const uint64_t before = smr_state_hash(s);
    assert_int_equal(SMR_E_ARENA, smr_set_surface(s, 0, surface));
    assert_int_equal(SMR_E_ARENA, smr_set_surface(s, SMR_ALL, surface));
    assert_true(before == smr_state_hash(s));
    smr_structure_report part;
    assert_int_equal(SMR_OK, smr_get_structure_report(s, 0, &part));
    assert_int_equal(0, part.has_target);
    config.basic.n_target_vertices = other.n_vertices;
    s = rig_init(model, &config, NULL);
    assert_int_equal(SMR_OK, smr_set_surface(s, 0, surface));
}

/* The macro for static storage is never too small, and not wasteful. */
TEST(test_arena_macro)
{
    static const uint32_t workers[] = {1, 2, 8, 64}, targets[] = {0, 1, 5000}, parts[] = {1, 7, 40};
    const smr_prepare_config radii = rig_radii(1, 5, 0, 0);
    smr_mesh mesh[40];
    double worst = 0.0, waste = 0.0;
    for (uint32_t size = 0; size < 5u; size++) {
        for (uint32_t p = 0; p < 3u; p++) {
            if (size >= 3u && p > 1u)
                continue;
            for (uint32_t i = 0; i < parts[p]; i++) {
                const float at[3] = {200.0f * (float)i, 0, 0};
                mesh[i] = rig_ball(60, 3u + 5u * size, 4u + 8u * size, at);
                mesh[i].n_triangles = size == 1u ? i % 3u : mesh[i].n_triangles;
                mesh[i].n_vertices = size == 0u ? 1u : mesh[i].n_vertices;
                mesh[i].n_triangles = size == 0u ? 0u : mesh[i].n_triangles;
            }
            const smr_model *m = rig_model(mesh, parts[p], &radii);
            smr_model_info info;
            assert_int_equal(SMR_OK, smr_model_get_info(m, &info));
            for (uint32_t k = 0; k < 24u; k++) {
                smr_config config = smr_config_default();
                size_t bytes = 0;
                config.basic.n_workers = workers[k % 4u];
                config.basic.n_target_vertices = targets[k / 4u % 3u];
                config.basic.method = k / 12u;
                assert_int_equal(SMR_OK, smr_arena_bytes(m, &config, &bytes));
                const size_t bound =
                    SMR_ARENA_BYTES(info.n_vertices, info.n_triangles, info.n_structures, config.basic.n_workers,
                                    config.basic.n_target_vertices, config.basic.method);
                const double ratio = (double)bytes / (double)bound;
                worst = ratio > worst ? ratio : worst;
                if (size == 4u)
                    waste = 1.0 / ratio > waste ? 1.0 / ratio : waste;
                if (bytes > bound) {
                    print_message("%u vertices %u triangles %u structures %u workers %u targets: %zu > %zu\n",
                                  info.n_vertices, info.n_triangles, info.n_structures, config.basic.n_workers,
                                  config.basic.n_target_vertices, bytes, bound);
                }
            }
        }
    }
    if (getenv("SMR_TEST_SHOW") != NULL)
        print_message("arena / macro: at most %.3f; macro / arena of a large model: at most %.3f\n", worst, waste);
    assert_true(worst <= 1.0);
    assert_true(waste <= 1.04);
}

/* ---- coordinates from outside */

TEST(test_refused_positions_change_nothing)
{
    static const float bad[] = {NAN, INFINITY, -INFINITY, 1.001e5f, -1.001e5f, 3.0e38f};
    smr_config config = smr_config_default();
    smr *s = rig_init(model, &config, NULL), *twin = rig_init(model, &config, NULL);
    assert_int_equal(SMR_OK, smr_set_surface(s, 0, surface));
    assert_int_equal(SMR_OK, smr_set_surface(twin, 0, surface));
    (void)rig_run(s, 4);
    (void)rig_run(twin, 4);
    float *xyz = rig_alloc(ball.n_vertices * 3u * sizeof *xyz);
    for (uint32_t i = 0; i < 6u; i++) {
        smr_pose pose = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
        memcpy(xyz, ball.xyz, ball.n_vertices * 3u * sizeof *xyz);
        xyz[3u * ball.n_vertices - 1u - i] = bad[i];
        assert_int_equal(SMR_E_INPUT, smr_set_positions(s, 0, xyz));
        pose.m[i % 3u][i / 2u] = bad[i];
        assert_int_equal(SMR_E_INPUT, smr_set_pose(s, &pose));
    }
    const smr_pose too_far = {{{1, 0, 0, 99990.0f}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    const smr_pose too_large = {{{4000, 0, 0, 0}, {0, 4000, 0, 0}, {0, 0, 4000, 0}}};
    assert_int_equal(SMR_E_INPUT, smr_set_pose(s, &too_far));
    assert_int_equal(SMR_E_INPUT, smr_set_pose(s, &too_large));
    for (uint32_t i = 0; i < 5u; i++) { /* nothing, a plane, a mirror image, and scales of 1/1100 and 1100 */
        static const float x[] = {0.0f, 0.0f, -1.0f, 1.0f / 1100.0f, 1100.0f};
        const float yz = i == 0u || i > 2u ? x[i] : 1.0f;
        const smr_pose pose = {{{x[i], 0, 0, 0}, {0, yz, 0, 0}, {0, 0, yz, 0}}};
        assert_int_equal(SMR_E_INPUT, smr_set_pose(s, &pose));
    }
    assert_true(smr_state_hash(s) == smr_state_hash(twin));
    (void)rig_run(s, 10);
    (void)rig_run(twin, 10);
    assert_true(smr_state_hash(s) == smr_state_hash(twin));
}

/* Bytes that are no model: nothing behind the first 64 is read, nor a place that they name. */
TEST(test_refuses_what_is_no_model)
{
    smr_config config = smr_config_default();
    size_t bytes = 0;
    smr *s = NULL;
    uint32_t seed = 7;
    for (uint32_t i = 0; i < 40u; i++) {
        uint32_t *word = rig_alloc(64);
        for (uint32_t k = 0; k < 16u; k++)
            word[k] = i == 0u ? 0u : i == 1u ? UINT32_MAX : rig_random(&seed, UINT32_MAX);
        if (i > 2u) /* the begin of a model, with a wrong word */
            memcpy(word, model, 64);
        static const uint32_t at[] = {0, 1, 4, 6, 7, 8};
        if (i > 2u)
            word[at[i % 6u]] = i < 12u ? UINT32_MAX : 0u;
        assert_int_equal(SMR_E_MODEL, smr_arena_bytes((const smr_model *)word, &config, &bytes));
        assert_int_equal(SMR_E_MODEL, smr_init((const smr_model *)word, &config, NULL, word, 64, &s));
        rig_free(word);
    }
    assert_int_equal(SMR_E_MODEL, smr_arena_bytes((const smr_model *)((const char *)model + 4), &config, &bytes));
    assert_true(s == NULL && bytes == 0u);
}
