/* log.c: writes down what was done to a registration: each input that is set, each tick and how far it came. That and the
 * inputs is all that decides the bits (replay.c), so a run whose ticks were cut by the clock can be repeated anywhere.
 * Bytes are little-endian, records are only ever added, and each one's checksum goes on from the one before: what a device
 * wrote until it lost power can be read up to its last record. Layout: docs/SPEC.md.
 * Bounds: SMR_LOG_WORDS; SMR_LOG_CONFIG_WORDS for the header.
 * SPDX-License-Identifier: MIT */
#include "runtime/record/log.h"

_Static_assert(SMR_LOG_BYTES(0, 0) >= SMR_LOG_HEADER + SMR_LOG_FULL_BYTES, "SMR_LOG_BYTES is too small");

uint32_t smr_log_words(uint32_t kind)
{
    switch (kind) {
    case SMR_LOG_TICK: return 8;
    case SMR_LOG_SURFACE: return 4;
    case SMR_LOG_VOLUME: return 3;
    case SMR_LOG_POSE: return 12;
    case SMR_LOG_POSITIONS: return 3;
    case SMR_LOG_ACTIVE:
    case SMR_LOG_FULL: return 1;
    default: return 0;
    }
}

/* The room is there. */
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
static void put(smr *s, uint32_t kind, const uint32_t *word)
{
    smr_log *log = &s->log;
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

/* 1 when there is a log; whatever is logged ends the state in which one may be set. */
static int logs(smr *s)
{
    s->fresh = 0;
    return s->log.memory != NULL;
}

static uint32_t high(uint64_t v) { return (uint32_t)(v >> 32); }
static uint32_t low(uint64_t v) { return (uint32_t)(v & 0xffffffffu); }

void smr_log_surface(smr *s, uint32_t structure, const smr_surface *surface)
{
    if (!logs(s))
        return;
    const uint64_t sum = surface == NULL ? 0u : smr_surface_checksum(surface);
    const uint32_t word[4] = {structure, surface != NULL, low(sum), high(sum)};
    put(s, SMR_LOG_SURFACE, word);
}

void smr_log_volume(smr *s, const smr_volume *volume)
{
    if (!logs(s))
        return;
    const uint64_t sum = volume == NULL ? 0u : smr_volume_checksum(volume);
    const uint32_t word[3] = {volume != NULL, low(sum), high(sum)};
    put(s, SMR_LOG_VOLUME, word);
}

void smr_log_pose(smr *s, const smr_pose *pose)
{
    uint32_t word[12];
    if (!logs(s))
        return;
    for (uint32_t i = 0; i < 12u; i++)
        word[i] = smr_float_bits(pose->m[i / 4u][i % 4u]);
    put(s, SMR_LOG_POSE, word);
}

void smr_log_positions(smr *s, uint32_t structure, const float *xyz)
{
    if (!logs(s))
        return;
    const uint64_t sum = smr_points_checksum(xyz, s->part[structure].n_vertices);
    const uint32_t word[3] = {structure, low(sum), high(sum)};
    put(s, SMR_LOG_POSITIONS, word);
}

void smr_log_active(smr *s, uint32_t n_active)
{
    if (logs(s))
        put(s, SMR_LOG_ACTIVE, &n_active);
}

/* So many vertices' forces were looked for in the iteration under way, or in the last one. */
static uint32_t evaluated(const smr *s, int complete)
{
    if (complete)
        return s->report.n_taken;
    if (smr_steps[s->step].run == smr_force_search)
        return smr_min_u32(s->next_task * smr_force_chunk(s), s->n_active);
    return s->step > 0u && (!smr_forces_pending(s) || smr_steps[s->step].run == smr_force_take) ? s->n_active : 0u;
}

void smr_log_tick(smr *s, smr_status status)
{
    if (!logs(s))
        return;
    const smr_tick_report *r = &s->report;
    const int complete = status == SMR_OK;
    const uint32_t word[8] = {(uint32_t)complete | r->done << 1 | r->phase << 8,
                              r->iteration,
                              r->n_taken,
                              evaluated(s, complete),
                              r->n_forces,
                              r->plastic_updates,
                              low(r->state_hash),
                              high(r->state_hash)};
    put(s, SMR_LOG_TICK, word);
}

static void write_header(smr *s)
{
    smr_log *log = &s->log;
    const uint32_t version = SMR_VERSION_MAJOR << 16 | SMR_VERSION_MINOR << 8 | SMR_VERSION_PATCH;
    const uint32_t fixed[SMR_LOG_FIXED / 4u] = {
        SMR_LOG_MAGIC, SMR_LOG_VERSION,     SMR_LOG_HEADER, version, smr_le32(s->model->checksum),
        s->n,          SMR_LOG_CONFIG_WORDS};
    for (uint32_t i = 0; i < SMR_LOG_FIXED / 4u; i++)
        smr_log_put32(log->memory + 4u * i, fixed[i]);
    smr_log_put_config(log->memory + SMR_LOG_FIXED, &s->config);
    log->crc = smr_crc32(0, log->memory, SMR_LOG_HEADER - 4u);
    smr_log_put32(log->memory + SMR_LOG_HEADER - 4u, log->crc);
    log->used = SMR_LOG_HEADER;
}

smr_status smr_set_log(smr *s, void *memory, size_t bytes)
{
    if (s == NULL)
        return SMR_E_NULL;
    if (!smr_valid(s) || (memory != NULL && !s->fresh))
        return SMR_E_STATE;
    if (memory != NULL && bytes < SMR_LOG_HEADER + SMR_LOG_FULL_BYTES)
        return SMR_E_ARENA;
    memset(&s->log, 0, sizeof s->log);
    if (memory == NULL)
        return SMR_OK;
    s->log.memory = memory;
    s->log.bytes = bytes;
    write_header(s);
    return SMR_OK;
}

smr_status smr_get_log(const smr *s, smr_log_state *state)
{
    if (s == NULL || state == NULL)
        return SMR_E_NULL;
    if (!smr_valid(s))
        return SMR_E_STATE;
    state->bytes = s->log.used;
    state->n_ticks = s->log.n_ticks;
    state->full = s->log.full;
    return SMR_OK;
}
