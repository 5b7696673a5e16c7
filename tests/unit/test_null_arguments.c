/* test_null_arguments.c: each required pointer of each call, NULL alone, is refused as such; with all pointers the call
 * says something else. So is each object that is none, that changes under a job, or that has wrong numbers.
 * SPDX-License-Identifier: MIT */
#include "suite.h"

/* Number of the argument that is NULL now. */
static uint32_t none;
#define OR_NULL(i, pointer) (none == (i) ? NULL : (pointer))

/* The call has n required pointers, which are its OR_NULL(0 .. n - 1, ...). */
#define NEEDS(n, call)                                                                                                 \
    for (none = 0; none <= (n); none++) {                                                                              \
        const smr_status status = (call);                                                                              \
        if ((status == SMR_E_NULL) != (none < (n)))                                                                    \
            fail_msg("argument %u of %s: %s", (unsigned)none, #call, smr_status_name(status));                         \
    }

#define ROOM ((size_t)1 << 22)

typedef struct scene {
    smr_mesh mesh;
    const smr_model *model;
    smr_config config;
    smr_surface *surface;
    smr *s;
    float *xyz;
    void *memory;
    size_t bytes;
    smr_pose pose;
    smr_job job;
} scene;

static scene e;

BEFORE_ALL_TESTS()
{
    const smr_prepare_config radii = rig_radii(1, 60, 0, 0);
    smr_mesh target;
    rig_bone(12000, 1.0f, &e.mesh, &target);
    e.model = rig_model(&e.mesh, 1, &radii);
    e.config = smr_config_default();
    e.config.basic.n_target_vertices = target.n_vertices;
    e.s = rig_init(e.model, &e.config, NULL);
    e.surface = rig_surface(&target);
    e.xyz = rig_alloc(12u * (size_t)(e.mesh.n_vertices + 3u));
    for (uint32_t i = 0; i < 3u * e.mesh.n_vertices; i++)
        e.xyz[i] = e.mesh.xyz[i];
    e.memory = rig_alloc(ROOM);
    e.pose = (smr_pose){{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
}

TEST(registrations)
{
    smr *out;
    const smr_model *model;
    smr_model_info info;
    smr_structure_info one;
    NEEDS(3, smr_arena_bytes(OR_NULL(0, e.model), OR_NULL(1, &e.config), OR_NULL(2, &e.bytes)))
    NEEDS(4, smr_init(OR_NULL(0, e.model), OR_NULL(1, &e.config), NULL, OR_NULL(2, e.memory), ROOM, OR_NULL(3, &out)))
    NEEDS(5, smr_init_begin(OR_NULL(0, e.model), OR_NULL(1, &e.config), NULL, OR_NULL(2, e.memory), ROOM,
                            OR_NULL(3, &out), OR_NULL(4, &e.job)))
    NEEDS(2, smr_model_open(OR_NULL(0, e.model), 0, OR_NULL(1, &model)))
    NEEDS(3, smr_model_open_begin(OR_NULL(0, e.model), 0, OR_NULL(1, &model), OR_NULL(2, &e.job)))
    NEEDS(2, smr_model_get_info(OR_NULL(0, e.model), OR_NULL(1, &info)))
    NEEDS(2, smr_model_structure(OR_NULL(0, e.model), 0, OR_NULL(1, &one)))
    NEEDS(1, smr_model_mesh(OR_NULL(0, e.model), 0, NULL, NULL))
    NEEDS(2, smr_set_pose(OR_NULL(0, e.s), OR_NULL(1, &e.pose)))
    NEEDS(3, smr_set_pose_begin(OR_NULL(0, e.s), OR_NULL(1, &e.pose), OR_NULL(2, &e.job)))
    NEEDS(2, smr_set_positions(OR_NULL(0, e.s), 0, OR_NULL(1, e.xyz)))
    NEEDS(3, smr_set_positions_begin(OR_NULL(0, e.s), 0, OR_NULL(1, e.xyz), OR_NULL(2, &e.job)))
    NEEDS(1, smr_set_surface(OR_NULL(0, e.s), 0, NULL))
    NEEDS(1, smr_set_points(OR_NULL(0, e.s), 0, NULL))
    NEEDS(1, smr_set_fixed(OR_NULL(0, e.s), 0, NULL))
    NEEDS(1, smr_set_active(OR_NULL(0, e.s), 1))
    NEEDS(1, smr_set_scrub(OR_NULL(0, e.s), 0))
    NEEDS(2, smr_set_scrub_begin(OR_NULL(0, e.s), 0, OR_NULL(1, &e.job)))
    NEEDS(1, smr_scrub(OR_NULL(0, e.s), 0))
    NEEDS(1, smr_tick(OR_NULL(0, e.s), 0, NULL))
    NEEDS(1, smr_job_step(OR_NULL(0, &e.job), 1, NULL, 0))
}

TEST(results)
{
    union {
        smr_verdict verdict;
        smr_structure_report report;
        smr_structure_volume volume;
        smr_energy energy;
        unsigned char visible[SMR_VERTICES_MAX / 16u];
    } *const to = e.memory;
    smr_pose pose;
    float mm;
    uint32_t n;
    NEEDS(2, smr_get_positions(OR_NULL(0, e.s), 0, OR_NULL(1, e.memory)))
    NEEDS(2, smr_get_verdict(OR_NULL(0, e.s), 0, OR_NULL(1, &to->verdict)))
    NEEDS(3, smr_verdict_begin(OR_NULL(0, e.s), 0, OR_NULL(1, &to->verdict), OR_NULL(2, &e.job)))
    NEEDS(2, smr_get_expected_error(OR_NULL(0, e.s), 0, OR_NULL(1, e.memory)))
    NEEDS(1, smr_get_expected_parts(OR_NULL(0, e.s), 0, e.memory, NULL))
    NEEDS(1, smr_get_expected_parts(OR_NULL(0, e.s), 0, NULL, e.memory))
    NEEDS(2, smr_expected_begin(OR_NULL(0, e.s), 0, NULL, OR_NULL(1, e.memory), NULL, &e.job))
    NEEDS(2, smr_expected_begin(OR_NULL(0, e.s), 0, NULL, NULL, OR_NULL(1, e.memory), &e.job))
    NEEDS(2, smr_get_local_volume(OR_NULL(0, e.s), 0, 30, OR_NULL(1, e.memory)))
    NEEDS(3, smr_local_volume_begin(OR_NULL(0, e.s), 0, 30, OR_NULL(1, e.memory), OR_NULL(2, &e.job)))
    NEEDS(2, smr_get_visible(OR_NULL(0, e.s), 0, OR_NULL(1, to->visible)))
    NEEDS(2, smr_get_normals(OR_NULL(0, e.s), 0, OR_NULL(1, e.memory)))
    NEEDS(2, smr_get_structure_report(OR_NULL(0, e.s), 0, OR_NULL(1, &to->report)))
    NEEDS(3, smr_get_pose(OR_NULL(0, e.s), 0, OR_NULL(1, &pose), OR_NULL(2, &mm)))
    NEEDS(2, smr_get_structure_volume(OR_NULL(0, e.s), 0, OR_NULL(1, &to->volume)))
    NEEDS(2, smr_get_awaited(OR_NULL(0, e.s), OR_NULL(1, &n)))
    NEEDS(2, smr_get_velocities(OR_NULL(0, e.s), 0, OR_NULL(1, e.memory)))
    NEEDS(2, smr_get_energy(OR_NULL(0, e.s), OR_NULL(1, &to->energy)))
    NEEDS(2, smr_get_landmarks(OR_NULL(0, e.s), OR_NULL(1, e.memory)))
    NEEDS(3, smr_get_reference_weights(OR_NULL(0, e.s), OR_NULL(1, e.memory), OR_NULL(2, &n)))
}

TEST(surfaces)
{
    smr_surface *surface;
    smr_points *points;
    smr_closest hit;
    smr_contact_report contact;
    float mm;
    uint32_t n;
    smr_mesh mesh = e.mesh;
    NEEDS(1, smr_surface_bytes(9, 9, OR_NULL(0, &e.bytes)))
    NEEDS(3, smr_surface_build(OR_NULL(0, &mesh), OR_NULL(1, e.memory), ROOM, OR_NULL(2, &surface)))
    NEEDS(3, smr_surface_begin(OR_NULL(0, &mesh), OR_NULL(1, e.memory), ROOM, OR_NULL(2, &surface)))
    NEEDS(1, (mesh.xyz = OR_NULL(0, e.mesh.xyz), smr_surface_build(&mesh, e.memory, ROOM, &surface)))
    NEEDS(1, (mesh.xyz = OR_NULL(0, e.mesh.xyz), smr_surface_begin(&mesh, e.memory, ROOM, &surface)))
    NEEDS(1, (mesh.triangles = OR_NULL(0, e.mesh.triangles), smr_surface_build(&mesh, e.memory, ROOM, &surface)))
    NEEDS(1, (mesh.triangles = OR_NULL(0, e.mesh.triangles), smr_surface_begin(&mesh, e.memory, ROOM, &surface)))
    NEEDS(1, smr_surface_step(OR_NULL(0, surface), 1, NULL, 0))
    NEEDS(2, smr_surface_refit(OR_NULL(0, surface), OR_NULL(1, e.mesh.xyz)))
    NEEDS(3, smr_surface_closest(OR_NULL(0, e.surface), OR_NULL(1, e.xyz), NULL, 0, 1, OR_NULL(2, &hit)))
    NEEDS(3, smr_surface_distances(OR_NULL(0, e.surface), OR_NULL(1, e.xyz), 1, OR_NULL(2, &mm)))
    NEEDS(3, smr_surface_contact(OR_NULL(0, e.surface), OR_NULL(1, e.surface), 1, OR_NULL(2, &contact)))
    NEEDS(4, smr_surface_contact_begin(OR_NULL(0, e.surface), OR_NULL(1, e.surface), 1, OR_NULL(2, &contact),
                                       OR_NULL(3, &e.job)))
    NEEDS(1, smr_points_bytes(9, OR_NULL(0, &e.bytes)))
    NEEDS(2, smr_points_open(9, OR_NULL(0, e.memory), ROOM, OR_NULL(1, &points)))
    NEEDS(2, smr_points_add(OR_NULL(0, points), OR_NULL(1, e.xyz), NULL, NULL, 1))
    NEEDS(1, smr_points_weigh(OR_NULL(0, points), 0, 1))
    NEEDS(2, smr_points_count(OR_NULL(0, points), OR_NULL(1, &n)))
    void *const room = rig_alloc(ROOM);
    NEEDS(1, smr_points_surface_bytes(9, OR_NULL(0, &e.bytes)))
    NEEDS(3, smr_points_surface(OR_NULL(0, points), OR_NULL(1, room), ROOM, OR_NULL(2, &surface)))
    NEEDS(3, smr_points_surface_begin(OR_NULL(0, points), OR_NULL(1, room), ROOM, OR_NULL(2, &surface)))
    NEEDS(1, smr_points_clear(OR_NULL(0, points)))
}

TEST(start_poses)
{
    const smr_align_config c = smr_align_config_default();
    smr_warp *warp;
    smr_pose pose;
    uint32_t kind;
    const float *const p = e.mesh.xyz;
    NEEDS(2, smr_align_bytes(OR_NULL(0, &c), OR_NULL(1, &e.bytes)))
    void *const room = rig_alloc(e.bytes);
    NEEDS(6, smr_align_begin(OR_NULL(0, e.surface), OR_NULL(1, e.surface), OR_NULL(2, &c), OR_NULL(3, room), e.bytes,
                             OR_NULL(4, &pose), NULL, OR_NULL(5, &e.job)))
    NEEDS(3, smr_articulated_bytes(OR_NULL(0, e.surface), OR_NULL(1, e.surface), OR_NULL(2, &e.bytes)))
    NEEDS(7,
          smr_articulated_begin(OR_NULL(0, e.surface), OR_NULL(1, e.surface), OR_NULL(2, &e.pose), NULL,
                                OR_NULL(3, e.memory), ROOM, OR_NULL(4, e.xyz), OR_NULL(5, &kind), OR_NULL(6, &e.job)))
    NEEDS(3, smr_align_landmarks(OR_NULL(0, p), OR_NULL(1, p), 5, 0, OR_NULL(2, &pose), NULL))
    NEEDS(1, smr_warp_bytes(5, OR_NULL(0, &e.bytes)))
    NEEDS(5, smr_warp_fit(OR_NULL(0, p), OR_NULL(1, p), 5, 0, OR_NULL(2, e.memory), ROOM, OR_NULL(3, &warp),
                          OR_NULL(4, &kind)))
    NEEDS(2, smr_warp_apply(OR_NULL(0, warp), OR_NULL(1, e.xyz), 1))
}

TEST(carrying)
{
    const uint32_t n = e.mesh.n_vertices;
    const float *const p = e.mesh.xyz;
    float frame[3 * SMR_FRAME_PLACES], now[9];
    smr_carry *carry;
    NEEDS(1, smr_carry_bytes(n, 1, 1, OR_NULL(0, &e.bytes)))
    NEEDS(4, smr_carry_fit(OR_NULL(0, p), n, OR_NULL(1, p), 1, NULL, OR_NULL(2, e.memory), ROOM, OR_NULL(3, &carry)))
    NEEDS(5, smr_carry_fit_begin(OR_NULL(0, p), n, OR_NULL(1, p), 1, NULL, OR_NULL(2, e.memory), ROOM,
                                 OR_NULL(3, &carry), OR_NULL(4, &e.job)))
    assert_int_equal(SMR_OK, smr_carry_fit(p, n, p, 1, NULL, e.memory, ROOM, &carry));
    NEEDS(3, smr_carry_apply(OR_NULL(0, carry), OR_NULL(1, p), OR_NULL(2, now)))
    NEEDS(4, smr_carry_map(OR_NULL(0, carry), OR_NULL(1, p), 0, OR_NULL(2, p), 1, OR_NULL(3, now), NULL))
    NEEDS(2, smr_frame_places(OR_NULL(0, p), 1, 1, OR_NULL(1, frame)))
    NEEDS(3, smr_frame_poses(OR_NULL(0, frame), OR_NULL(1, frame), 1, NULL, OR_NULL(2, now)))
    NEEDS(2, smr_frame_normals(OR_NULL(0, now), OR_NULL(1, frame), 1))
}

TEST(saves_and_logs)
{
    static unsigned char log[SMR_LOG_BYTES(9, 0)];
    unsigned char *const saved = rig_alloc(ROOM), *const arena = rig_alloc(ROOM);
    smr *out = rig_init(e.model, &e.config, NULL);
    smr_saved_info info;
    smr_log_state recorded;
    smr_log_reader reader;
    smr_log_info about;
    smr_log_record record;
    smr_replay replay;
    smr_replay_report report;
    NEEDS(2, smr_save_bytes(OR_NULL(0, e.s), OR_NULL(1, &e.bytes)))
    NEEDS(2, smr_save(OR_NULL(0, e.s), OR_NULL(1, saved), ROOM))
    NEEDS(3, smr_save_begin(OR_NULL(0, e.s), OR_NULL(1, saved), ROOM, OR_NULL(2, &e.job)))
    assert_int_equal(SMR_OK, smr_save(e.s, saved, ROOM));
    NEEDS(2, smr_save_info(OR_NULL(0, saved), e.bytes, OR_NULL(1, &info)))
    NEEDS(4, smr_restore(OR_NULL(0, e.model), NULL, NULL, OR_NULL(1, saved), e.bytes, OR_NULL(2, arena), ROOM,
                         OR_NULL(3, &out)))
    NEEDS(4, smr_restore_begin(OR_NULL(0, e.model), NULL, NULL, OR_NULL(1, saved), e.bytes, arena, ROOM,
                               OR_NULL(2, &out), OR_NULL(3, &e.job))) /* the job's first step looks at the arena */
    out = rig_init(e.model, &e.config, NULL);
    NEEDS(1, smr_set_log(OR_NULL(0, out), log, sizeof log))
    NEEDS(2, smr_get_log(OR_NULL(0, out), OR_NULL(1, &recorded)))
    NEEDS(2, smr_log_open(OR_NULL(0, log), recorded.bytes, OR_NULL(1, &reader), &about))
    NEEDS(2, smr_log_next(OR_NULL(0, &reader), OR_NULL(1, &record)))
    NEEDS(3, smr_replay_start(OR_NULL(0, out), OR_NULL(1, log), recorded.bytes, NULL, NULL, OR_NULL(2, &replay)))
    NEEDS(2, smr_replay_tick(OR_NULL(0, &replay), OR_NULL(1, &report)))
}

/* A call of two surfaces. */
typedef smr_status (*pairing)(const smr_surface *a, const smr_surface *b);
static smr_contact_report contact;
static uint32_t bent;

static smr_status touch(const smr_surface *a, const smr_surface *b)
{
    return smr_surface_contact_begin(a, b, 1, &contact, &e.job);
}
static smr_status bend_bytes(const smr_surface *a, const smr_surface *b)
{
    return smr_articulated_bytes(a, b, &e.bytes);
}
static smr_status bend(const smr_surface *a, const smr_surface *b)
{
    return smr_articulated_begin(a, b, &e.pose, NULL, e.memory, ROOM, e.xyz, &bent, &e.job);
}
static smr_status align(const smr_surface *a, const smr_surface *b)
{
    static smr_align_config c;
    c = smr_align_config_default();
    return smr_align_begin(a, b, &c, e.memory, ROOM, &e.pose, NULL, &e.job);
}

TEST(pairs_of_surfaces)
{
    static const pairing call[] = {touch, bend, align, bend_bytes};
    static _Alignas(SMR_ALIGN) unsigned char room[SMR_POINTS_BYTES(9)];
    void *const zero = rig_alloc(4096), *memory[2];
    smr_points *points;
    smr_surface *cloud, *pair[2];
    size_t bytes;
    assert_int_equal(SMR_OK, smr_points_open(9, room, sizeof room, &points));
    assert_int_equal(SMR_OK, smr_points_add(points, e.xyz, NULL, NULL, 9));
    assert_int_equal(SMR_OK, smr_points_surface_bytes(9, &bytes));
    assert_int_equal(SMR_OK, smr_points_surface(points, rig_alloc(bytes), bytes, &cloud));
    assert_int_equal(SMR_OK, smr_surface_bytes(e.mesh.n_vertices, e.mesh.n_triangles, &bytes));
    for (uint32_t i = 0; i < 2u; i++)
        memory[i] = rig_alloc(bytes);
    for (uint32_t k = 0; k < 4u; k++) {
        smr_surface *const wrong[] = {zero, cloud};
        for (uint32_t i = 0; i < (call[k] == align ? 1u : 2u); i++) {
            assert_int_equal(SMR_E_STATE, call[k](wrong[i], e.surface));
            assert_int_equal(SMR_E_STATE, call[k](e.surface, wrong[i]));
        }
        for (uint32_t i = 0; i < 5u && k < 3u;
             i++) { /* surface i / 2 gets other positions, or is built anew; 4: neither */
            for (uint32_t side = 0; side < 2u; side++)
                assert_int_equal(SMR_OK, smr_surface_build(&e.mesh, memory[side], bytes, &pair[side]));
            assert_int_equal(SMR_OK, call[k](pair[0], pair[1]));
            smr_surface *const changed = pair[i / 2u % 2u];
            if (i < 4u && i % 2u == 0u)
                assert_int_equal(SMR_OK,
                                 smr_surface_refit(changed, e.mesh.xyz) + smr_surface_step(changed, 0, NULL, 0));
            if (i < 4u && i % 2u == 1u)
                assert_int_equal(SMR_OK, smr_surface_begin(&e.mesh, changed, bytes, &pair[i / 2u]));
            assert_int_equal(i < 4u ? SMR_E_STATE : SMR_PARTIAL, smr_job_step(&e.job, 1, NULL, 0));
        }
    }
    assert_int_equal(SMR_E_INPUT, smr_surface_contact(e.surface, e.surface, 1.0e9f, &contact));
}

/* A budget counts where the port has a clock; without, it is as none. */
TEST(budgets_without_a_clock)
{
    const smr_port still = {NULL, 1, NULL, NULL};
    const smr_port *const ports[] = {NULL, &still};
    smr_surface *surface;
    for (uint32_t i = 0; i < 2u; i++) {
        assert_int_equal(SMR_OK, smr_surface_begin(&e.mesh, e.memory, ROOM, &surface));
        assert_int_equal(SMR_OK, smr_surface_step(surface, 0, ports[i], 1));
        assert_int_equal(SMR_OK, touch(e.surface, e.surface));
        assert_int_equal(SMR_OK, smr_job_step(&e.job, 0, ports[i], 1));
    }
}

TEST(numbers)
{
    const float *const p = e.mesh.xyz;
    const float wild[3] = {0, 2.0f * SMR_COORD_MAX, 0};
    smr_align_config c = smr_align_config_default();
    smr_port port = {NULL, 0, NULL, NULL};
    smr_warp *warp;
    uint32_t kind;
    smr_pose pose;
    c.port = &port;
    assert_int_equal(SMR_E_CONFIG, smr_align_bytes(&c, &e.bytes));
    port.n_workers = SMR_WORKERS_MAX + 1u;
    assert_int_equal(SMR_E_CONFIG, smr_align_bytes(&c, &e.bytes));
    port.n_workers = 2;
    assert_int_equal(SMR_OK, smr_align_bytes(&c, &e.bytes));
    port.n_workers = 0; /* as no port */
    assert_int_equal(SMR_OK,
                     smr_articulated_begin(e.surface, e.surface, &e.pose, &port, e.memory, ROOM, e.xyz, &bent, &e.job));
    port.n_workers = 1;
    assert_int_equal(SMR_OK,
                     smr_articulated_begin(e.surface, e.surface, &e.pose, &port, e.memory, ROOM, e.xyz, &bent, &e.job));
    assert_int_equal(SMR_E_INPUT, smr_carry_bytes(SMR_VERTICES_MAX + 1u, 1, 1, &e.bytes));
    assert_int_equal(SMR_E_INPUT, smr_align_landmarks(wild, p, 1, 0, &pose, NULL));
    assert_int_equal(SMR_E_INPUT, smr_align_landmarks(p, wild, 1, 0, &pose, NULL));
    assert_int_equal(SMR_E_INPUT, smr_warp_fit(p, p, 0, 0, e.memory, ROOM, &warp, &kind));
}

/* Parts of an alignment: no model, a model or a target that is none, and one that changes under the job. */
TEST(parts)
{
    void *const zero = rig_alloc(4096);
    smr_align_part part;
    smr_align_config c = smr_align_config_default();
    size_t bytes;
    c.part = &part;
    c.n_parts = 1;
    assert_int_equal(SMR_OK, smr_align_bytes(&c, &bytes));
    void *const memory = rig_alloc(bytes);
    smr_surface *const own = rig_surface(&e.mesh), *const wrong[][2] = {{NULL, NULL}, {zero, NULL}, {own, zero}};
    for (uint32_t i = 0; i < 3u; i++) {
        part = (smr_align_part){.model = wrong[i][0], .target = wrong[i][1]};
        assert_int_equal(SMR_E_STATE, smr_align_begin(e.surface, e.surface, &c, memory, bytes, &e.pose, NULL, &e.job));
    }
    part = (smr_align_part){.model = own, .target = own};
    assert_int_equal(SMR_OK, smr_align_begin(e.surface, e.surface, &c, memory, bytes, &e.pose, NULL, &e.job));
    assert_int_equal(SMR_OK, smr_surface_refit(own, e.mesh.xyz) + smr_surface_step(own, 0, NULL, 0));
    assert_int_equal(SMR_E_STATE, smr_job_step(&e.job, 1, NULL, 0));
}
