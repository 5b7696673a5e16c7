/* gaussian_process.c: a Cholesky factor, entry by entry, and triangular solves.
 * Bounds: n multiplications for an entry or a row, n^2 / 2 for a solve.
 * SPDX-License-Identifier: MIT */
#include "geometry/gaussian_process/gaussian_process.h"

void smr_factor_set(float *lower, uint32_t i, uint32_t j, float covariance, float least)
{
    float *const row = smr_factor_row(lower, i);
    const float *const above = smr_factor_row(lower, j);
    float left = covariance;
    for (uint32_t k = 0; k < j; k++)
        left -= row[k] * above[k];
    row[j] = i == j ? SMR_SQRT(smr_max(left, least)) : left / above[j];
}

float smr_solve_row(const float *row, uint32_t i, const float *known, float value)
{
    for (uint32_t k = 0; k < i; k++)
        value -= row[k] * known[k];
    return value / row[i];
}

void smr_solve_rows_forward(float *lower, SMR_UNUSED uint32_t n, uint32_t first, uint32_t last, float *y)
{
    for (uint32_t i = first; i < last; i++)
        y[i] = smr_solve_row(smr_factor_row(lower, i), i, y, y[i]);
}

void smr_solve_rows_back(float *lower, SMR_UNUSED uint32_t n, uint32_t first, uint32_t last, float *y)
{
    for (uint32_t i = last; i-- > first;) {
        const float *const row = smr_factor_row(lower, i);
        y[i] /= row[i];
        for (uint32_t k = 0; k < i; k++)
            y[k] -= row[k] * y[i];
    }
}

void smr_solve_rows_forward3(float *lower, SMR_UNUSED uint32_t n, uint32_t first, uint32_t last, float *y)
{
    for (uint32_t i = first; i < last; i++) {
        const float *const row = smr_factor_row(lower, i);
        smr_vec left = smr_get3(y, i);
        for (uint32_t k = 0; k < i; k++)
            left = smr_sub(left, smr_scale(smr_get3(y, k), row[k]));
        smr_put3(y, i, smr_scale(left, 1.0f / row[i]));
    }
}

void smr_solve_rows_back3(float *lower, uint32_t n, uint32_t first, uint32_t last, float *y)
{
    for (uint32_t i = last; i-- > first;) {
        smr_vec left = smr_get3(y, i);
        for (uint32_t k = i + 1u; k < n; k++)
            left = smr_sub(left, smr_scale(smr_get3(y, k), smr_factor_row(lower, k)[i]));
        smr_put3(y, i, smr_scale(left, 1.0f / smr_factor_row(lower, i)[i]));
    }
}

void smr_solve_forward(float *lower, uint32_t n, float *y) { smr_solve_rows_forward(lower, n, 0, n, y); }
void smr_solve_back(float *lower, uint32_t n, float *y) { smr_solve_rows_back(lower, n, 0, n, y); }
