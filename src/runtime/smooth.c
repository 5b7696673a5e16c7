/* smooth.c: the smoothing force (paper 2.3: other forces): where the image shows no goal, a vertex is drawn towards the middle
 * of its mesh neighbours. What the image does not have, such as the longer tendon of another person's muscle, so shrinks
 * back instead of staying where the start put it; where the image does show the surface, nothing is smoothed, nor in a
 * structure of which less than half had a goal: what is lost or missing as a whole must not collapse. The force
 * falls to 0 where the schedule ends, as all others do (schedule.c). The same counts say how far goals are sought.
 * Bounds: one pass over a structure's triangles.
 * SPDX-License-Identifier: MIT */
#include "geometry/curve.h"
#include "runtime/state.h"

#define SMR_SEEN_WELL 0.8f /* share of a structure's vertices that had a goal: so many, and it is where it belongs; */
#define SMR_SEEN_BADLY 0.5f /* so few, and it is lost */

uint32_t smr_smooth_tasks(smr *s) { return s->has_grid ? s->n_parts : 0u; }

/* How far profiles of a structure are sought that is badly seen: what is near it there is not what belongs to it, so half a
 * radius, which keeps a structure from its neighbours' far sides, keeps this one from its own place. */
static float wide_of(const smr *s, uint32_t seen, uint32_t looked, smr_vec size)
{
    if (looked == 0u)
        return 0.0f;
    const float share = (float)seen / (float)looked;
    const float lost = smr_clamp((SMR_SEEN_WELL - share) / (SMR_SEEN_WELL - SMR_SEEN_BADLY), 0.0f, 1.0f);
    /* as far as at the start: only the last radius, which comes to rest, narrows with the schedule */
    const float most = s->radius == smr_last_radius(s) ? s->farthest_mm : s->config.profile_mm;
    const float half = 0.5f * smr_min(size.x, smr_min(size.y, size.z)); /* beyond lies what is not its own */
    const float far = smr_min(smr_min(most, s->lists.radius), half);
    return s->profile_mm + lost * smr_max(far - s->profile_mm, 0.0f);
}

/* Sums over the mesh neighbours of one structure's vertices; a neighbour counts once for each triangle between. */
void smr_smooth_sum(void *arg, uint32_t task, uint32_t worker)
{
    smr *s = arg;
    smr_part *part = &s->part[task];
    const uint32_t *t = part->facets.triangle;
    uint32_t seen = 0, looked = 0; /* vertices with a goal, and those of which the image can tell */
    smr_box box = {{SMR_FAR, SMR_FAR, SMR_FAR}, {-SMR_FAR, -SMR_FAR, -SMR_FAR}};
    (void)worker;
    for (uint32_t i = 0; i < part->n_vertices; i++) {
        const uint32_t v = smr_model_position(s->model, part->first_vertex + i);
        const smr_vec at = smr_load(smr_at3(s->x, v));
        box.lo = smr_v(smr_min(box.lo.x, at.x), smr_min(box.lo.y, at.y), smr_min(box.lo.z, at.z));
        box.hi = smr_v(smr_max(box.hi.x, at.x), smr_max(box.hi.y, at.y), smr_max(box.hi.z, at.z));
        seen += s->found[v] == 1u;
        looked += s->found[v] == 1u || s->found[v] == 2u;
        smr_store(smr_at3(s->ring_sum, v), smr_v(0, 0, 0));
        s->ring_weight[v] = 0.0f;
    }
    part->wide_mm = wide_of(s, seen, looked, smr_sub(box.hi, box.lo));
    if (!(s->config.smoothing > 0.0f) || seen == 0u || (float)seen < SMR_SEEN_BADLY * (float)looked)
        return; /* no ring has a weight: nothing is smoothed */
    for (uint32_t k = 0; k < part->facets.n_triangles; k++, t += 3) {
        const smr_vec a = smr_load(smr_at3(s->x, t[0])), b = smr_load(smr_at3(s->x, t[1])), c = smr_load(smr_at3(s->x, t[2]));
        const smr_vec all = smr_add(a, smr_add(b, c)), corner[3] = {a, b, c};
        for (uint32_t i = 0; i < 3u; i++) {
            float *sum = smr_at3(s->ring_sum, t[i]);
            smr_store(sum, smr_add(smr_load(sum), smr_sub(all, corner[i])));
            s->ring_weight[t[i]] += 2.0f;
        }
    }
}

/* The way of a vertex without a goal. */
smr_vec smr_smooth_way(const smr *s, uint32_t v)
{
    if (!(s->config.smoothing > 0.0f) || !(s->ring_weight[v] > 0.0f))
        return smr_v(0, 0, 0);
    const smr_vec middle = smr_scale(smr_load(smr_at3(s->ring_sum, v)), 1.0f / s->ring_weight[v]);
    return smr_scale(smr_sub(middle, smr_load(smr_at3(s->x, v))), s->config.smoothing);
}
