/* save_fields.c: places the slots of a registration, or counts, writes, checks and reads their saved values.
 * Bounds: one pass over the values.
 * SPDX-License-Identifier: MIT */
#include "base/save_fields.h"
#include "base/bytes.h"
#include "base/vec.h"

void *smr_slot_scratch(smr_arena *a, void *now, size_t count, size_t size)
{
    return smr_keeps(a) ? now : smr_arena_take(a, count, size);
}

float *smr_slot_floats(smr_arena *a, float *now, size_t count, float most)
{
    smr_keep_floats(a, now, count, -most, most);
    return smr_slot_scratch(a, now, count, sizeof *now);
}

uint32_t *smr_slot_indexes(smr_arena *a, uint32_t *now, size_t count, uint32_t below)
{
    if (smr_keeps(a))
        a->keeper->calls->words(a->keeper, now, count, below - 1u, 1);
    return smr_slot_scratch(a, now, count, sizeof *now);
}

uint8_t *smr_slot_bytes(smr_arena *a, uint8_t *now, size_t count, uint32_t most)
{
    if (smr_keeps(a))
        a->keeper->calls->bytes(a->keeper, now, count, most);
    return smr_slot_scratch(a, now, count, 1);
}

void smr_keep_words(smr_arena *a, uint32_t *field, size_t count, uint32_t most)
{
    if (smr_keeps(a))
        a->keeper->calls->words(a->keeper, field, count, most, 0);
}

void smr_keep_floats(smr_arena *a, float *field, size_t count, float least, float most)
{
    if (smr_keeps(a))
        a->keeper->calls->floats(a->keeper, field, count, least, most);
}

void smr_keep_long(smr_arena *a, uint64_t *field)
{
    uint32_t half[2] = {(uint32_t)(*field & 0xffffffffu), (uint32_t)(*field >> 32)};
    if (!smr_keeps(a))
        return;
    a->keeper->calls->words(a->keeper, half, 2, UINT32_MAX, 0);
    *field = (uint64_t)half[1] << 32 | half[0];
}

void smr_keep_require(smr_arena *a, int legal)
{
    if (smr_keeps(a) && a->keeper->mode != SMR_KEEP_COUNT)
        a->keeper->wrong |= (uint32_t)!legal;
}

void smr_keep_pose(smr_arena *a, smr_pose *pose, float most)
{
    if (smr_keeps(a))
        a->keeper->calls->pose(a, pose, most);
}

enum { KEPT_BYTE = 1, KEPT_WORD = 4, KEPT_FLOAT = 5 };

/* Adds count, kind and range of values to the checksum k->plan. Returns 1 when the values are to be processed. */
static int begin(smr_keeper *k, size_t count, size_t size, uint32_t kind, uint32_t range)
{
    const uint32_t facts[3] = {smr_le32((uint32_t)count), smr_le32(kind), smr_le32(range)};
    k->plan = smr_crc32(k->plan, facts, sizeof facts);
    if (k->mode == SMR_KEEP_COUNT) {
        k->at += count * size;
        return 0;
    }
    if (k->at > k->bytes || count > (k->bytes - k->at) / size)
        k->wrong = 1;
    return !k->wrong;
}

/* Appends *value to the bytes of a save; in a check or restore reads the next word of those bytes into *value. */
static void word(smr_keeper *k, uint32_t *value)
{
    uint32_t stored = smr_le32(*value);
    if (k->mode == SMR_KEEP_SAVE)
        memcpy(k->to + k->at, &stored, sizeof stored);
    else
        memcpy(&stored, k->from + k->at, sizeof stored);
    *value = smr_le32(stored);
    k->at += sizeof stored;
}

static void words(smr_keeper *k, uint32_t *field, size_t count, uint32_t most, int or_none)
{
    if (!begin(k, count, sizeof *field, KEPT_WORD + 256u * (uint32_t)or_none, most))
        return;
    for (size_t i = 0; i < count; i++) {
        uint32_t value = k->mode == SMR_KEEP_SAVE ? field[i] : 0u;
        word(k, &value);
        k->wrong |= value > most && !(or_none && value == SMR_NONE);
        if (field != NULL)
            field[i] = value;
    }
}

static void floats(smr_keeper *k, float *field, size_t count, float least, float most)
{
    if (!begin(k, count, sizeof *field, KEPT_FLOAT, smr_float_bits(least) + 3u * smr_float_bits(most)))
        return;
    for (size_t i = 0; i < count; i++) {
        uint32_t bits = k->mode == SMR_KEEP_SAVE ? smr_float_bits(field[i]) : 0u;
        word(k, &bits);
        const float value = smr_float_of(bits);
        k->wrong |= !(value >= least && value <= most);
        if (field != NULL)
            field[i] = value;
    }
}

static void bytes(smr_keeper *k, uint8_t *field, size_t count, uint32_t most)
{
    if (!begin(k, count, 1, KEPT_BYTE, most))
        return;
    for (size_t i = 0; i < count; i++, k->at++) {
        if (k->mode == SMR_KEEP_SAVE)
            k->to[k->at] = field[i];
        const uint8_t value = k->mode == SMR_KEEP_SAVE ? field[i] : k->from[k->at];
        k->wrong |= value > most;
        if (field != NULL)
            field[i] = value;
    }
}

/* Returns 1 when the pose's columns are about equally long and at right angles, as bounds of sums demand. */
static int is_similarity(const smr_pose *p)
{
    const smr_vec a = smr_column(p, 0), b = smr_column(p, 1), c = smr_column(p, 2);
    const float size = smr_dot(a, a), most = 1.0e-3f * size;
    return smr_within(smr_dot(b, b) - size, most) && smr_within(smr_dot(c, c) - size, most) &&
           smr_within(smr_dot(a, b), most) && smr_within(smr_dot(b, c), most) && smr_within(smr_dot(c, a), most);
}

static void keep_pose(smr_arena *a, smr_pose *pose, float most)
{
    smr_keep_floats(a, &pose->m[0][0], 12, -most, most);
    smr_keep_require(a, is_similarity(pose));
}

const smr_keep_calls smr_keep_all = {words, floats, bytes, keep_pose};
