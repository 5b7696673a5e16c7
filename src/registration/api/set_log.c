/* set_log.c: sets the memory of the log.
 * SPDX-License-Identifier: MIT */
#include "registration/api/setup.h"

smr_status smr_set_log(smr *s, void *memory, size_t bytes)
{
    SMR_TRY(smr_sound(s));
    if (smr_changeable(s) && smr_awaits_log(&s->log))
        return smr_await_log(s, memory, bytes);
    if (!smr_ready(s) || (memory != NULL && !s->log.fresh))
        return SMR_E_STATE;
    const size_t header = SMR_LOG_FIXED + 4u * (size_t)smr_log_config_words(&s->shared.config) + 4u;
    if (memory != NULL && bytes < header + SMR_LOG_FULL_BYTES)
        return SMR_E_ARENA;
    if (memory == NULL)
        smr_log_end(&s->log);
    else
        smr_log_start(&s->log, &s->shared, memory, bytes);
    smr_guard_close(s);
    return SMR_OK;
}
