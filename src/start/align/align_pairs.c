/* align_pairs.c: closest points in both directions under a pose: search, quantiles, shares and costs.
 * Bounds: 2 * samples searches; a quantile is 4 passes over a side's samples.
 * SPDX-License-Identifier: MIT */
#include "start/align/align.h"

#define SMR_AGREE 0.1f  /* least cosine between the normals of a pair */
#define SMR_MOSTLY 0.4f /* share of a side's samples that is assumed to match */
/* limit of distances over that share's distance: three standard deviations of half-normal distances */
#define SMR_LIMIT 5.7f
#define SMR_LEAST 0.045f /* smallest limit over the smaller spread: a smaller limit would keep a slightly wrong pose */

static void find(const smr_align_side *from, const smr_align_side *to, const smr_pose *pose, uint32_t samples,
                 float scale, float far2)
{
    const float sign = to->outward;
    const float min_cos = from->bare || to->bare ? -2.0f : SMR_AGREE;
    for (uint32_t k = 0; k < samples; k++) {
        const uint32_t i = smr_sample(from, k, samples);
        smr_pair *const pair = &from->pair[k];
        const smr_query q = {smr_pose_apply(pose, from->point[i]),
                             smr_scale(smr_unit(smr_pose_turn(pose, from->normal[i])), sign), min_cos, UINT32_MAX,
                             pair->triangle};
        smr_hit hit = {far2 / (scale * scale), SMR_NONE, {0, 0, 0}};
        smr_surface_search(to->surface, &q, &hit);
        pair->triangle = hit.triangle;
        pair->d2 = hit.d2 * scale * scale;
        pair->border = 0;
        if (hit.triangle == SMR_NONE)
            continue;
        pair->at = smr_triangle_point(&to->surface->tree, hit.triangle, hit.weight);
        pair->border = to->surface->open ? smr_surface_on_border(to->surface, hit.triangle, hit.weight) : 0u;
    }
}

void smr_pairs_find(smr_aligner *a, const smr_pose *pose, uint32_t samples)
{
    const smr_pose back = smr_pose_invert(pose);
    a->used = samples;
    find(&a->side[SMR_MODEL], &a->side[SMR_TARGET], pose, samples, 1.0f, a->far2);
    find(&a->side[SMR_TARGET], &a->side[SMR_MODEL], &back, samples, smr_pose_scale(pose), a->far2);
}

/* The squared distance that a share of a side's samples does not exceed, mm^2. Found byte by byte, since the bits of
 * non-negative floats have the order of the floats. */
static float quantile(const smr_aligner *a, uint32_t side, float share)
{
    uint32_t rank = smr_min_u32((uint32_t)(share * (float)a->used), a->used - 1u), found = 0, mask = 0;
    float d2;
    for (uint32_t i = 0; i < a->used; i++)
        memcpy(&a->order[i], &a->side[side].pair[i].d2, sizeof *a->order);
    for (uint32_t shift = 24u; shift < 32u; shift -= 8u) {
        uint32_t count[256] = {0}, byte = 0;
        for (uint32_t i = 0; i < a->used; i++)
            if ((a->order[i] & mask) == found)
                count[a->order[i] >> shift & 255u]++;
        for (; rank >= count[byte]; byte++)
            rank -= count[byte];
        found |= byte << shift;
        mask |= 255u << shift;
    }
    memcpy(&d2, &found, sizeof d2);
    return d2;
}

float smr_pairs_limit(const smr_aligner *a)
{
    const float d2 = smr_min(quantile(a, SMR_MODEL, SMR_MOSTLY), quantile(a, SMR_TARGET, SMR_MOSTLY));
    return smr_max(SMR_LIMIT * SMR_SQRT(d2), SMR_LEAST * smr_aligner_spread(a));
}

float smr_pairs_share(const smr_aligner *a, uint32_t side, float limit)
{
    const smr_align_side *s = &a->side[side];
    float near = 0.0f, all = 1.0e-6f;
    for (uint32_t k = 0; k < a->used; k++) {
        const float weight = s->weight[smr_sample(s, k, a->used)];
        near += s->pair[k].d2 < limit * limit ? weight : 0.0f;
        all += weight;
    }
    return near / all;
}

float smr_pairs_cost(const smr_aligner *a)
{
    const float most = a->limit * a->limit;
    float cost[SMR_SIDES];
    for (uint32_t side = 0; side < SMR_SIDES; side++) {
        const smr_align_side *s = &a->side[side];
        float sum = 0.0f, all = 1.0e-6f;
        for (uint32_t k = 0; k < a->used; k++) {
            const float weight = s->weight[smr_sample(s, k, a->used)];
            sum += weight * smr_min(s->pair[k].d2, most);
            all += weight;
        }
        cost[side] = sum / (all * most);
    }
    return smr_cost_of_sides(cost[SMR_MODEL], cost[SMR_TARGET]);
}

float smr_pairs_rms(const smr_aligner *a, const float share[SMR_SIDES])
{
    float sum = 0.0f, all = 1.0e-6f;
    for (uint32_t side = 0; side < SMR_SIDES; side++) {
        const smr_align_side *s = &a->side[side];
        const float most = quantile(a, side, share[side]);
        for (uint32_t k = 0; k < a->used; k++) {
            const float d2 = s->pair[k].d2, weight = d2 <= most ? s->weight[smr_sample(s, k, a->used)] : 0.0f;
            sum += weight * d2;
            all += weight;
        }
    }
    return SMR_SQRT(sum / all);
}
