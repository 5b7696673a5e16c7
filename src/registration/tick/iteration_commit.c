/* iteration_commit.c: the end of an iteration. The last step exchanges x and x_next; an iteration that is abandoned
 * before leaves no trace. Readers of positions always see a complete iteration.
 * Bounds: one pass over the vertices; when abandoned, also over targets and triangles.
 * SPDX-License-Identifier: MIT */
#include "registration/tick/iteration_commit.h"
#include "registration/tick/coarse_to_fine_schedule.h"

#include "options/track/track.h"
#include "registration/schedule_radius.h"

uint32_t smr_commit_tasks(const void *s)
{
    (void)s;
    return 1;
}

void smr_commit(void *arg, uint32_t task, uint32_t worker)
{
    smr *s = arg;
    smr_shape *shape = &s->shape;
    float *before = shape->x;
    (void)task;
    (void)worker;
    shape->x = shape->x_next;
    shape->x_next = before;
    for (uint32_t v = 0; v < s->shared.n; v++)
        smr_put3(shape->normal, v, smr_next_normal(s->sums.sum, v));
    if (smr_tracks(&s->schedule))
        smr_track_rest_commit(shape);
    if (smr_volumes_used(&s->volumes))
        smr_volumes_commit(&s->volumes);
    smr_folds_reset(&s->folds);
    s->report.displacement_max_mm = s->evolve.moved_mm;
    s->report.state_hash = s->evolve.hash;
    s->schedule.iteration++;
    s->schedule.radius_iteration++;
    s->schedule.since_plastic++;
    s->report.details.radius = s->schedule.radius; /* the next iteration may have another radius */
    s->report.details.radius_iteration = s->schedule.repairing > 0u ? 0u : s->schedule.radius_iteration;
    smr_schedule_next(s);
    if (s->schedule.since_plastic == 0u)
        smr_plastic_normals(shape);
}

void smr_abandon_iteration(smr *s)
{
    memcpy(s->shape.x_next, s->shape.x, 3u * (size_t)s->shared.n * sizeof(float));
    smr_forces_reset(&s->forces);
    smr_match_reset(&s->match);
    smr_evolve_reset(&s->evolve);
    smr_triangles_now(&s->shape);
    smr_folds_reset(&s->folds);
    s->step = s->next_task = 0;
}
