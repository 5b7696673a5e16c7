/* evolve_positions.c: new positions (paper 2.3, evolution): x += relaxation (x~ - x) with x~_i = Sum_i(T) x^r_i /
 * |zeta_i|, normals rotated by the averaged rotation, and the state hash. In dynamics: x~, for the end of the sweep.
 * Bounds: two passes over the vertices.
 * SPDX-License-Identifier: MIT */
#include "registration/evolve/evolve_positions.h"

void smr_evolve_layout(smr_arena *a, smr_evolve *e, const smr_shared *shared)
{
    e->tangent_smooth.limited = smr_slot_bytes(a, e->tangent_smooth.limited, shared->n, UINT8_MAX);
    if (smr_target_slots(shared) > 0u)
        e->most2 = smr_slot_scratch(a, e->most2, shared->config.basic.n_workers * shared->n_structures, sizeof(float));
    smr_keep_floats(a, &e->moved_mm, 1, 0.0f, 2.0f * SMR_KEPT_MM);
}

void smr_evolve_reset(smr_evolve *e, uint32_t part, uint32_t parts)
{
    const smr_piece p = smr_part(e->shared->n, part, parts);
    memset(e->tangent_smooth.limited + p.first, 0, p.last - p.first);
    if (part == 0u && e->most2 != NULL)
        memset(e->most2, 0, e->shared->config.basic.n_workers * e->shared->n_structures * sizeof *e->most2);
}

/* Returns the displacement of ref by the average of the clusters' transforms, mm; rotates *normal. w: vertex' sum. */
static inline smr_vec average_displacement(int logs, const uint32_t *w, const float inverse[2], float share,
                                           smr_vec ref, smr_vec *normal)
{
    float r_minus_i[9];
    if (logs)
        return smr_twist_move(smr_average_twist(w, inverse, share), ref, normal);
    const smr_vec t = smr_average_transform(w, inverse, share, r_minus_i);
    *normal = smr_add(*normal, smr_mul(r_minus_i, *normal));
    return smr_add(smr_mul(r_minus_i, ref), t);
}

uint32_t smr_evolve_tasks(const void *arg) { return ((const smr_evolve *)arg)->shared->n_tasks; }

void smr_evolve_step(void *arg, uint32_t task, SMR_UNUSED uint32_t worker)
{
    const smr_evolve *e = arg;
    const smr_shape shape = *e->shape;
    uint32_t *const sum = e->sums->sum;
    const float *const share = e->reference->share, relaxation = e->shared->config.motion.relaxation;
    const float inverse[2] = {1.0f / e->sums->scale[0], 1.0f / e->sums->scale[1]};
    const uint32_t last = smr_chunk_end(e->shared, task);
    const int logs = smr_blends_logs(e->shared);
    for (uint32_t v = task * SMR_CHUNK; v < last; v++) {
        const smr_vec ref = smr_get3(shape.x_ref, v), old = smr_get3(shape.x, v);
        smr_vec n = smr_get3(shape.normal_ref, v);
        const uint32_t *const w = sum + SMR_WORDS * (size_t)v;
        const smr_vec goal = smr_add(ref, average_displacement(logs, w, inverse, share[v], ref, &n));
        const smr_vec step = smr_scale(smr_sub(goal, old), relaxation);
        const smr_vec next = smr_add(smr_add(old, step), smr_tangent_displacement(&e->tangent_smooth, v));
        smr_put3(shape.x_next, v, shape.from != NULL ? goal : next);
        smr_next_normal_set(sum, v, smr_unit(n));
    }
}

/* Returns the hash of a vertex' number and position x, mm. The sum over vertices does not depend on their order. */
uint64_t smr_hash_point(uint32_t v, const float *x)
{
    const uint64_t xy = (uint64_t)smr_float_bits(x[0] + 0.0f) << 32 | smr_float_bits(x[1] + 0.0f);
    const uint64_t zi = (uint64_t)smr_float_bits(x[2] + 0.0f) << 32 | v;
    return smr_mix(xy + 0x9e3779b97f4a7c15u * smr_mix(zi));
}

uint64_t smr_hash_positions(const float *xyz, uint32_t n)
{
    uint64_t hash = 0;
    for (uint32_t v = 0; v < n; v++)
        hash += smr_hash_point(v, xyz + 3u * (size_t)v);
    return hash;
}

/* Raises the worker's largest squared displacement of v's structure. */
static void note_moved(const smr_evolve *e, uint32_t v, uint32_t worker, float moved2)
{
    const uint32_t n = e->shared->n_structures;
    float *const most2 = e->most2 + worker * n + (n > 1u ? smr_model_owner(e->shared->model, v) : 0u);
    if (moved2 > *most2)
        *most2 = moved2;
}

void smr_evolve_measure(void *arg, uint32_t task, uint32_t worker)
{
    smr_evolve *e = arg;
    float *const x = e->shape->x, *const x_next = e->shape->x_next;
    const uint32_t last = smr_chunk_end(e->shared, task);
    float moved2 = 0.0f, sum = 0.0f;
    uint64_t hash = 0;
    for (uint32_t v = task * SMR_CHUNK; v < last; v++) {
        const smr_vec moved = smr_sub(smr_get3(x_next, v), smr_get3(x, v));
        moved2 = smr_max(moved2, smr_dot(moved, moved));
        if (e->most2 != NULL)
            note_moved(e, v, worker, smr_dot(moved, moved));
        sum += SMR_SQRT(smr_dot(moved, moved));
        hash += smr_hash_point(v, smr_at3(x_next, v));
    }
    e->tally[task].evolve.moved2 = moved2;
    e->tally[task].evolve.moved = sum;
    e->tally[task].evolve.hash = hash;
}

void smr_evolve_measure_end(smr_evolve *e)
{
    float moved2 = 0.0f, sum = 0.0f;
    e->hash = 0;
    for (uint32_t t = 0; t < e->shared->n_tasks; t++) {
        moved2 = smr_max(moved2, e->tally[t].evolve.moved2);
        sum += e->tally[t].evolve.moved;
        e->hash += e->tally[t].evolve.hash;
    }
    e->moved_mm = SMR_SQRT(moved2);
    e->mean_mm = sum / (float)e->shared->n;
}
