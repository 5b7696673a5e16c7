/* iteration_end.c: how an iteration ends. It stands when the last step exchanges x and x_next; what is given up
 * before leaves nothing behind. Readers of positions therefore always see a complete iteration.
 * Bounds: one pass over the vertices; to give up, over targets and triangles, too.
 * SPDX-License-Identifier: MIT */
#include "registration/tick/iteration_end.h"

#include "options/track/track.h"
#include "registration/convergence.h"
#include "registration/tick/schedule.h"

uint32_t smr_stand_tasks(const void *s)
{
    (void)s;
    return 1;
}

void smr_stand(void *arg, uint32_t task, uint32_t worker)
{
    smr *s = arg;
    smr_shape *shape = &s->shape;
    float *before = shape->x;
    (void)task;
    (void)worker;
    shape->x = shape->x_next;
    shape->x_next = before;
    for (uint32_t v = 0; v < s->shared.n; v++)
        smr_store(smr_at3(shape->normal, v), smr_next_normal(s->sums.sum, v));
    if (smr_tracks(&s->pace))
        smr_held_stand(shape);
    if (smr_volumes_used(&s->volumes))
        smr_volumes_stand(&s->volumes);
    smr_folds_reset(&s->folds);
    s->report.displacement_max_mm = s->evolve.moved_mm;
    s->report.state_hash = s->evolve.hash;
    s->pace.iteration++;
    s->pace.radius_iteration++;
    s->pace.since_plastic++;
    s->report.details.radius = s->pace.radius; /* the next iteration may be at another one */
    s->report.details.radius_iteration = s->pace.repairing > 0u ? 0u : s->pace.radius_iteration;
    smr_schedule_next(s);
    if (s->pace.since_plastic == 0u)
        smr_plastic_normals(shape);
}

void smr_abandon_iteration(smr *s)
{
    memcpy(s->shape.x_next, s->shape.x, 3u * (size_t)s->shared.n * sizeof(float));
    smr_forces_reset(&s->forces);
    smr_match_reset(&s->match);
    smr_evolve_reset(&s->evolve);
    smr_facets_now(&s->shape);
    smr_folds_reset(&s->folds);
    s->step = s->next_task = 0;
}
