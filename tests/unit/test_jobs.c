/* test_jobs.c: a call in pieces gives the bits of the whole call, however it is cut and whoever runs the pieces; what
 * changes under a job ends it.
 * SPDX-License-Identifier: MIT */
#include "suite.h"

#include <string.h>

#include "property/rig_cloud.h"
#include "registration/registration.h"

#define RESULT_WORDS 30000u

/* What the calls read and write. */
typedef struct scene {
    smr *s;
    uint32_t structure;
    smr_mesh source, target;
    const smr_surface *surface[2];
    void *scratch;
    smr_carry *carry;
    smr_job job;
    float result[RESULT_WORDS];
} scene;

/* A call: whole, and its begin. Both write to e->result. */
typedef struct call {
    smr_status (*whole)(scene *e);
    smr_status (*begin)(scene *e);
    void (*read)(scene *e); /* NULL: nothing is read from what the call made */
} call;

static smr_status whole_verdict(scene *e)
{
    return smr_get_verdict(e->s, e->structure, (smr_verdict *)(void *)e->result);
}
static smr_status begin_verdict(scene *e)
{
    return smr_verdict_begin(e->s, e->structure, (smr_verdict *)(void *)e->result, &e->job);
}
static smr_status whole_volume(scene *e) { return smr_get_local_volume(e->s, e->structure, 30, e->result); }
static smr_status begin_volume(scene *e) { return smr_local_volume_begin(e->s, e->structure, 30, e->result, &e->job); }
static uint32_t one_of(const scene *e) { return e->structure == SMR_ALL ? 0u : e->structure; }
static smr_status whole_expected(scene *e)
{
    const smr_status status = smr_get_expected_error(e->s, one_of(e), e->result);
    return status != SMR_OK ? status : smr_get_expected_parts(e->s, one_of(e), e->result + 10000, e->result + 20000);
}
static smr_status begin_expected(scene *e)
{
    return smr_expected_begin(e->s, one_of(e), e->result, e->result + 10000, e->result + 20000, &e->job);
}

static smr_status whole_contact(scene *e)
{
    return smr_surface_contact(e->surface[0], e->surface[1], 0.5f, (smr_contact_report *)(void *)e->result);
}
static smr_status begin_contact(scene *e)
{
    return smr_surface_contact_begin(e->surface[0], e->surface[1], 0.5f, (smr_contact_report *)(void *)e->result,
                                     &e->job);
}

static void *scratch_of(scene *e, const smr_align_config *config, size_t *bytes)
{
    assert_int_equal(SMR_OK, smr_align_bytes(config, bytes));
    e->scratch = e->scratch != NULL ? e->scratch : rig_alloc(*bytes);
    smr_arena_release(e->scratch, *bytes);
    memset(e->scratch, 0x5a, *bytes);
    return e->scratch;
}
static smr_align_report *align_report(scene *e) { return (smr_align_report *)(void *)(e->result + 12); }
static smr_status whole_align(scene *e)
{
    size_t bytes;
    smr_align_config config = smr_align_config_default();
    const smr_port port = rig_port(RIG_SHUFFLE, 3);
    config.port = &port;
    void *const memory = scratch_of(e, &config, &bytes);
    return smr_align(e->surface[0], e->surface[1], &config, memory, bytes, (smr_pose *)(void *)e->result,
                     align_report(e));
}
static smr_status begin_align(scene *e)
{
    size_t bytes;
    const smr_align_config config = smr_align_config_default();
    void *const memory = scratch_of(e, &config, &bytes);
    return smr_align_begin(e->surface[0], e->surface[1], &config, memory, bytes, (smr_pose *)(void *)e->result,
                           align_report(e), &e->job);
}

/* The source's vertices carry those of the target. */
#define CARRIED 500u
static smr_status carry_it(scene *e, const smr_port *port, int whole)
{
    size_t bytes;
    const uint32_t n = e->source.n_vertices;
    assert_int_equal(SMR_OK, smr_carry_bytes(n, CARRIED, port->n_workers, &bytes));
    e->scratch = rig_rough(bytes);
    return whole ? smr_carry_fit(e->source.xyz, n, e->target.xyz, CARRIED, port, e->scratch, bytes, &e->carry)
                 : smr_carry_fit_begin(e->source.xyz, n, e->target.xyz, CARRIED, port, e->scratch, bytes, &e->carry,
                                       &e->job);
}
static smr_status whole_carry(scene *e)
{
    const smr_port port = rig_port(RIG_INTERLEAVE, 2);
    return carry_it(e, &port, 1);
}
static smr_status begin_carry(scene *e)
{
    const smr_port port = rig_port(RIG_PLAIN, 3);
    return carry_it(e, &port, 0);
}
static void read_carry(scene *e) { assert_int_equal(SMR_OK, smr_carry_apply(e->carry, e->source.xyz, e->result)); }

static const call carry = {whole_carry, begin_carry, read_carry}, align = {whole_align, begin_align, NULL};
static const call contact = {whole_contact, begin_contact, NULL};
static const call volume = {whole_volume, begin_volume, NULL}, verdict = {whole_verdict, begin_verdict, NULL},
                  expected = {whole_expected, begin_expected, NULL};

/* Runs a begun job in slices of `units`. Returns the number of slices. */
static uint32_t run(scene *e, uint32_t units, const smr_port *port)
{
    smr_status status = SMR_PARTIAL;
    uint32_t slices = 0;
    for (; status == SMR_PARTIAL; slices++)
        status = smr_job_step(&e->job, units, port, 0);
    assert_int_equal(SMR_OK, status);
    assert_int_equal(SMR_OK, smr_job_step(&e->job, units, port, 0)); /* and stays so */
    return slices;
}

/* Makes the next call compute expected errors. */
static void forget(smr *s)
{
    s->judged_turn = 0;
    smr_guard_close(s);
}

/* Compares all ways to cut and to run a call. */
static void check_call(scene *e, const call *c)
{
    static const uint32_t units[] = {0, 1, 7};
    float *const whole = rig_alloc(sizeof e->result);
    uint32_t slices[3];
    memset(e->result, 0, sizeof e->result);
    assert_int_equal(SMR_OK, c->whole(e));
    if (c->read != NULL)
        c->read(e);
    memcpy(whole, e->result, sizeof e->result);
    for (uint32_t workers = 1; workers <= 3u; workers++)
        for (uint32_t i = 0; i < 3u; i++) {
            const smr_port port = rig_port(workers == 1u   ? RIG_PLAIN
                                           : workers == 2u ? RIG_REVERSE
                                                           : RIG_SHUFFLE,
                                           workers);
            memset(e->result, 0, sizeof e->result);
            if (e->s != NULL && workers != 2u) /* with two workers expected errors are those of the call before */
                forget(e->s);
            assert_int_equal(SMR_OK, c->begin(e));
            slices[i] = run(e, units[i], workers == 1u ? NULL : &port);
            if (c->read != NULL)
                c->read(e);
            assert_memory_equal(whole, e->result, sizeof e->result);
        }
    assert_true(slices[0] == 1u && slices[1] > 10u && slices[2] <= slices[1] / 7u + 1u);
}

/* Two bones side by side, registered for a while. shown: 0 nothing, 1 surfaces, 2 a cloud, 3 landmarks. */
static scene *start(uint32_t shown)
{
    const smr_prepare_config radii = rig_radii(2, 110, 60, 0);
    const float same[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, aside[3] = {150, 0, 0};
    scene *const e = rig_alloc(sizeof *e);
    smr_config config = smr_config_default();
    rig_bone(8000, 1.0f, &e->source, &e->target);
    const smr_mesh both[2] = {e->source, rig_moved(&e->source, same, aside)};
    config.partial.n_landmarks = 8;
    config.basic.n_target_vertices = 2u * e->target.n_vertices;
    e->s = rig_init(rig_model(both, 2, &radii), &config, NULL);
    if (shown == 1u)
        assert_int_equal(SMR_OK, smr_set_surface(e->s, 0, rig_surface(&e->target)));
    if (shown == 2u) {
        smr_points *const cloud = rig_cloud(e->target.n_vertices);
        assert_int_equal(SMR_OK, smr_points_add(cloud, e->target.xyz, NULL, NULL, e->target.n_vertices));
        assert_int_equal(SMR_OK, smr_set_points(e->s, 0, cloud));
    }
    if (shown == 3u) {
        smr_landmark l[8];
        for (uint32_t i = 0; i < 8u; i++) {
            l[i] = (smr_landmark){.structure = 0, .vertex = i * (e->source.n_vertices / 8u), .weight = 1};
            memcpy(l[i].place, e->target.xyz + 3u * (size_t)(i * (e->target.n_vertices / 8u)), sizeof l[i].place);
        }
        assert_int_equal(SMR_OK, smr_set_landmarks(e->s, l, 8));
    }
    (void)rig_run(e->s, 12);
    return e;
}

/* The expected errors that a verdict on all structures leaves are those of a call of its own; a tick changes them. */
static void check_known(scene *e)
{
    float *const known = rig_alloc(sizeof e->result);
    smr_verdict all, one[2];
    for (uint32_t i = 0; i < 4u; i++) {
        e->structure = i % 2u;
        assert_int_equal(SMR_OK, smr_get_verdict(e->s, SMR_ALL, &all));
        if (i >= 2u)
            assert_int_equal(SMR_OK, smr_tick(e->s, 0, NULL));
        memset(e->result, 0, sizeof e->result);
        assert_int_equal(SMR_OK, whole_expected(e));
        assert_int_equal(SMR_OK, smr_get_verdict(e->s, e->structure, &one[0]));
        memcpy(known, e->result, sizeof e->result);
        forget(e->s);
        assert_int_equal(SMR_OK, whole_expected(e));
        assert_memory_equal(known, e->result, sizeof e->result);
        forget(e->s);
        assert_int_equal(SMR_OK, smr_get_verdict(e->s, e->structure, &one[1]));
        assert_memory_equal(&one[0], &one[1], sizeof one[0]);
    }
}

TEST(verdicts)
{
    for (uint32_t shown = 0; shown < 4u; shown++) {
        scene *const e = start(shown);
        check_call(e, &expected);
        check_call(e, &verdict);
        check_call(e, &volume);
        check_known(e);
        e->structure = SMR_ALL;
        check_call(e, &volume);
        check_call(e, &verdict);
    }
}

/* Two bones through each other; a surface that changes ends the job. */
TEST(surfaces)
{
    static const call *const calls[] = {&contact, &align};
    scene *const e = rig_alloc(sizeof *e);
    rig_bone(8000, 1.0f, &e->source, &e->target);
    smr_surface *const refitted = rig_surface(&e->target);
    e->surface[0] = rig_surface(&e->source);
    e->surface[1] = refitted;
    for (uint32_t i = 0; i < 2u; i++) {
        check_call(e, calls[i]);
        assert_true(i == 1u || (e->result[0] > 10.0f && e->result[2] > 1.0e5f && e->result[3] > 1.0e4f));
        assert_true(i == 0u || align_report(e)->model_share > 0.9f);
        assert_int_equal(SMR_OK, calls[i]->begin(e));
        assert_int_equal(SMR_PARTIAL, smr_job_step(&e->job, 3, NULL, 0));
        assert_int_equal(SMR_OK, smr_surface_refit(refitted, e->target.xyz));
        assert_int_equal(SMR_E_STATE, smr_job_step(&e->job, 3, NULL, 0));
        assert_int_equal(SMR_OK, smr_surface_step(refitted, 0, NULL, 0));
        assert_int_equal(SMR_E_STATE, smr_job_step(&e->job, 3, NULL, 0));
    }
}

TEST(carried)
{
    scene *const e = rig_alloc(sizeof *e);
    const smr_port more = rig_port(RIG_PLAIN, 4);
    rig_bone(8000, 1.0f, &e->source, &e->target);
    check_call(e, &carry);
    assert_true(rig_far(e->target.xyz, e->result, CARRIED) < 1.0e-3f);
    assert_int_equal(SMR_OK, begin_carry(e));
    assert_int_equal(SMR_E_CONFIG, smr_job_step(&e->job, 0, &more, 0)); /* scratch of three workers */
    smr_carry *const never = e->carry = NULL;
    float *const far = rig_alloc(12u * (size_t)e->source.n_vertices);
    memcpy(far, e->source.xyz, 12u * (size_t)e->source.n_vertices);
    far[3u * e->source.n_vertices - 1u] = 2.0f * SMR_COORD_MAX;
    e->source.xyz = far;
    assert_int_equal(SMR_OK, begin_carry(e));
    assert_int_equal(SMR_E_INPUT, smr_job_step(&e->job, 0, NULL, 0));
    assert_true(e->carry == never);
}

/* A clock ends a slice after the piece in which the budget ends. */
TEST(budgets)
{
    rig_clock clock = {0};
    const smr_port port = rig_clock_port(&clock, RIG_CLOCK_STEADY, 1000);
    scene *const e = start(1);
    assert_int_equal(SMR_OK, begin_verdict(e));
    assert_int_equal(SMR_PARTIAL, smr_job_step(&e->job, 0, &port, 5000));
    assert_int_equal(6, clock.readings);
    assert_int_equal(SMR_PARTIAL, smr_job_step(&e->job, 2, &port, 5000));
    assert_int_equal(9, clock.readings);
}

static smr_status tick(scene *e) { return smr_tick(e->s, 0, NULL); }
static smr_status partial_tick(scene *e) { return smr_tick(e->s, 1, NULL) == SMR_PARTIAL ? SMR_OK : SMR_E_STATE; }
static smr_status pose(scene *e)
{
    const smr_pose identity = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    return smr_set_pose(e->s, &identity);
}
static smr_status active(scene *e) { return smr_set_active(e->s, 100000); }

/* Ticks, setters and other measures end a job, and nothing else does. */
TEST(stale)
{
    smr_status (*const other[])(scene * e) = {tick,          pose,           active,      whole_volume,
                                              whole_verdict, begin_expected, partial_tick};
    rig_clock clock = {0};
    scene *const e = start(1);
    smr_job never;
    e->s->port = rig_clock_port(&clock, RIG_CLOCK_STEADY, 1000);
    smr_guard_close(e->s);
    for (uint32_t i = 0; i < sizeof other / sizeof other[0]; i++) {
        assert_int_equal(SMR_OK, begin_verdict(e));
        smr_job old = e->job;
        assert_int_equal(SMR_PARTIAL, smr_job_step(&old, 5, NULL, 0));
        assert_int_equal(SMR_OK, smr_get_visible(e->s, 0, (unsigned char *)e->result));
        assert_int_equal(SMR_PARTIAL, smr_job_step(&old, 5, NULL, 0));
        assert_int_equal(SMR_OK, other[i](e));
        assert_int_equal(SMR_E_STATE, smr_job_step(&old, 5, NULL, 0));
        assert_int_equal(SMR_E_STATE, smr_job_step(&old, 5, NULL, 0));
    }
    assert_int_equal(SMR_E_STATE, begin_verdict(e)); /* an iteration is under way */
    memset(&never, 0, sizeof never);
    assert_int_equal(SMR_E_STATE, smr_job_step(&never, 0, NULL, 0));
    assert_int_equal(SMR_E_NULL, smr_job_step(NULL, 0, NULL, 0));
    assert_int_equal(SMR_E_NULL, smr_verdict_begin(e->s, 0, NULL, &never));
    assert_int_equal(SMR_E_NULL, smr_verdict_begin(e->s, 0, (smr_verdict *)(void *)e->result, NULL));
    assert_int_equal(SMR_E_NULL, smr_expected_begin(e->s, 0, NULL, NULL, NULL, &never));
}

/* A local volume that is left anywhere changes no tick, and a fault between two steps is told. */
TEST(left)
{
    uint64_t hash = 0;
    for (uint32_t pieces = 0; pieces < 400u; pieces += 40u) {
        scene *const e = start(1);
        assert_int_equal(SMR_OK, begin_volume(e));
        for (uint32_t i = 0; i < pieces; i++)
            (void)smr_job_step(&e->job, 1, NULL, 0);
        assert_int_equal(SMR_OK, smr_tick(e->s, 0, NULL));
        hash = pieces == 0u ? smr_state_hash(e->s) : hash;
        assert_true(hash == smr_state_hash(e->s));
    }
    scene *const e = start(1);
    assert_int_equal(SMR_OK, begin_verdict(e));
    assert_int_equal(SMR_PARTIAL, smr_job_step(&e->job, 3, NULL, 0));
    e->s->schedule.iteration ^= 1u;
    assert_int_equal(SMR_E_DAMAGED, smr_job_step(&e->job, 3, NULL, 0));
    assert_int_equal(SMR_E_DAMAGED, smr_tick(e->s, 0, NULL));
}

/* A port that leaves out tasks, or has no worker, is refused. */
static void lose(void *ctx, smr_task task, void *arg, uint32_t n_tasks)
{
    (void)ctx;
    for (uint32_t t = 1; t < n_tasks; t++)
        task(arg, t, 0);
}

TEST(ports)
{
    const smr_port bad = {NULL, 2, lose, NULL}, none = {NULL, 0, NULL, NULL};
    scene *const e = start(1);
    assert_int_equal(SMR_OK, begin_verdict(e));
    assert_int_equal(SMR_E_CONFIG, smr_job_step(&e->job, 0, &none, 0));
    assert_int_equal(SMR_E_STATE, smr_job_step(&e->job, 0, &bad, 0));
    assert_int_equal(SMR_E_STATE, smr_job_step(&e->job, 0, NULL, 0));
    assert_int_equal(SMR_OK, whole_verdict(e));
}
