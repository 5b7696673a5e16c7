/* unseen_field.c: vertices that the target does not show follow those that it does. These, too, go with the field along
 * the surface, where goals say nothing: patches that lie apart would slide, each for itself. Some of the seen vertices
 * are controls: a rigid pose lays their start positions onto the present ones, and a smooth field adds what the pose
 * leaves. Far from all controls only the pose is left. The field is a regression by a kernel (Gaussian process;
 * Rasmussen and Williams 2006, chapter 2) with k(d) = 1 / (1 + d^2 / l^2), solved by Cholesky decomposition. While
 * clusters are large it is held stiff, for then the controls are not yet where they belong.
 * Bounds: SMR_CONTROLS + 2 tasks, of SMR_CONTROLS^2 multiplications at most; one pass over the vertices for the first.
 * SPDX-License-Identifier: MIT */
#include "runtime/forces/unseen_field.h"

#define SMR_FIELD_LENGTH 0.4f  /* kernel length over the diagonal of the model's box */
#define SMR_FIELD_LOOSE 0.003f /* of the variance: what a control may be off */
#define SMR_FIELD_STIFF 4.0f   /* times (cluster radius / kernel length)^2, added to it */
#define SMR_FIELD_LEAST 4u     /* controls: with fewer there is no field */

size_t smr_unseen_field_words(const smr_shared *shared)
{
    return shared->config.coverage == SMR_COVERAGE_WHOLE ? 0u : 7u * SMR_CONTROLS + SMR_FACTOR_WORDS;
}

void smr_unseen_field_wire(smr_unseen_field *f, const smr_shared *shared, const smr_pace *pace, const smr_shape *shape,
                           const smr_surface_goals *goals, const smr_overlay *overlay)
{
    f->shared = shared;
    f->pace = pace;
    f->shape = shape;
    f->goals = goals;
    f->start = (float *)overlay->sum;
    f->bend = f->start + 3u * SMR_CONTROLS;
    f->loose = f->bend + 3u * SMR_CONTROLS;
    f->lower = f->loose + SMR_CONTROLS;
}

/* Where the field starts: what tracking holds to, or where the registration started. */
static float *start_of(const smr_unseen_field *f) { return f->pace->tracking ? f->shape->held_x : f->shape->start; }

static float *row(const smr_unseen_field *f, uint32_t i) { return f->lower + (size_t)i * (i + 1u) / 2u; }

static float kernel(const smr_unseen_field *f, smr_vec a, smr_vec b)
{
    const smr_vec d = smr_sub(a, b);
    return 1.0f / (1.0f + smr_dot(d, d) * f->per_length2);
}

static int seen(const smr_unseen_field *f, uint32_t v) { return f->goals->seen[v] > SMR_SEEN_ONE / 2u; }

/* The controls: every so many of the seen vertices in stored order, which winds through the whole model. Not of the
 * active ones alone: a budget may leave more out after this step, and a replay knows that before. */
static void choose(smr_unseen_field *f, uint32_t control[SMR_CONTROLS])
{
    uint32_t total = 0, at = 0;
    for (uint32_t i = 0; i < f->shared->n_structures; i++)
        total += f->goals->target[i].n_seen;
    const uint32_t wanted = smr_min_u32(total, SMR_CONTROLS);
    f->n = 0;
    for (uint32_t v = 0; v < f->shared->n && f->n < wanted; v++) {
        if (!seen(f, v))
            continue;
        if ((uint64_t)at * wanted >= (uint64_t)f->n * total)
            control[f->n++] = v;
        at++;
    }
    if (f->n < SMR_FIELD_LEAST)
        f->n = 0;
}

/* The pose, and what it leaves. */
static void begin(smr_unseen_field *f)
{
    uint32_t control[SMR_CONTROLS];
    smr_fit fit;
    const smr_box box = f->pace->tracking ? f->shape->held->box : f->shape->start_box;
    const float length = smr_max(SMR_FIELD_LENGTH * smr_length(smr_sub(box.hi, box.lo)), 1.0e-6f);
    const float ratio = f->pace->lists.radius / length;
    const smr_vec middle = smr_scale(smr_add(box.lo, box.hi), 0.5f);
    f->per_length2 = 1.0f / (length * length);
    choose(f, control);
    smr_fit_start(&fit, middle, middle);
    for (uint32_t k = 0; k < f->n; k++) {
        const smr_vec from = smr_load(smr_at3(start_of(f), control[k]));
        const smr_vec to = smr_load(smr_at3(f->shape->x, control[k]));
        smr_store(smr_at3(f->start, k), from);
        smr_store(smr_at3(f->bend, k), to);
        smr_fit_add(&fit, from, to, 1.0f);
        f->loose[k] = (SMR_FIELD_LOOSE + SMR_FIELD_STIFF * ratio * ratio) * (float)SMR_SEEN_ONE /
                      (float)f->goals->seen[control[k]];
    }
    f->pose = smr_fit_solve(&fit, 1);
    for (uint32_t k = 0; k < f->n; k++) {
        const smr_vec posed = smr_pose_apply(&f->pose, smr_load(smr_at3(f->start, k)));
        smr_store(smr_at3(f->bend, k), smr_sub(smr_load(smr_at3(f->bend, k)), posed));
    }
}

/* Column j of the Cholesky factor. */
static void factor(smr_unseen_field *f, uint32_t j)
{
    const float *const above = row(f, j);
    for (uint32_t i = j; i < f->n; i++) {
        float *const r = row(f, i);
        float sum = kernel(f, smr_load(smr_at3(f->start, i)), smr_load(smr_at3(f->start, j)));
        sum += i == j ? f->loose[i] : 0.0f;
        for (uint32_t k = 0; k < j; k++)
            sum -= r[k] * above[k];
        r[j] = i == j ? SMR_SQRT(smr_max(sum, 0.5f * SMR_FIELD_LOOSE)) : sum / above[j];
    }
}

/* bend = (L L^T)^-1 bend */
static void substitute(smr_unseen_field *f)
{
    for (uint32_t i = 0; i < f->n; i++) {
        smr_vec sum = smr_load(smr_at3(f->bend, i));
        for (uint32_t k = 0; k < i; k++)
            sum = smr_sub(sum, smr_scale(smr_load(smr_at3(f->bend, k)), row(f, i)[k]));
        smr_store(smr_at3(f->bend, i), smr_scale(sum, 1.0f / row(f, i)[i]));
    }
    for (uint32_t i = f->n; i-- > 0u;) {
        smr_vec sum = smr_load(smr_at3(f->bend, i));
        for (uint32_t k = i + 1u; k < f->n; k++)
            sum = smr_sub(sum, smr_scale(smr_load(smr_at3(f->bend, k)), row(f, k)[i]));
        smr_store(smr_at3(f->bend, i), smr_scale(sum, 1.0f / row(f, i)[i]));
    }
}

uint32_t smr_unseen_field_tasks(const void *arg)
{
    return ((const smr_unseen_field *)arg)->goals->partial ? SMR_CONTROLS + 2u : 0u;
}

void smr_unseen_field_solve(void *arg, uint32_t task, uint32_t worker)
{
    smr_unseen_field *f = arg;
    (void)worker;
    if (task == 0u)
        begin(f);
    else if (task <= f->n)
        factor(f, task - 1u);
    else if (task == SMR_CONTROLS + 1u)
        substitute(f);
}

/* The way to where the field carries the vertex, mm. */
static smr_vec carried(const smr_unseen_field *f, uint32_t v)
{
    const smr_vec from = smr_load(smr_at3(start_of(f), v)), x = smr_load(smr_at3(f->shape->x, v));
    if (f->n == 0u)
        return smr_v(0, 0, 0);
    smr_vec to = smr_pose_apply(&f->pose, from);
    for (uint32_t k = 0; k < f->n; k++)
        to = smr_add(to, smr_scale(smr_load(smr_at3(f->bend, k)), kernel(f, from, smr_load(smr_at3(f->start, k)))));
    return smr_sub(to, x);
}

void smr_unseen_field_blend(const smr_unseen_field *f, uint32_t v, smr_vec *way)
{
    const float share = (float)f->goals->seen_next[v] * (1.0f / (float)SMR_SEEN_ONE);
    const smr_vec by_field = carried(f, v), normal = smr_load(smr_at3(f->shape->normal, v));
    const smr_vec along = smr_sub(by_field, smr_scale(normal, smr_dot(normal, by_field)));
    *way = smr_add(smr_scale(smr_add(*way, along), share), smr_scale(by_field, 1.0f - share));
}
