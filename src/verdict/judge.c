/* judge.c: the rule: a measure beyond its limit is a reason. Each limit stands where generated runs with known truth
 * that ended within a millimetre seldom come, and runs that went wrong do.
 * SPDX-License-Identifier: MIT */
#include "verdict/evidence.h"

#define SMR_EXPECTED_MOST 4.5f  /* mm */
#define SMR_EXPECTED_PART 3.4f  /* mm, of a part (below SMR_SEEN_PART), the rest of which is a guess */
#define SMR_OPEN_MOST 0.75f     /* expected error over the bend: so much is left open by what is seen, */
#define SMR_OPEN_LEAST 1.8f     /* mm: and it matters */
#define SMR_SEEN_LEAST 0.1f     /* share of the model */
#define SMR_SEEN_ALL 0.95f      /* the model is seen as a whole: what the target has more is outliers */
#define SMR_COVERED_LEAST 0.75f /* share of the target then, */
#define SMR_COVERED_PART                                                                                               \
    0.95f /* and otherwise: a part of the model does not explain it, and it does not show the model */
#define SMR_COVERED_FAILED 0.5f
#define SMR_AGREE_LEAST 0.85f
#define SMR_AGREE_FAILED 0.6f
#define SMR_RESIDUAL_MOST 0.25f /* mean edges */
#define SMR_LANDMARK_MOST 3.0f  /* mm: what landmarks may be off in the mean */
#define SMR_SCALE_MOST 1.25f    /* either way, within the registration */
#define SMR_SCALE_PART 1.06f    /* the same where less than SMR_SEEN_PART is seen: a part hardly tells the size */
#define SMR_SEEN_PART 0.8f      /* share of the model: below it the target shows a part */
#define SMR_STRAIN_MOST 0.25f
#define SMR_STRAIN_SMOOTH 0.15f /* the same but for what the target's noise does to edges: */
#define SMR_STRAIN_NOISE 2.0f   /* so many times the residual in mean edges */
#define SMR_STRETCH_MOST 0.045f
#define SMR_STRETCH_FAILED 0.2f
#define SMR_VOLUME_MOST 1.25f /* either way */
#define SMR_VOLUME_FAILED 2.0f
#define SMR_ROTATION_MOST 14.0f /* degrees */
#define SMR_ROTATION_FAILED 40.0f
#define SMR_BEND_MOST 20.0f /* mm */
#define SMR_LIKENESS_LEAST 0.85f
#define SMR_LIKENESS_FAILED 0.5f
#define SMR_GOALS_LEAST 0.85f
#define SMR_GOALS_FAILED 0.3f

const char *smr_reason_text(uint32_t bit)
{
    switch (bit) {
    case SMR_REASON_NOTHING_VISIBLE: return "nothing of the target was seen: look at the start and at search distances";
    case SMR_REASON_LITTLE_VISIBLE:
        return "the target shows too little of the model to say where the rest is: look at what is not seen";
    case SMR_REASON_EXPECTED: return "large errors are expected: look at the vertices whose expected error is high";
    case SMR_REASON_UNCOVERED:
        return "the model lies on too little of the target: look at the start, and for other bodies in the target";
    case SMR_REASON_NORMALS:
        return "normals of model and target disagree: look for a surface that is inside out, or a wrong start";
    case SMR_REASON_RESIDUAL: return "seen vertices stay away from the target: look at its noise and at the start";
    case SMR_REASON_SCALE:
        return "the size has changed much for what is seen: look at units, or start with a scale that is known";
    case SMR_REASON_STRAIN:
        return "parts of the model have changed their size much: look whether the target is the same body";
    case SMR_REASON_VOLUME: return "the volume has changed much: look whether the target is the same body, and closed";
    case SMR_REASON_ROTATION: return "parts of the model have turned far: look at the start's rotation";
    case SMR_REASON_BEND:
        return "the model had to bend far: look whether the target is the same body, and at the start";
    case SMR_REASON_SIMILARITY:
        return "the image is hardly more like the model there than elsewhere: look at the image and the landmarks";
    case SMR_REASON_GOALS:
        return "many vertices found no goal in the image: look where the image ends or differs in contrast";
    case SMR_REASON_STRUCTURES:
        return "structures that are not good make up much of the model: look at their own verdicts";
    default: return "";
    }
}

/* A measure against its limits: `look` beyond the first, `failed` beyond the second. Larger is worse. */
static void ask(smr_verdict *verdict, uint32_t reason, float measure, float look, float failed)
{
    const uint32_t level = measure > failed ? SMR_VERDICT_FAILED : measure > look ? SMR_VERDICT_LOOK : SMR_VERDICT_GOOD;
    if (level == SMR_VERDICT_GOOD)
        return;
    verdict->reasons |= reason;
    verdict->level = smr_max_u32(verdict->level, level);
}

/* The same where smaller is worse, and below 0 nothing was measured. */
static void ask_least(smr_verdict *verdict, uint32_t reason, float measure, float look, float failed)
{
    if (measure >= 0.0f)
        ask(verdict, reason, -measure, -look, -failed);
}

/* A ratio to 1 or more, whichever way it is. */
static float beyond(float ratio) { return ratio > 1.0f ? ratio : ratio > 0.0f ? 1.0f / ratio : SMR_FAR; }

/* What holds of everything that bends towards places. */
static void judge_bend(smr_verdict *v)
{
    if (v->expected_error_mm > SMR_OPEN_LEAST)
        ask(v, SMR_REASON_LITTLE_VISIBLE, v->expected_error_mm, SMR_OPEN_MOST * v->bend_mm, SMR_FAR);
    ask(v, SMR_REASON_STRAIN, v->stretch, SMR_STRETCH_MOST, SMR_STRETCH_FAILED);
    ask(v, SMR_REASON_STRAIN, v->strain, SMR_STRAIN_MOST, SMR_FAR);
    ask(v, SMR_REASON_VOLUME, beyond(v->volume_ratio), SMR_VOLUME_MOST, SMR_VOLUME_FAILED);
    ask(v, SMR_REASON_ROTATION, v->rotation_deg, SMR_ROTATION_MOST, SMR_ROTATION_FAILED);
    ask(v, SMR_REASON_BEND, v->bend_mm, SMR_BEND_MOST, SMR_FAR);
    ask(v, SMR_REASON_EXPECTED, v->expected_error_mm, SMR_EXPECTED_MOST, SMR_FAR);
}

/* The strain of a body of the same kind. Noise of the target adds to it, in square. */
static float strain_most(const smr_verdict *v, float edge_mm)
{
    const float noise = SMR_STRAIN_NOISE * smr_max(v->residual_mm, 0.0f) / smr_max(edge_mm, 1.0e-6f);
    return smr_min(SMR_STRAIN_MOST, SMR_SQRT(SMR_STRAIN_SMOOTH * SMR_STRAIN_SMOOTH + noise * noise));
}

static void judge_surface(smr_verdict *v, float edge_mm)
{
    const float covered = v->visible_share > SMR_SEEN_ALL ? SMR_COVERED_LEAST : SMR_COVERED_PART;
    ask_least(v, SMR_REASON_LITTLE_VISIBLE, v->visible_share, SMR_SEEN_LEAST, -1.0f);
    if (v->visible_share < SMR_SEEN_PART)
        ask(v, SMR_REASON_LITTLE_VISIBLE, v->expected_error_mm, SMR_EXPECTED_PART, SMR_FAR);
    ask_least(v, SMR_REASON_UNCOVERED, v->target_covered, covered, SMR_COVERED_FAILED);
    ask_least(v, SMR_REASON_NORMALS, v->normals_agree, SMR_AGREE_LEAST, SMR_AGREE_FAILED);
    ask(v, SMR_REASON_RESIDUAL, v->residual_mm, SMR_RESIDUAL_MOST * edge_mm, SMR_FAR);
    ask(v, SMR_REASON_STRAIN, v->strain, strain_most(v, edge_mm), SMR_FAR);
    judge_bend(v);
}

/* Landmarks alone: few vertices are seen, however many there are; too few tell nothing of what they leave open. */
static void judge_landmarks(smr_verdict *v)
{
    ask(v, SMR_REASON_LITTLE_VISIBLE, v->expected_error_mm < 0.0f ? 1.0f : 0.0f, 0.5f, SMR_FAR);
    ask(v, SMR_REASON_RESIDUAL, v->residual_mm, SMR_LANDMARK_MOST, SMR_FAR);
    judge_bend(v);
}

static void judge_image(smr_verdict *v)
{
    ask_least(v, SMR_REASON_SIMILARITY, v->image_similarity, SMR_LIKENESS_LEAST, SMR_LIKENESS_FAILED);
    ask_least(v, SMR_REASON_GOALS, v->goals_share, SMR_GOALS_LEAST, SMR_GOALS_FAILED);
}

void smr_judge(smr_verdict *v, float edge_mm, int whole)
{
    const int part = whole && v->goals_share < 0.0f && v->visible_share < SMR_SEEN_PART;
    v->level = SMR_VERDICT_GOOD;
    v->reasons = 0;
    if (!(v->visible_share > 0.0f))
        ask(v, SMR_REASON_NOTHING_VISIBLE, 1.0f, 0.0f, 0.5f);
    ask(v, SMR_REASON_SCALE, beyond(v->scale), part ? SMR_SCALE_PART : SMR_SCALE_MOST, SMR_FAR);
    if (v->goals_share >= 0.0f)
        judge_image(v);
    if (v->normals_agree >= 0.0f || v->target_covered >= 0.0f) /* points may have no normals */
        judge_surface(v, edge_mm);
    else if (v->goals_share < 0.0f && v->residual_mm >= 0.0f)
        judge_landmarks(v);
}
