/* set_active.c: sets the number of active vertices.
 * SPDX-License-Identifier: MIT */
#include "registration/registration.h"

smr_status smr_set_active(smr *s, uint32_t n_active)
{
    if (s == NULL)
        return SMR_E_NULL;
    if (!smr_ready(s))
        return SMR_E_STATE;
    s->schedule.n_active_chosen = smr_min_u32(n_active, s->shared.n);
    smr_log_note(&s->log, SMR_LOG_ACTIVE, n_active, NULL, 0);
    return SMR_OK;
}
