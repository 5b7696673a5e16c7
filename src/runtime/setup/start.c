/* start.c: where a registration starts: the rest shape under a pose, or any positions.
 * SPDX-License-Identifier: MIT */
#include "geometry/hilbert_curve.h"
#include "geometry/transform_fit.h"
#include "geometry/mesh.h"
#include "runtime/record/log.h"

#define SMR_FAR_OFF 500.0f /* mm */

static smr_vec rest_of(const smr *s, uint32_t v)
{
    const uint32_t *rest = (const uint32_t *)smr_at(s->model, s->model->at_rest) + 3u * (size_t)v;
    return smr_v(smr_le_float(rest[0]), smr_le_float(rest[1]), smr_le_float(rest[2]));
}

/* Moves the origin into the middle of a model that lies far from it, by whole millimetres. */
static void centre_origin(smr *s)
{
    const smr_box box = smr_box_of(s->x, s->n);
    const smr_vec shift = smr_whole(smr_scale(smr_add(box.lo, box.hi), 0.5f));
    if (smr_dot(shift, shift) < SMR_FAR_OFF * SMR_FAR_OFF)
        return;
    for (uint32_t v = 0; v < s->n; v++)
        smr_store(smr_at3(s->x, v), smr_sub(smr_load(smr_at3(s->x, v)), shift));
    s->origin = smr_add(s->origin, shift);
}

/* x holds the start, relative to origin: everything else follows. */
static void start_here(smr *s)
{
    const size_t bytes = 3u * (size_t)s->n * sizeof(float);
    centre_origin(s);
    const smr_mesh mesh = {s->x, s->triangle, s->n, s->n_triangles};
    smr_fit fit;
    smr_fit_start(&fit, smr_v(0, 0, 0), smr_v(0, 0, 0));
    for (uint32_t v = 0; v < s->n; v++)
        smr_fit_add(&fit, rest_of(s, v), smr_load(smr_at3(s->x, v)), 1.0f);
    s->fitted = smr_fit_solve(&fit, 1);
    memcpy(s->start, s->x, bytes);
    memcpy(s->x_ref, s->x, bytes);
    memcpy(s->x_next, s->x, bytes);
    memset(s->force, 0, bytes);
    memset(s->guard, 0, s->n);
    s->n_guarded = 0;
    smr_facets_now(s);
    smr_mesh_normals(&mesh, s->normal, NULL);
    memcpy(s->normal_ref, s->normal, bytes);
    smr_abandon_iteration(s);
    memset(&s->report, 0, sizeof s->report);
    smr_schedule_start(s);
}

smr_status smr_set_pose(smr *s, const smr_pose *pose)
{
    if (s == NULL || pose == NULL)
        return SMR_E_NULL;
    if (!smr_valid(s))
        return SMR_E_STATE;
    for (uint32_t i = 0; i < 12u; i++)
        if (!smr_within(pose->m[i / 4u][i % 4u], SMR_COORD_MAX))
            return SMR_E_INPUT;
    const smr_vec centre =
        smr_v(smr_le_float(s->model->centre[0]), smr_le_float(s->model->centre[1]), smr_le_float(s->model->centre[2]));
    const smr_vec moved = smr_pose_apply(pose, centre);
    const float border = SMR_COORD_MAX + 1.0f; /* the rest shape itself may be rounded a little beyond */
    if (!smr_within(moved.x, border) || !smr_within(moved.y, border) || !smr_within(moved.z, border))
        return SMR_E_INPUT;
    for (uint32_t v = 0; v < s->n; v++) {
        const smr_vec p = smr_pose_apply(pose, smr_add(rest_of(s, v), centre));
        if (!smr_within(p.x, border) || !smr_within(p.y, border) || !smr_within(p.z, border))
            return SMR_E_INPUT;
    }
    s->origin = smr_whole(moved);
    const smr_vec off = smr_sub(moved, s->origin);
    smr_pose turn = *pose;
    turn.m[0][3] = turn.m[1][3] = turn.m[2][3] = 0.0f;
    for (uint32_t v = 0; v < s->n; v++)
        smr_store(smr_at3(s->x, v), smr_add(smr_pose_apply(&turn, rest_of(s, v)), off));
    start_here(s);
    smr_log_pose(s, pose);
    return SMR_OK;
}

smr_status smr_set_positions(smr *s, uint32_t structure, const float *xyz)
{
    if (s == NULL || xyz == NULL)
        return SMR_E_NULL;
    if (!smr_valid(s))
        return SMR_E_STATE;
    if (structure >= s->n_parts)
        return SMR_E_INPUT;
    const smr_part *part = &s->part[structure];
    for (size_t i = 0; i < 3u * (size_t)part->n_vertices; i++)
        if (!smr_within(xyz[i], SMR_COORD_MAX))
            return SMR_E_INPUT;
    for (uint32_t i = 0; i < part->n_vertices; i++) {
        const uint32_t v = smr_model_position(s->model, part->first_vertex + i);
        smr_store(smr_at3(s->x, v), smr_sub(smr_load(xyz + 3u * (size_t)i), s->origin));
    }
    start_here(s);
    smr_log_positions(s, structure, xyz);
    return SMR_OK;
}
