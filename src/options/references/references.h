/* references.h: capability: shapes of further subjects, with the model's vertices, in one model. In: start pose, the
 * weights that visible vertices choose. Out: start positions that are a convex blend of all shapes, which vertices that
 * are not visible follow (paper, section 4).
 * SPDX-License-Identifier: MIT */
#ifndef SMR_REFERENCES_H
#define SMR_REFERENCES_H

#include "registration/shape/deformed_shape.h"

#ifdef SMR_WITHOUT_REFERENCES
#define SMR_HAS_REFERENCES 0
#else
#define SMR_HAS_REFERENCES 1
#endif

typedef struct smr_references {
    const smr_stored_references *stored; /* the model's section */
    uint32_t n;                          /* number of shapes, the model's own first */
    float weight[SMR_REFERENCES_MAX];    /* [n] weights of the last forces, at least 0; their sum is 1 */
    float turn[9]; /* row-major: turns and scales rest positions to the start; 0: the start is given, nothing blends */
} smr_references;

/* Returns 1 when the model has shapes of further subjects. */
static inline int smr_blends(const smr_shape *shape) { return SMR_HAS_REFERENCES && shape->references != NULL; }

void smr_references_layout(smr_arena *a, smr_references **references, const smr_shared *shared);
/* With a start pose (posed 1): moves the start positions from the model's own shape to the mean of all shapes. */
void smr_references_start(smr_shape *shape, int posed);

/* Writes the displacement along the vector `along` of start vertex v by each shape's difference from the mean shape. */
void smr_reference_modes(const smr_references *r, uint32_t v, smr_vec along, float *mode);
/* Returns the prior variance of a weight per mm^2 of the shapes' mean variance at the start / prior strength. */
float smr_reference_variance(const smr_references *r, float prior);
/* Sets the weights to 1/n + change[n], without negative ones and with the sum 1. */
void smr_reference_choose(smr_references *r, const float *change);
/* Returns the displacement of start vertex v from the mean shape to the blend by the present weights, mm. */
smr_vec smr_reference_blend(const smr_references *r, uint32_t v);

#endif
