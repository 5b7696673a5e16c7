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

#define SMR_NEARLY 0.1f      /* (largest distance of a near triangle / closest distance) - 1 */
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
    return smr_triangle_closest_of(&q->point, f->xyz, smr_triangle_at(f->triangle, i, f->n_vertices), weight);
}

/* Returns 1 unless the normal of triangle i disagrees or the mask leaves the triangle out. */
static inline int accepted(const smr_box_tree *f, const smr_tree_mask *mask, const smr_query *q, uint32_t i)
{
    return !(smr_dot(smr_get3(f->normal, i), q->normal) < q->min_cos || (mask != NULL && smr_tree_left_out(mask, i)));
}

/* Updates *hit when a measured triangle is closer, or as close with a smaller rank; lists the triangle when near. */
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

#define SMR_TIES 64u   /* largest number of nodes opened whose boxes are exactly as far away as the closest triangle */
#define SMR_BEYOND 24u /* largest number of nodes opened only to bound the distance to other triangles */
#define SMR_ROUNDING 2.0e-6f   /* rounding of a closest point's weights, times (sides / area)^2 of the triangle */
#define SMR_WORK_VISIT 30u     /* instructions at most to take a node off the stack */
#define SMR_WORK_NODE 1200u    /* instructions at most to open a node and to test the children */
#define SMR_WORK_TRIANGLE 600u /* instructions at most to measure a triangle */
#define SMR_SURELY 1.00001f    /* factor on a distance, so that rounding does not make a triangle surely the closest */

/* Returns a lower bound of the squared distance to triangle i, measured as d2. In a sliver rounding may put the
 * measured point far from the closest point. box_d2: squared distance to the triangle's box. */
static float least_of(const smr_box_tree *f, const smr_query *q, uint32_t i, float d2, float box_d2)
{
    const smr_corner_values v = smr_corners_of(f->xyz, smr_triangle_at(f->triangle, i, f->n_vertices));
    const smr_vec ab = smr_sub(v.b, v.a), ac = smr_sub(v.c, v.a), ap = smr_sub(q->point, v.a), n = smr_cross(ab, ac);
    const float sides = smr_dot(ab, ab) + smr_dot(ac, ac);
    const float beside = SMR_ROUNDING * sides * (sides + smr_dot(ap, ap)) / smr_max(smr_dot(n, n), 1.0e-20f);
    const float least = smr_positive(SMR_SQRT(d2) - beside * SMR_SQRT(sides));
    return smr_max(box_d2, least * least);
}

/* Sets reach2, within which nodes are opened to bound other triangles, from the closest triangle so far. */
static void set_reach(smr_bounds *b, const smr_hit *hit, const smr_certainty *known)
{
    const float reach = SMR_SQRT(hit->d2) + known->slack_mm;
    b->reach2 = hit->triangle != SMR_NONE ? reach * reach : 0.0f;
}

/* Sets the bounds before the first node is opened. */
static void start_bounds(smr_bounds *b, const smr_hit *hit, const smr_certainty *known)
{
    b->other2 = b->best2 = FLT_MAX;
    for (uint32_t k = 0; k < SMR_TREE_WIDTH; k++)
        b->lane[k] = FLT_MAX;
    set_reach(b, hit, known);
}

/* Lowers the bounds by triangle i, measured at d2; before: the closest triangle so far. box_d2: as in least_of(). */
static void note_other(const smr_box_tree *f, const smr_query *q, uint32_t i, float d2, float box_d2, uint32_t before,
                       const smr_hit *hit, const smr_certainty *known, smr_bounds *b)
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

/* Tests the triangles in the children `near` of a leaf, whose first triangle is `first`. warm: q->warm, if measured.
 * Returns the number of triangles in `near` that were tested. */
static uint32_t search_leaf(const smr_box_tree *f, const smr_tree_mask *mask, const smr_query *q, uint32_t first,
                            uint32_t near, const float box_d2[SMR_TREE_WIDTH], const smr_hit *warm, smr_hit *hit,
                            float widen, smr_near_list *list, smr_bounds *b, const smr_certainty *known)
{
    uint32_t n = 0;
    for (; near != 0u; near &= near - 1u) {
        const uint32_t k = (uint32_t)__builtin_ctz(near), i = first + k, before = hit->triangle;
        const smr_hit *found = warm;
        smr_hit own;
        if (i >= f->n_triangles)
            break;
        const int wanted = box_d2[k] <= hit->d2 * widen && accepted(f, mask, q, i);
        if (!wanted && known == NULL)
            continue;
        n++;
        if (i != warm->triangle) {
            own.triangle = i;
            own.d2 = measure(f, q, i, own.weight);
            found = &own;
        }
        if (wanted)
            take(f, found, hit, widen, list);
        if (known != NULL)
            note_other(f, q, i, found->d2, box_d2[k], before, hit, known, b);
    }
    return n;
}

/* Tries q->warm. Returns 1 when no other triangle can lie within `widen` times the squared distance of *warm. */
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
static float other_of(const smr_bounds *b)
{
    float other2 = b->other2;
    for (uint32_t k = 0; k < SMR_TREE_WIDTH; k++)
        other2 = smr_min(other2, b->lane[k]);
    return SMR_SQRT(other2);
}

/* Returns 1 when no search is needed: the query's warm triangle is the closest one, or a forged model's point is NaN or
 * as far as empty boxes. */
static int ends_at_once(const smr_box_tree *f, const smr_tree_mask *mask, const smr_query *q, smr_hit *hit, float widen,
                        smr_near_list *list, smr_certainty *known, smr_hit *warm)
{
    if (f->n_levels == 0u || !(smr_dot(q->point, q->point) < SMR_FAR))
        return 1;
    if ((known != NULL && known->pause != NULL && known->pause->in_search) ||
        !warm_is_sure(f, mask, q, hit, widen, known, warm))
        return 0;
    known->sure = 1;
    if (list != NULL)
        add_near(list, q->warm, hit->d2, hit->weight);
    return 1;
}

/* Returns the work after which a search stops, instructions at most. */
static uint32_t most_of(const smr_pause *pause)
{
    if (pause == NULL || pause->left == SMR_ENDLESS)
        return SMR_ENDLESS;
    return pause->left > pause->after ? pause->left - pause->after : 0u;
}

/* Counts the work of a search. Returns 1, and copies the search to *pause, when it stops. list NULL: no list. */
static int stops(smr_pause *pause, uint32_t work, uint32_t most, const smr_walk *w, const smr_visit *stack,
                 const smr_hit *hit, const smr_near_list *list)
{
    smr_work(pause, work);
    if (work < most)
        return 0;
    pause->in_search = pause->kept = 1;
    pause->walk = *w;
    pause->hit = *hit;
    memcpy(pause->stack, stack, w->top * sizeof *stack);
    if (list != NULL)
        memcpy(&pause->list, list, offsetof(smr_near_list, item) + list->n * sizeof *list->item);
    return 1;
}

/* Copies a stopped search back from *pause. Returns 0 when no search has stopped. */
static int resume(smr_pause *pause, smr_walk *w, smr_visit *stack, smr_hit *hit, smr_near_list *list)
{
    if (pause == NULL || !pause->in_search)
        return 0;
    pause->in_search = pause->kept = 0;
    *w = pause->walk;
    *hit = pause->hit;
    memcpy(stack, pause->stack, w->top * sizeof *stack);
    if (list != NULL)
        memcpy(list, &pause->list, offsetof(smr_near_list, item) + pause->list.n * sizeof *list->item);
    return 1;
}

/* Finds the closest triangle for *hit, and lists the triangles within `widen` >= 1 times the squared distance of *hit.
 * list NULL: only the closest triangle is wanted. Returns 0 when known->pause ended the work. */
static int search(const smr_box_tree *f, const smr_tree_mask *mask, const smr_query *q, smr_hit *hit, float widen,
                  smr_near_list *list, smr_certainty *known)
{
    smr_visit stack[SMR_TREE_LEVELS * SMR_TREE_WIDTH];
    smr_walk w = {.top = 1, .warm.triangle = SMR_NONE};
    smr_pause *const pause = known != NULL ? known->pause : NULL;
    const uint32_t most = most_of(pause);
    uint32_t work = 0;
    if (ends_at_once(f, mask, q, hit, widen, list, known, &w.warm))
        return 1;
    if (known != NULL && known->slack_mm < 0.0f) {
        known->other_mm = 0.0f;
        known = NULL;
    }
    const uint32_t root = f->level[f->n_levels - 1u]; /* the last node: a fault in a box must not lead beyond it */
    stack[0] = (smr_visit){0.0f, f->n_levels - 1u, 0u};
    if (!resume(pause, &w, stack, hit, list) && known != NULL)
        start_bounds(&w.b, hit, known);
    while (w.top > 0u && w.opened < q->node_budget && work < most) {
        const smr_visit v = stack[--w.top];
        const int farther = v.d2 > hit->d2 * widen; /* no triangle in the node is closer: its boxes only limit other2 */
        work += SMR_WORK_VISIT;
        if (farther ? v.d2 > w.b.reach2 || w.beyond++ >= SMR_BEYOND
                    : v.d2 == hit->d2 && hit->triangle != SMR_NONE && ++w.ties > SMR_TIES) {
            if (known != NULL)
                w.b.other2 = smr_min(w.b.other2, v.d2);
            continue;
        }
        w.opened += !farther;
        work += SMR_WORK_NODE;
        float d2[SMR_TREE_WIDTH];
        const smr_node *node = &f->node[smr_min_u32(f->level[v.level] + v.index, root)];
        const float reach2 = smr_max(hit->d2 * widen, w.b.reach2);
        const uint32_t near = smr_box_distances(node, q->point, reach2, d2), base = v.index * SMR_TREE_WIDTH;
        if (known != NULL)
            note_left(w.b.lane, d2, reach2);
        if (v.level == 0u)
            work += SMR_WORK_TRIANGLE * search_leaf(f, mask, q, base, near, d2, &w.warm, hit, widen, list, &w.b, known);
        else
            w.top = smr_push_near(near, d2, (smr_visit){0.0f, v.level - 1u, base}, stack, w.top);
    }
    if (most != SMR_ENDLESS && stops(pause, work, most, &w, stack, hit, list))
        return 0;
    if (known != NULL)
        known->other_mm = w.top == 0u ? other_of(&w.b) : 0.0f;
    while (list != NULL && w.top > 0u) /* the node budget is used up: the nearest unopened box ends the list */
        list->cut2 = smr_min(list->cut2, stack[--w.top].d2);
    return 1;
}

int smr_tree_closest_but(const smr_box_tree *f, const smr_tree_mask *mask, const smr_query *q, smr_hit *hit,
                         smr_certainty *known)
{
    return search(f, mask, q, hit, 1.0f, NULL, known);
}

int smr_tree_near(const smr_box_tree *f, const smr_query *q, smr_hit *hit, smr_near_list *list, smr_certainty *known)
{
    list->n = 0;
    list->cut2 = FLT_MAX;
    if (!search(f, NULL, q, hit, (1.0f + SMR_NEARLY) * (1.0f + SMR_NEARLY), list, known))
        return 0;
    if (hit->triangle == SMR_NONE)
        list->n = 0; /* all triangles of the list lie just beyond the search distance */
    if (list->n == 1u && list->item[0].triangle == hit->triangle) {
        list->item[0].share = 1.0f;
        return 1;
    }
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
        return 1;
    list->n = 1; /* no share is above 0 (distance 0, ties, normals barely accepted): the closest triangle gets all */
    list->item[0] = (smr_near){1.0f, hit->d2, hit->triangle, {hit->weight[0], hit->weight[1], hit->weight[2]}};
    return 1;
}
