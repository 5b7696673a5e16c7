/* set_fixed_surfaces.c: sets fixed surfaces, which structures must not enter.
 * Bounds: one pass over the vertices.
 * SPDX-License-Identifier: MIT */
#include "registration/api/setup.h"

smr_status smr_set_fixed(smr *s, uint32_t index, const smr_surface *surface)
{
    const int legal = surface == NULL || (smr_surface_valid(surface) && !smr_is_cloud(surface));
    const smr_status status = smr_settable(s, SMR_HAS_CONTACT, legal);
    if (status != SMR_OK)
        return status;
    smr_contact *c = &s->forces.contact;
    if (c->fixed == NULL)
        return SMR_E_ARENA;
    if (index >= s->shared.config.contact.n_fixed)
        return SMR_E_INPUT;
    if (s->n_awaited > 0u)
        return s->await(s, SMR_LOG_FIXED_SURFACE, index, surface);
    smr_contact_fix(c, index, surface);
    smr_restart_forces(s, SMR_CHANGED);
    smr_log_note(&s->log, SMR_LOG_FIXED_SURFACE, index, surface, 0);
    return SMR_OK;
}
