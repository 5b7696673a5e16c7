/* expected_error_field.h: where the vertices of a structure are, given its visible part: a smooth random displacement,
 * observed at some visible vertices along their normals. In: start and present positions, normals, visible vertices.
 * Out: the standard deviation of each vertex' position.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_EXPECTED_ERROR_FIELD_H
#define SMR_EXPECTED_ERROR_FIELD_H

#include "registration/registration.h"

#define SMR_OBSERVATIONS 64u /* most observations: visible vertices that the field is fitted to */

typedef struct smr_normal_field {
    const smr *s;
    float *at;         /* [n][3] start positions of the observed vertices, mm */
    float *normal;     /* [n][3] their normals in the start's frame */
    float *moved;      /* [n] observed displacement along the normal, mm */
    float *open;       /* [n] change of the coefficients by the variance of the motion from the start */
    float *lower;      /* Cholesky factor, row by row */
    uint32_t n;        /* number of observations; 0: too few */
    smr_vec middle;    /* middle of the structure's box at the start, mm */
    float motions;     /* variance of the motions over that of the displacement */
    float per_length2; /* 1 / l^2 of the kernel length l, 1 / mm^2 */
    float size2;       /* variance of the displacement along an axis, mm^2 */
    /* motion from the start to the pose of all visible vertices, in the start's frame: */
    smr_vec shift; /* of the middle, mm */
    smr_vec turn;  /* rotation about the middle, mm at a kernel length */
    float more;    /* variance of that motion's factor over the displacement's variance; 0: not used */
    float again;   /* factor on that motion that the field then has */
} smr_normal_field;

/* Solves the field of a structure in the memory of sums, which is free between iterations. */
void smr_normal_field_solve(smr_normal_field *f, const smr *s, uint32_t structure);

/* The standard deviation of the position of stored vertex v, mm. */
float smr_normal_field_error(const smr_normal_field *f, uint32_t v);

#endif
