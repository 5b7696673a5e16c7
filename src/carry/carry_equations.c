/* carry_equations.c: the coefficients of vertices near a point, by simple kriging with the covariance 1 + rough - g(r).
 * g is the sum of two twice differentiable parts (Wendland 1995): one with the range of the model, and a small one with
 * the range of some edges, for differences between neighbours. The nearest vertex is eliminated: with covariances K_ij
 * = C - g_ij, C = 1 + rough, the rest is K_ij - K_i0 K_0j / C = g_i0 + g_0j - g_ij - g_i0 g_0j / C, small numbers
 * without cancellation. At a vertex the right-hand side is exactly 0: it maps exactly to its present position.
 * Bounds: SMR_CARRY_NEAR^3 / 6 multiplications for a factor, SMR_CARRY_NEAR^2 for a solution.
 * SPDX-License-Identifier: MIT */
#include "carry/carry.h"

#define SMR_CARRY_WIDTH ((size_t)SMR_CARRY_NEAR)
#define SMR_CARRY_PIVOT 3.0e-6f    /* pivot / diagonal element at or below which a vertex gets no weight */
#define SMR_CARRY_NOTHING 1.0e-12f /* added to the smallest pivot, which would be 0 with a diagonal element of 0 */
#define SMR_CARRY_ALL (1.0f + SMR_CARRY_ROUGH) /* C: variance of smooth and rough part together */

/* Returns g, the loss of covariance: 0 at distance 0, 1 + rough beyond both ranges. d2: squared distance, mm^2. */
static inline float growth(const smr_carry *c, float d2)
{
    const float r = SMR_SQRT(d2);
    const float s = 1.0f - smr_positive(1.0f - r * c->per_smooth), u = 1.0f - smr_positive(1.0f - r * c->per_rough);
    return s * s * (10.0f + s * (-20.0f + s * (15.0f - 4.0f * s))) +
           SMR_CARRY_ROUGH * (u * u * (10.0f + u * (-20.0f + u * (15.0f - 4.0f * u))));
}

/* Writes g[i], g of the distance from p to the site's vertex i, for i = first .. end-1. */
static void growths(const smr_carry *c, const smr_carry_site *s, smr_vec p, uint32_t first, uint32_t end, float *g)
{
    for (uint32_t i = first; i < end; i++) {
        const float x = s->x[0][i] - p.x, y = s->x[1][i] - p.y, z = s->x[2][i] - p.z;
        g[i] = growth(c, x * x + y * y + z * z);
    }
}

/* Returns the matrix' diagonal element of the site's vertex i, before elimination. */
static float diagonal(const smr_carry_site *s, uint32_t i)
{
    return s->far[i] + s->part[i] * s->far[i] + s->noise_variance[i];
}

void smr_carry_fill(const smr_carry *c, smr_carry_site *s)
{
    growths(c, s, smr_carry_place(s, 0), 1, s->n, s->far);
    for (uint32_t i = 1; i < s->n; i++) {
        float *row = s->lower + i * SMR_CARRY_WIDTH;
        const float far = s->far[i], part = 1.0f - far / SMR_CARRY_ALL;
        s->part[i] = part;
        growths(c, s, smr_carry_place(s, i), 1, i, row);
        for (uint32_t j = 1; j < i; j++)
            row[j] = far + part * s->far[j] - row[j];
        row[i] = diagonal(s, i);
    }
}

/* The factors are L D L^T. Column by column, compilers vectorise the inner loop. */
void smr_carry_factor(smr_carry_site *s, uint32_t first, uint32_t last)
{
    float column[SMR_CARRY_NEAR];
    for (uint32_t j = smr_max_u32(first, 1u); j < smr_min_u32(last, s->n); j++) {
        const float pivot = s->lower[j * SMR_CARRY_WIDTH + j];
        s->inverse[j] = pivot > SMR_CARRY_PIVOT * diagonal(s, j) + SMR_CARRY_NOTHING ? 1.0f / pivot : 0.0f;
        for (uint32_t i = j + 1u; i < s->n; i++)
            column[i] = s->lower[i * SMR_CARRY_WIDTH + j];
        for (uint32_t i = j + 1u; i < s->n; i++) {
            float *row = s->lower + i * SMR_CARRY_WIDTH;
            const float f = column[i] * s->inverse[j];
            row[j] = f;
            for (uint32_t k = j + 1u; k <= i; k++)
                row[k] -= f * column[k];
        }
    }
}

void smr_carry_solve(const smr_carry_site *s, float *b)
{
    for (uint32_t i = 2; i < s->n; i++) {
        const float *row = s->lower + i * SMR_CARRY_WIDTH;
        float sum = b[i];
        for (uint32_t j = 1; j < i; j++)
            sum -= row[j] * b[j];
        b[i] = sum;
    }
    for (uint32_t i = 1; i < s->n; i++)
        b[i] *= s->inverse[i];
    for (uint32_t i = s->n; i-- > 2u;)
        for (uint32_t j = 1; j < i; j++)
            b[j] -= s->lower[i * SMR_CARRY_WIDTH + j] * b[i];
}

float smr_carry_side(const smr_carry *c, smr_vec p, smr_carry_site *s)
{
    growths(c, s, p, 0, s->n, s->side);
    const float near = s->side[0];
    for (uint32_t i = 1; i < s->n; i++)
        s->side[i] = (s->far[i] - s->side[i]) + s->part[i] * near;
    return near;
}
