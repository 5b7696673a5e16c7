/* unseen_field.c: vertices that the target does not show follow those that it does. These, too, go with the field along
 * the surface, where goals say nothing: patches that lie apart would slide, each for itself. Some of the seen vertices
 * are controls: a rigid pose lays their start positions onto the present ones, and a smooth field adds what the pose
 * leaves. Far from all controls only the pose is left. The field is a regression by a kernel (Gaussian process;
 * Rasmussen and Williams 2006, chapter 2) with k(d) = 1 / (1 + d^2 / l^2), solved by Cholesky decomposition. While
 * clusters are large it is held stiff, for then the controls are not yet where they belong.
 * While images are followed every vertex with a goal is seen, whatever draws it. Without the field a structure slides
 * along itself while images come: nothing but its ends holds it there, and profiles err about those. One that has
 * strayed farther than clusters and edges reach has found what is not its own, and would carry others along: unseen.
 * An image of the past shows where its vertices were. From there the field of what else is followed carries them.
 * Landmarks are controls whose places are given. What is observed of one is the mean of its triangle's corners. So that
 * the field passes exactly by a hard one, what it may be off is not noise, but a second field of short reach.
 * Bounds: two tasks for each SMR_LOOK vertices, and as many and 2 as controls, of their square multiplications.
 * SPDX-License-Identifier: MIT */
#include "options/partial/partial.h"

#define SMR_FIELD_LENGTH 0.4f  /* kernel length over the diagonal of the model's box */
#define SMR_FIELD_NORMAL 0.02f /* the same along its normal: there are more of them */
#define SMR_FIELD_STIFF 4.0f   /* times (cluster radius / kernel length)^2, added to it */
#define SMR_FIELD_PART 8u      /* vertices for a control along its normal */
#define SMR_FIELD_LEAST 4u     /* controls: with fewer vertices there is no field, with fewer landmarks no scale */
#define SMR_LOOK 2048u         /* vertices of a task that counts or chooses controls */
#define SMR_FIELD_HARD 1.0e-5f /* of the variance: what a hard landmark may be off */

/* What is kept while controls are chosen, in the memory of the factor. */
typedef struct smr_choice {
    uint32_t control[SMR_FIELD_ROWS]; /* stored vertices */
    uint32_t n;                       /* of them so far */
    uint32_t total, passed;           /* seen vertices: all, and those looked at */
} smr_choice;

_Static_assert(sizeof(smr_choice) <= SMR_FACTOR_WORDS(SMR_CONTROLS) * sizeof(float), "it lies over the factor");

/* Controls that there is room for: along normals as many as a model needs, so that its sums are no smaller. */
static uint32_t most_of(const smr_shared *shared)
{
    const uint32_t n_landmarks = shared->config.partial.n_landmarks;
    const uint32_t rows = smr_min_u32(smr_max_u32(shared->n / SMR_FIELD_PART, SMR_CONTROLS), SMR_FIELD_ROWS);
    return n_landmarks > 0u ? SMR_CONTROLS + n_landmarks : rows;
}

size_t smr_unseen_field_words(const smr_shared *shared)
{
    const size_t most = most_of(shared);
    if (shared->config.partial.n_landmarks == 0u && shared->config.partial.coverage == SMR_COVERAGE_WHOLE &&
        !smr_follows_images(shared))
        return 0;
    return (9u + SMR_FIELD_MOTIONS) * most + SMR_FACTOR_WORDS(most);
}

void smr_unseen_field_wire(smr_unseen_field *f, const smr_shared *shared, const smr_pace *pace, const smr_shape *shape,
                           const smr_surface_goals *goals, const smr_landmark_goals *landmarks,
                           const smr_overlay *overlay)
{
    f->shared = shared;
    f->pace = pace;
    f->shape = shape;
    f->goals = goals;
    f->landmarks = landmarks;
    f->most = most_of(shared);
    f->start = (float *)overlay->sum;
    f->bend = f->start + 3u * f->most;
    f->loose = f->bend + 3u * f->most;
    f->left = f->loose + f->most;
    f->told = f->left + f->most;
    f->motion = f->told + f->most;
    f->lower = f->motion + SMR_FIELD_MOTIONS * f->most;
}

void smr_unseen_field_watch(smr_unseen_field *f, const uint8_t *found, const uint32_t *has_image)
{
    f->found = found;
    f->has_image = has_image;
}

static uint32_t seen(const smr_unseen_field *f, uint32_t v)
{
    const smr_target *const target = &f->goals->target[smr_model_owner(f->shared->model, v)];
    if (smr_field_of_past(f) && target->surface == NULL)
        return 0u;
    if (f->landmarks->n > 0u)
        return f->landmarks->seen[v];
    if (!smr_field_of_image(f) || (target->partial && !smr_field_of_rest(f, v)))
        return f->goals->seen[v];
    return f->found[v] == SMR_FOUND_GOAL ? SMR_SEEN_ONE : 0u;
}

/* 1 where each vertex has to be asked; otherwise structures know how many are seen. */
static int counts(const smr_unseen_field *f) { return f->landmarks->n > 0u || smr_field_of_image(f); }

static smr_choice *choice(const smr_unseen_field *f) { return (smr_choice *)(void *)f->lower; }

static uint32_t looks(const smr_unseen_field *f) { return smr_ceil_div(f->shared->n, SMR_LOOK); }

/* Counts what is seen. */
static void count_seen(smr_unseen_field *f, uint32_t task)
{
    smr_choice *c = choice(f);
    const uint32_t end = smr_min_u32((task + 1u) * SMR_LOOK, f->shared->n);
    if (task == 0u) {
        c->n = c->total = c->passed = 0;
        f->by_normals = smr_field_normals_only(f);
    }
    for (uint32_t i = 0; task == 0u && !counts(f) && i < f->shared->n_structures; i++)
        c->total += f->goals->target[i].n_seen;
    for (uint32_t v = task * SMR_LOOK; counts(f) && v < end; v++)
        c->total += seen(f, v) > SMR_SEEN_ONE / 2u;
}

/* Vertices that are controls, behind the landmarks: every so many of the seen ones in stored order, which winds through
 * the whole model. Not of the active ones alone: a budget may leave more out after this step, and a replay knows that
 * before. */
static void choose(smr_unseen_field *f, uint32_t task)
{
    smr_choice *c = choice(f);
    const uint32_t end = smr_min_u32((task + 1u) * SMR_LOOK, f->shared->n);
    const uint32_t wanted = smr_min_u32(c->total, SMR_CONTROLS);
    if (f->by_normals) {
        c->n = smr_field_normals_choose(f, 2u * task * SMR_LOOK, 2u * (task + 1u) * SMR_LOOK, c->control, c->n);
        return;
    }
    for (uint32_t v = task * SMR_LOOK; v < end && c->n < wanted; v++) {
        if (seen(f, v) <= SMR_SEEN_ONE / 2u)
            continue;
        if ((uint64_t)c->passed * wanted >= (uint64_t)c->n * c->total)
            c->control[c->n++] = v;
        c->passed++;
    }
}

/* Notes a control and adds it to the pose. */
static void add_control(smr_unseen_field *f, uint32_t k, smr_vec from, smr_vec to, float weight, smr_fit *fit)
{
    smr_store(smr_at3(f->start, k), from);
    smr_store(smr_at3(f->bend, k), to);
    smr_fit_add(fit, from, to, weight);
}

static void add_landmarks(smr_unseen_field *f, smr_fit *fit)
{
    const smr_landmark_goals *g = f->landmarks;
    for (uint32_t k = 0; k < g->n; k++) {
        const float weight = smr_field_hard(f, k) ? 1.0f : g->landmark[k].given.weight;
        const smr_vec to = smr_add(smr_landmark_goal(g, k), g->landmark[k].more);
        add_control(f, k, smr_landmark_foot(g, k, smr_field_start(f)), to, weight, fit);
        f->loose[k] = smr_field_hard(f, k) ? SMR_FIELD_HARD : SMR_FIELD_LOOSE / weight;
    }
}

static void add_seen(smr_unseen_field *f, const uint32_t *control, float ratio, smr_fit *fit)
{
    const float loose = f->by_normals ? SMR_FIELD_NORMAL : SMR_FIELD_LOOSE, one = (float)SMR_SEEN_ONE;
    for (uint32_t k = f->landmarks->n; k < f->n; k++) {
        const uint32_t v = control[k - f->landmarks->n];
        const float counts = f->by_normals ? 2.0f * (float)seen(f, v) - one : (float)seen(f, v);
        add_control(f, k, smr_load(smr_at3(smr_field_start(f), v)), smr_load(smr_at3(f->shape->x, v)), 1.0f, fit);
        f->loose[k] = (loose + SMR_FIELD_STIFF * ratio * ratio) * one / counts;
    }
}

/* The pose, and what it leaves, of landmarks and of n chosen vertices. */
static void begin(smr_unseen_field *f, uint32_t n)
{
    smr_fit fit;
    const smr_box box = f->pace->tracking ? f->shape->held->box : f->shape->start_box;
    const float length = smr_max(SMR_FIELD_LENGTH * smr_length(smr_sub(box.hi, box.lo)), 1.0e-6f);
    const smr_vec middle = smr_scale(smr_add(box.lo, box.hi), 0.5f);
    f->per_length2 = 1.0f / (length * length);
    f->rough = f->rough_loose = 0.0f;
    f->n = f->landmarks->n > 0u || n >= SMR_FIELD_LEAST ? f->landmarks->n + n : 0u;
    smr_fit_start(&fit, middle, middle);
    add_landmarks(f, &fit);
    add_seen(f, choice(f)->control, f->pace->lists.radius / length, &fit);
    f->pose = smr_fit_solve(&fit, f->n >= SMR_FIELD_LEAST);
    if (f->by_normals)
        smr_field_normals_begin(f, choice(f)->control, middle);
    for (uint32_t k = 0; !f->by_normals && k < f->n; k++) {
        const smr_vec posed = smr_pose_apply(&f->pose, smr_load(smr_at3(f->start, k)));
        smr_store(smr_at3(f->bend, k), smr_sub(smr_load(smr_at3(f->bend, k)), posed));
    }
}

/* Column j of the Cholesky factor. What is left on the diagonal is no smaller than what its differences are off by. */
static void factor(smr_unseen_field *f, uint32_t j)
{
    float least = 0.5f * smr_min(f->loose[j], SMR_FIELD_LOOSE);
    for (uint32_t i = j; i < f->n; i++) {
        const float both = smr_unseen_field_between(f, i, j);
        least = i == j ? smr_max(least, SMR_FIELD_ROUNDED * both) : least;
        smr_factor_set(f->lower, i, j, both + (i == j ? f->loose[i] + f->rough_loose : 0.0f), least);
    }
}

uint32_t smr_unseen_field_tasks(const void *arg)
{
    const smr_unseen_field *f = arg;
    return f->goals->partial || counts(f) ? 2u * looks(f) + SMR_FIELD_TRIES * SMR_TRY_TASKS + f->most + 2u : 0u;
}

/* bend = (L L^T)^-1 bend */
static void solve(smr_unseen_field *f)
{
    smr_solve_forward3(f->lower, f->n, f->bend);
    smr_solve_back3(f->lower, f->n, f->bend);
}

void smr_unseen_field_solve(void *arg, uint32_t task, uint32_t worker)
{
    smr_unseen_field *f = arg;
    const uint32_t first = looks(f), tries = 2u * first, then = tries + SMR_FIELD_TRIES * SMR_TRY_TASKS;
    (void)worker;
    if (task < first)
        count_seen(f, task);
    else if (task < tries)
        choose(f, task - first);
    else if (task == tries)
        begin(f, choice(f)->n);
    else if (task <= then)
        smr_field_roughness_try(f, task - tries - 1u);
    else if (task - then <= f->n)
        factor(f, task - then - 1u);
    else if (task - then == f->most + 1u && f->by_normals)
        smr_field_normals_end(f);
    else if (task - then == f->most + 1u)
        solve(f);
}

smr_vec smr_unseen_field_way(const smr_unseen_field *f, uint32_t v)
{
    const smr_vec from = smr_load(smr_at3(smr_field_start(f), v)), x = smr_load(smr_at3(f->shape->x, v));
    if (f->n == 0u)
        return smr_v(0, 0, 0);
    smr_vec to = smr_pose_apply(&f->pose, from);
    for (uint32_t k = 0; k < f->n; k++)
        to = smr_add(to, smr_scale(smr_load(smr_at3(f->bend, k)), smr_field_with_control(f, from, k, smr_field_hard(f, k))));
    return smr_sub(to, x);
}

static smr_vec mix(smr_vec a, smr_vec b, float share)
{
    return smr_add(smr_scale(a, 1.0f - share), smr_scale(b, share));
}

float smr_unseen_field_prevails(const smr_unseen_field *f, uint32_t v)
{
    float share = 0.0f;
    for (uint32_t k = 0; k < f->landmarks->n; k++)
        if (smr_field_hard(f, k))
            share = smr_max(share, smr_landmark_prevails(f->landmarks, k, v));
    return share;
}

/* What is left of a way along the surface at v. */
static smr_vec along(const smr_unseen_field *f, uint32_t v, smr_vec way)
{
    const smr_vec normal = smr_load(smr_at3(f->shape->normal, v));
    return smr_sub(way, smr_scale(normal, smr_dot(normal, way)));
}

/* Beside an image a structure that is shown nearly whole holds itself along its surface: at a joint the field of all
 * would draw one along with the next. Landmarks say what a surface cannot. */
void smr_unseen_field_blend(const smr_unseen_field *f, uint32_t v, int has_goal, smr_vec *way)
{
    const float share = smr_overlap_shown(f->goals, v, has_goal);
    const int holds = smr_field_of_image(f) && f->landmarks->n == 0u;
    const float slides = holds ? smr_overlap_part(f->goals, v) : 1.0f;
    const smr_vec by_field = smr_scale(smr_unseen_field_way(f, v), f->by_normals ? smr_field_normals_step(f) : 1.0f);
    *way = mix(by_field, smr_add(*way, smr_scale(along(f, v, by_field), slides)), share);
    smr_unseen_field_prevail(f, v, way);
}

int smr_unseen_field_steady(const smr_unseen_field *f, uint32_t v, int seen, smr_vec *way)
{
    const smr_vec by_field = smr_unseen_field_way(f, v);
    const float most = smr_max(f->pace->lists.radius, smr_le_float(f->shared->model->edge_mm));
    seen = seen == SMR_GOAL && smr_length(by_field) > most ? SMR_NO_GOAL : seen;
    *way = seen == SMR_GOAL ? smr_add(*way, along(f, v, by_field)) : by_field;
    return seen;
}

void smr_unseen_field_prevail(const smr_unseen_field *f, uint32_t v, smr_vec *way)
{
    const float hard = smr_unseen_field_prevails(f, v);
    if (hard > 0.0f)
        *way = mix(*way, smr_unseen_field_way(f, v), hard);
}

/* The square of the distance at the start to the nearest of controls first .. last - 1, mm^2. */
static float nearest(const smr_unseen_field *f, smr_vec at, uint32_t first, uint32_t last)
{
    float least = SMR_FAR;
    for (uint32_t k = first; k < last; k++) {
        const smr_vec d = smr_sub(at, smr_load(smr_at3(f->start, k)));
        least = smr_min(least, smr_dot(d, d));
    }
    return least;
}

void smr_unseen_field_fill(const smr_unseen_field *f, uint32_t v, smr_vec *way)
{
    const smr_vec at = smr_load(smr_at3(smr_field_start(f), v));
    const float landmark = nearest(f, at, 0, f->landmarks->n), vertex = nearest(f, at, f->landmarks->n, f->n);
    const float share = vertex < SMR_FAR ? vertex / smr_max(vertex + landmark, FLT_MIN) : 1.0f;
    *way = mix(*way, smr_unseen_field_way(f, v), share);
}

float smr_landmark_field_solve(smr_unseen_field *f)
{
    float sum = 0.0f;
    begin(f, 0);
    for (uint32_t j = 0; j < f->n; j++)
        factor(f, j);
    smr_solve_forward3(f->lower, f->n, f->bend);
    for (uint32_t i = 0; i < f->n; i++) /* y^T K^-1 y is |L^-1 y|^2 */
        sum += smr_dot(smr_load(smr_at3(f->bend, i)), smr_load(smr_at3(f->bend, i)));
    return f->n < SMR_FIELD_LEAST ? -1.0f : sum / (3.0f * (float)f->n);
}

float smr_landmark_field_left(const smr_unseen_field *f, uint32_t v)
{
    const smr_vec at = smr_load(smr_at3(smr_field_start(f), v));
    float known[SMR_CONTROLS_MAX], left = 1.0f;
    for (uint32_t i = 0; i < f->n; i++) {
        const float with = smr_field_with_control(f, at, i, smr_field_hard(f, i));
        known[i] = smr_solve_row(smr_field_row(f, i), i, known, with);
        left -= known[i] * known[i];
    }
    return smr_max(left, 0.0f);
}
