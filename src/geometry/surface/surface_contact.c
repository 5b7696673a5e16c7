/* surface_contact.c: overlap of two closed surfaces: deepest penetration, overlapping volume, area in contact. Depth
 * and area are measured at the vertices of both surfaces and at three points of each triangle that can reach the
 * other surface. Between two places the distance to a surface changes by their distance at most, which saves searches.
 * The volume is a sum over a grid of lines, on each of which the length inside both surfaces is exact. A job (job.h).
 * Bounds: four places a triangle, one a leaf, one a vertex (surface_sweep.c); SMR_LINES^2 lines of two passes through a
 * tree, and two passes for SMR_CONTACT_PLACES lines.
 * SPDX-License-Identifier: MIT */
#include "base/job.h"
#include "geometry/box_tree/triangle.h"
#include "geometry/surface/surface_sweep.h"

#define SMR_LINES 64u          /* largest number of lines of the volume's grid along each of two axes */
#define SMR_LINE_MM 0.25f      /* smallest distance between two lines, mm */
#define SMR_VERTICES_TASK 3u   /* vertices in a task */
#define SMR_CONTACT_LEAVES 4u  /* leaves that are tested before the triangles of the near ones are measured */
#define SMR_CONTACT_POINTS 3u  /* points of a triangle, each of which is a task behind that of the middle */
#define SMR_CONTACT_PLACES 16u /* tasks whose results wait to be added */

/* A leaf whose triangles may reach the other surface. */
typedef struct near_leaf {
    uint32_t leaf; /* number among the leaves of a, then of b; SMR_NONE: far */
    smr_sweep_place middle;
} near_leaf;

typedef struct contact {
    smr_job_head head;
    smr_sweep sweep[2]; /* of a in b, and of b in a */
    smr_contact_report *report;
    uint32_t changes[2];                       /* smr_surface.changes at the begin */
    smr_box box;                               /* box around the overlap, mm from a's origin */
    uint32_t u, v, w;                          /* axes across the lines, and along them */
    uint32_t n_u, n_v;                         /* numbers of lines along the axes u and v */
    float du, dv;                              /* distances of the lines, mm */
    uint32_t line;                             /* first of the lines that are tested now */
    smr_extent on[2];                          /* extents of a and b on these lines, mm from a's origin */
    float length;                              /* length of all lines inside both surfaces so far, mm */
    smr_sweep_found place[SMR_CONTACT_PLACES]; /* results of tasks */
    uint32_t leaf, n_near; /* first leaf of a, then of b, that is tested now; number of near ones among those tested */
    uint32_t warm[2];      /* triangle of b, and of a, closest to the last near leaf */
    near_leaf near[SMR_CONTACT_LEAVES];
    smr_sweep_middle middle[SMR_CONTACT_LEAVES * SMR_TREE_WIDTH]; /* of the triangles of the near leaves */
    float part; /* area in contact of the points of a triangle so far, mm^2; length inside of a pair of lines, mm */
} contact;

_Static_assert(sizeof(contact) <= SMR_JOB_BYTES, "a measurement in progress lies in the caller's job");

static uint32_t places(const void *job) { return (void)job, SMR_CONTACT_PLACES; }

static smr_sweep_found *place_of(contact *c, uint32_t task)
{
    smr_sweep_found *const f = &c->place[task % SMR_CONTACT_PLACES];
    *f = (smr_sweep_found){smr_sweep_no_box, 0.0f, 0.0f};
    return f;
}

/* Adds the results of a task to a sweep. */
static void take(contact *c, uint32_t task, uint32_t i)
{
    const smr_sweep_found *f = &c->place[task % SMR_CONTACT_PLACES];
    smr_sweep_found *const to = &c->sweep[i].found;
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
    c->near[task].middle.warm = c->warm[leaf >= n];
    const int is_near = smr_sweep_leaf(&c->sweep[leaf >= n], leaf < n ? leaf : leaf - n, &c->near[task].middle);
    c->near[task].leaf = is_near ? leaf : SMR_NONE;
}

static void keep_near(void *job, uint32_t first, uint32_t last)
{
    contact *c = job;
    c->n_near = first == 0u ? 0u : c->n_near;
    for (uint32_t task = first; task < last; task++)
        if (c->near[task].leaf != SMR_NONE) {
            c->warm[c->near[task].leaf >= leaves_of(c, 0)] = c->near[task].middle.warm;
            c->near[c->n_near++] = c->near[task];
        }
}

static uint32_t triangle_tasks(const void *job) { return ((const contact *)job)->n_near * SMR_TREE_WIDTH; }
static uint32_t point_tasks(const void *job) { return SMR_CONTACT_POINTS * triangle_tasks(job); }

/* Returns the sweep of the surface that has near leaf `at`, and sets *leaf to the leaf's number there. */
static smr_sweep *sweep_of(contact *c, uint32_t at, uint32_t *leaf)
{
    const uint32_t n = leaves_of(c, 0), i = c->near[at].leaf >= n;
    *leaf = c->near[at].leaf - (i ? n : 0u);
    return &c->sweep[i];
}

static void run_triangle(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    contact *c = job;
    const uint32_t at = task / SMR_TREE_WIDTH;
    uint32_t leaf;
    const smr_sweep *s = sweep_of(c, at, &leaf);
    const uint32_t k = leaf * SMR_TREE_WIDTH + task % SMR_TREE_WIDTH;
    smr_sweep_place last = c->near[at].middle;
    smr_sweep_found *const f = place_of(c, task);
    c->middle[task] = (smr_sweep_middle){.third = 0.0f};
    if (k < s->a->tree.n_triangles)
        c->middle[task] = smr_sweep_triangle(s, k, &last, f);
    f->sum = 0.0f; /* added with the points, in the order of the triangles */
}

static void take_triangles(void *job, uint32_t first, uint32_t last)
{
    contact *c = job;
    for (uint32_t task = first; task < last; task++)
        take(c, task, c->near[task / SMR_TREE_WIDTH].leaf >= leaves_of(c, 0));
}

/* Adds a point between a corner of a triangle and its middle. */
static void run_point(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    contact *c = job;
    const uint32_t triangle = task / SMR_CONTACT_POINTS;
    const smr_sweep_middle *m = &c->middle[triangle];
    uint32_t leaf;
    const smr_sweep *s = sweep_of(c, triangle / SMR_TREE_WIDTH, &leaf);
    smr_sweep_found *const f = place_of(c, task);
    if (!(m->third > 0.0f))
        return;
    const uint32_t k = leaf * SMR_TREE_WIDTH + triangle % SMR_TREE_WIDTH;
    const uint32_t v = smr_triangle_of(s->a->triangle, k, s->a->n_vertices)[task % SMR_CONTACT_POINTS];
    const smr_vec corner = smr_sub(smr_get3(s->a->xyz, v), s->shift);
    smr_sweep_point(s, smr_scale(smr_add(corner, m->at.at), 0.5f), m->third, &m->at, f);
}

static void take_points(void *job, uint32_t first, uint32_t last)
{
    contact *c = job;
    for (uint32_t task = first; task < last; task++) {
        const uint32_t triangle = task / SMR_CONTACT_POINTS, nth = task % SMR_CONTACT_POINTS;
        uint32_t leaf;
        smr_sweep_found *const to = &sweep_of(c, triangle / SMR_TREE_WIDTH, &leaf)->found,
                               *f = &c->place[task % SMR_CONTACT_PLACES];
        c->part = (nth == 0u ? c->middle[triangle].sum : c->part) + f->sum;
        to->deepest = smr_max(to->deepest, f->deepest);
        to->sum += nth + 1u == SMR_CONTACT_POINTS ? c->part : 0.0f;
    }
}

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
    smr_sweep_vertices(&c->sweep[i], smr_piece_of(i ? task - n : task, SMR_VERTICES_TASK, c->sweep[i].a->n_vertices),
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
    const smr_sweep *one = &c->sweep[0], *other = &c->sweep[1];
    const smr_box all_a = other->around;
    smr_box box = {smr_low(one->found.near.lo, smr_add(other->found.near.lo, one->shift)),
                   smr_high(one->found.near.hi, smr_add(other->found.near.hi, one->shift))};
    box.lo = smr_high(box.lo, smr_high(all_a.lo, smr_add(one->around.lo, one->shift)));
    box.hi = smr_low(box.hi, smr_low(all_a.hi, smr_add(one->around.hi, one->shift)));
    const smr_vec size = smr_sub(box.hi, box.lo);
    c->box = box; /* a box without room gets no lines */
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

/* Returns the line of the grid in row i, column k. */
static smr_ray ray_of(const contact *c, uint32_t i, uint32_t k)
{
    return (smr_ray){c->u, c->v, c->w, smr_axis_of(c->box.lo, c->u) + ((float)i + 0.5f) * c->du,
                     smr_axis_of(c->box.lo, c->v) + ((float)k + 0.5f) * c->dv};
}

static uint32_t n_lines(const contact *c) { return c->n_u * c->n_v; }

/* Returns the number of lines that are tested at once: SMR_CONTACT_PLACES of a row, or the rest of the row. */
static uint32_t lines_at_once(const contact *c) { return smr_min_u32(SMR_CONTACT_PLACES, c->n_v - c->line % c->n_v); }

static uint32_t extent_tasks(const void *job)
{
    const contact *c = job;
    return c->line < n_lines(c) ? 2u : 0u;
}

/* Finds where a, then b, lies on the lines that are tested at once. */
static void find_extent(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    contact *c = job;
    const uint32_t i = c->line / c->n_v, k = c->line % c->n_v;
    const smr_ray low = ray_of(c, i, k), high = ray_of(c, i, k + lines_at_once(c) - 1u);
    if (task == 0u)
        c->on[0] = smr_lines_extent(c->sweep[0].a, &low, &high, smr_v(0, 0, 0));
    else if (c->on[0].lo <= c->on[0].hi)
        c->on[1] = smr_lines_extent(c->sweep[0].b, &low, &high, c->sweep[0].shift);
}

/* Returns the number of lines to be measured: none where the surfaces lie apart from each other on all of them. */
static uint32_t line_tasks(const void *job)
{
    const contact *c = job;
    const smr_extent a = c->on[0], b = c->on[1];
    return c->line < n_lines(c) && a.lo <= a.hi && a.lo <= b.hi && a.hi >= b.lo ? lines_at_once(c) : 0u;
}

static void run_line(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    contact *c = job;
    const uint32_t at = c->line + task;
    smr_sweep_found *const f = place_of(c, task);
    smr_line l;
    l.ray = ray_of(c, at / c->n_v, at % c->n_v);
    l.n = 0;
    smr_line_cross(c->sweep[0].a, &l, smr_v(0, 0, 0), SMR_FAR, 1);
    if (l.n == 0u || l.list[0].at > c->on[1].hi || l.list[l.n - 1u].at < c->on[1].lo)
        return;
    smr_line_cross(c->sweep[0].b, &l, c->sweep[0].shift, l.list[l.n - 1u].at, 2);
    f->sum = smr_line_inside(&l);
}

/* Adds lengths by pairs of lines: lengths of both first, then the sum. */
static void take_lines(void *job, uint32_t first, uint32_t last)
{
    contact *c = job;
    for (uint32_t task = first; task < last; task++) {
        const uint32_t at = c->line + task;
        c->part = (at % 2u == 0u ? 0.0f : c->part) + c->place[task % SMR_CONTACT_PLACES].sum;
        c->length += at % 2u == 1u || at + 1u == n_lines(c) ? c->part : 0.0f;
    }
}

static void next_lines(void *job, SMR_UNUSED uint32_t task, SMR_UNUSED uint32_t worker)
{
    contact *c = job;
    if (c->line == n_lines(c))
        return;
    if (line_tasks(c) == 0u) { /* lengths of 0 */
        c->length += c->line % 2u == 1u ? c->part : 0.0f;
        c->part = 0.0f;
    }
    c->line += lines_at_once(c);
    c->head.next_stage = c->head.stage - 2u;
}

static void finish(void *job, SMR_UNUSED uint32_t task, SMR_UNUSED uint32_t worker)
{
    const contact *c = job;
    const smr_sweep_found *one = &c->sweep[0].found, *other = &c->sweep[1].found;
    *c->report = (smr_contact_report){.deepest_mm = smr_max(one->deepest, other->deepest),
                                      .a_in_b_mm = one->deepest,
                                      .volume_mm3 = c->length * c->du * c->dv,
                                      .area_mm2 = 0.5f * (one->sum + other->sum)};
}

static const smr_stage stages[] = {
    {leaf_tasks, test_leaf, NULL, keep_near},
    {triangle_tasks, run_triangle, places, take_triangles},
    {point_tasks, run_point, places, take_points},
    {NULL, next_leaves, NULL, NULL}, /* back to the first stage */
    {vertex_tasks, run_vertices, places, take_vertices},
    {NULL, begin_volume, NULL, NULL},
    {extent_tasks, find_extent, smr_in_order, NULL},
    {line_tasks, run_line, places, take_lines},
    {NULL, next_lines, NULL, NULL}, /* back to the stage of extents */
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
static int can_touch(const smr_surface *a, const smr_surface *b, const smr_sweep *s)
{
    const smr_box one = smr_sweep_box(a);
    if (a->open || b->open || a->n_fragment + b->n_fragment > 0u)
        return 0;
    const smr_vec nearest = smr_low(smr_high(smr_sub(one.lo, s->shift), s->around.lo), s->around.hi);
    const smr_box moved = {smr_sub(one.lo, s->shift), smr_sub(one.hi, s->shift)};
    const float reach = (s->within + SMR_SWEEP_MORE_MM) * SMR_SWEEP_MORE;
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
    c->warm[0] = c->warm[1] = SMR_NONE;
    const smr_sweep_found none = {smr_sweep_no_box, 0.0f, 0.0f};
    c->sweep[0] = (smr_sweep){a, b, smr_sub(b->origin, a->origin), smr_sweep_box(b), within_mm, none};
    c->sweep[1] = (smr_sweep){b, a, smr_sub(a->origin, b->origin), smr_sweep_box(a), within_mm, none};
    if (!can_touch(a, b, &c->sweep[0]))
        c->head.stage = SMR_CONTACT_STAGES - 1u; /* all measures are 0 */
    return SMR_OK;
}

smr_status smr_surface_contact(const smr_surface *a, const smr_surface *b, float within_mm, smr_contact_report *report)
{
    smr_job job;
    return smr_job_whole(smr_surface_contact_begin(a, b, within_mm, report, &job), &job, NULL);
}
