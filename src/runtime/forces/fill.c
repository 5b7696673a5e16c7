/* fill.c: the smoothing force (paper 2.3: other forces): where the image shows no goal, a vertex is drawn towards the middle
 * of its mesh neighbours. What the image does not have, such as the longer tendon of another person's muscle, so shrinks
 * back instead of staying where the start put it; where the image does show the surface, nothing is smoothed, nor in a
 * structure of which less than half had a goal: what is lost or missing as a whole must not collapse. The force
 * falls to 0 where the schedule ends, as all others do (schedule.c). The same counts say how far goals are sought; the
 * same pass takes each structure's contrast and brightness in the image, which its next goals are compared with.
 * Bounds: one pass over a structure's triangles.
 * SPDX-License-Identifier: MIT */
#include "runtime/state.h"

#define SMR_GAIN_LEAST 0.25f  /* contrast of the image against the profiles' */
#define SMR_ABOVE_MOST 100.0f /* a profile's range against noise: more does not count more */
#define SMR_SEEN_WELL 0.8f  /* share of a structure's vertices that had a goal: so many, and it is where it belongs; */
#define SMR_SEEN_BADLY 0.5f /* so few, and it is lost */

/* Without a budget a structure is one task. Otherwise it is cut into pieces, first of its vertices, then of its triangles; all
 * structures' pieces are done before the next ones start: task = piece * n_parts + structure. */
uint32_t smr_smooth_tasks(smr *s) { return s->has_grid ? s->n_parts * smr_max_u32(s->ring_pieces, 1u) : 0u; }

uint32_t smr_smooth_abreast(const smr *s) { return s->n_parts; }

static uint32_t vertex_pieces(const smr_part *part) { return smr_ceil_div(part->n_vertices, SMR_TRIANGLE_CHUNK); }

void smr_smooth_pieces(smr *s, int cut)
{
    s->ring_pieces = 1;
    for (uint32_t i = 0; cut && i < s->n_parts; i++)
        s->ring_pieces =
            smr_max_u32(s->ring_pieces,
                        vertex_pieces(&s->part[i]) + smr_ceil_div(s->part[i].facets.n_triangles, SMR_TRIANGLE_CHUNK));
}

/* How far profiles of a structure are sought that is badly seen: what is near it there is not what belongs to it, so half a
 * radius, which keeps a structure from its neighbours' far sides, keeps this one from its own place. */
static float wide_of(const smr *s, const smr_part *part)
{
    const smr_vec size = smr_sub(part->box.hi, part->box.lo);
    if (part->looked == 0u)
        return 0.0f;
    const float share = (float)part->seen / (float)part->looked;
    const float lost = smr_clamp((SMR_SEEN_WELL - share) / (SMR_SEEN_WELL - SMR_SEEN_BADLY), 0.0f, 1.0f);
    /* as far as at the start: only the last radius, which comes to rest, narrows with the schedule */
    const float most = s->radius == smr_last_radius(s) ? s->farthest_mm : s->config.profile_mm;
    const float half = 0.5f * smr_min(size.x, smr_min(size.y, size.z)); /* beyond lies what is not its own */
    const float far = smr_min(smr_min(most, s->lists.radius), half);
    return s->profile_mm + lost * smr_max(far - s->profile_mm, 0.0f);
}

/* The more a profile stands above noise, the more it tells of the image's contrast and brightness. */
static void add_contrast(const smr *s, smr_part *part, uint32_t v)
{
    const uint32_t *ranges = smr_at(s->model, s->model->at_ranges);
    const float above = smr_le_float(ranges[2u * (size_t)v + 1u]) / part->noise,
                weight = above < SMR_ABOVE_MOST ? above : SMR_ABOVE_MOST;
    part->gain_sum += weight * ((float)s->contrast[v] * (1.0f / (float)SMR_CONTRAST_ONE));
    part->lighter_sum += weight * (float)((int)s->lighter[v] - SMR_LIGHTER_NONE) * part->noise;
    part->gain_weight += weight;
}

/* Counts who had a goal and how the image compares there, and clears the sums. */
static void look_back(smr *s, smr_part *part, uint32_t from, uint32_t to)
{
    if (from == 0u) {
        part->seen = part->looked = 0;
        part->gain_sum = part->gain_weight = part->lighter_sum = 0.0f;
        part->box = (smr_box){{SMR_FAR, SMR_FAR, SMR_FAR}, {-SMR_FAR, -SMR_FAR, -SMR_FAR}};
    }
    for (uint32_t i = from; i < to; i++) {
        const uint32_t v = smr_model_position(s->model, part->first_vertex + i);
        const smr_vec at = smr_load(smr_at3(s->x, v));
        smr_box *b = &part->box;
        b->lo = smr_v(smr_min(b->lo.x, at.x), smr_min(b->lo.y, at.y), smr_min(b->lo.z, at.z));
        b->hi = smr_v(smr_max(b->hi.x, at.x), smr_max(b->hi.y, at.y), smr_max(b->hi.z, at.z));
        part->seen += s->seen[v] == 1u;
        part->looked += s->seen[v] == 1u || s->seen[v] == 2u;
        if (s->seen[v] == 1u && s->contrast[v] > 0u)
            add_contrast(s, part, v);
        smr_store(smr_at3(s->ring_sum, v), smr_v(0, 0, 0));
        s->ring_weight[v] = 0.0f;
    }
    if (to < part->n_vertices)
        return;
    part->wide_mm = wide_of(s, part);
    part->gain = part->gain_weight > 0.0f ? smr_max(part->gain_sum / part->gain_weight, SMR_GAIN_LEAST) : 1.0f;
    part->lighter = part->gain_weight > 0.0f ? part->lighter_sum / part->gain_weight : 0.0f;
}

/* Sums over the mesh neighbours; a neighbour counts once for each triangle between. */
static void add_rings(smr *s, const smr_part *part, uint32_t from, uint32_t to)
{
    if (!(s->config.fill > 0.0f) || part->seen == 0u || (float)part->seen < SMR_SEEN_BADLY * (float)part->looked)
        return; /* no ring has a weight: nothing is smoothed */
    for (uint32_t k = from; k < to; k++) {
        const uint32_t *t = part->facets.triangle + 3u * (size_t)k;
        const smr_vec a = smr_load(smr_at3(s->x, t[0])), b = smr_load(smr_at3(s->x, t[1])),
                      c = smr_load(smr_at3(s->x, t[2]));
        const smr_vec all = smr_add(a, smr_add(b, c)), corner[3] = {a, b, c};
        for (uint32_t i = 0; i < 3u; i++) {
            float *sum = smr_at3(s->ring_sum, t[i]);
            smr_store(sum, smr_add(smr_load(sum), smr_sub(all, corner[i])));
            s->ring_weight[t[i]] += 2.0f;
        }
    }
}

void smr_smooth_sum(void *arg, uint32_t task, uint32_t worker)
{
    smr *s = arg;
    smr_part *part = &s->part[task % s->n_parts];
    const uint32_t piece = task / s->n_parts, first = vertex_pieces(part), size = SMR_TRIANGLE_CHUNK;
    (void)worker;
    if (s->ring_pieces <= 1u) {
        look_back(s, part, 0, part->n_vertices);
        add_rings(s, part, 0, part->facets.n_triangles);
    } else if (piece < first) {
        look_back(s, part, piece * size, smr_min_u32((piece + 1u) * size, part->n_vertices));
    } else {
        add_rings(s, part, (piece - first) * size, smr_min_u32((piece - first + 1u) * size, part->facets.n_triangles));
    }
}

/* The way of a vertex without a goal. */
smr_vec smr_smooth_way(const smr *s, uint32_t v)
{
    if (!(s->config.fill > 0.0f) || !(s->ring_weight[v] > 0.0f))
        return smr_v(0, 0, 0);
    const smr_vec middle = smr_scale(smr_load(smr_at3(s->ring_sum, v)), 1.0f / s->ring_weight[v]);
    return smr_scale(smr_sub(middle, smr_load(smr_at3(s->x, v))), s->config.fill);
}
