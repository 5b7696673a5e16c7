/* surface_contact.c: overlap of two closed surfaces: deepest penetration, overlapping volume, area in contact. Depth
 * and area are measured at the vertices of both surfaces and at three points of each triangle that can reach the
 * other surface. The volume is a sum over a grid of lines, on each of which the length inside both surfaces is exact.
 * Bounds: four searches a triangle, one a vertex; SMR_LINES^2 lines of two passes through a tree.
 * SPDX-License-Identifier: MIT */
#include "geometry/surface/surface.h"
#include "geometry/box_tree/triangle.h"

#define SMR_DEPTH_MOST 100.0f /* mm: greater depths count as this depth */
#define SMR_LINES 64u         /* largest number of lines of the volume's grid along each of two axes */
#define SMR_LINE_MM 0.25f     /* smallest distance between two lines, mm */
#define SMR_CROSSINGS 64u     /* most crossings of a line with one surface */

/* Depth and contact area of surface a in surface b, measured at a's triangles and vertices. */
typedef struct sweep {
    const smr_surface *a, *b;
    smr_vec shift;       /* vector from a's origin to b's, mm */
    smr_box near;        /* box around all triangles of a that can reach into b, mm from a's origin */
    smr_box around;      /* box around b, mm from b's origin */
    float within;        /* largest distance that counts as contact, mm */
    float deepest, area; /* largest depth in b, mm; area in contact, mm^2 */
} sweep;

/* A crossing of a line with a surface. */
typedef struct crossing {
    float at; /* the crossing's position on its line, mm */
    int turn; /* 1: into surface a; -1: out of a; 2: into b; -2: out of b */
} crossing;

typedef struct line {
    uint32_t u, v, w;                  /* the two axes across the line, and the axis along it */
    float pu, pv;                      /* coordinates of the line on the axes u and v, mm */
    uint32_t n;                        /* number of crossings found */
    crossing list[2u * SMR_CROSSINGS]; /* [n] crossings, ascending */
} line;

static float axis_of(smr_vec p, uint32_t axis) { return axis == 0u ? p.x : axis == 1u ? p.y : p.z; }

/* Returns the side, 1 or -1, on which the line passes the edge from vertex i to k; the edge from k to i has the other
 * side. So a line that meets a shared edge crosses exactly one of the two triangles. */
static int beside(const smr_surface *s, const line *l, smr_vec shift, uint32_t i, uint32_t k)
{
    const uint32_t lo = smr_min_u32(i, k), hi = smr_max_u32(i, k);
    const smr_vec a = smr_add(smr_get3(s->xyz, lo), shift), b = smr_add(smr_get3(s->xyz, hi), shift);
    const float au = axis_of(a, l->u) - l->pu, av = axis_of(a, l->v) - l->pv;
    const float bu = axis_of(b, l->u) - l->pu, bv = axis_of(b, l->v) - l->pv;
    return (au * bv - av * bu >= 0.0f) == (i == lo) ? 1 : -1;
}

static void add_crossing(line *l, float at, int turn)
{
    if (l->n == 2u * SMR_CROSSINGS)
        return;
    uint32_t i = l->n++;
    for (; i > 0u && l->list[i - 1u].at > at; i--)
        l->list[i] = l->list[i - 1u];
    l->list[i] = (crossing){at, turn};
}

static void cross_triangle(const smr_surface *s, line *l, smr_vec shift, uint32_t k, int weight)
{
    const uint32_t *t = smr_triangle_of(s->triangle, k, s->n_vertices);
    const int turn = beside(s, l, shift, t[0], t[1]);
    if (beside(s, l, shift, t[1], t[2]) != turn || beside(s, l, shift, t[2], t[0]) != turn)
        return;
    const smr_corner_values at_origin = smr_corners_of(s->xyz, t);
    const smr_vec a = smr_add(at_origin.a, shift), b = smr_add(at_origin.b, shift), c = smr_add(at_origin.c, shift);
    const smr_vec n = smr_triangle_cross(a, b, c);
    const float along = axis_of(n, l->w);
    const float low = axis_of(smr_low(a, smr_low(b, c)), l->w), high = axis_of(smr_high(a, smr_high(b, c)), l->w);
    const float rise = axis_of(n, l->u) * (axis_of(a, l->u) - l->pu) + axis_of(n, l->v) * (axis_of(a, l->v) - l->pv);
    const float at = smr_abs(along) > 0.0f ? axis_of(a, l->w) + rise / along : 0.5f * (low + high);
    add_crossing(l, smr_clamp(at, low, high), turn > 0 ? -weight : weight);
}

/* Adds all crossings of the line with surface s, moved by `shift`, mm, to the line's list. weight: 1 for a, 2 for b. */
static void cross(const smr_surface *s, line *l, smr_vec shift, int weight)
{
    smr_visit stack[SMR_TREE_LEVELS * SMR_TREE_WIDTH];
    const smr_box_tree *f = &s->tree;
    const float u = l->pu - axis_of(shift, l->u), v = l->pv - axis_of(shift, l->v);
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

/* Returns 1 when the winding number of surface s around p (mm from its origin) is not 0, also near folds. */
static int is_inside(const smr_surface *s, smr_vec p)
{
    line l = {1, 2, 0, p.y, p.z, 0, {{0, 0}}};
    int winding = 0;
    cross(s, &l, smr_v(0, 0, 0), 1);
    for (uint32_t i = 0; i < l.n && l.list[i].at < p.x; i++)
        winding += l.list[i].turn;
    return winding != 0;
}

/* Returns the signed distance, mm, of p (mm from b's origin) to b; `most` where p is farther away. */
static float side_of(const sweep *s, smr_vec p, float most)
{
    const smr_query q = {p, smr_v(0, 0, 0), -2.0f, UINT32_MAX, SMR_NONE};
    smr_side side;
    const float far = smr_max(most, SMR_DEPTH_MOST);
    if (!smr_box_reaches(&s->around, p, most) || !smr_signed_distance(&s->b->tree, s->b->normal, &q, far, &side))
        return most;
    return side.mm < 0.0f && !is_inside(s->b, p) ? -side.mm : side.mm;
}

/* Adds depth and contact area at three points of triangle k of a to the sweep, unless the triangle is far from b. */
static void sample_triangle(sweep *s, uint32_t k)
{
    const uint32_t *t = smr_triangle_of(s->a->triangle, k, s->a->n_vertices);
    smr_vec corner[3];
    float round2 = 0.0f;
    for (uint32_t i = 0; i < 3u; i++)
        corner[i] = smr_sub(smr_get3(s->a->xyz, t[i]), s->shift);
    const smr_vec middle = smr_scale(smr_add(corner[0], smr_add(corner[1], corner[2])), 1.0f / 3.0f);
    for (uint32_t i = 0; i < 3u; i++) {
        const smr_vec r = smr_sub(corner[i], middle);
        round2 = smr_max(round2, smr_dot(r, r));
    }
    const float round = SMR_SQRT(round2) + s->within, side = side_of(s, middle, round);
    if (!(side < round))
        return;
    const float third = smr_length(smr_triangle_cross(corner[0], corner[1], corner[2])) * (1.0f / 6.0f);
    for (uint32_t i = 0; i < 3u; i++) {
        const float at = side_of(s, smr_scale(smr_add(corner[i], middle), 0.5f), round);
        s->deepest = smr_max(s->deepest, -at);
        s->area += at <= s->within ? third : 0.0f;
        smr_box_grow(&s->near, smr_add(corner[i], s->shift));
    }
}

static const smr_box no_box = {{SMR_FAR, SMR_FAR, SMR_FAR}, {-SMR_FAR, -SMR_FAR, -SMR_FAR}};

static smr_box used_box(const smr_surface *s)
{
    smr_box box = no_box;
    for (size_t i = 0; i < 3u * (size_t)s->tree.n_triangles; i++)
        smr_box_grow(&box, smr_get3(s->xyz, smr_index(s->triangle[i], s->n_vertices)));
    return box;
}

static sweep sweep_of(const smr_surface *a, const smr_surface *b, float within)
{
    sweep s = {a, b, smr_sub(b->origin, a->origin), no_box, used_box(b), within, 0.0f, 0.0f};
    for (uint32_t k = 0; k < a->tree.n_triangles; k++)
        sample_triangle(&s, k);
    for (uint32_t v = 0; v < a->n_vertices; v++) /* skips vertices without triangles: area 0, no normal */
        if (a->area[v] > 0.0f)
            s.deepest = smr_max(s.deepest, -side_of(&s, smr_sub(smr_get3(a->xyz, v), s.shift), 0.0f));
    return s;
}

/* Returns the length, mm, of the line inside both surfaces. */
static float length_inside(const line *l)
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

static float volume_of(const smr_surface *a, const smr_surface *b, smr_vec shift, smr_box box)
{
    const smr_vec size = smr_sub(box.hi, box.lo);
    line l;
    if (!(size.x > 0.0f && size.y > 0.0f && size.z > 0.0f))
        return 0.0f;
    l.w = size.x >= size.y && size.x >= size.z ? 0u : size.y >= size.z ? 1u : 2u;
    l.u = (l.w + 1u) % 3u;
    l.v = (l.w + 2u) % 3u;
    const float du = smr_max(axis_of(size, l.u) / (float)SMR_LINES, SMR_LINE_MM),
                dv = smr_max(axis_of(size, l.v) / (float)SMR_LINES, SMR_LINE_MM);
    float sum = 0.0f;
    for (uint32_t i = 0; (float)i * du < axis_of(size, l.u); i++)
        for (uint32_t k = 0; (float)k * dv < axis_of(size, l.v); k++) {
            l.pu = axis_of(box.lo, l.u) + ((float)i + 0.5f) * du;
            l.pv = axis_of(box.lo, l.v) + ((float)k + 0.5f) * dv;
            l.n = 0;
            cross(a, &l, smr_v(0, 0, 0), 1);
            cross(b, &l, shift, 2);
            sum += length_inside(&l);
        }
    return sum * du * dv;
}

smr_status smr_surface_contact(const smr_surface *a, const smr_surface *b, float within_mm, smr_contact_report *report)
{
    if (a == NULL || b == NULL || report == NULL)
        return SMR_E_NULL;
    if (!smr_surface_valid(a) || !smr_surface_valid(b) || smr_is_cloud(a) || smr_is_cloud(b))
        return SMR_E_STATE;
    if (!(within_mm >= 0.0f && within_mm <= SMR_DEPTH_MOST))
        return SMR_E_INPUT;
    memset(report, 0, sizeof *report);
    if (a->open || b->open || a->n_fragment + b->n_fragment > 0u)
        return SMR_OK;
    const sweep one = sweep_of(a, b, within_mm), other = sweep_of(b, a, within_mm);
    const smr_box all_a = used_box(a);
    smr_box box = {smr_low(one.near.lo, smr_add(other.near.lo, one.shift)),
                   smr_high(one.near.hi, smr_add(other.near.hi, one.shift))};
    box.lo = smr_high(box.lo, smr_high(all_a.lo, smr_add(one.around.lo, one.shift)));
    box.hi = smr_low(box.hi, smr_low(all_a.hi, smr_add(one.around.hi, one.shift)));
    report->deepest_mm = smr_max(one.deepest, other.deepest);
    report->a_in_b_mm = one.deepest;
    report->area_mm2 = 0.5f * (one.area + other.area);
    report->volume_mm3 = volume_of(a, b, one.shift, box);
    return SMR_OK;
}
