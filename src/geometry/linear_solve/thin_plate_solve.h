/* thin_plate_solve.h: small dense systems of linear equations in single precision, and sums with their rounding errors.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_THIN_PLATE_SOLVE_H
#define SMR_THIN_PLATE_SOLVE_H

#include "base/base.h"

#define SMR_SOLVE_SIDES 3u /* right-hand sides solved together: x, y, z */

/* A system of equations a x = b and scratch; all arrays belong to the caller and are row-major. */
typedef struct smr_system {
    uint32_t n;      /* number of equations */
    float *a;        /* [n][n] matrix of the equations; not changed */
    float *b;        /* [n][3] right-hand sides; not changed */
    float *x;        /* [n][3] solution of the equations */
    float *lu;       /* [n][n] scratch: triangular factors */
    float *residual; /* [n][3] scratch: b - a x */
    uint32_t *pivot; /* [n] scratch: rows in the order of elimination */
} smr_system;

/* Adds a to *sum and the rounding error of this addition to *error (Knuth's TwoSum). */
static inline void smr_add_exact(float a, float *sum, float *error)
{
    const float t = *sum + a;
    const float part = t - *sum;
    *error += (*sum - (t - part)) + (a - part);
    *sum = t;
}

/* Solves a x = b for three right-hand sides. Returns 0 when a is singular in this precision; x is undefined then. */
int smr_system_solve(const smr_system *s);

#endif
