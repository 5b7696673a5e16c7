/* keep.c: counts, writes, checks and reads what of a registration is kept.
 * Bounds: one pass over the values.
 * SPDX-License-Identifier: MIT */
#include "base/keep.h"

#include "base/bytes.h"

enum { KEPT_BYTE = 1, KEPT_WORD = 4, KEPT_FLOAT = 5 };

/* Makes room for count values of `size` bytes, of this kind and range. Returns 1 when they are to be gone over. */
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

/* field NULL: there is nowhere to store them. */
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
        float value;
        word(k, &bits);
        memcpy(&value, &bits, sizeof value);
        k->wrong |= !(value >= least && value <= most);
        if (field != NULL)
            field[i] = value;
    }
}

void *smr_slot_scratch(smr_arena *a, void *now, size_t count, size_t size)
{
    return smr_keeps(a) ? now : smr_arena_take(a, count, size);
}

float *smr_slot_floats(smr_arena *a, float *now, size_t count, float most)
{
    if (!smr_keeps(a))
        return smr_arena_take(a, count, sizeof *now);
    floats(a->keeper, now, count, -most, most);
    return now;
}

uint32_t *smr_slot_indexes(smr_arena *a, uint32_t *now, size_t count, uint32_t below)
{
    if (!smr_keeps(a))
        return smr_arena_take(a, count, sizeof *now);
    words(a->keeper, now, count, below - 1u, 1);
    return now;
}

uint8_t *smr_slot_bytes(smr_arena *a, uint8_t *now, size_t count, uint32_t most)
{
    smr_keeper *k = a->keeper;
    if (!smr_keeps(a))
        return smr_arena_take(a, count, 1);
    if (!begin(k, count, 1, KEPT_BYTE, most))
        return now;
    for (size_t i = 0; i < count; i++, k->at++) {
        if (k->mode == SMR_KEEP_SAVE)
            k->to[k->at] = now[i];
        const uint8_t value = k->mode == SMR_KEEP_SAVE ? now[i] : k->from[k->at];
        k->wrong |= value > most;
        if (now != NULL)
            now[i] = value;
    }
    return now;
}

void smr_keep_words(smr_arena *a, uint32_t *field, size_t count, uint32_t most)
{
    if (smr_keeps(a))
        words(a->keeper, field, count, most, 0);
}

void smr_keep_floats(smr_arena *a, float *field, size_t count, float least, float most)
{
    if (smr_keeps(a))
        floats(a->keeper, field, count, least, most);
}

void smr_keep_long(smr_arena *a, uint64_t *field)
{
    uint32_t half[2] = {(uint32_t)(*field & 0xffffffffu), (uint32_t)(*field >> 32)};
    if (!smr_keeps(a))
        return;
    words(a->keeper, half, 2, UINT32_MAX, 0);
    *field = (uint64_t)half[1] << 32 | half[0];
}

void smr_keep_require(smr_arena *a, int legal)
{
    if (smr_keeps(a) && a->keeper->mode != SMR_KEEP_COUNT)
        a->keeper->wrong |= (uint32_t)!legal;
}
