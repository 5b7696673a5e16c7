/* verdict.c: readings that judge a result: the verdict and its reasons in words, visible vertices, expected errors. A
 * verdict and expected errors are a job (base/job.h), which the whole calls run at once.
 * Bounds: those of the measures, once for each requested structure.
 * SPDX-License-Identifier: MIT */
#include "verdict/verdict_measures.h"

#define SMR_DOUBTFUL 0.3f       /* largest probability of a verdict that is doubtful whatever its measures say */
#define SMR_HIDDEN_SHARE 0.05f  /* share of vertices outside an image above which their expected errors are judged */
#define SMR_HIDDEN_MOST 3.4f    /* mm: larger mean expected errors of vertices outside an image are not good */
#define SMR_NOT_GOOD_SHARE 0.5f /* the whole is not good if structures not good hold a larger share of vertices */
#define SMR_NOT_KEPT UINT32_MAX /* level of a verdict on a structure that was not made */
#define SMR_APART 0.819f        /* cosine of 35 degrees: structures that have turned farther apart are not good */
#define SMR_MISFIT_LEAST 0.33f  /* smallest part of a residual that counts: noise leaves errors, too */

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
    case SMR_REASON_ROTATION:
        return "parts of the model have turned far: look at the start's rotation; joints need --align parts";
    case SMR_REASON_BEND:
        return "the model had to bend far: look whether the target is the same body, and at the start";
    case SMR_REASON_SIMILARITY:
        return "the image is hardly more like the model there than elsewhere: look at the image and the landmarks";
    case SMR_REASON_GOALS:
        return "many vertices found no goal in the image: look where the image ends or differs in contrast";
    case SMR_REASON_STRUCTURES:
        return "structures that are not good make up much of the model: look at their own verdicts";
    case SMR_REASON_RECOVERING:
        return "the model does not follow the present target yet, or has not recovered from its jump: "
               "tick on, and start again where the schedule has ended";
    case SMR_REASON_SUBJECTS:
        return "the shape is unlike all subjects of the model: look whether the target is the same body and side";
    case SMR_REASON_BOUND:
        return "edges stretched beyond their bound: look whether the target is the same body, and at the start";
    case SMR_REASON_UNCHECKED: return "inputs were not checked for faults since the last iteration: call smr_scrub()";
    default: return "";
    }
}

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

/* Returns the part of a structure's residual, 0..1, that is not a cloud's noise; 0 without a residual. */
static float misfit_of(const smr *s, uint32_t i)
{
    const smr_target *target = &s->forces.surface.target[i];
    if (target->surface != NULL)
        return smr_is_points(target->surface) ? SMR_SQRT(smr_points_agree(target)) : 1.0f;
    return smr_image_on(&s->forces.image) || smr_follows_landmarks(s, i) || smr_caller_has_goals(&s->forces.caller, i)
               ? 1.0f
               : 0.0f;
}

/* Returns that part of a structure's residual, or for SMR_ALL the largest part of all structures. */
static float most_misfit(const smr *s, uint32_t structure)
{
    float most = structure == SMR_ALL ? 0.0f : misfit_of(s, structure);
    for (uint32_t i = 0; structure == SMR_ALL && i < s->shared.n_structures; i++)
        most = smr_max(most, misfit_of(s, i));
    return smr_max(most, SMR_MISFIT_LEAST);
}

/* Computes the verdict on a structure or on the whole model (SMR_ALL) from its measures. */
static void conclude(const smr_judgement *j, uint32_t structure, const smr_evidence *e, smr_verdict *verdict)
{
    const smr *s = j->s;
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
    verdict->subjects_ratio = smr_mean_of(e->strange, -1.0f);
    smr_measure_moved(j, structure, e, verdict);
    smr_judge(verdict, smr_le_float(s->shared.model->edge_mm), structure == SMR_ALL || s->shared.n_structures == 1u,
              smr_mean_of(e->strays, -1.0f), most_misfit(s, structure));
    verdict->expected_error_mm = smr_mean_of(e->expected, -1.0f);
    if (e->hidden.weight > SMR_HIDDEN_SHARE * e->expected.weight && smr_mean_of(e->hidden, 0.0f) > SMR_HIDDEN_MOST)
        add_doubt(verdict, SMR_REASON_LITTLE_VISIBLE);
}

/* Computes the verdict on all structures together. The whole is not good when most vertices are in structures that are
 * not good, or when one has turned far against another since the start, where vertices slide along their surfaces; and
 * has not failed when most vertices are in good structures. */
static void judge_all(const smr_judgement *j, smr_verdict *verdict)
{
    conclude(j, SMR_ALL, &j->all, verdict);
    if (j->s->shared.n_structures == 1u)
        return;
    if (j->n > 0.0f && j->apart < SMR_APART && !j->s->schedule.tracking)
        add_doubt(verdict, SMR_REASON_ROTATION);
    if (j->n_doubtful > SMR_NOT_GOOD_SHARE * j->n)
        add_doubt(verdict, SMR_REASON_STRUCTURES);
    else if (verdict->level == SMR_VERDICT_FAILED && j->n > 0.0f) {
        verdict->level = SMR_VERDICT_LOOK;
        verdict->probability = SMR_DOUBTFUL;
    }
}

/* Marks the verdict as not good while the model recovers from a jump, or has not followed the present targets yet, and
 * where the bound of strain held x^r back. */
static void note_state(const smr *s, smr_verdict *verdict)
{
    const smr_schedule *p = &s->schedule;
    if (s->reference.strained)
        add_doubt(verdict, SMR_REASON_BOUND);
    if (p->recovering == 1u || p->serial != p->n_set)
        add_doubt(verdict, SMR_REASON_RECOVERING);
    if ((s->scrub.what & SMR_SCRUB_INPUTS) && !s->scrub.checked)
        add_doubt(verdict, SMR_REASON_UNCHECKED);
}

/* ---- the stages ---- */

static void next_structure(smr_judgement *j)
{
    j->e = (smr_evidence){.scale_rest = 1.0f};
    memset(&j->field, 0, sizeof j->field);
    smr_target_begin(j);
}

/* Returns 1 when the structure gets a verdict of its own, which needs its motion from the start. */
static int judges_structure(const smr_judgement *j)
{
    const int one_of_several = j->s->shared.n_structures > 1u && j->e.visible.weight > 0.0f;
    return j->verdict != NULL && (j->asked != SMR_ALL || one_of_several);
}

static uint32_t moved_tasks(const void *job)
{
    const smr_judgement *j = job;
    return judges_structure(j) ? smr_ceil_div(smr_judged(j)->n_vertices, SMR_JUDGE_PIECE) : 0u;
}

static void moved_fit(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_judgement *j = job;
    smr_fit_piece(j, task, smr_judged(j)->first_vertex, smr_judged(j)->n_vertices, 1);
}

/* Returns the place, behind the visible vertices, where a verdict on all structures leaves that on a structure; NULL
 * without room. */
static smr_verdict *kept_place(const smr *s, uint32_t structure)
{
    const size_t n = s->shared.n, from = (n + 7u) / 8u * 8u + structure * sizeof(smr_verdict);
    unsigned char *const visible = smr_judged_visible(s);
    return from + sizeof(smr_verdict) <= n * sizeof(uint32_t) ? (smr_verdict *)(void *)(visible + from) : NULL;
}

/* Returns the verdict on a structure that one on all structures has left; NULL: none. */
static const smr_verdict *kept(const smr *s, uint32_t structure)
{
    const smr_verdict *v = s->judged == SMR_ALL && structure != SMR_ALL ? kept_place(s, structure) : NULL;
    return v != NULL && v->level != SMR_NOT_KEPT ? v : NULL;
}

static void structure_end(void *job, SMR_UNUSED uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_judgement *j = job;
    const uint32_t n = smr_judged(j)->n_vertices;
    smr_verdict *const place = j->asked == SMR_ALL ? kept_place(j->s, j->structure) : NULL;
    add_all(&j->all, &j->e);
    if (place != NULL)
        place->level = SMR_NOT_KEPT;
    if (n > 0u && j->asked == SMR_ALL && judges_structure(j)) {
        smr_verdict one;
        conclude(j, j->structure, &j->e, &one);
        if (place != NULL)
            *place = one;
        j->first = j->n > 0.0f ? j->first : j->start;
        j->apart = j->n > 0.0f ? smr_min(j->apart, smr_cosine_between(&j->first, &j->start)) : 1.0f;
        j->n += (float)n;
        j->n_doubtful += one.level != SMR_VERDICT_GOOD ? (float)n : 0.0f;
    }
    if (j->asked == SMR_ALL && ++j->structure < j->s->shared.n_structures) {
        next_structure(j);
        j->job.head.next_stage = 0;
    }
}

static uint32_t all_tasks(const void *job)
{
    const smr_judgement *j = job;
    return j->asked == SMR_ALL ? smr_ceil_div(j->s->shared.n, SMR_JUDGE_PIECE) : 0u;
}

static uint32_t all_rest_tasks(const void *job)
{
    return ((const smr_judgement *)job)->s->shared.n_structures > 1u ? all_tasks(job) : 0u;
}

static void all_fit(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_fit_piece(job, task, 0, ((smr_judgement *)job)->s->shared.n, 1);
}

static void all_rest_fit(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_fit_piece(job, task, 0, ((smr_judgement *)job)->s->shared.n, 0);
}

static void finish(void *job, SMR_UNUSED uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_judgement *j = job;
    if (j->verdict == NULL)
        return;
    const smr_verdict *const one = j->by == SMR_BY_MEMORY ? kept(j->s, j->asked) : NULL;
    if (j->asked == SMR_ALL)
        judge_all(j, j->verdict);
    else if (one != NULL)
        *j->verdict = *one;
    else
        conclude(j, j->asked, &j->e, j->verdict);
    note_state(j->s, j->verdict);
}

static uint32_t copy_tasks(const void *job)
{
    const smr_judgement *j = job;
    return j->verdict == NULL ? smr_ceil_div(smr_judged(j)->n_vertices, SMR_JUDGE_PIECE) : 0u;
}

static void copy_expected(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    const smr_judgement *j = job;
    const smr_piece piece = smr_judged_vertices(j, task);
    for (uint32_t k = 0; k < 3u; k++)
        for (uint32_t i = piece.first; i < piece.last && j->mm[k] != NULL; i++)
            j->mm[k][i] = smr_vertex_expected(j->s, smr_judged_vertex(j, i))[k];
}

/* The first stages run for each structure. Stages with smr_in_order sum in a fixed order. */
static const smr_stage stages[] = {
    {smr_rest_fit_tasks, smr_rest_fit_add, smr_in_order, NULL},
    {smr_edges_tasks, smr_edges_measure, smr_in_order, NULL},
    {smr_parts_tasks, smr_parts_add, smr_parts_abreast, smr_parts_take},
    {smr_blend_tasks, smr_blend_measure, smr_in_order, NULL},
    {smr_list_tasks, smr_list_vertices, smr_in_order, NULL},
    {smr_visible_tasks, smr_visible_find, NULL, NULL},
    {smr_distances_tasks, smr_distances_find, NULL, NULL},
    {smr_cloud_tasks, smr_cloud_measure, smr_places_abreast, smr_cloud_take},
    {smr_profiles_tasks, smr_profiles_compare, smr_places_abreast, smr_profiles_take},
    {smr_vertices_tasks, smr_vertices_measure, smr_in_order, NULL},
    {smr_triangles_measure_tasks, smr_triangles_measure, smr_places_abreast, smr_triangles_take},
    {smr_cover_tasks, smr_cover_measure, smr_places_abreast, smr_cover_take},
    {smr_points_tasks, smr_points_measure, smr_places_abreast, smr_points_take},
    {smr_observed_tasks, smr_observed_count, smr_in_order, NULL},
    {smr_observed_tasks, smr_observe, smr_in_order, NULL},
    {smr_marks_tasks, smr_marks_observe, smr_in_order, NULL},
    {NULL, smr_field_begin, NULL, NULL},
    {smr_noise_tasks, smr_noise_begin, NULL, NULL},
    {smr_noise_rings_tasks, smr_noise_rings_add, smr_in_order, NULL},
    {smr_noise_tasks, smr_noise_add, smr_in_order, NULL},
    {smr_factor_tasks, smr_factor_rows, smr_in_order, NULL},
    {smr_round_tasks, smr_round_end, NULL, NULL}, /* back to the factor, several times */
    {smr_errors_tasks, smr_errors_find, NULL, NULL},
    {smr_errors_add_tasks, smr_errors_add, smr_in_order, NULL},
    {moved_tasks, moved_fit, smr_in_order, NULL},
    {NULL, structure_end, NULL, NULL}, /* back to the first stage for the next structure */
    {all_tasks, all_fit, smr_in_order, NULL},
    {all_rest_tasks, all_rest_fit, smr_in_order, NULL},
    {NULL, finish, NULL, NULL},
    {copy_tasks, copy_expected, NULL, NULL},
};

/* Notes that the expected errors are in memory. */
static void note_expected(const smr_judgement *j)
{
    smr *const s = j->job.s;
    if (smr_knows_expected(j))
        return;
    s->judged = j->asked;
    s->judged_at = s->log.changes;
    s->judged_turn = s->n_measured;
    smr_guard_close(s);
}

static int is_unchanged(void *job, int enter)
{
    smr_judgement *j = job;
    if (!smr_measure_guard(&j->job, enter))
        return 0;
    const smr_status status = enter ? smr_inputs_valid(&j->s->forces) : SMR_OK;
    if (!enter && j->job.head.status == SMR_OK)
        note_expected(j);
    if (status == SMR_OK)
        return 1;
    j->job.head.status = status;
    (void)smr_measure_guard(&j->job, 0);
    return 0;
}

/* Begins to measure a structure, or all. Errors: E_NULL, E_STATE, E_INPUT. */
static smr_status begin(smr *s, uint32_t structure, smr_verdict *verdict, float *const mm[3], smr_job *job)
{
    smr_judgement *const j = (smr_judgement *)(void *)job;
    SMR_TRY(job == NULL ? SMR_E_NULL : smr_sound(s));
    if (!smr_measurable(s))
        return SMR_E_STATE;
    SMR_TRY(smr_inputs_valid(&s->forces));
    if (structure >= s->shared.n_structures && (structure != SMR_ALL || verdict == NULL))
        return SMR_E_INPUT;
    memset(j, 0, sizeof *j);
    const int known = !(s->scrub.what & SMR_SCRUB_STATE) /* which does not check that memory */ && s->n_measured > 0u &&
                      s->judged_turn == s->n_measured && s->judged_at == s->log.changes &&
                      (s->judged == SMR_ALL || s->judged == structure);
    s->judged_turn += (uint32_t)known;
    j->job = smr_measure_begin(s, stages, sizeof stages / sizeof stages[0]);
    j->job.head.guard = is_unchanged;
    j->s = s;
    j->asked = structure;
    j->structure = structure == SMR_ALL ? 0u : structure;
    j->verdict = verdict;
    for (uint32_t k = 0; k < 3u && mm != NULL; k++)
        j->mm[k] = mm[k];
    next_structure(j);
    if (known && (verdict == NULL || kept(s, structure) != NULL)) {
        j->by = SMR_BY_MEMORY;
        j->job.head.stage = j->job.head.n_stages - 2u;
    }
    return SMR_OK;
}

smr_status smr_verdict_begin(smr *s, uint32_t structure, smr_verdict *verdict, smr_job *job)
{
    return verdict == NULL ? SMR_E_NULL : begin(s, structure, verdict, NULL, job);
}

smr_status smr_expected_begin(smr *s, uint32_t structure, float *mm, float *across_mm, float *along_mm, smr_job *job)
{
    float *const to[3] = {mm, across_mm, along_mm};
    return mm == NULL && across_mm == NULL && along_mm == NULL ? SMR_E_NULL : begin(s, structure, NULL, to, job);
}

smr_status smr_get_verdict(smr *s, uint32_t structure, smr_verdict *verdict)
{
    smr_job job;
    return smr_job_whole(smr_verdict_begin(s, structure, verdict, &job), &job, NULL);
}

static smr_status get_expected(smr *s, uint32_t structure, float *mm, float *across_mm, float *along_mm)
{
    smr_job job;
    return smr_job_whole(smr_expected_begin(s, structure, mm, across_mm, along_mm, &job), &job, NULL);
}

smr_status smr_get_expected_error(smr *s, uint32_t structure, float *mm)
{
    return get_expected(s, structure, mm, NULL, NULL);
}

smr_status smr_get_expected_parts(smr *s, uint32_t structure, float *across_mm, float *along_mm)
{
    return get_expected(s, structure, NULL, across_mm, along_mm);
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
