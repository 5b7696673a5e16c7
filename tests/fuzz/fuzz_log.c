/* fuzz_log.c: any bytes as the records of a log, or as the configuration in its header, are refused or replayed without
 * harm. The rest of the header is valid and checksums are repaired first, so that the fuzzer gets past them. Runs as a
 * regression test in tests/unit/test_fuzz.c, as a fuzzer by `make fuzz`.
 * SPDX-License-Identifier: MIT */
#include "fuzz/fuzz_targets.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "property/rig.h"
#include "log/record/log_format.h"
#include "unit/unit_log.h"

#define FUZZ_LOG_RECORDS 8192u /* bytes at most */

/* The bytes as the configuration of a log of either version: refused, or a configuration that replay compares. */
static void fuzz_header(const unit_log *u, const uint8_t *data, size_t size, smr *s)
{
    static unsigned char log[SMR_LOG_FIXED + FUZZ_LOG_RECORDS + 4u];
    const size_t bytes = SMR_LOG_FIXED + size / 4u * 4u + 4u;
    smr_replay replay;
    for (uint32_t version = 1; version <= SMR_LOG_VERSION; version++) {
        memcpy(log, u->log, SMR_LOG_FIXED);
        if (size > 0u)
            memcpy(log + SMR_LOG_FIXED, data, size / 4u * 4u);
        smr_log_put32(log + 4, version);
        smr_log_put32(log + 8, (uint32_t)bytes);
        smr_log_put32(log + 24, (uint32_t)(size / 4u));
        smr_log_put32(log + bytes - 4u, smr_crc32(0, log, bytes - 4u));
        (void)smr_replay_start(s, log, bytes, NULL, NULL, &replay);
    }
}

int fuzz_log(const uint8_t *data, size_t size)
{
    static unit_log u; /* made once, kept */
    static void *arena;
    static size_t arena_bytes;
    static unsigned char log[SMR_LOG_HEADER + FUZZ_LOG_RECORDS];
    smr_replay replay;
    smr_replay_report report = {0};
    smr *s = NULL;
    if (arena == NULL) {
        unit_log_make_kinds(&u, 1);
        (void)smr_arena_bytes(u.model, &u.config, &arena_bytes);
        arena = rig_alloc(arena_bytes);
    }
    if (size > FUZZ_LOG_RECORDS)
        return 0;
    memcpy(log, u.log, SMR_LOG_HEADER);
    if (size > 0u)
        memcpy(log + SMR_LOG_HEADER, data, size);
    unit_log_seal(log, SMR_LOG_HEADER + size);
    if (smr_init(u.model, &u.config, NULL, arena, arena_bytes, &s) == SMR_OK)
        fuzz_header(&u, data, size, s);
    if (s == NULL || smr_replay_start(s, log, SMR_LOG_HEADER + size, unit_log_input, &u, &replay) != SMR_OK) {
        (void)fprintf(stderr, "fuzz_log: a good header is refused\n");
        return -1;
    }
    smr_status status = SMR_OK;
    for (size_t ticks = 0; status == SMR_OK && !report.ended; ticks++) {
        status = smr_replay_tick(&replay, &report);
        if (ticks > size / SMR_LOG_FRAME + 1u) {
            (void)fprintf(stderr, "fuzz_log: it does not end\n");
            return -1;
        }
    }
    float *xyz = malloc(3u * u.ball.n_vertices * sizeof *xyz);
    const int good = xyz != NULL && smr_get_positions(s, 0, xyz) == SMR_OK && rig_finite(xyz, u.ball.n_vertices);
    free(xyz);
    return good ? status == SMR_OK : -1;
}

SMR_FUZZER(fuzz_log)
