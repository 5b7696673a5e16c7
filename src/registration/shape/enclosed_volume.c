/* enclosed_volume.c: the signed volume within closed triangles as a sum of cones (Zhang and Chen 2001), and its change,
 * a cubic, while vertices move along their normals. The cones' apex lies within the structure, which limits rounding.
 * Bounds: one pass over a structure's triangles; SMR_APEX_VERTICES vertices; SMR_NEWTON steps.
 * SPDX-License-Identifier: MIT */
#include "geometry/box_tree/triangle.h"
#include "geometry/surface/mesh.h"
#include "registration/shape/enclosed_volume.h"

#define SMR_SIXTH (1.0f / 6.0f)
#define SMR_APEX_VERTICES 64u /* largest number of vertices whose mean is the apex of the cones */
#define SMR_THIN 1.0e-3f      /* mm: volume / area below which a structure counts as without volume */
#define SMR_FLAT 1.0e-6f      /* least determinant of a covariance with largest entry 1 that has an orientation */
#define SMR_NEWTON 12u        /* number of Newton steps; the cubic is nearly linear where solved */

/* Returns the position of vertex v in xyz [n][3], mm; xyz NULL: in the rest shape. */
static smr_vec place(const smr_shape *shape, float *xyz, uint32_t v)
{
    return xyz != NULL ? smr_get3(xyz, v) : smr_rest(shape->shared, v);
}

smr_vec smr_cone_apex(const smr_shape *shape, uint32_t structure, float *xyz)
{
    const smr_shape_structure *one = &shape->structure[structure];
    const uint32_t n = smr_min_u32(one->n_vertices, SMR_APEX_VERTICES);
    smr_vec sum = smr_v(0, 0, 0);
    for (uint32_t i = 0; i < n; i++) {
        const uint32_t at = i * one->n_vertices / n; /* the product fits 32 bits: both factors are limited */
        const uint32_t v = smr_model_position(shape->shared->model, one->first_vertex + at);
        sum = smr_add(sum, place(shape, xyz, v));
    }
    return n > 0u ? smr_scale(sum, 1.0f / (float)n) : sum;
}

smr_enclosed smr_cone(const smr_vec at[3], const smr_vec normal[3])
{
    const smr_vec a = at[0], b = at[1], c = at[2], na = normal[0], nb = normal[1], nc = normal[2];
    const smr_vec flat = smr_cross(b, c), turn = smr_add(smr_cross(nb, c), smr_cross(b, nc)), twist = smr_cross(nb, nc);
    const smr_enclosed e = {{SMR_SIXTH * smr_dot(a, flat), SMR_SIXTH * (smr_dot(na, flat) + smr_dot(a, turn)),
                             SMR_SIXTH * (smr_dot(na, turn) + smr_dot(a, twist)), SMR_SIXTH * smr_dot(na, twist)}};
    return e;
}

float smr_enclosed_displacement(const smr_enclosed *e, float volume, float most)
{
    float t = 0.0f;
    for (uint32_t i = 0; i < SMR_NEWTON; i++) {
        const float slope = e->c[1] + t * (2.0f * e->c[2] + 3.0f * t * e->c[3]);
        if (!(smr_abs(slope) > 1.0e-3f * smr_abs(e->c[1])))
            return 0.0f; /* returns 0: no displacement gives the volume */
        const float now = e->c[0] + t * (e->c[1] + t * (e->c[2] + t * e->c[3]));
        t = smr_clamp(t + (volume - now) / slope, -most, most);
    }
    return t;
}

static float cones(const smr_shape *shape, uint32_t from, uint32_t to, smr_vec apex, float *x)
{
    float sum = 0.0f;
    for (uint32_t k = from; k < to; k++) {
        const uint32_t *t = smr_model_triangle(shape->shared, k);
        const smr_vec a = smr_sub(place(shape, x, t[0]), apex), b = smr_sub(place(shape, x, t[1]), apex);
        sum += SMR_SIXTH * smr_dot(a, smr_cross(b, smr_sub(place(shape, x, t[2]), apex)));
    }
    return sum;
}

/* Adds areas and hashes of edges of triangles at rest. */
static void add_rest(smr_bulk *b, const smr_shared *c, uint32_t first, uint32_t last)
{
    for (uint32_t k = first; k < last; k++) {
        const uint32_t *t = smr_model_triangle(c, k);
        b->area += 0.5f * smr_length(smr_triangle_cross(smr_rest(c, t[0]), smr_rest(c, t[1]), smr_rest(c, t[2])));
    }
    b->edges += smr_mesh_edges(c->triangle + 3u * (size_t)first, last - first);
}

int smr_bulk_add(smr_bulk *b, const smr_shape *shape, uint32_t structure, float *x)
{
    const smr_shape_structure *one = &shape->structure[structure];
    const uint32_t end = smr_min_u32(b->at + SMR_TRIANGLE_CHUNK, one->tree.n_triangles);
    const uint32_t first = one->first_triangle + b->at, last = one->first_triangle + end;
    if (b->half == 0u) {
        b->apex = b->at == 0u ? smr_cone_apex(shape, structure, x) : b->apex;
        b->mm3 += cones(shape, first, last, b->apex, x); /* sum of the chunks' sums, which keeps rounding small */
        b->half = x == NULL;
        if (b->half)
            return 0;
    } else {
        add_rest(b, shape->shared, first, last);
    }
    b->half = 0;
    b->at = end;
    b->thick_mm = b->area > 0.0f ? smr_abs(b->mm3) / b->area : 0.0f;
    b->closed = b->thick_mm > SMR_THIN && b->edges == 0u;
    return end == one->tree.n_triangles;
}

static smr_bulk at_once(const smr_shape *shape, uint32_t structure, float *x)
{
    smr_bulk b = {.at = 0};
    while (!smr_bulk_add(&b, shape, structure, x))
        ;
    return b;
}

float smr_enclosed_of(const smr_shape *shape, uint32_t structure, float *x) { return at_once(shape, structure, x).mm3; }
smr_bulk smr_rest_volume(const smr_shape *shape, uint32_t structure) { return at_once(shape, structure, NULL); }

void smr_start_fit(const smr_shape *shape, smr_fit *fit, uint32_t first, uint32_t last)
{
    if (first == 0u)
        smr_fit_start(fit, smr_v(0, 0, 0), smr_v(0, 0, 0));
    for (uint32_t v = first; v < last; v++)
        smr_fit_add(fit, smr_rest(shape->shared, v), smr_get3(shape->start, v), 1.0f);
}

float smr_start_scale(const smr_fit *fit)
{
    const smr_pose pose = smr_fit_solve(fit, 1);
    return smr_length(smr_column(&pose, 0));
}

int smr_start_mirrored(const smr_fit *fit)
{
    float m[9], most = 0.0f;
    for (uint32_t i = 0; i < 9u; i++) {
        const float means = fit->sum[SMR_FIT_TO + i / 3u] * fit->sum[SMR_FIT_FROM + i % 3u];
        m[i] = fit->sum[SMR_FIT_CROSS + i] - means / smr_max(fit->weight, 1.0f);
        most = smr_max(most, smr_abs(m[i]));
    }
    for (uint32_t i = 0; i < 9u; i++)
        m[i] = most > 0.0f ? m[i] / most : 0.0f; /* scaled so that products stay in range */
    const smr_vec x = smr_v(m[0], m[1], m[2]), y = smr_v(m[3], m[4], m[5]), z = smr_v(m[6], m[7], m[8]);
    return smr_dot(x, smr_cross(y, z)) < -SMR_FLAT;
}
