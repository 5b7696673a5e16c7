/* save_fields.c: places the slots of a registration, or passes their values to a save or restore.
 * SPDX-License-Identifier: MIT */
#include "base/save_fields.h"

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
