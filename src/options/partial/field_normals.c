/* field_normals.c: the field of unseen vertices through what the target really shows. A surface holds a vertex along
 * its normal only, so a control tells one number: how far it lies from the pose along its normal. What runs along the
 * surface follows from the field, of which each component has the same kernel. Taken as seen, it would keep whatever
 * the start left there. The pose has taken its share of that, too, so the field contains the seven motions of a
 * similarity, and they are added to the pose. They are measured from the start: what normals do not tell, a ball's turn
 * or how large a flat cap is, stays as the start had it, and does not wander from iteration to iteration.
 * How far a control lies from the pose is asked of its goal, not of its place: a field through places follows what
 * follows it, momentum adds to both, and it swings. In each iteration other vertices are controls, so that all of them
 * tell in turn; at the last radius a small step takes the mean.
 * How rough the deformation is: field_roughness.c.
 * Bounds: those of unseen_field.c.
 * SPDX-License-Identifier: MIT */
#include "geometry/box_tree/triangle.h"
#include "options/partial/partial.h"

#define SMR_GOLDEN 2654435769u /* 2^32 times the golden ratio's part: its multiples are even in any first ones */
#define SMR_FIELD_TURN 3u      /* places of the order by which an iteration begins later than the one before */
#define SMR_FIELD_SHEET 0.5f   /* of its area: the sum of area vectors, above which a model is a sheet */
#define SMR_FIELD_FAR 1.0e7f   /* mm: no coordinate is */
#define SMR_TURN_MOST 0.1f     /* of 4: what Cayley's parameter divides by, near half a turn */
#define SMR_SIZE_MOST 2.0f     /* in a step */

/* Landmarks, images and the borders of sheets give places. Without them what is known of a part lies along normals. A
 * closed target that is not covered yet is taken for the whole that it will be: what the start pose gave stays. */
uint32_t smr_field_normals_only(const smr_unseen_field *f)
{
    uint32_t open = 0;
    for (uint32_t i = 0; i < f->shared->n_structures; i++)
        open |= (uint32_t)smr_overlap_lasting(f->goals, i);
    return f->shared->config.partial.n_landmarks == 0u && !smr_field_of_image(f) && !f->sheet ? open : 0u;
}

/* The least power of two from n on. */
static uint32_t period(uint32_t n)
{
    uint32_t bits = 0;
    while (bits < 31u && 1u << bits < n)
        bits++;
    return 1u << bits;
}

/* That one vertex more is seen makes a difference to one control. With every so many of the seen ones it would to all,
 * and what is not determined well would jump. */
uint32_t smr_field_normals_choose(const smr_unseen_field *f, uint32_t first, uint32_t last, uint32_t *control,
                                  uint32_t n)
{
    const uint32_t all = period(f->shared->n);
    const uint32_t apart = (uint32_t)((uint64_t)all * SMR_GOLDEN >> 32) | 1u; /* odd: each place comes once */
    for (uint32_t i = first; i < smr_min_u32(last, all) && n < f->most; i++) {
        const uint32_t v = (i * apart + SMR_FIELD_TURN * f->pace->iteration) & (all - 1u);
        if (v < f->shared->n && f->goals->seen[v] > SMR_SEEN_ONE / 2u)
            control[n++] = v;
    }
    return n;
}

float smr_field_normals_step(const smr_unseen_field *f)
{
    if (f->pace->tracking)
        return SMR_FIELD_FOLLOW;
    return smr_at_last_radius(f->shared, f->pace) ? SMR_FIELD_MEAN : SMR_FIELD_STEP;
}

static float *motions(const smr_unseen_field *f, uint32_t k) { return f->motion + (size_t)SMR_FIELD_MOTIONS * k; }

/* The sum of a structure's area vectors at rest, twice; adds twice its area. */
static smr_vec open_part(const smr_shared *shared, const smr_shape_structure *one, float *area)
{
    const uint32_t first = one->first_triangle, last = first + one->facets.n_triangles;
    smr_vec sum = smr_v(0, 0, 0);
    for (uint32_t k = first; k < last; k++) {
        const uint32_t *t = shared->triangle + 3u * (size_t)k;
        const smr_vec two = smr_triangle_cross(smr_rest(shared, t[0]), smr_rest(shared, t[1]), smr_rest(shared, t[2]));
        sum = smr_add(sum, two);
        *area += smr_length(two);
    }
    return sum;
}

void smr_unseen_field_model(smr_unseen_field *f)
{
    float open = 0.0f, area = 0.0f;
    for (uint32_t i = 0; i < f->shared->n_structures; i++)
        open += smr_length(open_part(f->shared, &f->shape->structure[i], &area));
    f->sheet = open > SMR_FIELD_SHEET * area;
}

static float dot(const float a[SMR_FIELD_MOTIONS], const float b[SMR_FIELD_MOTIONS])
{
    float sum = 0.0f;
    for (uint32_t m = 0; m < SMR_FIELD_MOTIONS; m++)
        sum += a[m] * b[m];
    return sum;
}

static smr_vec column(const smr_pose *p, uint32_t c) { return smr_v(p->m[0][c], p->m[1][c], p->m[2][c]); }

/* The motions that take the pose back to the start; while targets are followed, to its size only. */
static void find_way_back(smr_unseen_field *f, smr_vec middle)
{
    const smr_pose *p = &f->pose;
    const float length = 1.0f / SMR_SQRT(f->per_length2);
    const float scale = smr_length(column(p, 0)), trace = p->m[0][0] + p->m[1][1] + p->m[2][2];
    const smr_vec turn = smr_v(p->m[1][2] - p->m[2][1], p->m[2][0] - p->m[0][2], p->m[0][1] - p->m[1][0]);
    const float half = f->pace->tracking ? 0.0f : length / smr_max(scale + trace, SMR_TURN_MOST * scale);
    smr_store(f->back, f->pace->tracking ? smr_v(0, 0, 0) : smr_sub(middle, f->middle));
    smr_store(f->back + 3, smr_scale(turn, 2.0f * half));
    f->back[6] = length * (1.0f / scale - 1.0f);
}

void smr_field_normals_begin(smr_unseen_field *f, const uint32_t *control, smr_vec middle)
{
    const float inverse = SMR_SQRT(f->per_length2);
    f->middle = smr_pose_apply(&f->pose, middle);
    find_way_back(f, middle);
    for (uint32_t k = 0; k < f->n; k++) {
        const smr_vec n = smr_load(smr_at3(f->shape->normal, control[k]));
        const smr_vec posed = smr_pose_apply(&f->pose, smr_load(smr_at3(f->start, k)));
        const smr_vec arm = smr_scale(smr_sub(posed, f->middle), inverse), turn = smr_cross(arm, n);
        float *const m = motions(f, k);
        smr_store(m, n);
        smr_store(m + 3, turn);
        m[6] = smr_dot(arm, n);
        const smr_vec goal = smr_add(smr_load(smr_at3(f->bend, k)), smr_surface_goal_again(f->goals, control[k]));
        f->left[k] = smr_dot(n, smr_sub(goal, posed)) - dot(f->back, m);
        smr_store(smr_at3(f->bend, k), n);
    }
}

float smr_field_normals_between(const smr_unseen_field *f, uint32_t i, uint32_t j, float kernel)
{
    const float *const a = motions(f, i), *const b = motions(f, j);
    return kernel * smr_dot(smr_load(a), smr_load(b)) + f->motion_variance * dot(a, b);
}

/* v turned by a motion's turn, given as Cayley's parameter: a rotation however large the turn. */
static smr_vec turned(smr_vec half, smr_vec v)
{
    const smr_vec once = smr_add(v, smr_cross(half, v));
    const float per = 2.0f / (1.0f + smr_dot(half, half));
    return smr_add(v, smr_scale(smr_cross(half, once), per));
}

static void add_motions(smr_unseen_field *f, const float m[SMR_FIELD_MOTIONS])
{
    const float inverse = SMR_SQRT(f->per_length2);
    const smr_vec half = smr_scale(smr_load(m + 3), 0.5f * inverse);
    const float scale = smr_clamp(1.0f + inverse * m[6], 1.0f / SMR_SIZE_MOST, SMR_SIZE_MOST);
    for (uint32_t c = 0; c < 4u; c++) {
        const smr_vec from = c < 3u ? column(&f->pose, c) : smr_sub(column(&f->pose, c), f->middle);
        smr_vec to = smr_scale(turned(half, from), scale);
        if (c == 3u)
            to = smr_add(smr_add(to, f->middle), smr_load(m));
        f->pose.m[0][c] = to.x;
        f->pose.m[1][c] = to.y;
        f->pose.m[2][c] = to.z;
    }
}

/* 1 for numbers that a field near the target has: not what rounding leaves where a model has gone very far. */
static int is_sane(const float *number, uint32_t n)
{
    for (uint32_t i = 0; i < n; i++)
        if (!(number[i] > -SMR_FIELD_FAR && number[i] < SMR_FIELD_FAR))
            return 0;
    return 1;
}

void smr_field_normals_end(smr_unseen_field *f)
{
    float *const sum = f->back;
    smr_solve_forward(f->lower, f->n, f->left);
    smr_solve_back(f->lower, f->n, f->left);
    for (uint32_t k = 0; k < f->n; k++) {
        float *const to = smr_at3(f->bend, k);
        for (uint32_t m = 0; m < SMR_FIELD_MOTIONS; m++)
            sum[m] += f->motion_variance * f->left[k] * motions(f, k)[m];
        smr_store(to, smr_scale(smr_load(to), f->left[k]));
    }
    add_motions(f, sum);
    if (!is_sane(f->bend, 3u * f->n) || !is_sane(&f->pose.m[0][0], 12u))
        f->n = 0;
}
