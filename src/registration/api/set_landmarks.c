/* set_landmarks.c: sets landmarks, binds them to the model, and reads their positions.
 * Bounds: for a new point one pass over the model's triangles, and one over its vertices.
 * SPDX-License-Identifier: MIT */
#include "options/track/track.h"
#include "geometry/box_tree/triangle.h"
#include "registration/api/setup.h"
#include "registration/tick/iteration_steps.h"

#define SMR_ON_SURFACE 1.0e-3f /* mm: points nearer to the surface count as on the surface */

static int legal(const smr *s, const smr_landmark *l)
{
    const int weighs = l->hard == 1u || (l->hard == 0u && l->weight >= 0.001f && l->weight <= 1000.0f);
    const int rests = l->vertex == SMR_NONE && smr_within3(smr_load(l->rest), SMR_COORD_MAX);
    if (!smr_within3(smr_load(l->place), SMR_COORD_MAX) || !weighs)
        return 0;
    if (l->structure == SMR_ALL)
        return rests;
    const uint32_t n = l->structure < s->shared.n_structures ? s->shape.structure[l->structure].n_vertices : 0u;
    return n > 0u && (rests || l->vertex < n);
}

static int same_point(const smr_landmark *a, const smr_landmark *b)
{
    const int same = a->structure == b->structure && a->vertex == b->vertex;
    return same && (a->vertex != SMR_NONE || memcmp(a->rest, b->rest, sizeof a->rest) == 0);
}

static void bind_vertex(smr_bound_landmark *b, const smr_shared *c, uint32_t v)
{
    b->corner[0] = b->corner[1] = b->corner[2] = v;
    b->share[0] = 1.0f;
    b->share[1] = b->share[2] = 0.0f;
    b->foot = smr_rest(c, v);
}

static int of_structure(const smr *s, uint32_t structure, uint32_t v)
{
    return structure == SMR_ALL || smr_model_owner(s->shared.model, v) == structure;
}

/* Binds a landmark to the nearest triangle of the rest shape. Returns 0 when the structure has no triangles. */
static int bind_triangle(smr_bound_landmark *b, const smr *s, smr_vec p)
{
    const smr_shared *c = &s->shared;
    float least = SMR_FAR, w[3];
    for (uint32_t k = 0; k < c->n_triangles; k++) {
        const uint32_t *t = smr_model_triangle(c, k);
        if (!of_structure(s, b->given.structure, t[0]))
            continue;
        const smr_vec corner[3] = {smr_rest(c, t[0]), smr_rest(c, t[1]), smr_rest(c, t[2])};
        const float d2 = smr_triangle_closest(p, corner[0], corner[1], corner[2], w);
        if (!(d2 < least))
            continue;
        least = d2;
        memcpy(b->corner, t, sizeof b->corner);
        memcpy(b->share, w, sizeof b->share);
        b->foot = smr_add(smr_scale(corner[0], w[0]), smr_add(smr_scale(corner[1], w[1]), smr_scale(corner[2], w[2])));
    }
    return least < SMR_FAR;
}

/* Lists the nearest vertices of the rest shape, at most `most`, in ascending order of distance. */
static void find_near(smr_bound_landmark *b, const smr *s, uint32_t structure, uint32_t most)
{
    float d2[SMR_LANDMARK_NEAR];
    b->n_near = 0;
    for (uint32_t v = 0; v < s->shared.n; v++) {
        const smr_vec displacement = smr_sub(smr_rest(&s->shared, v), b->foot);
        const float far = smr_dot(displacement, displacement);
        uint32_t at = b->n_near;
        if (!of_structure(s, structure, v) || (at == most && far >= d2[most - 1u]))
            continue;
        at = at < most ? b->n_near++ : most - 1u;
        for (; at > 0u && d2[at - 1u] > far; at--) {
            d2[at] = d2[at - 1u];
            b->near[at] = b->near[at - 1u];
        }
        d2[at] = far;
        b->near[at] = v;
    }
}

/* Lists the most important vertices within the length of the offset from the foot: they lie apart. */
static void find_spread(smr_bound_landmark *b, const smr *s, uint32_t structure)
{
    const float most = smr_dot(b->offset, b->offset);
    b->n_near = 0;
    for (uint32_t v = 0; v < s->shared.n && b->n_near < SMR_LANDMARK_NEAR; v++)
        if (of_structure(s, structure, v) && smr_distance2(smr_rest(&s->shared, v), b->foot) <= most)
            b->near[b->n_near++] = v;
}

static void bind_rest(smr_bound_landmark *b, const smr *s)
{
    const smr_vec p = smr_sub(smr_load(b->given.rest), smr_model_centre(s->shared.model));
    b->foot = p;
    if (!bind_triangle(b, s, p)) {
        find_near(b, s, b->given.structure, 1);
        bind_vertex(b, &s->shared, b->near[0]);
    }
    b->offset = smr_sub(p, b->foot);
    b->n_near = 0;
    if (smr_dot(b->offset, b->offset) > SMR_ON_SURFACE * SMR_ON_SURFACE) {
        const uint32_t structure = smr_model_owner(s->shared.model, b->corner[0]);
        find_spread(b, s, structure);
        if (b->n_near < SMR_LANDMARK_NEAR)
            find_near(b, s, structure, SMR_LANDMARK_NEAR);
    } else
        b->offset = smr_v(0, 0, 0);
}

static void bind_point(smr_bound_landmark *b, const smr *s, const smr_landmark *given, int known)
{
    b->given = *given;
    if (known)
        return;
    b->more = smr_v(0, 0, 0);
    if (given->vertex == SMR_NONE) {
        bind_rest(b, s);
        return;
    }
    b->offset = smr_v(0, 0, 0);
    b->n_near = 0;
    bind_vertex(b, &s->shared,
                smr_model_position(s->shared.model, s->shape.structure[given->structure].first_vertex + given->vertex));
}

smr_status smr_set_landmarks(smr *s, const smr_landmark *landmarks, uint32_t n)
{
    SMR_TRY(landmarks == NULL && n > 0u ? SMR_E_NULL : smr_settable(s, SMR_HAS_PARTIAL, smr_ready(s)));
    if (n > s->shared.config.partial.n_landmarks)
        return SMR_E_ARENA;
    for (uint32_t i = 0; i < n; i++)
        if (!legal(s, &landmarks[i]))
            return SMR_E_INPUT;
    smr_forces_settle(s);
    smr_landmark_goals *g = &s->forces.landmarks;
    for (uint32_t i = 0; i < n; i++)
        bind_point(&g->landmark[i], s, &landmarks[i], i < g->n && same_point(&g->landmark[i].given, &landmarks[i]));
    g->n = n;
    s->schedule.n_set++;
    smr_restart_forces(s, n > 0u ? SMR_CHANGED_SHOWN : SMR_CHANGED);
    smr_changed(s, SMR_LOG_LANDMARKS, 0, landmarks, n);
    return SMR_OK;
}

smr_status smr_get_landmarks(const smr *s, float *xyz)
{
    const smr_status status = smr_readable(s, 0, xyz);
    for (uint32_t k = 0; status == SMR_OK && k < s->forces.landmarks.n; k++) {
        const smr_vec foot = smr_landmark_foot(&s->forces.landmarks, k, s->shape.x);
        smr_put3(xyz, k, smr_add(smr_add(foot, smr_landmark_offset(&s->forces.landmarks, k)), s->shape.origin));
    }
    return status;
}
