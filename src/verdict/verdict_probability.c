/* verdict_probability.c: the probability that a result is right, from its measures, and level and reasons by it.
 * Each measure adds doubt: none up to `none`, 1 at `limit`, SMR_DOUBT_FAILED at `failed`, straight lines between and
 * beyond. The sum of doubts gives the probability by a table. Limits and table are fitted to generated runs with a
 * known truth, of which half of the bones was left out (docs/RESULTS.md); right: surface below 1 mm, vertices below 3.
 * SPDX-License-Identifier: MIT */
#include "verdict/verdict_measures.h"

#define SMR_DOUBT_GOOD 1.0f     /* sum of doubts below which a result is good */
#define SMR_DOUBT_FAILED 5.0f   /* sum of doubts above which a result has failed */
#define SMR_DOUBT_ALONE 2.0f    /* largest sum of doubts when only coverage is low */
#define SMR_DOUBT_MOST 10.0f    /* largest doubt by one measure */
#define SMR_DOUBT_REASON 0.5f   /* share of the largest doubt that makes a reason, if no measure is beyond its limit */
#define SMR_MET_SHARE 0.98f     /* visible, covered and agreeing shares above which model and target meet both ways */
#define SMR_PART_SHARE 0.8f     /* visible share of the model below which the target is partial */
#define SMR_WHOLE_SHARE 0.95f   /* visible share above which the model counts as wholly visible, for coverage */
#define SMR_STRAIN_MOST 0.25f   /* largest plausible strain, whatever the noise */
#define SMR_STRAIN_SMOOTH 0.15f /* largest plausible strain on a target without noise */
#define SMR_STRAIN_NOISE 2.0f   /* strain by noise for a residual of one mean edge length; squares of strains add up */
#define SMR_UNLIKE_MOST 0.3f    /* largest 1 less image similarity that is multiplied by the stretch */
#define SMR_BETWEEN_BODIES 1.7f /* factor on the bend of a model that leaves much of a target's bodies uncovered */
#define SMR_OPEN_LEAST 1.8f     /* mm: smaller expected errors are not compared with the bend */

/* Indexes of the measures that give doubt. */
enum {
    NOTHING,
    LITTLE,
    PART,
    OPEN,
    EXPECTED,
    UNCOVERED,
    UNCOVERED_PART,
    STRAYS,
    NORMALS,
    RESIDUAL,
    MARKS,
    SIZE,
    SIZE_PART,
    STRAIN,
    STRETCH,
    VOLUME,
    ROTATION,
    BEND,
    SIMILARITY,
    STRETCH_IMAGE,
    GOALS,
    SUBJECTS,
    MEASURES
};

/* Reason and limits of each measure. wider: factor on limits where model and target meet both ways: people differ. */
static const struct {
    uint32_t reason;
    float none, limit, failed, wider;
} table[MEASURES] = {
    [NOTHING] = {SMR_REASON_NOTHING_VISIBLE, 0.0f, 0.1f, 0.5f, 1.0f},    /* limits of 1 (nothing visible) or 0 */
    [LITTLE] = {SMR_REASON_LITTLE_VISIBLE, 0.8f, 0.9f, 1.3f, 1.0f},      /* limits of the model's hidden share */
    [PART] = {SMR_REASON_LITTLE_VISIBLE, 2.0f, 2.3f, 13.0f, 1.0f},       /* limits of error on a partial target, mm */
    [OPEN] = {SMR_REASON_LITTLE_VISIBLE, 0.45f, 1.15f, 5.0f, 1.0f},      /* limits of expected error / bend */
    [EXPECTED] = {SMR_REASON_EXPECTED, 3.2f, 6.5f, 12.0f, 1.0f},         /* limits of expected error, mm */
    [UNCOVERED] = {SMR_REASON_UNCOVERED, 0.15f, 0.25f, 0.5f, 1.0f},      /* limits of uncovered share, all visible */
    [UNCOVERED_PART] = {SMR_REASON_UNCOVERED, 0.03f, 0.05f, 0.6f, 1.0f}, /* limits of uncovered share, part visible */
    [STRAYS] = {SMR_REASON_UNCOVERED, 0.35f, 0.5f, 0.8f, 1.0f},          /* limits of a cloud's share of outliers */
    [NORMALS] = {SMR_REASON_NORMALS, 0.1f, 0.15f, 0.4f, 1.0f},           /* limits of share of disagreeing normals */
    [RESIDUAL] = {SMR_REASON_RESIDUAL, 0.23f, 0.25f, 2.0f, 1.0f},        /* limits of residual in mean edge lengths */
    [MARKS] = {SMR_REASON_RESIDUAL, 2.0f, 3.0f, 20.0f, 1.0f},            /* limits of landmarks' residual, mm */
    [SIZE] = {SMR_REASON_SCALE, 1.2f, 1.25f, 4.0f, 1.7f},                /* limits of size factor since start, >= 1 */
    [SIZE_PART] = {SMR_REASON_SCALE, 1.04f, 1.06f, 2.0f, 1.0f},          /* limits of size factor, partial target */
    [STRAIN] = {SMR_REASON_STRAIN, 0.8f, 1.0f, 8.0f, 1.0f},              /* limits of strain / largest plausible one */
    [STRETCH] = {SMR_REASON_STRAIN, 0.046f, 0.055f, 0.4f, 1.15f},        /* limits of rms stretch of parts */
    [VOLUME] = {SMR_REASON_VOLUME, 1.2f, 1.25f, 4.0f, 1.09f},            /* limits of volume factor from rest, >= 1 */
    [ROTATION] = {SMR_REASON_ROTATION, 13.0f, 15.5f, 40.0f, 1.15f},      /* limits of a part's rotation, degrees */
    [BEND] = {SMR_REASON_BEND, 14.5f, 16.5f, 80.0f, 1.0f},               /* limits of bend, mm */
    [SIMILARITY] = {SMR_REASON_SIMILARITY, 0.12f, 0.15f, 0.5f, 1.0f},    /* limits of 1 - image similarity */
    [STRETCH_IMAGE] = {SMR_REASON_STRAIN, 0.008f, 0.01f, 0.04f, 1.0f},   /* limits of stretch * (1 - similarity) */
    [GOALS] = {SMR_REASON_GOALS, 0.12f, 0.15f, 0.7f, 1.0f},              /* limits of share without a goal */
    [SUBJECTS] = {SMR_REASON_SUBJECTS, 1.25f, 1.4f, 4.0f, 1.0f},         /* limits of subjects_ratio, with subjects */
};

/* Points of a curve: sum of doubts, and share of runs with this sum that were right. */
static const struct {
    float doubt, probability;
} curve[] = {{0.0f, 0.985f},  {SMR_DOUBT_GOOD, SMR_PROBABILITY_GOOD},
             {2.0f, 0.3f},    {SMR_DOUBT_FAILED, SMR_PROBABILITY_FAILED},
             {10.0f, 0.005f}, {20.0f, 0.0f}};

static float between(float x, float from, float to, float low, float high)
{
    return low + (high - low) * ((x - from) / (to - from));
}

static float probability_of(float doubt)
{
    uint32_t k = 1;
    while (k + 1u < sizeof curve / sizeof curve[0] && doubt > curve[k].doubt)
        k++;
    const float p =
        between(doubt, curve[k - 1u].doubt, curve[k].doubt, curve[k - 1u].probability, curve[k].probability);
    return smr_clamp(p, 0.0f, 1.0f);
}

/* Returns the ratio or its inverse, whichever is at least 1. */
static float beyond(float ratio) { return ratio > 1.0f ? ratio : ratio > 0.0f ? 1.0f / ratio : SMR_FAR; }

/* Returns 1 less a share; 0 for a share below 0, which was not measured. */
static float lacking(float share) { return share >= 0.0f ? 1.0f - share : 0.0f; }

/* Returns the largest plausible strain of a surface's edges. */
static float strain_most(const smr_verdict *v, float edge_mm)
{
    const float noise = SMR_STRAIN_NOISE * smr_max(v->residual_mm, 0.0f) / smr_max(edge_mm, 1.0e-6f);
    return smr_min(SMR_STRAIN_MOST, SMR_SQRT(SMR_STRAIN_SMOOTH * SMR_STRAIN_SMOOTH + noise * noise));
}

/* Writes deformation and expected error to m, for surfaces and landmarks as targets. */
static void take_bend(const smr_verdict *v, float *m)
{
    if (v->expected_error_mm > SMR_OPEN_LEAST)
        m[OPEN] = v->bend_mm > 0.0f ? v->expected_error_mm / v->bend_mm : SMR_FAR;
    m[EXPECTED] = v->expected_error_mm;
    m[STRETCH] = v->stretch;
    m[STRAIN] = v->strain / SMR_STRAIN_MOST;
    m[VOLUME] = beyond(v->volume_ratio);
    m[ROTATION] = v->rotation_deg;
    m[BEND] = v->bend_mm;
}

static void take_surface(const smr_verdict *v, float edge_mm, float misfit, float *m)
{
    take_bend(v, m);
    m[LITTLE] = lacking(v->visible_share);
    m[PART] = v->visible_share < SMR_PART_SHARE ? v->expected_error_mm : 0.0f;
    m[v->visible_share > SMR_WHOLE_SHARE ? UNCOVERED : UNCOVERED_PART] = lacking(v->target_covered);
    if (lacking(v->target_covered) > table[UNCOVERED].limit)
        m[BEND] *= SMR_BETWEEN_BODIES; /* a model that lies on parts of two bodies bends from one to the other */
    m[NORMALS] = lacking(v->normals_agree);
    m[RESIDUAL] = misfit * v->residual_mm / smr_max(edge_mm, 1.0e-6f);
    m[STRAIN] = v->strain / strain_most(v, edge_mm);
}

/* Writes the measures to m[MEASURES]; measures that were not taken stay 0. */
static void take(const smr_verdict *v, float edge_mm, int whole, float strays, float misfit, float *m)
{
    const int image = v->goals_share >= 0.0f;
    m[NOTHING] = v->visible_share > 0.0f ? 0.0f : 1.0f;
    m[whole && !image && v->visible_share < SMR_PART_SHARE ? SIZE_PART : SIZE] = beyond(v->scale);
    m[STRAYS] = strays;
    m[SUBJECTS] = v->subjects_ratio; /* below 0 without further subjects */
    if (image) {
        m[SIMILARITY] = v->image_similarity > -1.0f ? 1.0f - v->image_similarity : 0.0f;
        m[STRETCH_IMAGE] =
            smr_min(m[SIMILARITY], SMR_UNLIKE_MOST) * v->stretch; /* less where the image fits: people differ */
        m[GOALS] = lacking(v->goals_share);
        m[EXPECTED] = m[SIMILARITY] > table[SIMILARITY].limit ? v->expected_error_mm : 0.0f;
    }
    if (v->normals_agree >= 0.0f || v->target_covered >= 0.0f) /* points may lack normals, but not coverage */
        take_surface(v, edge_mm, misfit, m);
    else if (!image && v->residual_mm >= 0.0f) {
        take_bend(v, m);
        m[PART] = v->expected_error_mm; /* landmarks show little, and few of them are met whatever the shape */
        m[MARKS] = v->residual_mm;
    }
    if (!image && v->residual_mm >= 0.0f && v->expected_error_mm < 0.0f)
        m[LITTLE] = 1.0f; /* too few landmarks, points or vertices that are visible */
}

/* Returns the doubt that measure k gives. met 1: the limits are wider. */
static float doubt_of(uint32_t k, float measure, int met)
{
    const float wider = met ? table[k].wider : 1.0f, limit = wider * table[k].limit, none = wider * table[k].none;
    if (measure <= none) /* false for NaN, which then gives the largest doubt */
        return 0.0f;
    if (measure < limit)
        return between(measure, none, limit, 0.0f, 1.0f);
    return smr_min(between(measure, limit, wider * table[k].failed, 1.0f, SMR_DOUBT_FAILED), SMR_DOUBT_MOST);
}

/* Returns the reasons of measures beyond their limits, or else of those that give most doubt. */
static uint32_t reasons_of(const float *doubt)
{
    uint32_t reasons = 0;
    float most = 0.0f;
    for (uint32_t k = 0; k < MEASURES; k++)
        most = smr_max(most, doubt[k]);
    const float least = most >= 1.0f ? 1.0f : SMR_DOUBT_REASON * most;
    for (uint32_t k = 0; k < MEASURES; k++)
        reasons |= doubt[k] >= least ? table[k].reason : 0u;
    return reasons;
}

void smr_judge(smr_verdict *v, float edge_mm, int whole, float strays, float misfit)
{
    const int met = smr_min(smr_min(v->visible_share, v->target_covered), v->normals_agree) > SMR_MET_SHARE;
    float doubt[MEASURES] = {0.0f}, sum = 0.0f;
    take(v, edge_mm, whole, strays, misfit, doubt);
    for (uint32_t k = 0; k < MEASURES; k++) {
        doubt[k] = doubt_of(k, doubt[k], met);
        sum += doubt[k];
    }
    /* low coverage alone does not fail, and gives no doubt for a whole model, which may be a part of a larger target */
    const uint32_t low = doubt[UNCOVERED] > 0.0f ? UNCOVERED : UNCOVERED_PART;
    if (sum - doubt[low] < SMR_DOUBT_GOOD) {
        const int part = low == UNCOVERED && doubt[low] < SMR_DOUBT_FAILED;
        const float alone = part ? 0.0f : smr_min(doubt[low], SMR_DOUBT_ALONE);
        sum += alone - doubt[low];
        doubt[low] = alone;
    }
    v->probability = probability_of(sum);
    v->level = v->probability > SMR_PROBABILITY_GOOD      ? SMR_VERDICT_GOOD
               : v->probability >= SMR_PROBABILITY_FAILED ? SMR_VERDICT_LOOK
                                                          : SMR_VERDICT_FAILED;
    v->reasons = v->level == SMR_VERDICT_GOOD ? 0u : reasons_of(doubt);
}
