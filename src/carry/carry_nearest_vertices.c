/* carry_nearest_vertices.c: the vertices near a point, at four densities. A density is every k-th vertex along a
 * Hilbert curve, which spreads evenly over surfaces; the tree of boxes follows from the number of vertices alone.
 * Bounds: a search opens each node at most once; each tested vertex is inserted among at most SMR_CARRY_NEAR + 1.
 * SPDX-License-Identifier: MIT */
#include "carry/carry.h"

#define SMR_CARRY_COARSE 600u /* largest number of vertices in the thinnest selection, about */
#define SMR_CARRY_STACK (SMR_TREE_LEVELS * SMR_TREE_WIDTH)
#define SMR_CARRY_NOWHERE 1.0e20f /* mm^2: larger than any squared distance between two points */
#define SMR_CARRY_NOISE 3.0e-4f   /* noise variance / (t^4 / (1 - t)^2), where t = distance / range */
#define SMR_CARRY_END 1.0e-6f     /* added to (1 - distance / range)^2, a divisor that is 0 at the range */

/* Sets *t to every stride-th of n vertices, from `first` on. Returns the number of nodes of the selection's tree. */
static uint32_t shape_one(smr_carry_thin *t, uint32_t n, uint32_t first, uint32_t stride, uint32_t take)
{
    *t = (smr_carry_thin){.first = first, .stride = stride, .n = smr_ceil_div(n - first, stride), .take = take};
    smr_tree_shape(&t->groups, smr_ceil_div(t->n, SMR_TREE_WIDTH));
    return smr_tree_nodes(t->groups.n_triangles);
}

void smr_carry_shape(smr_carry_thin thin[SMR_CARRY_DENSITIES], uint32_t n, uint32_t *n_densities, uint32_t *n_nodes)
{
    uint32_t ratio = 2u;
    *n_densities = n <= SMR_CARRY_NEAR ? 1u : SMR_CARRY_DENSITIES;
    *n_nodes = shape_one(&thin[0], n, 0, 1, n <= SMR_CARRY_NEAR ? SMR_CARRY_NEAR : SMR_CARRY_FIRST);
    while (n / (ratio * ratio * ratio) > SMR_CARRY_COARSE) /* ratio: how many times thinner each selection is, <= 19 */
        ratio++;
    for (uint32_t k = 1, stride = ratio; k < *n_densities; k++, stride *= ratio)
        *n_nodes += shape_one(&thin[k], n, smr_min_u32(stride / 2u, n - 1u), stride, SMR_CARRY_MORE);
}

static const float *vertex(const smr_carry_thin *t, const float *rest, uint32_t i)
{
    return rest + 3u * ((size_t)t->first + (size_t)i * t->stride);
}

void smr_carry_boxes(const smr_carry_thin *t, const float *rest, uint32_t first, uint32_t last)
{
    const uint32_t per_leaf = SMR_TREE_WIDTH * SMR_TREE_WIDTH;
    for (uint32_t i = first * SMR_TREE_WIDTH; i < last * SMR_TREE_WIDTH; i++)
        for (uint32_t axis = 0; axis < 3u; axis++) {
            t->groups.node[i / SMR_TREE_WIDTH].lo[axis][i % SMR_TREE_WIDTH] = SMR_FAR;
            t->groups.node[i / SMR_TREE_WIDTH].hi[axis][i % SMR_TREE_WIDTH] =
                i < t->groups.n_triangles ? -SMR_FAR : SMR_FAR; /* lo > hi: empty before vertices are added */
        }
    for (uint32_t i = first * per_leaf; i < smr_min_u32(t->n, last * per_leaf); i++) {
        const uint32_t group = i / SMR_TREE_WIDTH, k = group % SMR_TREE_WIDTH;
        smr_node *node = &t->groups.node[group / SMR_TREE_WIDTH];
        for (uint32_t axis = 0; axis < 3u; axis++) {
            node->lo[axis][k] = smr_min(node->lo[axis][k], vertex(t, rest, i)[axis]);
            node->hi[axis][k] = smr_max(node->hi[axis][k], vertex(t, rest, i)[axis]);
        }
    }
}

static float bound_of(const smr_carry_nearest *f) { return f->n < f->most ? SMR_CARRY_NOWHERE : f->d2[f->n - 1u]; }

void smr_carry_insert(smr_carry_nearest *f, uint32_t id, float d2)
{
    uint32_t at = f->n < f->most ? f->n++ : f->n - 1u;
    for (; at > 0u && (f->d2[at - 1u] > d2 || (!(f->d2[at - 1u] < d2) && f->id[at - 1u] > id)); at--) {
        f->d2[at] = f->d2[at - 1u];
        f->id[at] = f->id[at - 1u];
    }
    f->d2[at] = d2;
    f->id[at] = id;
}

static void look_at_group(const smr_carry_thin *t, const float *rest, uint32_t group, smr_carry_nearest *f)
{
    const uint32_t end = smr_min_u32(t->n, (group + 1u) * SMR_TREE_WIDTH);
    for (uint32_t i = group * SMR_TREE_WIDTH; i < end; i++) {
        const float d2 = smr_distance2(smr_load(vertex(t, rest, i)), f->p);
        const uint32_t id = t->first + i * t->stride;
        if (f->n < f->most || d2 < bound_of(f) || (!(d2 > bound_of(f)) && id < f->id[f->n - 1u]))
            smr_carry_insert(f, id, d2);
    }
}

static void search(const smr_carry_thin *t, const float *rest, smr_carry_nearest *f)
{
    const smr_box_tree *g = &t->groups;
    smr_visit stack[SMR_CARRY_STACK];
    uint32_t height = 0;
    stack[height++] = (smr_visit){0.0f, g->n_levels, 0u}; /* visits: level 0 is a group, k + 1 the tree's level k */
    while (height > 0u) {
        const smr_visit at = stack[--height];
        float d2[SMR_TREE_WIDTH];
        if (at.d2 > bound_of(f))
            continue;
        if (at.level == 0u) {
            look_at_group(t, rest, at.index, f);
            continue;
        }
        const uint32_t near =
            smr_box_distances(&g->node[smr_min_u32(g->level[at.level - 1u] + at.index, g->level[g->n_levels - 1u])],
                              f->p, bound_of(f), d2);
        height = smr_push_near(near, d2, (smr_visit){0.0f, at.level - 1u, at.index * SMR_TREE_WIDTH}, stack, height);
    }
}

/* Returns the noise variance of vertex i: 0 for the nearest vertex, huge as far off as the first vertex left out. */
static float noise_variance(const smr_carry_nearest *f, uint32_t i)
{
    if (f->n < f->most)
        return 0.0f;
    const float first = SMR_SQRT(f->d2[0]), range = SMR_SQRT(f->d2[f->n - 1u]) - first;
    if (!(range > 0.0f))
        return 0.0f;
    const float t = (SMR_SQRT(f->d2[i]) - first) / range, left = 1.0f - t, square = t * t;
    return SMR_CARRY_NOISE * square * square / (left * left + SMR_CARRY_END);
}

/* Adds vertex `id` to the site. If another selection has added the vertex, the smaller noise variance is kept. */
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
    s->n = 0;
    for (uint32_t k = 0; k < c->n_densities; k++) {
        const smr_carry_thin *t = &c->thin[k];
        smr_carry_nearest f = {.p = p, .most = t->take + 1u}; /* the last vertex only marks where the range ends */
        search(t, c->rest, &f);
        for (uint32_t i = 0; i < smr_min_u32(f.n, t->take); i++)
            add(c, s, f.id[i], noise_variance(&f, i));
    }
}
