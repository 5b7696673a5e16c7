/* verdict_shape_measures.c: how a structure's shape differs from its rest shape: strain of edges, volume, rotations of
 * parts. Bounds: one pass over the triangles, and SMR_PARTS passes over the vertices.
 * SPDX-License-Identifier: MIT */
#include "geometry/rotation/rotation.h"
#include "verdict/verdict_measures.h"

#define SMR_PARTS 24u          /* parts whose rotation is measured */
#define SMR_PART_RADIUS 0.12f  /* radius of a part / diagonal of the structure's box */
#define SMR_CLOSED 1.0e-3f     /* largest |sum of area vectors| / area of a closed surface */
#define SMR_FLAT 1.0e-5f       /* volume / area^1.5 below which a body is flat and its volume not measured */
#define SMR_EDGE_LEAST 1.0e-6f /* mm: shorter edges are not measured */
#define SMR_RATIO_MOST 1.0e6f  /* largest ratio of scales or volumes */

/* Returns the angle in degrees whose cosine is c, to a thousandth of a degree. */
static float degrees_of(float c)
{
    float low = 0.0f, high = 180.0f;
    for (uint32_t i = 0; i < 18u; i++) {
        const float middle = 0.5f * (low + high);
        if (smr_cos_degrees(middle) > c)
            low = middle;
        else
            high = middle;
    }
    return 0.5f * (low + high);
}

/* Fits the similarity from the rest shape (from_start 1: from the start positions) to the present positions. */
static smr_pose pose_of(const smr *s, const smr_shape_structure *one, int from_start)
{
    const smr_model *m = s->shared.model;
    const uint32_t first = smr_model_position(m, one->first_vertex);
    smr_fit fit;
    smr_fit_start(&fit, from_start ? smr_get3(s->shape.start, first) : smr_rest(&s->shared, first),
                  smr_get3(s->shape.x, first));
    for (uint32_t i = 0; i < one->n_vertices; i++) {
        const uint32_t v = smr_model_position(m, one->first_vertex + i);
        smr_fit_add(&fit, from_start ? smr_get3(s->shape.start, v) : smr_rest(&s->shared, v), smr_get3(s->shape.x, v),
                    1.0f);
    }
    return smr_fit_solve(&fit, 1);
}

/* Returns the scale of a similarity: the root mean square of its singular values. */
static float scale_of(const smr_pose *p)
{
    return SMR_SQRT((p->m[0][0] * p->m[0][0] + p->m[0][1] * p->m[0][1] + p->m[0][2] * p->m[0][2] +
                     p->m[1][0] * p->m[1][0] + p->m[1][1] * p->m[1][1] + p->m[1][2] * p->m[1][2] +
                     p->m[2][0] * p->m[2][0] + p->m[2][1] * p->m[2][1] + p->m[2][2] * p->m[2][2]) *
                    (1.0f / 3.0f));
}

static void add_edges(const smr *s, const smr_shape_structure *one, float scale, smr_evidence *e)
{
    for (uint32_t k = 0; k < one->tree.n_triangles; k++) {
        const uint32_t *t = smr_model_triangle(&s->shared, one->first_triangle + k);
        for (uint32_t c = 0; c < 3u; c++) {
            const uint32_t a = t[c], b = t[(c + 1u) % 3u];
            const float now = smr_length(smr_sub(smr_get3(s->shape.x, a), smr_get3(s->shape.x, b)));
            const float rest = scale * smr_length(smr_sub(smr_rest(&s->shared, a), smr_rest(&s->shared, b)));
            if (rest > SMR_EDGE_LEAST)
                smr_mean_add(&e->strain2, (now / rest - 1.0f) * (now / rest - 1.0f), 1.0f);
        }
    }
}

static float det(smr_vec a, smr_vec b, smr_vec c) { return smr_dot(a, smr_cross(b, c)); }

static void add_volume(const smr *s, const smr_shape_structure *one, float scale, smr_evidence *e)
{
    float now = 0.0f, rest = 0.0f, area = 0.0f;
    smr_vec all = smr_v(0, 0, 0);
    if (one->tree.n_triangles == 0u)
        return;
    const uint32_t first = smr_model_triangle(&s->shared, one->first_triangle)[0];
    const smr_vec o = smr_get3(s->shape.x, first), r = smr_rest(&s->shared, first);
    for (uint32_t k = 0; k < one->tree.n_triangles; k++) {
        const uint32_t *t = smr_model_triangle(&s->shared, one->first_triangle + k);
        smr_vec x[3], y[3];
        for (uint32_t c = 0; c < 3u; c++) {
            x[c] = smr_sub(smr_get3(s->shape.x, t[c]), o);
            y[c] = smr_sub(smr_rest(&s->shared, t[c]), r);
        }
        const smr_vec n = smr_cross(smr_sub(y[1], y[0]), smr_sub(y[2], y[0]));
        now += det(x[0], x[1], x[2]);
        rest += det(y[0], y[1], y[2]);
        area += smr_length(n);
        all = smr_add(all, n);
    }
    if (smr_length(all) > SMR_CLOSED * area || !(smr_abs(rest) > SMR_FLAT * area * SMR_SQRT(area)))
        return;
    rest *= scale * scale * scale;
    const int far = !(smr_abs(now) < SMR_RATIO_MOST * smr_abs(rest));
    smr_mean_add(&e->volume, far ? SMR_RATIO_MOST : now / rest, smr_abs(rest));
}

/* Returns the cosine of the angle between the rotations of two poses, each of which may have a scale. */
static float between(const smr_pose *a, const smr_pose *b)
{
    float trace = 0.0f;
    for (uint32_t r = 0; r < 3u; r++)
        for (uint32_t c = 0; c < 3u; c++)
            trace += a->m[r][c] * b->m[r][c];
    return smr_clamp(0.5f * (trace / (scale_of(a) * scale_of(b)) - 1.0f), -1.0f, 1.0f);
}

static void add_rotations(const smr *s, const smr_shape_structure *one, const smr_pose *whole, smr_evidence *e)
{
    const smr_model *m = s->shared.model;
    smr_vec lo = smr_rest(&s->shared, smr_model_position(m, one->first_vertex)), hi = lo;
    for (uint32_t i = 0; i < one->n_vertices; i++) {
        const smr_vec p = smr_rest(&s->shared, smr_model_position(m, one->first_vertex + i));
        lo = smr_low(lo, p);
        hi = smr_high(hi, p);
    }
    const float radius = SMR_PART_RADIUS * smr_length(smr_sub(hi, lo));
    for (uint32_t k = 0; k < SMR_PARTS; k++) {
        const uint32_t at = one->first_vertex + (uint32_t)((uint64_t)k * one->n_vertices / SMR_PARTS);
        const uint32_t centre = smr_model_position(m, at);
        const smr_vec from = smr_rest(&s->shared, centre);
        smr_fit fit;
        smr_fit_start(&fit, from, smr_get3(s->shape.x, centre));
        for (uint32_t i = 0; i < one->n_vertices; i++) {
            const uint32_t v = smr_model_position(m, one->first_vertex + i);
            const smr_vec d = smr_sub(smr_rest(&s->shared, v), from);
            if (smr_dot(d, d) <= radius * radius)
                smr_fit_add(&fit, smr_rest(&s->shared, v), smr_get3(s->shape.x, v), 1.0f);
        }
        if (fit.weight < 6.0f)
            continue;
        const smr_pose part = smr_fit_solve(&fit, 1);
        const float ratio = smr_min(scale_of(&part) / smr_max(scale_of(whole), 1.0e-6f), SMR_RATIO_MOST);
        smr_mean_add(&e->stretch2, (ratio - 1.0f) * (ratio - 1.0f), 1.0f);
        e->rotation_deg = smr_max(e->rotation_deg, degrees_of(between(&part, whole)));
    }
}

void smr_measure_shape(const smr *s, uint32_t structure, smr_evidence *e)
{
    const smr_shape_structure *one = &s->shape.structure[structure];
    const smr_pose whole = pose_of(s, one, 0);
    e->scale_rest = scale_of(&whole);
    add_edges(s, one, e->scale_rest, e);
    add_volume(s, one, e->scale_rest, e);
    add_rotations(s, one, &whole, e);
}

void smr_measure_moved(const smr *s, uint32_t structure, const smr_evidence *e, smr_verdict *verdict)
{
    static const smr_pose none = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    const smr_shape_structure all = {.first_vertex = 0, .n_vertices = s->shared.n};
    const smr_shape_structure *one = structure == SMR_ALL ? &all : &s->shape.structure[structure];
    const smr_pose start = pose_of(s, one, 1);
    verdict->scale_rest = e->scale_rest;
    if (structure == SMR_ALL && s->shared.n_structures > 1u) {
        const smr_pose rest = pose_of(s, one, 0);
        verdict->scale_rest = scale_of(&rest);
    }
    verdict->scale = scale_of(&start);
    verdict->turned_deg = degrees_of(between(&start, &none));
}
