/* model_write_sections.c: writes numbers and sections of the model in little-endian order.
 * SPDX-License-Identifier: MIT */
#include "prepare/model_write.h"

void smr_put16(smr_writer *w, size_t at, uint32_t value)
{
    const uint16_t stored = smr_le16((uint16_t)value);
    if (w->model != NULL && at + sizeof stored <= w->capacity)
        memcpy(w->model + at, &stored, sizeof stored);
}

void smr_put32(smr_writer *w, size_t at, uint32_t value)
{
    const uint32_t stored = smr_le32(value);
    if (w->model != NULL && at + sizeof stored <= w->capacity)
        memcpy(w->model + at, &stored, sizeof stored);
}

size_t smr_put_section(smr_writer *w, size_t bytes)
{
    const size_t at = (w->used + SMR_ALIGN - 1u) / SMR_ALIGN * SMR_ALIGN;
    if (w->model != NULL && w->used < w->capacity) {
        const size_t end = at + bytes < w->capacity ? at + bytes : w->capacity;
        memset(w->model + w->used, 0, end - w->used);
    }
    w->used = at + bytes;
    return at;
}
