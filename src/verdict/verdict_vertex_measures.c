/* verdict_vertex_measures.c: stages of a verdict that visit a structure's vertices: visibility; how well intensity
 * profiles match in their places, compared with chance; residuals on surfaces, in images, at landmarks and goals.
 * Bounds: SMR_LOOKED comparisons in an image, and one for each vertex once the search in the image has ended.
 * SPDX-License-Identifier: MIT */
#include "verdict/verdict_measures.h"

#define SMR_MEASURE_EDGES 1.0f /* distance up to which the target is covered, in mean edge lengths of the model */
#define SMR_MEASURE_TIMES 2.0f /* distance up to which the target is covered, in mean residuals, if larger */
#define SMR_LOOKED 400u        /* most compared vertices of a structure in an image, evenly spaced */
#define SMR_MEASURE_SEEN 8u    /* vertices in a task that compares their profiles */

int smr_vertex_visible(const smr *s, uint32_t v)
{
    const smr_surface_goals *g = &s->forces.surface;
    const uint32_t owner = smr_model_owner(s->shared.model, v);
    int32_t wins = 0;
    uint32_t n = 0;
    if (g->target[owner].surface != NULL && g->visibility != NULL && g->target[owner].n_judged > 0u)
        return smr_visibility_found(&s->forces, v) > SMR_VISIBLE_ONE / 2u;
    if (g->target[owner].surface != NULL || !s->forces.image.has_image || !s->forces.image.structure[owner].idle ||
        smr_field_of_past(&s->forces.occluded))
        return smr_found(&s->forces, v) == SMR_FOUND_GOAL;
    smr_image_compare(&s->forces.image, v, &wins, &n); /* goals are unknown after the search has ended */
    return wins > 0;
}

void smr_target_begin(smr_judgement *j)
{
    const smr_forces *f = &j->s->forces;
    const smr_surface *target = f->surface.target[j->structure].surface;
    j->residual = j->mean = (smr_mean){0, 0};
    j->n_listed = 0;
    if (smr_judged(j)->n_vertices == 0u)
        j->by = SMR_BY_NOTHING;
    else if (target != NULL)
        j->by = smr_is_cloud(target) ? SMR_BY_CLOUD : SMR_BY_SURFACE;
    else if (smr_image_on(&f->image))
        j->by = SMR_BY_IMAGE;
    else if (smr_follows_landmarks(j->s, j->structure))
        j->by = SMR_BY_LANDMARKS;
    else
        j->by = smr_caller_has_goals(&f->caller, j->structure) ? SMR_BY_CALLER : SMR_BY_NOTHING;
}

uint32_t smr_places_abreast(const void *job) { return (void)job, SMR_JUDGE_PLACES; }

/* Adds the structure's residual to the measures, and sets the distance up to which the target counts as covered. */
static void add_residual(smr_judgement *j)
{
    const float edge = smr_max(smr_le_float(j->s->shared.model->edge_mm), 1.0e-6f);
    j->e.residual.sum += j->residual.sum;
    j->e.residual.weight += j->residual.weight;
    j->near = smr_max(SMR_MEASURE_EDGES * edge, SMR_MEASURE_TIMES * smr_mean_of(j->residual, 0.0f));
}

uint32_t smr_list_tasks(const void *job)
{
    return smr_ceil_div(((const smr_judgement *)job)->s->shared.n, SMR_JUDGE_PIECE);
}

void smr_list_vertices(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_judgement *j = job;
    const smr_piece piece = smr_piece_of(task, SMR_JUDGE_PIECE, j->s->shared.n);
    for (uint32_t v = piece.first; v < piece.last; v++)
        if (smr_model_owner(j->s->shared.model, v) == j->structure)
            smr_judged_list(j)[j->n_listed++] = v;
}

uint32_t smr_visible_tasks(const void *job)
{
    const smr_judgement *j = job;
    return smr_ceil_div(smr_judged(j)->n_vertices, SMR_MEASURE_SEEN);
}

void smr_visible_find(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    const smr_judgement *j = job;
    const smr_piece piece = smr_piece_of(task, SMR_MEASURE_SEEN, smr_judged(j)->n_vertices);
    for (uint32_t i = piece.first; i < piece.last; i++) {
        const uint32_t v = smr_judged_vertex(j, i);
        smr_judged_visible(j->s)[v] = (unsigned char)smr_vertex_visible(j->s, v);
    }
}

/* ---- images ---- */

uint32_t smr_profiles_tasks(const void *job)
{
    const smr_judgement *j = job;
    const int compares = j->verdict != NULL && j->by == SMR_BY_IMAGE && !smr_field_of_past(&j->s->forces.occluded);
    return compares ? smr_ceil_div(smr_min_u32(smr_judged(j)->n_vertices, SMR_LOOKED), SMR_MEASURE_SEEN) : 0u;
}

void smr_profiles_compare(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_judgement *j = job;
    const uint32_t n_vertices = smr_judged(j)->n_vertices, looked = smr_min_u32(n_vertices, SMR_LOOKED);
    const smr_piece piece = smr_piece_of(task, SMR_MEASURE_SEEN, looked);
    smr_mean *const place = smr_judge_place(j, task);
    for (uint32_t k = piece.first; k < piece.last; k++) {
        int32_t wins;
        uint32_t n;
        const uint32_t v = smr_judged_vertex(j, (uint32_t)((uint64_t)k * n_vertices / looked));
        smr_image_compare(&j->s->forces.image, v, &wins, &n);
        if (n > 0u)
            smr_mean_add(&place[0], (float)wins / (float)n, (float)n);
    }
}

void smr_profiles_take(void *job, uint32_t first, uint32_t last)
{
    smr_judgement *j = job;
    smr_judge_take(j, first, last, 0, &j->e.similarity);
}

/* ---- a pass over the structure's vertices ---- */

/* Adds the measures in an image that follow from all vertices. j->mean.weight: number of vertices that it shows. */
static void end_image(smr_judgement *j)
{
    const smr *s = j->s;
    const float n = (float)smr_judged(j)->n_vertices, shown = j->mean.weight;
    if (!(j->e.similarity.weight > 0.0f) && shown > 0.0f && !smr_field_of_past(&s->forces.occluded))
        smr_mean_add(&j->e.similarity, 0.0f, 1.0f); /* without a comparison the similarity counts as chance */
    j->e.n_invisible = smr_judged(j)->n_vertices - (uint32_t)shown;
    const float matched = smr_forces_matched(&s->forces, j->structure);
    if (matched >= 0.0f)
        smr_mean_add(&j->e.goals, matched, shown);
    if (s->forces.surface.target[j->structure].measured)
        smr_mean_add(&j->e.visible, smr_max(matched, 0.0f) * (shown / n), n);
}

/* Adds the distances of the structure's landmarks. Returns their number. */
static uint32_t add_landmarks(smr_judgement *j)
{
    const smr *s = j->s;
    const smr_landmark_goals *g = &s->forces.landmarks;
    uint32_t own = 0;
    for (uint32_t k = 0; k < g->n; k++) {
        if (smr_model_owner(s->shared.model, g->landmark[k].corner[0]) != j->structure)
            continue;
        const smr_vec foot = smr_landmark_foot(g, k, s->shape.x);
        smr_mean_add(&j->residual, smr_length(smr_sub(smr_landmark_goal(g, k), foot)), 1.0f);
        own++;
    }
    return own;
}

/* Adds stored vertex v to the residual and to a mean: of shown or of visible vertices. */
static void add_vertex(smr_judgement *j, uint32_t v)
{
    const smr_forces *f = &j->s->forces;
    const int visible = smr_judged_visible(j->s)[v] & SMR_JUDGED_VISIBLE;
    if (j->by == SMR_BY_IMAGE) {
        smr_mean_add(&j->mean, 1.0f, (float)smr_image_shows(&f->image, v));
        if (f->found_last[v] == SMR_FOUND_GOAL)
            smr_mean_add(&j->residual, f->residual[v], 1.0f);
        return;
    }
    smr_mean_add(&j->mean, (float)visible, 1.0f);
    if (j->by == SMR_BY_SURFACE && visible && smr_judged_distance(j)[v] < SMR_FAR)
        smr_mean_add(&j->residual, smr_judged_distance(j)[v], 1.0f);
    if (j->by == SMR_BY_CALLER && visible)
        smr_mean_add(&j->residual, f->residual[v], 1.0f);
}

uint32_t smr_vertices_tasks(const void *job)
{
    const smr_judgement *j = job;
    return j->by != SMR_BY_NOTHING ? smr_ceil_div(smr_judged(j)->n_vertices, SMR_JUDGE_PIECE) : 0u;
}

void smr_vertices_measure(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_judgement *j = job;
    const smr_piece piece = smr_judged_vertices(j, task);
    for (uint32_t i = piece.first; i < piece.last; i++)
        add_vertex(j, smr_judged_vertex(j, i));
    if (piece.last < smr_judged(j)->n_vertices)
        return;
    const float n = (float)smr_judged(j)->n_vertices;
    if (j->by == SMR_BY_IMAGE)
        end_image(j);
    if (j->by == SMR_BY_LANDMARKS && add_landmarks(j) > 0u)
        smr_mean_add(&j->e.visible, j->mean.sum / n, n);
    if (j->by == SMR_BY_CALLER)
        j->e.visible = j->mean;
    add_residual(j);
}
