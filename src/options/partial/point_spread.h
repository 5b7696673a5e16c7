/* point_spread.h: what the points of a cloud ask of the vertices around them. In: their pulls on corners of triangles
 * (target_attraction.c). Out: pulls and weights that reach all vertices between the points.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_POINT_SPREAD_H
#define SMR_POINT_SPREAD_H

#include "registration/goals/surface_goal.h"
#include "registration/shape/overlaid_memory.h"

typedef struct smr_point_spread {
    const smr_shared *shared;
    const smr_shape *shape;
    smr_surface_goals *goals;
    smr_spread memory;
    uint32_t rounds;    /* of spreading, so far as is known */
    uint32_t n_reached; /* vertices with a weight, in the round under way */
    float weight;       /* of all points that pull */
} smr_point_spread;

void smr_point_spread_wire(smr_point_spread *p, const smr_shared *shared, const smr_shape *shape,
                           smr_surface_goals *goals, const smr_overlay *overlay);

/* Steps, skipped where there is no cloud; one task after the other. */
uint32_t smr_point_spread_tasks(const void *spread);
void smr_point_spread_run(void *spread, uint32_t task, uint32_t worker);

#endif
