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

/* Marks the values that are listed next as those of a slot, or no longer. */
static void set_slot(smr_arena *a, uint32_t slot)
{
    if (smr_keeps(a))
        a->keeper->slot = slot;
}

float *smr_slot_floats(smr_arena *a, float *now, size_t count, float most)
{
    set_slot(a, 1);
    smr_keep_floats(a, now, count, -most, most);
    set_slot(a, 0);
    return smr_slot_scratch(a, now, count, sizeof *now);
}

uint32_t *smr_slot_indexes(smr_arena *a, uint32_t *now, size_t count, uint32_t below)
{
    set_slot(a, 1);
    if (smr_keeps(a))
        a->keeper->calls->words(a->keeper, now, count, below - 1u, 1);
    set_slot(a, 0);
    return smr_slot_scratch(a, now, count, sizeof *now);
}

uint8_t *smr_slot_bytes(smr_arena *a, uint8_t *now, size_t count, uint32_t most)
{
    set_slot(a, 1);
    if (smr_keeps(a))
        a->keeper->calls->bytes(a->keeper, now, count, most);
    set_slot(a, 0);
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

/* The values first .. last-1 of an array, which begins at byte `at` of a save. */
typedef struct values {
    size_t at, first, last;
} values;

/* Returns the number of values, of `size` bytes each from byte `at` on, that begin before byte `end`. */
static size_t before(size_t at, size_t size, size_t count, size_t end)
{
    const size_t n = end > at ? (end - at - 1u) / size + 1u : 0u;
    return n < count ? n : count;
}

/* Adds count, kind and range of values to the checksum k->plan of a first pass. Returns the values to be processed. */
static values begin(smr_keeper *k, size_t count, size_t size, uint32_t kind, uint32_t range)
{
    const uint32_t facts[3] = {smr_le32((uint32_t)count), smr_le32(kind), smr_le32(range)};
    values v = {k->at, 0, 0};
    if (k->first == 0u) /* later passes need not list the values again */
        k->plan = smr_crc32(k->plan, facts, sizeof facts);
    if (k->mode != SMR_KEEP_COUNT && (k->at > k->bytes || count > (k->bytes - k->at) / size)) {
        k->wrong = 1;
        return v;
    }
    k->at += count * size;
    if (k->mode == SMR_KEEP_COUNT || k->wrong)
        return v;
    v.first = k->slot ? before(v.at, size, count, k->first) : 0u;
    v.last = k->slot ? before(v.at, size, count, k->last) : count;
    return v;
}

/* Writes *value to byte `at` of a save; in a check or restore reads the word there into *value. */
static void word(const smr_keeper *k, size_t at, uint32_t *value)
{
    uint32_t stored = smr_le32(*value);
    if (k->mode == SMR_KEEP_SAVE)
        memcpy(k->to + at, &stored, sizeof stored);
    else
        memcpy(&stored, k->from + at, sizeof stored);
    *value = smr_le32(stored);
}

static void words(smr_keeper *k, uint32_t *field, size_t count, uint32_t most, int or_none)
{
    const values v = begin(k, count, sizeof *field, KEPT_WORD + 256u * (uint32_t)or_none, most);
    for (size_t i = v.first; i < v.last; i++) {
        uint32_t value = k->mode == SMR_KEEP_SAVE ? field[i] : 0u;
        word(k, v.at + sizeof value * i, &value);
        k->wrong |= value > most && !(or_none && value == SMR_NONE);
        if (field != NULL)
            field[i] = value;
    }
}

static void floats(smr_keeper *k, float *field, size_t count, float least, float most)
{
    const values v = begin(k, count, sizeof *field, KEPT_FLOAT, smr_float_bits(least) + 3u * smr_float_bits(most));
    for (size_t i = v.first; i < v.last; i++) {
        uint32_t bits = k->mode == SMR_KEEP_SAVE ? smr_float_bits(field[i]) : 0u;
        word(k, v.at + sizeof bits * i, &bits);
        const float value = smr_float_of(bits);
        k->wrong |= !(value >= least && value <= most);
        if (field != NULL)
            field[i] = value;
    }
}

static void bytes(smr_keeper *k, uint8_t *field, size_t count, uint32_t most)
{
    const values v = begin(k, count, 1, KEPT_BYTE, most);
    for (size_t i = v.first; i < v.last; i++) {
        if (k->mode == SMR_KEEP_SAVE)
            k->to[v.at + i] = field[i];
        const uint8_t value = k->mode == SMR_KEEP_SAVE ? field[i] : k->from[v.at + i];
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
