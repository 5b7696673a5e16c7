/* tangential_smoothing.c: smooths displacements along the surface at the last radius, where nothing else determines the
 * place of a vertex on the surface: clusters are single vertices, and forces are normal to the target. Differences in
 * last bits would otherwise stay and grow. Displacements are from the rest shape in its pose. A vertex moves along the
 * surface towards its mesh neighbours' mean displacement, by a share that falls to 0 at the end, and at fold limits.
 * Where the target is noisy, it does so across the surface, too, by a share that the noise sets: of a mesh, whose noise
 * is known when it is built (surface_noise.c), or of points that show the whole with much noise for the mesh.
 * Bounds: one pass over triangles and vertices.
 * SPDX-License-Identifier: MIT */
#include "registration/evolve/evolve_positions.h"

#define SMR_ACROSS 0.25f     /* clouds: largest share of uneven motion across the surface that is taken back */
#define SMR_ACROSS_NONE 0.1f /* clouds: noise / mean edge up to which nothing is taken back across the surface, ... */
#define SMR_ACROSS_FULL 0.3f /* ... and from which on the largest share is */
#define SMR_ACROSS_MESH 0.5f /* the same three of meshes, whose noise is known to be noise */
#define SMR_ACROSS_MESH_NONE 0.02f
#define SMR_ACROSS_MESH_FULL 0.1f
#define SMR_ACROSS_SHOWN 0.9f /* share of visible vertices above which points show the whole */
#define SMR_ACROSS_LEAST 350u /* vertices of the smallest structure of which a vertex and its ring are a fiftieth */

void smr_tangent_begin(smr_tangent_smooth *e)
{
    const smr_config *c = &e->shared->config;
    e->share = 0.0f;
    if (c->dynamics.mode || !smr_at_last_radius(e->shared, e->schedule) || e->schedule->tracking ||
        e->schedule->repairing > 0u || e->goals->n_goals == 0u)
        return;
    const float left = smr_positive(1.0f - (float)e->schedule->radius_iteration / (float)c->basic.iterations_last);
    e->share = c->basic.even * left * left;
}

uint32_t smr_tangent_tasks(const void *arg)
{
    const smr_tangent_smooth *e = arg;
    return e->share > 0.0f ? e->shared->n_tasks : 0u;
}

uint32_t smr_tangent_sum_tasks(const void *arg)
{
    const smr_tangent_smooth *e = arg;
    return e->share > 0.0f ? smr_triangle_tasks(e->shared) : 0u;
}

void smr_tangent_clear(void *arg, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_tangent_smooth *e = arg;
    const smr_shared *shared = e->shared;
    const smr_rings rings = e->rings;
    const smr_pose pose = e->shape->rest_pose;
    float *const x = e->shape->x;
    const int first = e->schedule->radius_iteration == 0u;
    const uint32_t last = smr_chunk_end(shared, task);
    for (uint32_t v = task * SMR_CHUNK; v < last; v++) {
        if (first)
            e->limited[v] = 0;
        smr_put3(rings.sum, v, smr_v(0, 0, 0));
        rings.weight[v] = 0.0f;
        const smr_vec rest = smr_pose_apply(&pose, smr_rest_in_parts(e->shape, v));
        smr_put3(rings.displacement, v, smr_sub(smr_get3(x, v), rest));
    }
}

/* Sums the displacements of each vertex' mesh neighbours. Triangles share vertices, so tasks run in order. */
void smr_tangent_sum(void *arg, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_tangent_smooth *e = arg;
    const uint32_t last = smr_min_u32((task + 1u) * SMR_TRIANGLE_CHUNK, e->shared->n_triangles);
    for (uint32_t k = task * SMR_TRIANGLE_CHUNK; k < last; k++)
        smr_ring_add(&e->rings, smr_model_triangle(e->shared, k), e->rings.displacement);
}

/* Returns 0 up to `none`, 1 from `full` on. */
static float ramp(float x, float none, float full) { return smr_clamp((x - none) / (full - none), 0.0f, 1.0f); }

/* Returns the share of uneven motion across the surface that is taken back at the last radius: by a mesh's noise; or by
 * a cloud's, but where the cloud shows a part, and on small structures. */
static float across_share(const smr_tangent_smooth *e, uint32_t structure, smr_target_noise noise)
{
    const smr_target *const t = &e->goals->target[structure];
    if (noise.mesh > 0.0f)
        return SMR_ACROSS_MESH * ramp(noise.mesh, SMR_ACROSS_MESH_NONE, SMR_ACROSS_MESH_FULL);
    if (!(noise.cloud > 0.0f))
        return 0.0f;
    const int whole = t->n_judged == 0u || (float)t->n_visible > SMR_ACROSS_SHOWN * (float)t->n_judged;
    if (!whole || e->shape->structure[structure].n_vertices < SMR_ACROSS_LEAST)
        return 0.0f;
    return SMR_ACROSS * ramp(noise.cloud, SMR_ACROSS_NONE, SMR_ACROSS_FULL);
}

float smr_noise_smoothed(const smr_tangent_smooth *e, uint32_t structure)
{
    const smr_config *c = &e->shared->config;
    const int acts = c->basic.even > 0.0f && !c->dynamics.mode && smr_at_last_radius(e->shared, e->schedule) &&
                     !e->schedule->tracking;
    const smr_target_noise noise = smr_noise_of(&e->goals->target[structure], smr_le_float(e->shared->model->edge_mm));
    return acts ? 1.0f + across_share(e, structure, noise) / SMR_ACROSS : 1.0f;
}

smr_vec smr_tangent_displacement(const smr_tangent_smooth *e, uint32_t v)
{
    const uint32_t owner = smr_model_owner(e->shared->model, v);
    if (!(e->share > 0.0f) || !e->goals->target[owner].had_target || !(e->rings.weight[v] > 0.0f))
        return smr_v(0, 0, 0);
    const smr_vec mean = smr_scale(smr_get3(e->rings.sum, v), 1.0f / e->rings.weight[v]);
    const smr_vec displacement = smr_sub(mean, smr_get3(e->rings.displacement, v));
    const smr_vec n = smr_get3(e->shape->normal, v), across = smr_scale(n, smr_dot(n, displacement));
    const float kept = 1.0f - (float)e->limited[v] / SMR_LIMITED_FULL,
                noise = across_share(e, owner, e->goals->target[owner].noise);
    const smr_vec along = smr_scale(smr_sub(displacement, across), e->share * kept);
    return noise > 0.0f ? smr_add(along, smr_scale(across, noise * kept)) : along;
}
