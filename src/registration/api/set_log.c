/* set_log.c: sets the memory of the log.
 * SPDX-License-Identifier: MIT */
#include "registration/api/setup.h"

smr_status smr_set_log(smr *s, void *memory, size_t bytes)
{
    if (s == NULL)
        return SMR_E_NULL;
    if (smr_changeable(s) && smr_awaits_log(&s->log))
        return smr_await_log(s, memory, bytes);
    if (!smr_ready(s) || (memory != NULL && !s->log.fresh))
        return SMR_E_STATE;
    if (memory != NULL && bytes < SMR_LOG_HEADER + SMR_LOG_FULL_BYTES)
        return SMR_E_ARENA;
    if (memory == NULL)
        smr_log_end(&s->log);
    else
        smr_log_start(&s->log, &s->shared, memory, bytes);
    return SMR_OK;
}
