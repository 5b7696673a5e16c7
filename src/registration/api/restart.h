/* restart.h: restarts the forces of the current iteration when a goal is set.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_RESTART_H
#define SMR_RESTART_H

#include "registration/tick/iteration_steps.h"

/* Marks measures as outdated. An iteration whose forces are not complete starts them again; otherwise it ends with
 * the old goals. Discards all results of searches, since a replay does not know how far they had come. changed: as
 * in smr_tracking_changed(). */
static inline void smr_restart_forces(smr *s, uint32_t changed)
{
    smr_surface_goals *g = &s->forces.surface;
    for (uint32_t j = 0; g->target_warm != NULL && j < s->shared.config.basic.n_target_vertices; j++)
        g->target_warm[j] = SMR_NONE;
    for (uint32_t i = 0; i < s->shared.n_structures; i++)
        g->target[i].measured = 0;
    smr_forces_unmeasured(&s->forces);
    smr_tracking_changed(s, changed);
    if (!smr_forces_pending(s))
        return;
    smr_pulls_clear(g);
    s->step = s->next_task = 0;
}

#endif
