/* set_start_pose.c: sets the start positions of a registration: the rest shape in a pose, or given positions.
 * SPDX-License-Identifier: MIT */
#include "geometry/box_tree/hilbert_curve.h"
#include "geometry/surface/mesh.h"
#include "options/references/references.h"
#include "registration/schedule_radius.h"
#include "registration/api/setup.h"

#define SMR_FAR_OFF 500.0f     /* distance of the model from the origin, mm, from which on the origin is moved */
#define SMR_POSE_LEAST 1.0e-9f /* smallest legal determinant of a pose (metres to kilometres); reflections are below */
#define SMR_POSE_MOST 1.0e9f   /* largest legal determinant of a pose (kilometres to metres) */

/* Moves the origin, by whole millimetres, to the middle of a model far from the origin. */
static void centre_origin(smr *s)
{
    const smr_box box = smr_box_of(s->shape.x, s->shared.n);
    const smr_vec shift = smr_whole(smr_scale(smr_add(box.lo, box.hi), 0.5f));
    if (smr_dot(shift, shift) < SMR_FAR_OFF * SMR_FAR_OFF)
        return;
    for (uint32_t v = 0; v < s->shared.n; v++)
        smr_put3(s->shape.x, v, smr_sub(smr_get3(s->shape.x, v), shift));
    s->shape.origin = smr_add(s->shape.origin, shift);
}

/* Sets everything that follows from the start positions in x. by_pose 1: x is the rest shape in a pose. */
static void start_here(smr *s, int by_pose)
{
    smr_shape *shape = &s->shape;
    const size_t bytes = 3u * (size_t)s->shared.n * sizeof(float);
    centre_origin(s);
    const smr_mesh mesh = {shape->x, s->shared.triangle, s->shared.n, s->shared.n_triangles};
    shape->in_parts = 0;
    smr_rest_pose_now(shape);
    memcpy(shape->start, shape->x, bytes);
    if (smr_shape_find_parts(shape))
        smr_rest_pose_now(shape);
    if (smr_blends(shape))
        smr_references_start(shape, by_pose);
    shape->start_box = smr_box_of(shape->start, s->shared.n);
    memcpy(shape->x_ref, shape->x, bytes);
    memset(s->forces.force, 0, bytes);
    memset(s->folds.marked, 0, s->shared.n);
    s->folds.n_guarded = 0;
    if (SMR_HAS_CONTACT) {
        smr_volumes_start(&s->volumes);
        smr_smooth_start(&s->forces.smooth);
    }
    smr_triangles_now(shape);
    smr_abandon_iteration(s); /* may write normals of the iteration before */
    smr_mesh_normals(&mesh, shape->normal, NULL);
    smr_plastic_normals(shape);
    memset(&s->report, 0, sizeof s->report);
    s->refused = s->schedule.serial = 0;
    smr_schedule_start(s);
}

smr_status smr_set_pose(smr *s, const smr_pose *pose)
{
    SMR_TRY(pose == NULL ? SMR_E_NULL : smr_settable(s, 1, smr_ready(s)));
    if (!smr_all_within(&pose->m[0][0], 12, SMR_COORD_MAX))
        return SMR_E_INPUT;
    const float volume = smr_dot(smr_column(pose, 0), smr_cross(smr_column(pose, 1), smr_column(pose, 2)));
    const smr_vec centre = smr_model_centre(s->shared.model);
    const smr_vec moved = smr_pose_apply(pose, centre);
    const float border = SMR_COORD_MAX + 1.0f; /* mm: rounding may move the rest shape a little beyond SMR_COORD_MAX */
    if (!(volume >= SMR_POSE_LEAST && volume <= SMR_POSE_MOST) || !smr_within3(moved, border))
        return SMR_E_INPUT;
    for (uint32_t v = 0; v < s->shared.n; v++)
        if (!smr_within3(smr_pose_apply(pose, smr_add(smr_rest(&s->shared, v), centre)), border))
            return SMR_E_INPUT;
    s->shape.origin = smr_whole(moved);
    const smr_vec off = smr_sub(moved, s->shape.origin);
    smr_pose turn = *pose;
    turn.m[0][3] = turn.m[1][3] = turn.m[2][3] = 0.0f;
    for (uint32_t v = 0; v < s->shared.n; v++)
        smr_put3(s->shape.x, v, smr_add(smr_pose_apply(&turn, smr_rest(&s->shared, v)), off));
    start_here(s, 1);
    smr_changed(s, SMR_LOG_POSE, 0, pose, 0);
    return SMR_OK;
}

smr_status smr_set_positions(smr *s, uint32_t structure, const float *xyz)
{
    SMR_TRY(xyz == NULL ? SMR_E_NULL : smr_settable(s, 1, smr_ready(s)));
    if (structure >= s->shared.n_structures)
        return SMR_E_INPUT;
    const smr_shape_structure *one = &s->shape.structure[structure];
    if (!smr_all_within(xyz, 3u * (size_t)one->n_vertices, SMR_COORD_MAX))
        return SMR_E_INPUT;
    for (uint32_t i = 0; i < one->n_vertices; i++) {
        const uint32_t v = smr_model_position(s->shared.model, one->first_vertex + i);
        smr_put3(s->shape.x, v, smr_sub(smr_get3(xyz, i), s->shape.origin));
    }
    start_here(s, 0);
    smr_changed(s, SMR_LOG_POSITIONS, structure, xyz, one->n_vertices);
    return SMR_OK;
}
