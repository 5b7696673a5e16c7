/* reference_blend.c: the blend of several subjects' shapes (a linear shape model; Cootes et al. 1995). The model stores
 * each further shape as differences from the model's own shape, after the similarity that fits best.
 * Bounds: SMR_REFERENCES_MAX differences for a vertex; one pass over the vertices when a start pose is set.
 * SPDX-License-Identifier: MIT */
#include "options/references/references.h"

#define SMR_VARIANCE_LEAST 1.0e-12f /* smallest divisor of a weight's variance, mm^2 */

void smr_references_layout(smr_arena *a, smr_references **references, const smr_shared *shared)
{
    const smr_stored_references *stored = smr_model_references(shared->model);
    smr_references none = {0}, *r = &none;
    if (stored == NULL)
        return;
    *references = smr_slot_scratch(a, *references, 1, sizeof **references);
    if (*references != NULL)
        r = *references;
    r->stored = stored;
    r->n = smr_le32(stored->n_others) + 1u;
    smr_keep_floats(a, r->weight, r->n, 0.0f, SMR_KEPT_UNIT);
    smr_keep_floats(a, r->turn, 9, -SMR_KEPT_MM, SMR_KEPT_MM);
}

/* Returns the difference at vertex v of shape i from the model's own, 1 <= i < n, mm in the rest shape's frame. */
static smr_vec difference(const smr_references *r, uint32_t i, uint32_t v)
{
    const size_t at = smr_le32(r->stored->n_vertices) * (size_t)(i - 1u) + v;
    const uint32_t *d = (const uint32_t *)(const void *)(r->stored + 1) + 3u * at;
    return smr_v(smr_le_float(d[0]), smr_le_float(d[1]), smr_le_float(d[2]));
}

/* Returns the displacement of start vertex v by the sum of (weight - less) times difference, mm. */
static smr_vec displaced(const smr_references *r, uint32_t v, float less)
{
    const float *const t = r->turn;
    smr_vec sum = smr_v(0, 0, 0);
    for (uint32_t i = 1; i < r->n; i++)
        sum = smr_add(sum, smr_scale(difference(r, i, v), r->weight[i] - less));
    return smr_v(smr_dot(smr_load(t), sum), smr_dot(smr_load(t + 3), sum), smr_dot(smr_load(t + 6), sum));
}

void smr_references_start(smr_shape *shape, int posed)
{
    smr_references *r = shape->references;
    for (uint32_t i = 0; i < r->n; i++)
        r->weight[i] = 1.0f / (float)r->n;
    for (uint32_t i = 0; i < 9u; i++)
        r->turn[i] = posed ? shape->rest_pose.m[i / 3u][i % 3u] : 0.0f;
    for (uint32_t v = 0; v < shape->shared->n; v++)
        smr_put3(shape->start, v, smr_add(smr_get3(shape->start, v), displaced(r, v, 0.0f)));
}

void smr_reference_modes(const smr_references *r, uint32_t v, smr_vec along, float *mode)
{
    const float *const t = r->turn;
    const smr_vec x = smr_scale(smr_load(t), along.x), y = smr_scale(smr_load(t + 3), along.y);
    const smr_vec back = smr_add(smr_add(x, y), smr_scale(smr_load(t + 6), along.z));
    float sum = 0.0f;
    mode[0] = 0.0f;
    for (uint32_t i = 1; i < r->n; i++) {
        mode[i] = smr_dot(back, difference(r, i, v));
        sum += mode[i];
    }
    for (uint32_t i = 0; i < r->n; i++)
        mode[i] -= sum / (float)r->n;
}

float smr_reference_variance(const smr_references *r, float prior)
{
    const smr_vec first = smr_v(r->turn[0], r->turn[3], r->turn[6]);
    const float variance = smr_le_float(r->stored->variance) * smr_dot(first, first);
    return 1.0f / smr_max(prior * (float)r->n * variance, SMR_VARIANCE_LEAST);
}

void smr_reference_choose(smr_references *r, const float *change)
{
    const float equal = 1.0f / (float)r->n;
    float sum = 0.0f;
    for (uint32_t i = 0; i < r->n; i++) {
        r->weight[i] = smr_clamp(equal + change[i], 0.0f, 1.0f);
        sum += r->weight[i];
    }
    for (uint32_t i = 0; i < r->n; i++)
        r->weight[i] = sum > 0.0f ? smr_min(r->weight[i] / sum, 1.0f) : equal;
}

smr_vec smr_reference_blend(const smr_references *r, uint32_t v) { return displaced(r, v, 1.0f / (float)r->n); }
