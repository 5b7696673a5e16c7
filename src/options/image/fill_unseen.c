/* fill_unseen.c: what fills in where the image shows no goal: a smoothing force (paper 2.3, other forces). A vertex
 * without a goal is drawn towards the middle of its mesh neighbours. What the image does not have, such as the longer
 * tendon of another person's muscle, so shrinks back instead of staying where the start put it. Where the image shows
 * the surface nothing is smoothed, nor in a structure of which less than half had a goal: what is lost or missing as
 * a whole must not collapse. The force falls to 0 where the schedule ends, as all others do. The same pass takes each
 * structure's share of vertices with a goal, which says how far goals are sought, and its contrast and brightness in
 * the image, which its next goals are compared with.
 * Bounds: one pass over a structure's vertices and triangles.
 * SPDX-License-Identifier: MIT */
#include "options/image/image.h"

#define SMR_GAIN_LEAST 0.25f  /* contrast of the image over the profiles' */
#define SMR_ABOVE_MOST 100.0f /* a profile's range over noise: more does not count more */
#define SMR_SEEN_WELL 0.8f    /* of a structure's vertices had a goal: it is where it belongs */
#define SMR_SEEN_BADLY 0.5f   /* had a goal: it is lost */

/* Without a budget a structure is one task. Otherwise it is cut into pieces, first of its vertices, then of its
 * triangles; all structures' pieces are done before the next ones start: task = piece * n_structures + structure. */
uint32_t smr_fill_tasks(const void *arg)
{
    const smr_image_goals *g = arg;
    return g->has_image ? g->shared->n_structures * smr_max_u32(g->ring_pieces, 1u) : 0u;
}

uint32_t smr_fill_abreast(const void *arg) { return ((const smr_image_goals *)arg)->shared->n_structures; }

static uint32_t vertex_pieces(const smr_shape_structure *one)
{
    return smr_ceil_div(one->n_vertices, SMR_TRIANGLE_CHUNK);
}

void smr_fill_pieces(void *arg, int cut)
{
    smr_image_goals *g = arg;
    g->ring_pieces = 1;
    for (uint32_t i = 0; cut && i < g->shared->n_structures; i++) {
        const smr_shape_structure *one = &g->shape->structure[i];
        const uint32_t triangle_pieces = smr_ceil_div(one->facets.n_triangles, SMR_TRIANGLE_CHUNK);
        g->ring_pieces = smr_max_u32(g->ring_pieces, vertex_pieces(one) + triangle_pieces);
    }
}

/* How far profiles of a structure are sought that is badly seen: what is near it there does not belong to it. Half a
 * radius, which keeps a structure from its neighbours' far sides, would keep this one from its own place. */
static float wide_of(const smr_image_goals *g, const smr_image_structure *view)
{
    const smr_pace *p = g->pace;
    const smr_vec size = smr_sub(view->box.hi, view->box.lo);
    if (view->n_decided == 0u)
        return 0.0f;
    const float share = (float)view->n_goals / (float)view->n_decided;
    const float lost = smr_clamp((SMR_SEEN_WELL - share) / (SMR_SEEN_WELL - SMR_SEEN_BADLY), 0.0f, 1.0f);
    /* as far as at the start: only the last radius, which comes to rest, narrows with the schedule */
    const float most = smr_at_last_radius(g->shared, p) ? p->farthest_mm : g->shared->config.image.profile_mm;
    const float half = 0.5f * smr_min(size.x, smr_min(size.y, size.z)); /* beyond lies what is not its own */
    const float far = smr_min(smr_min(most, p->lists.radius), half);
    return p->profile_mm + lost * smr_max(far - p->profile_mm, 0.0f);
}

/* The more a profile stands above noise, the more it tells of the image's contrast and brightness. */
static void add_contrast(const smr_image_goals *g, smr_image_structure *view, uint32_t v)
{
    const uint32_t *ranges = smr_at(g->shared->model, g->shared->model->at_ranges);
    const float above = smr_le_float(ranges[2u * (size_t)v + 1u]) / view->noise;
    const float weight = above < SMR_ABOVE_MOST ? above : SMR_ABOVE_MOST;
    view->gain_sum += weight * ((float)g->contrast[v] * (1.0f / (float)SMR_CONTRAST_ONE));
    view->brighter_sum += weight * (float)((int)g->brighter[v] - SMR_BRIGHTER_NONE) * view->noise;
    view->gain_weight += weight;
}

static void begin_view(smr_image_structure *view)
{
    view->n_goals = view->n_decided = 0;
    view->gain_sum = view->gain_weight = view->brighter_sum = 0.0f;
    view->box = (smr_box){{SMR_FAR, SMR_FAR, SMR_FAR}, {-SMR_FAR, -SMR_FAR, -SMR_FAR}};
}

static void end_view(const smr_image_goals *g, smr_image_structure *view)
{
    const int known = view->gain_weight > 0.0f;
    view->wide_mm = wide_of(g, view);
    view->gain = known ? smr_max(view->gain_sum / view->gain_weight, SMR_GAIN_LEAST) : 1.0f;
    view->brighter = known ? view->brighter_sum / view->gain_weight : 0.0f;
}

/* Counts who had a goal and how the image compares there, and clears the sums. */
static void look_back(smr_image_goals *g, uint32_t structure, uint32_t from, uint32_t to)
{
    const smr_shape_structure *one = &g->shape->structure[structure];
    smr_image_structure *view = &g->structure[structure];
    if (from == 0u)
        begin_view(view);
    for (uint32_t i = from; i < to; i++) {
        const uint32_t v = smr_model_position(g->shared->model, one->first_vertex + i);
        const smr_vec at = smr_load(smr_at3(g->shape->x, v));
        smr_box *b = &view->box;
        b->lo = smr_v(smr_min(b->lo.x, at.x), smr_min(b->lo.y, at.y), smr_min(b->lo.z, at.z));
        b->hi = smr_v(smr_max(b->hi.x, at.x), smr_max(b->hi.y, at.y), smr_max(b->hi.z, at.z));
        view->n_goals += g->found[v] == 1u;
        view->n_decided += g->found[v] == 1u || g->found[v] == 2u;
        if (g->found[v] == 1u && g->contrast[v] > 0u)
            add_contrast(g, view, v);
        smr_store(smr_at3(g->rings.sum, v), smr_v(0, 0, 0));
        g->rings.weight[v] = 0.0f;
    }
    if (to == one->n_vertices)
        end_view(g, view);
}

/* Sums over the mesh neighbours; a neighbour counts once for each triangle between. */
static void add_rings(smr_image_goals *g, uint32_t structure, uint32_t from, uint32_t to)
{
    const smr_image_structure *view = &g->structure[structure];
    if (!(g->shared->config.image.fill > 0.0f) || view->n_goals == 0u ||
        (float)view->n_goals < SMR_SEEN_BADLY * (float)view->n_decided)
        return; /* no ring has a weight: nothing is smoothed */
    for (uint32_t k = from; k < to; k++) {
        const uint32_t *t = g->shape->structure[structure].facets.triangle + 3u * (size_t)k;
        const smr_vec a = smr_load(smr_at3(g->shape->x, t[0])), b = smr_load(smr_at3(g->shape->x, t[1])),
                      c = smr_load(smr_at3(g->shape->x, t[2]));
        const smr_vec all = smr_add(a, smr_add(b, c)), corner[3] = {a, b, c};
        for (uint32_t i = 0; i < 3u; i++) {
            float *sum = smr_at3(g->rings.sum, t[i]);
            smr_store(sum, smr_add(smr_load(sum), smr_sub(all, corner[i])));
            g->rings.weight[t[i]] += 2.0f;
        }
    }
}

void smr_fill_sum(void *arg, uint32_t task, uint32_t worker)
{
    smr_image_goals *g = arg;
    const uint32_t structure = task % g->shared->n_structures, piece = task / g->shared->n_structures;
    const smr_shape_structure *one = &g->shape->structure[structure];
    const uint32_t first = vertex_pieces(one), size = SMR_TRIANGLE_CHUNK, n_triangles = one->facets.n_triangles;
    (void)worker;
    if (g->ring_pieces <= 1u) {
        look_back(g, structure, 0, one->n_vertices);
        add_rings(g, structure, 0, n_triangles);
    } else if (piece < first) {
        look_back(g, structure, piece * size, smr_min_u32((piece + 1u) * size, one->n_vertices));
    } else {
        add_rings(g, structure, (piece - first) * size, smr_min_u32((piece - first + 1u) * size, n_triangles));
    }
}

smr_vec smr_fill_way(const smr_image_goals *g, uint32_t v)
{
    if (!(g->shared->config.image.fill > 0.0f) || !(g->rings.weight[v] > 0.0f))
        return smr_v(0, 0, 0);
    const smr_vec middle = smr_scale(smr_load(smr_at3(g->rings.sum, v)), 1.0f / g->rings.weight[v]);
    return smr_scale(smr_sub(middle, smr_load(smr_at3(g->shape->x, v))), g->shared->config.image.fill);
}
