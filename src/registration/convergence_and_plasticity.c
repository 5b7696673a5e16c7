/* convergence_and_plasticity.c: the end of a radius, and of the registration with the last radius; and when the
 * reference shape follows the positions, x^r = x (paper 2.3, the last line of an iteration): when the model is at rest
 * (paper 3), after plastic_every iterations, and at the end of a radius.
 * Bounds: one pass over the vertices, a task for each SMR_CHUNK of them.
 * SPDX-License-Identifier: MIT */
#include "registration/schedule_radius.h"

#define SMR_FEWEST 3u      /* fewest iterations at a radius whose vertices still move */
#define SMR_UNREACHED 0.5f /* factor on settle_share while the model cannot reach some goals */

/* Returns 1 when a radius may end before its last iteration. With tangential smoothing the last radius does not, since
 * rounding would decide when. No radius ends early while volumes change towards their ratios. */
static int may_end_early(const smr *s)
{
    if (s->volumes.pending)
        return 0;
    if (smr_contact_on(&s->forces.contact) && smr_at_last_radius(&s->shared, &s->schedule))
        return 0; /* the last radius runs to its end: only its last iterations test triangles' centres for contact */
    return !(s->evolve.moved_mm > 0.0f) || !smr_at_last_radius(&s->shared, &s->schedule) ||
           s->forces.surface.n_goals_at_begin == 0u || !(s->shared.config.basic.even > 0.0f);
}

/* Returns 1 when some goals stay far at any radius: they lie on other bodies, or at noisy points of a cloud. */
static int unreached(const smr *s) { return s->forces.surface.n_clouds_at_begin + s->schedule.others > 0u; }

/* Returns 1 when the vertices move by less than settle_share of the way to their goals: forces on clusters of the
 * current radius cancel out, and smaller clusters follow them further. Smaller clusters end at a larger share, in
 * inverse ratio to their radius: they can follow more, and what still moves then is mostly a creep along the target. */
static int stalls(const smr *s, uint32_t radius_iteration)
{
    const smr_motion_config *c = &s->shared.config.motion;
    const uint32_t first = s->shared.config.schedule.radius_first;
    const smr_force_totals *f = &s->forces.totals; /* vertices without a goal count as at rest */
    const float way = f->goal_mean * (float)f->n_forces / (float)smr_max_u32(s->schedule.n_active, 1u);
    const float least = c->settle_share * (unreached(s) ? SMR_UNREACHED : 1.0f);
    const float share = least * smr_model_lists(s->shared.model, first).radius / s->schedule.lists.radius;
    return c->settle_um > 0.0f && share > 0.0f && radius_iteration >= SMR_FEWEST && /* none of a fold repair */
           !smr_at_last_radius(&s->shared, &s->schedule) && may_end_early(s) && s->evolve.mean_mm <= share * way;
}

/* Returns whether a radius ends: when no vertex moves by settle_um or more, when the vertices hardly approach their
 * goals, or after its number of iterations. */
smr_ending smr_ending_of(const smr *s, uint32_t radius_iteration)
{
    const int last = smr_at_last_radius(&s->shared, &s->schedule);
    const float moved_um = s->evolve.moved_mm * 1000.0f;
    smr_ending e;
    e.settled = moved_um < s->shared.config.motion.settle_um && may_end_early(s);
    e.spent = radius_iteration >= smr_radius_iterations(s) || stalls(s, radius_iteration);
    e.small = moved_um < s->shared.config.motion.plastic_um;
    e.done = s->schedule.repairing == 0u && last && (e.settled || e.spent);
    return e;
}

int smr_plastic_due(const smr *s, const smr_ending *e, uint32_t since_plastic)
{
    const smr_config *c = &s->shared.config;
    const int still =
        c->motion.plastic_by == SMR_PLASTIC_MEAN ? s->evolve.mean_mm * 1000.0f < c->motion.plastic_um : e->small;
    const int due = c->motion.plastic_every != 0u && since_plastic >= c->motion.plastic_every;
    return s->schedule.repairing > 0u || (!e->done && (still || due || e->settled || e->spent));
}

int smr_plastic_ahead(const smr *s)
{
    const smr_ending e = smr_ending_of(s, s->schedule.radius_iteration + 1u);
    return smr_plastic_due(s, &e, s->schedule.since_plastic + 1u);
}

void smr_plastic_update(smr *s)
{
    s->reference.stale = 1;
    s->schedule.since_plastic = 0;
    s->schedule.plastic_updates++;
}

int smr_plastic_follows(const smr *s) { return s->schedule.plastic_updates > 0u && s->schedule.since_plastic == 0u; }

uint32_t smr_plastic_tasks(const void *arg)
{
    const smr *s = arg;
    return smr_plastic_follows(s) ? s->shared.n_tasks : 0u;
}

void smr_plastic_follow(void *arg, uint32_t task, SMR_UNUSED uint32_t worker)
{
    const smr_shape *s = &((smr *)arg)->shape;
    const size_t first = 3u * SMR_CHUNK * (size_t)task, n = 3u * (size_t)smr_chunk_end(s->shared, task) - first;
    memcpy(s->x_ref + first, s->x + first, n * sizeof *s->x);
    memcpy(s->normal_ref + first, s->normal + first, n * sizeof *s->normal);
}
