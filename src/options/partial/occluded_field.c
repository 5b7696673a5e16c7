/* occluded_field.c: a smooth field moves occluded vertices with visible ones, and visible vertices along the surface,
 * where goals determine nothing. Some visible vertices and all landmarks are controls: a rigid pose maps their start
 * positions onto the present ones, and a Gaussian process interpolates the residuals (kernel 1 / (1 + d^2 / l^2),
 * Cholesky factor; Rasmussen and Williams 2006, chapter 2). Far from controls only the pose remains. Noise is larger
 * while clusters are large, since controls are not yet in place.
 * While images are tracked, all vertices with a goal count as visible: an image does not hold a structure along itself.
 * A vertex farther from the field than the cluster radius or an edge is an outlier. An outdated image's field follows
 * newer targets.
 * Bounds: two tasks for each SMR_LOOK vertices, four for each SMR_FIELD_CHUNK controls, and one for each control, of
 * its square in multiplications.
 * SPDX-License-Identifier: MIT */
#include "geometry/gaussian_process/gaussian_process.h"
#include "options/partial/partial.h"
#include "options/references/references.h"

#define SMR_FIELD_LENGTH 0.4f  /* length of the kernel / diagonal of the model's box */
#define SMR_FIELD_NORMAL 0.02f /* noise variance of a control along its normal / variance of the field */
#define SMR_FIELD_STIFF 4.0f   /* noise variance added to controls / (cluster radius / kernel length)^2 */
#define SMR_FIELD_PART 8u      /* smallest number of model vertices per control, above SMR_CONTROLS controls */
#define SMR_FIELD_LEAST 4u     /* least number of controls for a field of vertices, and for a scale other than 1 */
#define SMR_LOOK 512u          /* number of vertices that one task looks at to count or choose controls */
#define SMR_FIELD_CHUNK 4u     /* number of controls in a task, except in the Cholesky factor's, a column each */
#define SMR_FIELD_HARD 1.0e-5f /* noise variance of a hard landmark / variance of the field */

/* State of the choice of controls, in the memory of the Cholesky factor, which is computed later. */
typedef struct smr_choice {
    uint32_t control[SMR_FIELD_ROWS]; /* [n] stored vertices that are controls */
    uint32_t n;                       /* number of controls chosen so far */
    uint32_t total, passed;           /* number of visible vertices; number of visible vertices already looked at */
} smr_choice;

_Static_assert(sizeof(smr_choice) <= SMR_FACTOR_WORDS(SMR_CONTROLS) * sizeof(float), "the choice lies over the factor");

/* Returns the largest number of controls, which without landmarks grows with the model, as the sums' memory does. */
static uint32_t most_of(const smr_shared *shared)
{
    const uint32_t n_landmarks = shared->config.partial.n_landmarks;
    const uint32_t rows = smr_min_u32(smr_max_u32(shared->n / SMR_FIELD_PART, SMR_CONTROLS), SMR_FIELD_ROWS);
    return n_landmarks > 0u ? SMR_CONTROLS + n_landmarks : rows;
}

size_t smr_occluded_field_words(const smr_shared *shared)
{
    const size_t most = most_of(shared);
    if (shared->config.partial.n_landmarks == 0u && shared->config.partial.coverage == SMR_COVERAGE_WHOLE &&
        !smr_follows_images(shared))
        return 0;
    return (9u + SMR_FIELD_MOTIONS + shared->n_references) * most + SMR_FACTOR_WORDS(most);
}

void smr_occluded_field_wire(smr_occluded_field *f, const smr_overlay *overlay)
{
    f->most = most_of(f->shared);
    f->start = (float *)overlay->sum;
    f->coefficient = f->start + 3u * f->most;
    f->noise_variance = f->coefficient + 3u * f->most;
    f->residual = f->noise_variance + f->most;
    f->whitened = f->residual + f->most;
    f->motion = f->whitened + f->most;
    f->n_motions = SMR_FIELD_MOTIONS + f->shared->n_references;
    f->lower = f->motion + f->n_motions * f->most;
}

/* Returns 1 when visible vertices must be counted for the field; otherwise smr_target.n_visible holds their number. */
static int counts(const smr_occluded_field *f)
{
    return f->landmarks->n > 0u || smr_field_of_image(f) || smr_field_of_part(f);
}

static smr_choice *choice(const smr_occluded_field *f) { return (smr_choice *)(void *)f->lower; }

static uint32_t looks(const smr_occluded_field *f) { return smr_ceil_div(f->shared->n, SMR_LOOK); }

static void count_visible(smr_occluded_field *f, uint32_t task)
{
    smr_choice *c = choice(f);
    const uint32_t end = smr_min_u32((task + 1u) * SMR_LOOK, f->shared->n);
    if (task == 0u) {
        c->n = c->total = c->passed = 0;
        f->by_normals = smr_field_normals_only(f);
    }
    for (uint32_t i = 0; task == 0u && !counts(f) && i < f->shared->n_structures; i++)
        c->total += f->goals->target[i].n_visible;
    for (uint32_t v = task * SMR_LOOK; counts(f) && v < end; v++)
        c->total += smr_field_visibility(f, v) > SMR_VISIBLE_ONE / 2u;
}

/* Chooses controls: every k-th visible vertex in stored order, which runs through the whole model. Inactive vertices
 * may be chosen, too: a budget may change their number, which a replay does not know. */
static void choose(smr_occluded_field *f, uint32_t task)
{
    smr_choice *c = choice(f);
    const uint32_t end = smr_min_u32((task + 1u) * SMR_LOOK, f->shared->n);
    const uint32_t wanted = smr_min_u32(c->total, SMR_CONTROLS);
    if (f->by_normals) {
        c->n = smr_field_normals_choose(f, 2u * task * SMR_LOOK, 2u * (task + 1u) * SMR_LOOK, c->control, c->n);
        return;
    }
    for (uint32_t v = task * SMR_LOOK; v < end && c->n < wanted; v++) {
        if (smr_field_visibility(f, v) <= SMR_VISIBLE_ONE / 2u)
            continue;
        if ((uint64_t)c->passed * wanted >= (uint64_t)c->n * c->total)
            c->control[c->n++] = v;
        c->passed++;
    }
}

/* Stores start position `from` and present position or goal `to` of control k, mm. Adds both to the fit of the pose. */
static void add_control(smr_occluded_field *f, uint32_t k, smr_vec from, smr_vec to, float weight, smr_fit *fit)
{
    smr_put3(f->start, k, from);
    smr_put3(f->coefficient, k, to);
    smr_fit_add(fit, from, to, weight);
}

static void add_landmark(smr_occluded_field *f, uint32_t k)
{
    const smr_landmark_goals *g = f->landmarks;
    const float weight = smr_field_hard(f, k) ? 1.0f : g->landmark[k].given.weight;
    const smr_vec now = smr_landmark_foot(g, k, f->shape->x), left = smr_sub(smr_landmark_goal(g, k), now);
    const smr_vec to = smr_add(smr_add(now, smr_scale(left, smr_landmark_share(g, k))), g->landmark[k].more);
    add_control(f, k, smr_landmark_foot(g, k, smr_field_start(f)), to, weight, &f->fit);
    f->noise_variance[k] = smr_field_hard(f, k) ? SMR_FIELD_HARD : SMR_FIELD_NOISE / weight;
}

/* Makes vertex v control k. ratio: cluster radius / length of the kernel. */
static void add_vertex(smr_occluded_field *f, uint32_t k, uint32_t v, float ratio)
{
    const float noise_variance = f->by_normals ? SMR_FIELD_NORMAL : SMR_FIELD_NOISE, one = (float)SMR_VISIBLE_ONE;
    const float shown = (float)smr_field_visibility(f, v), counts = f->by_normals ? 2.0f * shown - one : shown;
    add_control(f, k, smr_get3(smr_field_start(f), v), smr_get3(f->shape->x, v), 1.0f, &f->fit);
    f->noise_variance[k] = (noise_variance + SMR_FIELD_STIFF * ratio * ratio) * one / counts;
}

/* Returns the centre of the box around the start, mm. */
static smr_vec middle_of(const smr_occluded_field *f)
{
    const smr_box box = f->schedule->tracking ? f->shape->track_rest->box : f->shape->start_box;
    return smr_scale(smr_add(box.lo, box.hi), 0.5f);
}

/* Returns the length of the kernel, mm. */
static float length_of(const smr_occluded_field *f)
{
    const smr_box box = f->schedule->tracking ? f->shape->track_rest->box : f->shape->start_box;
    return smr_max(SMR_FIELD_LENGTH * smr_length(smr_sub(box.hi, box.lo)), 1.0e-6f);
}

/* Sets the number of controls, n vertices and all landmarks, and the length of the kernel. */
static void begin(smr_occluded_field *f, uint32_t n)
{
    const float length = length_of(f);
    f->per_length2 = 1.0f / (length * length);
    f->rough = f->rough_noise = f->unit = 0.0f;
    f->n = f->landmarks->n > 0u || n >= SMR_FIELD_LEAST ? f->landmarks->n + n : 0u;
    smr_fit_start(&f->fit, middle_of(f), middle_of(f));
}

/* Makes controls first .. last - 1 of the landmarks and the chosen vertices. */
static void add_controls(smr_occluded_field *f, uint32_t first, uint32_t last)
{
    const float ratio = f->schedule->lists.radius / length_of(f);
    for (uint32_t k = first; k < last; k++)
        if (k < f->landmarks->n)
            add_landmark(f, k);
        else
            add_vertex(f, k, smr_index(choice(f)->control[k - f->landmarks->n], f->shared->n), ratio);
}

static void fit_pose(smr_occluded_field *f)
{
    f->pose = smr_fit_solve(&f->fit, f->n >= SMR_FIELD_LEAST);
    if (f->by_normals)
        smr_field_normals_begin(f, middle_of(f));
}

static void find_residuals(smr_occluded_field *f, uint32_t first, uint32_t last)
{
    if (f->by_normals)
        smr_field_normals_residuals(f, choice(f)->control, first, last);
    for (uint32_t k = first; !f->by_normals && k < last; k++) {
        const smr_vec posed = smr_field_posed(f, smr_get3(f->start, k));
        smr_put3(f->coefficient, k, smr_sub(smr_get3(f->coefficient, k), posed));
    }
}

/* Computes column j of the Cholesky factor. Diagonal elements are kept above the rounding errors of their sums. */
static void factor(smr_occluded_field *f, uint32_t j)
{
    float least = 0.5f * smr_min(f->noise_variance[j], SMR_FIELD_NOISE);
    for (uint32_t i = j; i < f->n; i++) {
        const float both = smr_occluded_field_between(f, i, j);
        least = i == j ? smr_max(least, SMR_FIELD_ROUNDED * both) : least;
        smr_factor_set(f->lower, i, j, both + (i == j ? f->noise_variance[i] + f->rough_noise : 0.0f), least);
    }
}

/* Returns the number of tasks of a pass over the controls. */
static uint32_t parts(const smr_occluded_field *f) { return smr_ceil_div(f->most, SMR_FIELD_CHUNK); }

uint32_t smr_occluded_field_tasks(const void *arg)
{
    const smr_occluded_field *f = arg;
    const uint32_t n = 2u * looks(f) + 4u * parts(f) + SMR_FIELD_TRIES * SMR_TRY_TASKS + f->most + 1u;
    return f->goals->partial || counts(f) ? n : 0u;
}

/* Runs task `part` of pass 0 .. 3 over the controls: controls, residuals, and both triangular solves. */
static void run_pass(smr_occluded_field *f, uint32_t pass, uint32_t part)
{
    const uint32_t first = smr_min_u32(part * SMR_FIELD_CHUNK, f->n), last = smr_min_u32(first + SMR_FIELD_CHUNK, f->n);
    if (pass == 0u)
        add_controls(f, first, last);
    else if (pass == 1u)
        find_residuals(f, first, last);
    else if (pass == 2u && f->by_normals)
        smr_solve_rows_forward(f->lower, f->n, first, last, f->residual);
    else if (pass == 2u)
        smr_solve_rows_forward3(f->lower, f->n, first, last, f->coefficient);
    else if (f->by_normals)
        smr_solve_rows_back(f->lower, f->n, f->n - last, f->n - first, f->residual);
    else
        smr_solve_rows_back3(f->lower, f->n, f->n - last, f->n - first, f->coefficient);
}

void smr_occluded_field_solve(void *arg, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_occluded_field *f = arg;
    const uint32_t choose_at = looks(f), passes_at = 2u * choose_at, n = parts(f), tries_at = passes_at + 2u * n;
    const uint32_t factor_at = tries_at + SMR_FIELD_TRIES * SMR_TRY_TASKS, solve_at = factor_at + f->most;
    if (task == passes_at)
        begin(f, smr_min_u32(choice(f)->n, f->most - f->landmarks->n));
    if (task == passes_at + n)
        fit_pose(f);
    if (task < choose_at)
        count_visible(f, task);
    else if (task < passes_at)
        choose(f, task - choose_at);
    else if (task < tries_at)
        run_pass(f, (task - passes_at) / n, (task - passes_at) % n);
    else if (task < factor_at)
        smr_field_roughness_try(f, task - tries_at);
    else if (task < solve_at && task - factor_at < f->n)
        factor(f, task - factor_at);
    else if (task >= solve_at && task < solve_at + 2u * n)
        run_pass(f, 2u + (task - solve_at) / n, (task - solve_at) % n);
    else if (task == solve_at + 2u * n && f->by_normals)
        smr_field_normals_end(f);
}

smr_vec smr_occluded_field_displacement(const smr_occluded_field *f, uint32_t v)
{
    const smr_vec from = smr_get3(smr_field_start(f), v), x = smr_get3(f->shape->x, v);
    if (f->n == 0u)
        return smr_v(0, 0, 0);
    smr_vec at = from;
    if (smr_blends(f->shape) && f->unit > 0.0f)
        at = smr_add(at, smr_reference_blend(f->shape, v, 0, f->shared->n_references, f->shape->references->more));
    smr_vec to = smr_field_posed(f, at);
    for (uint32_t k = 0; k < f->n; k++)
        to = smr_add(to,
                     smr_scale(smr_get3(f->coefficient, k), smr_field_with_control(f, from, k, smr_field_hard(f, k))));
    return smr_sub(to, x);
}

smr_vec smr_occluded_field_follow(const smr_occluded_field *f, uint32_t v)
{
    return smr_scale(smr_occluded_field_displacement(f, v), f->by_normals ? smr_field_normals_step(f) : 1.0f);
}

/* Returns the weighted mean of a and b: a has the weight 1 - t, b the weight t, 0..1. */
static smr_vec mix(smr_vec a, smr_vec b, float t) { return smr_add(smr_scale(a, 1.0f - t), smr_scale(b, t)); }

float smr_occluded_field_hard_weight(const smr_occluded_field *f, uint32_t v)
{
    float share = 0.0f;
    for (uint32_t k = 0; k < f->landmarks->n; k++)
        if (smr_field_hard(f, k))
            share = smr_max(share, smr_landmark_hard_weight(f->landmarks, k, v));
    return share;
}

/* Returns the part of a displacement of vertex v that is perpendicular to v's normal, mm. */
static smr_vec along(const smr_occluded_field *f, uint32_t v, smr_vec displacement)
{
    const smr_vec normal = smr_get3(f->shape->normal, v);
    return smr_sub(displacement, smr_scale(normal, smr_dot(normal, displacement)));
}

/* Blends *displacement with the field. With a tracked image and no landmarks visible structures do not slide along. */
void smr_occluded_field_blend(const smr_occluded_field *f, uint32_t v, int has_goal, smr_vec *displacement)
{
    const float share = smr_visibility_of(f->goals, v, has_goal);
    const int holds = smr_field_of_image(f) && f->landmarks->n == 0u;
    const float slides = holds ? smr_visibility_partial(f->goals, v) : 1.0f;
    const smr_vec by_field = smr_occluded_field_follow(f, v);
    *displacement = mix(by_field, smr_add(*displacement, smr_scale(along(f, v, by_field), slides)), share);
    smr_occluded_field_blend_hard(f, v, displacement);
}

int smr_occluded_field_blend_image(const smr_occluded_field *f, uint32_t v, int found, smr_vec *displacement)
{
    const smr_vec by_field = smr_occluded_field_displacement(f, v);
    const float most = smr_max(f->schedule->lists.radius, smr_le_float(f->shared->model->edge_mm));
    found = found == SMR_GOAL && smr_length(by_field) > most ? SMR_NO_GOAL : found;
    *displacement = found == SMR_GOAL ? smr_add(*displacement, along(f, v, by_field)) : by_field;
    return found;
}

void smr_occluded_field_blend_hard(const smr_occluded_field *f, uint32_t v, smr_vec *displacement)
{
    const float hard = smr_occluded_field_hard_weight(f, v);
    if (hard > 0.0f)
        *displacement = mix(*displacement, smr_occluded_field_displacement(f, v), hard);
}

/* Returns the smallest squared distance from `at` to the start positions of controls first .. last - 1, mm^2. */
static float nearest(const smr_occluded_field *f, smr_vec at, uint32_t first, uint32_t last)
{
    float least = SMR_FAR;
    for (uint32_t k = first; k < last; k++)
        least = smr_min(least, smr_distance2(at, smr_get3(f->start, k)));
    return least;
}

void smr_occluded_field_fill(const smr_occluded_field *f, uint32_t v, smr_vec *displacement)
{
    const smr_vec at = smr_get3(smr_field_start(f), v);
    const float landmark = nearest(f, at, 0, f->landmarks->n), vertex = nearest(f, at, f->landmarks->n, f->n);
    const float share = vertex < SMR_FAR ? vertex / smr_max(vertex + landmark, FLT_MIN) : 1.0f;
    *displacement = mix(*displacement, smr_occluded_field_displacement(f, v), share);
}

float smr_landmark_field_solve(smr_occluded_field *f)
{
    float sum = 0.0f;
    begin(f, 0);
    add_controls(f, 0, f->n);
    fit_pose(f);
    find_residuals(f, 0, f->n);
    for (uint32_t j = 0; j < f->n; j++)
        factor(f, j);
    smr_solve_rows_forward3(f->lower, f->n, 0, f->n, f->coefficient);
    for (uint32_t i = 0; i < f->n; i++) /* sums y^T K^-1 y = |L^-1 y|^2, whose mean is the field's variance */
        sum += smr_dot(smr_get3(f->coefficient, i), smr_get3(f->coefficient, i));
    return f->n < SMR_FIELD_LEAST ? -1.0f : sum / (3.0f * (float)f->n);
}

float smr_landmark_field_left(const smr_occluded_field *f, uint32_t v)
{
    const smr_vec at = smr_get3(smr_field_start(f), v);
    float known[SMR_CONTROLS_MAX], left = 1.0f;
    for (uint32_t i = 0; i < f->n; i++) {
        const float with = smr_field_with_control(f, at, i, smr_field_hard(f, i));
        known[i] = smr_solve_row(smr_factor_row(f->lower, i), i, known, with);
        left -= known[i] * known[i];
    }
    return smr_max(left, 0.0f);
}
