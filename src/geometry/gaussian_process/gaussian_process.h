/* gaussian_process.h: regression by a kernel (Gaussian process; Rasmussen and Williams 2006, chapter 2): the Cholesky
 * factor of the controls' covariance, and what is solved with it. The caller computes covariances, so that it says what
 * a control tells: a place, or a distance along a normal.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_GAUSSIAN_PROCESS_H
#define SMR_GAUSSIAN_PROCESS_H

#include "base/vec.h"

#define SMR_FACTOR_WORDS(n) ((n) * ((n) + 1u) / 2u) /* floats of a factor of n controls */

/* Row i of a factor, which has its lower triangle row by row. */
static inline float *smr_factor_row(float *lower, uint32_t i) { return lower + (size_t)i * (i + 1u) / 2u; }

/* The covariance of two places at this squared distance, over the variance: 1 / (1 + d^2 / l^2). */
static inline float smr_kernel(float d2, float per_length2) { return 1.0f / (1.0f + d2 * per_length2); }

/* Entry j <= i of row i, from the covariance of controls i and j, noise included. Entries of rows up to j and of this
 * one before j are there. least: of what is left on the diagonal, its rounding. */
void smr_factor_set(float *lower, uint32_t i, uint32_t j, float covariance, float least);

/* Number i of L^-1 y: value is y_i, known the numbers before. */
float smr_solve_row(const float *row, uint32_t i, const float *known, float value);
smr_vec smr_solve_row3(const float *row, uint32_t i, float *known, smr_vec value); /* known: [i][3] */

/* y = L^-1 y, and y = L^-T y. Then the same of y[n][3]. */
void smr_solve_forward(float *lower, uint32_t n, float *y);
void smr_solve_back(float *lower, uint32_t n, float *y);
void smr_solve_forward3(float *lower, uint32_t n, float *y);
void smr_solve_back3(float *lower, uint32_t n, float *y);

#endif
