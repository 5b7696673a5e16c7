/* convergence.c: the end of a radius, and of the registration with the last radius.
 * Bounds: one pass over the structures.
 * SPDX-License-Identifier: MIT */
#include "registration/schedule_radius.h"

/* Returns 1 when a radius may end before its last iteration. With tangential smoothing the last radius does not, since
 * rounding would decide. Volumes reach their ratios at the first radius. */
static int may_end_early(const smr *s)
{
    if (smr_volumes_used(&s->volumes) && smr_volumes_pending(&s->volumes))
        return 0;
    if (smr_contact_on(&s->forces.contact) && smr_at_last_radius(&s->shared, &s->schedule))
        return 0; /* triangles are tested for contact in its last iterations */
    return !(s->evolve.moved_mm > 0.0f) || !smr_at_last_radius(&s->shared, &s->schedule) ||
           s->forces.surface.n_goals_at_begin == 0u || !(s->shared.config.basic.even > 0.0f);
}

/* A radius ends when no vertex moves by settle_um or more, or after its number of iterations. */
smr_ending smr_ending_of(const smr *s, uint32_t radius_iteration)
{
    const int last = smr_at_last_radius(&s->shared, &s->schedule);
    const float moved_um = s->evolve.moved_mm * 1000.0f;
    smr_ending e;
    e.settled = moved_um < s->shared.config.motion.settle_um && may_end_early(s);
    e.spent = radius_iteration >= smr_radius_iterations(s);
    e.small = moved_um < s->shared.config.motion.plastic_um;
    e.done = s->schedule.repairing == 0u && last && (e.settled || e.spent);
    return e;
}
