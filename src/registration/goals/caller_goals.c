/* caller_goals.c: goals and forces that the caller supplies. The caller's force is evaluated once for each chunk of
 * vertices, before goals are searched for. Stored outputs do not depend on threads and budgets.
 * Bounds: one call for each SMR_CALLER_CHUNK active vertices, two calls where the force is checked.
 * SPDX-License-Identifier: MIT */
#include "registration/goals/caller_goals.h"

#define SMR_OUTPUT_MULTIPLIER 0x9e3779b97f4a7c15u /* 2^64 divided by the golden ratio */

/* Stores the checksum of what the caller's force returned for all active vertices in g->sum. */
static void stand(smr_caller_goals *g)
{
    g->summed = g->force != NULL;
    g->sum = g->schedule->n_active;
    for (size_t i = 0; g->summed && i < 2u * (size_t)g->schedule->n_active; i++) {
        const uint64_t two =
            (uint64_t)smr_float_bits(g->force_output[2u * i]) << 32 | smr_float_bits(g->force_output[2u * i + 1u]);
        g->sum = smr_mix(g->sum * SMR_OUTPUT_MULTIPLIER + two);
    }
}

/* The arguments of one call of the caller's force, and its output. */
typedef struct chunk {
    uint32_t structure[SMR_CALLER_CHUNK], vertex[SMR_CALLER_CHUNK];
    float xyz[SMR_CALLER_CHUNK][3], rest[SMR_CALLER_CHUNK][3];
    float displacement[SMR_CALLER_CHUNK][3], weight[SMR_CALLER_CHUNK];
} chunk;

static void call(const smr_caller_goals *g, const smr_force_view *view, chunk *c)
{
    memset(c->displacement, 0, sizeof c->displacement);
    memset(c->weight, 0, sizeof c->weight);
    g->force(g->ctx, view, c->displacement[0], c->weight);
}

/* Stores the output of a call. Returns 0 when a value of the output is not legal. */
static int keep(smr_caller_goals *g, const chunk *c, uint32_t first, uint32_t n)
{
    int good = 1;
    for (uint32_t i = 0; i < n; i++) {
        float *to = g->force_output + 4u * ((size_t)first + i);
        good &= smr_within3(smr_load(c->displacement[i]), SMR_COORD_MAX);
        good &= c->weight[i] >= 0.0f && c->weight[i] <= SMR_CALLER_WEIGHT;
        memcpy(to, c->displacement[i], 3u * sizeof(float));
        to[3] = c->weight[i];
    }
    return good;
}

/* Returns 1 when the stored output of the first call equals that of this second call. */
static int same(const smr_caller_goals *g, const chunk *c, uint32_t first, uint32_t n)
{
    int alike = 1;
    for (uint32_t i = 0; i < n; i++) {
        const float *was = g->force_output + 4u * ((size_t)first + i);
        alike &=
            memcmp(was, c->displacement[i], 3u * sizeof *was) == 0 && memcmp(was + 3, &c->weight[i], sizeof *was) == 0;
    }
    return alike;
}

/* Returns the caller's number of vertex v in its structure, an index of the caller's arrays also after a fault. */
static uint32_t place_of(const smr_caller_goals *g, uint32_t v, uint32_t owner)
{
    const smr_shape_structure *one = &g->shape->structure[owner];
    return smr_index(smr_model_original(g->shared->model, v) - one->first_vertex, one->n_vertices);
}

static void ask(smr_caller_goals *g, uint32_t task)
{
    chunk c;
    const smr_model *model = g->shared->model;
    const uint32_t first = task * SMR_CALLER_CHUNK;
    const uint32_t n = smr_min_u32(g->schedule->n_active - first, SMR_CALLER_CHUNK);
    const float *normal = g->shape->normal + 3u * (size_t)first;
    const smr_force_view view = {
        n, g->schedule->iteration, g->schedule->lists.radius, c.structure, c.vertex, c.xyz[0], normal, c.rest[0]};
    for (uint32_t i = 0; i < n; i++) {
        const uint32_t v = first + i, owner = smr_model_owner(model, v);
        c.structure[i] = owner;
        c.vertex[i] = place_of(g, v, owner);
        smr_store(c.xyz[i], smr_add(smr_get3(g->shape->x, v), g->shape->origin));
        smr_store(c.rest[i], smr_add(smr_rest(g->shared, v), smr_model_centre(model)));
    }
    call(g, &view, &c);
    int good = keep(g, &c, first, n);
    if (g->shared->config.caller.force == SMR_CALLER_CHECKED) {
        call(g, &view, &c);
        good &= same(g, &c, first, n);
    }
    if (!good)
        __atomic_store_n(&g->broken, 1u, __ATOMIC_RELAXED);
}

/* Returns the weight of the goal that smr_set_goals() gave vertex v; *displacement: from v to that goal, mm. */
static float set_goal(const smr_caller_goals *g, uint32_t v, smr_vec *displacement)
{
    const uint32_t owner = smr_model_owner(g->shared->model, v);
    const smr_goals *own = &g->goals[owner];
    const uint32_t i = place_of(g, v, owner);
    if (own->xyz == NULL)
        return 0.0f;
    const smr_vec goal = smr_get3(own->xyz, i);
    const float weight = own->weights != NULL ? own->weights[i] : 1.0f;
    if (!smr_within3(goal, SMR_COORD_MAX) || !(weight <= SMR_CALLER_WEIGHT))
        return 0.0f; /* no goal: the caller has made the array illegal since smr_set_goals() */
    *displacement = smr_sub(smr_sub(goal, g->shape->origin), smr_get3(g->shape->x, v));
    return weight;
}

/* Averages a displacement of this weight with the caller's displacements of v, mm. Returns the sum of the weights. */
static float blend(const smr_caller_goals *g, uint32_t v, smr_vec *displacement, float weight)
{
    smr_vec own = smr_v(0, 0, 0);
    if (g->goals != NULL) {
        const float of_goal = set_goal(g, v, &own);
        smr_blend(displacement, &weight, own, of_goal);
    }
    if (g->force != NULL)
        smr_blend(displacement, &weight, smr_load(g->force_output + 4u * (size_t)v),
                  g->force_output[4u * (size_t)v + 3u]);
    return weight;
}

const smr_caller_calls smr_caller_all = {ask, blend, stand};
