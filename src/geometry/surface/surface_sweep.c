/* surface_sweep.c: the signed distance of places of one surface to another, and what follows from it for surroundings:
 * between two places the distance changes by their distance at most, which saves searches. Outside of a surface the
 * closest triangle tells the distance; only inside the costlier side of surface_distance.c is asked for.
 * Bounds: two searches and a line for each place.
 * SPDX-License-Identifier: MIT */
#include "geometry/surface/surface_sweep.h"
#include "geometry/box_tree/triangle.h"

static float apart(smr_vec p, smr_vec q) { return smr_length(smr_sub(p, q)) * SMR_SWEEP_MORE + SMR_SWEEP_MORE_MM; }

/* Finds the signed distance of p (mm from b's origin) to b. to: a place whose side is known or not, as it is replaced.
 * A depth beyond `most` and `deep` counts as `deep`. Returns 0, with p's side unknown, where p is outside and farther
 * away than `most`. */
static int find_side(const smr_sweep *s, smr_vec p, float most, float deep, smr_sweep_place *to)
{
    const int joined = to->side < SMR_FAR && smr_abs(to->side) > apart(p, to->at); /* no surface lies between */
    smr_query q = {p, smr_v(0, 0, 0), -2.0f, UINT32_MAX, to->warm};
    smr_hit hit = {most * most, SMR_NONE, {0, 0, 0}};
    smr_side side;
    to->at = p;
    to->side = SMR_FAR;
    if (!smr_box_reaches(&s->around, p, most))
        return 0;
    if (most > 0.0f)
        smr_tree_closest(&s->b->tree, &q, &hit);
    if (hit.triangle != SMR_NONE)
        to->warm = q.warm = hit.triangle;
    if (!joined)
        to->inside = smr_surface_inside(s->b, p);
    if (!to->inside) {
        to->side = hit.triangle != SMR_NONE ? SMR_SQRT(hit.d2) : SMR_FAR;
        return hit.triangle != SMR_NONE;
    }
    if (!smr_signed_distance(&s->b->tree, s->b->normal, &q, smr_max(most, deep), NULL, &side)) {
        to->side = -deep;
        return 1;
    }
    to->side = side.mm;
    to->warm = side.triangle;
    return 1;
}

/* Adds the area of points at most `way` mm from a place, if all of them surely are in contact and none can be deeper
 * than the deepest place so far. Returns 0 when that is not known. */
static int adds_surely(const smr_sweep *s, const smr_sweep_place *at, float way, smr_sweep_found *f, float area)
{
    if (!(smr_abs(at->side) > way && at->side + way <= s->within &&
          way - at->side <= smr_max(f->deepest, s->found.deepest)))
        return 0;
    f->sum += area;
    return 1;
}

/* Adds a point of a triangle with a third of its area, mm^2. middle: the triangle's, whose side is known. */
void smr_sweep_point(const smr_sweep *s, smr_vec p, float third, const smr_sweep_place *middle, smr_sweep_found *f)
{
    const float way = apart(p, middle->at);
    smr_sweep_place at = *middle;
    if (middle->side - way > s->within || adds_surely(s, middle, way, f, third))
        return;
    const smr_query q = {p, smr_v(0, 0, 0), -2.0f, UINT32_MAX, SMR_NONE};
    smr_hit hit = {SMR_FAR, SMR_NONE, {0, 0, 0}};
    if (middle->warm != SMR_NONE)
        smr_tree_try(&s->b->tree, NULL, &q, middle->warm, &hit);
    if (SMR_SQRT(hit.d2) <= smr_min(s->within, smr_max(f->deepest, s->found.deepest))) {
        f->sum += third;
        return;
    }
    if (!find_side(s, p, s->within * SMR_SWEEP_MORE + SMR_SWEEP_MORE_MM, SMR_DEPTH_MOST, &at))
        return;
    f->deepest = smr_max(f->deepest, -at.side);
    f->sum += at.side <= s->within ? third : 0.0f;
}

/* Adds triangle k of a to the box f->near unless the triangle is far from b. last: a place whose side is known or not.
 * Returns the triangle's middle. */
smr_sweep_middle smr_sweep_triangle(const smr_sweep *s, uint32_t k, smr_sweep_place *last, smr_sweep_found *f)
{
    smr_sweep_middle m = {*last, 0.0f, 0.0f};
    const uint32_t *t = smr_triangle_of(s->a->triangle, k, s->a->n_vertices);
    smr_vec corner[3];
    float round2 = 0.0f;
    for (uint32_t i = 0; i < 3u; i++)
        corner[i] = smr_sub(smr_get3(s->a->xyz, t[i]), s->shift);
    const smr_vec centre = smr_scale(smr_add(corner[0], smr_add(corner[1], corner[2])), 1.0f / 3.0f);
    for (uint32_t i = 0; i < 3u; i++) {
        const smr_vec r = smr_sub(corner[i], centre);
        round2 = smr_max(round2, smr_dot(r, r));
    }
    const float size = SMR_SQRT(round2), round = size + s->within, moved = apart(centre, last->at);
    if (last->side < SMR_FAR && last->side - moved >= round)
        return m;
    const float third = smr_length(smr_triangle_cross(corner[0], corner[1], corner[2])) * (1.0f / 6.0f);
    if (adds_surely(s, last, moved + size * SMR_SWEEP_MORE, f, 3.0f * third)) {
        m.sum = f->sum;
    } else {
        if (!find_side(s, centre, round * SMR_SWEEP_MORE, SMR_DEPTH_MOST, last) || !(last->side < round))
            return m;
        m.at = *last;
        m.third = third;
    }
    for (uint32_t i = 0; i < 3u; i++)
        smr_box_grow(&f->near, smr_add(corner[i], s->shift));
    return m;
}

/* Returns the box around all triangles below a node, mm from the surface's origin. */
static smr_box box_of_node(const smr_node *node)
{
    smr_box box = smr_sweep_no_box;
    for (uint32_t k = 0; k < SMR_TREE_WIDTH && node->lo[0][k] < SMR_FAR; k++) {
        smr_box_grow(&box, smr_v(node->lo[0][k], node->lo[1][k], node->lo[2][k]));
        smr_box_grow(&box, smr_v(node->hi[0][k], node->hi[1][k], node->hi[2][k]));
    }
    return box;
}

smr_box smr_sweep_box(const smr_surface *s) { return box_of_node(&s->tree.node[s->tree.level[s->tree.n_levels - 1u]]); }

/* Finds the side of the middle of a leaf of a. Returns 0 when the middle is so far outside of b that no triangle of
 * the leaf can reach b. */
int smr_sweep_leaf(const smr_sweep *s, uint32_t leaf, smr_sweep_place *middle)
{
    const smr_box box = box_of_node(&s->a->tree.node[leaf]);
    const float half = 0.5f * apart(box.lo, box.hi), reach = (3.0f * half + s->within) * SMR_SWEEP_MORE;
    const smr_vec at = smr_sub(smr_scale(smr_add(box.lo, box.hi), 0.5f), s->shift);
    middle->side = SMR_FAR;
    return find_side(s, at, reach, SMR_DEPTH_MOST + half, middle) && middle->side <= reach;
}

/* Measures the depth of the vertices first .. last-1 of a that have triangles: those have an area. */
void smr_sweep_vertices(const smr_sweep *s, smr_piece piece, smr_sweep_found *f)
{
    smr_sweep_place last = {smr_v(0, 0, 0), SMR_FAR, SMR_NONE, 0};
    for (uint32_t v = piece.first; v < piece.last; v++) {
        const smr_vec p = smr_sub(smr_get3(s->a->xyz, v), s->shift);
        const float deepest = smr_max(f->deepest, s->found.deepest);
        const int known = last.side < SMR_FAR;
        if (!(s->a->area[v] > 0.0f) || (known && apart(p, last.at) - last.side <= deepest))
            continue;
        if (find_side(s, p, 0.0f, SMR_DEPTH_MOST, &last))
            f->deepest = smr_max(f->deepest, -last.side);
    }
}
