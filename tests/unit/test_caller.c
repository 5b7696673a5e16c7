/* test_caller.c: goals and forces of the caller's own: refused where they are wrong, blended by weight, and found out
 * when they break their contract.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include <string.h>
#include "registration/registration.h"

enum { LOG = 65536 };

static smr_mesh ball;
static const smr_model *model;

static smr_config config_of(uint32_t goals, uint32_t force)
{
    smr_config c = smr_config_default();
    c.caller.goals = goals;
    c.caller.force = force;
    c.basic.iterations_last = 30;
    return c;
}

static smr *start(uint32_t goals, uint32_t force, const smr_port *port)
{
    const smr_prepare_config radii = rig_radii(2, 30, 0.1f, 0);
    const float at[3] = {100, 200, -300};
    smr_config config = config_of(goals, force);
    config.basic.n_workers = port != NULL ? port->n_workers : 1u;
    ball = rig_ball(20, 10, 14, at);
    model = rig_model(&ball, 1, &radii);
    return rig_init(model, &config, port);
}

/* Where a vertex of the rest shape is drawn to. */
static void bent(const float *p, float *to)
{
    to[0] = p[0] + 3.0f;
    to[1] = p[1] + 0.01f * (p[2] + 300.0f) * (p[2] + 300.0f);
    to[2] = 1.1f * (p[2] + 300.0f) - 300.0f;
}

static float *bent_goals(void)
{
    float *xyz = rig_alloc(3u * (size_t)ball.n_vertices * sizeof(float));
    for (uint32_t i = 0; i < ball.n_vertices; i++)
        bent(ball.xyz + 3u * (size_t)i, xyz + 3u * (size_t)i);
    return xyz;
}

TEST(test_refused)
{
    smr *s = start(1, SMR_CALLER_ON, NULL);
    float *xyz = bent_goals(), *weight = rig_alloc(ball.n_vertices * sizeof(float));
    memset(weight, 0, ball.n_vertices * sizeof *weight);
    assert_int_equal(SMR_E_NULL, smr_set_goals(NULL, 0, xyz, NULL));
    assert_int_equal(SMR_E_NULL, smr_set_force(NULL, NULL, NULL));
    assert_int_equal(SMR_E_INPUT, smr_set_goals(s, 1, xyz, NULL));
    assert_int_equal(SMR_E_INPUT, smr_set_goals(s, SMR_ALL, NULL, NULL));
    weight[3] = -1.0f;
    assert_int_equal(SMR_E_INPUT, smr_set_goals(s, 0, xyz, weight));
    weight[3] = NAN;
    assert_int_equal(SMR_E_INPUT, smr_set_goals(s, 0, xyz, weight));
    weight[3] = 2.0f * SMR_CALLER_WEIGHT;
    assert_int_equal(SMR_E_INPUT, smr_set_goals(s, 0, xyz, weight));
    weight[3] = 1.0f;
    assert_int_equal(SMR_OK, smr_set_goals(s, 0, xyz, weight));
    xyz[7] = -2.0f * SMR_COORD_MAX;
    assert_int_equal(SMR_E_INPUT, smr_set_goals(s, 0, xyz, NULL));
    xyz[7] = INFINITY;
    assert_int_equal(SMR_E_INPUT, smr_set_goals(s, 0, xyz, NULL));
    assert_ptr_equal(weight, s->forces.caller.goals[0].weights); /* those before stay */
    assert_int_equal(SMR_OK, smr_set_goals(s, 0, NULL, NULL));
    s = start(0, SMR_CALLER_OFF, NULL);
    xyz[7] = 0.0f;
    assert_int_equal(SMR_E_ARENA, smr_set_goals(s, 0, xyz, NULL));
    assert_int_equal(SMR_E_ARENA, smr_set_force(s, NULL, NULL));
}

/* Goals are reached; those with weight 0 are none; they are taken away. */
TEST(test_goals)
{
    smr *s = start(1, SMR_CALLER_OFF, NULL);
    const float *goal = bent_goals();
    float *weight = rig_alloc(ball.n_vertices * sizeof(float));
    smr_structure_report report;
    smr_verdict verdict;
    assert_int_equal(SMR_OK, smr_set_goals(s, 0, goal, NULL));
    smr_tick_report last = rig_run(s, 1000);
    assert_true(last.done && last.n_forces == ball.n_vertices && last.details.residual_max_mm < 0.01f);
    assert_true(rig_far(rig_positions(s, model), goal, ball.n_vertices) < 0.01f);
    assert_int_equal(SMR_OK, smr_get_structure_report(s, 0, &report));
    assert_int_equal(1, report.has_target);
    assert_int_equal(SMR_OK, smr_get_verdict(s, SMR_ALL, &verdict));
    assert_true(verdict.visible_share > 0.99f && verdict.residual_mm < 0.01f);
    s = start(1, SMR_CALLER_OFF, NULL);
    for (uint32_t i = 0; i < ball.n_vertices; i++)
        weight[i] = i % 2u != 0u ? 0.5f : 0.0f;
    assert_int_equal(SMR_OK, smr_set_goals(s, 0, goal, weight));
    last = rig_run(s, 3);
    assert_int_equal(ball.n_vertices / 2u, last.n_forces);
    assert_int_equal(SMR_OK, smr_set_goals(s, 0, NULL, NULL));
    last = rig_run(s, 1);
    assert_int_equal(0, last.n_forces);
}

/* Where two vertices have goals, too few for a pose, it is that of all vertices; three give one by themselves. */
TEST(test_pose_of_few)
{
    const smr_pose there = {{{0, 0, 1, 5}, {1, 0, 0, 0}, {0, 1, 0, 0}}};
    smr *s = start(1, SMR_CALLER_OFF, NULL);
    float *weight = rig_alloc(ball.n_vertices * sizeof(float));
    assert_int_equal(SMR_OK, smr_set_pose(s, &there));
    const float *here = rig_positions(s, model);
    memset(weight, 0, ball.n_vertices * sizeof *weight);
    for (uint32_t n = 1; n <= 3u; n++) {
        smr_pose pose;
        float mm;
        weight[30u * n] = 1.0f;
        assert_int_equal(SMR_OK, smr_set_goals(s, 0, here, weight));
        assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
        assert_int_equal(SMR_OK, smr_get_pose(s, 0, &pose, &mm));
        assert_true(mm >= 0.0f && mm < 0.01f && rig_far(&pose.m[0][0], &there.m[0][0], 4) < 0.01f);
    }
}

/* The arrays stay the caller's, who may spoil them: such vertices have no goal, and nothing else changes. */
TEST(test_spoilt_goals)
{
    for (uint32_t i = 0; i < 4u; i++) {
        smr *s = start(1, SMR_CALLER_OFF, NULL);
        float *xyz = bent_goals(), *weight = rig_alloc(ball.n_vertices * sizeof(float));
        for (uint32_t v = 0; v < ball.n_vertices; v++)
            weight[v] = 1.0f;
        assert_int_equal(SMR_OK, smr_set_goals(s, 0, xyz, weight));
        xyz[5] = i == 1u ? NAN : i == 2u ? 2.0f * SMR_COORD_MAX : xyz[5];
        weight[1] = i == 3u ? 2.0f * SMR_CALLER_WEIGHT : 1.0f;
        assert_int_equal(ball.n_vertices - (i > 0u ? 1u : 0u), rig_run(s, 2).n_forces);
        assert_true(rig_finite(rig_positions(s, model), ball.n_vertices));
    }
}

/* The same as a force: where each vertex is drawn follows from its place at rest. Notes what it saw. */
typedef struct pull {
    uint32_t n_vertices, wild;
    float weight, far;
} pull;

static void draw(void *ctx, const smr_force_view *view, float *way, float *weight)
{
    const pull *p = ctx;
    for (uint32_t i = 0; i < view->n; i++) {
        float to[3];
        bent(view->rest + 3u * (size_t)i, to);
        for (uint32_t c = 0; c < 3u; c++)
            way[3u * i + c] += to[c] - view->xyz[3u * i + c];
        weight[i] += p->weight;
        if (view->structure[i] != 0u || view->vertex[i] >= p->n_vertices)
            way[3u * i] += NAN;
    }
    if (p->wild && view->n > 2u)
        way[5] = p->far;
}

static uint64_t forced(const smr_port *port, uint32_t how, float *off)
{
    smr *s = start(0, how, port);
    pull p = {ball.n_vertices, 0, 2.0f, 0.0f};
    assert_int_equal(SMR_OK, smr_set_force(s, draw, &p));
    assert_true(rig_run(s, 1000).done);
    *off = rig_far(rig_positions(s, model), bent_goals(), ball.n_vertices);
    return smr_state_hash(s);
}

TEST(test_force)
{
    float off = 0.0f;
    const uint64_t hash = forced(NULL, SMR_CALLER_ON, &off);
    assert_true(off < 0.01f);
    for (uint32_t k = 0; k < RIG_SCHEDULERS; k++) {
        const smr_port port = rig_port(k, 6);
        assert_true(forced(&port, SMR_CALLER_CHECKED, &off) == hash);
    }
}

/* A force that remembers is found out, and so is one that gives what is not a number; it can be set again. */
static void forgets(void *ctx, const smr_force_view *view, float *way, float *weight)
{
    uint32_t *calls = ctx;
    way[0] = (float)++*calls;
    weight[0] = (float)(view->n > 0u);
}
static void forgets_weights(void *ctx, const smr_force_view *view, float *way, float *weight)
{
    uint32_t *calls = ctx;
    way[0] = (float)(view->n > 0u);
    weight[0] = (float)(++*calls % 2u);
}

TEST(test_broken)
{
    smr *s = start(0, SMR_CALLER_ON, NULL);
    uint32_t calls = 0;
    pull p = {ball.n_vertices, 1, 1.0f, NAN};
    assert_int_equal(SMR_OK, smr_set_force(s, forgets, &calls));
    assert_int_equal(SMR_OK, smr_tick(s, 0, NULL)); /* nobody looks */
    s = start(0, SMR_CALLER_CHECKED, NULL);
    const uint64_t before = smr_state_hash(s);
    assert_int_equal(SMR_OK, smr_set_force(s, forgets, &calls));
    assert_int_equal(SMR_E_STATE, smr_tick(s, 0, NULL));
    assert_int_equal(SMR_E_STATE, smr_tick(s, 0, NULL));
    size_t bytes = 0;
    assert_int_equal(SMR_OK, smr_save_bytes(s, &bytes));
    assert_int_equal(SMR_E_STATE, smr_save(s, rig_alloc(bytes), bytes)); /* nor can it be saved */
    assert_int_equal(SMR_OK, smr_set_surface(s, 0, NULL));               /* which starts the iteration over */
    assert_int_equal(SMR_E_STATE, smr_save(s, rig_alloc(bytes), bytes));
    assert_int_equal(SMR_OK, smr_set_force(s, forgets_weights, &calls));
    assert_int_equal(SMR_E_STATE, smr_tick(s, 0, NULL));
    assert_int_equal(SMR_OK, smr_set_force(s, draw, &p)); /* not a number */
    assert_int_equal(SMR_E_STATE, smr_tick(s, 0, NULL));
    p.far = 2e5f;
    assert_int_equal(SMR_OK, smr_set_force(s, draw, &p));
    assert_int_equal(SMR_E_STATE, smr_tick(s, 0, NULL));
    assert_true(smr_state_hash(s) == before);
    p.wild = 0;
    assert_int_equal(SMR_OK, smr_set_force(s, draw, &p));
    assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
    assert_int_equal(SMR_OK, smr_set_force(s, NULL, NULL));
    assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
}

/* A force's output of weights and displacements out of range, one vertex at a time; the state stays as it was. */
static void strange(void *ctx, const smr_force_view *view, float *displacement, float *weight)
{
    const float *bad = ctx; /* at which vertex, its weight, its displacement along z */
    for (uint32_t i = 0; i < view->n; i++)
        if (view->vertex[i] == (uint32_t)bad[0]) {
            weight[i] = bad[1];
            displacement[3u * (size_t)i + 2u] = bad[2];
        }
}

TEST(test_strange_output)
{
    static const struct {
        float weight, z;
        smr_status status;
    } all[] = {{1, 5, SMR_OK},
               {SMR_CALLER_WEIGHT, -5, SMR_OK},
               {0, 0, SMR_OK},
               {-1, 5, SMR_E_STATE},
               {NAN, 5, SMR_E_STATE},
               {2.0f * SMR_CALLER_WEIGHT, 5, SMR_E_STATE},
               {1, 2.0f * SMR_COORD_MAX, SMR_E_STATE},
               {1, -INFINITY, SMR_E_STATE}};
    for (uint32_t i = 0; i < 8u; i++)
        for (uint32_t v = 0; v < 140u; v += 46u) {
            float bad[3] = {(float)v, all[i].weight, all[i].z};
            smr *s = start(0, SMR_CALLER_ON, NULL);
            assert_int_equal(SMR_OK, smr_set_active(s, SMR_ALL));
            const uint64_t before = smr_state_hash(s);
            assert_int_equal(SMR_OK, smr_set_force(s, strange, bad));
            assert_int_equal(all[i].status, smr_tick(s, 0, NULL));
            assert_true(all[i].status == SMR_OK || smr_state_hash(s) == before);
        }
}

/* Inputs of the replay, in turn. */
typedef struct inputs {
    smr_goals goals;
    smr_caller_force force;
} inputs;
