/* carry_nearest_vertices.c: the vertices near a point, at four densities. A density is every k-th vertex along a
 * Hilbert curve, which spreads evenly over surfaces; the tree of boxes follows from the number of vertices alone.
 * Bounds: a search opens each node at most once, and its stack holds SMR_CARRY_STACK entries; each tested vertex is
 * inserted among at most SMR_CARRY_NEAR + 1.
 * SPDX-License-Identifier: MIT */
#include "carry/carry.h"

#define SMR_CARRY_COARSE 600u /* most vertices of the thinnest selection */
#define SMR_CARRY_STACK (SMR_CARRY_STEPS * SMR_TREE_WIDTH)
#define SMR_CARRY_NOWHERE 1.0e20f /* mm^2: larger than any squared distance */
#define SMR_CARRY_NOISE 3.0e-4f   /* noise variance at half of the way to the end of the selection */
#define SMR_CARRY_END 1.0e-6f     /* keeps the noise variance finite */

/* The nearest vertices of one selection, ascending. */
typedef struct nearest {
    smr_vec p;
    uint32_t n, most;
    uint32_t id[SMR_CARRY_NEAR + 1u];
    float d2[SMR_CARRY_NEAR + 1u];
} nearest;

typedef struct entry {
    float d2;
    uint32_t step, node;
} entry;

static uint32_t shape_one(smr_carry_thin *t, uint32_t n, uint32_t first, uint32_t stride, uint32_t take)
{
    uint32_t total = 0, at = 0;
    memset(t, 0, sizeof *t);
    t->first = first;
    t->stride = stride;
    t->n = (n - first + stride - 1u) / stride;
    t->take = take;
    for (uint32_t k = smr_ceil_div(t->n, SMR_TREE_WIDTH); at < SMR_CARRY_STEPS && (at == 0u || k > 1u); at++) {
        k = smr_ceil_div(k, SMR_TREE_WIDTH);
        t->step[at] = total;
        t->count[at] = k;
        total += k;
    }
    t->n_steps = at;
    return total;
}

void smr_carry_shape(smr_carry_thin thin[SMR_CARRY_DENSITIES], uint32_t n, uint32_t *n_densities, uint32_t *n_nodes)
{
    uint32_t ratio = 2u;
    *n_densities = n <= SMR_CARRY_NEAR ? 1u : SMR_CARRY_DENSITIES;
    *n_nodes = shape_one(&thin[0], n, 0, 1, n <= SMR_CARRY_NEAR ? SMR_CARRY_NEAR : SMR_CARRY_FIRST);
    while (n / (ratio * ratio * ratio) > SMR_CARRY_COARSE) /* at most 19 for SMR_VERTICES_MAX */
        ratio++;
    for (uint32_t k = 1, stride = ratio; k < *n_densities; k++, stride *= ratio)
        *n_nodes += shape_one(&thin[k], n, smr_min_u32(stride / 2u, n - 1u), stride, SMR_CARRY_MORE);
}

static const float *vertex(const smr_carry_thin *t, const float *rest, uint32_t i)
{
    return rest + 3u * ((size_t)t->first + (size_t)i * t->stride);
}

/* Widens child k of a node to hold the box lo, hi. */
static void widen(smr_node *node, uint32_t k, const float *lo, const float *hi, size_t step)
{
    for (uint32_t axis = 0; axis < 3u; axis++) {
        node->lo[axis][k] = smr_min(node->lo[axis][k], lo[axis * step]);
        node->hi[axis][k] = smr_max(node->hi[axis][k], hi[axis * step]);
    }
}

void smr_carry_boxes(const smr_carry_thin *t, const float *rest)
{
    for (uint32_t s = 0; s < t->n_steps; s++)
        for (uint32_t i = 0; i < t->count[s]; i++)
            for (uint32_t axis = 0; axis < 3u; axis++)
                for (uint32_t k = 0; k < SMR_TREE_WIDTH; k++) {
                    t->node[t->step[s] + i].lo[axis][k] = SMR_FAR;
                    t->node[t->step[s] + i].hi[axis][k] = s == 0u ? -SMR_FAR : SMR_FAR;
                }
    for (uint32_t i = 0; i < t->n; i++) {
        const uint32_t group = i / SMR_TREE_WIDTH;
        const float *p = vertex(t, rest, i);
        widen(&t->node[group / SMR_TREE_WIDTH], group % SMR_TREE_WIDTH, p, p, 1);
    }
    for (uint32_t i = smr_ceil_div(t->n, SMR_TREE_WIDTH); i < t->count[0] * SMR_TREE_WIDTH; i++)
        for (uint32_t axis = 0; axis < 3u; axis++) /* empty groups have no vertices */
            t->node[i / SMR_TREE_WIDTH].hi[axis][i % SMR_TREE_WIDTH] = SMR_FAR;
    for (uint32_t s = 1; s < t->n_steps; s++)
        for (uint32_t i = 0; i < t->count[s - 1u]; i++) {
            const smr_node *below = &t->node[t->step[s - 1u] + i];
            smr_node *node = &t->node[t->step[s] + i / SMR_TREE_WIDTH];
            for (uint32_t axis = 0; axis < 3u; axis++)
                node->hi[axis][i % SMR_TREE_WIDTH] = -SMR_FAR;
            for (uint32_t k = 0; k < SMR_TREE_WIDTH && below->lo[0][k] < SMR_FAR; k++)
                widen(node, i % SMR_TREE_WIDTH, &below->lo[0][k], &below->hi[0][k], SMR_TREE_WIDTH);
        }
}

static float bound_of(const nearest *f) { return f->n < f->most ? SMR_CARRY_NOWHERE : f->d2[f->n - 1u]; }

/* Inserts a vertex in order of distance; ties in order of the curve. */
static void insert(nearest *f, uint32_t id, float d2)
{
    uint32_t at = f->n < f->most ? f->n++ : f->n - 1u;
    while (at > 0u && (f->d2[at - 1u] > d2 || (!(f->d2[at - 1u] < d2) && f->id[at - 1u] > id))) {
        f->d2[at] = f->d2[at - 1u];
        f->id[at] = f->id[at - 1u];
        at--;
    }
    f->d2[at] = d2;
    f->id[at] = id;
}

static void look_at_group(const smr_carry_thin *t, const float *rest, uint32_t group, nearest *f)
{
    const uint32_t end = smr_min_u32(t->n, (group + 1u) * SMR_TREE_WIDTH);
    for (uint32_t i = group * SMR_TREE_WIDTH; i < end; i++) {
        const smr_vec d = smr_sub(smr_load(vertex(t, rest, i)), f->p);
        const float d2 = smr_dot(d, d);
        const uint32_t id = t->first + i * t->stride;
        if (f->n < f->most || d2 < bound_of(f) || (!(d2 > bound_of(f)) && id < f->id[f->n - 1u]))
            insert(f, id, d2);
    }
}

/* Pushes the children of a node that may hold nearer vertices, the nearest last. Returns the new height of the
 * stack. */
static uint32_t push(const smr_carry_thin *t, entry at, const nearest *f, entry *stack, uint32_t height)
{
    float d2[SMR_TREE_WIDTH];
    const uint32_t near = smr_box_distances(&t->node[t->step[at.step] + at.node], f->p, bound_of(f), d2);
    const uint32_t base = height;
    for (uint32_t k = 0; k < SMR_TREE_WIDTH; k++) {
        if ((near & smr_child_bit[k]) == 0u)
            continue;
        uint32_t i = height++;
        while (i > base && stack[i - 1u].d2 < d2[k]) {
            stack[i] = stack[i - 1u];
            i--;
        }
        stack[i].d2 = d2[k];
        stack[i].step = at.step; /* level of the child plus 1; 0 for a group */
        stack[i].node = at.node * SMR_TREE_WIDTH + k;
    }
    return height;
}

static void search(const smr_carry_thin *t, const float *rest, nearest *f)
{
    entry stack[SMR_CARRY_STACK];
    const entry root = {0.0f, t->n_steps - 1u, 0};
    uint32_t height = push(t, root, f, stack, 0);
    while (height > 0u) { /* each node and group is popped once */
        entry at = stack[--height];
        if (at.d2 > bound_of(f))
            continue;
        if (at.step == 0u) {
            look_at_group(t, rest, at.node, f);
            continue;
        }
        at.step--;
        height = push(t, at, f, stack, height);
    }
}

/* Noise variance of vertex i: 0 for the nearest, unbounded when the next vertex beyond the selection is as near. */
static float noise_variance(const nearest *f, uint32_t i)
{
    if (f->n < f->most)
        return 0.0f;
    const float first = SMR_SQRT(f->d2[0]), range = SMR_SQRT(f->d2[f->n - 1u]) - first;
    if (!(range > 0.0f))
        return 0.0f;
    const float t = (SMR_SQRT(f->d2[i]) - first) / range, left = 1.0f - t, square = t * t;
    return SMR_CARRY_NOISE * square * square / (left * left + SMR_CARRY_END);
}

/* Adds a vertex, or lowers the noise variance of one that another selection has added. */
static void add(const smr_carry *c, smr_carry_site *s, uint32_t id, float noise_variance)
{
    uint32_t k = 0;
    while (k < s->n && s->id[k] != id)
        k++;
    if (k < s->n) {
        s->noise_variance[k] = smr_min(s->noise_variance[k], noise_variance);
        return;
    }
    s->id[k] = id;
    s->noise_variance[k] = noise_variance;
    for (uint32_t axis = 0; axis < 3u; axis++)
        s->x[axis][k] = c->rest[3u * (size_t)id + axis];
    s->n++;
}

void smr_carry_gather(const smr_carry *c, smr_vec p, smr_carry_site *s)
{
    nearest f;
    s->n = 0;
    for (uint32_t k = 0; k < c->n_densities; k++) {
        const smr_carry_thin *t = &c->thin[k];
        f.p = p;
        f.n = 0;
        f.most = t->take + 1u; /* the last vertex marks the end of the selection */
        search(t, c->rest, &f);
        for (uint32_t i = 0; i < smr_min_u32(f.n, t->take); i++)
            add(c, s, f.id[i], noise_variance(&f, i));
    }
}
