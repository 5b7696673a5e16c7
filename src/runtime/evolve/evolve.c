/* evolve.c: averaged goal positions x~_i = Sum_i(T) x^r_i / |zeta_i|, relaxation x += relaxation (x~ - x), normals carried
 * by the averaged rotation, and the state hash (paper 2.3, evolution).
 * SPDX-License-Identifier: MIT */
#include "base/fixed_point.h"
#include "runtime/state.h"

/* A vertex' part of the hash: the sum over vertices does not depend on their order or on the number of threads. */
static uint64_t hash_point(uint32_t index, const float *p)
{
    const uint64_t xy = (uint64_t)smr_float_bits(p[0] + 0.0f) << 32 | smr_float_bits(p[1] + 0.0f);
    const uint64_t zi = (uint64_t)smr_float_bits(p[2] + 0.0f) << 32 | index;
    return smr_mix(xy + 0x9e3779b97f4a7c15u * smr_mix(zi));
}

void smr_evolve(void *arg, uint32_t task, uint32_t worker)
{
    smr *s = arg;
    (void)worker;
    const float inverse_r = 1.0f / s->scale[0], inverse_t = 1.0f / s->scale[1];
    for (uint32_t v = task * SMR_CHUNK; v < smr_chunk_end(s, task); v++) {
        const uint32_t *w = s->sum + SMR_WORDS * (size_t)v;
        const float share = s->share[v];
        float r_minus_i[9];
        for (uint32_t i = 0; i < 9u; i++)
            r_minus_i[i] = smr_unfix(w[i], inverse_r) * share;
        const smr_vec t = smr_v(smr_unfix(w[9], inverse_t), smr_unfix(w[10], inverse_t), smr_unfix(w[11], inverse_t));
        const smr_vec ref = smr_load(smr_at3(s->x_ref, v)), old = smr_load(smr_at3(s->x, v));
        const smr_vec goal = smr_add(ref, smr_add(smr_mul(r_minus_i, ref), smr_scale(t, share)));
        const smr_vec step = smr_scale(smr_sub(goal, old), s->config.relaxation);
        const smr_vec next = smr_add(smr_add(old, step), smr_even_step(s, v));
        smr_store(smr_at3(s->x_next, v), next);
        const smr_vec n = smr_load(smr_at3(s->normal_ref, v));
        smr_spare_set(s, v, smr_unit(smr_add(n, smr_mul(r_minus_i, n))));
    }
}

void smr_evolve_end(smr *s)
{
    for (uint32_t i = 0; i < s->n_parts; i++)
        s->part[i].facets.xyz = s->x_next;
}

/* Displacements and the hash of the positions that stand. */
void smr_settle(void *arg, uint32_t task, uint32_t worker)
{
    smr *s = arg;
    (void)worker;
    smr_tally *tally = &s->tally[task];
    tally->max = 0.0f;
    tally->hash = 0;
    for (uint32_t v = task * SMR_CHUNK; v < smr_chunk_end(s, task); v++) {
        const smr_vec moved = smr_sub(smr_load(smr_at3(s->x_next, v)), smr_load(smr_at3(s->x, v)));
        tally->max = smr_max(tally->max, smr_dot(moved, moved));
        tally->hash += hash_point(v, smr_at3(s->x_next, v));
    }
}

void smr_settle_end(smr *s)
{
    float max2 = 0.0f;
    s->hash = 0;
    for (uint32_t t = 0; t < s->n_tasks; t++) {
        max2 = smr_max(max2, s->tally[t].max);
        s->hash += s->tally[t].hash;
    }
    s->moved_mm = SMR_SQRT(max2);
    s->exact = s->config.normals == SMR_NORMALS_EXACT || smr_schedule_plastic(s);
}

uint32_t smr_stand_tasks(smr *s)
{
    (void)s;
    return 1;
}

void smr_stand(void *arg, uint32_t task, uint32_t worker)
{
    smr *s = arg;
    float *swap = s->x;
    (void)task;
    (void)worker;
    s->x = s->x_next;
    s->x_next = swap;
    for (uint32_t v = 0; v < s->n; v++)
        smr_store(smr_at3(s->normal, v), smr_spare(s, v));
    smr_mend_abandon(s);
    s->report.displacement_max_mm = s->moved_mm;
    s->report.state_hash = s->hash;
    s->iteration++;
    s->radius_iteration++;
    s->since_plastic++;
    smr_schedule_next(s);
    if (s->since_plastic == 0u)
        memcpy(s->normal_ref, s->normal, 3u * (size_t)s->n * sizeof(float));
}

uint64_t smr_state_hash(const smr *s)
{
    if (!smr_valid(s))
        return 0;
    uint64_t hash = 0;
    for (uint32_t v = 0; v < s->n; v++)
        hash += hash_point(v, smr_at3(s->x, v)) + 3u * hash_point(v, smr_at3(s->x_ref, v));
    return hash;
}
