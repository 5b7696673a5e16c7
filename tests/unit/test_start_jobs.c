/* test_start_jobs.c: opening a model, setting up, start positions, save, restore and scrub in pieces give the bits of
 * the whole calls, keep other calls out while positions are written, and leave nothing behind where they fail.
 * SPDX-License-Identifier: MIT */
#include "suite.h"

#include <string.h>

#include "property/rig.h"
#include "registration/registration.h"

typedef struct scene {
    const smr_model *model;
    smr_config config;
    smr_surface *target;
    smr_mesh source;
    const float *moved; /* positions of structure 0 */
    smr_job job;
} scene;

static const smr_pose turned = {{{0.98f, -0.1f, 0, 900}, {0.1f, 0.98f, 0, 3}, {0, 0, 0.985f, -2}}};

/* Runs a begun job in pieces of one unit. */
static smr_status run(smr_job *job)
{
    smr_status status = SMR_PARTIAL;
    uint32_t n = 0;
    for (; status == SMR_PARTIAL; n++)
        status = smr_job_step(job, 1, NULL, 0);
    assert_true(status != SMR_OK || n > 10u);
    return status;
}

/* Two bones, of which a target shows one. kind: what the registration has besides. */
static scene start(uint32_t kind)
{
    const smr_prepare_config radii = rig_radii(2, 110, 60, 0);
    const float same[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, aside[3] = {150, 0, 0};
    scene e = {.config = smr_config_default()};
    smr_mesh target;
    rig_bone(6000, 1.0f, &e.source, &target);
    const smr_mesh both[2] = {e.source, rig_moved(&e.source, same, aside)};
    e.model = rig_model(both, 2, &radii);
    e.target = rig_surface(&target);
    float *const moved = rig_alloc(12u * (size_t)e.source.n_vertices);
    for (uint32_t i = 0; i < 3u * e.source.n_vertices; i++)
        moved[i] = e.source.xyz[i] + (i % 3u == 1u ? 700.0f : 0.0f);
    e.moved = moved;
    e.config.basic.n_target_vertices = kind == 3u ? 0u : 2u * target.n_vertices;
    e.config.contact.share = e.config.contact.volume = kind == 1u ? 1.0f : 0.0f;
    e.config.contact.smooth = kind == 1u ? 0.3f : 0.0f;
    e.config.track.mode = kind == 2u ? SMR_TRACK_RECOVER : SMR_TRACK_OFF;
    e.config.track.ahead = kind == 2u ? 0.5f : 0.0f;
    e.config.basic.method = kind == 2u ? SMR_METHOD_POLAR : SMR_METHOD_RIGID;
    e.config.dynamics.mode = kind == 3u ? SMR_DYNAMICS_ON : SMR_DYNAMICS_OFF;
    return e;
}

static smr *init_by(scene *e, int pieces)
{
    size_t bytes;
    smr *s = NULL;
    assert_int_equal(SMR_OK, smr_arena_bytes(e->model, &e->config, &bytes));
    void *const arena = rig_rough(bytes);
    if (!pieces) {
        assert_int_equal(SMR_OK, smr_init(e->model, &e->config, NULL, arena, bytes, &s));
        return s;
    }
    assert_int_equal(SMR_OK, smr_init_begin(e->model, &e->config, NULL, arena, bytes, &s, &e->job));
    assert_null(s);
    assert_int_equal(SMR_OK, run(&e->job));
    return s;
}

static void pose_by(scene *e, smr *s, int pieces)
{
    assert_int_equal(SMR_OK, pieces ? smr_set_pose_begin(s, &turned, &e->job) : smr_set_pose(s, &turned));
    assert_int_equal(SMR_OK, pieces ? run(&e->job) : SMR_OK);
}

static void place_by(scene *e, smr *s, int pieces)
{
    assert_int_equal(SMR_OK,
                     pieces ? smr_set_positions_begin(s, 0, e->moved, &e->job) : smr_set_positions(s, 0, e->moved));
    assert_int_equal(SMR_OK, pieces ? run(&e->job) : SMR_OK);
}

/* Returns the bytes of a save, which hold all that outlives an iteration. */
static unsigned char *save_by(scene *e, smr *s, int pieces, size_t *bytes)
{
    assert_int_equal(SMR_OK, smr_save_bytes(s, bytes));
    unsigned char *const to = rig_alloc(*bytes);
    assert_int_equal(SMR_OK, pieces ? smr_save_begin(s, to, *bytes, &e->job) : smr_save(s, to, *bytes));
    assert_int_equal(SMR_OK, pieces ? run(&e->job) : SMR_OK);
    return to;
}

static smr *restore_by(scene *e, const void *saved, size_t saved_bytes, int pieces)
{
    size_t bytes;
    smr *s = NULL;
    assert_int_equal(SMR_OK, smr_arena_bytes(e->model, &e->config, &bytes));
    void *const arena = rig_rough(bytes);
    if (pieces)
        assert_int_equal(SMR_OK,
                         smr_restore_begin(e->model, NULL, NULL, saved, saved_bytes, arena, bytes, &s, &e->job));
    assert_int_equal(SMR_OK,
                     pieces ? run(&e->job) : smr_restore(e->model, NULL, NULL, saved, saved_bytes, arena, bytes, &s));
    assert_int_equal(SMR_OK, e->config.basic.n_target_vertices > 0u ? smr_set_surface(s, 0, e->target) : SMR_OK);
    return s;
}

TEST(same_bits)
{
    for (uint32_t kind = 0; kind < 4u; kind++) {
        scene e = start(kind);
        unsigned char *saved[2], *again[2];
        uint64_t hash[2];
        size_t bytes[2];
        for (int pieces = 0; pieces < 2; pieces++) {
            smr *s = init_by(&e, pieces);
            if (kind != 3u)
                assert_int_equal(SMR_OK, smr_set_surface(s, 0, e.target));
            (void)rig_run(s, 3);
            pose_by(&e, s, pieces);
            (void)rig_run(s, 3);
            place_by(&e, s, pieces);
            (void)rig_run(s, 3);
            assert_int_equal(SMR_OK, smr_set_scrub_begin(s, SMR_SCRUB_INPUTS, &e.job));
            assert_int_equal(SMR_OK, pieces ? run(&e.job) : smr_job_step(&e.job, 0, NULL, 0));
            assert_int_equal(SMR_OK, smr_scrub(s, 0));
            saved[pieces] = save_by(&e, s, pieces, &bytes[pieces]);
            s = restore_by(&e, saved[pieces], bytes[pieces], pieces);
            (void)rig_run(s, 3);
            hash[pieces] = smr_state_hash(s);
            again[pieces] = save_by(&e, s, 1 - pieces, &bytes[pieces]);
        }
        assert_true(bytes[0] == bytes[1] && hash[0] == hash[1]);
        assert_memory_equal(saved[0], saved[1], bytes[0]);
        assert_memory_equal(again[0], again[1], bytes[0]);
    }
}

static smr_status read(smr *s, float *xyz) { return smr_get_positions(s, 1, xyz); }

/* A clock that asks for positions, within a step. */
static struct {
    const smr *s;
    float *xyz;
    smr_status status;
} within;
static uint64_t ask_within(void *ctx)
{
    (void)ctx;
    within.status = smr_get_positions(within.s, 1, within.xyz);
    return 0;
}

/* From the first position written to the end only this job, or a new pose, goes on. */
TEST(kept_out)
{
    scene e = start(3);
    smr *s = init_by(&e, 0);
    smr_energy energy;
    float *const before = rig_alloc(12u * (size_t)e.source.n_vertices), *const xyz = rig_alloc(
                                                                            12u * (size_t)e.source.n_vertices);
    smr_job other;
    assert_int_equal(SMR_OK, read(s, before));
    assert_int_equal(SMR_OK, smr_set_pose_begin(s, &turned, &e.job));
    assert_int_equal(SMR_PARTIAL, smr_job_step(&e.job, 2, NULL, 0)); /* checks alone */
    assert_int_equal(SMR_OK, read(s, xyz));
    assert_memory_equal(before, xyz, 12u * (size_t)e.source.n_vertices);
    for (smr_status status = SMR_OK; status == SMR_OK; status = read(s, xyz))
        assert_int_equal(SMR_PARTIAL, smr_job_step(&e.job, 1, NULL, 0));
    const smr_port asks = {NULL, 1, NULL, ask_within};
    within.s = s;
    within.xyz = xyz;
    assert_int_equal(SMR_PARTIAL, smr_job_step(&e.job, 1, &asks, 1));
    assert_int_equal(SMR_E_STATE, within.status);
    for (uint32_t left = 0; left < 40u; left++) {
        assert_int_equal(SMR_E_STATE, read(s, xyz));
        assert_int_equal(SMR_E_STATE, smr_tick(s, 0, NULL));
        assert_int_equal(SMR_E_STATE, smr_set_surface(s, 0, e.target));
        assert_int_equal(SMR_E_STATE, smr_set_positions(s, 0, e.moved));
        assert_int_equal(SMR_E_STATE, smr_verdict_begin(s, 0, (smr_verdict *)(void *)xyz, &other));
        assert_int_equal(SMR_E_STATE, smr_get_energy(s, &energy));
        assert_true(smr_state_hash(s) == 0u);
        assert_int_equal(SMR_PARTIAL, smr_job_step(&e.job, 1, NULL, 0));
    }
    assert_int_equal(SMR_OK, smr_set_pose_begin(s, &turned, &other));
    assert_int_equal(SMR_E_STATE, smr_job_step(&e.job, 1, NULL, 0));
    assert_int_equal(SMR_OK, run(&other));
    smr *const whole = init_by(&e, 0);
    pose_by(&e, whole, 0);
    assert_true(smr_state_hash(s) == smr_state_hash(whole) && smr_state_hash(s) != 0u);
    assert_int_equal(SMR_OK, smr_set_pose_begin(s, &turned, &e.job));
    assert_int_equal(SMR_PARTIAL, smr_job_step(&e.job, 2, NULL, 0));
    assert_int_equal(SMR_OK, smr_tick(s, 0, NULL)); /* a tick ends a job that has not written */
    assert_int_equal(SMR_E_STATE, smr_job_step(&e.job, 2, NULL, 0));
    assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
}

TEST(refused)
{
    scene e = start(0);
    smr *s = init_by(&e, 0);
    smr *none = NULL;
    const uint64_t hash = smr_state_hash(s);
    float *const far = rig_alloc(12u * (size_t)e.source.n_vertices);
    memcpy(far, e.moved, 12u * (size_t)e.source.n_vertices);
    far[3u * e.source.n_vertices - 1u] = 2.0f * SMR_COORD_MAX;
    assert_int_equal(SMR_OK, smr_set_positions_begin(s, 0, far, &e.job));
    assert_int_equal(SMR_E_INPUT, run(&e.job));
    assert_true(smr_state_hash(s) == hash);
    assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
    size_t bytes, arena_bytes;
    unsigned char *const saved = save_by(&e, s, 0, &bytes);
    assert_int_equal(SMR_OK, smr_arena_bytes(e.model, &e.config, &arena_bytes));
    void *const arena = rig_rough(arena_bytes);
    saved[bytes / 2u] ^= 1u;
    assert_int_equal(SMR_OK, smr_restore_begin(e.model, NULL, NULL, saved, bytes, arena, arena_bytes, &none, &e.job));
    assert_int_equal(SMR_E_SAVE, run(&e.job));
    assert_null(none);
    assert_int_equal(SMR_E_ARENA, smr_init_begin(e.model, &e.config, NULL, arena, arena_bytes - 1u, &none, &e.job));
    saved[bytes / 2u] ^= 1u;
    assert_int_equal(SMR_OK, smr_save_begin(s, saved, bytes, &e.job));
    assert_int_equal(SMR_PARTIAL, smr_job_step(&e.job, 1, NULL, 0));
    assert_int_equal(SMR_OK, smr_tick(s, 0, NULL)); /* which ends the save */
    assert_int_equal(SMR_E_STATE, smr_job_step(&e.job, 1, NULL, 0));
    assert_int_equal(SMR_OK, smr_set_surface(s, 0, e.target));
    assert_int_equal(SMR_OK, smr_save_begin(s, saved, bytes, &e.job));
    assert_int_equal(SMR_OK, smr_surface_refit(e.target, e.target->xyz)); /* an input that is being built */
    assert_int_equal(SMR_E_STATE, smr_job_step(&e.job, 1, NULL, 0));
    assert_int_equal(SMR_OK, smr_set_surface(s, 0, NULL));
    const smr_pose flat = {{{0}}};
    assert_int_equal(SMR_E_INPUT, smr_set_pose_begin(s, &flat, &e.job));
    assert_int_equal(SMR_E_NULL, smr_set_pose_begin(s, NULL, &e.job));
    assert_int_equal(SMR_E_NULL, smr_set_positions_begin(s, 0, far, NULL));
    assert_int_equal(SMR_E_NULL, smr_save_begin(s, NULL, bytes, &e.job));
    assert_int_equal(SMR_E_NULL, smr_set_scrub_begin(s, 0, NULL));
    assert_int_equal(SMR_OK, smr_set_pose_begin(s, &turned, &e.job));
    assert_int_equal(SMR_PARTIAL, smr_job_step(&e.job, 60, NULL, 0));
    s->schedule.iteration ^= 1u;
    assert_int_equal(SMR_E_DAMAGED, smr_job_step(&e.job, 1, NULL, 0));
}

/* A model is opened in pieces like at once, and a changed byte is found. */
TEST(opened)
{
    scene e = start(0);
    smr_model_info info;
    const smr_model *model = NULL;
    assert_int_equal(SMR_OK, smr_model_get_info(e.model, &info));
    unsigned char *const copy = rig_alloc(info.bytes);
    memcpy(copy, e.model, info.bytes);
    assert_int_equal(SMR_OK, smr_model_open_begin(copy, info.bytes, &model, &e.job));
    assert_null(model);
    assert_int_equal(SMR_OK, run(&e.job));
    assert_ptr_equal(copy, model);
    model = NULL;
    copy[info.bytes / 2u] ^= 1u;
    assert_int_equal(SMR_OK, smr_model_open_begin(copy, info.bytes, &model, &e.job));
    assert_int_equal(SMR_E_MODEL, run(&e.job));
    assert_null(model);
    assert_int_equal(SMR_E_NULL, smr_model_open_begin(copy, info.bytes, &model, NULL));
}
