/* carry_points.c: carries points along with the model: binds them to the rest shape, then moves them to a present one.
 * Binding computes a point's coefficients from the rest shape alone; moving it is one sum of SMR_CARRY_NEAR terms.
 * Bounds: a radix sort and boxes over the vertices; for each bound point one search and one factor of the equations.
 * SPDX-License-Identifier: MIT */
#include "base/arena.h"
#include "base/bytes.h"
#include "carry/carry.h"
#include "geometry/box_tree/hilbert_curve.h"
#include "geometry/rotation/similarity_fit.h"
#include "geometry/surface/mesh.h"

#define SMR_CARRY_SMOOTH_SHARE 0.75f /* range of the covariance's smooth part / diagonal of the rest shape's box */
#define SMR_CARRY_ROUGH_STEPS 1.0f   /* range of the rough part / mean distance of successive vertices on the curve */
#define SMR_CARRY_LEAST 1.0e-6f      /* least diagonal of the box, mm; least range of the rough part / diagonal */

/* Arguments and scratch of smr_carry_fit(), which binds points. */
typedef struct binding {
    smr_carry *c;
    uint32_t *key;       /* [n_vertices] sort key of each vertex: place along the Hilbert curve */
    uint32_t *tmp;       /* [2 n_vertices] scratch of the sort by `key` */
    const float *points; /* [n_points][3] points to bind, mm */
} binding;

/* Arguments of smr_carry_apply(), which moves bound points. */
typedef struct motion {
    smr_carry *c;
    const float *now; /* [n_vertices][3] present positions in the caller's order, mm */
    smr_pose trend;   /* similarity T from rest to present positions */
    float *out;       /* [n_points][3] present positions of the points, mm */
} motion;

/* Arguments of smr_carry_run(), whose tasks handle SMR_CARRY_CHUNK points each. */
typedef struct chunks {
    smr_carry *c;
    smr_carry_each *each; /* function that is called for each point */
    const void *arg;      /* first argument of each() */
    uint32_t n;           /* number of points */
} chunks;

static void run_chunk(void *arg, uint32_t task, uint32_t worker)
{
    const chunks *a = arg;
    const uint32_t first = task * SMR_CARRY_CHUNK, end = smr_min_u32(a->n, first + SMR_CARRY_CHUNK);
    for (uint32_t i = first; i < end; i++)
        a->each(a->arg, &a->c->site[worker], i);
}

smr_status smr_carry_run(smr_carry *c, smr_carry_each *each, const void *arg, uint32_t n)
{
    chunks all = {c, each, arg, n};
    return smr_fork(&c->port, run_chunk, &all, smr_ceil_div(n, SMR_CARRY_CHUNK)) ? SMR_OK : SMR_E_STATE;
}

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

/* Orders the vertices along a Hilbert curve, sets the ranges of the covariance, and fits the boxes of all trees. */
static void number(const binding *b, const float *rest)
{
    smr_carry *c = b->c;
    const smr_box box = smr_box_of(rest, c->n_vertices);
    const float diagonal = smr_max(smr_length(smr_sub(box.hi, box.lo)), SMR_CARRY_LEAST);
    float steps = 0.0f;
    c->centre = smr_whole(smr_scale(smr_add(box.lo, box.hi), 0.5f));
    c->per_smooth = 1.0f / (SMR_CARRY_SMOOTH_SHARE * diagonal);
    for (uint32_t v = 0; v < c->n_vertices; v++) {
        b->key[v] = smr_curve_key(box, smr_get3(rest, v));
        c->item[v] = v;
    }
    smr_curve_sort(b->key, c->item, b->tmp, c->n_vertices);
    for (uint32_t v = 0; v < c->n_vertices; v++)
        smr_put3(c->rest, v, smr_sub(smr_get3(rest, c->item[v]), c->centre));
    for (size_t v = 1; v < c->n_vertices; v++)
        steps += smr_length(smr_sub(smr_load(c->rest + 3u * v), smr_load(c->rest + 3u * (v - 1u))));
    c->per_rough = 1.0f / smr_max(SMR_CARRY_ROUGH_STEPS * steps / (float)c->n_vertices, SMR_CARRY_LEAST * diagonal);
    for (uint32_t k = 0; k < c->n_densities; k++)
        smr_carry_boxes(&c->thin[k], c->rest);
}

/* Binds point i: writes the vertices near the point, their coefficients, and the remaining part that T maps. */
static void bind(const void *arg, smr_carry_site *s, uint32_t i)
{
    const binding *b = arg;
    smr_carry *c = b->c;
    const smr_vec p = smr_sub(smr_get3(b->points, i), c->centre);
    uint32_t *near = c->near + (size_t)SMR_CARRY_NEAR * i;
    float *coefficient = c->coefficient + (size_t)SMR_CARRY_NEAR * i, *left = c->rest_part + 4u * (size_t)i;
    smr_carry_gather(c, p, s);
    smr_carry_factor(c, s);
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

smr_status smr_carry_fit(const float *rest, uint32_t n_vertices, const float *points, uint32_t n_points,
                         const smr_port *port, void *memory, size_t bytes, smr_carry **carry)
{
    const smr_port alone = {NULL, 1, NULL, NULL};
    const smr_port *used = port != NULL ? port : &alone;
    size_t needed;
    smr_arena a;
    binding b;
    smr_carry c = {0};
    if (rest == NULL || carry == NULL || (points == NULL && n_points > 0u))
        return SMR_E_NULL;
    SMR_TRY(smr_arena_start(&a, memory, bytes));
    SMR_TRY(smr_carry_bytes(n_vertices, n_points, used->n_workers, &needed));
    if (!smr_all_within(rest, 3u * (size_t)n_vertices, SMR_COORD_MAX) ||
        !smr_all_within(points, 3u * (size_t)n_points, SMR_COORD_MAX))
        return SMR_E_INPUT;
    if (needed > bytes)
        return SMR_E_ARENA;
    smr_arena_release(memory, bytes);
    layout(&a, n_vertices, n_points, used->n_workers, &b, &c);
    b.points = points;
    c.port = *used;
    *b.c = c;
    number(&b, rest);
    SMR_TRY(smr_carry_run(b.c, bind, &b, n_points));
    b.c->magic = SMR_CARRY_MAGIC;
    b.c->self = b.c;
    b.c->guard = smr_byte_sum(0, b.c, offsetof(smr_carry, guard));
    *carry = b.c;
    return SMR_OK;
}

smr_pose smr_carry_trend(const smr_carry *c, const float *now)
{
    const smr_carry_thin *t = &c->thin[c->n_densities - 1u];
    smr_fit fit;
    smr_fit_start(&fit, smr_v(0, 0, 0), smr_get3(now, smr_carry_item(c, t->first)));
    for (uint32_t i = 0; i < t->n; i++) {
        const uint32_t v = t->first + i * t->stride;
        smr_fit_add(&fit, smr_get3(c->rest, v), smr_get3(now, smr_carry_item(c, v)), 1.0f);
    }
    return smr_fit_solve(&fit, 1);
}

smr_status smr_carry_check(const smr_carry *c, const float *now)
{
    if (c == NULL || now == NULL)
        return SMR_E_NULL;
    if (c->magic != SMR_CARRY_MAGIC || c->self != c)
        return SMR_E_STATE;
    if (c->guard != smr_byte_sum(0, c, offsetof(smr_carry, guard)))
        return SMR_E_DAMAGED;
    return smr_all_within(now, 3u * (size_t)c->n_vertices, SMR_COORD_MAX) ? SMR_OK : SMR_E_INPUT;
}

/* Writes the present position of point i, mm. The sum is relative to the nearest vertex, which limits rounding. */
static void apply(const void *arg, SMR_UNUSED smr_carry_site *s, uint32_t i)
{
    const motion *m = arg;
    const uint32_t *near = m->c->near + (size_t)SMR_CARRY_NEAR * i;
    const float *coefficient = m->c->coefficient + (size_t)SMR_CARRY_NEAR * i;
    const float *left = m->c->rest_part + 4u * (size_t)i;
    const uint32_t n = m->c->n_vertices;
    const smr_vec from = smr_get3(m->now, smr_index(near[0], n)), rest = smr_load(left);
    smr_vec sum = smr_v(0, 0, 0);
    for (uint32_t k = 1; k < SMR_CARRY_NEAR; k++)
        sum = smr_add(sum, smr_scale(smr_sub(smr_get3(m->now, smr_index(near[k], n)), from), coefficient[k]));
    const smr_vec open = smr_sub(smr_column(&m->trend, 3), from);
    sum = smr_add(sum, smr_add(smr_pose_turn(&m->trend, rest), smr_scale(open, left[3])));
    smr_put3(m->out, i, smr_add(from, sum));
}

smr_status smr_carry_apply(smr_carry *carry, const float *now, float *xyz)
{
    SMR_TRY(xyz == NULL ? SMR_E_NULL : smr_carry_check(carry, now));
    const motion m = {carry, now, smr_carry_trend(carry, now), xyz};
    return smr_carry_run(carry, apply, &m, carry->n_points);
}
