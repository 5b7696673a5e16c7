/* log_read.c: reads a log, record by record. The bytes may come from anywhere: each length, kind and flag is checked
 * before use, and each record advances the reader, so that reading ends.
 * SPDX-License-Identifier: MIT */
#include "log/record/log_format.h"

/* Returns the offset of the first record; 0 when the header's lengths disagree with each other or with `bytes`. */
static size_t header_bytes(const unsigned char *at, size_t bytes)
{
    if (bytes < SMR_LOG_FIXED + 4u || smr_log_get32(at) != SMR_LOG_MAGIC)
        return 0;
    const uint32_t header = smr_log_get32(at + 8), n_config = smr_log_get32(at + 24);
    return header <= bytes && n_config <= header / 4u && header == SMR_LOG_FIXED + 4u * n_config + 4u ? header : 0u;
}

smr_status smr_log_open(const void *log, size_t bytes, smr_log_reader *reader, smr_log_info *info)
{
    const unsigned char *at = log;
    smr_config config;
    if (log == NULL || reader == NULL)
        return SMR_E_NULL;
    const size_t header = header_bytes(at, bytes);
    if (header == 0u || smr_log_get32(at + header - 4u) != smr_crc32(0, at, header - 4u) ||
        smr_log_get_config(at + SMR_LOG_FIXED, smr_log_get32(at + 24), smr_log_get32(at + 4), &config) != SMR_OK)
        return SMR_E_LOG;
    *reader = (smr_log_reader){at, bytes, header, smr_log_get32(at + header - 4u)};
    if (info != NULL)
        *info = (smr_log_info){smr_log_get32(at + 12), smr_log_get32(at + 16), smr_log_get32(at + 20), config};
    return SMR_OK;
}

static uint64_t joined(const uint32_t *word) { return (uint64_t)word[1] << 32 | word[0]; }

static smr_status take_tick(const uint32_t *word, smr_log_record *r)
{
    r->complete = word[0] & 1u;
    r->done = word[0] >> 1 & 1u;
    r->phase = word[0] >> 8;
    r->iteration = word[1];
    r->n_taken = word[2];
    r->n_evaluated = word[3];
    r->n_forces = word[4];
    r->plastic_updates = word[5];
    r->state_hash = joined(word + 6);
    return (word[0] & 0xfcu) == 0u && r->phase < SMR_PHASES && (!r->complete || r->phase == 0u) ? SMR_OK : SMR_E_LOG;
}

static smr_status take_landmark(const uint32_t *word, smr_log_record *r)
{
    r->count = word[0];
    r->index = word[1];
    if (r->count == 0u)
        return r->index == 0u ? SMR_OK : SMR_E_LOG;
    r->landmark.structure = word[2];
    r->landmark.vertex = word[3];
    for (uint32_t c = 0; c < 3u; c++) {
        r->landmark.rest[c] = smr_float_of(word[4u + c]);
        r->landmark.place[c] = smr_float_of(word[7u + c]);
    }
    r->landmark.weight = smr_float_of(word[10]);
    r->landmark.hard = word[11];
    return r->index < r->count && r->count <= SMR_LANDMARKS_MAX && word[11] <= 1u ? SMR_OK : SMR_E_LOG;
}

/* Reads a force record. word[0]: 0: the force was taken away; 1: it was set; 2: the checksum of its output follows. */
static smr_status take_force(const uint32_t *word, smr_log_record *r)
{
    r->present = word[0] == 1u;
    r->gave = word[0] == 2u;
    r->checksum = joined(word + 1);
    return word[0] <= 2u && (r->gave || r->checksum == 0u) ? SMR_OK : SMR_E_LOG;
}

static smr_status take(const uint32_t *word, smr_log_record *r)
{
    switch (r->kind) {
    case SMR_LOG_TICK: return take_tick(word, r);
    case SMR_LOG_LANDMARKS: return take_landmark(word, r);
    case SMR_LOG_FORCE: return take_force(word, r);
    case SMR_LOG_FULL: return SMR_OK;
    case SMR_LOG_ACTIVE: r->n_taken = word[0]; return SMR_OK;
    case SMR_LOG_VOLUME_RATIO:
        r->structure = word[0];
        r->ratio = smr_float_of(word[1]); /* stored unchecked: smr_set_volume_ratio() checks the ratio */
        return SMR_OK;
    case SMR_LOG_POSE: memcpy(&r->pose, word, sizeof r->pose); return SMR_OK;
    }
    const int owned = r->kind == SMR_LOG_POSITIONS || r->kind == SMR_LOG_MOTION || r->kind == SMR_LOG_ALL_POSITIONS;
    const int image = r->kind == SMR_LOG_VOLUME;
    *(r->kind == SMR_LOG_FIXED_SURFACE ? &r->index : &r->structure) = image ? 0u : word[0];
    r->present = owned ? 1u : word[image ? 0 : 1];
    r->checksum = joined(word + (owned || image ? 1 : 2));
    return r->present > 1u || (r->checksum != 0u) != (r->present == 1u) ? SMR_E_LOG : SMR_OK;
}

smr_status smr_log_next(smr_log_reader *reader, smr_log_record *record)
{
    uint32_t word[SMR_LOG_WORDS] = {0};
    if (reader == NULL || record == NULL)
        return SMR_E_NULL;
    memset(record, 0, sizeof *record);
    if (reader->log == NULL || reader->at > reader->bytes)
        return SMR_E_LOG;
    const size_t left = reader->bytes - reader->at;
    const unsigned char *at = reader->log + reader->at;
    if (left == 0u)
        return SMR_OK;
    if (left < SMR_LOG_FRAME)
        return SMR_E_LOG;
    const uint32_t head = smr_log_get32(at), n = smr_log_words(head & 255u), bytes = SMR_LOG_FRAME + 4u * n;
    if (n == 0u || head >> 8 != bytes || left < bytes)
        return SMR_E_LOG;
    const uint32_t crc = smr_crc32(reader->checksum, at, bytes - 4u);
    if (smr_log_get32(at + bytes - 4u) != crc)
        return SMR_E_LOG;
    for (uint32_t i = 0; i < n; i++)
        word[i] = smr_log_get32(at + 4u + 4u * i);
    smr_log_record r = {.kind = head & 255u};
    SMR_TRY(take(word, &r));
    *record = r;
    reader->at += bytes;
    reader->checksum = crc;
    return SMR_OK;
}
