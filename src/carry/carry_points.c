/* carry_points.c: moves bound points to a present shape: one sum of SMR_CARRY_NEAR terms for each point.
 * Bounds: a pass over the vertices of the thinnest selection and the bound points.
 * SPDX-License-Identifier: MIT */
#include "base/bytes.h"
#include "carry/carry.h"
#include "geometry/rotation/similarity_fit.h"

/* A call in tasks of SMR_CARRY_CHUNK points. */
typedef struct chunks {
    const smr_carry_call *call;
    smr_carry_each *each; /* function that is called for each point */
} chunks;

static void run_chunk(void *arg, uint32_t task, uint32_t worker)
{
    const chunks *a = arg;
    const uint32_t first = task * SMR_CARRY_CHUNK, end = smr_min_u32(a->call->n, first + SMR_CARRY_CHUNK);
    for (uint32_t i = first; i < end; i++)
        a->each(a->call, &a->call->c->site[worker], i);
}

static smr_pose trend_of(const smr_carry *c, const float *now)
{
    const smr_carry_thin *t = &c->thin[c->n_densities - 1u];
    smr_fit fit;
    smr_fit_start(&fit, smr_v(0, 0, 0), smr_get3(now, smr_carry_item(c, t->first)));
    for (uint32_t i = 0; i < t->n; i++) {
        const uint32_t v = t->first + i * t->stride;
        smr_fit_add(&fit, smr_get3(c->rest, v), smr_get3(now, smr_carry_item(c, v)), 1.0f);
    }
    return smr_fit_solve(&fit, 1);
}

smr_status smr_carry_run(smr_carry_call *call, smr_carry_each *each)
{
    chunks all = {call, each};
    call->trend = trend_of(call->c, call->now);
    return smr_fork(&call->c->port, run_chunk, &all, smr_ceil_div(call->n, SMR_CARRY_CHUNK)) ? SMR_OK : SMR_E_STATE;
}

smr_status smr_carry_check(const smr_carry *c, const float *now)
{
    if (c == NULL || now == NULL)
        return SMR_E_NULL;
    if (c->magic != SMR_CARRY_MAGIC || c->self != c)
        return SMR_E_STATE;
    if (c->guard != smr_byte_sum(0, c, offsetof(smr_carry, guard)))
        return SMR_E_DAMAGED;
    return smr_all_within(now, 3u * (size_t)c->n_vertices, SMR_COORD_MAX) ? SMR_OK : SMR_E_INPUT;
}

/* Writes the present position of point i, mm. The sum is relative to the nearest vertex, which limits rounding. */
static void apply(const smr_carry_call *m, SMR_UNUSED smr_carry_site *s, uint32_t i)
{
    const uint32_t *near = m->c->near + (size_t)SMR_CARRY_NEAR * i;
    const float *coefficient = m->c->coefficient + (size_t)SMR_CARRY_NEAR * i;
    const float *left = m->c->rest_part + 4u * (size_t)i;
    const uint32_t n = m->c->n_vertices;
    const smr_vec from = smr_get3(m->now, smr_index(near[0], n)), rest = smr_load(left);
    smr_vec sum = smr_v(0, 0, 0);
    for (uint32_t k = 1; k < SMR_CARRY_NEAR; k++)
        sum = smr_add(sum, smr_scale(smr_sub(smr_get3(m->now, smr_index(near[k], n)), from), coefficient[k]));
    const smr_vec open = smr_sub(smr_column(&m->trend, 3), from);
    sum = smr_add(sum, smr_add(smr_pose_turn(&m->trend, rest), smr_scale(open, left[3])));
    smr_put3(m->out, i, smr_add(from, sum));
}

smr_status smr_carry_apply(smr_carry *carry, const float *now, float *xyz)
{
    SMR_TRY(xyz == NULL ? SMR_E_NULL : smr_carry_check(carry, now));
    smr_carry_call call = {.c = carry, .now = now, .out = xyz, .n = carry->n_points};
    return smr_carry_run(&call, apply);
}
