/* verdict_shape_measures.c: how a structure's shape differs from its rest shape: strain of edges, volume, rotations of
 * parts. Bounds: one pass over the triangles, and SMR_PARTS passes over the vertices.
 * SPDX-License-Identifier: MIT */
#include "geometry/box_tree/triangle.h"
#include "geometry/rotation/rotation.h"
#include "verdict/verdict_measures.h"

#define SMR_PARTS 24u          /* parts whose rotation is measured */
#define SMR_PART_RADIUS 0.12f  /* radius of a part / diagonal of the structure's box */
#define SMR_PART_LEAST 6u      /* fewest vertices of a part */
#define SMR_PART_PIECE 192u    /* vertices in a task, of which few lie in its part */
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

void smr_fit_piece(smr_judgement *j, uint32_t task, uint32_t first, uint32_t n, int from_start)
{
    const smr *s = j->s;
    const smr_piece piece = smr_piece_of(task, SMR_JUDGE_PIECE, n);
    for (uint32_t i = piece.first; i < piece.last; i++) {
        const uint32_t v = smr_model_position(s->shared.model, first + i);
        const smr_vec from = from_start ? smr_get3(s->shape.start, v) : smr_rest(&s->shared, v);
        if (i == 0u) {
            smr_fit_start(&j->fit, from, smr_get3(s->shape.x, v));
            j->box = (smr_box){from, from};
        }
        smr_fit_add(&j->fit, from, smr_get3(s->shape.x, v), 1.0f);
        smr_box_grow(&j->box, from);
    }
    if (piece.last == n)
        *(from_start ? &j->start : &j->rest) = smr_fit_solve(&j->fit, 1);
}

/* Returns the scale of a similarity: the root mean square of its singular values. */
static float scale_of(const smr_pose *p)
{
    return SMR_SQRT((p->m[0][0] * p->m[0][0] + p->m[0][1] * p->m[0][1] + p->m[0][2] * p->m[0][2] +
                     p->m[1][0] * p->m[1][0] + p->m[1][1] * p->m[1][1] + p->m[1][2] * p->m[1][2] +
                     p->m[2][0] * p->m[2][0] + p->m[2][1] * p->m[2][1] + p->m[2][2] * p->m[2][2]) *
                    (1.0f / 3.0f));
}

static void add_edges(smr_judgement *j, const uint32_t *t)
{
    const smr *s = j->s;
    for (uint32_t c = 0; c < 3u; c++) {
        const uint32_t a = t[c], b = t[(c + 1u) % 3u];
        const float now = smr_length(smr_sub(smr_get3(s->shape.x, a), smr_get3(s->shape.x, b)));
        const float rest = j->e.scale_rest * smr_length(smr_sub(smr_rest(&s->shared, a), smr_rest(&s->shared, b)));
        if (rest > SMR_EDGE_LEAST)
            smr_mean_add(&j->e.strain2, (now / rest - 1.0f) * (now / rest - 1.0f), 1.0f);
    }
}

static float det(smr_vec a, smr_vec b, smr_vec c) { return smr_dot(a, smr_cross(b, c)); }

/* Adds triangle t to the sums of volumes, counted from the first triangle's first corner, and of areas. */
static void add_volume(smr_judgement *j, const uint32_t *t)
{
    const smr *s = j->s;
    const uint32_t first = smr_triangle_of(smr_judged(j)->tree.triangle, 0, s->shared.n)[0];
    const smr_vec o = smr_get3(s->shape.x, first), r = smr_rest(&s->shared, first);
    smr_vec x[3], y[3];
    for (uint32_t c = 0; c < 3u; c++) {
        x[c] = smr_sub(smr_get3(s->shape.x, t[c]), o);
        y[c] = smr_sub(smr_rest(&s->shared, t[c]), r);
    }
    const smr_vec n = smr_cross(smr_sub(y[1], y[0]), smr_sub(y[2], y[0]));
    j->volume[0] += det(x[0], x[1], x[2]);
    j->volume[1] += det(y[0], y[1], y[2]);
    j->volume[2] += smr_length(n);
    j->areas = smr_add(j->areas, n);
}

/* Adds the volume ratio of a closed structure from the sums. */
static void take_volume(smr_judgement *j)
{
    const float now = j->volume[0], area = j->volume[2], scale = j->e.scale_rest;
    float rest = j->volume[1];
    if (smr_length(j->areas) > SMR_CLOSED * area || !(smr_abs(rest) > SMR_FLAT * area * SMR_SQRT(area)))
        return;
    rest *= scale * scale * scale;
    const int far = !(smr_abs(now) < SMR_RATIO_MOST * smr_abs(rest));
    smr_mean_add(&j->e.volume, far ? SMR_RATIO_MOST : now / rest, smr_abs(rest));
}

float smr_cosine_between(const smr_pose *a, const smr_pose *b)
{
    float trace = 0.0f;
    for (uint32_t r = 0; r < 3u; r++)
        for (uint32_t c = 0; c < 3u; c++)
            trace += a->m[r][c] * b->m[r][c];
    return smr_clamp(0.5f * (trace / (scale_of(a) * scale_of(b)) - 1.0f), -1.0f, 1.0f);
}

uint32_t smr_rest_fit_tasks(const void *job)
{
    const smr_judgement *j = job;
    return j->verdict != NULL ? smr_ceil_div(smr_judged(j)->n_vertices, SMR_JUDGE_PIECE) : 0u;
}

void smr_rest_fit_add(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_judgement *j = job;
    smr_fit_piece(j, task, smr_judged(j)->first_vertex, smr_judged(j)->n_vertices, 0);
    j->e.scale_rest = scale_of(&j->rest);
    memset(j->volume, 0, sizeof j->volume);
    j->areas = smr_v(0, 0, 0);
}

uint32_t smr_edges_tasks(const void *job)
{
    const smr_judgement *j = job;
    return j->verdict != NULL ? smr_ceil_div(smr_judged(j)->tree.n_triangles, SMR_JUDGE_PIECE) : 0u;
}

void smr_edges_measure(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_judgement *j = job;
    const smr_piece piece = smr_judged_triangles(j, task);
    for (uint32_t k = piece.first; k < piece.last; k++) {
        const uint32_t *t = smr_triangle_of(smr_judged(j)->tree.triangle, k, j->s->shared.n);
        add_edges(j, t);
        add_volume(j, t);
    }
    if (piece.last == smr_judged(j)->tree.n_triangles)
        take_volume(j);
}

/* ---- rotations of parts: tasks visit a piece of the vertices for each part, then the next piece ---- */

static smr_fit *fits(const smr_judgement *j) { return (smr_fit *)(void *)j->s->overlay.record; }

uint32_t smr_parts_abreast(const void *job)
{
    const smr_judgement *j = job;
    const size_t places = SMR_JUDGE_WORDS * sizeof(uint32_t) * j->s->shared.n / sizeof(smr_fit);
    return places < SMR_PARTS ? (uint32_t)places : SMR_PARTS; /* fewer only where all vertices are one piece */
}

_Static_assert(SMR_PARTS * sizeof(smr_fit) <= SMR_JUDGE_WORDS * sizeof(uint32_t) * SMR_PART_PIECE,
               "fits of several pieces");

uint32_t smr_parts_tasks(const void *job)
{
    const smr_judgement *j = job;
    const uint32_t n = smr_judged(j)->n_vertices;
    return j->verdict != NULL && n >= SMR_PART_LEAST ? SMR_PARTS * smr_ceil_div(n, SMR_PART_PIECE) : 0u;
}

void smr_parts_add(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    const smr_judgement *j = job;
    const smr *s = j->s;
    const uint32_t part = task % SMR_PARTS, n = smr_judged(j)->n_vertices;
    const smr_piece piece = smr_piece_of(task / SMR_PARTS, SMR_PART_PIECE, n);
    const uint32_t centre = smr_judged_vertex(j, (uint32_t)((uint64_t)part * n / SMR_PARTS));
    const float radius = SMR_PART_RADIUS * smr_length(smr_sub(j->box.hi, j->box.lo));
    const smr_vec from = smr_rest(&s->shared, centre);
    smr_fit *const fit = &fits(j)[part % smr_parts_abreast(j)];
    if (piece.first == 0u)
        smr_fit_start(fit, from, smr_get3(s->shape.x, centre));
    for (uint32_t i = piece.first; i < piece.last; i++) {
        const uint32_t v = smr_judged_vertex(j, i);
        const smr_vec d = smr_sub(smr_rest(&s->shared, v), from);
        if (smr_dot(d, d) <= radius * radius)
            smr_fit_add(fit, smr_rest(&s->shared, v), smr_get3(s->shape.x, v), 1.0f);
    }
}

void smr_parts_take(void *job, uint32_t first, uint32_t last)
{
    smr_judgement *j = job;
    const uint32_t final = smr_parts_tasks(j) - SMR_PARTS;
    for (uint32_t task = smr_max_u32(first, final); task < last; task++) {
        const smr_fit *fit = &fits(j)[task % SMR_PARTS % smr_parts_abreast(j)];
        if (fit->weight < (float)SMR_PART_LEAST)
            continue;
        const smr_pose part = smr_fit_solve(fit, 1);
        const float ratio = smr_min(scale_of(&part) / smr_max(scale_of(&j->rest), 1.0e-6f), SMR_RATIO_MOST);
        smr_mean_add(&j->e.stretch2, (ratio - 1.0f) * (ratio - 1.0f), 1.0f);
        j->e.rotation_deg = smr_max(j->e.rotation_deg, degrees_of(smr_cosine_between(&part, &j->rest)));
    }
}

void smr_measure_moved(const smr_judgement *j, uint32_t structure, const smr_evidence *e, smr_verdict *verdict)
{
    static const smr_pose none = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    const int several = structure == SMR_ALL && j->s->shared.n_structures > 1u;
    verdict->scale_rest = several ? scale_of(&j->rest) : e->scale_rest;
    verdict->scale = scale_of(&j->start);
    verdict->turned_deg = degrees_of(smr_cosine_between(&j->start, &none));
}
