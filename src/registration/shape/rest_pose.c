/* rest_pose.c: the similarity that maps the rest shape onto the present positions, fitted when a registration or its
 * last radius starts. Tangential smoothing and fold repair use displacements from it, and it bounds the clusters' size.
 * Bounds: one pass over the vertices.
 * SPDX-License-Identifier: MIT */
#include "registration/shape/deformed_shape.h"

static void begin(smr_shape *shape) { smr_fit_start(&shape->fit, smr_v(0, 0, 0), smr_v(0, 0, 0)); }

static void add(smr_shape *shape, uint32_t from, uint32_t to)
{
    for (uint32_t v = from; v < to; v++)
        smr_fit_add(&shape->fit, smr_rest(shape->shared, v), smr_get3(shape->x, v), 1.0f);
}

uint32_t smr_rest_pose_tasks(const void *arg)
{
    const smr_shape *shape = arg;
    return shape->rest_pose_due ? smr_ceil_div(shape->shared->n, SMR_MATCH_CHUNK) : 0u;
}

void smr_rest_pose_sum(void *arg, uint32_t task, uint32_t worker)
{
    smr_shape *shape = arg;
    (void)worker;
    if (task == 0u)
        begin(shape);
    add(shape, task * SMR_MATCH_CHUNK, smr_min_u32((task + 1u) * SMR_MATCH_CHUNK, shape->shared->n));
}

void smr_rest_pose_end(smr_shape *shape)
{
    shape->rest_pose = smr_fit_solve(&shape->fit, 1);
    shape->rest_pose_due = 0;
}

void smr_rest_pose_now(smr_shape *shape)
{
    const uint32_t due = shape->rest_pose_due;
    begin(shape);
    add(shape, 0, shape->shared->n);
    smr_rest_pose_end(shape);
    shape->rest_pose_due = due;
}
