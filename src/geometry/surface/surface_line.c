/* surface_line.c: crossings of lines along an axis with surfaces of triangles, and what follows from the crossings:
 * whether a point is inside, and the length of a line inside two surfaces.
 * Bounds: a walk down the box tree; SMR_CROSSINGS crossings with one surface.
 * SPDX-License-Identifier: MIT */
#include "geometry/surface/surface.h"
#include "geometry/box_tree/triangle.h"

/* Returns the side, 1 or -1, on which the line passes the edge from vertex i to k; the edge from k to i has the other
 * side. So a line that meets a shared edge crosses exactly one of the two triangles. */
static int beside(const smr_surface *s, const smr_line *l, smr_vec shift, uint32_t i, uint32_t k)
{
    const uint32_t lo = smr_min_u32(i, k), hi = smr_max_u32(i, k);
    const smr_vec a = smr_add(smr_get3(s->xyz, lo), shift), b = smr_add(smr_get3(s->xyz, hi), shift);
    const float au = smr_axis_of(a, l->u) - l->pu, av = smr_axis_of(a, l->v) - l->pv;
    const float bu = smr_axis_of(b, l->u) - l->pu, bv = smr_axis_of(b, l->v) - l->pv;
    return (au * bv - av * bu >= 0.0f) == (i == lo) ? 1 : -1;
}

static void add_crossing(smr_line *l, float at, int turn)
{
    if (l->n == 2u * SMR_CROSSINGS)
        return;
    uint32_t i = l->n++;
    for (; i > 0u && l->list[i - 1u].at > at; i--)
        l->list[i] = l->list[i - 1u];
    l->list[i] = (smr_crossing){at, turn};
}

static void cross_triangle(const smr_surface *s, smr_line *l, smr_vec shift, uint32_t k, int weight)
{
    const uint32_t *t = smr_triangle_of(s->triangle, k, s->n_vertices);
    const int turn = beside(s, l, shift, t[0], t[1]);
    if (beside(s, l, shift, t[1], t[2]) != turn || beside(s, l, shift, t[2], t[0]) != turn)
        return;
    const smr_corner_values at_origin = smr_corners_of(s->xyz, t);
    const smr_vec a = smr_add(at_origin.a, shift), b = smr_add(at_origin.b, shift), c = smr_add(at_origin.c, shift);
    const smr_vec n = smr_triangle_cross(a, b, c);
    const float along = smr_axis_of(n, l->w);
    const float low = smr_axis_of(smr_low(a, smr_low(b, c)), l->w),
                high = smr_axis_of(smr_high(a, smr_high(b, c)), l->w);
    const float rise =
        smr_axis_of(n, l->u) * (smr_axis_of(a, l->u) - l->pu) + smr_axis_of(n, l->v) * (smr_axis_of(a, l->v) - l->pv);
    const float at = smr_abs(along) > 0.0f ? smr_axis_of(a, l->w) + rise / along : 0.5f * (low + high);
    add_crossing(l, smr_clamp(at, low, high), turn > 0 ? -weight : weight);
}

void smr_line_cross(const smr_surface *s, smr_line *l, smr_vec shift, int weight)
{
    smr_visit stack[SMR_TREE_LEVELS * SMR_TREE_WIDTH];
    const smr_box_tree *f = &s->tree;
    const float u = l->pu - smr_axis_of(shift, l->u), v = l->pv - smr_axis_of(shift, l->v);
    uint32_t top = 1;
    stack[0] = (smr_visit){0.0f, f->n_levels - 1u, 0u};
    while (top > 0u) {
        const uint32_t level = stack[--top].level, index = stack[top].index;
        const smr_node *node = &f->node[smr_min_u32(f->level[level] + index, f->level[f->n_levels - 1u])];
        for (uint32_t k = 0; k < SMR_TREE_WIDTH; k++) {
            const uint32_t child = index * SMR_TREE_WIDTH + k;
            if (!(node->lo[l->u][k] <= u && node->lo[l->v][k] <= v && node->hi[l->u][k] >= u && node->hi[l->v][k] >= v))
                continue;
            if (level > 0u)
                stack[top++] = (smr_visit){0.0f, level - 1u, child};
            else if (child < f->n_triangles)
                cross_triangle(s, l, shift, child, weight);
        }
    }
}

int smr_surface_inside(const smr_surface *s, smr_vec p)
{
    smr_line l = {1, 2, 0, p.y, p.z, 0, {{0, 0}}};
    int winding = 0;
    smr_line_cross(s, &l, smr_v(0, 0, 0), 1);
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
