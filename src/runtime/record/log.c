/* log.c: writes down what was done to a registration: each input that is set, each tick and how far it came. That and
 * the inputs is all that decides the bits (replay.c), so a run whose ticks were cut by the clock can be repeated
 * anywhere. Bytes are little-endian, records are only ever added, and each one's checksum goes on from the one
 * before: what a device wrote until it lost power can be read up to its last record. Layout: docs/SPEC.md.
 * Bounds: SMR_LOG_WORDS; SMR_LOG_CONFIG_WORDS for the header.
 * SPDX-License-Identifier: MIT */
#include "runtime/record/log.h"

_Static_assert(SMR_LOG_BYTES(1, 0) - SMR_LOG_BYTES(0, 0) == 2u * SMR_LOG_FRAME + 4u * (8u + 3u),
               "a tick, and what a force gave");
_Static_assert(SMR_LOG_BYTES(0, 0) >= SMR_LOG_HEADER + SMR_LOG_FULL_BYTES, "SMR_LOG_BYTES is too small");

uint32_t smr_log_words(uint32_t kind)
{
    switch (kind) {
    case SMR_LOG_TICK: return 8;
    case SMR_LOG_SURFACE:
    case SMR_LOG_POINTS:
    case SMR_LOG_FIXED_SURFACE:
    case SMR_LOG_GOALS: return 4;
    case SMR_LOG_VOLUME:
    case SMR_LOG_FORCE: return 3;
    case SMR_LOG_POSE: return 12;
    case SMR_LOG_MOTION:
    case SMR_LOG_POSITIONS: return 3;
    case SMR_LOG_VOLUME_RATIO: return 2;
    case SMR_LOG_LANDMARKS: return 12;
    case SMR_LOG_ACTIVE:
    case SMR_LOG_FULL: return 1;
    default: return 0;
    }
}

/* Appends a record, for which there is room. */
static void write_record(smr_log *log, uint32_t kind, const uint32_t *word)
{
    const uint32_t n = smr_log_words(kind), bytes = SMR_LOG_FRAME + 4u * n;
    unsigned char *to = log->memory + log->used;
    smr_log_put32(to, kind | bytes << 8);
    for (uint32_t i = 0; i < n; i++)
        smr_log_put32(to + 4u + 4u * i, word[i]);
    log->crc = smr_crc32(log->crc, to, bytes - 4u);
    smr_log_put32(to + bytes - 4u, log->crc);
    log->used += bytes;
}

/* Nothing follows a record that did not fit: a log with a gap would be worth nothing. */
static void put(smr_log *log, uint32_t kind, const uint32_t *word)
{
    const size_t needed = SMR_LOG_FRAME + 4u * (size_t)smr_log_words(kind) + SMR_LOG_FULL_BYTES;
    if (log->full)
        return;
    if (log->bytes - log->used < needed) {
        write_record(log, SMR_LOG_FULL, &kind);
        log->full = 1;
        return;
    }
    write_record(log, kind, word);
    log->n_ticks += kind == SMR_LOG_TICK;
}

/* 1 when there is a log. The registration is no longer as smr_init left it. */
static int logs(smr_log *log)
{
    log->fresh = 0;
    return log->memory != NULL;
}

static uint32_t high(uint64_t v) { return (uint32_t)(v >> 32); }
static uint32_t low(uint64_t v) { return (uint32_t)(v & 0xffffffffu); }

static void put_target(smr_log *log, uint32_t kind, uint32_t structure, int present, uint64_t sum)
{
    const uint32_t word[4] = {structure, present != 0, low(sum), high(sum)};
    put(log, kind, word);
}

void smr_log_surface(smr_log *log, uint32_t structure, const smr_surface *surface)
{
    if (logs(log))
        put_target(log, SMR_LOG_SURFACE, structure, surface != NULL,
                   surface == NULL ? 0u : smr_surface_checksum(surface));
}

void smr_log_fixed(smr_log *log, uint32_t index, const smr_surface *surface)
{
    if (logs(log))
        put_target(log, SMR_LOG_FIXED_SURFACE, index, surface != NULL,
                   surface == NULL ? 0u : smr_surface_checksum(surface));
}

void smr_log_points(smr_log *log, uint32_t structure, const smr_points *points)
{
    if (logs(log))
        put_target(log, SMR_LOG_POINTS, structure, points != NULL, points == NULL ? 0u : smr_cloud_checksum(points));
}

void smr_log_volume(smr_log *log, const smr_volume *volume)
{
    if (!logs(log))
        return;
    const uint64_t sum = volume == NULL ? 0u : smr_volume_checksum(volume);
    const uint32_t word[3] = {volume != NULL, low(sum), high(sum)};
    put(log, SMR_LOG_VOLUME, word);
}

void smr_log_pose(smr_log *log, const smr_pose *pose)
{
    uint32_t word[12];
    if (!logs(log))
        return;
    for (uint32_t i = 0; i < 12u; i++)
        word[i] = smr_float_bits(pose->m[i / 4u][i % 4u]);
    put(log, SMR_LOG_POSE, word);
}

void smr_log_positions(smr_log *log, uint32_t structure, const float *xyz, uint32_t n)
{
    if (!logs(log))
        return;
    const uint64_t sum = smr_points_checksum(xyz, n);
    const uint32_t word[3] = {structure, low(sum), high(sum)};
    put(log, SMR_LOG_POSITIONS, word);
}

void smr_log_motion(smr_log *log, uint32_t structure, const smr_motion *motion, uint32_t n)
{
    if (!logs(log))
        return;
    const uint64_t sum = smr_motion_checksum(motion, n);
    const uint32_t word[3] = {structure, low(sum), high(sum)};
    put(log, SMR_LOG_MOTION, word);
}

/* Each landmark is a record, so that contents stay short. None at all is one of zeros. */
void smr_log_landmarks(smr_log *log, const smr_landmark *landmark, uint32_t n)
{
    if (!logs(log))
        return;
    for (uint32_t i = 0; i < n || i == 0u; i++) {
        uint32_t word[12] = {n, i};
        if (n > 0u) {
            const smr_landmark *l = &landmark[i];
            word[2] = l->structure;
            word[3] = l->vertex;
            for (uint32_t c = 0; c < 3u; c++) {
                word[4u + c] = l->vertex == SMR_NONE ? smr_float_bits(l->rest[c]) : 0u;
                word[7u + c] = smr_float_bits(l->place[c]);
            }
            word[10] = l->hard ? 0u : smr_float_bits(l->weight);
            word[11] = l->hard;
        }
        put(log, SMR_LOG_LANDMARKS, word);
    }
}

void smr_log_goals(smr_log *log, uint32_t structure, const smr_goals *goals, uint32_t n)
{
    if (!logs(log))
        return;
    const uint64_t sum = goals->xyz == NULL ? 0u : smr_goals_checksum(goals, n);
    const uint32_t word[4] = {structure, goals->xyz != NULL, low(sum), high(sum)};
    put(log, SMR_LOG_GOALS, word);
}

void smr_log_force(smr_log *log, int present)
{
    const uint32_t word[3] = {present != 0, 0, 0};
    if (logs(log))
        put(log, SMR_LOG_FORCE, word);
}

void smr_log_gave(smr_log *log, uint64_t sum)
{
    const uint32_t word[3] = {2, low(sum), high(sum)};
    if (logs(log))
        put(log, SMR_LOG_FORCE, word);
}

void smr_log_volume_ratio(smr_log *log, uint32_t structure, float ratio)
{
    const uint32_t word[2] = {structure, smr_float_bits(ratio)};
    if (logs(log))
        put(log, SMR_LOG_VOLUME_RATIO, word);
}

void smr_log_active(smr_log *log, uint32_t n_active)
{
    if (logs(log))
        put(log, SMR_LOG_ACTIVE, &n_active);
}

void smr_log_tick(smr_log *log, const smr_tick_report *r, smr_status status, uint32_t n_evaluated)
{
    if (!logs(log))
        return;
    const uint32_t flags = (uint32_t)(status == SMR_OK) | r->done << 1 | r->details.phase << 8;
    const uint32_t word[8] = {flags,
                              r->iteration,
                              r->details.n_taken,
                              n_evaluated,
                              r->n_forces,
                              r->details.plastic_updates,
                              low(r->state_hash),
                              high(r->state_hash)};
    put(log, SMR_LOG_TICK, word);
}

static void write_header(smr_log *log, const smr_shared *shared)
{
    const uint32_t version = SMR_VERSION_MAJOR << 16 | SMR_VERSION_MINOR << 8 | SMR_VERSION_PATCH;
    const uint32_t fixed[SMR_LOG_FIXED / 4u] = {
        SMR_LOG_MAGIC, SMR_LOG_VERSION,     SMR_LOG_HEADER, version, smr_le32(shared->model->checksum),
        shared->n,     SMR_LOG_CONFIG_WORDS};
    for (uint32_t i = 0; i < SMR_LOG_FIXED / 4u; i++)
        smr_log_put32(log->memory + 4u * i, fixed[i]);
    smr_log_put_config(log->memory + SMR_LOG_FIXED, &shared->config);
    log->crc = smr_crc32(0, log->memory, SMR_LOG_HEADER - 4u);
    smr_log_put32(log->memory + SMR_LOG_HEADER - 4u, log->crc);
    log->used = SMR_LOG_HEADER;
}

void smr_log_end(smr_log *log)
{
    const uint32_t fresh = log->fresh;
    memset(log, 0, sizeof *log);
    log->fresh = fresh;
}

void smr_log_keep(smr_arena *a, smr_log *log)
{
    uint64_t used = log->used;
    smr_keep_long(a, &used);
    smr_keep_require(a, used == 0u || (used >= SMR_LOG_FIXED + 8u && used <= SIZE_MAX));
    log->used = (size_t)used;
    smr_keep_words(a, &log->crc, 1, UINT32_MAX);
    smr_keep_words(a, &log->n_ticks, 1, UINT32_MAX);
    smr_keep_words(a, &log->full, 1, 1);
    smr_keep_words(a, &log->fresh, 1, 1);
}

void smr_log_start(smr_log *log, const smr_shared *shared, void *memory, size_t bytes)
{
    smr_log_end(log);
    log->memory = memory;
    log->bytes = bytes;
    write_header(log, shared);
}
