/* box_tree_search.c: search in the box tree for the closest acceptable triangle, and for triangles nearly as close.
 * Method: depth first, nearest child first; boxes beyond the best distance so far are skipped. The search starts with
 * the last iteration's triangle, which usually is the closest one. Where all other triangles were so far away in the
 * last search that none can be closer now, the search ends with that triangle: the same bits for a tenth of the work.
 * Bounds: node_budget + SMR_BEYOND nodes opened, 8 box tests and at most 8 triangles each; a stack of 7 entries a level
 * and 8 more.
 * SPDX-License-Identifier: MIT */
#include "geometry/box_tree/box_tree.h"
#include "geometry/box_tree/triangle.h"

smr_vec smr_triangle_point(const smr_box_tree *f, uint32_t triangle, const float weight[3])
{
    return smr_corners_mean(smr_corners_of(f->xyz, smr_triangle_at(f->triangle, triangle, f->n_vertices)), weight);
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

/* Returns the squared distance, mm^2, from q's point to triangle i; writes the weights of the closest point. */
static inline float measure(const smr_box_tree *f, const smr_query *q, uint32_t i, float weight[3])
{
    const uint32_t *t =
        smr_triangle_at(f->triangle, i, f->n_vertices); /* corners by value cost 15 % more instructions */
    return smr_triangle_closest(q->point, smr_get3(f->xyz, t[0]), smr_get3(f->xyz, t[1]), smr_get3(f->xyz, t[2]),
                                weight);
}

/* Returns 1 unless the normal of triangle i disagrees or the mask leaves the triangle out. */
static inline int accepted(const smr_box_tree *f, const smr_tree_mask *mask, const smr_query *q, uint32_t i)
{
    return !(smr_dot(smr_get3(f->normal, i), q->normal) < q->min_cos || (mask != NULL && smr_tree_left_out(mask, i)));
}

/* Updates *hit when a measured triangle is closer, or as close with a smaller rank, and adds the triangle to the list
 * when it is near. */
static void take(const smr_box_tree *f, const smr_hit *found, smr_hit *hit, float widen, smr_near_list *list)
{
    if (list != NULL && found->d2 < hit->d2 * widen)
        add_near(list, found->triangle, found->d2, found->weight);
    if (found->d2 < hit->d2 || (found->d2 == hit->d2 && comes_first(f, found->triangle, hit->triangle)))
        *hit = *found;
}

void smr_tree_try(const smr_box_tree *f, const smr_tree_mask *mask, const smr_query *q, uint32_t i, smr_hit *hit)
{
    smr_hit found = {0.0f, i, {0, 0, 0}};
    if (!accepted(f, mask, q, i))
        return;
    found.d2 = measure(f, q, i, found.weight);
    take(f, &found, hit, 1.0f, NULL);
}

#define SMR_TIES 64u         /* most nodes opened whose boxes are exactly as far away as the closest triangle so far */
#define SMR_BEYOND 24u       /* most nodes opened only for a lower bound of the distance to other triangles */
#define SMR_ROUNDING 2.0e-6f /* rounding of a closest point's weights, times (sides / area)^2 of the triangle */
#define SMR_SURELY 1.00001f  /* factor on a distance, so that rounding does not make a triangle surely the closest */

/* Squared lower bounds, mm^2, of distances to triangles. */
typedef struct bounds {
    float other2;               /* of all triangles tested or of nodes left aside, but the closest one */
    float lane[SMR_TREE_WIDTH]; /* of all nodes that were never pushed, by the number of the child */
    float best2;                /* of the closest triangle, where a leaf showed it; else FLT_MAX */
    float reach2;               /* nodes within this distance are opened for other2 */
} bounds;

/* Returns a lower bound of the squared distance to triangle i, measured as d2. Rounding may put the measured point
 * beside the closest one, in a sliver far beside it. box_d2: squared distance to the triangle's box. */
static float least_of(const smr_box_tree *f, const smr_query *q, uint32_t i, float d2, float box_d2)
{
    const smr_corner_values v = smr_corners_of(f->xyz, smr_triangle_at(f->triangle, i, f->n_vertices));
    const smr_vec ab = smr_sub(v.b, v.a), ac = smr_sub(v.c, v.a), ap = smr_sub(q->point, v.a), n = smr_cross(ab, ac);
    const float sides = smr_dot(ab, ab) + smr_dot(ac, ac);
    const float beside = SMR_ROUNDING * sides * (sides + smr_dot(ap, ap)) / smr_max(smr_dot(n, n), 1.0e-20f);
    const float least = smr_positive(SMR_SQRT(d2) - beside * SMR_SQRT(sides));
    return smr_max(box_d2, least * least);
}

/* Sets how far nodes are opened for other2 beyond the closest triangle found so far. */
static void set_reach(bounds *b, const smr_hit *hit, const smr_certainty *known)
{
    const float reach = SMR_SQRT(hit->d2) + known->slack_mm;
    b->reach2 = hit->triangle != SMR_NONE ? reach * reach : 0.0f;
}

/* Sets the bounds before the first node is opened. */
static void start_bounds(bounds *b, const smr_hit *hit, const smr_certainty *known)
{
    b->other2 = b->best2 = FLT_MAX;
    for (uint32_t k = 0; k < SMR_TREE_WIDTH; k++)
        b->lane[k] = FLT_MAX;
    set_reach(b, hit, known);
}

/* Lowers the bounds by triangle i, measured at d2; before: the closest triangle so far. box_d2: as in least_of(). */
static void note_other(const smr_box_tree *f, const smr_query *q, uint32_t i, float d2, float box_d2, uint32_t before,
                       const smr_hit *hit, const smr_certainty *known, bounds *b)
{
    if (hit->triangle != i) {
        if (box_d2 < b->other2)
            b->other2 = smr_min(b->other2, least_of(f, q, i, d2, box_d2));
        return;
    }
    if (before != i) {
        b->other2 = smr_min(b->other2, b->best2);
        set_reach(b, hit, known);
    }
    b->best2 = least_of(f, q, i, d2, box_d2);
}

/* Tests the triangles in the children `near` of a leaf, whose first triangle is `first`. warm: q->warm, if measured. */
static void search_leaf(const smr_box_tree *f, const smr_tree_mask *mask, const smr_query *q, uint32_t first,
                        uint32_t near, const float box_d2[SMR_TREE_WIDTH], const smr_hit *warm, smr_hit *hit,
                        float widen, smr_near_list *list, bounds *b, const smr_certainty *known)
{
    for (; near != 0u; near &= near - 1u) {
        const uint32_t k = (uint32_t)__builtin_ctz(near), before = hit->triangle;
        const int wanted =
            box_d2[k] <= hit->d2 * widen && first + k < f->n_triangles && accepted(f, mask, q, first + k);
        smr_hit found = {0.0f, first + k, {0, 0, 0}};
        if (!wanted && (known == NULL || found.triangle >= f->n_triangles))
            continue;
        if (found.triangle == warm->triangle)
            found = *warm;
        else
            found.d2 = measure(f, q, found.triangle, found.weight);
        if (wanted)
            take(f, &found, hit, widen, list);
        if (known != NULL)
            note_other(f, q, found.triangle, found.d2, box_d2[k], before, hit, known, b);
    }
}

/* Tries q->warm, and stores its closest point. Returns 1 when no other triangle can be closer, or within `widen` times
 * its squared distance. */
static int warm_is_sure(const smr_box_tree *f, const smr_tree_mask *mask, const smr_query *q, smr_hit *hit, float widen,
                        const smr_certainty *known, smr_hit *warm)
{
    if (q->warm >= f->n_triangles || !accepted(f, mask, q, q->warm))
        return 0;
    warm->triangle = q->warm;
    warm->d2 = measure(f, q, q->warm, warm->weight);
    take(f, warm, hit, widen, NULL);
    return known != NULL && hit->triangle == q->warm && SMR_SQRT(warm->d2 * widen) * SMR_SURELY < known->other_mm;
}

/* Lowers the lanes by the children of a node beyond reach2. */
static inline void note_left(float lane[SMR_TREE_WIDTH], const float d2[SMR_TREE_WIDTH], float reach2)
{
    for (uint32_t k = 0; k < SMR_TREE_WIDTH; k++) {
        const float left = d2[k] > reach2 ? d2[k] : FLT_MAX;
        lane[k] = left < lane[k] ? left : lane[k];
    }
}

/* Returns the lower bound of the distance to all triangles but the closest one, mm. */
static float other_of(const bounds *b)
{
    float other2 = b->other2;
    for (uint32_t k = 0; k < SMR_TREE_WIDTH; k++)
        other2 = smr_min(other2, b->lane[k]);
    return SMR_SQRT(other2);
}

/* Finds the closest triangle for *hit. Boxes and triangles within `widen` (1 or more) times the squared distance of
 * *hit are also tested and enter the list. list NULL: only the closest triangle is wanted. */
static void search(const smr_box_tree *f, const smr_tree_mask *mask, const smr_query *q, smr_hit *hit, float widen,
                   smr_near_list *list, smr_certainty *known)
{
    smr_visit stack[SMR_TREE_LEVELS * SMR_TREE_WIDTH];
    smr_hit warm = {0.0f, SMR_NONE, {0, 0, 0}};
    bounds b;
    uint32_t top = 0, opened = 0, ties = 0, beyond = 0;
    if (f->n_levels == 0u || !(smr_dot(q->point, q->point) < SMR_FAR))
        return; /* the position, of a forged model, is NaN or as far as empty boxes */
    if (warm_is_sure(f, mask, q, hit, widen, known, &warm)) {
        known->sure = 1;
        if (list != NULL)
            add_near(list, q->warm, hit->d2, hit->weight);
        return;
    }
    b.reach2 = 0.0f;
    if (known != NULL && known->slack_mm < 0.0f) {
        known->other_mm = 0.0f;
        known = NULL;
    }
    if (known != NULL)
        start_bounds(&b, hit, known);
    const uint32_t root = f->level[f->n_levels - 1u]; /* the last node: a fault in a box must not lead beyond it */
    stack[top++] = (smr_visit){0.0f, f->n_levels - 1u, 0u};
    while (top > 0u && opened < q->node_budget) {
        const smr_visit v = stack[--top];
        const int farther = v.d2 > hit->d2 * widen; /* no triangle in the node is closer: its boxes only limit other2 */
        if (farther ? v.d2 > b.reach2 || beyond++ >= SMR_BEYOND
                    : v.d2 == hit->d2 && hit->triangle != SMR_NONE && ++ties > SMR_TIES) {
            if (known != NULL)
                b.other2 = smr_min(b.other2, v.d2);
            continue;
        }
        opened += !farther;
        float d2[SMR_TREE_WIDTH];
        const smr_node *node = &f->node[smr_min_u32(f->level[v.level] + v.index, root)];
        const float reach2 = smr_max(hit->d2 * widen, b.reach2);
        const uint32_t near = smr_box_distances(node, q->point, reach2, d2), base = v.index * SMR_TREE_WIDTH;
        if (known != NULL)
            note_left(b.lane, d2, reach2);
        if (v.level == 0u)
            search_leaf(f, mask, q, base, near, d2, &warm, hit, widen, list, &b, known);
        else
            top = smr_push_near(near, d2, (smr_visit){0.0f, v.level - 1u, base}, stack, top);
    }
    if (known != NULL)
        known->other_mm = top == 0u ? other_of(&b) : 0.0f;
    while (list != NULL && top > 0u) /* the node budget is used up: the nearest unopened box ends the list */
        list->cut2 = smr_min(list->cut2, stack[--top].d2);
}

void smr_tree_closest(const smr_box_tree *f, const smr_query *q, smr_hit *hit)
{
    search(f, NULL, q, hit, 1.0f, NULL, NULL);
}

void smr_tree_closest_but(const smr_box_tree *f, const smr_tree_mask *mask, const smr_query *q, smr_hit *hit,
                          smr_certainty *known)
{
    search(f, mask, q, hit, 1.0f, NULL, known);
}

void smr_tree_near(const smr_box_tree *f, const smr_query *q, smr_hit *hit, smr_near_list *list, smr_certainty *known)
{
    list->n = 0;
    list->cut2 = FLT_MAX;
    search(f, NULL, q, hit, (1.0f + SMR_NEARLY) * (1.0f + SMR_NEARLY), list, known);
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
