/* occluded_field_normals.c: fits the field of occluded vertices to a target that holds vertices along their normals
 * only. A control contributes one number: the distance from the posed start position to its goal along the normal.
 * Displacements along the surface follow from the field, whose three components share one kernel. The field includes
 * the seven motions of a similarity, which are added to the pose and measured from the start, so that the start pose
 * stays where normals do not determine it (the turn of a ball, the size of a flat cap).
 * A control's distance is measured to its goal, not to its position: a field through positions would follow itself and
 * oscillate with momentum. Goals on clouds are taken in full, as the field averages noise itself; those of a tracked
 * cloud, which may lie on the wrong side, are not: there positions count. Each iteration uses other controls; small
 * steps at the last radius average over them.
 * Bounds: those of the field of occluded vertices.
 * SPDX-License-Identifier: MIT */
#include "geometry/box_tree/triangle.h"
#include "options/partial/partial.h"
#include "options/references/references.h"

#define SMR_GOLDEN 2654435769u    /* 2^32 times the golden ratio's fractional part, whose multiples spread evenly */
#define SMR_FIELD_TURN 3u         /* number of positions by which the order of vertices shifts in each iteration */
#define SMR_FIELD_SHEET 0.5f      /* |sum of area vectors| / area above which the model is a sheet */
#define SMR_FIELD_FAR 9.999999e6f /* mm: largest coefficient or pose entry of a field that is not discarded */
#define SMR_TURN_MOST 0.1f        /* smallest value used for 1 + trace(R), a divisor that is 0 at half a turn */
#define SMR_SIZE_MOST 2.0f        /* largest factor by which one solution changes the pose's scale */

uint32_t smr_field_normals_only(const smr_occluded_field *f)
{
    uint32_t open = 0;
    for (uint32_t i = 0; i < f->shared->n_structures; i++)
        open |= (uint32_t)smr_visibility_always_partial(f->goals, i);
    open |= (uint32_t)smr_field_of_part(f);
    return f->shared->config.partial.n_landmarks == 0u && !smr_field_of_image(f) && !f->sheet ? open : 0u;
}

static uint32_t period(uint32_t n)
{
    uint32_t bits = 0;
    while (bits < 31u && 1u << bits < n)
        bits++;
    return 1u << bits;
}

/* Appends visible vertices to control[n] in an order in which one more visible vertex changes one control only. Every
 * k-th visible vertex would change all controls, and badly determined motions would jump. Returns the new n. */
uint32_t smr_field_normals_choose(const smr_occluded_field *f, uint32_t first, uint32_t last, uint32_t *control,
                                  uint32_t n)
{
    const uint32_t all = period(f->shared->n);
    const uint32_t apart = (uint32_t)((uint64_t)all * SMR_GOLDEN >> 32) | 1u; /* odd: each vertex occurs once */
    for (uint32_t i = first; i < smr_min_u32(last, all) && n < f->most; i++) {
        const uint32_t v = (i * apart + SMR_FIELD_TURN * f->schedule->iteration) & (all - 1u);
        if (v < f->shared->n && smr_field_visibility(f, v) > SMR_VISIBLE_ONE / 2u)
            control[n++] = v;
    }
    return n;
}

float smr_field_normals_step(const smr_occluded_field *f)
{
    if (f->schedule->tracking)
        return SMR_FIELD_FOLLOW;
    return smr_at_last_radius(f->shared, f->schedule) ? SMR_FIELD_MEAN : SMR_FIELD_STEP;
}

SMR_SHARED smr_vec smr_field_posed(const smr_occluded_field *f, smr_vec at) { return smr_pose_apply(&f->pose, at); }

/* Returns the array [n_motions] of displacements along the normal of control k by each unit motion. */
static float *motions(const smr_occluded_field *f, uint32_t k) { return f->motion + (size_t)f->n_motions * k; }

void smr_occluded_field_add(const smr_shared *shared, uint32_t first, uint32_t last, smr_vec *sum, float *areas)
{
    for (uint32_t k = first; k < last; k++) {
        const uint32_t *t = smr_model_triangle(shared, k);
        const smr_vec two = smr_triangle_cross(smr_rest(shared, t[0]), smr_rest(shared, t[1]), smr_rest(shared, t[2]));
        *sum = smr_add(*sum, two);
        *areas += smr_length(two);
    }
}

void smr_occluded_field_model(smr_occluded_field *f, float open, float areas)
{
    f->sheet = open > SMR_FIELD_SHEET * areas;
}

SMR_SHARED static float dot(const smr_occluded_field *f, const float *a, const float *b, uint32_t n)
{
    float sum = 0.0f;
    for (uint32_t m = 0; m < SMR_FIELD_MOTIONS; m++)
        sum += a[m] * b[m];
    for (uint32_t m = SMR_FIELD_MOTIONS; SMR_HAS_REFERENCES && m < n; m++)
        sum += f->unit * a[m] * b[m];
    return sum;
}

/* Sets f->back, the motions from the pose back to the start; while targets are tracked, only the change of size. */
static void find_motion_to_start(smr_occluded_field *f, smr_vec middle)
{
    const smr_pose *p = &f->pose;
    const float length = 1.0f / SMR_SQRT(f->per_length2);
    const float scale = smr_length(smr_column(p, 0)), trace = p->m[0][0] + p->m[1][1] + p->m[2][2];
    const smr_vec turn = smr_v(p->m[1][2] - p->m[2][1], p->m[2][0] - p->m[0][2], p->m[0][1] - p->m[1][0]);
    const float half = f->schedule->tracking ? 0.0f : length / smr_max(scale + trace, SMR_TURN_MOST * scale);
    smr_store(f->back, f->schedule->tracking ? smr_v(0, 0, 0) : smr_sub(middle, f->middle));
    smr_store(f->back + 3, smr_scale(turn, 2.0f * half));
    f->back[6] = length * (1.0f / scale - 1.0f);
}

/* Sets control k's motions of references, of stored vertex v, and adds their squares to f->apart2. */
static void add_references(smr_occluded_field *f, uint32_t k, uint32_t v)
{
    static const float whole = 1.0f;
    for (uint32_t i = 0; i < f->shared->n_references; i++) {
        const smr_vec to = smr_field_posed(f, smr_reference_blend(f->shape, v, i, 1, &whole));
        const float along = smr_dot(smr_sub(to, smr_column(&f->pose, 3)), smr_get3(f->shape->normal, v));
        motions(f, k)[SMR_FIELD_MOTIONS + i] = along;
        f->apart2 += along * along;
    }
}

/* Sets the references' weights, at least 0 and with the sum 1, by the solved coefficients f->residual. */
static void take_weights(const smr_occluded_field *f)
{
    float *const more = f->shape->references->more;
    const uint32_t n = f->shared->n_references;
    const float equal = 1.0f / (float)n;
    float sum = FLT_MIN;
    for (uint32_t i = 0; i < n; i++) {
        float change = 0.0f;
        for (uint32_t k = 0; k < f->n; k++)
            change += f->residual[k] * motions(f, k)[SMR_FIELD_MOTIONS + i];
        more[i] = smr_clamp(equal + f->unit * f->motion_variance * change, 0.0f, 1.0f);
        sum += more[i];
    }
    for (uint32_t i = 0; i < n; i++)
        more[i] = more[i] / sum - equal;
}

void smr_field_normals_begin(smr_occluded_field *f, smr_vec middle)
{
    f->middle = smr_field_posed(f, middle);
    f->apart2 = 1.0e-20f; /* mm^2: no division by 0 where all shapes are equal */
    find_motion_to_start(f, middle);
}

void smr_field_normals_residuals(smr_occluded_field *f, const uint32_t *control, uint32_t first, uint32_t last)
{
    const float inverse = SMR_SQRT(f->per_length2);
    for (uint32_t k = first; k < last; k++) {
        const uint32_t v = smr_index(control[k], f->shared->n);
        const smr_vec n = smr_get3(f->shape->normal, v);
        const smr_vec posed = smr_field_posed(f, smr_get3(f->start, k));
        const smr_vec arm = smr_scale(smr_sub(posed, f->middle), inverse), turn = smr_cross(arm, n);
        float *const m = motions(f, k);
        smr_store(m, n);
        smr_store(m + 3, turn);
        m[6] = smr_dot(arm, n);
        const smr_target *const target = &f->goals->target[smr_model_owner(f->shared->model, v)];
        const int cloud = target->surface != NULL && smr_is_cloud(target->surface) && !f->schedule->tracking;
        const smr_vec on = cloud ? smr_points_goal(f->goals, v) : smr_surface_goal_again(f->goals, v);
        const smr_vec goal = smr_add(smr_get3(f->coefficient, k), on);
        f->residual[k] = smr_dot(n, smr_sub(goal, posed)) - dot(f, f->back, m, SMR_FIELD_MOTIONS);
        smr_put3(f->coefficient, k, n);
        if (smr_blends(f->shape))
            add_references(f, k, v);
    }
    /* prior variance of a weight: 1 / (prior * mean square of the references' motions); constant while tracking */
    if (last == f->n && smr_blends(f->shape) && !f->schedule->tracking)
        f->unit = (float)f->n / (SMR_MOTION_VARIANCE * f->shared->config.references.prior * f->apart2);
}

float smr_field_normals_between(const smr_occluded_field *f, uint32_t i, uint32_t j, float kernel)
{
    const float *const a = motions(f, i), *const b = motions(f, j);
    return kernel * smr_dot(smr_load(a), smr_load(b)) + f->motion_variance * dot(f, a, b, f->n_motions);
}

/* Returns v rotated by the Cayley parameter `half`: tan(angle / 2) times the unit axis. Any length is a rotation. */
static smr_vec turned(smr_vec half, smr_vec v)
{
    const smr_vec once = smr_add(v, smr_cross(half, v));
    const float per = 2.0f / (1.0f + smr_dot(half, half));
    return smr_add(v, smr_scale(smr_cross(half, once), per));
}

/* Applies the motions m (shift, turn, scale about f->middle) to the pose. */
static void add_motions(smr_occluded_field *f, const float m[SMR_FIELD_MOTIONS])
{
    const float inverse = SMR_SQRT(f->per_length2);
    const smr_vec half = smr_scale(smr_load(m + 3), 0.5f * inverse);
    const float scale = smr_clamp(1.0f + inverse * m[6], 1.0f / SMR_SIZE_MOST, SMR_SIZE_MOST);
    for (uint32_t c = 0; c < 4u; c++) {
        const smr_vec from = c < 3u ? smr_column(&f->pose, c) : smr_sub(smr_column(&f->pose, c), f->middle);
        smr_vec to = smr_scale(turned(half, from), scale);
        if (c == 3u)
            to = smr_add(smr_add(to, f->middle), smr_load(m));
        f->pose.m[0][c] = to.x;
        f->pose.m[1][c] = to.y;
        f->pose.m[2][c] = to.z;
    }
}

void smr_field_normals_end(smr_occluded_field *f)
{
    float *const sum = f->back;
    for (uint32_t k = 0; k < f->n; k++) {
        float *const to = smr_at3(f->coefficient, k);
        for (uint32_t m = 0; m < SMR_FIELD_MOTIONS; m++)
            sum[m] += f->motion_variance * f->residual[k] * motions(f, k)[m];
        smr_store(to, smr_scale(smr_load(to), f->residual[k]));
    }
    add_motions(f, sum);
    if (smr_blends(f->shape) && f->unit > 0.0f)
        take_weights(f);
    if (!smr_all_within(f->coefficient, 3u * f->n, SMR_FIELD_FAR) || !smr_all_within(f->pose.m[0], 12u, SMR_FIELD_FAR))
        f->n = 0;
}
