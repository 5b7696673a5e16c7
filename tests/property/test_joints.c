/* test_joints.c: start poses of parts. A forearm has turned at an elbow by 60 to 90 degrees about any axis, and carries
 * a ball without a target. Poses are found onto own targets and onto one that both bones share, with the same bits in
 * pieces; a registration from there stays, also where it is saved and restored on the way. Parts that are not found
 * take their neighbour's pose.
 * Accuracy: 0.3 mm for the same meshes.
 * SPDX-License-Identifier: MIT */
#include "suite.h"

#include <math.h>
#include <string.h>

#include "rig_cloud.h"
#include "rig_parts.h"

enum { ARM, FOREARM, BALL, PARTS };

#define CELL_UM 9000u
#define FOUND_MM 0.3f
#define STAYS_MM 0.05f

typedef struct arm {
    smr_mesh model[PARTS], target[2]; /* at rest; turned */
    float turn[9], shift[3];          /* of the forearm */
} arm;

static const float none[3] = {0, 0, 0};

/* The vertex with the largest z, or the smallest where sign is -1. */
static const float *end_of(const smr_mesh *m, float sign)
{
    uint32_t best = 0;
    for (uint32_t v = 1; v < m->n_vertices; v++)
        if (sign * m->xyz[3u * v + 2u] > sign * m->xyz[3u * best + 2u])
            best = v;
    return m->xyz + 3u * (size_t)best;
}

static arm make_arm(uint32_t *seed, float degrees)
{
    static const float smaller[9] = {0.7f, 0, 0, 0, 0.7f, 0, 0, 0, 0.7f}, same[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    smr_mesh target;
    arm a;
    float axis[3], joint[3], to[3];
    rig_bone(CELL_UM, 0.0f, &a.model[ARM], &target);
    const smr_mesh small = rig_moved(&a.model[ARM], smaller, none);
    const float *low = end_of(&a.model[ARM], -1.0f), *high = end_of(&small, 1.0f);
    for (uint32_t k = 0; k < 3u; k++) {
        joint[k] = low[k] - (k == 2u ? 2.0f : 0.0f);
        to[k] = joint[k] - high[k];
    }
    a.model[FOREARM] = rig_moved(&small, same, to);
    const float *wrist = end_of(&a.model[FOREARM], -1.0f), ball[3] = {wrist[0], wrist[1], wrist[2] - 8.0f};
    a.model[BALL] = rig_ball(6.0f, 7, 8, ball);
    rig_within(seed, -1, 1, axis);
    rig_rotation(axis[0], axis[1], axis[2], degrees, a.turn);
    for (uint32_t k = 0; k < 3u; k++)
        a.shift[k] =
            joint[k] - (a.turn[3u * k] * joint[0] + a.turn[3u * k + 1u] * joint[1] + a.turn[3u * k + 2u] * joint[2]);
    a.target[ARM] = a.model[ARM];
    a.target[FOREARM] = rig_moved(&a.model[FOREARM], a.turn, a.shift);
    return a;
}

static void posed(const smr_mesh *m, const smr_pose *p, float *out)
{
    for (uint32_t v = 0; v < m->n_vertices; v++)
        for (uint32_t r = 0; r < 3u; r++)
            out[3u * v + r] = p->m[r][0] * m->xyz[3u * v] + p->m[r][1] * m->xyz[3u * v + 1u] +
                              p->m[r][2] * m->xyz[3u * v + 2u] + p->m[r][3];
}

/* Finds the poses of n parts, at once or in pieces. */
static void align(const smr_surface *model, const smr_surface *onto, smr_align_part *part, uint32_t n, int pieces)
{
    smr_align_config c = smr_align_config_default();
    const smr_port port = rig_port(RIG_SHUFFLE, 3);
    smr_pose whole;
    smr_job job;
    size_t bytes;
    c.scaled = 0;
    c.samples = 301;
    c.n_parts = n;
    c.part = part;
    c.port = pieces ? NULL : &port;
    assert_int_equal(SMR_OK, smr_align_bytes(&c, &bytes));
    assert_int_equal(SMR_OK, smr_align_begin(model, onto, &c, rig_rough(bytes), bytes, &whole, NULL, &job));
    smr_status status = SMR_PARTIAL;
    while (status == SMR_PARTIAL)
        status = smr_job_step(&job, pieces ? 97u : 0u, NULL, 0);
    assert_int_equal(SMR_OK, status);
}

/* ball: the target of its own that the ball has, or NULL. */
static void find(const arm *a, int shared, const smr_surface *ball, int pieces, smr_align_part part[PARTS])
{
    const smr_mesh model = rig_joined(a->model, 2), both = rig_joined(a->target, 2);
    smr_surface *onto = rig_surface(&both);
    memset(part, 0, PARTS * sizeof *part);
    for (uint32_t i = 0; i < PARTS; i++) {
        part[i].model = rig_surface(&a->model[i]);
        part[i].target = i == BALL ? ball : shared ? onto : rig_surface(&a->target[i]);
    }
    align(rig_surface(&model), onto, part, PARTS, pieces);
}

static float check_found(const arm *a, const smr_align_part *part)
{
    float worst = 0.0f;
    for (uint32_t i = 0; i < 2u; i++) {
        float *at = rig_alloc(12u * (size_t)a->model[i].n_vertices);
        posed(&a->model[i], &part[i].pose, at);
        worst = fmaxf(worst, rig_far(at, a->target[i].xyz, a->model[i].n_vertices));
        assert_true(part[i].order == i + 1u && part[i].report.n_alike > 0u);
    }
    assert_true(part[BALL].order == 3u && part[BALL].report.n_alike == 0u);
    assert_memory_equal(&part[BALL].pose, &part[FOREARM].pose, sizeof part[BALL].pose);
    return worst;
}

TEST(test_poses)
{
    uint32_t seed = 11;
    for (uint32_t i = 0; i < rig_times(4); i++)
        for (int shared = 0; shared < 2; shared++) {
            const arm a = make_arm(&seed, 60.0f + 10.0f * (float)i);
            smr_align_part part[PARTS], again[PARTS];
            find(&a, shared, NULL, 0, part);
            assert_true(check_found(&a, part) < FOUND_MM);
            find(&a, shared, NULL, 1, again);
            for (uint32_t k = 0; k < PARTS && i == 0u; k++) {
                assert_memory_equal(&part[k].pose, &again[k].pose, sizeof part[k].pose);
                assert_memory_equal(&part[k].report, &again[k].report, sizeof part[k].report);
            }
            rig_free_all();
        }
}

/* A part with a target of its own is found far from its joint, also right after a part that shares its target. */
TEST(test_own_target_after_a_shared_one)
{
    static const float same[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, beside[3] = {400, 0, 0};
    uint32_t seed = 15;
    const arm a = make_arm(&seed, 70.0f);
    const smr_mesh away = rig_moved(&a.model[BALL], same, beside);
    const smr_surface *own = rig_surface(&away);
    smr_align_part part[PARTS];
    float at[3];
    find(&a, 1, own, 0, part);
    assert_true(part[FOREARM].order == 2u && part[BALL].order == 3u && part[BALL].report.n_alike > 0u);
    const float *wrist = end_of(&a.model[FOREARM], -1.0f);
    const float centre[3] = {wrist[0], wrist[1], wrist[2] - 8.0f};
    const float to[3] = {centre[0] + beside[0], centre[1], centre[2]};
    posed(&(const smr_mesh){centre, NULL, 1, 0}, &part[BALL].pose, at);
    assert_true(rig_far(at, to, 1) < FOUND_MM);
    rig_free_all();
}

static float far_from(const arm *a, const smr *s, const smr_model *model)
{
    const float *at = rig_positions(s, model);
    return fmaxf(
        rig_far(at, a->target[ARM].xyz, a->model[ARM].n_vertices),
        rig_far(at + 3u * (size_t)a->model[ARM].n_vertices, a->target[FOREARM].xyz, a->model[FOREARM].n_vertices));
}

TEST(test_stays)
{
    uint32_t seed = 12;
    const arm a = make_arm(&seed, 80.0f);
    const smr_pose turned = {{{a.turn[0], a.turn[1], a.turn[2], a.shift[0]},
                              {a.turn[3], a.turn[4], a.turn[5], a.shift[1]},
                              {a.turn[6], a.turn[7], a.turn[8], a.shift[2]}}};
    const smr_model *model = rig_model(a.model, 2, NULL);
    smr_config c = smr_config_default();
    smr *s = rig_init(model, &c, NULL);
    float *at = rig_alloc(12u * (size_t)a.model[FOREARM].n_vertices);
    smr_surface *target[2] = {rig_surface(&a.target[ARM]), rig_surface(&a.target[FOREARM])};
    posed(&a.model[FOREARM], &turned, at);
    assert_int_equal(SMR_OK, smr_set_positions(s, FOREARM, at));
    for (uint32_t i = 0; i < 2u; i++)
        assert_int_equal(SMR_OK, smr_set_surface(s, i, target[i]));
    (void)rig_run(s, 40);
    smr *twin = rig_restored(s, model, &c);
    for (uint32_t i = 0; i < 2u; i++)
        assert_int_equal(SMR_OK, smr_set_surface(twin, i, target[i]));
    (void)rig_run(s, 1000);
    (void)rig_run(twin, 1000);
    assert_true(far_from(&a, s, model) < STAYS_MM);
    assert_true(smr_state_hash(s) == smr_state_hash(twin));
    smr_verdict verdict;
    assert_int_equal(SMR_OK, smr_get_verdict(s, SMR_ALL, &verdict));
    assert_int_equal(SMR_VERDICT_GOOD, verdict.level);
    rig_free_all();
}

/* The points of a mesh, without normals, as a surface. */
static const smr_surface *cloud_of(const smr_mesh *m)
{
    smr_points *const points = rig_cloud(m->n_vertices);
    smr_surface *cloud;
    size_t bytes;
    assert_int_equal(SMR_OK, smr_points_add(points, m->xyz, NULL, NULL, m->n_vertices));
    assert_int_equal(SMR_OK, smr_points_surface_bytes(m->n_vertices, &bytes));
    assert_int_equal(SMR_OK, smr_points_surface(points, rig_alloc(bytes), bytes, &cloud));
    return cloud;
}

/* Parts that are found, on a target that shows forearm and ball, and such that are not and take their neighbour's pose:
 * twins of the arm, which explains its target already, and one of which a small core alone fits. clouds: of the
 * targets (1), or the models of arm and forearm (2). */
TEST(test_unusual_parts)
{
    enum { ODD = PARTS, TWIN, TWINS = 2, ALL = TWIN + TWINS };
    static const float beside[3] = {500, 0, 0};
    for (uint32_t clouds = 0; clouds < 3u; clouds++) {
        uint32_t seed = 14;
        arm a = make_arm(&seed, 70.0f);
        const smr_mesh ball = rig_moved(&a.model[BALL], a.turn, a.shift), core = rig_ball(15, 20, 20, beside);
        const smr_mesh odd[2][2] = {{rig_ball(30, 8, 10, beside), core}, {rig_ball(60, 8, 10, beside), core}};
        const smr_mesh lower[2] = {a.target[FOREARM], ball}, onto[2] = {a.target[ARM], rig_joined(lower, 2)};
        const smr_mesh odd_model = rig_joined(odd[0], 2), odd_target = rig_joined(odd[1], 2);
        smr_align_part part[ALL];
        memset(part, 0, sizeof part);
        for (uint32_t i = 0; i < ALL; i++) {
            const smr_mesh *m = i == ODD ? &odd_model : &a.model[i < PARTS ? i : ARM];
            part[i].model = clouds == 2u && i < BALL ? cloud_of(m) : rig_surface(m);
        }
        for (uint32_t i = 0; i < 2u; i++) {
            const smr_surface *s = clouds == 1u ? cloud_of(&onto[i]) : rig_surface(&onto[i]);
            for (uint32_t k = 0; k < ALL; k++)
                part[k].target = i == (k == FOREARM || k == BALL) ? s : part[k].target;
        }
        part[ODD].target = rig_surface(&odd_target);
        align(part[ARM].model, part[ARM].target, part, ALL, 1);
        for (uint32_t i = 0; i < ALL; i++) {
            const uint32_t first = clouds == 2u ? TWIN : ARM; /* of a mesh the area counts, which is larger */
            assert_int_equal(i == first || i == FOREARM || i == BALL, part[i].report.n_alike > 0u);
            assert_true(part[i].report.rms_mm < 2.0f && part[first].order == 1u);
            if (part[i].report.n_alike == 0u && i != ODD)
                assert_memory_equal(&part[i].pose, &part[first].pose, sizeof part[i].pose);
        }
        rig_free_all();
    }
}

TEST(test_refusals)
{
    uint32_t seed = 13;
    const arm a = make_arm(&seed, 60.0f);
    smr_surface *s = rig_surface(&a.model[ARM]);
    smr_align_part part[2] = {{.model = s, .target = s}, {.model = s, .target = s}};
    smr_align_config c = smr_align_config_default();
    size_t bytes;
    smr_pose pose;
    smr_job job;
    c.n_parts = 1;
    assert_int_equal(SMR_E_CONFIG, smr_align_bytes(&c, &bytes));
    c.part = part;
    c.n_parts = SMR_STRUCTURES_MAX + 1u;
    assert_int_equal(SMR_E_CONFIG, smr_align_bytes(&c, &bytes));
    c.n_parts = 2;
    assert_int_equal(SMR_OK, smr_align_bytes(&c, &bytes));
    void *memory = rig_alloc(bytes);
    part[0].model = NULL;
    assert_int_equal(SMR_E_STATE, smr_align_begin(s, s, &c, memory, bytes, &pose, NULL, &job));
    part[0].model = rig_surface(&a.model[FOREARM]);
    assert_int_equal(SMR_OK, smr_align_begin(s, s, &c, memory, bytes, &pose, NULL, &job));
    assert_int_equal(SMR_PARTIAL, smr_job_step(&job, 5, NULL, 0));
    assert_int_equal(SMR_OK, smr_surface_refit((smr_surface *)(uintptr_t)part[0].model, a.model[FOREARM].xyz));
    assert_int_equal(SMR_E_STATE, smr_job_step(&job, 5, NULL, 0));
    rig_free_all();
}
