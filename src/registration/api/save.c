/* save.c: saves a registration between two iterations into the caller's memory. Values that follow from the model,
 * the inputs or the next iteration are not saved.
 * Bounds: one pass over all slots, and one over each input.
 * SPDX-License-Identifier: MIT */
#include "registration/api/setup.h"

#define SMR_SAVED_VALUES (SMR_SAVED_FIXED + 4u * SMR_LOG_CONFIG_WORDS) /* bytes before the saved values */

/* Lists what is saved, on a copy that shares the arrays of s; nothing is changed. */
static smr_keeper go_over(const smr *s, uint32_t mode, unsigned char *to, size_t bytes)
{
    smr copy = *s;
    smr_keeper k = {.mode = mode, .to = to, .at = SMR_SAVED_VALUES, .bytes = bytes};
    smr_go_over(&copy, &k);
    return k;
}

smr_status smr_save_bytes(const smr *s, size_t *bytes)
{
    if (s == NULL || bytes == NULL)
        return SMR_E_NULL;
    if (!smr_valid(s))
        return SMR_E_STATE;
    *bytes = go_over(s, SMR_KEEP_COUNT, NULL, 0).at + 4u;
    return SMR_OK;
}

smr_status smr_save(const smr *s, void *memory, size_t bytes)
{
    unsigned char *to = memory;
    size_t needed;
    if (memory == NULL)
        return SMR_E_NULL;
    const smr_status status = smr_save_bytes(s, &needed);
    if (status != SMR_OK)
        return status;
    if (!smr_ready(s) || s->refused || s->forces.caller.broken || s->step != 0u || s->next_task != 0u ||
        !smr_can_wait(&s->shared) || !smr_inputs_valid(&s->forces))
        return SMR_E_STATE; /* only between iterations, when all inputs can still be read */
    if (bytes < needed || needed > UINT32_MAX)
        return SMR_E_ARENA;
    const smr_keeper k = go_over(s, SMR_KEEP_SAVE, to, needed - 4u);
    if (k.wrong)
        return SMR_E_STATE;
    const uint32_t version = SMR_VERSION_MAJOR << 16 | SMR_VERSION_MINOR << 8 | SMR_VERSION_PATCH;
    const uint32_t header[SMR_SAVED_FIXED / 4u] = {SMR_SAVED_MAGIC,
                                                   SMR_SAVED_VERSION,
                                                   (uint32_t)needed,
                                                   version,
                                                   smr_le32(s->shared.model->checksum),
                                                   s->shared.n,
                                                   k.plan,
                                                   SMR_LOG_CONFIG_WORDS};
    for (size_t i = 0; i < SMR_SAVED_FIXED / 4u; i++)
        smr_log_put32(to + 4u * i, header[i]);
    smr_log_put_config(to + SMR_SAVED_FIXED, &s->shared.config);
    smr_log_put32(to + needed - 4u, smr_crc32(0, to, needed - 4u));
    return SMR_OK;
}
