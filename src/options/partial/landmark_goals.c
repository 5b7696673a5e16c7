/* landmark_goals.c: positions of landmarks on the model and their goals. A landmark off the surface is attached to
 * its foot, the closest point of the surface; vertices around the foot, as far as the offset is long, rotate it.
 * Bounds: SMR_LANDMARK_NEAR pairs of a fit for a landmark off the surface.
 * SPDX-License-Identifier: MIT */
#include "geometry/linear_solve/eigen_jacobi.h"
#include "options/partial/partial.h"

#define SMR_MORE_SHARE 0.2f /* share of a hard landmark's residual that an iteration adds to the displacement `more` */
#define SMR_MORE_MOST 0.1f  /* largest displacement `more` of a hard landmark's goal / smr_landmark_goals.reach */

/* Returns a copy of the landmark *b in which all unused fields are 0, so that saves do not depend on them. */
static smr_bound_landmark without_rest(const smr_bound_landmark *b)
{
    smr_bound_landmark copy = *b;
    for (uint32_t i = copy.n_near; i < SMR_LANDMARK_NEAR; i++)
        copy.near[i] = 0;
    for (uint32_t c = 0; copy.given.vertex != SMR_NONE && c < 3u; c++)
        copy.given.rest[c] = 0.0f;
    copy.given.weight = copy.given.hard ? 0.0f : copy.given.weight;
    return copy;
}

/* Saves or restores a landmark as the caller gave it, its foot, offset and vertices. set: 1: the landmark is set. */
static void keep_landmark(smr_arena *a, smr_bound_landmark *b, const smr_shared *c, int set)
{
    smr_landmark *given = &b->given;
    smr_keep_words(a, &given->structure, 1, UINT32_MAX);
    smr_keep_words(a, &given->vertex, 1, UINT32_MAX);
    smr_keep_floats(a, given->rest, 3, -SMR_COORD_MAX, SMR_COORD_MAX);
    smr_keep_floats(a, given->place, 3, -SMR_COORD_MAX, SMR_COORD_MAX);
    smr_keep_floats(a, &given->weight, 1, 0.0f, 1000.0f);
    smr_keep_words(a, &given->hard, 1, 1);
    smr_keep_words(a, b->corner, 3, c->n - 1u);
    smr_keep_floats(a, b->share, 3, -0.001f, SMR_KEPT_UNIT);
    smr_keep_floats(a, &b->foot.x, 3, -SMR_KEPT_MM, SMR_KEPT_MM);
    smr_keep_floats(a, &b->offset.x, 3, -SMR_KEPT_MM, SMR_KEPT_MM);
    smr_keep_floats(a, &b->more.x, 3, -SMR_KEPT_MM, SMR_KEPT_MM);
    smr_keep_words(a, &b->n_near, 1, SMR_LANDMARK_NEAR);
    smr_keep_words(a, b->near, SMR_LANDMARK_NEAR, c->n - 1u);
    smr_keep_require(a, !set || given->hard || given->weight >= 0.001f);
    smr_keep_require(a, !set || smr_within(b->share[0] + b->share[1] + b->share[2] - 1.0f, 0.001f));
}

void smr_landmark_goals_layout(smr_arena *a, smr_landmark_goals *g, const smr_shared *shared)
{
    if (shared->config.partial.n_landmarks == 0u)
        return;
    g->landmark = smr_slot_scratch(a, g->landmark, shared->config.partial.n_landmarks, sizeof *g->landmark);
    g->visibility = smr_slot_bytes(a, g->visibility, shared->n, SMR_VISIBLE_ONE);
    smr_keep_words(a, &g->n, 1, shared->config.partial.n_landmarks);
    for (uint32_t k = 0; smr_keeps(a) && k < shared->config.partial.n_landmarks; k++) {
        const smr_bound_landmark none = {0};
        smr_bound_landmark b = k < g->n && g->landmark != NULL ? without_rest(&g->landmark[k]) : none;
        keep_landmark(a, &b, shared, k < g->n);
        if (g->landmark != NULL && a->keeper->mode == SMR_KEEP_RESTORE)
            g->landmark[k] = b;
    }
}

void smr_landmark_goals_reset(smr_landmark_goals *g, uint32_t part, uint32_t parts)
{
    const smr_piece p = smr_part(g->shared->n, part, parts);
    if (g->visibility != NULL)
        memset(g->visibility + p.first, 0, p.last - p.first);
    for (uint32_t k = 0; k < g->n; k++)
        g->landmark[k].more = smr_v(0, 0, 0);
}

/* Moves goals of hard landmarks by integral control, only at a last radius whose clusters have several vertices. */
void smr_landmark_keep(smr_landmark_goals *g, uint32_t k)
{
    const float most = SMR_MORE_MOST * g->reach;
    smr_bound_landmark *b = &g->landmark[k];
    if (!smr_at_last_radius(g->shared, g->schedule) || g->schedule->lists.largest <= 1u || b->given.hard == 0u)
        return;
    const smr_vec left = smr_sub(smr_landmark_goal(g, k), smr_landmark_foot(g, k, g->shape->x));
    const smr_vec more = smr_add(b->more, smr_scale(left, SMR_MORE_SHARE));
    const float length = smr_length(more);
    b->more = length > most ? smr_scale(more, most / length) : more;
}

smr_vec smr_landmark_foot(const smr_landmark_goals *g, uint32_t k, float *xyz)
{
    const smr_bound_landmark *b = &g->landmark[k];
    smr_vec sum = smr_v(0, 0, 0);
    for (uint32_t c = 0; c < 3u; c++)
        sum = smr_add(sum, smr_scale(smr_get3(xyz, b->corner[c]), b->share[c]));
    return sum;
}

smr_vec smr_landmark_offset(const smr_landmark_goals *g, uint32_t k)
{
    const smr_bound_landmark *b = &g->landmark[k];
    smr_fit fit;
    if (b->n_near == 0u)
        return smr_v(0, 0, 0);
    smr_fit_start(&fit, b->foot, smr_get3(g->shape->x, b->corner[0]));
    for (uint32_t i = 0; i < b->n_near; i++)
        smr_fit_add(&fit, smr_rest(g->shared, b->near[i]), smr_get3(g->shape->x, b->near[i]), 1.0f);
    const smr_pose pose = smr_fit_solve(&fit, 1);
    return smr_sub(smr_pose_apply(&pose, b->offset), smr_column(&pose, 3));
}

smr_vec smr_landmark_goal(const smr_landmark_goals *g, uint32_t k)
{
    return smr_sub(smr_sub(smr_load(g->landmark[k].given.place), g->shape->origin), smr_landmark_offset(g, k));
}

float smr_landmark_share(const smr_landmark_goals *g, uint32_t k)
{
    const smr_bound_landmark *b = &g->landmark[k];
    const float offset2 = smr_dot(b->offset, b->offset) * (float)b->n_near;
    float spread[6] = {0};
    for (uint32_t i = 0; i < b->n_near; i++) {
        const smr_vec d = smr_sub(smr_rest(g->shared, b->near[i]), b->foot);
        spread[SMR_XX] += d.x * d.x;
        spread[SMR_XY] += d.x * d.y;
        spread[SMR_XZ] += d.x * d.z;
        spread[SMR_YY] += d.y * d.y;
        spread[SMR_YZ] += d.y * d.z;
        spread[SMR_ZZ] += d.z * d.z;
    }
    const float *const m = spread, sum = m[SMR_XX] + m[SMR_YY] + m[SMR_ZZ];
    const float across2 = m[SMR_XY] * m[SMR_XY] + m[SMR_XZ] * m[SMR_XZ] + m[SMR_YZ] * m[SMR_YZ];
    const float along2 = m[SMR_XX] * m[SMR_XX] + m[SMR_YY] * m[SMR_YY] + m[SMR_ZZ] * m[SMR_ZZ] + 2.0f * across2;
    /* About the longest axis `near` resists a turn least. The root of all squares is the largest eigenvalue or a little
     * more; 1.5 makes up for it where `near` lies about as far in all directions. */
    const float reach2 = 1.5f * (sum - SMR_SQRT(along2));
    return offset2 > reach2 ? smr_max(reach2, 0.0f) / smr_max(offset2, SMR_SUM_TINY) : 1.0f;
}

float smr_landmark_hard_weight(const smr_landmark_goals *g, uint32_t k, uint32_t v)
{
    const smr_bound_landmark *b = &g->landmark[k];
    const smr_vec at = smr_get3(g->shape->start, v);
    float least = g->reach * g->reach;
    for (uint32_t c = 0; c < 3u; c++)
        if (b->share[c] > 0.0f)
            least = smr_min(least, smr_distance2(at, smr_get3(g->shape->start, b->corner[c])));
    return smr_wendland(SMR_SQRT(least) / g->reach);
}

int smr_landmark_binds(const smr_landmark_goals *g, uint32_t v)
{
    int binds = 0;
    for (uint32_t k = 0; k < g->n; k++)
        for (uint32_t c = 0; c < 3u; c++)
            binds |= g->landmark[k].corner[c] == v && g->landmark[k].share[c] > 0.0f;
    return binds;
}
