/* held_shape.c: the shape that tracking is elastic about. It is the result of the coarse-to-fine schedule; the
 * reference shape x^r is that shape, not x, so errors do not creep into it. Clusters find small rotations best
 * (match/match.c), and parts may turn against each other: so each structure is carried by the rigid pose that lays it
 * onto x. The pose is fitted anew each time and nothing adds up; x^r follows when the iteration stands. A structure
 * without triangles goes with the whole model.
 * Bounds: a pass over the vertices in chunks and one in a piece, a fit for each structure.
 * SPDX-License-Identifier: MIT */
#include "runtime/deformed/shape.h"

void smr_held_layout(smr_arena *a, smr_shape *shape, const smr_shared *shared)
{
    smr_pose none = {{{0}}};
    if (shared->config.track == SMR_TRACK_OFF && !shared->config.dynamics)
        return;
    shape->held = smr_slot_scratch(a, shape->held, 1, sizeof *shape->held);
    shape->held_x = smr_slot_floats(a, shape->held_x, 3u * (size_t)shared->n, SMR_KEPT_MM);
    shape->held_pose = smr_slot_scratch(a, shape->held_pose, shared->n_structures, sizeof *shape->held_pose);
    if (!smr_keeps(a))
        return;
    smr_keep_pose(a, shape->held != NULL ? &shape->held->rest_pose : &none); /* where there are no slots yet */
}

void smr_held_wire(smr_shape *shape)
{
    smr_held *h = shape->held;
    if (h == NULL)
        return;
    memset(h, 0, sizeof *h);
    memset(shape->held_x, 0, 3u * (size_t)shape->shared->n * sizeof(float));
    for (uint32_t i = 0; i < shape->shared->n_structures; i++)
        h->n_tasks += smr_ceil_div(shape->structure[i].n_vertices, SMR_MATCH_CHUNK);
}

void smr_held_derive(smr_shape *shape)
{
    if (shape->held != NULL)
        shape->held->box = smr_box_of(shape->held_x, shape->shared->n);
}

void smr_held_start(smr_shape *shape)
{
    memcpy(shape->held_x, shape->x, 3u * (size_t)shape->shared->n * sizeof(float));
    shape->held->rest_pose = shape->rest_pose;
    smr_held_derive(shape);
}

uint32_t smr_held_sum_tasks(const void *arg)
{
    const smr_shape *shape = arg;
    return shape->held != NULL && shape->held->due ? shape->held->n_tasks : 0u;
}

static void begin(smr_fit *fit) { smr_fit_start(fit, smr_v(0, 0, 0), smr_v(0, 0, 0)); }

/* Where the pose is to lay a vertex: x, or, when a time step ends, where the next one starts. */
static smr_vec to_of(const smr_shape *shape, uint32_t v)
{
    const smr_vec x = smr_load(smr_at3(shape->x_next, v));
    return shape->dynamics == NULL ? x : smr_dynamics_ahead(shape->dynamics, v, x);
}

/* A chunk of one structure, in the caller's order. */
void smr_held_sum(void *arg, uint32_t task, uint32_t worker)
{
    smr_shape *shape = arg;
    smr_held *h = shape->held;
    (void)worker;
    if (task == 0u) {
        h->structure = h->vertex = 0;
        begin(&h->one);
        begin(&h->all);
    }
    const smr_shape_structure *one = &shape->structure[h->structure];
    const uint32_t last = smr_min_u32(h->vertex + SMR_MATCH_CHUNK, one->n_vertices);
    for (; h->vertex < last; h->vertex++) {
        const uint32_t v = smr_model_position(shape->shared->model, one->first_vertex + h->vertex);
        const smr_vec from = smr_load(smr_at3(shape->held_x, v)), to = to_of(shape, v);
        smr_fit_add(&h->one, from, to, 1.0f);
        smr_fit_add(&h->all, from, to, 1.0f);
    }
    if (h->vertex < one->n_vertices)
        return;
    shape->held_pose[h->structure] = smr_fit_solve(&h->one, 0);
    begin(&h->one);
    h->structure++;
    h->vertex = 0;
}

/* The pose q after p. */
static smr_pose after(const smr_pose *q, const smr_pose *p)
{
    smr_pose r;
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 4; k++)
            r.m[i][k] = q->m[i][0] * p->m[0][k] + q->m[i][1] * p->m[1][k] + q->m[i][2] * p->m[2][k];
        r.m[i][3] += q->m[i][3];
    }
    return r;
}

void smr_held_sum_end(smr_shape *shape)
{
    smr_held *h = shape->held;
    h->whole = smr_fit_solve(&h->all, 0);
    for (uint32_t i = 0; i < shape->shared->n_structures; i++)
        if (shape->structure[i].facets.n_triangles == 0u)
            shape->held_pose[i] = h->whole;
}

void smr_held_stand(smr_shape *shape)
{
    if (shape->held == NULL || !shape->held->due)
        return;
    shape->rest_pose = after(&shape->held->whole, &shape->held->rest_pose);
    for (uint32_t v = 0; v < shape->shared->n; v++) {
        const smr_pose *pose = &shape->held_pose[smr_model_owner(shape->shared->model, v)];
        smr_store(smr_at3(shape->x_ref, v), smr_pose_apply(pose, smr_load(smr_at3(shape->held_x, v))));
    }
}
