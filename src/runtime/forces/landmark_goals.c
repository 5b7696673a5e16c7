/* landmark_goals.c: where landmarks' points of the model are, and where they want to be. A point off the surface keeps
 * to its foot there; the vertices around the foot turn what lies between.
 * Bounds: SMR_LANDMARK_NEAR pairs of a fit for a landmark off the surface.
 * SPDX-License-Identifier: MIT */
#include "runtime/forces/landmark_goals.h"

#define SMR_MORE_SHARE 0.2f /* of what is left in an iteration, added to what a hard landmark asks for */
#define SMR_MORE_MOST 0.1f  /* of the reach: most that is asked for beyond its place */

void smr_landmark_goals_layout(smr_arena *a, smr_landmark_goals *g, const smr_shared *shared)
{
    if (shared->config.n_landmarks == 0u)
        return;
    g->landmark = smr_arena_take(a, shared->config.n_landmarks, sizeof *g->landmark);
    g->seen = smr_arena_take(a, shared->n, 1);
}

void smr_landmark_goals_wire(smr_landmark_goals *g, const smr_shared *shared, const smr_pace *pace,
                             const smr_shape *shape)
{
    g->shared = shared;
    g->pace = pace;
    g->shape = shape;
    g->reach = smr_max(SMR_HARD_EDGES * smr_le_float(shared->model->edge_mm), 1.0e-3f);
}

void smr_landmark_goals_reset(smr_landmark_goals *g)
{
    if (g->seen != NULL)
        memset(g->seen, 0, g->shared->n);
    for (uint32_t k = 0; k < g->n; k++)
        g->landmark[k].more = smr_v(0, 0, 0);
}

/* At the last radius, where that has clusters of several vertices, a hard landmark asks for more by what is left, until
 * it is reached (integral control). */
void smr_landmark_goals_stand(smr_landmark_goals *g)
{
    const float most = SMR_MORE_MOST * g->reach;
    if (!smr_at_last_radius(g->shared, g->pace) || g->pace->lists.largest <= 1u)
        return;
    for (uint32_t k = 0; k < g->n; k++) {
        smr_bound_landmark *b = &g->landmark[k];
        if (b->given.hard == 0u)
            continue;
        const smr_vec left = smr_sub(smr_landmark_goal(g, k), smr_landmark_foot(g, k, g->shape->x));
        const smr_vec more = smr_add(b->more, smr_scale(left, SMR_MORE_SHARE));
        const float length = smr_length(more);
        b->more = length > most ? smr_scale(more, most / length) : more;
    }
}

smr_vec smr_landmark_foot(const smr_landmark_goals *g, uint32_t k, float *xyz)
{
    const smr_bound_landmark *b = &g->landmark[k];
    smr_vec sum = smr_v(0, 0, 0);
    for (uint32_t c = 0; c < 3u; c++)
        sum = smr_add(sum, smr_scale(smr_load(smr_at3(xyz, b->corner[c])), b->share[c]));
    return sum;
}

smr_vec smr_landmark_apart(const smr_landmark_goals *g, uint32_t k)
{
    const smr_bound_landmark *b = &g->landmark[k];
    smr_fit fit;
    if (b->n_near == 0u)
        return smr_v(0, 0, 0);
    smr_fit_start(&fit, b->foot, smr_load(smr_at3(g->shape->x, b->corner[0])));
    for (uint32_t i = 0; i < b->n_near; i++)
        smr_fit_add(&fit, smr_rest(g->shared, b->near[i]), smr_load(smr_at3(g->shape->x, b->near[i])), 1.0f);
    const smr_pose pose = smr_fit_solve(&fit, 1);
    return smr_sub(smr_pose_apply(&pose, b->apart), smr_v(pose.m[0][3], pose.m[1][3], pose.m[2][3]));
}

smr_vec smr_landmark_goal(const smr_landmark_goals *g, uint32_t k)
{
    const smr_vec place = smr_sub(smr_load(g->landmark[k].given.place), g->shape->origin);
    return smr_sub(place, smr_landmark_apart(g, k));
}

float smr_landmark_prevails(const smr_landmark_goals *g, uint32_t k, uint32_t v)
{
    const smr_bound_landmark *b = &g->landmark[k];
    const smr_vec at = smr_load(smr_at3(g->shape->start, v));
    float least = g->reach * g->reach;
    for (uint32_t c = 0; c < 3u; c++) {
        const smr_vec d = smr_sub(at, smr_load(smr_at3(g->shape->start, b->corner[c])));
        if (b->share[c] > 0.0f)
            least = smr_min(least, smr_dot(d, d));
    }
    return smr_bump(SMR_SQRT(least) / g->reach);
}
