/* unseen_field.h: where the parts of the model lie that the target does not show. In: positions, and which vertices are
 * seen. Out: a smooth field from the start positions, which unseen vertices follow.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_UNSEEN_FIELD_H
#define SMR_UNSEEN_FIELD_H

#include "runtime/forces/surface_goal.h"
#include "runtime/overlaid_memory.h"

#define SMR_CONTROLS 64u /* seen vertices that the field passes by */
#define SMR_FACTOR_WORDS (SMR_CONTROLS * (SMR_CONTROLS + 1u) / 2u)

typedef struct smr_unseen_field {
    const smr_shared *shared;
    const smr_pace *pace;
    const smr_shape *shape;
    const smr_surface_goals *goals;
    float *start;      /* [SMR_CONTROLS][3] start positions of the controls, mm */
    float *bend;       /* [SMR_CONTROLS][3] coefficients of the field; while it is solved: what the pose leaves, mm */
    float *lower;      /* [SMR_FACTOR_WORDS] Cholesky factor, row by row */
    float *loose;      /* [SMR_CONTROLS] on the diagonal: how far the field may miss a control */
    uint32_t n;        /* controls in use; 0: no field */
    smr_pose pose;     /* rigid, from start to present positions of the controls */
    float per_length2; /* 1 / mm^2, of the kernel's length */
} smr_unseen_field;

size_t smr_unseen_field_words(const smr_shared *shared); /* of memory that it needs while forces are computed */
void smr_unseen_field_wire(smr_unseen_field *f, const smr_shared *shared, const smr_pace *pace, const smr_shape *shape,
                           const smr_surface_goals *goals, const smr_overlay *overlay);

/* Steps, skipped where nothing is unseen; one task after the other. */
uint32_t smr_unseen_field_tasks(const void *field);
void smr_unseen_field_solve(void *field, uint32_t task, uint32_t worker);

/* Adds to the way to a goal what the field does along the surface, and blends it with the field as far as the vertex is
 * unseen. way: in: to the goal; out: mm. */
void smr_unseen_field_blend(const smr_unseen_field *f, uint32_t v, smr_vec *way);

#endif
