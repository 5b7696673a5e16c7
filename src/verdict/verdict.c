/* verdict.c: readings that judge a result: the verdict and its reasons in words, visible vertices, expected errors.
 * Bounds: those of the measures, once for each requested structure.
 * SPDX-License-Identifier: MIT */
#include "verdict/verdict_measures.h"

#define SMR_DOUBTFUL 0.3f       /* largest probability of a verdict that is doubtful whatever its measures say */
#define SMR_HIDDEN_SHARE 0.05f  /* share of vertices outside an image above which their expected errors are judged */
#define SMR_HIDDEN_MOST 3.4f    /* mm: larger mean expected errors of vertices outside an image are not good */
#define SMR_NOT_GOOD_SHARE 0.5f /* the whole is not good if structures not good hold a larger share of vertices */

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
    case SMR_REASON_UNCHECKED: return "inputs were not checked for faults since the last iteration: call smr_scrub()";
    default: return "";
    }
}

/* Checks that measures can be taken now and that `out` exists. Errors: E_NULL, E_STATE, E_DAMAGED. */
static smr_status check(const smr *s, const void *out)
{
    SMR_TRY(out == NULL ? SMR_E_NULL : smr_sound(s));
    return smr_ready(s) && s->step == 0u && s->next_task == 0u ? smr_inputs_valid(&s->forces) : SMR_E_STATE;
}

/* Clears e and stores the measures of one structure there: all, or those on which the expected errors depend. */
static void gather(const smr *s, uint32_t structure, int all, smr_evidence *e)
{
    *e = (smr_evidence){.scale_rest = 1.0f};
    if (s->shape.structure[structure].n_vertices == 0u)
        return;
    if (all)
        smr_measure_shape(s, structure, e);
    smr_measure_target(s, structure, all, e);
    smr_measure_expected(s, structure, e);
}

/* Adds the measures of one structure to those of the whole model. */
static void add_all(smr_evidence *to, const smr_evidence *more)
{
    for (uint32_t i = 0; i < SMR_MEANS; i++) {
        to->mean[i].sum += more->mean[i].sum;
        to->mean[i].weight += more->mean[i].weight;
    }
    to->scale_rest = more->scale_rest;
    to->rotation_deg = smr_max(to->rotation_deg, more->rotation_deg);
}

/* Adds a reason for which a result is not good, whatever its measures say, and lowers level and probability. */
static void add_doubt(smr_verdict *verdict, uint32_t reason)
{
    verdict->reasons |= reason;
    verdict->level = smr_max_u32(verdict->level, SMR_VERDICT_LOOK);
    verdict->probability = smr_min(verdict->probability, SMR_DOUBTFUL);
}

/* Computes the verdict on a structure or on the whole model (SMR_ALL) from its measures. */
static void conclude(const smr *s, uint32_t structure, const smr_evidence *e, smr_verdict *verdict)
{
    memset(verdict, 0, sizeof *verdict);
    const smr_mean shown = {e->expected.sum - e->hidden.sum, e->expected.weight - e->hidden.weight};
    verdict->expected_error_mm = smr_mean_of(shown, -1.0f); /* judged without vertices outside the image */
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
    smr_measure_moved(s, structure, e, verdict);
    smr_judge(verdict, smr_le_float(s->shared.model->edge_mm), structure == SMR_ALL || s->shared.n_structures == 1u,
              smr_mean_of(e->strays, 0.0f));
    verdict->expected_error_mm = smr_mean_of(e->expected, -1.0f);
    if (e->hidden.weight > SMR_HIDDEN_SHARE * e->expected.weight && smr_mean_of(e->hidden, 0.0f) > SMR_HIDDEN_MOST)
        add_doubt(verdict, SMR_REASON_LITTLE_VISIBLE);
}

/* Computes the verdict on all structures together. The whole is not good when most vertices are in structures that are
 * not good, and has not failed when most vertices are in good structures. */
static void judge_all(const smr *s, smr_verdict *verdict)
{
    smr_evidence all = {.rotation_deg = 0.0f};
    smr_verdict one;
    float n = 0.0f, doubtful = 0.0f;
    for (uint32_t i = 0; i < s->shared.n_structures; i++) {
        smr_evidence e;
        gather(s, i, 1, &e);
        add_all(&all, &e);
        if (s->shared.n_structures == 1u || s->shape.structure[i].n_vertices == 0u || !(e.visible.weight > 0.0f))
            continue;
        conclude(s, i, &e, &one);
        const float count = (float)s->shape.structure[i].n_vertices;
        n += count;
        doubtful += one.level != SMR_VERDICT_GOOD ? count : 0.0f;
    }
    conclude(s, SMR_ALL, &all, verdict);
    if (s->shared.n_structures == 1u)
        return;
    if (doubtful > SMR_NOT_GOOD_SHARE * n)
        add_doubt(verdict, SMR_REASON_STRUCTURES);
    else if (verdict->level == SMR_VERDICT_FAILED && n > 0.0f) {
        verdict->level = SMR_VERDICT_LOOK;
        verdict->probability = SMR_DOUBTFUL;
    }
}

/* Marks the verdict as not good while the model recovers from a jump, or has not followed the present targets yet. */
static void note_recovering(const smr *s, smr_verdict *verdict)
{
    const smr_schedule *p = &s->schedule;
    if (p->recovering == 1u || p->serial != p->n_set)
        add_doubt(verdict, SMR_REASON_RECOVERING);
    if ((s->scrub.what & SMR_SCRUB_INPUTS) && !s->scrub.checked)
        add_doubt(verdict, SMR_REASON_UNCHECKED);
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
        gather(s, structure, 1, &e);
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
    gather(s, structure, 0, &e);
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
