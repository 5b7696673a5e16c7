/* align_side.c: samples of a surface, its principal axes, and the sign of its volume, in passes of short pieces.
 * Bounds: four passes over the vertices, one over the triangles.
 * SPDX-License-Identifier: MIT */
#include "start/align/align.h"
#include "geometry/box_tree/triangle.h"
#include "geometry/linear_solve/eigen_jacobi.h"

#define SMR_SIDE_PIECE 512u /* vertices or triangles in a task */
#define SMR_MASK_PIECE 4u   /* the same where placed parts are searched for each vertex */

/* Returns 1 for a vertex that counts: outside fragments and in the region of the side. */
static int vertex_counts(const smr_align_side *side, uint32_t v)
{
    const smr_surface *s = side->surface;
    return !smr_surface_fragment(s, v) &&
           (side->mask == NULL || smr_mask_holds(side->mask, s, smr_get3(s->xyz, v), smr_get3(s->normal, v)));
}

/* Returns the area of a vertex, mm^2, 0 outside the region of the side. */
static float area_of(const smr_align_side *side, uint32_t v)
{
    return side->mask == NULL || vertex_counts(side, v) ? side->surface->area[v] : 0.0f;
}

/* Each pass adds a piece of the vertices or triangles of the surface to w. The last piece ends the pass. */

/* Sums positions, from the first one on, by area. */
static void add_centre(smr_align_side *side, smr_side_work *w, smr_piece piece)
{
    const smr_surface *s = side->surface;
    const smr_vec origin = smr_load(s->xyz);
    if (piece.first == 0u) {
        *w = (smr_side_work){.weight = 0.0f};
        side->bare = (uint32_t)smr_is_cloud(s);
        side->kept = side->mask == NULL ? s->n_vertices - s->n_fragment_vertices : 0u;
    }
    for (uint32_t i = piece.first; i < piece.last; i++) {
        const float area = area_of(side, i);
        w->sum = smr_add(w->sum, smr_scale(smr_sub(smr_get3(s->xyz, i), origin), area));
        w->weight += area;
        side->kept += side->mask != NULL && vertex_counts(side, i);
        side->bare &= (uint32_t)(!side->bare || smr_all_within(s->normal + 3u * (size_t)i, 3, 0.0f));
    }
    w->inverse = w->weight > 0.0f ? 1.0f / w->weight : 0.0f;
    side->centre = smr_add(origin, smr_scale(w->sum, w->inverse));
}

/* Sums the covariance of positions; the last piece sets axes and spread. */
static void add_spread(smr_align_side *side, smr_side_work *w, smr_piece piece)
{
    const smr_surface *s = side->surface;
    float value[3];
    for (uint32_t i = piece.first; i < piece.last; i++)
        smr_add_square(w->c, area_of(side, i) * w->inverse, smr_sub(smr_get3(s->xyz, i), side->centre));
    side->spread = SMR_SQRT(w->c[SMR_XX] + w->c[SMR_YY] + w->c[SMR_ZZ]);
    if (piece.last == s->n_vertices)
        smr_eigen(w->c, value, side->axes);
}

/* Chooses the signs of a side's axes so that third moments along the first two are positive. Eigenvectors have no
 * sign; without a choice the order of equally good poses would depend on the surface's orientation. */
static void add_skew(smr_align_side *side, smr_side_work *w, smr_piece piece)
{
    const smr_surface *s = side->surface;
    float *a = side->axes;
    for (uint32_t i = piece.first; i < piece.last; i++) {
        const smr_vec d = smr_sub(smr_get3(s->xyz, i), side->centre);
        const float area = area_of(side, i);
        for (uint32_t k = 0; k < 2u; k++) {
            const float along = d.x * a[k] + d.y * a[3u + k] + d.z * a[6u + k];
            w->skew[k] += area * along * along * along;
        }
    }
    for (uint32_t k = 0; k < 2u && piece.last == s->n_vertices; k++)
        for (uint32_t r = 0; r < 3u && w->skew[k] < 0.0f; r++) {
            a[3u * r + k] = -a[3u * r + k];
            a[3u * r + 2u] = -a[3u * r + 2u];
        }
}

/* Sums the volume of a closed surface: a negative one is inside out. */
static void add_volume(smr_align_side *side, smr_side_work *w, smr_piece piece)
{
    const smr_surface *s = side->surface;
    for (uint32_t i = piece.first; i < piece.last && !s->open; i++) {
        const uint32_t *t = s->triangle + 3u * (size_t)i;
        if (smr_surface_fragment(s, t[0]))
            continue;
        const smr_corner_values v = smr_corners_of(s->xyz, t);
        w->volume +=
            smr_dot(smr_sub(v.a, side->centre), smr_cross(smr_sub(v.b, side->centre), smr_sub(v.c, side->centre)));
    }
    side->outward = w->volume < 0.0f ? -1.0f : 1.0f;
}

/* Returns the number of vertices that count before that of sample k. */
static uint32_t wanted_of(const smr_align_side *side, uint32_t k)
{
    return (uint32_t)(((uint64_t)2u * k + 1u) * side->kept / (2u * (uint64_t)side->n));
}

static void take_samples(smr_align_side *side, smr_side_work *w, smr_piece piece)
{
    const smr_surface *s = side->surface;
    const float inverse = s->area_mean > 0.0f ? 1.0f / s->area_mean : 0.0f;
    uint32_t k = w->at[0], wanted = wanted_of(side, k);
    for (uint32_t i = piece.first; i < piece.last; i++) {
        if (!vertex_counts(side, i))
            continue;
        for (; k < side->n && wanted == w->at[1]; wanted = wanted_of(side, ++k)) {
            side->point[k] = smr_get3(s->xyz, i);
            side->normal[k] = smr_scale(smr_get3(s->normal, i), side->outward);
            side->weight[k] = s->area[i] * inverse;
            side->pair[k].triangle = SMR_NONE;
        }
        w->at[1]++;
    }
    w->at[0] = k;
}

static const struct {
    void (*run)(smr_align_side *side, smr_side_work *w, smr_piece piece);
    uint32_t of; /* what the pass visits: 0 vertices, 1 triangles */
} passes[] = {{add_centre, 0}, {add_spread, 0}, {add_skew, 0}, {add_volume, 1}, {take_samples, 0}};

static uint32_t items_of(const smr_align_side *side, uint32_t pass)
{
    const smr_surface *s = side->surface;
    return passes[pass].of == 0u ? s->n_vertices : s->tree.n_triangles;
}

static uint32_t size_of_piece(const smr_align_side *side)
{
    return side->mask == NULL ? SMR_SIDE_PIECE : SMR_MASK_PIECE;
}

uint32_t smr_align_side_tasks(const smr_align_side *side)
{
    uint32_t n = 0;
    for (uint32_t pass = 0; pass < sizeof passes / sizeof passes[0]; pass++)
        n += smr_ceil_div(items_of(side, pass), size_of_piece(side));
    return n;
}

void smr_align_side_make(smr_align_side *side, smr_side_work *w, uint32_t task)
{
    uint32_t pass = 0;
    for (; task >= smr_ceil_div(items_of(side, pass), size_of_piece(side)); pass++)
        task -= smr_ceil_div(items_of(side, pass), size_of_piece(side));
    passes[pass].run(side, w, smr_piece_of(task, size_of_piece(side), items_of(side, pass)));
}
