/* test_port_contract.c: what a port or a program does against the contract is refused with a status: calls from
 * within a tick, worker numbers that are not there, a copied arena. Positions stay those of the last complete
 * iteration.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <string.h>
#include "property/rig_chaos.h"
#include "registration/registration.h"

/* Runs tasks in order. `meddle`: the first one of each loop is followed by calls that must be refused.
 * `worker`: the number that the last task of each loop is given. `drop`: 1: leaves out the loop's last task, 2: the
 * first one, 3: all of them. */
typedef struct port_state {
    smr *s;
    const smr_surface *surface;
    uint32_t meddle, worker, drop, calls, accepted;
} port_state;

static const smr_pose identity = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
static const float none[3] = {0, 0, 0};
static smr_mesh ball, goal;

/* Tries everything that changes a registration; returns how many calls were not SMR_E_STATE. */
static uint32_t meddle(smr *s, const smr_surface *surface)
{
    unsigned char log[SMR_LOG_BYTES(0, 0)];
    const smr_status status[] = {
        smr_tick(s, 0, NULL),           smr_set_pose(s, &identity),     smr_set_positions(s, 0, ball.xyz),
        smr_set_surface(s, 0, surface), smr_set_volume(s, NULL),        smr_set_active(s, 1),
        smr_set_log(s, NULL, 0),        smr_set_log(s, log, sizeof log)};
    uint32_t accepted = 0;
    for (size_t i = 0; i < sizeof status / sizeof status[0]; i++)
        accepted += status[i] != SMR_E_STATE;
    return accepted;
}

static void loop(void *ctx, smr_task run, void *arg, uint32_t n_tasks)
{
    port_state *p = ctx;
    for (uint32_t t = 0; t < n_tasks; t++) {
        if (!(p->drop == 3u || (p->drop == 1u && t + 1u == n_tasks) || (p->drop == 2u && t == 0u)))
            run(arg, t, t + 1u == n_tasks ? p->worker : 0u);
        if (t == 0u && p->meddle) {
            p->calls++;
            p->accepted += meddle(p->s, p->surface);
        }
    }
}

static uint64_t meddling_clock(void *ctx)
{
    port_state *p = ctx;
    if (p->meddle)
        p->accepted += meddle(p->s, p->surface);
    return 0;
}

static smr *start(port_state *p, uint32_t n_workers)
{
    const float off[3] = {5, 3, -2};
    const smr_prepare_config radii = rig_radii(2, 25, 15, 0);
    const smr_port port = {p, n_workers, loop, meddling_clock};
    smr_config config = smr_config_default();
    ball = rig_ball(30, 29, 24, none);
    goal = rig_ball(35, 12, 16, off);
    config.basic.n_workers = n_workers;
    config.basic.n_target_vertices = goal.n_vertices;
    memset(p, 0, sizeof *p);
    p->s = rig_init(rig_model(&ball, 1, &radii), &config, &port);
    p->surface = rig_surface(&goal);
    assert_int_equal(SMR_OK, smr_set_surface(p->s, 0, p->surface));
    return p->s;
}

TEST(refuses_calls_from_within)
{
    port_state p, q;
    smr *s = start(&p, 2), *twin = start(&q, 2);
    p.meddle = 1;
    for (uint32_t i = 0; i < 12u; i++) {
        assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
        assert_int_equal(SMR_OK, smr_tick(twin, 0, NULL));
        assert_true(smr_state_hash(s) == smr_state_hash(twin));
    }
    assert_true(p.calls > 12u);
    assert_int_equal(p.accepted, 0);
    p.meddle = 0;
    assert_int_equal(SMR_OK, smr_set_active(s, 0)); /* allowed again between ticks */
    assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
}

/* After a tick that failed: s waits for positions, and then goes on as its twin, which did not fail. */
static void assert_goes_on(smr *s, smr *twin)
{
    assert_int_equal(SMR_E_STATE, smr_tick(s, 0, NULL));
    assert_true(smr_state_hash(s) == smr_state_hash(twin));
    assert_int_equal(SMR_OK, smr_set_pose(s, &identity));
    assert_int_equal(SMR_OK, smr_set_pose(twin, &identity));
    (void)rig_run(s, 6);
    (void)rig_run(twin, 6);
    assert_true(smr_state_hash(s) == smr_state_hash(twin));
    rig_free_all();
}

TEST(refuses_workers_that_are_not_there)
{
    static const uint32_t worker[] = {2, 3, 64, UINT32_MAX};
    for (size_t k = 0; k < sizeof worker / sizeof worker[0]; k++) {
        port_state p, q;
        smr_tick_report report, before;
        smr *s = start(&p, 2), *twin = start(&q, 2);
        (void)rig_run(s, 3);
        (void)rig_run(twin, 3);
        p.worker = worker[k];
        memset(&report, 0x5a, sizeof report);
        before = report;
        assert_int_equal(SMR_E_STATE, smr_tick(s, 0, &report));
        assert_memory_equal(&report, &before, sizeof report);
        p.worker = 1;
        assert_goes_on(s, twin);
    }
}

/* A port that leaves tasks out gets an error, and the last complete positions stay; as does one of prepare. */
TEST(notices_tasks_left_out)
{
    for (uint32_t drop = 1; drop <= 3u; drop++) {
        port_state p, q;
        smr *s = start(&p, 2), *twin = start(&q, 2);
        smr_port port = {&p, 2, loop, NULL};
        smr_prepare_config config = rig_radii(2, 25, 15, 0);
        const smr_structure one = {"", ball};
        smr_carry *carry;
        size_t bytes;
        (void)rig_run(s, 3);
        (void)rig_run(twin, 3);
        p.drop = drop;
        assert_int_equal(SMR_E_STATE, smr_tick(s, 0, NULL));
        assert_int_equal(SMR_OK, smr_carry_bytes(ball.n_vertices, ball.n_vertices, 2, &bytes));
        assert_int_equal(SMR_E_STATE, smr_carry_fit(ball.xyz, ball.n_vertices, ball.xyz, ball.n_vertices, &port,
                                                    rig_alloc(bytes), bytes, &carry));
        config.port = &port;
        assert_int_equal(SMR_OK, smr_prepare_bytes(&one, 1, &config, &bytes));
        void *scratch = rig_alloc(bytes), *memory = rig_alloc(1u << 20);
        size_t model_bytes;
        assert_int_equal(SMR_E_STATE, smr_prepare(&one, 1, &config, scratch, bytes, memory, 1u << 20, &model_bytes));
        for (uint32_t i = 0; i < 2u; i++) {
            port.n_workers = i == 0u ? 0u : SMR_WORKERS_MAX + 1u;
            assert_int_equal(SMR_E_CONFIG, smr_prepare_bytes(&one, 1, &config, &bytes));
        }
        p.drop = 0;
        assert_goes_on(s, twin);
    }
}

/* Prepares a model, binds points to it and aligns it, on a port. Each is refused when the port broke its contract, and
 * otherwise has the bytes at `want`; NULL: keeps them. */
typedef struct made {
    _Alignas(SMR_ALIGN) unsigned char model[1u << 18];
    float carried[3 * 512];
    smr_align_report found;
} made;

static void make(rig_chaos *chaos, const smr_port *port, made *m, const made *want)
{
    const smr_structure one = {"", ball};
    smr_prepare_config config = rig_radii(2, 25, 15, 0);
    smr_align_config align = smr_align_config_default();
    smr_carry *carry = NULL;
    smr_pose pose;
    size_t bytes, model_bytes;
    uint32_t before = chaos->broken;
    memset(m, 0, sizeof *m);
    config.port = align.port = port;
    assert_int_equal(SMR_OK, smr_prepare_bytes(&one, 1, &config, &bytes));
    smr_status status = smr_prepare(&one, 1, &config, rig_rough(bytes), bytes, m->model, sizeof m->model, &model_bytes);
    assert_int_equal(chaos->broken > before ? SMR_E_STATE : SMR_OK, status);
    if (want != NULL && status == SMR_OK)
        assert_memory_equal(want->model, m->model, model_bytes);
    before = chaos->broken;
    assert_int_equal(SMR_OK, smr_carry_bytes(ball.n_vertices, goal.n_vertices, port->n_workers, &bytes));
    status = smr_carry_fit(ball.xyz, ball.n_vertices, goal.xyz, goal.n_vertices, port, rig_rough(bytes), bytes, &carry);
    if (status == SMR_OK)
        status = smr_carry_apply(carry, ball.xyz, m->carried);
    assert_int_equal(chaos->broken > before ? SMR_E_STATE : SMR_OK, status);
    if (want != NULL && status == SMR_OK)
        assert_memory_equal(want->carried, m->carried, sizeof m->carried);
    before = chaos->broken;
    align.samples = 64;
    assert_int_equal(SMR_OK, smr_align_bytes(&align, &bytes));
    status = smr_align(rig_surface(&ball), rig_surface(&goal), &align, rig_rough(bytes), bytes, &pose, &m->found);
    assert_int_equal(chaos->broken > before ? SMR_E_STATE : SMR_OK, status);
    if (want != NULL && status == SMR_OK)
        assert_memory_equal(&want->found, &m->found, sizeof m->found);
}

TEST(other_calls_in_chaos)
{
    static made want, m;
    const float off[3] = {5, 3, -2};
    rig_chaos chaos;
    uint32_t broken = 0;
    for (uint32_t i = 0; i < 40u; i++) {
        ball = rig_ball(30, 12, 14, none);
        goal = rig_ball(35, 12, 16, off);
        assert_true(goal.n_vertices <= 512u);
        const smr_port port = rig_chaos_port(&chaos, i + 1u, 2, i == 0u ? 0u : 15u);
        make(&chaos, &port, i == 0u ? &want : &m, i == 0u ? NULL : &want);
        broken += chaos.broken;
        rig_free_all();
    }
    assert_true(broken > 20u);
}

TEST(refuses_a_copied_arena)
{
    port_state p;
    float xyz[3 * 1024];
    smr_structure_report part;
    smr *s = start(&p, 1), *copy = rig_alloc(sizeof *s);
    (void)rig_run(s, 2);
    memcpy(copy, s, sizeof *s);
    assert_true(ball.n_vertices <= 1024u);
    assert_int_equal(0, meddle(copy, p.surface));
    assert_int_equal(SMR_E_STATE, smr_get_positions(copy, 0, xyz));
    assert_int_equal(SMR_E_STATE, smr_get_normals(copy, 0, xyz));
    assert_int_equal(SMR_E_STATE, smr_get_structure_report(copy, 0, &part));
    assert_true(smr_state_hash(copy) == 0u);
    assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
}
