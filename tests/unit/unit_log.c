/* unit_log.c: a small registration, its inputs and its log.
 * SPDX-License-Identifier: MIT */
#include "unit/unit_log.h"

#include <string.h>

#include "property/rig.h"
#include "runtime/record/log.h"

smr *unit_log_begin(const unit_log *u, const smr_port *port) { return rig_init(u->model, &u->config, port); }

static void ticks(smr *s, uint32_t n, uint32_t *seed)
{
    for (uint32_t i = 0; i < n; i++)
        (void)smr_tick(s, 100u * (100u + rig_random(seed, 900)), NULL);
}

void unit_log_make(unit_log *u)
{
    const float none[3] = {0, 0, 0}, off[3] = {4, -3, 2};
    const smr_pose pose = {{{1, 0, 0, 1.5f}, {0, 1, 0, -0.5f}, {0, 0, 1, 0}}};
    const smr_prepare_config prepare = rig_radii(2, 40.0f, 15.0f, 0.0f);
    rig_clock clock;
    const smr_port port = rig_clock_port(&clock, RIG_CLOCK_STEADY, 700);
    uint32_t seed = 5;
    smr_log_state state = {0, 0, 0};
    memset(u, 0, sizeof *u);
    u->ball = rig_ball(30.0f, 8, 12, none);
    for (uint32_t i = 0; i < 2u; i++) {
        u->goal[i] = rig_ball(33.0f - 7.0f * (float)i, 9, 14, i == 0u ? off : none);
        u->surface[i] = rig_surface(&u->goal[i]);
    }
    u->model = rig_model(&u->ball, 1, &prepare);
    u->config = smr_config_default();
    u->config.n_target_vertices = 200;
    u->config.iterations = 30;
    u->config.settle_um = 0.0f;
    smr *s = unit_log_begin(u, &port);
    (void)smr_set_log(s, u->log, sizeof u->log);
    (void)smr_set_pose(s, &pose);
    (void)smr_set_surface(s, SMR_ALL, u->surface[0]);
    ticks(s, 20, &seed);
    (void)smr_set_surface(s, SMR_ALL, u->surface[1]);
    ticks(s, 20, &seed);
    (void)smr_get_log(s, &state);
    u->bytes = state.bytes;
    u->ticks = state.n_ticks;
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
