/* curvature_smoothing.c: smoothing towards the rest shape's curvature. The height of the mesh neighbours' mean above a
 * vertex, along the normal, is the discrete mean curvature (umbrella operator; Kobbelt et al. 1998). A vertex moves
 * along its normal until this height equals the height at rest, scaled like the start. Noise falls, while edges and
 * dents of the rest shape stay. Rigid motions and bending are not resisted; borders do not shrink.
 * Bounds: one pass over triangles and vertices.
 * SPDX-License-Identifier: MIT */
#include "options/contact/contact.h"

void smr_smooth_layout(smr_arena *a, smr_smooth *s, const smr_shared *shared)
{
    if (shared->config.contact.smooth > 0.0f)
        s->height = smr_slot_scratch(a, s->height, shared->n, sizeof *s->height); /* a restore recomputes heights */
}

uint32_t smr_smooth_tasks(const void *arg)
{
    const smr_smooth *s = arg;
    return s->height != NULL && s->schedule->repairing == 0u ? s->shared->n_tasks + smr_triangle_tasks(s->shared) : 0u;
}

void smr_smooth_sum(void *arg, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_smooth *s = arg;
    const uint32_t n = s->shared->n_tasks;
    if (task < n) {
        const size_t first = task * SMR_CHUNK, count = smr_chunk_end(s->shared, task) - first;
        memset(s->rings.sum + 3u * first, 0, 3u * count * sizeof(float));
        memset(s->rings.weight + first, 0, count * sizeof(float));
        return;
    }
    const uint32_t last = smr_min_u32((task - n + 1u) * SMR_TRIANGLE_CHUNK, s->shared->n_triangles);
    for (uint32_t k = (task - n) * SMR_TRIANGLE_CHUNK; k < last; k++)
        smr_ring_add(&s->rings, smr_model_triangle(s->shared, k), s->shape->x);
}

/* Returns the height of the mesh neighbours' mean position above vertex v, along the vertex' normal, mm. */
static float height_of(const smr_smooth *s, uint32_t v)
{
    if (!(s->rings.weight[v] > 0.0f))
        return 0.0f;
    const smr_vec middle = smr_scale(smr_get3(s->rings.sum, v), 1.0f / s->rings.weight[v]);
    return smr_dot(smr_get3(s->shape->normal, v), smr_sub(middle, smr_get3(s->shape->x, v)));
}

void smr_smooth_rest(smr_smooth *s, uint32_t task)
{
    for (uint32_t v = task * SMR_CHUNK; v < smr_chunk_end(s->shared, task); v++)
        s->height[v] = height_of(s, v);
}

smr_vec smr_smooth_blend(const smr_smooth *s, uint32_t v, smr_vec displacement)
{
    if (!s->shape->on_surface[v])
        return displacement;
    const float off = height_of(s, v) - s->side * smr_length(smr_column(&s->shape->rest_pose, 0)) * s->height[v];
    const smr_vec own = smr_scale(smr_get3(s->shape->normal, v), off);
    return smr_add(displacement, smr_scale(smr_sub(own, displacement), s->shared->config.contact.smooth));
}
