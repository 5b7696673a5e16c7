/* log_write.c: logs all inputs of a registration, and the end of each tick. Log and inputs determine all bits, so a run
 * that the clock has cut short can be repeated anywhere. Bytes are little-endian, records are appended, each record's
 * checksum continues the one before: after a loss of power the log is readable up to its last record (docs/SPEC.md).
 * Bounds: SMR_LOG_WORDS; SMR_LOG_CONFIG_WORDS for the header.
 * SPDX-License-Identifier: MIT */
#include "log/record/log_format.h"

_Static_assert(SMR_LOG_BYTES(1, 0) - SMR_LOG_BYTES(0, 0) == 2u * SMR_LOG_FRAME + 4u * (8u + 3u), "a tick and a force");
_Static_assert(SMR_LOG_BYTES(0, 0) >= SMR_LOG_HEADER + 8u * SMR_LOG_LATE_WORDS + SMR_LOG_FULL_BYTES, "a header");

uint32_t smr_log_words(uint32_t kind)
{
    static const uint8_t words[] = {
        [SMR_LOG_TICK] = 8,   [SMR_LOG_SURFACE] = 4,   [SMR_LOG_POINTS] = 4,       [SMR_LOG_FIXED_SURFACE] = 4,
        [SMR_LOG_GOALS] = 4,  [SMR_LOG_VOLUME] = 3,    [SMR_LOG_FORCE] = 3,        [SMR_LOG_POSE] = 12,
        [SMR_LOG_MOTION] = 3, [SMR_LOG_POSITIONS] = 3, [SMR_LOG_VOLUME_RATIO] = 2, [SMR_LOG_LANDMARKS] = 12,
        [SMR_LOG_ACTIVE] = 1, [SMR_LOG_FULL] = 1,      [SMR_LOG_ALL_POSITIONS] = 3};
    return kind < sizeof words ? words[kind] : 0u;
}

/* Appends a record to the log, in whose memory there must be room for the record. */
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

/* Appends a record, or SMR_LOG_FULL in place of the first record that does not fit. Nothing follows SMR_LOG_FULL. */
static void put(smr_log *log, uint32_t kind, const uint32_t *word)
{
    if (log->full)
        return;
    log->full = log->bytes - log->used < SMR_LOG_FRAME + 4u * (size_t)smr_log_words(kind) + SMR_LOG_FULL_BYTES;
    write_record(log, log->full ? SMR_LOG_FULL : kind, log->full ? &kind : word);
    log->n_ticks += !log->full && kind == SMR_LOG_TICK;
}

static uint32_t high(uint64_t v) { return (uint32_t)(v >> 32); }
static uint32_t low(uint64_t v) { return (uint32_t)(v & 0xffffffffu); }

/* Logs each landmark as a record of its own. A record of zeros stands for no landmarks. */
static void put_landmarks(smr_log *log, const smr_landmark *landmark, uint32_t n)
{
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

static void put_tick(smr_log *log, const smr_log_of_tick *t)
{
    const smr_tick_report *r = t->report;
    const uint32_t flags = t->complete | r->done << 1 | r->details.phase << 8, taken = r->details.n_taken;
    const uint32_t plastic = r->details.plastic_updates, hash[2] = {low(r->state_hash), high(r->state_hash)};
    const uint32_t word[8] = {flags, r->iteration, taken, t->n_evaluated, r->n_forces, plastic, hash[0], hash[1]};
    put(log, SMR_LOG_TICK, word);
}

/* Logs that an input was set or taken away, with the checksum by which a replay compares it. */
static void put_input(smr_log *log, uint32_t kind, uint32_t number, const void *what, uint32_t n)
{
    const uint64_t sum = smr_log_checksum(kind, what, n);
    const uint32_t present = kind == SMR_LOG_GOALS ? ((const smr_goals *)what)->xyz != NULL : what != NULL;
    const uint32_t bare[3] = {kind == SMR_LOG_VOLUME ? present : number, low(sum), high(sum)};
    const uint32_t whole[4] = {number, present, low(sum), high(sum)};
    put(log, kind, smr_log_words(kind) == 4u ? whole : bare);
}

void smr_log_write(smr_log *log, uint32_t kind, uint32_t number, const void *what, uint32_t n)
{
    uint32_t word[SMR_LOG_WORDS] = {number};
    switch (kind) {
    case SMR_LOG_TICK: put_tick(log, what); return;
    case SMR_LOG_LANDMARKS: put_landmarks(log, what, n); return;
    case SMR_LOG_POSE: memcpy(word, what, sizeof(smr_pose)); break;
    case SMR_LOG_VOLUME_RATIO: memcpy(word + 1, what, sizeof(float)); break;
    case SMR_LOG_FORCE:
        word[1] = what != NULL ? low(*(const uint64_t *)what) : 0u;
        word[2] = what != NULL ? high(*(const uint64_t *)what) : 0u;
        break;
    case SMR_LOG_ACTIVE: break;
    default: put_input(log, kind, number, what, n); return;
    }
    put(log, kind, word);
}

void smr_log_end(smr_log *log)
{
    const uint32_t fresh = log->fresh, changes = log->changes;
    memset(log, 0, sizeof *log);
    log->fresh = fresh;
    log->changes = changes;
}

void smr_log_start(smr_log *log, const smr_shared *shared, void *memory, size_t bytes)
{
    const uint32_t version = SMR_VERSION_MAJOR << 16 | SMR_VERSION_MINOR << 8 | SMR_VERSION_PATCH;
    const uint32_t n_config = smr_log_config_words(&shared->config), header = SMR_LOG_FIXED + 4u * n_config + 4u;
    const uint32_t fixed[SMR_LOG_FIXED / 4u] = {
        SMR_LOG_MAGIC, SMR_LOG_VERSION, header, version, smr_le32(shared->model->checksum), shared->n, n_config};
    smr_log_end(log);
    log->memory = memory;
    log->write = smr_log_write;
    log->bytes = bytes;
    for (uint32_t i = 0; i < SMR_LOG_FIXED / 4u; i++) /* the words before the configuration */
        smr_log_put32(log->memory + 4u * i, fixed[i]);
    smr_log_put_config(log->memory + SMR_LOG_FIXED, &shared->config);
    log->crc = smr_crc32(0, log->memory, header - 4u);
    smr_log_put32(log->memory + header - 4u, log->crc);
    log->used = header;
}
