/* expected_error_observations.c: chooses the visible vertices whose displacements along their normals tell the expected
 * errors, and measures their noise: how much vertices stick out from their neighbours.
 * Bounds: four passes over a structure's vertices, one over its triangles.
 * SPDX-License-Identifier: MIT */
#include "geometry/box_tree/triangle.h"
#include "geometry/gaussian_process/gaussian_process.h"
#include "verdict/verdict_measures.h"

#define SMR_OBSERVATIONS_LEAST 6u /* fewest observations: a rigid pose alone has six unknowns */
#define SMR_NORMAL_LENGTH 0.5f    /* kernel length divided by the diagonal of the structure's box */
#define SMR_NORMAL_NOISE 0.01f    /* assumed noise variance / field's variance, for the bend and the first size2 */
#define SMR_NOISE_POINTS 0.25f    /* points that a vertex averages in all iterations / points that a goal averages */
#define SMR_NORMAL_MOTIONS 8.0f   /* variance of shift, turn, scale (at a kernel length) / field's variance */

/* Places arrays in the memory of sums and records, which is free between iterations. Returns the number of observations
 * for which there is room. */
static uint32_t place(smr_normal_field *f, const smr *s)
{
    const uint32_t words = smr_min_u32(s->shared.n, 4u * SMR_OBSERVATIONS) * SMR_WORDS;
    uint32_t most = smr_min_u32(SMR_OBSERVATIONS, s->shared.n);
    while (most > 0u && (SMR_FACTOR_WORDS(most) + 8u * most > words || 5u * most > 4u * s->shared.n))
        most--; /* behind the expected errors are four words a vertex for terms of five */
    f->at = (float *)s->overlay.sum;
    f->normal = f->at + 3u * (size_t)most;
    f->moved = f->normal + 3u * (size_t)most;
    f->open = f->moved + most;
    f->lower = f->open + most;
    f->term = (smr_terms *)smr_vertex_expected(s, s->shared.n);
    return most;
}

/* Returns 1 when landmark k lies on the judged structure. */
static int is_marked(const smr_judgement *j, uint32_t k)
{
    const smr *s = j->s;
    return smr_model_owner(s->shared.model, s->forces.landmarks.landmark[k].corner[0]) == j->structure;
}

/* Returns how many landmarks beside a target are observations, each along three axes: at most half of the room. */
static uint32_t n_marked(const smr_judgement *j, uint32_t room)
{
    const smr_landmark_goals *const g = &j->s->forces.landmarks;
    uint32_t n = 0;
    for (uint32_t k = 0; smr_landmarks_on(g) && k < g->n; k++)
        n += (uint32_t)is_marked(j, k);
    return smr_min_u32(n, room / 6u);
}

/* Adds an observation of the displacement from `from` to `to` along a normal. */
static void add_observation(smr_normal_field *f, smr_vec from, smr_vec to, smr_vec normal)
{
    smr_put3(f->at, f->n, from);
    smr_put3(f->normal, f->n, normal);
    smr_put3(f->lower, f->n++, to); /* positions, until the factor needs the memory */
}

/* Between the points of a cloud no vertex is observed. */
static int is_observed(const smr_judgement *j, uint32_t v)
{
    const smr_vec n = smr_get3(j->s->shape.normal, v);
    const uint32_t marks = smr_judged_visible(j->s)[v];
    const int at_point = j->by != SMR_BY_CLOUD || (marks & SMR_JUDGED_POINT);
    return (marks & SMR_JUDGED_VISIBLE) && at_point && smr_dot(n, n) > 0.5f;
}

uint32_t smr_observed_tasks(const void *job)
{
    const smr_judgement *j = job;
    return smr_follows_landmarks(j->s, j->structure) ? 0u : smr_ceil_div(smr_judged(j)->n_vertices, SMR_JUDGE_PIECE);
}

void smr_observed_count(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_judgement *j = job;
    const smr_piece piece = smr_judged_vertices(j, task);
    for (uint32_t i = piece.first; i < piece.last; i++)
        j->field.total += (uint32_t)is_observed(j, smr_judged_vertex(j, i));
}

/* Lists visible vertices, at most as many as there is room for, evenly in stored order, as observations; adds all
 * observed ones to the fit, and all vertices to the box. */
void smr_observe(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_judgement *j = job;
    smr_normal_field *f = &j->field;
    const smr *s = j->s;
    const smr_piece piece = smr_judged_vertices(j, task);
    if (task == 0u) {
        const uint32_t room = place(f, s);
        f->most = smr_min_u32(f->total, room - 3u * n_marked(j, room));
        j->box = (smr_box){{SMR_FAR, SMR_FAR, SMR_FAR}, {-SMR_FAR, -SMR_FAR, -SMR_FAR}};
    }
    for (uint32_t i = piece.first; i < piece.last; i++) {
        const uint32_t v = smr_judged_list(j)[i];
        const smr_vec p = smr_get3(s->shape.start, v), x = smr_get3(s->shape.x, v);
        smr_box_grow(&j->box, p);
        if (!is_observed(j, v))
            continue;
        if (f->met == 0u)
            smr_fit_start(&j->fit, p, x);
        smr_fit_add(&j->fit, p, x, 1.0f);
        if (f->n < f->most && (uint64_t)f->met * f->most >= (uint64_t)f->n * f->total)
            add_observation(f, p, x, smr_get3(s->shape.normal, v));
        f->met++;
    }
}

uint32_t smr_marks_tasks(const void *job)
{
    const smr_judgement *j = job;
    const smr_landmark_goals *const g = &j->s->forces.landmarks;
    return 1u + (smr_landmarks_on(g) && !smr_follows_landmarks(j->s, j->structure) ? g->n : 0u);
}

/* The first task clears what landmarks are still off; each further one adds a landmark of the judged structure. */
void smr_marks_observe(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    static const smr_vec axis[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    smr_judgement *j = job;
    smr_normal_field *f = &j->field;
    const smr_landmark_goals *const g = &j->s->forces.landmarks;
    if (task == 0u)
        f->marked2 = 0.0f;
    if (task == 0u || f->n < SMR_OBSERVATIONS_LEAST || !is_marked(j, task - 1u))
        return;
    const uint32_t room = place(f, j->s), n = n_marked(j, room);
    if (f->n + 3u > f->most + 3u * n) /* at most the room for observations */
        return;
    const smr_vec from = smr_landmark_foot(g, task - 1u, j->s->shape.start),
                  to = smr_landmark_foot(g, task - 1u, j->s->shape.x),
                  off = smr_sub(smr_landmark_goal(g, task - 1u), to);
    for (uint32_t c = 0; c < 3u; c++)
        add_observation(f, from, to, axis[c]);
    f->marked2 += smr_dot(off, off) / (float)n;
}

/* Prepares the process: the pose, observed displacements, and assumed noise. Landmarks: solves their field. */
void smr_field_begin(void *job, SMR_UNUSED uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_judgement *j = job;
    smr_normal_field *f = &j->field;
    j->bend2 = -1.0f;
    j->mean = (smr_mean){0, 0};
    if (smr_follows_landmarks(j->s, j->structure)) {
        j->through = j->s->forces.occluded;
        j->bend2 = smr_landmark_field_solve(&j->through);
    }
    if (f->n < SMR_OBSERVATIONS_LEAST) {
        f->n = 0;
        return;
    }
    const float length = smr_max(SMR_NORMAL_LENGTH * smr_length(smr_sub(j->box.hi, j->box.lo)), 1.0e-6f);
    f->per_length2 = 1.0f / (length * length);
    f->middle = smr_scale(smr_add(j->box.lo, j->box.hi), 0.5f);
    f->motions = j->s->forces.occluded.sheet ? 0.0f : SMR_NORMAL_MOTIONS; /* a sheet's borders determine its motion */
    f->noise = SMR_NORMAL_NOISE;
    f->image_part = j->e.n_invisible > 0u;
    f->pose = smr_fit_solve(&j->fit, 0);
    for (uint32_t i = 0; i < f->n; i++) {
        const smr_vec posed = smr_pose_apply(&f->pose, smr_get3(f->at, i)), normal = smr_get3(f->normal, i);
        f->moved[i] = smr_dot(smr_sub(smr_get3(f->lower, i), posed), normal);
        smr_put3(f->normal, i, smr_pose_turn_back(&f->pose, normal));
    }
}

/* ---- noise variance of visible vertices, mm^2: squared difference, along the normal, of a vertex' displacement from
 * the posed start and the mean of its neighbours'. Six neighbours add a sixth of the variance. ---- */

uint32_t smr_noise_tasks(const void *job)
{
    const smr_judgement *j = job;
    return j->field.n > 0u ? smr_ceil_div(smr_judged(j)->n_vertices, SMR_JUDGE_PIECE) : 0u;
}

/* Writes displacements from the posed start, and clears the sums over neighbours. */
void smr_noise_begin(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    const smr_judgement *j = job;
    const smr *s = j->s;
    const smr_piece piece = smr_judged_vertices(j, task);
    for (uint32_t i = piece.first; i < piece.last; i++) {
        const uint32_t v = smr_judged_list(j)[i];
        const smr_vec posed = smr_pose_apply(&j->field.pose, smr_get3(s->shape.start, v));
        smr_put3(s->overlay.rings.displacement, v, smr_sub(smr_get3(s->shape.x, v), posed));
        smr_put3(s->overlay.rings.sum, v, smr_v(0, 0, 0));
        s->overlay.rings.weight[v] = 0.0f;
    }
}

uint32_t smr_noise_rings_tasks(const void *job)
{
    const smr_judgement *j = job;
    return j->field.n > 0u ? smr_ceil_div(smr_judged(j)->tree.n_triangles, SMR_JUDGE_PIECE) : 0u;
}

void smr_noise_rings_add(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    const smr_judgement *j = job;
    const smr_rings *rings = &j->s->overlay.rings;
    const smr_piece piece = smr_judged_triangles(j, task);
    for (uint32_t k = piece.first; k < piece.last; k++)
        smr_ring_add(rings, smr_triangle_of(smr_judged(j)->tree.triangle, k, j->s->shared.n), rings->displacement);
}

/* Returns the share of the variance of a cloud's noise that is left: vertices follow the mean of several points. */
static float after_averaging(const smr_judgement *j)
{
    const float smoothed = smr_noise_smoothed(&j->s->evolve.tangent_smooth, j->structure);
    const float averaged =
        SMR_NOISE_POINTS * smoothed * smr_points_in_reach(&j->s->forces.surface.target[j->structure]);
    return j->by == SMR_BY_CLOUD ? 1.0f / (1.0f + averaged) : 1.0f;
}

/* Adds the noise of visible vertices; the last task sets the noise variance. */
void smr_noise_add(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_judgement *j = job;
    const smr_rings *rings = &j->s->overlay.rings;
    const smr_piece piece = smr_judged_vertices(j, task);
    const float residual = smr_mean_of(j->e.residual, 0.0f);
    for (uint32_t i = piece.first; i < piece.last; i++) {
        const uint32_t v = smr_judged_list(j)[i];
        if (!(rings->weight[v] > 0.0f) || !is_observed(j, v))
            continue;
        const smr_vec mean = smr_scale(smr_get3(rings->sum, v), 1.0f / rings->weight[v]);
        const float out = smr_dot(smr_sub(smr_get3(rings->displacement, v), mean), smr_get3(j->s->shape.normal, v));
        smr_mean_add(&j->mean, out * out * (6.0f / 7.0f), 1.0f);
    }
    j->field.noise2 = smr_mean_of(j->mean, 0.0f) + residual * residual * after_averaging(j);
}
