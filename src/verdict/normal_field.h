/* normal_field.h: what the seen part of a structure tells of where its vertices are: a smooth random displacement that
 * is known at some seen vertices, and there along their normals only. In: start and present positions, normals, which
 * vertices are seen. Out: how far each vertex may be off.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_NORMAL_FIELD_H
#define SMR_NORMAL_FIELD_H

#include "registration/registration.h"

#define SMR_TELLERS 64u /* seen vertices that are asked, at most */

typedef struct smr_normal_field {
    const smr *s;
    float *at;         /* [n][3] their start positions, mm */
    float *normal;     /* [n][3] */
    float *moved;      /* [n] how far they went along their normals, mm */
    float *open;       /* [n] coefficients of what the motion from the start changes */
    float *lower;      /* Cholesky factor, row by row */
    uint32_t n;        /* 0: too little is seen */
    smr_vec middle;    /* of the box at the start */
    float motions;     /* their variance, over that of the displacement */
    float per_length2; /* 1 / mm^2, of the kernel's length */
    float size2;       /* mm^2: variance of the displacement along an axis */
    /* the motion from the start to the pose of all seen vertices, in the start's frame, mm: */
    smr_vec shift; /* of the middle, */
    smr_vec turn;  /* and about it, at a kernel length */
    float more;    /* variance of how many times more, over that of the displacement; 0: it counts for nothing */
    float again;   /* how many times more the field has it with that variance */
} smr_normal_field;

/* Solves the field of a structure in the memory of sums, which is free between iterations. */
void smr_normal_field_solve(smr_normal_field *f, const smr *s, uint32_t structure);

/* mm: one standard deviation of the place of stored vertex v. */
float smr_normal_field_doubt(const smr_normal_field *f, uint32_t v);

#endif
