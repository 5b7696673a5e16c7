/* occluded_field_covariance.c: what two places of the field have in common: its kernel, and what controls tell. What is
 * observed of a landmark is the mean of its triangle's corners. So that the field passes exactly by a hard one, what it
 * may be off is not noise, but a second field of short reach.
 * Bounds: nine kernels.
 * SPDX-License-Identifier: MIT */
#include "options/partial/partial.h"

/* Positions from which the field displaces: the rest shape of tracking, the start positions, or the positions of an
 * outdated image. */
float *smr_field_start(const smr_occluded_field *f)
{
    if (smr_field_of_past(f))
        return f->shape->image_x;
    return f->schedule->tracking ? f->shape->track_rest_x : f->shape->start;
}

static float kernel(const smr_occluded_field *f, smr_vec a, smr_vec b)
{
    const smr_vec d = smr_sub(a, b);
    const float d2 = smr_dot(d, d), smooth = smr_kernel(d2, f->per_length2);
    const float near = f->rough > 0.0f ? smr_kernel(d2, f->per_rough2) : 0.0f;
    return smooth + f->rough * (near * near * near);
}

static int is_landmark(const smr_occluded_field *f, uint32_t k) { return k < f->landmarks->n; }

int smr_field_hard(const smr_occluded_field *f, uint32_t k)
{
    return is_landmark(f, k) && f->landmarks->landmark[k].given.hard != 0u;
}

/* Covariance of the field at a position with control k. A landmark is the mean of its corners. sharp: includes the
 * field of short range. */
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

/* Covariance of controls i and j, j <= i. */
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
