/* carry_apply.c: moves bound points to the present shape: one sum of SMR_CARRY_NEAR terms for each.
 * SPDX-License-Identifier: MIT */
#include "base/parallel.h"
#include "carry/carry.h"
#include "geometry/rotation/similarity_fit.h"
#include "geometry/surface/mesh.h"

/* One call: present vertices, the similarity T, and the results. */
typedef struct job {
    smr_carry *c;
    const float *now; /* [n_vertices][3] present positions in the caller's order, mm */
    smr_pose trend;
    float *out; /* [n_points][3] results, mm */
} job;

smr_carry_site *smr_carry_site_of(smr_carry *c, uint32_t worker)
{
    if (worker < c->port.n_workers)
        return &c->site[worker];
    __atomic_store_n(&c->wrong_worker, 1u, __ATOMIC_RELAXED); /* any thread may set it */
    return NULL;
}

smr_status smr_carry_run(smr_carry *c, smr_task run, void *arg, uint32_t n)
{
    c->wrong_worker = 0;
    smr_fork(&c->port, run, arg, smr_ceil_div(n, SMR_CARRY_CHUNK));
    return __atomic_load_n(&c->wrong_worker, __ATOMIC_RELAXED) != 0u ? SMR_E_STATE : SMR_OK;
}

smr_pose smr_carry_trend(const smr_carry *c, const float *now)
{
    const smr_carry_thin *t = &c->thin[c->n_densities - 1u];
    smr_fit fit;
    smr_fit_start(&fit, smr_v(0, 0, 0), smr_get3(now, c->item[t->first]));
    for (uint32_t i = 0; i < t->n; i++) {
        const size_t v = (size_t)t->first + (size_t)i * t->stride;
        smr_fit_add(&fit, smr_load(c->rest + 3u * v), smr_get3(now, c->item[v]), 1.0f);
    }
    return smr_fit_solve(&fit, 1);
}

smr_status smr_carry_check(const smr_carry *c, const float *now)
{
    if (c == NULL || now == NULL)
        return SMR_E_NULL;
    if (c->magic != SMR_CARRY_MAGIC || c->self != c)
        return SMR_E_STATE;
    return smr_all_within(now, 3u * (size_t)c->n_vertices, SMR_COORD_MAX) ? SMR_OK : SMR_E_INPUT;
}

/* The position of point i, computed relative to the nearest vertex, which limits rounding. */
static smr_vec apply(const job *j, uint32_t i)
{
    const uint32_t *near = j->c->near + (size_t)SMR_CARRY_NEAR * i;
    const float *coefficient = j->c->coefficient + (size_t)SMR_CARRY_NEAR * i;
    const float *left = j->c->rest_part + 4u * (size_t)i;
    const smr_vec from = smr_get3(j->now, near[0]), rest = smr_load(left);
    smr_vec sum = smr_v(0, 0, 0);
    for (uint32_t k = 1; k < SMR_CARRY_NEAR; k++)
        sum = smr_add(sum, smr_scale(smr_sub(smr_get3(j->now, near[k]), from), coefficient[k]));
    const smr_vec open = smr_sub(smr_column(&j->trend, 3), from);
    sum = smr_add(sum, smr_add(smr_pose_turn(&j->trend, rest), smr_scale(open, left[3])));
    return smr_add(from, sum);
}

static void run_apply(void *arg, uint32_t task, uint32_t worker)
{
    const job *j = arg;
    const uint32_t first = task * SMR_CARRY_CHUNK, end = smr_min_u32(j->c->n_points, first + SMR_CARRY_CHUNK);
    if (smr_carry_site_of(j->c, worker) == NULL) /* no scratch is needed, but the worker's number must exist */
        return;
    for (uint32_t i = first; i < end; i++)
        smr_put3(j->out, i, apply(j, i));
}

smr_status smr_carry_apply(smr_carry *carry, const float *now, float *xyz)
{
    const smr_status status = xyz == NULL ? SMR_E_NULL : smr_carry_check(carry, now);
    if (status != SMR_OK)
        return status;
    job j = {carry, now, smr_carry_trend(carry, now), xyz};
    return smr_carry_run(carry, run_apply, &j, carry->n_points);
}
