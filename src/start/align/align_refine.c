/* align_refine.c: iterative closest point in both directions (ICP, Besl and McKay 1992, with agreeing normals).
 * Outlier pairs lose their weight (Tukey's); the limit follows from the distances.
 * Bounds: `rounds` rounds over 2 * samples points.
 * SPDX-License-Identifier: MIT */
#include "start/align/align.h"
#include "geometry/rotation/similarity_fit.h"

#define SMR_UNTRIMMED 1.0e15f /* mm: no pair is an outlier; the square still fits a float */
#define SMR_STEADY 16u        /* rounds before a refinement may end early: the end depends on rounding */
/* convergence: the refinement ends when a round leaves more than this share of the mean square distance */
#define SMR_STAGNANT 0.9995f

/* Adds a side's pairs to the fit, the model's point first. Without outlier rejection all samples have the same
 * weight. Returns the weighted sum of squared distances, mm^2. */
static float collect(const smr_aligner *a, uint32_t side, float limit, int mirrored, smr_fit *fit)
{
    const smr_align_side *from = &a->side[side];
    const int trimmed = limit < SMR_UNTRIMMED;
    const float inverse = trimmed ? 1.0f / (limit * limit) : 0.0f;
    float sum = 0.0f;
    for (uint32_t k = 0; k < a->used; k++) {
        const smr_pair *pair = &from->pair[k];
        const uint32_t i = smr_sample(from, k, a->used);
        const float left = 1.0f - pair->d2 * inverse, weight = trimmed ? from->weight[i] : 1.0f;
        sum += weight * (trimmed ? smr_min(pair->d2, limit * limit) : pair->d2);
        if (pair->triangle == SMR_NONE || !(left * weight > 0.0f) || (trimmed && pair->border))
            continue;
        smr_vec x = side == SMR_MODEL ? from->point[i] : pair->at;
        if (mirrored)
            x.x = -x.x;
        smr_fit_add(fit, x, side == SMR_MODEL ? pair->at : from->point[i], left * left * weight);
    }
    return sum;
}

int smr_align_refine(smr_aligner *a, uint32_t samples, uint32_t rounds, uint32_t how, smr_pose *pose)
{
    const int mirrored = smr_pose_mirrors(pose), scaled = (how & SMR_REFINE_SCALED) != 0u;
    float last = FLT_MAX;
    for (uint32_t i = 0; i < rounds; i++) {
        smr_fit fit;
        smr_fit_start(&fit, smr_v(0, 0, 0), smr_v(0, 0, 0));
        smr_pairs_find(a, pose, samples);
        const float limit = how & SMR_REFINE_TRIMMED ? smr_pairs_limit(a) : SMR_UNTRIMMED;
        float mean = collect(a, SMR_MODEL, limit, mirrored, &fit);
        mean += collect(a, SMR_TARGET, limit, mirrored, &fit);
        if (!(fit.weight >= 3.0f))
            return 0;
        if (i >= SMR_STEADY && mean > last * SMR_STAGNANT)
            return 1;
        last = smr_min(last, mean);
        smr_pose next = smr_fit_solve(&fit, scaled);
        const float size = smr_pose_scale(&next);
        if (!(size > 0.1f && size < 10.0f))
            return 0; /* the scale collapses onto a small area of the target */
        if (mirrored)
            smr_pose_reflect(&next);
        *pose = next;
    }
    return 1;
}
