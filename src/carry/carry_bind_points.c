/* carry_bind_points.c: makes the map and binds points to it: computes their coefficients from the rest shape alone.
 * Bounds: a radix sort and boxes over the vertices; for each point one search and one factor of the equations.
 * SPDX-License-Identifier: MIT */
#include "base/arena.h"
#include "carry/carry.h"
#include "geometry/box_tree/hilbert_curve.h"
#include "geometry/surface/mesh.h"

/* Reach of the covariance's parts, over the diagonal of the rest shape's box and over the mean step from vertex to
 * vertex along the curve; by trials. */
#define SMR_CARRY_SMOOTH_SHARE 0.75f
#define SMR_CARRY_ROUGH_STEPS 1.0f
#define SMR_CARRY_LEAST 1.0e-6f /* smallest range, mm, and over the diagonal */

/* A fit in progress: scratch, and the points to bind. */
typedef struct job {
    smr_carry *c;
    uint32_t *key;       /* [n_vertices] keys along the curve */
    uint32_t *tmp;       /* [2 n_vertices] */
    const float *points; /* [n_points][3] points, mm */
} job;

static void layout(smr_arena *a, uint32_t n_vertices, uint32_t n_points, uint32_t n_workers, job *j, smr_carry *c)
{
    uint32_t n_nodes;
    j->c = smr_arena_take(a, 1, sizeof *j->c);
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
    j->key = smr_arena_take(a, n_vertices, sizeof(uint32_t));
    j->tmp = smr_arena_take(a, n_vertices, 2u * sizeof(uint32_t));
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
    smr_carry c;
    job j;
    memset(&c, 0, sizeof c);
    layout(&a, n_vertices, n_points, n_workers, &j, &c);
    if (a.used == SIZE_MAX)
        return SMR_E_INPUT;
    *bytes = a.used;
    return SMR_OK;
}

/* Numbers the vertices along the curve and builds the trees. */
static void number(job *j, const float *rest)
{
    smr_carry *c = j->c;
    const smr_box box = smr_box_of(rest, c->n_vertices);
    const float diagonal = smr_max(smr_length(smr_sub(box.hi, box.lo)), SMR_CARRY_LEAST);
    float steps = 0.0f;
    c->centre = smr_whole(smr_scale(smr_add(box.lo, box.hi), 0.5f));
    c->per_smooth = 1.0f / (SMR_CARRY_SMOOTH_SHARE * diagonal);
    for (uint32_t v = 0; v < c->n_vertices; v++) {
        j->key[v] = smr_curve_key(box, smr_get3(rest, v));
        c->item[v] = v;
    }
    smr_curve_sort(j->key, c->item, j->tmp, c->n_vertices);
    for (uint32_t v = 0; v < c->n_vertices; v++)
        smr_put3(c->rest, v, smr_sub(smr_get3(rest, c->item[v]), c->centre));
    for (size_t v = 1; v < c->n_vertices; v++)
        steps += smr_length(smr_sub(smr_load(c->rest + 3u * v), smr_load(c->rest + 3u * (v - 1u))));
    c->per_rough = 1.0f / smr_max(SMR_CARRY_ROUGH_STEPS * steps / (float)c->n_vertices, SMR_CARRY_LEAST * diagonal);
    for (uint32_t k = 0; k < c->n_densities; k++)
        smr_carry_boxes(&c->thin[k], c->rest);
}

static void bind(smr_carry *c, smr_carry_site *s, smr_vec p, uint32_t i)
{
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
        near[k] = c->item[s->id[k < s->n ? k : 0u]];
        coefficient[k] = k < s->n ? s->side[k] : 0.0f;
    }
    coefficient[0] = 1.0f - open - sum;
    smr_store(left, smr_add(rest, smr_scale(first, open)));
    left[3] = open;
}

static void run_bind(void *arg, uint32_t task, uint32_t worker)
{
    const job *j = arg;
    smr_carry_site *s = smr_carry_site_of(j->c, worker);
    const uint32_t first = task * SMR_CARRY_CHUNK, end = smr_min_u32(j->c->n_points, first + SMR_CARRY_CHUNK);
    for (uint32_t i = first; i < end && s != NULL; i++)
        bind(j->c, s, smr_sub(smr_get3(j->points, i), j->c->centre), i);
}

smr_status smr_carry_fit(const float *rest, uint32_t n_vertices, const float *points, uint32_t n_points,
                         const smr_port *port, void *memory, size_t bytes, smr_carry **carry)
{
    const smr_port alone = {NULL, 1, NULL, NULL};
    const smr_port *used = port != NULL ? port : &alone;
    size_t needed;
    smr_arena a;
    job j;
    smr_carry c;
    if (rest == NULL || carry == NULL || (points == NULL && n_points > 0u))
        return SMR_E_NULL;
    smr_status status = smr_arena_start(&a, memory, bytes);
    if (status == SMR_OK)
        status = smr_carry_bytes(n_vertices, n_points, used->n_workers, &needed);
    if (status != SMR_OK)
        return status;
    if (!smr_all_within(rest, 3u * (size_t)n_vertices, SMR_COORD_MAX) ||
        !smr_all_within(points, 3u * (size_t)n_points, SMR_COORD_MAX))
        return SMR_E_INPUT;
    if (needed > bytes)
        return SMR_E_ARENA;
    smr_arena_release(memory, bytes);
    memset(&c, 0, sizeof c);
    layout(&a, n_vertices, n_points, used->n_workers, &j, &c);
    j.points = points;
    c.port = *used;
    *j.c = c;
    number(&j, rest);
    status = smr_carry_run(j.c, run_bind, &j, n_points);
    if (status != SMR_OK)
        return status;
    j.c->magic = SMR_CARRY_MAGIC;
    j.c->self = j.c;
    *carry = j.c;
    return SMR_OK;
}
