/* thin_plate_solve.c: solves the linear equations of a thin-plate spline in single precision.
 * Method: LU with partial pivoting and iterative refinement (Higham, "Accuracy and Stability of Numerical Algorithms",
 * 9 and 12). Residuals are summed as if in double precision (Dot2: Ogita, Rump, Oishi 2005; error of a product: Dekker
 * 1971), so each component is right to the last digits of a float for condition numbers below about 1e6.
 * Bounds: n^3 / 3 multiplications to factor, then 4 * 3 * 2 n^2 and four Dot2 passes over a; no data-dependent loop.
 * SPDX-License-Identifier: MIT */
#include "geometry/linear_solve/thin_plate_solve.h"

#define SMR_REFINEMENTS 3u    /* number of corrections of the solution by the residual */
#define SMR_PIVOT_MIN 1.0e-9f /* smaller pivots count as 0; the caller scales the matrix to entries of about 1 */

/* Factors s->a into s->lu, rows in the order of s->pivot. Of equal pivots takes the first. Returns 0 if one is 0. */
static int factor(const smr_system *s)
{
    const size_t n = s->n;
    float *lu = s->lu;
    memcpy(lu, s->a, n * n * sizeof *lu);
    for (size_t i = 0; i < n; i++)
        s->pivot[i] = (uint32_t)i;
    for (size_t k = 0; k < n; k++) {
        size_t best = k;
        for (size_t i = k + 1u; i < n; i++)
            if (smr_abs(lu[i * n + k]) > smr_abs(lu[best * n + k]))
                best = i;
        if (!(smr_abs(lu[best * n + k]) > SMR_PIVOT_MIN))
            return 0;
        const uint32_t row = s->pivot[k];
        s->pivot[k] = s->pivot[best];
        s->pivot[best] = row;
        for (size_t j = 0; best != k && j < n; j++) {
            const float swap = lu[k * n + j];
            lu[k * n + j] = lu[best * n + j];
            lu[best * n + j] = swap;
        }
        const float inverse = 1.0f / lu[k * n + k];
        for (size_t i = k + 1u; i < n; i++) {
            const float f = lu[i * n + k] * inverse;
            lu[i * n + k] = f;
            for (size_t j = k + 1u; j < n; j++)
                lu[i * n + j] -= f * lu[k * n + j];
        }
    }
    return 1;
}

/* Solves the factored system in place. y[n][3]: in the right-hand sides in pivot order; out the unknowns. */
static void substitute(const smr_system *s, float *y)
{
    const size_t n = s->n;
    const float *lu = s->lu;
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < i; j++)
            for (size_t c = 0; c < SMR_SOLVE_SIDES; c++)
                y[i * SMR_SOLVE_SIDES + c] -= lu[i * n + j] * y[j * SMR_SOLVE_SIDES + c];
    for (size_t i = n; i-- > 0u;) {
        for (size_t j = i + 1u; j < n; j++)
            for (size_t c = 0; c < SMR_SOLVE_SIDES; c++)
                y[i * SMR_SOLVE_SIDES + c] -= lu[i * n + j] * y[j * SMR_SOLVE_SIDES + c];
        for (size_t c = 0; c < SMR_SOLVE_SIDES; c++)
            y[i * SMR_SOLVE_SIDES + c] /= lu[i * n + i];
    }
}

/* Returns a's upper half of digits (Dekker's split): a - high(a) and products of such halves are exact. */
static float high(float a)
{
    const float big = 4097.0f * a;
    return big - (big - a);
}

/* Adds a * b to *sum, and the rounding errors of product and sum to *error. */
static void add_product(float a, float b, float *sum, float *error)
{
    const float p = a * b;
    const float ah = high(a), al = a - ah, bh = high(b), bl = b - bh;
    const float p_error = al * bl - (((p - ah * bh) - al * bh) - ah * bl);
    smr_add_exact(p, sum, error);
    *error += p_error;
}

/* Computes s->residual, the residuals b - a x, with the rows in pivot order. */
static void find_residual(const smr_system *s)
{
    const size_t n = s->n;
    for (size_t i = 0; i < n; i++) {
        const size_t row = s->pivot[i];
        for (size_t c = 0; c < SMR_SOLVE_SIDES; c++) {
            float sum = s->b[row * SMR_SOLVE_SIDES + c], error = 0.0f;
            for (size_t j = 0; j < n; j++)
                add_product(-s->a[row * n + j], s->x[j * SMR_SOLVE_SIDES + c], &sum, &error);
            s->residual[i * SMR_SOLVE_SIDES + c] = sum + error;
        }
    }
}

int smr_system_solve(const smr_system *s)
{
    const size_t values = (size_t)s->n * SMR_SOLVE_SIDES;
    if (!factor(s))
        return 0;
    memset(s->x, 0, values * sizeof *s->x);
    for (uint32_t k = 0; k <= SMR_REFINEMENTS; k++) { /* pass 0 solves, each later one refines */
        find_residual(s);
        substitute(s, s->residual);
        for (size_t i = 0; i < values; i++)
            s->x[i] += s->residual[i];
    }
    return smr_all_within(s->x, values, FLT_MAX);
}
