/* verdict.c: readings that judge a result: the verdict and its rules, visible vertices, expected errors. A measure
 * beyond its limit is a reason. Limits are chosen so that generated runs that ended within a millimetre of the truth
 * seldom exceed them, and failed runs do.
 * Bounds: those of the measures, once for each requested structure.
 * SPDX-License-Identifier: MIT */
#include "verdict/verdict_measures.h"

#define SMR_NOT_GOOD_SHARE 0.5f  /* largest share of vertices in structures whose verdict is not good */
#define SMR_EXPECTED_MOST 4.5f   /* largest expected error, mm */
#define SMR_EXPECTED_FAILED 8.0f /* expected error beside a target above which the run failed, mm */
#define SMR_REASONS_FAILED 5u    /* number of reasons at which the run failed */
#define SMR_EXPECTED_PART 3.4f   /* largest expected error with a partial target, mm: the rest is extrapolated */
#define SMR_OPEN_MOST 0.75f      /* largest expected error over the bend */
#define SMR_OPEN_LEAST 1.8f      /* mm: smaller expected errors are not compared with the bend */
#define SMR_VISIBLE_LEAST 0.1f   /* smallest visible share of the model */
#define SMR_VISIBLE_ALL 0.95f /* visible share above which the model is whole: other parts of the target are outliers */
#define SMR_COVERED_LEAST 0.75f /* smallest covered share of the target for a whole model */
#define SMR_COVERED_PART 0.95f  /* smallest covered share of the target for a partly visible model */
#define SMR_COVERED_FAILED 0.5f /* covered share of the target below which the run failed */
#define SMR_STRAYS_MOST 0.25f   /* largest share of a cloud's points that are outliers */
#define SMR_STRAYS_FAILED 0.5f  /* share of outliers above which the run failed */
#define SMR_AGREE_LEAST 0.85f   /* smallest share of the area whose normals agree with the target's */
#define SMR_AGREE_FAILED 0.6f   /* the share of agreeing normals below which the run failed */
#define SMR_RESIDUAL_MOST 0.25f /* largest residual, in mean edge lengths */
#define SMR_LANDMARK_MOST 3.0f  /* largest mean residual of landmarks, mm */
#define SMR_SCALE_MOST 1.25f    /* largest change of size within the registration, and its inverse */
#define SMR_SCALE_PART 1.06f    /* largest change of size with a partial target, which hardly determines the size */
#define SMR_VISIBLE_PART 0.8f   /* visible share of the model below which the target is partial */
#define SMR_STRAIN_MOST 0.25f
#define SMR_STRAIN_SMOOTH 0.15f /* largest strain without noise of the target */
#define SMR_STRAIN_NOISE 2.0f /* strain by noise of the target over the residual in mean edge lengths; squares add up */
#define SMR_STRETCH_MOST 0.045f
#define SMR_STRETCH_FAILED 0.2f
#define SMR_MET_SHARE 0.98f /* visible, covered and agreeing shares above which model and target meet both ways */
/* limits where they meet: people differ by more than a model bends in a doubtful run */
#define SMR_MET_STRETCH 0.1f
#define SMR_MET_VOLUME 1.35f
#define SMR_MET_ROTATION 18.0f
#define SMR_VOLUME_MOST 1.25f /* largest change of volume, and its inverse */
#define SMR_VOLUME_FAILED 2.0f
#define SMR_ROTATION_MOST 14.0f /* largest rotation of a part, degrees */
#define SMR_ROTATION_FAILED 40.0f
#define SMR_BEND_MOST 20.0f /* largest bend, mm */
#define SMR_SIMILARITY_LEAST 0.85f
#define SMR_SIMILARITY_FAILED 0.5f
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
    case SMR_REASON_RECOVERING:
        return "the model does not follow the present target yet, or has not recovered from its jump: tick on";
    default: return "";
    }
}

/* Notes a reason when a measure exceeds a limit: `look` for a doubtful result, `failed` for a failed one. */
static void check_most(smr_verdict *verdict, uint32_t reason, float measure, float look, float failed)
{
    const uint32_t level = measure > failed ? SMR_VERDICT_FAILED : measure > look ? SMR_VERDICT_LOOK : SMR_VERDICT_GOOD;
    if (level == SMR_VERDICT_GOOD)
        return;
    verdict->reasons |= reason;
    verdict->level = smr_max_u32(verdict->level, level);
}

/* Notes a reason when a measure lies below a limit. A measure below 0 was not taken. */
static void check_least(smr_verdict *verdict, uint32_t reason, float measure, float look, float failed)
{
    if (measure >= 0.0f)
        check_most(verdict, reason, -measure, -look, -failed);
}

/* The ratio or its inverse, whichever is at least 1. */
static float beyond(float ratio) { return ratio > 1.0f ? ratio : ratio > 0.0f ? 1.0f / ratio : SMR_FAR; }

/* Applies the rules for the deformation and the expected error. */
static void judge_bend(smr_verdict *v)
{
    if (v->expected_error_mm > SMR_OPEN_LEAST)
        check_most(v, SMR_REASON_LITTLE_VISIBLE, v->expected_error_mm, SMR_OPEN_MOST * v->bend_mm, SMR_FAR);
    const int met = smr_min(smr_min(v->visible_share, v->target_covered), v->normals_agree) > SMR_MET_SHARE;
    check_most(v, SMR_REASON_STRAIN, v->stretch, met ? SMR_MET_STRETCH : SMR_STRETCH_MOST, SMR_STRETCH_FAILED);
    check_most(v, SMR_REASON_STRAIN, v->strain, SMR_STRAIN_MOST, SMR_FAR);
    check_most(v, SMR_REASON_VOLUME, beyond(v->volume_ratio), met ? SMR_MET_VOLUME : SMR_VOLUME_MOST,
               SMR_VOLUME_FAILED);
    check_most(v, SMR_REASON_ROTATION, v->rotation_deg, met ? SMR_MET_ROTATION : SMR_ROTATION_MOST,
               SMR_ROTATION_FAILED);
    check_most(v, SMR_REASON_BEND, v->bend_mm, SMR_BEND_MOST, SMR_FAR);
    check_most(v, SMR_REASON_EXPECTED, v->expected_error_mm, SMR_EXPECTED_MOST, SMR_FAR);
}

/* The largest plausible strain. Squares of the strain by noise of the target add to it. */
static float strain_most(const smr_verdict *v, float edge_mm)
{
    const float noise = SMR_STRAIN_NOISE * smr_max(v->residual_mm, 0.0f) / smr_max(edge_mm, 1.0e-6f);
    return smr_min(SMR_STRAIN_MOST, SMR_SQRT(SMR_STRAIN_SMOOTH * SMR_STRAIN_SMOOTH + noise * noise));
}

static void judge_surface(smr_verdict *v, float edge_mm)
{
    const float covered = v->visible_share > SMR_VISIBLE_ALL ? SMR_COVERED_LEAST : SMR_COVERED_PART;
    check_least(v, SMR_REASON_LITTLE_VISIBLE, v->visible_share, SMR_VISIBLE_LEAST, -1.0f);
    if (v->visible_share < SMR_VISIBLE_PART)
        check_most(v, SMR_REASON_LITTLE_VISIBLE, v->expected_error_mm, SMR_EXPECTED_PART, SMR_FAR);
    check_least(v, SMR_REASON_UNCOVERED, v->target_covered, covered, SMR_COVERED_FAILED);
    check_least(v, SMR_REASON_NORMALS, v->normals_agree, SMR_AGREE_LEAST, SMR_AGREE_FAILED);
    check_most(v, SMR_REASON_RESIDUAL, v->residual_mm, SMR_RESIDUAL_MOST * edge_mm, SMR_FAR);
    check_most(v, SMR_REASON_STRAIN, v->strain, strain_most(v, edge_mm), SMR_FAR);
    judge_bend(v);
}

/* Applies the rules for landmarks alone. Too few landmarks give no expected error. */
static void judge_landmarks(smr_verdict *v)
{
    check_most(v, SMR_REASON_LITTLE_VISIBLE, v->expected_error_mm < 0.0f ? 1.0f : 0.0f, 0.5f, SMR_FAR);
    check_most(v, SMR_REASON_RESIDUAL, v->residual_mm, SMR_LANDMARK_MOST, SMR_FAR);
    judge_bend(v);
}

static uint32_t count(uint32_t reasons)
{
    uint32_t n = 0;
    for (; reasons != 0u; reasons &= reasons - 1u)
        n++;
    return n;
}

/* Weighs reasons together. Of generated runs with an expected error or a number of reasons beyond the limits none had
 * ended near the truth. A model that is visible as a whole may be a part of a larger target: then low coverage alone is
 * no reason. */
static void judge_together(smr_verdict *v)
{
    const int doubtful = v->goals_share < 0.0f || (v->reasons & SMR_REASON_SIMILARITY) != 0u;
    if (v->reasons == SMR_REASON_UNCOVERED) {
        const int part = v->visible_share > SMR_VISIBLE_ALL && v->target_covered >= SMR_COVERED_FAILED;
        v->level = part ? SMR_VERDICT_GOOD : SMR_VERDICT_LOOK;
        v->reasons = v->level == SMR_VERDICT_GOOD ? 0u : v->reasons;
    }
    if (count(v->reasons) >= SMR_REASONS_FAILED || (doubtful && v->expected_error_mm > SMR_EXPECTED_FAILED))
        v->level = SMR_VERDICT_FAILED;
}

void smr_judge(smr_verdict *v, float edge_mm, int whole)
{
    const int part = whole && v->goals_share < 0.0f && v->visible_share < SMR_VISIBLE_PART;
    v->level = SMR_VERDICT_GOOD;
    v->reasons = 0;
    if (!(v->visible_share > 0.0f))
        check_most(v, SMR_REASON_NOTHING_VISIBLE, 1.0f, 0.0f, 0.5f);
    check_most(v, SMR_REASON_SCALE, beyond(v->scale), part ? SMR_SCALE_PART : SMR_SCALE_MOST, SMR_FAR);
    if (v->goals_share >= 0.0f) {
        check_least(v, SMR_REASON_SIMILARITY, v->image_similarity, SMR_SIMILARITY_LEAST, SMR_SIMILARITY_FAILED);
        check_least(v, SMR_REASON_GOALS, v->goals_share, SMR_GOALS_LEAST, SMR_GOALS_FAILED);
    }
    if (v->normals_agree >= 0.0f || v->target_covered >= 0.0f) /* points may lack normals */
        judge_surface(v, edge_mm);
    else if (v->goals_share < 0.0f && v->residual_mm >= 0.0f) {
        judge_landmarks(v);
        return;
    }
    judge_together(v);
}

/* Checks that measures can be taken now and that `out` exists. Errors: E_NULL, E_STATE. */
static smr_status check(const smr *s, const void *out)
{
    if (s == NULL || out == NULL)
        return SMR_E_NULL;
    if (!smr_ready(s) || s->step != 0u || s->next_task != 0u || !smr_inputs_valid(&s->forces))
        return SMR_E_STATE;
    return SMR_OK;
}

/* Measures one structure. */
static void gather(const smr *s, uint32_t structure, smr_evidence *e)
{
    memset(e, 0, sizeof *e);
    if (s->shape.structure[structure].n_vertices == 0u)
        return;
    smr_measure_shape(s, structure, e);
    smr_measure_target(s, structure, e);
    smr_measure_expected(s, structure, e);
}

/* Adds the measures of one structure to those of the whole model. */
static void add_all(smr_evidence *to, const smr_evidence *more)
{
    for (uint32_t i = 0; i < SMR_MEANS; i++) {
        to->mean[i].sum += more->mean[i].sum;
        to->mean[i].weight += more->mean[i].weight;
    }
    to->rotation_deg = smr_max(to->rotation_deg, more->rotation_deg);
}

/* Computes the verdict on a structure or on the whole model (SMR_ALL) from its measures. */
static void conclude(const smr *s, uint32_t structure, const smr_evidence *e, smr_verdict *verdict)
{
    memset(verdict, 0, sizeof *verdict);
    verdict->expected_error_mm = smr_mean_of(e->expected, -1.0f);
    verdict->expected_across_mm = smr_mean_of(e->across, -1.0f);
    verdict->expected_along_mm = smr_mean_of(e->along, -1.0f);
    verdict->expected_visible_mm = smr_mean_of(e->on_visible, -1.0f);
    verdict->visible_share = smr_mean_of(e->visible, -1.0f);
    verdict->target_covered = smr_mean_of(e->covered, -1.0f);
    verdict->other_share = smr_mean_of(e->others, smr_mean_of(e->strays, -1.0f));
    verdict->residual_mm = smr_mean_of(e->residual, -1.0f);
    verdict->normals_agree = smr_mean_of(e->agree, -1.0f);
    verdict->image_similarity = smr_mean_of(e->similarity, -1.0f);
    verdict->goals_share = smr_mean_of(e->goals, -1.0f);
    verdict->strain = SMR_SQRT(smr_mean_of(e->strain2, 0.0f));
    verdict->stretch = SMR_SQRT(smr_mean_of(e->stretch2, 0.0f));
    verdict->volume_ratio = smr_mean_of(e->volume, 1.0f);
    verdict->rotation_deg = e->rotation_deg;
    verdict->bend_mm = smr_mean_of(e->bend, 0.0f);
    verdict->moved_last_mm = s->evolve.moved_mm;
    smr_measure_moved(s, structure, verdict);
    smr_judge(verdict, smr_le_float(s->shared.model->edge_mm), structure == SMR_ALL || s->shared.n_structures == 1u);
    check_most(verdict, SMR_REASON_UNCOVERED, smr_mean_of(e->strays, 0.0f), SMR_STRAYS_MOST, SMR_STRAYS_FAILED);
    if (count(verdict->reasons) >= SMR_REASONS_FAILED)
        verdict->level = SMR_VERDICT_FAILED;
}

/* Computes the verdict on all structures together. It is not good when most vertices are in structures that are not. */
static void judge_all(const smr *s, smr_verdict *verdict)
{
    smr_evidence all = {.rotation_deg = 0.0f};
    smr_verdict one;
    float n = 0.0f, doubtful = 0.0f;
    for (uint32_t i = 0; i < s->shared.n_structures; i++) {
        smr_evidence e;
        gather(s, i, &e);
        add_all(&all, &e);
        if (s->shape.structure[i].n_vertices == 0u || !(e.visible.weight > 0.0f))
            continue;
        conclude(s, i, &e, &one);
        const float count = (float)s->shape.structure[i].n_vertices;
        n += count;
        doubtful += one.level != SMR_VERDICT_GOOD ? count : 0.0f;
    }
    conclude(s, SMR_ALL, &all, verdict);
    if (s->shared.n_structures > 1u && doubtful > SMR_NOT_GOOD_SHARE * n) {
        verdict->reasons |= SMR_REASON_STRUCTURES;
        verdict->level = verdict->level == SMR_VERDICT_GOOD ? SMR_VERDICT_LOOK : verdict->level;
    }
}

/* The result is not good while the model recovers from a jump, or has not followed the present targets yet. */
static void note_recovering(const smr *s, smr_verdict *verdict)
{
    const smr_schedule *p = &s->schedule;
    if (p->recovering == 1u || (!p->done && p->serial != p->n_set))
        check_most(verdict, SMR_REASON_RECOVERING, 1.0f, 0.0f, SMR_FAR);
}

smr_status smr_get_verdict(smr *s, uint32_t structure, smr_verdict *verdict)
{
    const smr_status status = check(s, verdict);
    smr_evidence e;
    if (status != SMR_OK)
        return status;
    if (structure != SMR_ALL && structure >= s->shared.n_structures)
        return SMR_E_INPUT;
    if (structure == SMR_ALL) {
        judge_all(s, verdict);
    } else {
        gather(s, structure, &e);
        conclude(s, structure, &e, verdict);
    }
    note_recovering(s, verdict);
    return SMR_OK;
}

smr_status smr_get_visible(const smr *s, uint32_t structure, unsigned char *visible)
{
    if (s != NULL && visible != NULL && smr_valid(s) && s->n_awaited > 0u)
        return SMR_E_STATE;
    const smr_status status = smr_readable(s, structure, visible);
    if (status != SMR_OK)
        return status;
    const smr_shape_structure *one = &s->shape.structure[structure];
    for (uint32_t i = 0; i < one->n_vertices; i++)
        visible[i] = (unsigned char)smr_vertex_visible(s, smr_model_position(s->shared.model, one->first_vertex + i));
    return SMR_OK;
}

/* Copies part k of each vertex' expected errors: 0: total, 1: across, 2: along. */
static void copy_expected(const smr *s, uint32_t structure, uint32_t k, float *mm)
{
    const smr_shape_structure *one = &s->shape.structure[structure];
    for (uint32_t i = 0; mm != NULL && i < one->n_vertices; i++)
        mm[i] = smr_vertex_expected(s, smr_model_position(s->shared.model, one->first_vertex + i))[k];
}

/* Measures a structure's expected errors and copies the requested ones. */
static smr_status get_expected(smr *s, uint32_t structure, float *mm, float *across_mm, float *along_mm)
{
    const smr_status status = check(s, mm != NULL ? mm : across_mm != NULL ? across_mm : along_mm);
    smr_evidence e;
    if (status != SMR_OK)
        return status;
    if (structure >= s->shared.n_structures)
        return SMR_E_INPUT;
    gather(s, structure, &e);
    copy_expected(s, structure, 0, mm);
    copy_expected(s, structure, 1, across_mm);
    copy_expected(s, structure, 2, along_mm);
    return SMR_OK;
}

smr_status smr_get_expected_error(smr *s, uint32_t structure, float *mm)
{
    return get_expected(s, structure, mm, NULL, NULL);
}

smr_status smr_get_expected_parts(smr *s, uint32_t structure, float *across_mm, float *along_mm)
{
    return get_expected(s, structure, NULL, across_mm, along_mm);
}
