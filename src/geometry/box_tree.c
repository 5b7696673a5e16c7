/* box_tree.c: refitting and searching the box tree: the closest triangle, and those nearly as close.
 * Search: nearest child first, depth first, pruned by the best distance so far; the warm start usually makes the
 * first guess the answer. Worst case: node_budget nodes opened, 8 box tests and at most 8 triangles each; the
 * stack never holds more than 7 entries a level and 8 at the bottom.
 * SPDX-License-Identifier: MIT */
#include "geometry/box_tree.h"

#include <float.h>

#include "geometry/triangle.h"

uint32_t smr_tree_nodes(uint32_t n_triangles)
{
    uint32_t total = 0;
    for (uint32_t n = n_triangles; n > 0u;) {
        n = smr_ceil_div(n, SMR_TREE_WIDTH);
        total += n;
        if (n == 1u)
            break;
    }
    return total;
}

void smr_tree_shape(smr_facets *f, uint32_t n_triangles)
{
    f->n_triangles = n_triangles;
    f->n_levels = 0;
    uint32_t first = 0;
    for (uint32_t n = n_triangles; n > 0u;) {
        n = smr_ceil_div(n, SMR_TREE_WIDTH);
        f->level[f->n_levels++] = first;
        first += n;
        if (n == 1u)
            break;
    }
}

static void clear_node(smr_node *node)
{
    for (uint32_t axis = 0; axis < 3u; axis++)
        for (uint32_t k = 0; k < SMR_TREE_WIDTH; k++)
            node->lo[axis][k] = node->hi[axis][k] = SMR_FAR;
}

static void set_child(smr_node *node, uint32_t k, smr_vec lo, smr_vec hi)
{
    node->lo[0][k] = lo.x;
    node->lo[1][k] = lo.y;
    node->lo[2][k] = lo.z;
    node->hi[0][k] = hi.x;
    node->hi[1][k] = hi.y;
    node->hi[2][k] = hi.z;
}

void smr_tree_refit_leaves(const smr_facets *f, uint32_t first, uint32_t last)
{
    for (uint32_t leaf = first; leaf < last; leaf++) {
        smr_node *node = f->node == NULL ? NULL : &f->node[leaf];
        uint32_t base = leaf * SMR_TREE_WIDTH;
        uint32_t n = smr_min_u32(f->n_triangles - base, SMR_TREE_WIDTH);
        if (node != NULL && n < SMR_TREE_WIDTH)
            clear_node(node);
        for (uint32_t k = 0; k < n; k++) {
            const uint32_t *t = f->triangle + 3u * (size_t)(base + k);
            smr_vec a = smr_load(f->xyz + 3u * (size_t)t[0]);
            smr_vec b = smr_load(f->xyz + 3u * (size_t)t[1]);
            smr_vec c = smr_load(f->xyz + 3u * (size_t)t[2]);
            smr_store(f->normal + 3u * (size_t)(base + k), smr_unit(smr_triangle_cross(a, b, c)));
            if (node == NULL)
                continue;
            set_child(node, k,
                      smr_v(smr_min(a.x, smr_min(b.x, c.x)), smr_min(a.y, smr_min(b.y, c.y)),
                            smr_min(a.z, smr_min(b.z, c.z))),
                      smr_v(smr_max(a.x, smr_max(b.x, c.x)), smr_max(a.y, smr_max(b.y, c.y)),
                            smr_max(a.z, smr_max(b.z, c.z))));
        }
    }
}

void smr_tree_refit_upper(const smr_facets *f)
{
    uint32_t n = smr_tree_leaves(f);
    for (uint32_t l = 1; l < f->n_levels; l++) {
        uint32_t above = smr_ceil_div(n, SMR_TREE_WIDTH);
        for (uint32_t i = 0; i < above; i++) {
            smr_node *node = &f->node[f->level[l] + i];
            clear_node(node);
            for (uint32_t k = 0; k < SMR_TREE_WIDTH && i * SMR_TREE_WIDTH + k < n; k++) {
                uint32_t child_index = i * SMR_TREE_WIDTH + k;
                const smr_node *child = &f->node[f->level[l - 1u] + child_index];
                for (uint32_t axis = 0; axis < 3u; axis++) {
                    float lo = child->lo[axis][0], hi = child->hi[axis][0];
                    for (uint32_t c = 1; c < SMR_TREE_WIDTH; c++) {
                        if (child->lo[axis][c] >= SMR_FAR)
                            break;
                        lo = smr_min(lo, child->lo[axis][c]);
                        hi = smr_max(hi, child->hi[axis][c]);
                    }
                    node->lo[axis][k] = lo;
                    node->hi[axis][k] = hi;
                }
            }
        }
        n = above;
    }
}

smr_vec smr_facet_point(const smr_facets *f, uint32_t triangle, const float weight[3])
{
    const uint32_t *t = f->triangle + 3u * (size_t)triangle;
    smr_vec a = smr_load(f->xyz + 3u * (size_t)t[0]);
    smr_vec b = smr_load(f->xyz + 3u * (size_t)t[1]);
    smr_vec c = smr_load(f->xyz + 3u * (size_t)t[2]);
    return smr_add(smr_add(smr_scale(a, weight[0]), smr_scale(b, weight[1])), smr_scale(c, weight[2]));
}

/* Among equally near triangles, i comes before the one found so far. */
static int comes_first(const smr_facets *f, uint32_t i, uint32_t found)
{
    if (found == SMR_NONE || f->rank == NULL)
        return i < found;
    return f->rank[i] < f->rank[found];
}

#define SMR_NEARLY 0.1f      /* of the distance: what is so much farther is not near */
#define SMR_NORMAL_RAMP 0.2f /* cosine above the least that is accepted: shares fall to 0 over it, too */

/* Notes a triangle for smr_tree_near; where there is no room the farthest goes, and what is as far from then on is not near. */
static void note(smr_near_list *list, uint32_t triangle, float d2, const float weight[3])
{
    uint32_t at = list->n;
    if (at == SMR_NEAR_MOST) {
        at = 0;
        for (uint32_t i = 1; i < list->n; i++)
            if (list->item[i].d2 > list->item[at].d2)
                at = i;
        list->cut2 = smr_min(list->cut2, smr_max(list->item[at].d2, d2));
        if (list->item[at].d2 <= d2)
            return;
    } else
        list->n++;
    list->item[at] = (smr_near){0.0f, d2, triangle, {weight[0], weight[1], weight[2]}};
}

/* Tries one triangle; ties go to the smaller rank. */
static void try_triangle(const smr_facets *f, const smr_query *q, uint32_t i, smr_hit *hit, float widen,
                         smr_near_list *list)
{
    smr_vec n = smr_load(f->normal + 3u * (size_t)i);
    if (smr_dot(n, q->normal) < q->min_cos)
        return;
    const uint32_t *t = f->triangle + 3u * (size_t)i;
    float weight[3];
    float d2 = smr_triangle_closest(q->point, smr_load(f->xyz + 3u * (size_t)t[0]),
                                    smr_load(f->xyz + 3u * (size_t)t[1]), smr_load(f->xyz + 3u * (size_t)t[2]), weight);
    if (list != NULL && d2 < hit->d2 * widen)
        note(list, i, d2, weight);
    if (d2 < hit->d2 || (d2 == hit->d2 && comes_first(f, i, hit->triangle))) {
        hit->d2 = d2;
        hit->triangle = i;
        memcpy(hit->weight, weight, sizeof weight);
    }
}

/* Squared distances from p to the eight child boxes. Returns those within `bound`, a bit each: what is far off is sorted out
 * without a branch. */
static uint32_t box_distances(const smr_node *node, smr_vec p, float bound, float d2[SMR_TREE_WIDTH])
{
    static const uint32_t bit[SMR_TREE_WIDTH] = {1, 2, 4, 8, 16, 32, 64, 128};
    uint32_t near = 0;
    /* below or above: at most one of the two is positive */
    for (uint32_t k = 0; k < SMR_TREE_WIDTH; k++) {
        const float x = smr_positive(node->lo[0][k] - p.x) + smr_positive(p.x - node->hi[0][k]);
        const float y = smr_positive(node->lo[1][k] - p.y) + smr_positive(p.y - node->hi[1][k]);
        const float z = smr_positive(node->lo[2][k] - p.z) + smr_positive(p.z - node->hi[2][k]);
        const float sum = x * x + y * y + z * z;
        d2[k] = sum;
        near |= sum <= bound ? bit[k] : 0u;
    }
    return near;
}

#define SMR_TIES 64u /* nodes opened for triangles that can only be as near as the best one */

typedef struct visit {
    float d2;
    uint32_t level, index;
} visit;

/* widen: boxes are opened up to this share of the squared distance found; all triangles within go into the list. */
static void search(const smr_facets *f, const smr_query *q, smr_hit *hit, float widen, smr_near_list *list)
{
    visit stack[SMR_TREE_LEVELS * SMR_TREE_WIDTH];
    uint32_t top = 0, opened = 0, ties = 0;
    if (f->n_levels == 0u || !(smr_dot(q->point, q->point) < SMR_FAR))
        return; /* no number, or so far off that empty boxes are near: a forged model's positions */
    if (q->warm < f->n_triangles)
        try_triangle(f, q, q->warm, hit, widen, NULL);
    stack[top++] = (visit){0.0f, f->n_levels - 1u, 0u};
    while (top > 0u && opened < q->node_budget) {
        const visit v = stack[--top];
        if (v.d2 > hit->d2 * widen || (v.d2 == hit->d2 && hit->triangle != SMR_NONE && ++ties > SMR_TIES))
            continue;
        opened++;
        float d2[SMR_TREE_WIDTH];
        uint32_t near = box_distances(&f->node[f->level[v.level] + v.index], q->point, hit->d2 * widen, d2);
        uint32_t base = v.index * SMR_TREE_WIDTH;
        if (v.level == 0u) {
            for (; near != 0u; near &= near - 1u) {
                const uint32_t k = (uint32_t)__builtin_ctz(near);
                if (d2[k] <= hit->d2 * widen && base + k < f->n_triangles)
                    try_triangle(f, q, base + k, hit, widen, list);
            }
            continue;
        }
        /* push the near children, nearest on top */
        const uint32_t bottom = top;
        for (; near != 0u; near &= near - 1u) {
            const uint32_t k = (uint32_t)__builtin_ctz(near);
            if (d2[k] >= SMR_FAR)
                continue;
            uint32_t at = top++;
            for (; at > bottom && stack[at - 1u].d2 < d2[k]; at--)
                stack[at] = stack[at - 1u];
            stack[at] = (visit){d2[k], v.level - 1u, base + k};
        }
    }
    while (list != NULL && top > 0u) /* the budget is used up: what lies in boxes that stayed closed is not near */
        list->cut2 = smr_min(list->cut2, stack[--top].d2);
}

void smr_tree_closest(const smr_facets *f, const smr_query *q, smr_hit *hit) { search(f, q, hit, 1.0f, NULL); }

void smr_tree_near(const smr_facets *f, const smr_query *q, smr_hit *hit, smr_near_list *list)
{
    list->n = 0;
    list->cut2 = FLT_MAX;
    search(f, q, hit, (1.0f + SMR_NEARLY) * (1.0f + SMR_NEARLY), list);
    if (hit->triangle == SMR_NONE)
        list->n = 0; /* what lies within reach of the search, but not in it */
    const float distance = SMR_SQRT(hit->d2), width = smr_min(SMR_NEARLY * distance, SMR_SQRT(list->cut2) - distance);
    float total = 0.0f;
    for (uint32_t i = 0; i < list->n; i++) {
        smr_near *near = &list->item[i];
        const float beyond = width > 0.0f ? (SMR_SQRT(near->d2) - distance) / width : 1.0f;
        const float above = smr_dot(smr_load(f->normal + 3u * (size_t)near->triangle), q->normal) - q->min_cos;
        near->share = smr_clamp(1.0f - beyond, 0.0f, 1.0f) * smr_clamp(above / SMR_NORMAL_RAMP, 0.0f, 1.0f);
        total += near->share;
    }
    for (uint32_t i = 0; i < list->n; i++)
        list->item[i].share /= total > 0.0f ? total : 1.0f;
    if (total > 0.0f || hit->triangle == SMR_NONE)
        return;
    list->n = 1; /* it lies on the surface, or others are as near, or nothing looks its way enough */
    list->item[0] = (smr_near){1.0f, hit->d2, hit->triangle, {hit->weight[0], hit->weight[1], hit->weight[2]}};
}
