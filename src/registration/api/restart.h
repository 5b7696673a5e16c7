/* restart.h: what a new goal does to an iteration under way.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_RESTART_H
#define SMR_RESTART_H

#include "registration/tick/iteration.h"

/* What was measured was about other goals. An iteration that has not all its forces yet starts them again with the new
 * ones; one that has them ends with the old ones. A replay does not know how far a search had come, so nothing of it
 * is left. called: as smr_tracking_call(). */
static inline void smr_restart_forces(smr *s, uint32_t called)
{
    smr_surface_goals *g = &s->forces.surface;
    for (uint32_t j = 0; g->target_warm != NULL && j < s->shared.config.basic.n_target_vertices; j++)
        g->target_warm[j] = SMR_NONE;
    for (uint32_t i = 0; i < s->shared.n_structures; i++)
        g->target[i].measured = 0;
    smr_forces_unmeasured(&s->forces);
    smr_tracking_call(s, called);
    if (!smr_forces_pending(s))
        return;
    smr_pulls_clear(g);
    s->step = s->next_task = 0;
}

#endif
