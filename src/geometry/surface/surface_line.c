/* surface_line.c: crossings of lines along an axis with surfaces of triangles, and what follows from the crossings:
 * whether a point is inside, and the length of a line inside two surfaces.
 * Bounds: a walk down the box tree; SMR_CROSSINGS crossings with one surface; SMR_EXTENT_NODES nodes for an extent, and
 * those then on the stack.
 * SPDX-License-Identifier: MIT */
#include "geometry/surface/surface.h"
#include "geometry/box_tree/triangle.h"

/* A corner of a triangle, mm from a line on the axes across it. */
typedef struct corner {
    uint32_t vertex;
    float u, v;
} corner;

static inline corner corner_of(const smr_surface *s, const smr_ray *r, const float shift[3], uint32_t vertex)
{
    const float *const p = s->xyz + 3u * (size_t)vertex;
    return (corner){vertex, p[r->u] + shift[r->u] - r->pu, p[r->v] + shift[r->v] - r->pv};
}

/* Returns 1 or 0, the side on which the line passes the edge from corner i to k; the edge from k to i has the other
 * side. So a line that meets a shared edge crosses exactly one of the two triangles. */
static inline int beside(corner i, corner k)
{
    const float left = i.u * k.v, right = i.v * k.u;
    return i.vertex <= k.vertex ? left - right >= 0.0f : !(right - left >= 0.0f);
}

/* Adds the crossing with the triangle t. */
static void add_crossing(const smr_surface *s, smr_line *l, smr_vec shift, const uint32_t *t, int turn)
{
    const smr_ray *const r = &l->ray;
    if (l->n == 2u * SMR_CROSSINGS)
        return;
    const smr_corner_values at_origin = smr_corners_of(s->xyz, t);
    const smr_vec a = smr_add(at_origin.a, shift), b = smr_add(at_origin.b, shift), c = smr_add(at_origin.c, shift);
    const smr_vec n = smr_triangle_cross(a, b, c);
    const float along = smr_axis_of(n, r->w);
    const float low = smr_axis_of(smr_low(a, smr_low(b, c)), r->w),
                high = smr_axis_of(smr_high(a, smr_high(b, c)), r->w);
    const float rise =
        smr_axis_of(n, r->u) * (smr_axis_of(a, r->u) - r->pu) + smr_axis_of(n, r->v) * (smr_axis_of(a, r->v) - r->pv);
    const float on = smr_abs(along) > 0.0f ? smr_axis_of(a, r->w) + rise / along : 0.5f * (low + high),
                at = smr_clamp(on, low, high);
    uint32_t i = l->n++;
    for (; i > 0u && l->list[i - 1u].at > at; i--)
        l->list[i] = l->list[i - 1u];
    l->list[i] = (smr_crossing){at, turn};
}

static inline void cross_triangle(const smr_surface *s, smr_line *l, smr_vec shift, uint32_t k, int weight)
{
    const uint32_t *t = smr_triangle_at(s->triangle, k, s->n_vertices);
    const float by[3] = {shift.x, shift.y, shift.z};
    const corner a = corner_of(s, &l->ray, by, t[0]), b = corner_of(s, &l->ray, by, t[1]),
                 c = corner_of(s, &l->ray, by, t[2]);
    const int turn = beside(a, b);
    if (beside(b, c) == turn && beside(c, a) == turn)
        add_crossing(s, l, shift, t, turn ? -weight : weight);
}

#define SMR_EXTENT_NODES 80u /* nodes after which an extent holds whole nodes, not their triangles: it is only larger */

/* Parallel lines through a rectangle across them, in a surface's coordinates, mm. */
typedef struct beam {
    uint32_t u, v, w;
    float low_u, low_v, high_u, high_v;
} beam;

static beam beam_of(const smr_ray *low, const smr_ray *high, smr_vec shift)
{
    const float u = smr_axis_of(shift, low->u), v = smr_axis_of(shift, low->v);
    return (beam){low->u, low->v, low->w, low->pu - u, low->pv - v, high->pu - u, high->pv - v};
}

/* Returns the node of a tree with triangles that is next on the stack, or the root where a fault in a box led beyond
 * the tree. */
static const smr_node *node_of(const smr_box_tree *f, smr_visit visit)
{
    return &f->node[smr_min_u32(f->level[visit.level] + visit.index, f->level[f->n_levels - 1u])];
}

/* Returns how far child k of a node is from the beam, mm, on the axis across it that is farther; 0 or less: meets. */
static inline float off_of(const smr_node *node, beam b, uint32_t k)
{
    const float off_u = smr_max(node->lo[b.u][k] - b.high_u, b.low_u - node->hi[b.u][k]);
    return smr_max(off_u, smr_max(node->lo[b.v][k] - b.high_v, b.low_v - node->hi[b.v][k]));
}

void smr_line_cross(const smr_surface *s, smr_line *l, smr_vec shift, float most, int weight)
{
    smr_visit stack[SMR_TREE_LEVELS * SMR_TREE_WIDTH];
    const smr_box_tree *f = &s->tree;
    const beam b = beam_of(&l->ray, &l->ray, shift);
    const float along = smr_axis_of(shift, b.w);
    uint32_t top = 1;
    stack[0] = (smr_visit){0.0f, f->n_levels - 1u, 0u};
    while (top > 0u) {
        const smr_visit visit = stack[--top];
        const smr_node *node = node_of(f, visit);
        uint32_t on = 0;
        for (uint32_t k = 0; k < SMR_TREE_WIDTH; k++)
            on |= smr_max(off_of(node, b, k), node->lo[b.w][k] + along - most) <= 0.0f ? smr_child_bit[k] : 0u;
        for (; on != 0u; on &= on - 1u) {
            const uint32_t child = visit.index * SMR_TREE_WIDTH + (uint32_t)__builtin_ctz(on);
            if (visit.level > 0u)
                stack[top++] = (smr_visit){0.0f, visit.level - 1u, child};
            else if (child < f->n_triangles)
                cross_triangle(s, l, shift, child, weight);
        }
    }
}

smr_extent smr_lines_extent(const smr_surface *s, const smr_ray *low, const smr_ray *high, smr_vec shift)
{
    smr_visit stack[SMR_TREE_LEVELS * SMR_TREE_WIDTH];
    const smr_box_tree *f = &s->tree;
    const beam b = beam_of(low, high, shift);
    const float along = smr_axis_of(shift, b.w);
    smr_extent all = {SMR_FAR, -SMR_FAR};
    uint32_t top = 1, opened = 0;
    stack[0] = (smr_visit){0.0f, f->n_levels - 1u, 0u};
    while (top > 0u) {
        const smr_visit visit = stack[--top];
        const smr_node *node = node_of(f, visit);
        const float *const lo = node->lo[b.w], *const hi = node->hi[b.w];
        uint32_t on = 0; /* children in the beam that are not within the extent so far */
        for (uint32_t k = 0; k < SMR_TREE_WIDTH; k++) {
            const float within = smr_min(lo[k] - all.lo, all.hi - hi[k]);
            on |= smr_max(off_of(node, b, k), within) <= 0.0f ? smr_child_bit[k] : 0u;
        }
        opened++;
        for (; on != 0u; on &= on - 1u) {
            const uint32_t k = (uint32_t)__builtin_ctz(on);
            if (visit.level > 0u && opened < SMR_EXTENT_NODES)
                stack[top++] = (smr_visit){0.0f, visit.level - 1u, visit.index * SMR_TREE_WIDTH + k};
            else
                all = (smr_extent){smr_min(all.lo, lo[k]), smr_max(all.hi, hi[k])};
        }
    }
    return (smr_extent){all.lo + along, all.hi + along};
}

int smr_surface_inside(const smr_surface *s, smr_vec p)
{
    smr_line l;
    int winding = 0;
    l.ray = (smr_ray){1, 2, 0, p.y, p.z};
    l.n = 0;
    smr_line_cross(s, &l, smr_v(0, 0, 0), p.x, 1);
    for (uint32_t i = 0; i < l.n && l.list[i].at < p.x; i++)
        winding += l.list[i].turn;
    return winding != 0;
}

float smr_line_inside(const smr_line *l)
{
    int in_a = 0, in_b = 0;
    float sum = 0.0f;
    for (uint32_t i = 0; i + 1u < l->n; i++) {
        const int turn = l->list[i].turn;
        in_a += turn == 1 ? 1 : turn == -1 ? -1 : 0;
        in_b += turn == 2 ? 1 : turn == -2 ? -1 : 0;
        if (in_a != 0 && in_b != 0)
            sum += l->list[i + 1u].at - l->list[i].at;
    }
    return sum;
}
