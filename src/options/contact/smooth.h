/* smooth.h: smoothing on the surface, an internal force (paper 2.3, other forces). In: positions, normals, the rest
 * shape. Out: how far each vertex is to go along its normal for the surface to be as flat there as at rest.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_SMOOTH_H
#define SMR_SMOOTH_H

#include "registration/shape/shape.h"
#include "registration/shape/overlaid_memory.h"

typedef struct smr_smooth {
    const smr_shared *shared;
    const smr_pace *pace;
    const smr_shape *shape;
    smr_rings rings; /* sums over the mesh neighbours' positions */
    float side;      /* of the heights in the start: -1 where it is mirrored */
    float *height; /* [n] mm at rest: of the middle of its mesh neighbours over a vertex, along its normal; NULL: off */
} smr_smooth;

void smr_smooth_layout(smr_arena *a, smr_smooth *s, const smr_shared *shared);
void smr_smooth_wire(smr_smooth *s, const smr_shared *shared, const smr_pace *pace, const smr_shape *shape,
                     const smr_rings *rings);
void smr_smooth_rest(smr_smooth *s); /* notes the heights; the shape is the rest shape */

void smr_smooth_start(smr_smooth *s); /* positions start anew, or were restored */

/* Step: sums over mesh neighbours. Serial. */
uint32_t smr_smooth_tasks(const void *smooth);
void smr_smooth_sum(void *smooth, uint32_t task, uint32_t worker);

/* Blends a way to a goal with what smoothing asks for, where the step has tasks. */
smr_vec smr_smooth_blend(const smr_smooth *s, uint32_t v, smr_vec way);

#endif
