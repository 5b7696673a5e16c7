/* box_tree_search.c: search in the box tree for the closest acceptable triangle, and for triangles nearly as close.
 * Method: depth first, nearest child first; boxes beyond the best distance so far are skipped. The search starts with
 * the last iteration's triangle, which usually is the closest one.
 * Bounds: node_budget nodes opened, 8 box tests and at most 8 triangles each; a stack of 7 entries a level and 8 more.
 * SPDX-License-Identifier: MIT */
#include "geometry/box_tree/box_tree.h"
#include "geometry/box_tree/triangle.h"

smr_vec smr_triangle_point(const smr_box_tree *f, uint32_t triangle, const float weight[3])
{
    return smr_corners_mean(smr_corners_of(f->xyz, f->triangle + 3u * (size_t)triangle), weight);
}

/* Returns 1 when triangle i wins against an equally close triangle found before, by rank or by smaller number. */
static int comes_first(const smr_box_tree *f, uint32_t i, uint32_t found)
{
    return found == SMR_NONE || f->rank == NULL ? i < found : f->rank[i] < f->rank[found];
}

#define SMR_NEARLY 0.1f      /* triangles farther than (1 + this) times the closest distance are not near */
#define SMR_NORMAL_RAMP 0.2f /* width of the range of cosines above min_cos over which shares rise from 0 to 1 */

/* Adds a near triangle to the list. A full list drops its farthest triangle, and cut2 falls to that distance. */
static void add_near(smr_near_list *list, uint32_t triangle, float d2, const float weight[3])
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

/* Tests triangle i, unless its normal disagrees or the mask leaves it out: updates *hit when the triangle is closer, or
 * as close with a smaller rank, and adds the triangle to the list when it is near. */
static void try_triangle(const smr_box_tree *f, const smr_tree_mask *mask, const smr_query *q, uint32_t i, smr_hit *hit,
                         float widen, smr_near_list *list)
{
    if (smr_dot(smr_get3(f->normal, i), q->normal) < q->min_cos || (mask != NULL && smr_tree_left_out(mask, i)))
        return;
    const uint32_t *t = f->triangle + 3u * (size_t)i; /* corners by value cost 15 % more instructions */
    float weight[3];
    const float d2 =
        smr_triangle_closest(q->point, smr_get3(f->xyz, t[0]), smr_get3(f->xyz, t[1]), smr_get3(f->xyz, t[2]), weight);
    if (list != NULL && d2 < hit->d2 * widen)
        add_near(list, i, d2, weight);
    if (d2 < hit->d2 || (d2 == hit->d2 && comes_first(f, i, hit->triangle))) {
        hit->d2 = d2;
        hit->triangle = i;
        memcpy(hit->weight, weight, sizeof weight);
    }
}

#define SMR_TIES 64u /* most nodes opened whose boxes are exactly as far away as the closest triangle so far */

/* Finds the closest triangle for *hit. Boxes and triangles within `widen` (1 or more) times the squared distance of
 * *hit are also tested and enter the list. list NULL: only the closest triangle is wanted. */
static void search(const smr_box_tree *f, const smr_tree_mask *mask, const smr_query *q, smr_hit *hit, float widen,
                   smr_near_list *list)
{
    smr_visit stack[SMR_TREE_LEVELS * SMR_TREE_WIDTH];
    uint32_t top = 0, opened = 0, ties = 0;
    if (f->n_levels == 0u || !(smr_dot(q->point, q->point) < SMR_FAR))
        return; /* the position, of a forged model, is NaN or as far as empty boxes */
    if (q->warm < f->n_triangles)
        try_triangle(f, mask, q, q->warm, hit, widen, NULL);
    stack[top++] = (smr_visit){0.0f, f->n_levels - 1u, 0u};
    while (top > 0u && opened < q->node_budget) {
        const smr_visit v = stack[--top];
        if (v.d2 > hit->d2 * widen || (v.d2 == hit->d2 && hit->triangle != SMR_NONE && ++ties > SMR_TIES))
            continue;
        opened++;
        float d2[SMR_TREE_WIDTH];
        uint32_t near = smr_box_distances(&f->node[f->level[v.level] + v.index], q->point, hit->d2 * widen, d2);
        uint32_t base = v.index * SMR_TREE_WIDTH;
        if (v.level == 0u) {
            for (; near != 0u; near &= near - 1u) {
                const uint32_t k = (uint32_t)__builtin_ctz(near);
                if (d2[k] <= hit->d2 * widen && base + k < f->n_triangles)
                    try_triangle(f, mask, q, base + k, hit, widen, list);
            }
            continue;
        }
        top = smr_push_near(near, d2, (smr_visit){0.0f, v.level - 1u, base}, stack, top);
    }
    while (list != NULL && top > 0u) /* the node budget is used up: the nearest unopened box ends the list */
        list->cut2 = smr_min(list->cut2, stack[--top].d2);
}

void smr_tree_closest(const smr_box_tree *f, const smr_query *q, smr_hit *hit) { search(f, NULL, q, hit, 1.0f, NULL); }

void smr_tree_closest_but(const smr_box_tree *f, const smr_tree_mask *mask, const smr_query *q, smr_hit *hit)
{
    search(f, mask, q, hit, 1.0f, NULL);
}

void smr_tree_near(const smr_box_tree *f, const smr_query *q, smr_hit *hit, smr_near_list *list)
{
    list->n = 0;
    list->cut2 = FLT_MAX;
    search(f, NULL, q, hit, (1.0f + SMR_NEARLY) * (1.0f + SMR_NEARLY), list);
    if (hit->triangle == SMR_NONE)
        list->n = 0; /* all triangles of the list lie just beyond the search distance */
    const float distance = SMR_SQRT(hit->d2), width = smr_min(SMR_NEARLY * distance, SMR_SQRT(list->cut2) - distance);
    float total = 0.0f;
    for (uint32_t i = 0; i < list->n; i++) {
        smr_near *near = &list->item[i];
        const float beyond = width > 0.0f ? (SMR_SQRT(near->d2) - distance) / width : 1.0f;
        const float above = smr_dot(smr_get3(f->normal, near->triangle), q->normal) - q->min_cos;
        near->share = smr_clamp(1.0f - beyond, 0.0f, 1.0f) * smr_clamp(above / SMR_NORMAL_RAMP, 0.0f, 1.0f);
        total += near->share;
    }
    for (uint32_t i = 0; i < list->n; i++)
        list->item[i].share /= total > 0.0f ? total : 1.0f;
    if (total > 0.0f || hit->triangle == SMR_NONE)
        return;
    list->n = 1; /* no share is above 0 (distance 0, ties, normals barely accepted): the closest triangle gets all */
    list->item[0] = (smr_near){1.0f, hit->d2, hit->triangle, {hit->weight[0], hit->weight[1], hit->weight[2]}};
}
