/* field_normals.c: the field of unseen vertices through what the target really shows. A surface holds a vertex along
 * its normal only, so a control tells one number: how far it lies from the pose along its normal. What runs along the
 * surface follows from the field, of which each component has the same kernel. Taken as seen, it would keep whatever
 * the start left there. The pose has taken its share of that, too, so the field contains the seven small motions of a
 * similarity, and they are added to the pose.
 * Bounds: those of unseen_field.c.
 * SPDX-License-Identifier: MIT */
#include "runtime/forces/unseen_field.h"

#define SMR_FIELD_ALIKE 0.9f     /* length of the mean of unit normals: above, they are those of a sheet */
#define SMR_FIELD_FAR 1.0e7f     /* mm: no coordinate is */
#define SMR_MOTION_VARIANCE 4.0f /* of the motions, over the field's: at a kernel length for turns and scale */

static float *motions(const smr_unseen_field *f, uint32_t k) { return f->motion + (size_t)SMR_FIELD_MOTIONS * k; }

uint32_t smr_field_normals_alike(const smr_unseen_field *f, const uint32_t *control)
{
    smr_vec sum = smr_v(0, 0, 0);
    for (uint32_t k = 0; k < f->n; k++)
        sum = smr_add(sum, smr_load(smr_at3(f->shape->normal, control[k])));
    return smr_dot(sum, sum) > SMR_FIELD_ALIKE * SMR_FIELD_ALIKE * (float)f->n * (float)f->n;
}

void smr_field_normals_begin(smr_unseen_field *f, const uint32_t *control, smr_vec middle)
{
    const float inverse = SMR_SQRT(f->per_length2);
    f->middle = smr_pose_apply(&f->pose, middle);
    for (uint32_t k = 0; k < f->n; k++) {
        const smr_vec n = smr_load(smr_at3(f->shape->normal, control[k]));
        const smr_vec posed = smr_pose_apply(&f->pose, smr_load(smr_at3(f->start, k)));
        const smr_vec arm = smr_scale(smr_sub(posed, f->middle), inverse), turn = smr_cross(arm, n);
        float *const m = motions(f, k);
        f->left[k] = smr_dot(n, smr_sub(smr_load(smr_at3(f->bend, k)), posed));
        smr_store(smr_at3(f->bend, k), n);
        smr_store(m, n);
        smr_store(m + 3, turn);
        m[6] = smr_dot(arm, n);
    }
}

float smr_field_normals_between(const smr_unseen_field *f, uint32_t i, uint32_t j, float kernel)
{
    const float *const a = motions(f, i), *const b = motions(f, j);
    float sum = 0.0f;
    for (uint32_t m = 0; m < SMR_FIELD_MOTIONS; m++)
        sum += a[m] * b[m];
    return kernel * smr_dot(smr_load(a), smr_load(b)) + SMR_MOTION_VARIANCE * sum;
}

/* left = (L L^T)^-1 left */
static void substitute(smr_unseen_field *f)
{
    float *const y = f->left;
    for (uint32_t i = 0; i < f->n; i++) {
        const float *const r = smr_field_row(f, i);
        for (uint32_t k = 0; k < i; k++)
            y[i] -= r[k] * y[k];
        y[i] /= r[i];
    }
    for (uint32_t i = f->n; i-- > 0u;) {
        const float *const r = smr_field_row(f, i);
        y[i] /= r[i];
        for (uint32_t k = 0; k < i; k++)
            y[k] -= r[k] * y[i];
    }
}

/* The motion of a point that lies at `arm` from the middle, in kernel lengths. */
static smr_vec moved(const float m[SMR_FIELD_MOTIONS], smr_vec arm)
{
    return smr_add(smr_cross(smr_load(m + 3), arm), smr_scale(arm, m[6]));
}

static smr_vec column(const smr_pose *p, uint32_t c) { return smr_v(p->m[0][c], p->m[1][c], p->m[2][c]); }

static void add_motions(smr_unseen_field *f, const float m[SMR_FIELD_MOTIONS])
{
    const float inverse = SMR_SQRT(f->per_length2);
    for (uint32_t c = 0; c < 4u; c++) {
        const smr_vec from = column(&f->pose, c), arm = c < 3u ? from : smr_sub(from, f->middle);
        const smr_vec shift = c < 3u ? smr_v(0, 0, 0) : smr_load(m);
        const smr_vec to = smr_add(smr_add(from, shift), moved(m, smr_scale(arm, inverse)));
        f->pose.m[0][c] = to.x;
        f->pose.m[1][c] = to.y;
        f->pose.m[2][c] = to.z;
    }
}

/* 1 for numbers that a field near the target has: not what rounding leaves where a model has gone very far. */
static int is_sane(const float *number, uint32_t n)
{
    for (uint32_t i = 0; i < n; i++)
        if (!(number[i] > -SMR_FIELD_FAR && number[i] < SMR_FIELD_FAR))
            return 0;
    return 1;
}

void smr_field_normals_end(smr_unseen_field *f)
{
    float sum[SMR_FIELD_MOTIONS] = {0};
    substitute(f);
    for (uint32_t k = 0; k < f->n; k++) {
        float *const to = smr_at3(f->bend, k);
        for (uint32_t m = 0; m < SMR_FIELD_MOTIONS; m++)
            sum[m] += SMR_MOTION_VARIANCE * f->left[k] * motions(f, k)[m];
        smr_store(to, smr_scale(smr_load(to), f->left[k]));
    }
    add_motions(f, sum);
    if (!is_sane(f->bend, 3u * f->n) || !is_sane(&f->pose.m[0][0], 12u))
        f->n = 0;
}
