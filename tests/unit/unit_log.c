/* unit_log.c: a small registration, its inputs and its log.
 * SPDX-License-Identifier: MIT */
#include "unit/unit_log.h"
#include <string.h>
#include "property/rig.h"
#include "log/record/log_format.h"

smr *unit_log_begin(const unit_log *u, const smr_port *port) { return rig_init(u->model, &u->config, port); }

static void ticks(const unit_log *u, smr *s, uint32_t n, uint32_t *seed)
{
    for (uint32_t i = 0; i < (u->small ? 1u : n); i++)
        (void)smr_tick(s, 5000u * (100u + rig_random(seed, 900)), NULL);
}

/* The ball, its targets, the model and what both recordings have of the configuration. */
static void make_scene(unit_log *u, int small)
{
    const float none[3] = {0, 0, 0}, off[3] = {4, -3, 2};
    const smr_prepare_config prepare = rig_radii(2, 40.0f, 15.0f, 0.0f);
    memset(u, 0, sizeof *u);
    u->small = small;
    u->ball = rig_ball(30.0f, small ? 3u : 8u, small ? 5u : 12u, none);
    for (uint32_t i = 0; i < 2u; i++) {
        u->goal[i] = rig_ball(33.0f - 7.0f * (float)i, small ? 5u : 9u, small ? 8u : 14u, i == 0u ? off : none);
        u->surface[i] = rig_surface(&u->goal[i]);
    }
    u->model = rig_model(&u->ball, 1, &prepare);
    u->config = smr_config_default();
    u->config.basic.n_target_vertices = 200;
    u->config.basic.iterations = 30;
    u->config.motion.settle_um = 0.0f;
}

static void end_log(unit_log *u, const smr *s)
{
    smr_log_state state = {0, 0, 0};
    (void)smr_get_log(s, &state);
    u->bytes = state.bytes;
    u->ticks = state.n_ticks;
}

void unit_log_make(unit_log *u)
{
    const smr_pose pose = {{{1, 0, 0, 1.5f}, {0, 1, 0, -0.5f}, {0, 0, 1, 0}}};
    rig_clock clock;
    const smr_port port = rig_clock_port(&clock, RIG_CLOCK_STEADY, 35000);
    uint32_t seed = 5;
    make_scene(u, 0);
    smr *s = unit_log_begin(u, &port);
    (void)smr_set_log(s, u->log, sizeof u->log);
    (void)smr_set_pose(s, &pose);
    (void)smr_set_surface(s, SMR_ALL, u->surface[0]);
    ticks(u, s, 20, &seed);
    (void)smr_set_surface(s, SMR_ALL, u->surface[1]);
    ticks(u, s, 20, &seed);
    end_log(u, s);
}

/* ---- every kind */

static void spring(void *ctx, const smr_force_view *view, float *way, float *weight)
{
    for (uint32_t i = 0; i < view->n; i++) {
        way[3u * i] += 0.1f * (*(const float *)ctx - view->xyz[3u * i]);
        weight[i] += 0.3f;
    }
}

static void make_inputs(unit_log *u)
{
    static float plane = 4.0f;
    const uint32_t n = u->ball.n_vertices;
    u->force = (smr_caller_force){spring, &plane};
    for (uint32_t i = 0; i < 2u; i++) {
        size_t bytes = 0;
        float *xyz = rig_alloc(3u * n * sizeof *xyz), *weights = rig_alloc(n * sizeof *weights);
        for (uint32_t k = 0; k < 3u * n; k++)
            xyz[k] = u->ball.xyz[k] * (1.05f + 0.02f * (float)i);
        for (uint32_t k = 0; k < n; k++)
            weights[k] = 0.2f * (float)(k % 3u);
        u->goals[i] = (smr_goals){xyz, i == 0u ? NULL : weights};
        (void)smr_points_bytes(40, &bytes);
        (void)smr_points_open(40, rig_alloc(bytes), bytes, &u->cloud[i]);
        (void)smr_points_add(u->cloud[i], u->goal[0].xyz, i == 0u ? NULL : u->goal[0].xyz, NULL, 20u + 10u * i);
    }
}

/* The landmarks' places are `by` away; one is at rest beside the surface, the last is hard. */
static void set_landmarks(smr *s, const unit_log *u, float by)
{
    smr_landmark mark[3] = {{0, 5, {0}, {0}, 2, 0},
                            {SMR_ALL, SMR_NONE, {0, 0, 33}, {0}, 0.5f, 0},
                            {0, 40u % u->ball.n_vertices, {0}, {0}, 0, 1}};
    for (uint32_t i = 0; i < 3u; i++)
        for (uint32_t c = 0; c < 3u; c++)
            mark[i].place[c] = (i == 1u ? mark[i].rest[c] : u->ball.xyz[3u * mark[i].vertex + c]) + by;
    (void)smr_set_landmarks(s, mark, 3);
}

void unit_log_make_kinds(unit_log *u, int small)
{
    const smr_pose pose = {{{1, 0, 0, 1.5f}, {0, 1, 0, -0.5f}, {0, 0, 1, 0}}};
    rig_clock clock;
    const smr_port port = rig_clock_port(&clock, RIG_CLOCK_STEADY, 700);
    uint32_t seed = 6;
    make_scene(u, small);
    make_inputs(u);
    u->config.partial.n_landmarks = 4;
    u->config.caller.goals = 1;
    u->config.caller.force = SMR_CALLER_ON;
    u->config.contact.share = 1.0f;
    u->config.contact.n_fixed = 1;
    u->config.track.mode = SMR_TRACK_RECOVER;
    u->config.track.radius_mm = 15.0f;
    u->config.track.iterations = 4;
    u->config.motion.fusing = SMR_FUSING_LIE;
    u->config.contact.volume = 0.7f;
    u->config.contact.smooth = 0.2f;
    u->config.basic.iterations = 2;
    u->config.basic.iterations_last = 3;
    smr *s = unit_log_begin(u, &port);
    (void)smr_set_log(s, u->log, sizeof u->log);
    (void)smr_set_positions(s, 0, u->ball.xyz);
    (void)smr_set_pose(s, &pose);
    set_landmarks(s, u, 1.0f);
    ticks(u, s, 6, &seed);
    (void)smr_set_volume_ratio(s, 0, 1.1f);
    (void)smr_set_goals(s, 0, u->goals[0].xyz, NULL);
    (void)smr_set_force(s, u->force.force, u->force.ctx);
    ticks(u, s, 8, &seed);
    for (uint32_t i = 0; i < 2u; i++) {
        (void)smr_set_points(s, 0, u->cloud[i]);
        (void)smr_set_volume_ratio(s, SMR_ALL, 0.8f + 0.1f * (float)i);
        (void)smr_set_active(s, 70u * i);
        (void)smr_set_fixed(s, 0, i == 0u ? u->surface[1] : NULL);
        ticks(u, s, 6, &seed);
    }
    set_landmarks(s, u, 2.0f);
    (void)smr_set_goals(s, 0, u->goals[1].xyz, u->goals[1].weights);
    ticks(u, s, 6, &seed);
    (void)smr_set_landmarks(s, NULL, 0);
    (void)smr_set_goals(s, 0, NULL, NULL);
    (void)smr_set_force(s, NULL, NULL);
    (void)smr_set_points(s, SMR_ALL, NULL);
    for (uint32_t i = 0; i < 2u; i++) {
        (void)smr_set_surface(s, SMR_ALL, u->surface[i]);
        ticks(u, s, 6, &seed);
    }
    end_log(u, s);
}

void unit_log_make_motion(unit_log *u)
{
    rig_clock clock;
    const smr_port port = rig_clock_port(&clock, RIG_CLOCK_STEADY, 700);
    uint32_t seed = 7;
    make_scene(u, 0);
    const uint32_t n = u->ball.n_vertices;
    float *mass = rig_alloc(n * sizeof *mass), *velocity = rig_alloc(3u * n * sizeof *velocity);
    for (uint32_t i = 0; i < n; i++)
        mass[i] = 1.0f + (float)(i % 5u);
    for (uint32_t i = 0; i < 3u * n; i++)
        velocity[i] = 20.0f * (float)(i % 3u);
    u->motion = (smr_motion){mass, velocity};
    u->config.dynamics.mode = SMR_DYNAMICS_ON;
    smr *s = unit_log_begin(u, &port);
    (void)smr_set_log(s, u->log, sizeof u->log);
    (void)smr_set_motion(s, 0, mass, velocity);
    ticks(u, s, 12, &seed);
    (void)smr_set_surface(s, SMR_ALL, u->surface[0]);
    ticks(u, s, 12, &seed);
    (void)smr_set_motion(s, 0, mass, velocity);
    ticks(u, s, 12, &seed);
    end_log(u, s);
}

const void *unit_log_input(void *ctx, const smr_log_record *record)
{
    const unit_log *u = ctx;
    switch (record->kind) {
    case SMR_LOG_FIXED_SURFACE:
    case SMR_LOG_SURFACE: return u->surface[record->checksum == smr_surface_checksum(u->surface[1])];
    case SMR_LOG_POINTS: return u->cloud[record->checksum == smr_log_checksum(SMR_LOG_POINTS, u->cloud[1], 0)];
    case SMR_LOG_GOALS: return &u->goals[record->checksum == smr_goals_checksum(&u->goals[1], u->ball.n_vertices)];
    case SMR_LOG_POSITIONS: return u->ball.xyz;
    case SMR_LOG_FORCE: return &u->force;
    case SMR_LOG_MOTION: return &u->motion;
    default: return NULL;
    }
}

uint32_t unit_log_records(const unsigned char *log, size_t bytes)
{
    uint32_t n = 0;
    size_t of_it = 0;
    while (unit_log_record(log, bytes, n, &of_it) > 0u)
        n++;
    return n;
}

size_t unit_log_record(const unsigned char *log, size_t bytes, uint32_t i, size_t *record_bytes)
{
    size_t at = SMR_LOG_HEADER, size = 0;
    for (uint32_t k = 0; at + SMR_LOG_FRAME <= bytes; k++, at += size) {
        size = smr_log_get32(log + at) >> 8;
        if (k == i) {
            *record_bytes = size;
            return at;
        }
    }
    *record_bytes = 0;
    return 0;
}

void unit_log_seal(unsigned char *log, size_t bytes)
{
    uint32_t crc = smr_crc32(0, log, SMR_LOG_HEADER - 4u);
    size_t size = 0;
    smr_log_put32(log + SMR_LOG_HEADER - 4u, crc);
    for (size_t at = SMR_LOG_HEADER; at + SMR_LOG_FRAME <= bytes; at += size) {
        size = smr_log_get32(log + at) >> 8;
        if (size < SMR_LOG_FRAME || size > bytes - at)
            return;
        crc = smr_crc32(crc, log + at, size - 4u);
        smr_log_put32(log + at + size - 4u, crc);
    }
}

unit_log unit_recorded;

int unit_log_set_up(void **state)
{
    (void)state;
    unit_log_make(&unit_recorded);
    return 0;
}

int unit_log_tidy(void **state)
{
    (void)state;
    rig_free_all();
    return 0;
}
