/* tangential_shift.c: the displacement along the surface after which the image agrees better with the reference
 * profile; the paper's goals lie on the normal.
 * Method: one damped Gauss-Newton step (Lucas and Kanade 1981) on the squared differences between reference and image,
 * in two tangential directions u and v. Bounds: four lines of at most SMR_PROFILE_MAX samples.
 * SPDX-License-Identifier: MIT */
#include "image/tangential_shift.h"

#define SMR_FARTHEST2 1.0e30f  /* mm^2: larger squared displacements, and NaN, count as no displacement */
#define SMR_NORMAL_ALONG 0.6f  /* |x| of a normal below which its cross product with the x axis is long enough */
#define SMR_CONTRAST_MOST 4.0f /* largest contrast that smr_contrast() returns */
#define SMR_ROUNDING 1.0e-4f   /* damping / sum of squared slopes: a hundred times the rounding error of the sum */

/* Subtracts the mean of value[n] from each value, because brightness differs between images of one kind. */
static void subtract_mean(float *value, uint32_t n)
{
    float sum = 0.0f;
    for (uint32_t k = 0; k < n; k++)
        sum += value[k];
    const float mean = sum / (float)n;
    for (uint32_t k = 0; k < n; k++)
        value[k] -= mean;
}

/* Writes slope[k]: the change of the image per mm from a line behind a place to one ahead at sample k, divided by the
 * reference's range, minus the mean of all slopes. */
static void slopes(const smr_place *at, const float *ahead, const float *behind, float *slope)
{
    const float per_mm = 0.5f / (at->reach_mm * at->reference->range);
    for (uint32_t k = 0; k < at->reference->n; k++)
        slope[k] = (ahead[k] - behind[k]) * per_mm;
    subtract_mean(slope, at->reference->n);
}

void smr_centre(const smr_profile *reference, const float *found, smr_centred *both)
{
    for (uint32_t k = 0; k < reference->n; k++) {
        both->reference[k] = (float)reference->value[k] * (1.0f / 255.0f);
        both->image[k] = (found[k] - reference->low) / reference->range;
    }
    subtract_mean(both->reference, reference->n);
    subtract_mean(both->image, reference->n);
}

float smr_contrast(const smr_centred *both, uint32_t n)
{
    float ref2 = 0.0f, here2 = 0.0f;
    for (uint32_t k = 0; k < n; k++) {
        ref2 += both->reference[k] * both->reference[k];
        here2 += both->image[k] * both->image[k];
    }
    return ref2 > 0.0f ? SMR_SQRT(smr_min(here2 / ref2, SMR_CONTRAST_MOST * SMR_CONTRAST_MOST)) : 0.0f;
}

smr_vec smr_tangential_shift(const smr_grid *image, const smr_place *at)
{
    const smr_profile *const ref = at->reference;
    const smr_vec nowhere = smr_v(0, 0, 0), normal = at->normal;
    const uint32_t n = ref->n;
    float p[SMR_PROFILE_MAX], q[SMR_PROFILE_MAX], line[SMR_TOGETHER][SMR_PROFILE_MAX];
    float p2 = 0.0f, q2 = 0.0f, pq = 0.0f, pm = 0.0f, qm = 0.0f;
    if (!(ref->range > 0.0f) || n > SMR_PROFILE_MAX)
        return nowhere;
    const smr_vec axis = smr_abs(normal.x) < SMR_NORMAL_ALONG ? smr_v(1, 0, 0) : smr_v(0, 1, 0);
    const smr_vec across = smr_cross(normal, axis);
    const smr_vec u = smr_scale(across, 1.0f / SMR_SQRT(smr_dot(across, across))), v = smr_cross(normal, u);
    const smr_vec by_u = smr_scale(u, at->reach_mm), by_v = smr_scale(v, at->reach_mm);
    const smr_vec beside[SMR_TOGETHER] = {smr_add(at->start, by_u), smr_sub(at->start, by_u), smr_add(at->start, by_v),
                                          smr_sub(at->start, by_v)};
    if (!smr_grid_lines(image, beside, at->spacing, n, line))
        return nowhere;
    slopes(at, line[0], line[1], p);
    slopes(at, line[2], line[3], q);
    for (uint32_t k = 0; k < n; k++) {
        const float missing = at->gain * at->both->reference[k] - at->both->image[k];
        p2 += p[k] * p[k];
        q2 += q[k] * q[k];
        pq += p[k] * q[k];
        pm += p[k] * missing;
        qm += q[k] * missing;
    }
    /* damping suppresses displacements along directions without slopes, and those that noise alone could cause */
    const float noise = at->noise / (ref->range * at->reach_mm);
    const float damp = (float)n * noise * noise + SMR_ROUNDING * (p2 + q2);
    const float pp = p2 + damp, qq = q2 + damp, det = pp * qq - pq * pq;
    if (!(det > 0.0f))
        return nowhere;
    const float along_u = (qq * pm - pq * qm) / det, along_v = (pp * qm - pq * pm) / det;
    const float length2 = along_u * along_u + along_v * along_v;
    if (!smr_within(length2, SMR_FARTHEST2))
        return nowhere;
    const float length = SMR_SQRT(length2), share = length > at->reach_mm ? at->reach_mm / length : 1.0f;
    return smr_add(smr_scale(u, along_u * share), smr_scale(v, along_v * share));
}
