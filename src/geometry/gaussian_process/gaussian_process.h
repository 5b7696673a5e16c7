/* gaussian_process.h: Gaussian-process regression (Rasmussen and Williams 2006, chapter 2): the Cholesky factor L of
 * the covariance of n measured values, and triangular solves. A value may be a position, or a distance along a normal.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_GAUSSIAN_PROCESS_H
#define SMR_GAUSSIAN_PROCESS_H

#include "base/vec.h"

#define SMR_FACTOR_WORDS(n) ((n) * ((n) + 1u) / 2u) /* floats of a factor of n values: the lower triangle by rows */

/* Returns row i of a Cholesky factor, the lower triangle of which is stored row by row. */
static inline float *smr_factor_row(float *lower, uint32_t i) { return lower + (size_t)i * (i + 1u) / 2u; }

/* Returns the correlation 1 / (1 + d^2 / l^2) of two places. d2: squared distance; per_length2: 1 / l^2. */
static inline float smr_kernel(float d2, float per_length2) { return 1.0f / (1.0f + d2 * per_length2); }

/* Computes entry j <= i of row i from the covariance of values i and j, noise included. The rows up to j and the
 * entries of row i before j must be set. least: smallest squared diagonal entry, above the rounding error. */
void smr_factor_set(float *lower, uint32_t i, uint32_t j, float covariance, float least);
/* Returns component i of L^-1 y. row: row i of L; known: components 0 .. i-1; value: y_i. */
float smr_solve_row(const float *row, uint32_t i, const float *known, float value);

/* Replace y[n] by L^-1 y (forward) or L^-T y (back). lower: the factor L. */
typedef void smr_solver(float *lower, uint32_t n, float *y);
smr_solver smr_solve_forward, smr_solve_back;
/* Solve rows first .. last - 1 alone: forward after all rows before `first`, back after all rows from `last` on. The
 * functions named ...3 solve for three columns, y[n][3]. */
typedef void smr_solver_of_rows(float *lower, uint32_t n, uint32_t first, uint32_t last, float *y);
smr_solver_of_rows smr_solve_rows_forward, smr_solve_rows_back, smr_solve_rows_forward3, smr_solve_rows_back3;

#endif
