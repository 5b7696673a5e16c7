/* surface_fragments.c: finds stray components of a target surface, such as a scanner or a reconstruction leaves.
 * Triangles with a common vertex belong to one component. A fragment is an open component of very few triangles, unless
 * fragments are a large part of all triangles. Registration ignores fragments: searches do not find them, they do not
 * attract, and they do not open a closed surface.
 * Larger components get numbers, for a target may hold other bodies than the model's (outlier_weights.c).
 * Method: union-find over triangles, united by size (Tarjan 1975).
 * Bounds: the stages of a surface's build; a path has at most log2(n_triangles) steps.
 * SPDX-License-Identifier: MIT */
#include "geometry/surface/surface.h"

#define SMR_FRAGMENT_PART 256u  /* an open component is a fragment up to n_triangles / SMR_FRAGMENT_PART triangles */
#define SMR_FRAGMENT_LEAST 512u /* a surface of fewer triangles has no fragments */
#define SMR_FRAGMENT_SHARE 8u   /* there are no fragments if they would hold over n_triangles / SMR_FRAGMENT_SHARE */

/* Union-find arrays [n_triangles]: parent of each triangle; a root's numbers of triangles, and of border edges. */
static uint32_t *parent(const smr_surface *s) { return s->work.key; }
static uint32_t *count(const smr_surface *s) { return s->work.tmp; }
static uint32_t *edges(const smr_surface *s) { return s->work.tmp + s->tree.n_triangles; }

/* Unites the components with the roots a and b: the one with fewer triangles becomes a part of the other. */
static void unite(smr_surface *s, uint32_t a, uint32_t b)
{
    const uint32_t more = count(s)[a] < count(s)[b] ? b : a, fewer = more == a ? b : a;
    if (a == b)
        return;
    parent(s)[fewer] = more;
    count(s)[more] += count(s)[fewer];
    edges(s)[more] += edges(s)[fewer];
}

void smr_fragments_forget(smr_surface *s, uint32_t first, uint32_t last)
{
    for (uint32_t v = first; v < last; v++)
        s->work.start[v] = SMR_NONE;
}

void smr_fragments_join(smr_surface *s, uint32_t first, uint32_t last)
{
    for (uint32_t k = first; k < last; k++) {
        parent(s)[k] = k;
        count(s)[k] = 1;
        edges(s)[k] = (s->border[k] & 7u) != 0u;
        for (uint32_t c = 0; c < 3u; c++) {
            uint32_t *const one = &s->work.start[s->triangle[3u * (size_t)k + c]];
            if (*one == SMR_NONE)
                *one = k;
            unite(s, smr_set_root(parent(s), *one), smr_set_root(parent(s), k));
        }
    }
}

static int is_fragment(const smr_surface *s, uint32_t r)
{
    return s->tree.n_triangles >= SMR_FRAGMENT_LEAST && count(s)[r] <= s->tree.n_triangles / SMR_FRAGMENT_PART &&
           edges(s)[r] > 0u;
}

void smr_fragments_sum(smr_surface *s, uint32_t first, uint32_t last)
{
    for (uint32_t k = first; k < last; k++)
        if (parent(s)[k] == k && is_fragment(s, k))
            s->n_fragment += count(s)[k];
    if (last == s->tree.n_triangles && s->n_fragment > last / SMR_FRAGMENT_SHARE)
        s->n_fragment = 0;
}

/* Sets edges() of each root in first .. last-1 to the number SMR_BODY_... of that root's component. */
void smr_bodies_number(smr_surface *s, uint32_t first, uint32_t last)
{
    for (uint32_t k = first; k < last; k++) {
        if (parent(s)[k] != k)
            continue;
        const int fragment = s->n_fragment > 0u && is_fragment(s, k);
        const int large = count(s)[k] > s->tree.n_triangles / SMR_BODY_PART;
        edges(s)[k] = fragment ? SMR_BODY_FRAGMENT : large ? SMR_BODY_FIRST + s->n_bodies++ : SMR_BODY_SMALL;
    }
}

void smr_fragments_mark(smr_surface *s, uint32_t first, uint32_t last)
{
    for (uint32_t k = first; k < last; k++) {
        s->work.body[k] = (unsigned char)edges(s)[smr_set_root(parent(s), k)];
        s->open |= s->work.body[k] != SMR_BODY_FRAGMENT && (s->border[k] & 7u) != 0u;
    }
}

void smr_fragments_release(smr_surface *s, uint32_t first, uint32_t last)
{
    for (uint32_t v = first; v < last && s->n_fragment > 0u; v++) {
        if (!smr_surface_fragment(s, v))
            continue;
        s->work.area -= s->area[v];
        s->area[v] = 0.0f;
        s->n_used -= !s->work.refit;
        s->n_fragment_vertices += !s->work.refit;
    }
}
