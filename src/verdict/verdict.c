/* verdict.c: readings that judge a result: the verdict, visible vertices, expected errors.
 * Bounds: those of the measures, once for each requested structure.
 * SPDX-License-Identifier: MIT */
#include "verdict/verdict_measures.h"

#define SMR_NOT_GOOD_SHARE 0.5f /* largest share of vertices in structures that are not good */

static smr_status check(const smr *s, const void *out)
{
    if (s == NULL || out == NULL)
        return SMR_E_NULL;
    if (!smr_ready(s) || s->step != 0u || s->next_task != 0u || !smr_inputs_valid(&s->forces))
        return SMR_E_STATE;
    return SMR_OK;
}

static void gather(const smr *s, uint32_t structure, smr_evidence *e)
{
    memset(e, 0, sizeof *e);
    if (s->shape.structure[structure].n_vertices == 0u)
        return;
    smr_measure_shape(s, structure, e);
    const smr_surface *target = s->forces.surface.target[structure].surface;
    if (target != NULL && smr_is_cloud(target))
        smr_measure_points(s, structure, e);
    else if (target != NULL)
        smr_measure_surface(s, structure, e);
    else if (s->forces.image.has_image)
        smr_measure_image(s, structure, e);
    else if (smr_follows_landmarks(s, structure))
        smr_measure_landmarks(s, structure, e);
    else if (smr_caller_has_goals(&s->forces.caller, structure))
        smr_measure_caller(s, structure, e);
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

_Static_assert(offsetof(smr_evidence, rotation_deg) == SMR_MEANS * sizeof(smr_mean), "the list has every mean");

static void conclude(const smr *s, uint32_t structure, const smr_evidence *e, smr_verdict *verdict)
{
    memset(verdict, 0, sizeof *verdict);
    verdict->expected_error_mm = smr_mean_of(e->expected, -1.0f);
    verdict->visible_share = smr_mean_of(e->visible, -1.0f);
    verdict->target_covered = smr_mean_of(e->covered, -1.0f);
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
}

/* The verdict of all structures together, and the share of vertices in structures that are not good. */
static void judge_all(const smr *s, smr_verdict *verdict)
{
    smr_evidence all;
    smr_verdict one;
    float n = 0.0f, doubtful = 0.0f;
    memset(&all, 0, sizeof all);
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

smr_status smr_get_expected_error(smr *s, uint32_t structure, float *mm)
{
    const smr_status status = check(s, mm);
    smr_evidence e;
    if (status != SMR_OK)
        return status;
    if (structure >= s->shared.n_structures)
        return SMR_E_INPUT;
    gather(s, structure, &e);
    const smr_shape_structure *one = &s->shape.structure[structure];
    for (uint32_t i = 0; i < one->n_vertices; i++)
        mm[i] = smr_vertex_expected(s)[smr_model_position(s->shared.model, one->first_vertex + i)];
    return SMR_OK;
}
