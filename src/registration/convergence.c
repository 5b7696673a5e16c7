/* convergence.c: when a radius is done, and with the last one the registration.
 * Bounds: one pass over the structures.
 * SPDX-License-Identifier: MIT */
#include "registration/convergence.h"

/* 1 when a radius may end before its iterations are spent. While tangent evening works the last radius runs to its end:
 * rounding would decide an early end. If nothing moved at all the end changes nothing. Volumes come to what is
 * asked at the first radius, before anything is fine. */
static int may_end_early(const smr *s)
{
    if (smr_volumes_used(&s->volumes) && smr_volumes_under_way(&s->volumes))
        return 0;
    if (smr_contact_on(&s->forces.contact) && smr_at_last_radius(&s->shared, &s->pace))
        return 0; /* triangles are looked at as it ends */
    return !(s->evolve.moved_mm > 0.0f) || !smr_at_last_radius(&s->shared, &s->pace) ||
           s->forces.surface.n_goals_begun == 0u || !(s->shared.config.basic.even > 0.0f);
}

/* A radius is done when an iteration moves less than settle_um, or after its number of iterations; the registration is
 * done with the last radius. */
smr_ending smr_ending_of(const smr *s, uint32_t radius_iteration)
{
    const int last = smr_at_last_radius(&s->shared, &s->pace);
    const float moved_um = s->evolve.moved_mm * 1000.0f;
    smr_ending e;
    e.settled = moved_um < s->shared.config.motion.settle_um && may_end_early(s);
    e.spent = radius_iteration >= smr_radius_iterations(s);
    e.small = moved_um < s->shared.config.motion.plastic_um;
    e.done = s->pace.repairing == 0u && last && (e.settled || e.spent);
    return e;
}
