/* surface_contact.c: overlap of two closed surfaces: deepest penetration, overlapping volume, area in contact. Depth
 * and area are measured at the vertices of both surfaces and at three points of each triangle that can reach the
 * other surface. Between two places the distance to a surface changes by their distance at most, which saves searches.
 * The volume is a sum over a grid of lines, on each of which the length inside both surfaces is exact. A job (job.h).
 * Bounds: four searches a triangle and one a leaf, one a vertex; SMR_LINES^2 lines of two passes through a tree.
 * SPDX-License-Identifier: MIT */
#include "base/job.h"
#include "geometry/surface/surface.h"
#include "geometry/box_tree/triangle.h"

#define SMR_DEPTH_MOST 100.0f  /* mm: greater depths count as this depth */
#define SMR_LINES 64u          /* largest number of lines of the volume's grid along each of two axes */
#define SMR_LINE_MM 0.25f      /* smallest distance between two lines, mm */
#define SMR_LINES_TASK 2u      /* number of grid lines that a task measures */
#define SMR_VERTICES_TASK 3u   /* number of vertices that a task measures */
#define SMR_CONTACT_LEAVES 24u /* number of leaves tested before the triangles of near leaves are measured */
#define SMR_CONTACT_PLACES 16u /* number of tasks whose results wait to be added */
#define SMR_ROUNDED 1.001f     /* factor on lengths that rounding must not make too short */
#define SMR_ROUNDED_MM 1.0e-4f /* added to lengths that rounding must not make too short, mm */

/* Depth, contact area and near box of surface a in surface b, as far as tasks have measured them. */
typedef struct found {
    smr_box near;  /* box around all triangles of a that can reach into b, mm from a's origin */
    float deepest; /* largest depth in b, mm */
    float sum;     /* area in contact, mm^2; in tasks over lines: length inside both surfaces, mm */
} found;

/* Depth and contact area of surface a in surface b, measured at a's triangles and vertices. */
typedef struct sweep {
    const smr_surface *a, *b;
    smr_vec shift;  /* vector from a's origin to b's, mm */
    smr_box around; /* box around b, mm from b's origin */
    float within;   /* largest distance that counts as contact, mm */
    found found;
} sweep;

/* A place whose signed distance to b is known. */
typedef struct place {
    smr_vec at;    /* position of the place, mm from b's origin */
    float side;    /* signed distance, mm; SMR_FAR: unknown */
    uint32_t warm; /* closest triangle of b, to be tried first at the next place; SMR_NONE: none */
} place;

/* Finds the signed distance of p (mm from b's origin) to b, within `most` outside or `deep` inside; else returns 0. */
static int find_side(const sweep *s, smr_vec p, float most, float deep, place *to)
{
    const smr_query q = {p, smr_v(0, 0, 0), -2.0f, UINT32_MAX, to->warm};
    smr_side side;
    to->at = p;
    to->side = SMR_FAR;
    if (!smr_box_reaches(&s->around, p, most) ||
        !smr_signed_distance(&s->b->tree, s->b->normal, &q, smr_max(most, deep), NULL, &side))
        return 0;
    to->side = side.mm < 0.0f && !smr_surface_inside(s->b, p) ? -side.mm : side.mm;
    to->warm = side.triangle;
    return 1;
}

/* Returns the distance between the points p and q, mm, rounded up. */
static float apart(smr_vec p, smr_vec q) { return smr_length(smr_sub(p, q)) * SMR_ROUNDED + SMR_ROUNDED_MM; }

/* Adds the area of points at most `way` mm from a place, if all of them surely are in contact and none can be deeper
 * than the deepest place so far. Returns 0 when that is not known. */
static int adds_surely(const sweep *s, const place *at, float way, found *f, float area)
{
    if (!(smr_abs(at->side) > way && at->side + way <= s->within &&
          way - at->side <= smr_max(f->deepest, s->found.deepest)))
        return 0;
    f->sum += area;
    return 1;
}

/* Adds a point of a triangle with a third of its area, mm^2. middle: the triangle's, whose side is known. */
static void add_point(const sweep *s, smr_vec p, float third, const place *middle, found *f)
{
    const float way = apart(p, middle->at);
    place at = *middle;
    if (middle->side - way > s->within || adds_surely(s, middle, way, f, third) ||
        !find_side(s, p, way + smr_abs(middle->side), SMR_DEPTH_MOST, &at))
        return;
    f->deepest = smr_max(f->deepest, -at.side);
    f->sum += at.side <= s->within ? third : 0.0f;
}

/* Adds depth and contact area at three points of triangle k of a, unless the triangle is far from b. last: a place
 * whose side is known or not; becomes the triangle's middle after a search. */
static void sample_triangle(const sweep *s, uint32_t k, place *last, found *f)
{
    const uint32_t *t = smr_triangle_of(s->a->triangle, k, s->a->n_vertices);
    smr_vec corner[3];
    float round2 = 0.0f;
    for (uint32_t i = 0; i < 3u; i++)
        corner[i] = smr_sub(smr_get3(s->a->xyz, t[i]), s->shift);
    const smr_vec middle = smr_scale(smr_add(corner[0], smr_add(corner[1], corner[2])), 1.0f / 3.0f);
    for (uint32_t i = 0; i < 3u; i++)
        round2 = smr_max(round2, smr_distance2(corner[i], middle));
    const float size = SMR_SQRT(round2), round = size + s->within, moved = apart(middle, last->at);
    if (last->side < SMR_FAR && last->side - moved >= round)
        return;
    const float third = smr_length(smr_triangle_cross(corner[0], corner[1], corner[2])) * (1.0f / 6.0f);
    if (!adds_surely(s, last, moved + size * SMR_ROUNDED, f, 3.0f * third)) {
        if (!find_side(s, middle, round, SMR_DEPTH_MOST, last) || !(last->side < round))
            return;
        for (uint32_t i = 0; i < 3u; i++)
            add_point(s, smr_scale(smr_add(corner[i], middle), 0.5f), third, last, f);
    }
    for (uint32_t i = 0; i < 3u; i++)
        smr_box_grow(&f->near, smr_add(corner[i], s->shift));
}

/* Finds the signed distance of a leaf's middle to b. Returns 0 when no triangle of the leaf can reach b. */
static int leaf_is_near(const sweep *s, uint32_t leaf, place *middle)
{
    const smr_box box = smr_node_box(&s->a->tree.node[leaf]);
    const float half = 0.5f * apart(box.lo, box.hi), reach = (3.0f * half + s->within) * SMR_ROUNDED;
    const smr_vec at = smr_sub(smr_scale(smr_add(box.lo, box.hi), 0.5f), s->shift);
    middle->warm = SMR_NONE;
    return find_side(s, at, reach, SMR_DEPTH_MOST + half, middle) && middle->side <= reach;
}

/* Measures the depth of the vertices first .. last-1 of a that have triangles: those have an area. */
static void sweep_vertices(const sweep *s, smr_piece piece, found *f)
{
    place last = {smr_v(0, 0, 0), SMR_FAR, SMR_NONE};
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

/* A leaf whose triangles may reach the other surface. */
typedef struct near_leaf {
    uint32_t leaf; /* index among the leaves of a followed by those of b; SMR_NONE: the leaf is far */
    place middle;
} near_leaf;

/* smr_surface_contact() in progress. */
typedef struct contact {
    smr_job_head head;
    sweep sweep[2]; /* of a in b, and of b in a */
    smr_contact_report *report;
    uint32_t changes[2];             /* smr_surface.changes of a and b when the measurement began */
    smr_box box;                     /* box around the overlap, mm from a's origin */
    uint32_t u, v, w;                /* axes across the lines, and along them */
    uint32_t n_u, n_v;               /* numbers of lines along the axes u and v */
    float du, dv;                    /* distances of the lines, mm */
    float length;                    /* length of all lines inside both surfaces so far, mm */
    found place[SMR_CONTACT_PLACES]; /* results of tasks that are not added to a sweep yet */
    uint32_t leaf, n_near; /* first leaf of a, then of b, that is tested now; number of near ones among those tested */
    near_leaf near[SMR_CONTACT_LEAVES];
} contact;

_Static_assert(sizeof(contact) <= SMR_JOB_BYTES, "a measurement in progress lies in the caller's job");

static uint32_t places(const void *job) { return (void)job, SMR_CONTACT_PLACES; }

static found *place_of(contact *c, uint32_t task)
{
    found *const f = &c->place[task % SMR_CONTACT_PLACES];
    *f = (found){smr_no_box(), 0.0f, 0.0f};
    return f;
}

/* Adds the results of a task to a sweep. */
static void take(contact *c, uint32_t task, uint32_t i)
{
    const found *f = &c->place[task % SMR_CONTACT_PLACES];
    found *const to = &c->sweep[i].found;
    to->near = (smr_box){smr_low(to->near.lo, f->near.lo), smr_high(to->near.hi, f->near.hi)};
    to->deepest = smr_max(to->deepest, f->deepest);
    to->sum += f->sum;
}

static uint32_t leaves_of(const contact *c, uint32_t i) { return smr_tree_leaves(&c->sweep[i].a->tree); }
static uint32_t pieces_of(const contact *c, uint32_t i)
{
    return smr_ceil_div(c->sweep[i].a->n_vertices, SMR_VERTICES_TASK);
}

static uint32_t leaves(const contact *c) { return leaves_of(c, 0) + leaves_of(c, 1); }
static uint32_t vertex_tasks(const void *job) { return pieces_of(job, 0) + pieces_of(job, 1); }

static uint32_t leaf_tasks(const void *job)
{
    const contact *c = job;
    return smr_min_u32(SMR_CONTACT_LEAVES, leaves(c) - c->leaf);
}

static void test_leaf(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    contact *c = job;
    const uint32_t leaf = c->leaf + task, n = leaves_of(c, 0);
    const int is_near = leaf_is_near(&c->sweep[leaf >= n], leaf < n ? leaf : leaf - n, &c->near[task].middle);
    c->near[task].leaf = is_near ? leaf : SMR_NONE;
}

/* Appends the near leaves among those tested to c->near, in the order of leaves. */
static void keep_near(void *job, uint32_t first, uint32_t last)
{
    contact *c = job;
    c->n_near = first == 0u ? 0u : c->n_near;
    for (uint32_t task = first; task < last; task++)
        if (c->near[task].leaf != SMR_NONE)
            c->near[c->n_near++] = c->near[task];
}

static uint32_t triangle_tasks(const void *job) { return ((const contact *)job)->n_near * SMR_TREE_WIDTH; }

static void run_triangle(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    contact *c = job;
    const near_leaf *near = &c->near[task / SMR_TREE_WIDTH];
    const uint32_t n = leaves_of(c, 0), leaf = near->leaf < n ? near->leaf : near->leaf - n;
    const sweep *s = &c->sweep[near->leaf >= n];
    const uint32_t k = leaf * SMR_TREE_WIDTH + task % SMR_TREE_WIDTH;
    place last = near->middle;
    found *const f = place_of(c, task);
    if (k < s->a->tree.n_triangles)
        sample_triangle(s, k, &last, f);
}

static void take_triangles(void *job, uint32_t first, uint32_t last)
{
    contact *c = job;
    for (uint32_t task = first; task < last; task++)
        take(c, task, c->near[task / SMR_TREE_WIDTH].leaf >= leaves_of(c, 0));
}

/* Makes the job test the next leaves, until all leaves are tested. */
static void next_leaves(void *job, SMR_UNUSED uint32_t task, SMR_UNUSED uint32_t worker)
{
    contact *c = job;
    c->leaf += SMR_CONTACT_LEAVES;
    if (c->leaf < leaves(c))
        c->head.next_stage = 0;
}

static void run_vertices(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    contact *c = job;
    const uint32_t n = pieces_of(c, 0), i = task >= n;
    sweep_vertices(&c->sweep[i], smr_piece_of(i ? task - n : task, SMR_VERTICES_TASK, c->sweep[i].a->n_vertices),
                   place_of(c, task));
}

static void take_vertices(void *job, uint32_t first, uint32_t last)
{
    for (uint32_t task = first; task < last; task++)
        take(job, task, task >= pieces_of(job, 0));
}

/* Sets the grid of lines through the box around the overlap. */
static void begin_volume(void *job, SMR_UNUSED uint32_t task, SMR_UNUSED uint32_t worker)
{
    contact *c = job;
    const sweep *one = &c->sweep[0], *other = &c->sweep[1];
    const smr_box all_a = other->around;
    smr_box box = {smr_low(one->found.near.lo, smr_add(other->found.near.lo, one->shift)),
                   smr_high(one->found.near.hi, smr_add(other->found.near.hi, one->shift))};
    box.lo = smr_high(box.lo, smr_high(all_a.lo, smr_add(one->around.lo, one->shift)));
    box.hi = smr_low(box.hi, smr_low(all_a.hi, smr_add(one->around.hi, one->shift)));
    const smr_vec size = smr_sub(box.hi, box.lo);
    if (!(size.x > 0.0f && size.y > 0.0f && size.z > 0.0f))
        return;
    c->box = box;
    c->w = size.x >= size.y && size.x >= size.z ? 0u : size.y >= size.z ? 1u : 2u;
    c->u = (c->w + 1u) % 3u;
    c->v = (c->w + 2u) % 3u;
    c->du = smr_max(smr_axis_of(size, c->u) / (float)SMR_LINES, SMR_LINE_MM);
    c->dv = smr_max(smr_axis_of(size, c->v) / (float)SMR_LINES, SMR_LINE_MM);
    while ((float)c->n_u * c->du < smr_axis_of(size, c->u))
        c->n_u++;
    while ((float)c->n_v * c->dv < smr_axis_of(size, c->v))
        c->n_v++;
}

static uint32_t line_tasks(const void *job)
{
    const contact *c = job;
    return smr_ceil_div(c->n_u * c->n_v, SMR_LINES_TASK);
}

static void run_lines(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    contact *c = job;
    const smr_piece piece = smr_piece_of(task, SMR_LINES_TASK, c->n_u * c->n_v);
    smr_line l = {.u = c->u, .v = c->v, .w = c->w};
    float sum = 0.0f;
    for (uint32_t i = piece.first; i < piece.last; i++) {
        l.pu = smr_axis_of(c->box.lo, l.u) + ((float)(i / c->n_v) + 0.5f) * c->du;
        l.pv = smr_axis_of(c->box.lo, l.v) + ((float)(i % c->n_v) + 0.5f) * c->dv;
        l.n = 0;
        smr_line_cross(c->sweep[0].a, &l, smr_v(0, 0, 0), 1);
        smr_line_cross(c->sweep[0].b, &l, c->sweep[0].shift, 2);
        sum += smr_line_inside(&l);
    }
    place_of(c, task)->sum = sum;
}

static void take_lines(void *job, uint32_t first, uint32_t last)
{
    contact *c = job;
    for (uint32_t task = first; task < last; task++)
        c->length += c->place[task % SMR_CONTACT_PLACES].sum;
}

static void finish(void *job, SMR_UNUSED uint32_t task, SMR_UNUSED uint32_t worker)
{
    const contact *c = job;
    const found *one = &c->sweep[0].found, *other = &c->sweep[1].found;
    *c->report = (smr_contact_report){.deepest_mm = smr_max(one->deepest, other->deepest),
                                      .a_in_b_mm = one->deepest,
                                      .volume_mm3 = c->length * c->du * c->dv,
                                      .area_mm2 = 0.5f * (one->sum + other->sum)};
}

static const smr_stage stages[] = {
    {leaf_tasks, test_leaf, NULL, keep_near},
    {triangle_tasks, run_triangle, places, take_triangles},
    {NULL, next_leaves, NULL, NULL}, /* back to the first stage */
    {vertex_tasks, run_vertices, places, take_vertices},
    {NULL, begin_volume, NULL, NULL},
    {line_tasks, run_lines, places, take_lines},
    {NULL, finish, NULL, NULL},
};

#define SMR_CONTACT_STAGES ((uint32_t)(sizeof stages / sizeof stages[0]))

/* Returns 1 while both surfaces are as at the begin. */
static int is_unchanged(void *job, int enter)
{
    const contact *c = job;
    const smr_surface *a = c->sweep[0].a, *b = c->sweep[0].b;
    return !enter ||
           (smr_surface_valid(a) && smr_surface_valid(b) && a->changes == c->changes[0] && b->changes == c->changes[1]);
}

/* Returns 1 when the boxes of two closed surfaces are so near that the surfaces can touch. */
static int can_touch(const smr_surface *a, const smr_surface *b, const sweep *s)
{
    const smr_box one = smr_node_box(smr_tree_root(&a->tree));
    if (a->open || b->open || a->n_fragment + b->n_fragment > 0u)
        return 0;
    const smr_vec nearest = smr_low(smr_high(smr_sub(one.lo, s->shift), s->around.lo), s->around.hi);
    const smr_box moved = {smr_sub(one.lo, s->shift), smr_sub(one.hi, s->shift)};
    const float reach = (s->within + SMR_ROUNDED_MM) * SMR_ROUNDED;
    return smr_box_reaches(&moved, nearest, reach);
}

smr_status smr_surface_contact_begin(const smr_surface *a, const smr_surface *b, float within_mm,
                                     smr_contact_report *report, smr_job *job)
{
    contact *const c = (contact *)(void *)job;
    if (a == NULL || b == NULL || report == NULL || job == NULL)
        return SMR_E_NULL;
    if (!smr_surface_valid(a) || !smr_surface_valid(b) || smr_is_cloud(a) || smr_is_cloud(b))
        return SMR_E_STATE;
    if (!(within_mm >= 0.0f && within_mm <= SMR_DEPTH_MOST))
        return SMR_E_INPUT;
    memset(c, 0, sizeof *c);
    c->head = smr_job_begin(stages, SMR_CONTACT_STAGES, NULL);
    c->head.guard = is_unchanged;
    c->report = report;
    c->changes[0] = a->changes;
    c->changes[1] = b->changes;
    const found none = {smr_no_box(), 0.0f, 0.0f};
    c->sweep[0] = (sweep){a, b, smr_sub(b->origin, a->origin), smr_node_box(smr_tree_root(&b->tree)), within_mm, none};
    c->sweep[1] = (sweep){b, a, smr_sub(a->origin, b->origin), smr_node_box(smr_tree_root(&a->tree)), within_mm, none};
    if (!can_touch(a, b, &c->sweep[0]))
        c->head.stage = SMR_CONTACT_STAGES - 1u; /* only finish() runs: all measures are 0 */
    return SMR_OK;
}

smr_status smr_surface_contact(const smr_surface *a, const smr_surface *b, float within_mm, smr_contact_report *report)
{
    smr_job job;
    SMR_TRY(smr_surface_contact_begin(a, b, within_mm, report, &job));
    return smr_job_step(&job, 0, NULL, 0);
}
