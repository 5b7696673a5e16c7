/* occluded_field_covariance.c: the covariance of the occluded vertices' field: its kernel, and what it shares with
 * controls. The observation of a landmark is the mean of its triangle's corners. A hard landmark has a second field of
 * short range instead of noise, so that the field meets it exactly.
 * Two bodies differ smoothly and also from place to place. Such local differences, if taken as smooth, would turn and
 * stretch the whole model. Therefore the kernel has a second, short term. Its share of the variance is the most likely
 * of SMR_FIELD_TRIES values (marginal likelihood; Rasmussen and Williams 2006, section 5.4), and noise grows with it.
 * Bounds: nine kernels for a covariance; a factor of SMR_ROUGH_ROWS rows for each of SMR_FIELD_TRIES, two rows a task.
 * SPDX-License-Identifier: MIT */
#include "geometry/gaussian_process/gaussian_process.h"
#include "options/partial/partial.h"

#define SMR_ROUGH_CHUNK 2u     /* number of rows of the factor that one task computes */
#define SMR_ROUGH_ROWS 96u     /* largest number of controls from which a likelihood is computed */
#define SMR_ROUGH_LEAST 32u    /* number of controls below which the kernel has no short term */
#define SMR_ROUGH_LENGTH 0.15f /* length of the kernel's short term / length of the long term */
#define SMR_ROUGH_NOISE 0.1f   /* noise variance that the short term adds to controls / variance of the short term */
#define SMR_ROUGH_MOTION 20.0f /* growth of the motions' variance / variance of the short term */
#define SMR_ROUGH_SURE 8.0f    /* gain of 2 log2(likelihood) below which no short term is used: odds of 16 */
#define SMR_LOG_MIDDLE 1.41421356f
#define SMR_LOG_SCALE 2.88539008f /* 2 / ln 2: first coefficient of the series for log2 in log_two() */

_Static_assert(SMR_TRY_TASKS *SMR_ROUGH_CHUNK == SMR_ROUGH_ROWS, "each row has its task");

/* The variances of the kernel's short term that are tried, divided by the long term's variance. */
static const float roughness[SMR_FIELD_TRIES] = {0.0f, 0.1f, 0.3f};

float *smr_field_start(const smr_occluded_field *f)
{
    if (smr_field_of_past(f))
        return f->shape->image_x;
    return f->schedule->tracking ? f->shape->track_rest_x : f->shape->start;
}

/* Returns the covariance of the field at positions a and b, divided by the field's variance. */
static float kernel(const smr_occluded_field *f, smr_vec a, smr_vec b)
{
    const float d2 = smr_distance2(a, b), smooth = smr_kernel(d2, f->per_length2);
    const float near = f->rough > 0.0f ? smr_kernel(d2, f->per_rough2) : 0.0f;
    return smooth + f->rough * (near * near * near);
}

static int is_landmark(const smr_occluded_field *f, uint32_t k) { return k < f->landmarks->n; }

int smr_field_hard(const smr_occluded_field *f, uint32_t k)
{
    return is_landmark(f, k) && f->landmarks->landmark[k].given.hard != 0u;
}

float smr_field_with_control(const smr_occluded_field *f, smr_vec at, uint32_t k, int sharp)
{
    float sum = 0.0f;
    if (!is_landmark(f, k))
        return kernel(f, at, smr_get3(f->start, k));
    const smr_bound_landmark *b = &f->landmarks->landmark[k];
    for (uint32_t c = 0; c < 3u; c++) {
        const smr_vec corner = smr_get3(smr_field_start(f), b->corner[c]);
        if (!(b->share[c] > 0.0f))
            continue;
        float one = kernel(f, at, corner);
        if (sharp)
            one += SMR_FIELD_NOISE * smr_wendland(smr_length(smr_sub(at, corner)) / f->landmarks->reach);
        sum += b->share[c] * one;
    }
    return sum;
}

/* Returns the covariance of displacements along an axis at controls i and j, j <= i, / the field's variance. */
static float between(const smr_occluded_field *f, uint32_t i, uint32_t j)
{
    const int sharp = smr_field_hard(f, i) && smr_field_hard(f, j);
    float sum = 0.0f;
    if (!is_landmark(f, i))
        return smr_field_with_control(f, smr_get3(f->start, i), j, 0);
    const smr_bound_landmark *b = &f->landmarks->landmark[i];
    for (uint32_t c = 0; c < 3u; c++)
        if (b->share[c] > 0.0f)
            sum += b->share[c] * smr_field_with_control(f, smr_get3(smr_field_start(f), b->corner[c]), j, sharp);
    return sum;
}

float smr_occluded_field_between(const smr_occluded_field *f, uint32_t i, uint32_t j)
{
    return f->by_normals ? smr_field_normals_between(f, i, j, between(f, i, j)) : between(f, i, j);
}

/* Returns log2(x) of a positive normal x, accurate to 1e-6: exponent plus a series for the mantissa. */
static float log_two(float x)
{
    const uint32_t bits = smr_float_bits(x);
    const float whole = (float)(bits >> 23) - 127.0f, rest = smr_float_of((bits & 0x7fffffu) | 0x3f800000u);
    const float z = (rest - SMR_LOG_MIDDLE) / (rest + SMR_LOG_MIDDLE), q = z * z;
    return whole + 0.5f + SMR_LOG_SCALE * z * (1.0f + q * (1.0f / 3.0f + q * (1.0f / 5.0f + q * (1.0f / 7.0f))));
}

/* Sets the kernel's short term to the variance `rough` times the long term's, and all fields that depend on `rough`. */
static void take(smr_occluded_field *f, float rough)
{
    f->rough = rough;
    f->rough_noise = SMR_ROUGH_NOISE * rough;
    f->motion_variance = SMR_MOTION_VARIANCE * (1.0f + SMR_ROUGH_MOTION * rough);
    f->per_rough2 = f->per_length2 * (1.0f / (3.0f * SMR_ROUGH_LENGTH * SMR_ROUGH_LENGTH));
}

/* Computes row i of the factor of the controls' covariance and whitened residual i. Adds both to f->log, f->square. */
static void add_row(smr_occluded_field *f, uint32_t i)
{
    const float *const r = smr_factor_row(f->lower, i);
    for (uint32_t j = 0; j <= i; j++) {
        const float both = smr_occluded_field_between(f, i, j);
        const float noise_variance = i == j ? f->noise_variance[i] + f->rough_noise : 0.0f;
        smr_factor_set(f->lower, i, j, both + noise_variance, SMR_FIELD_ROUNDED * both);
    }
    f->whitened[i] = smr_solve_row(r, i, f->whitened, f->residual[i]);
    f->square += f->whitened[i] * f->whitened[i];
    f->log -= 2.0f * log_two(r[i]);
}

void smr_field_roughness_try(smr_occluded_field *f, uint32_t task)
{
    const uint32_t n = smr_min_u32(f->n, SMR_ROUGH_ROWS), k = task / SMR_TRY_TASKS, part = task % SMR_TRY_TASKS;
    const int enough = f->by_normals && n >= SMR_ROUGH_LEAST;
    if (task == 0u) {
        f->likeliest = 0;
        take(f, 0.0f);
    }
    if (enough && part == 0u) {
        take(f, roughness[k]);
        f->square = f->log = 0.0f;
    }
    for (uint32_t i = part * SMR_ROUGH_CHUNK; enough && i < n && i < (part + 1u) * SMR_ROUGH_CHUNK; i++)
        add_row(f, i);
    if (!enough || part + 1u < SMR_TRY_TASKS)
        return;
    /* 2 log2(likelihood) for the field's most likely variance, without constant terms */
    const float likelihood = f->log - (float)n * log_two(smr_max(f->square, FLT_MIN));
    const float now = likelihood + (k == 0u ? SMR_ROUGH_SURE : 0.0f);
    if (k == 0u || now > f->likelihood) {
        f->likelihood = now;
        f->likeliest = k;
    }
    if (k + 1u == SMR_FIELD_TRIES)
        take(f, roughness[f->likeliest]);
}
