/* carry_frames.c: frames and normals from five carried positions each: the point and the corners of a tetrahedron
 * around it. Their differences give the local linear map J, exactly where the map is linear.
 * SPDX-License-Identifier: MIT */
#include "carry/carry.h"
#include "geometry/linear_solve/eigen_jacobi.h"
#include "geometry/rotation/rotation.h"
#include "geometry/rotation/similarity_fit.h"

#define SMR_FRAME_SIDE 0.57735027f /* 1 / sqrt(3): coordinate of a tetrahedron's corners at distance 1 */

static const float SMR_FRAME_CORNER[SMR_FRAME_PLACES][3] = {
    {0.0f, 0.0f, 0.0f}, {1.0f, 1.0f, 1.0f}, {1.0f, -1.0f, -1.0f}, {-1.0f, 1.0f, -1.0f}, {-1.0f, -1.0f, 1.0f}};

smr_status smr_frame_places(const float *points, uint32_t n, float size_mm, float *places)
{
    if (points == NULL || places == NULL)
        return SMR_E_NULL;
    if (!(size_mm > 0.0f && size_mm <= SMR_COORD_MAX) || n > SMR_VERTICES_MAX ||
        !smr_all_within(points, 3u * (size_t)n, SMR_COORD_MAX))
        return SMR_E_INPUT;
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < SMR_FRAME_PLACES; k++)
            for (size_t axis = 0; axis < 3u; axis++)
                places[(i * SMR_FRAME_PLACES + k) * 3u + axis] =
                    points[3u * i + axis] + size_mm * SMR_FRAME_SIDE * SMR_FRAME_CORNER[k][axis];
    return SMR_OK;
}

/* Writes J, the linear map that takes the corners' rest offsets d to the present ones; sum d d^T = 4/3 size^2 I. */
static void local_map(const float *rest, const float *now, float jacobian[9])
{
    const smr_vec from = smr_load(rest), to = smr_load(now);
    float size2 = 0.0f;
    memset(jacobian, 0, 9u * sizeof *jacobian);
    for (uint32_t k = 1; k < SMR_FRAME_PLACES; k++) {
        const smr_vec d = smr_sub(smr_load(rest + 3u * k), from), e = smr_sub(smr_load(now + 3u * k), to);
        size2 += smr_dot(d, d);
        smr_add_product(jacobian, e, d);
    }
    for (uint32_t i = 0; i < 9u; i++)
        jacobian[i] *= size2 > 0.0f ? 3.0f / size2 : 0.0f;
}

static smr_pose rigid_part(const float jacobian[9], smr_vec from, smr_vec to)
{
    float v[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, turn[9];
    smr_pose pose = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    smr_polar(jacobian, v, turn);
    for (uint32_t i = 0; i < 9u; i++)
        pose.m[i / 3u][i % 3u] += turn[i];
    smr_pose_onto(&pose, from, to);
    return pose;
}

smr_status smr_frame_poses(const float *rest, const float *now, uint32_t n, smr_pose *poses, float *jacobians)
{
    const size_t step = 3u * (size_t)SMR_FRAME_PLACES;
    if (rest == NULL || now == NULL || (poses == NULL && jacobians == NULL))
        return SMR_E_NULL;
    if (n > SMR_VERTICES_MAX || !smr_all_within(rest, step * n, 4.0f * SMR_COORD_MAX) ||
        !smr_all_within(now, step * n, 4.0f * SMR_COORD_MAX))
        return SMR_E_INPUT;
    for (size_t i = 0; i < n; i++) {
        float jacobian[9];
        local_map(rest + step * i, now + step * i, jacobian);
        if (poses != NULL)
            poses[i] = rigid_part(jacobian, smr_load(rest + step * i), smr_load(now + step * i));
        if (jacobians != NULL)
            memcpy(jacobians + 9u * i, jacobian, sizeof jacobian);
    }
    return SMR_OK;
}

smr_status smr_frame_normals(const float *jacobians, float *normals, uint32_t n)
{
    if (jacobians == NULL || normals == NULL)
        return SMR_E_NULL;
    for (size_t i = 0; i < 9u * (size_t)n; i++)
        if (!smr_within(jacobians[i], 1.0e6f) || !smr_within(normals[i / 3u], 1.0e6f))
            return SMR_E_INPUT;
    for (size_t i = 0; i < n; i++) { /* multiplies the normal n by J's cofactor matrix, det(J) J^-T */
        const float *m = jacobians + 9u * i;
        const smr_vec a = smr_axis(m, 0), b = smr_axis(m, 1), c = smr_axis(m, 2);
        const smr_vec normal = smr_load(normals + 3u * i);
        const smr_vec turned =
            smr_add(smr_add(smr_scale(smr_cross(b, c), normal.x), smr_scale(smr_cross(c, a), normal.y)),
                    smr_scale(smr_cross(a, b), normal.z));
        smr_store(normals + 3u * i, smr_unit(turned));
    }
    return SMR_OK;
}
