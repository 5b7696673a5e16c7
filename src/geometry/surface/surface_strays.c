/* surface_strays.c: scraps of a target that show nothing of it: what a scanner, or a reconstruction, leaves in the
 * air. Pieces hang together by vertices. An open piece of very few triangles is a scrap; where scraps are a good part
 * of all triangles the surface comes in pieces, and none is. Registration passes scraps by: they are not found, attract
 * nothing, and open no closed surface. A closed piece has an inside, however small: it stays.
 * Method: a forest over triangles, united by size (Tarjan 1975): of two pieces the smaller goes below the larger, so
 * that a triangle's way up at least doubles the piece with each step.
 * Bounds: the stages of surface_build.c; a way up has at most log2(n_triangles) steps, whatever the mesh.
 * SPDX-License-Identifier: MIT */
#include "geometry/surface/surface.h"

#define SMR_STRAY_PART 256u  /* a piece of at most one triangle in so many is a scrap, */
#define SMR_STRAY_LEAST 512u /* where the surface has as many: of a coarse one each triangle shows a part */
#define SMR_STRAY_SHARE 8u   /* of which scraps make up no more than one triangle in so many */

static uint32_t *parent(const smr_surface *s) { return s->work.key; }

/* Of a root: triangles of its piece, and those of them with a border edge. */
static uint32_t *count(const smr_surface *s) { return s->work.tmp; }
static uint32_t *edges(const smr_surface *s) { return s->work.tmp + s->facets.n_triangles; }

static uint32_t root(const smr_surface *s, uint32_t k)
{
    uint32_t *const up = parent(s);
    while (up[k] != k)
        k = up[k] = up[up[k]];
    return k;
}

/* Makes two pieces one. */
static void unite(smr_surface *s, uint32_t a, uint32_t b)
{
    const uint32_t more = count(s)[a] < count(s)[b] ? b : a, fewer = more == a ? b : a;
    if (a == b)
        return;
    parent(s)[fewer] = more;
    count(s)[more] += count(s)[fewer];
    edges(s)[more] += edges(s)[fewer];
}

int smr_strays_forget(smr_surface *s, uint32_t first, uint32_t last)
{
    for (uint32_t v = first; v < last; v++)
        s->work.start[v] = SMR_NONE;
    return 1;
}

int smr_strays_join(smr_surface *s, uint32_t first, uint32_t last)
{
    for (uint32_t k = first; k < last; k++) {
        parent(s)[k] = k;
        count(s)[k] = 1;
        edges(s)[k] = (s->border[k] & 7u) != 0u;
        for (uint32_t c = 0; c < 3u; c++) {
            uint32_t *const one = &s->work.start[s->triangle[3u * (size_t)k + c]];
            if (*one == SMR_NONE)
                *one = k;
            unite(s, root(s, *one), root(s, k));
        }
    }
    return 1;
}

static int is_scrap(const smr_surface *s, uint32_t r)
{
    return s->facets.n_triangles >= SMR_STRAY_LEAST && count(s)[r] <= s->facets.n_triangles / SMR_STRAY_PART &&
           edges(s)[r] > 0u;
}

int smr_strays_sum(smr_surface *s, uint32_t first, uint32_t last)
{
    for (uint32_t k = first; k < last; k++)
        if (parent(s)[k] == k && is_scrap(s, k))
            s->n_stray += count(s)[k];
    if (last == s->facets.n_triangles && s->n_stray > last / SMR_STRAY_SHARE)
        s->n_stray = 0;
    return 1;
}

int smr_strays_mark(smr_surface *s, uint32_t first, uint32_t last)
{
    for (uint32_t k = first; k < last; k++)
        if (s->n_stray > 0u && is_scrap(s, root(s, k)))
            s->border[k] |= SMR_SKIPPED;
        else
            s->open |= (s->border[k] & 7u) != 0u;
    return 1;
}

int smr_strays_release(smr_surface *s, uint32_t first, uint32_t last)
{
    for (uint32_t v = first; v < last && s->n_stray > 0u; v++) {
        if (!smr_surface_stray(s, v))
            continue;
        s->work.area -= s->area[v];
        s->area[v] = 0.0f;
        s->n_used -= !s->work.refit;
        s->n_stray_vertices += !s->work.refit;
    }
    return 1;
}
