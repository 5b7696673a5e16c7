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
    const uint32_t *difference;     /* [n_references][n][3] float, mm: each shape minus the mean shape, in the model */
    float more[SMR_REFERENCES_MAX]; /* [n_references] weight of each shape in the blend minus 1 / n_references */
    smr_pose pose; /* similarity from the rest shape onto the start; 0: the start is given, and nothing blends */
} smr_references;

/* Returns 1 when the model has shapes of further subjects. */
static inline int smr_blends(const smr_shape *shape) { return SMR_HAS_REFERENCES && shape->references != NULL; }

void smr_references_layout(smr_arena *a, smr_references **references, const smr_shared *shared);
/* With a start pose (posed 1): moves starts first .. last - 1 from the model's own shape to the mean of all shapes. */
void smr_references_start(smr_shape *shape, int posed, uint32_t first, uint32_t last);
/* Returns the displacement, mm, of start vertex v by weight[0 .. n - 1] times the differences of shapes first, .... */
smr_vec smr_reference_blend(const smr_shape *shape, uint32_t v, uint32_t first, uint32_t n, const float *weight);

#endif
