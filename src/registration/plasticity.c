/* plasticity.c: the reference shape follows the positions, x^r = x (paper 2.3, the last line of an iteration), when the
 * model is at rest (paper 3), after plastic_every iterations, and at the end of a radius.
 * Bounds: one pass over the vertices.
 * SPDX-License-Identifier: MIT */
#include "registration/schedule_radius.h"

int smr_plastic_due(const smr *s, const smr_ending *e, uint32_t since_plastic)
{
    const smr_config *c = &s->shared.config;
    const int still =
        c->motion.plastic_by == SMR_PLASTIC_MEAN ? s->evolve.mean_mm * 1000.0f < c->motion.plastic_um : e->small;
    const int due = c->motion.plastic_every != 0u && since_plastic >= c->motion.plastic_every;
    return s->schedule.repairing > 0u || (!e->done && (still || due || e->settled || e->spent));
}

/* In tracking and dynamics x^r is tracking's rest shape in new poses (tracking_rest_shape.c). */
int smr_plastic_ahead(const smr *s)
{
    const smr_ending e = smr_ending_of(s, s->schedule.radius_iteration + 1u);
    return !s->schedule.tracking && s->shape.dynamics == NULL && smr_plastic_due(s, &e, s->schedule.since_plastic + 1u);
}

void smr_plastic_update(smr *s)
{
    smr_plastic_positions(&s->shape);
    s->reference.stale = 1;
    s->schedule.since_plastic = 0;
    s->schedule.plastic_updates++;
}

void smr_plastic_positions(smr_shape *shape)
{
    memcpy(shape->x_ref, shape->x, 3u * (size_t)shape->shared->n * sizeof(float));
}

void smr_plastic_normals(smr_shape *shape)
{
    memcpy(shape->normal_ref, shape->normal, 3u * (size_t)shape->shared->n * sizeof(float));
}
