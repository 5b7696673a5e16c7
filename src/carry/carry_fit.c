/* carry_fit.c: binds points to the rest shape, a job (base/job.h): orders the vertices along a curve, fits boxes around
 * groups of them, and computes each point's coefficients from the rest shape alone.
 * Bounds: passes over the vertices in pieces, a radix sort among them; for each point one search and one factor of the
 * equations, a task each, the factor in three.
 * SPDX-License-Identifier: MIT */
#include "base/arena.h"
#include "base/bytes.h"
#include "base/job.h"
#include "carry/carry.h"
#include "geometry/box_tree/hilbert_curve.h"

#define SMR_CARRY_SMOOTH_SHARE 0.75f /* range of the covariance's smooth part / diagonal of the rest shape's box */
#define SMR_CARRY_ROUGH_STEPS 1.0f   /* range of the rough part / mean distance of successive vertices on the curve */
#define SMR_CARRY_LEAST 1.0e-6f      /* least diagonal of the box, mm; least range of the rough part / diagonal */
#define SMR_CARRY_PIECE 96u          /* number of vertices or points that a task visits */
#define SMR_CARRY_BOXES 4u           /* number of nodes whose boxes a task fits */
#define SMR_CARRY_PARTS 5u           /* number of tasks that together bind a point */

/* A call of smr_carry_fit() in progress. */
typedef struct binding {
    smr_job_head head;
    smr_carry *c;
    smr_carry **carry;              /* where the caller wants the address of the map */
    uint32_t *key;                  /* [n_vertices] sort key of each vertex: place along the Hilbert curve */
    uint32_t *tmp;                  /* [2 n_vertices] scratch of the sort by `key` */
    const float *rest, *points;     /* [n_vertices][3] and [n_points][3] the caller's positions, mm */
    smr_box box;                    /* box around the rest positions checked so far, mm */
    float diagonal, steps;          /* diagonal of the box; sum of the distances along the curve so far, mm */
    uint32_t whole;                 /* 1: a task binds a whole point; 0: a task does a part of the work on a point */
    uint32_t count[SMR_SORT_BYTES]; /* scratch of the sort: numbers of keys with each byte */
} binding;

_Static_assert(sizeof(binding) <= SMR_JOB_BYTES, "a binding in progress lies in the caller's job");

static void layout(smr_arena *a, uint32_t n_vertices, uint32_t n_points, uint32_t n_workers, binding *b, smr_carry *c)
{
    uint32_t n_nodes;
    b->c = smr_arena_take(a, 1, sizeof *b->c);
    c->n_vertices = n_vertices;
    c->n_points = n_points;
    smr_carry_shape(c->thin, n_vertices, &c->n_densities, &n_nodes);
    c->rest = smr_arena_take(a, n_vertices, 3u * sizeof(float));
    c->item = smr_arena_take(a, n_vertices, sizeof(uint32_t));
    smr_node *node = smr_arena_take(a, n_nodes, sizeof *node);
    c->site = smr_arena_take(a, n_workers, sizeof *c->site);
    c->near = smr_arena_take(a, n_points, SMR_CARRY_NEAR * sizeof(uint32_t));
    c->coefficient = smr_arena_take(a, n_points, SMR_CARRY_NEAR * sizeof(float));
    c->rest_part = smr_arena_take(a, n_points, 4u * sizeof(float));
    b->key = smr_arena_take(a, n_vertices, sizeof(uint32_t));
    b->tmp = smr_arena_take(a, n_vertices, 2u * sizeof(uint32_t));
    for (uint32_t k = 0; k < c->n_densities && node != NULL; k++) {
        c->thin[k].groups.node = node;
        node += smr_tree_nodes(c->thin[k].groups.n_triangles);
    }
}

smr_status smr_carry_bytes(uint32_t n_vertices, uint32_t n_points, uint32_t n_workers, size_t *bytes)
{
    if (bytes == NULL)
        return SMR_E_NULL;
    if (n_vertices == 0u || n_vertices > SMR_VERTICES_MAX || n_points > SMR_VERTICES_MAX || n_workers == 0u ||
        n_workers > SMR_WORKERS_MAX)
        return SMR_E_INPUT;
    smr_arena a = smr_arena_measure();
    smr_carry c = {0};
    binding b;
    layout(&a, n_vertices, n_points, n_workers, &b, &c);
    if (a.used == SIZE_MAX)
        return SMR_E_INPUT;
    *bytes = a.used;
    return SMR_OK;
}

/* ---- the stages ---- */

static uint32_t vertex_tasks(const void *job)
{
    return smr_ceil_div(((const binding *)job)->c->n_vertices, SMR_CARRY_PIECE);
}

static uint32_t check_tasks(const void *job)
{
    return vertex_tasks(job) + smr_ceil_div(((const binding *)job)->c->n_points, SMR_CARRY_PIECE);
}

/* Checks a piece of the rest positions, then of the points. The last piece of the rest positions sets the ranges. */
static void check(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    binding *b = job;
    smr_carry *c = b->c;
    const uint32_t n = vertex_tasks(job), of_points = task >= n;
    const smr_piece p =
        smr_piece_of(of_points ? task - n : task, SMR_CARRY_PIECE, of_points ? c->n_points : c->n_vertices);
    const float *xyz = of_points ? b->points : b->rest;
    if (!smr_all_within(xyz + 3u * (size_t)p.first, 3u * (size_t)(p.last - p.first), SMR_COORD_MAX))
        b->head.status = SMR_E_INPUT;
    if (task == 0u)
        b->box = (smr_box){smr_load(xyz), smr_load(xyz)};
    for (uint32_t v = p.first; v < p.last && !of_points; v++)
        smr_box_grow(&b->box, smr_get3(xyz, v));
    b->diagonal = smr_max(smr_length(smr_sub(b->box.hi, b->box.lo)), SMR_CARRY_LEAST);
    c->centre = smr_whole(smr_scale(smr_add(b->box.lo, b->box.hi), 0.5f));
    c->per_smooth = 1.0f / (SMR_CARRY_SMOOTH_SHARE * b->diagonal);
}

static void make_keys(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    const binding *b = job;
    const smr_piece p = smr_piece_of(task, SMR_CARRY_PIECE, b->c->n_vertices);
    for (uint32_t v = p.first; v < p.last; v++) {
        b->key[v] = smr_curve_key(b->box, smr_get3(b->rest, v));
        b->c->item[v] = v;
    }
}

/* The sort counts, then moves, all pieces in each pass; a short list is sorted at once. */
static uint32_t sort_tasks(const void *job)
{
    return ((const binding *)job)->c->n_vertices <= SMR_SORT_SMALL ? 1u : 2u * SMR_SORT_PASSES * vertex_tasks(job);
}

static void sort(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    binding *b = job;
    const uint32_t n = b->c->n_vertices, pieces = vertex_tasks(job), pass = task / (2u * pieces);
    const smr_sort s = {b->key, b->c->item, b->tmp, b->count, n};
    const smr_piece p = smr_piece_of(task % pieces, SMR_CARRY_PIECE, n);
    if (n <= SMR_SORT_SMALL)
        smr_curve_sort(b->key, b->c->item, b->tmp, n);
    else if (task / pieces % 2u == 0u)
        smr_sort_count(&s, pass, p.first, p.last);
    else
        smr_sort_move(&s, pass, p.first, p.last);
}

/* Copies rest positions in the order of the curve, and adds the distances of successive ones. Tasks run in order. */
static void copy_rest(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    binding *b = job;
    smr_carry *c = b->c;
    const smr_piece p = smr_piece_of(task, SMR_CARRY_PIECE, c->n_vertices);
    for (uint32_t v = p.first; v < p.last; v++) {
        smr_put3(c->rest, v, smr_sub(smr_get3(b->rest, smr_carry_item(c, v)), c->centre));
        if (v > 0u)
            b->steps += smr_length(smr_sub(smr_get3(c->rest, v), smr_get3(c->rest, v - 1u)));
    }
    c->per_rough =
        1.0f / smr_max(SMR_CARRY_ROUGH_STEPS * b->steps / (float)c->n_vertices, SMR_CARRY_LEAST * b->diagonal);
}

/* Returns the number of tasks that fit boxes of leaves, or of nodes above them, of one selection. */
static uint32_t box_pieces(const smr_carry_thin *t, int above)
{
    const uint32_t leaves = smr_tree_leaves(&t->groups), all = smr_tree_nodes(t->groups.n_triangles);
    return smr_ceil_div(above ? all - leaves : leaves, SMR_CARRY_BOXES);
}

static uint32_t box_tasks(const binding *b, int above)
{
    uint32_t n = 0;
    for (uint32_t k = 0; k < b->c->n_densities; k++)
        n += box_pieces(&b->c->thin[k], above);
    return n;
}

static uint32_t leaf_tasks(const void *job) { return box_tasks(job, 0); }
static uint32_t node_tasks(const void *job) { return box_tasks(job, 1); }

static void fit_boxes(const binding *b, uint32_t task, int above)
{
    const smr_carry_thin *t = b->c->thin;
    for (; task >= box_pieces(t, above); t++)
        task -= box_pieces(t, above);
    const uint32_t leaves = smr_tree_leaves(&t->groups), all = smr_tree_nodes(t->groups.n_triangles);
    const smr_piece p = smr_piece_of(task, SMR_CARRY_BOXES, above ? all - leaves : leaves);
    if (above)
        smr_tree_refit_nodes(&t->groups, leaves + p.first, leaves + p.last);
    else
        smr_carry_boxes(t, b->c->rest, p.first, p.last);
}

static void fit_leaves(void *job, uint32_t task, SMR_UNUSED uint32_t worker) { fit_boxes(job, task, 0); }
static void fit_nodes(void *job, uint32_t task, SMR_UNUSED uint32_t worker) { fit_boxes(job, task, 1); }

static uint32_t n_sites(const void *job) { return ((const binding *)job)->c->port.n_workers; }

/* In pieces, tasks visit a part of as many points as there are sites, then the next part, then the next points. */
static uint32_t point_tasks(const void *job)
{
    const binding *b = job;
    const uint32_t n = b->c->n_points, sites = n_sites(b);
    return b->whole ? n : smr_ceil_div(n, sites) * sites * SMR_CARRY_PARTS;
}

static uint32_t point_places(const void *job)
{
    return ((const binding *)job)->whole ? point_tasks(job) : n_sites(job);
}

/* Writes the vertices near point i, their coefficients, and the remaining part that T maps. */
static void write_point(const binding *b, uint32_t i, smr_carry_site *s)
{
    smr_carry *c = b->c;
    const smr_vec p = smr_sub(smr_get3(b->points, i), c->centre);
    uint32_t *near = c->near + (size_t)SMR_CARRY_NEAR * i;
    float *coefficient = c->coefficient + (size_t)SMR_CARRY_NEAR * i, *left = c->rest_part + 4u * (size_t)i;
    float open = smr_carry_side(c, p, s), sum = 0.0f;
    smr_carry_solve(s, s->side);
    const smr_vec first = smr_carry_place(s, 0);
    smr_vec rest = smr_sub(p, first);
    for (uint32_t k = 1; k < s->n; k++) {
        open -= s->side[k] * s->far[k];
        sum += s->side[k];
        rest = smr_sub(rest, smr_scale(smr_sub(smr_carry_place(s, k), first), s->side[k]));
    }
    open /= 1.0f + SMR_CARRY_ROUGH;
    for (uint32_t k = 0; k < SMR_CARRY_NEAR; k++) {
        near[k] = smr_carry_item(c, s->id[k < s->n ? k : 0u]);
        coefficient[k] = k < s->n ? s->side[k] : 0.0f;
    }
    coefficient[0] = 1.0f - open - sum;
    smr_store(left, smr_add(rest, smr_scale(first, open)));
    left[3] = open;
}

/* Does a part of the work that binds point i, in s: the vertices near the point, the equations, their factors in three
 * parts of about equal work, the last with the point's results. */
static void bind_part(const binding *b, uint32_t i, uint32_t part, smr_carry_site *s)
{
    static const uint32_t first[] = {0, 0, 0, 7, 17, SMR_CARRY_NEAR}; /* first column of the factor in each part */
    if (part == 0u)
        smr_carry_gather(b->c, smr_sub(smr_get3(b->points, i), b->c->centre), s);
    if (part == 1u)
        smr_carry_fill(b->c, s);
    if (part >= 2u)
        smr_carry_factor(s, first[part], first[part + 1u]);
    if (part + 1u == SMR_CARRY_PARTS)
        write_point(b, i, s);
}

static void bind(void *job, uint32_t task, uint32_t worker)
{
    const binding *b = job;
    const uint32_t n = n_sites(b), i = task / (n * SMR_CARRY_PARTS) * n + task % n;
    if (!b->whole && i < b->c->n_points)
        bind_part(b, i, task / n % SMR_CARRY_PARTS, &b->c->site[task % n]);
    for (uint32_t part = 0; part < SMR_CARRY_PARTS && b->whole; part++)
        bind_part(b, task, part, &b->c->site[worker]);
}

static void finish(void *job, SMR_UNUSED uint32_t task, SMR_UNUSED uint32_t worker)
{
    const binding *b = job;
    b->c->magic = SMR_CARRY_MAGIC;
    b->c->self = b->c;
    b->c->guard = smr_byte_sum(0, b->c, offsetof(smr_carry, guard));
    *b->carry = b->c;
}

static const smr_stage stages[] = {
    {check_tasks, check, smr_in_order, NULL}, {vertex_tasks, make_keys, NULL, NULL},
    {sort_tasks, sort, smr_in_order, NULL},   {vertex_tasks, copy_rest, smr_in_order, NULL},
    {leaf_tasks, fit_leaves, NULL, NULL},     {node_tasks, fit_nodes, smr_in_order, NULL},
    {point_tasks, bind, point_places, NULL},  {NULL, finish, NULL, NULL},
};

smr_status smr_carry_fit_begin(const float *rest, uint32_t n_vertices, const float *points, uint32_t n_points,
                               const smr_port *port, void *memory, size_t bytes, smr_carry **carry, smr_job *job)
{
    const smr_port *used = port != NULL ? port : &smr_alone;
    binding *const b = (binding *)(void *)job;
    size_t needed;
    smr_arena a;
    smr_carry c = {0};
    if (rest == NULL || carry == NULL || job == NULL || (points == NULL && n_points > 0u))
        return SMR_E_NULL;
    SMR_TRY(smr_arena_start(&a, memory, bytes));
    SMR_TRY(smr_carry_bytes(n_vertices, n_points, used->n_workers, &needed));
    if (needed > bytes)
        return SMR_E_ARENA;
    smr_arena_release(memory, bytes);
    memset(b, 0, sizeof *b);
    b->head = smr_job_begin(stages, sizeof stages / sizeof stages[0], used);
    b->head.most_workers = used->n_workers;
    layout(&a, n_vertices, n_points, used->n_workers, b, &c);
    b->carry = carry;
    b->rest = rest;
    b->points = points;
    c.port = *used;
    *b->c = c;
    return SMR_OK;
}

static void bind_whole(smr_job *job) { ((binding *)(void *)job)->whole = 1; }

smr_status smr_carry_fit(const float *rest, uint32_t n_vertices, const float *points, uint32_t n_points,
                         const smr_port *port, void *memory, size_t bytes, smr_carry **carry)
{
    smr_job job;
    SMR_TRY(smr_carry_fit_begin(rest, n_vertices, points, n_points, port, memory, bytes, carry, &job));
    bind_whole(&job);
    return smr_job_step(&job, 0, NULL, 0);
}
