/* thin_plate_solve.h: small dense systems of linear equations in single precision, and sums with their rounding error.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_THIN_PLATE_SOLVE_H
#define SMR_THIN_PLATE_SOLVE_H

#include "base/base.h"

#define SMR_SOLVE_SIDES 3u /* right-hand sides solved together: x, y, z */

/* What one solution needs; all arrays are the caller's, row-major. */
typedef struct smr_system {
    uint32_t n;      /* equations */
    const float *a;  /* [n][n] the matrix; stays as it is */
    const float *b;  /* [n][3] right-hand sides; stay as they are */
    float *x;        /* [n][3] the solution */
    float *lu;       /* [n][n] scratch: triangular factors */
    float *rest;     /* [n][3] scratch: what the solution leaves over */
    uint32_t *pivot; /* [n] scratch: rows in the order of elimination */
} smr_system;

/* *sum + *error += a, the rounding error of the sum kept in *error (Knuth's TwoSum). */
static inline void smr_add_exact(float a, float *sum, float *error)
{
    const float t = *sum + a;
    const float part = t - *sum;
    *error += (*sum - (t - part)) + (a - part);
    *sum = t;
}

/* Solves a x = b for three right-hand sides. 1 when done; 0 when a has no inverse in this precision (x undefined). */
int smr_system_solve(const smr_system *s);

#endif
