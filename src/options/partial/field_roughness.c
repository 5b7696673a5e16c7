/* field_roughness.c: how rough a part's deformation is. Another body differs from the model not smoothly alone, but
 * also from place to place. Taken for smooth, such differences turn and stretch the whole and are carried far into what
 * the target does not show. So the field's kernel has a second, short term, whose share of the variance is the
 * likeliest of a few for some of the controls (marginal likelihood; Rasmussen and Williams 2006, section 5.4). With it
 * goes what a control may be off along its normal. A smooth deformation has none, and the field is as without.
 * Bounds: a factor of SMR_ROUGH_ROWS rows for each of SMR_FIELD_TRIES, four rows to a task.
 * SPDX-License-Identifier: MIT */
#include "options/partial/partial.h"

#define SMR_ROUGH_CHUNK 4u     /* rows of a task */
#define SMR_ROUGH_ROWS 96u     /* controls that are asked */
#define SMR_ROUGH_LEAST 32u    /* with fewer the deformation is smooth */
#define SMR_ROUGH_LENGTH 0.15f /* of the kernel's length */
#define SMR_ROUGH_LOOSE 0.1f   /* of the short term's variance: what a control may be off beside */
#define SMR_ROUGH_MOTION 20.0f /* the same over that of motions: what is rough says less of the smooth than of these */
#define SMR_ROUGH_SURE 8.0f    /* by how much likelier it must be than smooth, as how_likely() counts: odds of 16 */
#define SMR_LOG_MIDDLE 1.41421356f
#define SMR_LOG_SCALE 2.88539008f /* 2 / ln 2 */

/* The variance of the short term over that of the long one. */
static const float roughness[SMR_FIELD_TRIES] = {0.0f, 0.1f, 0.3f};

/* The binary logarithm of a positive normal number, to 1e-6: exponent, and a series of the rest. */
static float log_two(float x)
{
    uint32_t bits = 0;
    float rest = 0.0f;
    memcpy(&bits, &x, sizeof bits);
    const float whole = (float)(bits >> 23) - 127.0f;
    bits = (bits & 0x7fffffu) | 0x3f800000u;
    memcpy(&rest, &bits, sizeof rest);
    const float z = (rest - SMR_LOG_MIDDLE) / (rest + SMR_LOG_MIDDLE), q = z * z;
    return whole + 0.5f + SMR_LOG_SCALE * z * (1.0f + q * (1.0f / 3.0f + q * (1.0f / 5.0f + q * (1.0f / 7.0f))));
}

static void take(smr_unseen_field *f, float rough)
{
    f->rough = rough;
    f->rough_loose = SMR_ROUGH_LOOSE * rough;
    f->motion_variance = SMR_MOTION_VARIANCE * (1.0f + SMR_ROUGH_MOTION * rough);
    f->per_rough2 = f->per_length2 * (1.0f / (3.0f * SMR_ROUGH_LENGTH * SMR_ROUGH_LENGTH));
}

_Static_assert(SMR_TRY_TASKS *SMR_ROUGH_CHUNK == SMR_ROUGH_ROWS, "each row has its task");

/* Row i of the factor of what the controls tell, and what the rows before leave of what i tells, over its deviation. */
static void add_row(smr_unseen_field *f, uint32_t i)
{
    const float *const r = smr_field_row(f, i);
    for (uint32_t j = 0; j <= i; j++) {
        const float both = smr_unseen_field_between(f, i, j), loose = i == j ? f->loose[i] + f->rough_loose : 0.0f;
        smr_factor_set(f->lower, i, j, both + loose, SMR_FIELD_ROUNDED * both);
    }
    f->told[i] = smr_solve_row(r, i, f->told, f->left[i]);
    f->square += f->told[i] * f->told[i];
    f->log -= 2.0f * log_two(r[i]);
}

/* How likely the present roughness is, whatever the variance: twice the logarithm, a number of controls left out. */
static float how_likely(const smr_unseen_field *f, uint32_t n)
{
    return f->log - (float)n * log_two(smr_max(f->square, FLT_MIN));
}

void smr_field_roughness_try(smr_unseen_field *f, uint32_t task)
{
    const uint32_t n = smr_min_u32(f->n, SMR_ROUGH_ROWS), k = task / SMR_TRY_TASKS, part = task % SMR_TRY_TASKS;
    const int asks = f->by_normals && n >= SMR_ROUGH_LEAST;
    if (task == 0u) {
        f->likeliest = 0;
        take(f, 0.0f);
    }
    if (asks && part == 0u) {
        take(f, roughness[k]);
        f->square = f->log = 0.0f;
    }
    for (uint32_t i = part * SMR_ROUGH_CHUNK; asks && i < n && i < (part + 1u) * SMR_ROUGH_CHUNK; i++)
        add_row(f, i);
    if (!asks || part + 1u < SMR_TRY_TASKS)
        return;
    const float now = how_likely(f, n) + (k == 0u ? SMR_ROUGH_SURE : 0.0f);
    if (k == 0u || now > f->likelihood) {
        f->likelihood = now;
        f->likeliest = k;
    }
    if (k + 1u == SMR_FIELD_TRIES)
        take(f, roughness[f->likeliest]);
}
