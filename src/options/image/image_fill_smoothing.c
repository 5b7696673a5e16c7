/* image_fill_smoothing.c: smoothing force where the image shows no goal (paper 2.3, other forces). A vertex without a
 * goal moves towards the mean of its mesh neighbours, so that parts that the image lacks shrink back. Vertices with a
 * goal are not smoothed, nor are structures of which less than half had a goal: these must not collapse. The force
 * falls to 0 with the schedule. The same pass computes each structure's share of vertices with a goal, which sets the
 * search distance, and its contrast and brightness for the next comparisons with profiles.
 * Bounds: one pass over a structure's vertices and triangles.
 * SPDX-License-Identifier: MIT */
#include "options/image/image.h"

#define SMR_GAIN_LEAST 0.25f   /* smallest contrast of the image / contrast of the profiles */
#define SMR_ABOVE_MOST 100.0f  /* largest weight of a profile, which is the profile's range / noise */
#define SMR_MATCHED_WELL 0.8f  /* share of vertices with a goal at or above which the search is not widened */
#define SMR_MATCHED_BADLY 0.5f /* share of vertices with a goal below which the search is widest, without smoothing */

#define SMR_WORK_FILL 40000u /* instructions at most for SMR_TRIANGLE_CHUNK vertices or triangles */

/* Returns a structure's search distance of profiles, mm; 0: p->profile_mm. With few goals the distance is longer,
 * since the structure may be far from its place in the image. */
static float wide_of(const smr_image_goals *g, const smr_image_structure *view)
{
    const smr_schedule *p = g->schedule;
    const smr_vec size = smr_sub(view->box.hi, view->box.lo);
    if (view->n_decided == 0u)
        return 0.0f;
    const float share = (float)view->n_goals / (float)view->n_decided;
    const float lost = smr_clamp((SMR_MATCHED_WELL - share) / (SMR_MATCHED_WELL - SMR_MATCHED_BADLY), 0.0f, 1.0f);
    /* the largest search distance falls with the schedule at the last radius only */
    const float most = smr_at_last_radius(g->shared, p) ? p->farthest_mm : g->shared->config.image.profile_mm;
    const float half = 0.5f * smr_min(size.x, smr_min(size.y, size.z)); /* larger ranges reach other structures */
    const float far = smr_min(smr_min(most, p->lists.radius), half);
    return p->profile_mm + lost * smr_max(far - p->profile_mm, 0.0f);
}

/* Adds the contrast and brightness of v to the structure's sums, weighted by the range of v's profile / noise. */
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

/* For vertices from .. to-1 of a structure: counts goals, sums contrast and brightness, clears sums of neighbours. */
static void look_back(smr_image_goals *g, uint32_t structure, uint32_t from, uint32_t to)
{
    const smr_shape_structure *one = &g->shape->structure[structure];
    smr_image_structure *view = &g->structure[structure];
    if (from == 0u)
        begin_view(view);
    for (uint32_t i = from; i < to; i++) {
        const uint32_t v = smr_model_position(g->shared->model, one->first_vertex + i);
        const smr_vec at = smr_get3(g->shape->x, v);
        view->box = (smr_box){smr_low(view->box.lo, at), smr_high(view->box.hi, at)};
        view->n_goals += g->found[v] == 1u;
        view->n_decided += g->found[v] == 1u || g->found[v] == 2u;
        if (g->found[v] == 1u && g->contrast[v] > 0u)
            add_contrast(g, view, v);
        smr_put3(g->rings.sum, v, smr_v(0, 0, 0));
        g->rings.weight[v] = 0.0f;
    }
    if (to == one->n_vertices)
        end_view(g, view);
}

/* Adds the corners of triangles from .. to-1 to the sums of their neighbours: once for each triangle that two share.
 * Returns the work. */
static uint32_t add_rings(smr_image_goals *g, uint32_t structure, uint32_t from, uint32_t to)
{
    const smr_image_structure *view = &g->structure[structure];
    if (!(g->shared->config.image.fill > 0.0f) || view->n_goals == 0u ||
        (float)view->n_goals < SMR_MATCHED_BADLY * (float)view->n_decided)
        return 0; /* less than half have a goal: sums stay 0, which smooths nothing */
    for (uint32_t k = from; k < to; k++) {
        const uint32_t *t = smr_model_triangle(g->shared, g->shape->structure[structure].first_triangle + k);
        const smr_vec a = smr_get3(g->shape->x, t[0]), b = smr_get3(g->shape->x, t[1]), c = smr_get3(g->shape->x, t[2]);
        const smr_vec all = smr_add(a, smr_add(b, c)), corner[3] = {a, b, c};
        for (uint32_t i = 0; i < 3u; i++) {
            float *sum = smr_at3(g->rings.sum, t[i]);
            smr_store(sum, smr_add(smr_load(sum), smr_sub(all, corner[i])));
            g->rings.weight[t[i]] += 2.0f;
        }
    }
    return SMR_WORK_FILL;
}

/* Looks at a structure's vertices, then adds its triangles, in chunks. */
void smr_fill_structure(void *arg, uint32_t structure, uint32_t worker)
{
    smr_image_goals *g = arg;
    smr_worker *w = &g->shared->worker[worker];
    const smr_shape_structure *one = &g->shape->structure[structure];
    const uint32_t n = one->n_vertices, n_all = n + one->tree.n_triangles;
    smr_worker_needs(w, SMR_WORK_FILL);
    for (uint32_t from = w->at, to; from < n_all; from = to) {
        if (smr_worker_stops(w, from))
            return;
        to = smr_min_u32(from + SMR_TRIANGLE_CHUNK, from < n ? n : n_all);
        if (from < n)
            look_back(g, structure, from, to);
        smr_work(&w->pause, from < n ? SMR_WORK_FILL : add_rings(g, structure, from - n, to - n));
    }
}

smr_vec smr_fill_displacement(const smr_image_goals *g, uint32_t v)
{
    if (!(g->shared->config.image.fill > 0.0f) || !(g->rings.weight[v] > 0.0f))
        return smr_v(0, 0, 0);
    const smr_vec middle = smr_scale(smr_get3(g->rings.sum, v), 1.0f / g->rings.weight[v]);
    return smr_scale(smr_sub(middle, smr_get3(g->shape->x, v)), g->shared->config.image.fill);
}
