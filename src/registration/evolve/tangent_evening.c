/* tangent_evening.c: evens out, along the surface, how neighbours have moved, at the last radius. Nothing else there
 * decides where on the surface a vertex comes to lie: clusters are single vertices, forces are normal to the target.
 * So every choice that a last bit decided on the way (which triangle is nearer, who is just within a cluster) would
 * stay in the result, and grow. Evened is the displacement from the rest shape in its pose of that moment: x moves
 * towards the place where its displacement is the mean of its mesh neighbours', tangentially only. Towards the end
 * this fades. Where folds were held back it ends: it would push against that again and again, and how far this gives
 * way is a matter of last bits.
 * Bounds: one pass over triangles and vertices.
 * SPDX-License-Identifier: MIT */
#include "registration/evolve/evolve.h"

void smr_evening_begin(smr_evening *e)
{
    const smr_config *c = &e->shared->config;
    e->share = 0.0f;
    if (c->dynamics.mode || !smr_at_last_radius(e->shared, e->pace) || e->pace->tracking || e->pace->repairing > 0u ||
        e->goals->n_goals == 0u)
        return;
    const float left = 1.0f - (float)e->pace->radius_iteration / (float)c->basic.iterations_last;
    e->share = c->basic.even * left * left;
}

uint32_t smr_evening_tasks(const void *arg)
{
    const smr_evening *e = arg;
    return e->share > 0.0f ? e->shared->n_tasks : 0u;
}

uint32_t smr_evening_ring_tasks(const void *arg)
{
    const smr_evening *e = arg;
    return e->share > 0.0f ? smr_ceil_div(e->shared->n_triangles, SMR_TRIANGLE_CHUNK) : 0u;
}

void smr_evening_clear(void *arg, uint32_t task, uint32_t worker)
{
    smr_evening *e = arg;
    const smr_shared *shared = e->shared;
    const smr_rings rings = e->rings;
    const smr_pose pose = e->shape->rest_pose;
    float *const x = e->shape->x;
    const int first = e->pace->radius_iteration == 0u;
    const uint32_t last = smr_chunk_end(shared, task);
    (void)worker;
    for (uint32_t v = task * SMR_CHUNK; v < last; v++) {
        if (first)
            e->held[v] = 0;
        smr_store(smr_at3(rings.sum, v), smr_v(0, 0, 0));
        rings.weight[v] = 0.0f;
        const smr_vec rest = smr_pose_apply(&pose, smr_rest(shared, v));
        smr_store(smr_at3(rings.displacement, v), smr_sub(smr_load(smr_at3(x, v)), rest));
    }
}

/* Sums of the mesh neighbours' displacements. Triangles share vertices: one task after the other. */
void smr_evening_rings(void *arg, uint32_t task, uint32_t worker)
{
    smr_evening *e = arg;
    (void)worker;
    const uint32_t last = smr_min_u32((task + 1u) * SMR_TRIANGLE_CHUNK, e->shared->n_triangles);
    for (uint32_t k = task * SMR_TRIANGLE_CHUNK; k < last; k++)
        smr_ring_add(&e->rings, e->shared->triangle + 3u * (size_t)k, e->rings.displacement);
}

smr_vec smr_evening_way(const smr_evening *e, uint32_t v)
{
    if (!(e->share > 0.0f) || !e->goals->target[smr_model_owner(e->shared->model, v)].begun ||
        !(e->rings.weight[v] > 0.0f))
        return smr_v(0, 0, 0);
    const smr_vec mean = smr_scale(smr_load(smr_at3(e->rings.sum, v)), 1.0f / e->rings.weight[v]);
    const smr_vec way = smr_sub(mean, smr_load(smr_at3(e->rings.displacement, v)));
    const smr_vec n = smr_load(smr_at3(e->shape->normal, v));
    const smr_vec along = smr_sub(way, smr_scale(n, smr_dot(n, way)));
    return smr_scale(along, e->share * (1.0f - (float)e->held[v] / SMR_HELD));
}
