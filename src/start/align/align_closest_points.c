/* align_closest_points.c: pairs of closest points in both directions under a pose, and refinement by them: iterative
 * closest point (ICP, Besl and McKay 1992, with agreeing normals). Outlier pairs lose their weight (Tukey's); the limit
 * follows from the distances.
 * Bounds: 2 * samples searches for the pairs.
 * SPDX-License-Identifier: MIT */
#include "start/align/align.h"

#define SMR_UNTRIMMED 1.0e15f /* mm: outlier limit that no pair exceeds; its square still fits a float */
#define SMR_STEADY 16u        /* smallest number of rounds before a refinement may end early, which rounding affects */
#define SMR_STAGNANT 0.9995f  /* sum of squared distances / least sum so far above which a round is the last */

int smr_pairs_find(const smr_aligner *a, uint32_t side, const smr_pose *pose, smr_piece piece, smr_pause *pause)
{
    const smr_align_side *from = &a->side[side], *to = &a->side[side == SMR_MODEL ? SMR_TARGET : SMR_MODEL];
    const smr_pose move = side == SMR_MODEL ? *pose : smr_pose_invert(pose);
    const float scale = side == SMR_MODEL ? 1.0f : smr_pose_scale(pose); /* mm of the target in a mm of `to` */
    const float sign = to->outward, min_cos = from->bare || to->bare ? -2.0f : SMR_AGREE;
    for (uint32_t k = piece.first; k < piece.last; k++) {
        const uint32_t i = smr_sample(from, k, a->used);
        smr_pair *const pair = &from->pair[k];
        const smr_query q = {smr_pose_apply(&move, from->point[i]),
                             smr_scale(smr_unit(smr_pose_turn(&move, from->normal[i])), sign), min_cos, UINT32_MAX,
                             pair->triangle};
        smr_hit hit = {a->far2 / (scale * scale), SMR_NONE, {0, 0, 0}};
        smr_certainty known = {-1.0f, 0.0f, 0, pause};
        if (!smr_surface_search_known(to->surface, NULL, &q, &hit, &known))
            return 0;
        if (to->mask != NULL && hit.triangle != SMR_NONE &&
            !smr_mask_holds(to->mask, to->surface, smr_triangle_point(&to->surface->tree, hit.triangle, hit.weight),
                            q.normal))
            hit = (smr_hit){a->far2 / (scale * scale), SMR_NONE, {0, 0, 0}};
        pair->triangle = hit.triangle;
        pair->d2 = hit.d2 * scale * scale;
        pair->border = 0;
        if (hit.triangle == SMR_NONE)
            continue;
        pair->at = smr_triangle_point(&to->surface->tree, hit.triangle, hit.weight);
        pair->border = to->surface->open ? smr_surface_on_border(to->surface, hit.triangle, hit.weight) : 0u;
    }
    return 1;
}

void smr_align_limit(const smr_aligner *a, uint32_t how, smr_refined *r)
{
    r->limit = how & SMR_REFINE_TRIMMED ? smr_measure_limit(a, &r->measure) : SMR_UNTRIMMED;
    r->sum = 0.0f;
    smr_fit_start(&r->fit, smr_v(0, 0, 0), smr_v(0, 0, 0));
}

void smr_align_collect(const smr_aligner *a, uint32_t side, smr_piece piece, smr_refined *r)
{
    const smr_align_side *from = &a->side[side];
    const int trimmed = r->limit < SMR_UNTRIMMED, mirrored = smr_pose_mirrors(&r->pose);
    const float limit2 = r->limit * r->limit, inverse = trimmed ? 1.0f / limit2 : 0.0f;
    for (uint32_t k = piece.first; k < piece.last; k++) {
        const smr_pair *pair = &from->pair[k];
        const uint32_t i = smr_sample(from, k, a->used);
        const float left = 1.0f - pair->d2 * inverse, weight = trimmed ? from->weight[i] : 1.0f;
        r->sum += weight * (trimmed ? smr_min(pair->d2, limit2) : pair->d2);
        if (pair->triangle == SMR_NONE || !(left * weight > 0.0f) || (trimmed && pair->border))
            continue;
        smr_vec x = side == SMR_MODEL ? from->point[i] : pair->at;
        if (mirrored)
            x.x = -x.x;
        smr_fit_add(&r->fit, x, side == SMR_MODEL ? pair->at : from->point[i], left * left * weight);
    }
}

uint32_t smr_align_round(uint32_t how, smr_refined *r)
{
    const int mirrored = smr_pose_mirrors(&r->pose);
    if (!(r->fit.weight >= 3.0f))
        return SMR_REFINE_FAILED;
    if (r->round++ >= SMR_STEADY && r->sum > r->last * SMR_STAGNANT)
        return SMR_REFINE_ENDED;
    r->last = smr_min(r->last, r->sum);
    smr_pose next = smr_fit_solve(&r->fit, (how & SMR_REFINE_SCALED) != 0u);
    const float size = smr_pose_scale(&next);
    if (!(size > 0.1f && size < 10.0f))
        return SMR_REFINE_FAILED;                 /* the model shrinks onto a small area, or the reverse */
    for (uint32_t i = 0; i < 3u && mirrored; i++) /* adds the mirroring in x to the fitted pose */
        next.m[i][0] = -next.m[i][0];
    r->pose = next;
    return SMR_REFINE_GOES_ON;
}
