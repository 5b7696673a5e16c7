/* reference_blend.c: the blend of several subjects' shapes (a linear shape model; Cootes et al. 1995). The model stores
 * each shape's difference from the mean shape.
 * Bounds: SMR_REFERENCES_MAX differences for a vertex; one pass over the vertices when a start pose is set.
 * SPDX-License-Identifier: MIT */
#include "options/references/references.h"

void smr_references_layout(smr_arena *a, smr_references **references, const smr_shared *shared)
{
    smr_references none = {0}, *r = &none;
    if (shared->n_references == 0u)
        return;
    *references = smr_slot_scratch(a, *references, 1, sizeof **references);
    if (*references != NULL)
        r = *references;
    r->difference = smr_at(shared->model, smr_model_references(shared->model)->at);
    smr_keep_floats(a, r->more, shared->n_references, -1.0f, 1.0f);
    smr_keep_floats(a, r->pose.m[0], 12, -SMR_KEPT_MM, SMR_KEPT_MM);
}

smr_vec smr_reference_blend(const smr_shape *shape, uint32_t v, uint32_t first, uint32_t n, const float *weight)
{
    const smr_references *const r = shape->references;
    smr_vec sum = smr_v(0, 0, 0);
    for (uint32_t i = 0; i < n; i++) {
        const uint32_t *const d = r->difference + 3u * ((size_t)(first + i) * shape->shared->n + v);
        const smr_vec one = smr_v(smr_le_float(d[0]), smr_le_float(d[1]), smr_le_float(d[2]));
        sum = smr_add(sum, smr_scale(one, weight[i]));
    }
    return smr_pose_turn(&r->pose, sum);
}

void smr_references_start(smr_shape *shape, int posed, uint32_t first, uint32_t last)
{
    static const float back = -1.0f; /* from the model's own shape to the mean shape */
    smr_references *const r = shape->references;
    memset(r->more, 0, sizeof r->more);
    memset(&r->pose, 0, sizeof r->pose);
    if (!posed)
        return;
    r->pose = shape->rest_pose;
    for (uint32_t v = first; v < last; v++)
        smr_put3(shape->start, v, smr_add(smr_get3(shape->start, v), smr_reference_blend(shape, v, 0, 1, &back)));
}
