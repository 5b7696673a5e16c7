/* tracking_rest_shape.c: tracking's rest shape is the result of the coarse-to-fine schedule. The reference shape x^r is
 * the rest shape in new poses, not x, so errors do not accumulate. Clusters find small rotations best, and parts may
 * turn against each other: each iteration fits a rigid pose of each structure to x. x^r follows at its end. A structure
 * without triangles moves with the whole model.
 * Bounds: two passes over the vertices in chunks; a fit for each structure.
 * SPDX-License-Identifier: MIT */
#include "geometry/rotation/rotation.h"
#include "registration/shape/deformed_shape.h"

void smr_track_rest_layout(smr_arena *a, smr_shape *shape, const smr_shared *shared)
{
    const int predicted = shared->config.track.mode != SMR_TRACK_OFF && shared->config.track.ahead > 0.0f;
    smr_pose none = {{{0}}};
    uint32_t gone = 0;
    if (shared->config.track.mode == SMR_TRACK_OFF && !shared->config.dynamics.mode)
        return;
    shape->track_rest = smr_slot_scratch(a, shape->track_rest, 1, sizeof *shape->track_rest);
    shape->track_rest_x = smr_slot_floats(a, shape->track_rest_x, 3u * (size_t)shared->n, SMR_KEPT_MM);
    shape->track_pose = smr_slot_scratch(a, shape->track_pose, shared->n_structures, sizeof *shape->track_pose);
    if (smr_follows_images(shared))
        shape->image_x = smr_slot_floats(a, shape->image_x, 3u * (size_t)shared->n, SMR_KEPT_MM);
    if (predicted)
        shape->track_pose_last =
            smr_slot_scratch(a, shape->track_pose_last, shared->n_structures, sizeof *shape->track_pose_last);
    if (!smr_keeps(a))
        return;
    const int placed = shape->track_rest != NULL; /* 0: the saved values are only checked */
    if (predicted)
        smr_keep_words(a, placed ? &shape->track_rest->predicted : &gone, 1, 1);
    for (uint32_t i = 0; predicted && i < shared->n_structures; i++) {
        smr_keep_pose(a, placed ? &shape->track_pose[i] : &none, SMR_KEPT_MM);
        smr_keep_pose(a, placed ? &shape->track_pose_last[i] : &none, SMR_KEPT_MM);
    }
    smr_keep_pose(a, placed ? &shape->track_rest->rest_pose : &none, SMR_KEPT_MM);
}

void smr_track_rest_wire(smr_shape *shape)
{
    for (uint32_t i = 0; shape->track_rest != NULL && i < shape->shared->n_structures; i++)
        shape->track_rest->n_tasks += smr_ceil_div(shape->structure[i].n_vertices, SMR_MATCH_CHUNK);
}

void smr_track_rest_poses(smr_shape *shape)
{
    static const smr_pose identity = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    for (uint32_t i = 0; i < shape->shared->n_structures; i++) {
        shape->track_pose[i] = identity;
        if (shape->track_pose_last != NULL)
            shape->track_pose_last[i] = identity;
    }
    shape->track_rest->predicted = 0;
    shape->track_rest->rest_pose = shape->rest_pose;
}

void smr_track_rest_clear(smr_shape *shape)
{
    smr_track_rest_poses(shape);
    shape->track_rest->box = (smr_box){{SMR_FAR, SMR_FAR, SMR_FAR}, {-SMR_FAR, -SMR_FAR, -SMR_FAR}};
}

void smr_track_rest_add(smr_shape *shape, uint32_t v)
{
    const smr_vec x = smr_get3(shape->x_next, v);
    smr_put3(shape->track_rest_x, v, x);
    smr_box_grow(&shape->track_rest->box, x);
}

void smr_track_rest_keep_image(smr_shape *s) { memcpy(s->image_x, s->x, 3u * (size_t)s->shared->n * sizeof(float)); }

uint32_t smr_track_rest_sum_tasks(const void *arg)
{
    const smr_shape *shape = arg;
    return shape->track_rest->due ? shape->track_rest->n_tasks : 0u;
}

static void begin(smr_fit *fit) { smr_fit_start(fit, smr_v(0, 0, 0), smr_v(0, 0, 0)); }

/* Adds a chunk of vertices of one structure to the fits, in the caller's order. */
void smr_track_rest_sum(void *arg, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_shape *shape = arg;
    smr_track_rest *h = shape->track_rest;
    if (task == 0u) {
        h->structure = h->vertex = 0;
        begin(&h->one);
        begin(&h->all);
    }
    const smr_shape_structure *one = &shape->structure[h->structure];
    const uint32_t last = smr_min_u32(h->vertex + SMR_MATCH_CHUNK, one->n_vertices);
    for (; h->vertex < last; h->vertex++) {
        const uint32_t v = smr_model_position(shape->shared->model, one->first_vertex + h->vertex);
        const smr_vec from = smr_get3(shape->track_rest_x, v), x = smr_get3(shape->x_next, v);
        const smr_vec to = h->to != NULL ? h->to(shape->dynamics, v, x) : x;
        smr_fit_add(&h->one, from, to, 1.0f);
        smr_fit_add(&h->all, from, to, 1.0f);
    }
    if (h->vertex < one->n_vertices)
        return;
    shape->track_pose[h->structure] = smr_fit_solve(&h->one, 0);
    begin(&h->one);
    h->structure++;
    h->vertex = 0;
}

/* Returns the composition of two poses: first p, then q. */
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

void smr_track_rest_sum_end(smr_shape *shape)
{
    smr_track_rest *h = shape->track_rest;
    h->whole = smr_fit_solve(&h->all, 0);
    for (uint32_t i = 0; i < shape->shared->n_structures; i++)
        if (shape->structure[i].tree.n_triangles == 0u)
            shape->track_pose[i] = h->whole;
}

smr_vec smr_track_rest_posed(const smr_shape *shape, uint32_t v)
{
    const smr_pose *pose = &shape->track_pose[smr_model_owner(shape->shared->model, v)];
    return smr_pose_apply(pose, smr_get3(shape->track_rest_x, v));
}

void smr_track_rest_commit(smr_shape *shape)
{
    shape->track_rest->predicted = 0;
    shape->rest_pose = after(&shape->track_rest->whole, &shape->track_rest->rest_pose);
}

static smr_pose inverse(const smr_pose *p)
{
    smr_pose r;
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++)
            r.m[i][k] = p->m[k][i];
        r.m[i][3] = -(p->m[0][i] * p->m[0][3] + p->m[1][i] * p->m[1][3] + p->m[2][i] * p->m[2][3]);
    }
    return r;
}

/* Returns the rigid motion by this share of the turn and the shift of p, about the axis of p. */
static smr_twist part_of(const smr_pose *p, float share)
{
    float r_minus_i[9];
    for (uint32_t i = 0; i < 9u; i++)
        r_minus_i[i] = p->m[i / 3u][i % 3u] - (i % 4u == 0u ? 1.0f : 0.0f);
    smr_twist twist =
        smr_twist_about(smr_rotation_log(r_minus_i), smr_v(0, 0, 0), smr_v(p->m[0][3], p->m[1][3], p->m[2][3]));
    twist.turn = smr_scale(twist.turn, share);
    twist.rate = smr_scale(twist.rate, share);
    return twist;
}

/* Moves x and x^r of a structure by a rigid motion. The remaining share of the last displacement stays as momentum. */
static void move_structure(smr_shape *shape, uint32_t structure, const smr_twist *by)
{
    const smr_shape_structure *one = &shape->structure[structure];
    const float left = 1.0f - shape->shared->config.track.ahead;
    for (uint32_t i = 0; i < one->n_vertices; i++) {
        const uint32_t v = smr_model_position(shape->shared->model, one->first_vertex + i);
        smr_vec normal = smr_get3(shape->normal, v), none = smr_v(0, 0, 0);
        const smr_vec x = smr_get3(shape->x, v), ref = smr_get3(shape->x_ref, v);
        const smr_vec step = smr_sub(x, smr_get3(shape->x_next, v));
        smr_put3(shape->x, v, smr_add(x, smr_twist_move(*by, x, &normal)));
        smr_put3(shape->x_next, v, smr_sub(smr_get3(shape->x, v), smr_scale(step, left)));
        smr_put3(shape->x_ref, v, smr_add(ref, smr_twist_move(*by, ref, &none)));
        smr_put3(shape->normal, v, normal);
    }
}

void smr_track_rest_predict(smr_shape *shape, int steady)
{
    if (shape->track_pose_last == NULL || shape->track_rest->predicted)
        return;
    shape->track_rest->predicted = 1;
    for (uint32_t i = 0; i < shape->shared->n_structures; i++) {
        const smr_pose now = shape->track_pose[i], back = inverse(&shape->track_pose_last[i]), by = after(&now, &back);
        const smr_twist twist = part_of(&by, shape->shared->config.track.ahead);
        shape->track_pose_last[i] = now;
        if (steady)
            move_structure(shape, i, &twist);
    }
    if (steady)
        smr_triangles_now(shape);
}
