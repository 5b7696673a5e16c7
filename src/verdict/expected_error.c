/* expected_error.c: the expected error of each vertex, across the surface and along it, given the visible vertices or
 * the landmarks. A surface determines positions along normals only. The displacement from the start is a Gaussian
 * process (Rasmussen and Williams 2006, chapter 2) with covariance size2 / (1 + d^2 / l^2) for each axis, plus the
 * motions of a similarity; visible vertices show n . displacement with noise, from which size2 follows.
 * The noise is measured: how much vertices stick out from their neighbours, and the residual. Across the surface, a
 * visible vertex has the noise alone as error, and the error of an invisible one grows with the distance to the
 * visible ones: near them a body's thickness changes less, and far from them its shape more, than the process says.
 * A cloud shows vertices at its points only; between points the error grows as points become fewer. Landmarks beside a
 * target are observed along all axes.
 * The error of the start is unknown. With a partial target the registration keeps the start where normals determine
 * little. If the observed part moved far, the rest may lack the same motion. Therefore the motion from the start has a
 * variance of its own, and the displacement that it would add counts as error, too.
 * Bounds: SMR_OBSERVATIONS^2 / 2 multiplications for each vertex and axis; SMR_OBSERVATIONS^3 / 6 for each of
 * SMR_NOISE_ROUNDS + 2 factors; a pass over triangles. Landmarks: SMR_LANDMARKS_MAX^3 / 6, its square / 2 a vertex.
 * SPDX-License-Identifier: MIT */
#include "base/lanes.h"
#include "geometry/gaussian_process/gaussian_process.h"
#include "verdict/verdict_measures.h"

#define SMR_NOISE_LEAST 0.002f /* share of the field's variance that is finer than its kernel and counts as noise */
#define SMR_NOISE_MOST 0.25f   /* largest noise variance / field's variance: a coarse residual is not all noise */
#define SMR_NOISE_ROUNDS 5u    /* rounds that find size2 with the measured noise */
#define SMR_IMAGE_ROUNDS 1u    /* the same in a partly shown model: wrong goals would feed back on size2 */
#define SMR_IMAGE_MOST 4.0f    /* largest squared observation / their mean, which is found in SMR_IMAGE_MEANS rounds */
#define SMR_IMAGE_MEANS 8u
#define SMR_IMAGE_SIZE 1.4f     /* size2 / that mean */
#define SMR_IMAGE_MATCHED 0.95f /* share of vertices with a goal, in an image, for which errors stay as computed */
#define SMR_IMAGE_CHANCE 0.5f   /* smallest such share that counts: goals by chance are no worse than this */
#define SMR_NOISE_SHARE 0.64f   /* (mean absolute error)^2 / mean square error of normal noise: 2 / pi */
#define SMR_UNSEEN_NEAR 0.06f   /* variance across / process' variance, at invisible vertices near visible ones */
#define SMR_UNSEEN_IMAGE 0.75f  /* variance across / process' variance, invisible vertices of a partly shown model */
#define SMR_BETWEEN_POINTS 2.5f /* the same, between the points of a cloud that has as many points as are listed */
#define SMR_POINTS_ALONG 0.3f   /* growth of variance along by few points / that across between them */
#define SMR_NOISE_ALONG 4.0f    /* variance along / variance across, both by a cloud's noise as it is not smoothed */
#define SMR_UNSEEN_ACROSS 2.4f  /* growth of variance across / process' variance, a kernel length from the visible */
#define SMR_UNSEEN_ALONG 6.0f   /* growth of variance along / process' variance, a kernel length from the visible */
#define SMR_PARTIAL_ALONG 0.16f /* variance along / process' variance where a regression limits sliding */
#define SMR_ALONG_LEAST 0.05f   /* smallest error along the surface, in mean edge lengths: vertices slide that far */
#define SMR_NORMAL_MORE 0.5f    /* variance of the motion from the start / square of that motion */
#define SMR_NORMAL_MOST 4.0e3f  /* largest variance of the motion from the start / field's; beyond: rounding errors */
#define SMR_NORMAL_TURN 0.1f    /* smallest 1 + trace of a rotation in a divisor (4: no turn): limits half turns */

/* Positions whose covariances with the observations are computed at once. */
typedef struct places {
    smr_lanes3 at;     /* start position, mm */
    smr_lanes3 normal; /* unit normal in the start's frame */
    smr_lanes3 arm;    /* vector from the middle, in kernel lengths */
    smr_lanes3 motion; /* displacement by the motion from the start, mm */
} places;

/* Returns the vector from the middle of the structure's box to a position, in kernel lengths. */
static smr_vec arm_of(const smr_normal_field *f, smr_vec at)
{
    return smr_scale(smr_sub(at, f->middle), SMR_SQRT(f->per_length2));
}

/* Returns the displacement, mm, by the motion from the start at an arm of arm_of(). */
static smr_vec motion_at(const smr_normal_field *f, smr_vec arm) { return smr_add(f->shift, smr_cross(f->turn, arm)); }

static void set_place(const smr_normal_field *f, places *p, uint32_t l, smr_vec at, smr_vec normal)
{
    const smr_vec arm = arm_of(f, at);
    smr_lane_set(&p->at, l, at);
    smr_lane_set(&p->normal, l, normal);
    smr_lane_set(&p->arm, l, arm);
    smr_lane_set(&p->motion, l, motion_at(f, arm));
}

/* Returns the covariances of the displacements at places with observation i, divided by size2. Sets *d2 to the squared
 * distances. */
static inline smr_lanes3 with_observation(const smr_normal_field *f, const places *p, uint32_t i, smr_lanes *d2)
{
    const smr_terms *t = &f->term[i];
    const smr_lanes3 n = smr_lanes3_of(smr_get3(f->normal, i)),
                     apart = smr_lanes3_add(p->at, smr_lanes3_of(smr_scale(smr_get3(f->at, i), -1.0f)));
    const smr_lanes3 a = p->arm, turn = {t->turn.y * a.z - t->turn.z * a.y, t->turn.z * a.x - t->turn.x * a.z,
                                         t->turn.x * a.y - t->turn.y * a.x};
    const smr_lanes3 motions = smr_lanes3_scale(
        smr_lanes3_add(smr_lanes3_add(n, turn), smr_lanes3_scale(a, smr_lanes_of(t->scale))), smr_lanes_of(f->motions));
    *d2 = smr_lanes3_dot(apart, apart);
    return smr_lanes3_add(smr_lanes3_scale(n, 1.0f / (1.0f + *d2 * f->per_length2)),
                          smr_lanes3_add(motions, smr_lanes3_scale(p->motion, smr_lanes_of(t->more))));
}

uint32_t smr_factor_tasks(const void *job) { return smr_ceil_div(((const smr_judgement *)job)->field.n, SMR_LANES); }

/* Computes SMR_LANES rows of the Cholesky factor of the observations' covariance. Tasks run in order. */
void smr_factor_rows(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_normal_field *f = &((smr_judgement *)job)->field;
    const uint32_t first = task * SMR_LANES, rows = smr_min_u32(f->n - first, SMR_LANES);
    places p;
    smr_lanes d2;
    for (uint32_t i = 0; i < f->n && task == 0u; i++) {
        const smr_vec other = arm_of(f, smr_get3(f->at, i)), n = smr_get3(f->normal, i);
        f->term[i] = (smr_terms){smr_cross(other, n), smr_dot(other, n), f->more * smr_dot(motion_at(f, other), n)};
    }
    for (uint32_t l = 0; l < SMR_LANES; l++) {
        const uint32_t i = first + smr_min_u32(l, rows - 1u);
        set_place(f, &p, l, smr_get3(f->at, i), smr_get3(f->normal, i));
    }
    for (uint32_t j = 0; j < first + rows; j++) {
        const smr_lanes both = smr_lanes3_dot(p.normal, with_observation(f, &p, j, &d2));
        for (uint32_t l = j < first ? 0u : j - first, i = first + l; l < rows; l++, i++)
            smr_factor_set(f->lower, i, j, both[l] + (i == j ? f->noise : 0.0f), 0.5f * f->noise);
    }
}

/* Returns the mean of the squares of values[n], or of smaller ones where a square is more than `most`. */
static float mean_square(const float *values, uint32_t n, float most)
{
    float sum = 0.0f;
    for (uint32_t i = 0; i < n; i++)
        sum += smr_min(values[i] * values[i], most) / (float)n;
    return sum;
}

/* Sets size2 to its most likely value, y K^-1 y / n. y: observed displacements. K: covariance of the observations. In a
 * partly shown model a few wrong goals, at the border of the image, would decide it: no square counts for more than a
 * few times the mean. */
static void find_size(smr_normal_field *f)
{
    memcpy(f->open, f->moved, f->n * sizeof *f->open);
    smr_solve_forward(f->lower, f->n, f->open);
    f->size2 = mean_square(f->open, f->n, SMR_FAR);
    for (uint32_t k = 0; k < SMR_IMAGE_MEANS && f->image_part; k++)
        f->size2 = mean_square(f->open, f->n, SMR_IMAGE_MOST * f->size2);
    f->size2 *= f->image_part ? SMR_IMAGE_SIZE : 1.0f;
    memset(f->open, 0, f->n * sizeof *f->open);
}

/* Sets shift and turn to the motion from the start to the pose. */
static void find_motion(smr_normal_field *f, const smr_pose *p)
{
    const float trace = p->m[0][0] + p->m[1][1] + p->m[2][2];
    const smr_vec axis = smr_v(p->m[2][1] - p->m[1][2], p->m[0][2] - p->m[2][0], p->m[1][0] - p->m[0][1]);
    const float per = 2.0f / (SMR_SQRT(f->per_length2) * smr_max(1.0f + trace, SMR_NORMAL_TURN));
    f->turn = smr_scale(axis, per);
    f->shift = smr_pose_turn_back(p, smr_sub(smr_pose_apply(p, f->middle), f->middle));
}

/* Starts the change of the coefficients by a variance of the motion from the start: solves without the variance, which
 * then becomes a part of the covariance. */
static void open_motion(smr_normal_field *f, float square)
{
    const float most = SMR_NORMAL_MOST * f->size2;
    memcpy(f->open, f->moved, f->n * sizeof *f->open);
    smr_solve_forward(f->lower, f->n, f->open);
    smr_solve_back(f->lower, f->n, f->open);
    f->more = SMR_NORMAL_MORE * square < most ? SMR_NORMAL_MORE / f->size2 : SMR_NORMAL_MOST / square;
}

/* Sets `open` to the change of the coefficients, with the factor of the new covariance. */
static void end_motion(smr_normal_field *f)
{
    smr_solve_forward(f->lower, f->n, f->moved);
    smr_solve_back(f->lower, f->n, f->moved);
    for (uint32_t i = 0; i < f->n; i++) {
        const smr_vec arm = arm_of(f, smr_get3(f->at, i));
        f->again += f->more * f->open[i] * smr_dot(motion_at(f, arm), smr_get3(f->normal, i));
        f->open[i] = f->moved[i] - f->open[i];
    }
}

/* Returns 1 when the registration keeps to the start positions where normals hardly determine positions. */
static int keeps_to_start(const smr *s, uint32_t structure)
{
    return s->forces.surface.target[structure].surface != NULL && !s->forces.occluded.sheet && !s->schedule.tracking &&
           s->shared.config.partial.n_landmarks == 0u && smr_visibility_always_partial(&s->forces.surface, structure);
}

uint32_t smr_round_tasks(const void *job) { return ((const smr_judgement *)job)->field.n > 0u; }

/* Takes a factor: finds size2 with the assumed noise, the square of the bend, then in rounds with the measured noise.
 * The motion from the start may need one more factor. */
void smr_round_end(void *job, SMR_UNUSED uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_judgement *j = job;
    smr_normal_field *f = &j->field;
    const uint32_t rounds = f->image_part ? SMR_IMAGE_ROUNDS : SMR_NOISE_ROUNDS;
    if (f->round > rounds) {
        end_motion(f);
        return;
    }
    find_size(f);
    j->bend2 = f->round == 0u ? f->size2 : j->bend2;
    if (f->round++ < rounds) {
        f->noise = SMR_NOISE_LEAST + (f->noise2 < SMR_NOISE_MOST * f->size2 ? f->noise2 / f->size2 : SMR_NOISE_MOST);
        j->job.head.next_stage = j->job.head.stage - 1u; /* the next factor */
        return;
    }
    f->across2 = SMR_NOISE_SHARE * f->noise2;
    find_motion(f, &f->pose);
    for (uint32_t i = 0; i < f->n; i++) /* adds the observed motion along the normals */
        f->moved[i] += smr_dot(motion_at(f, arm_of(f, smr_get3(f->at, i))), smr_get3(f->normal, i));
    const float square = smr_dot(f->shift, f->shift) + smr_dot(f->turn, f->turn);
    const int keeps = keeps_to_start(j->s, j->structure);
    f->along = keeps ? SMR_PARTIAL_ALONG : 1.0f;
    if (keeps && square > 0.0f) {
        open_motion(f, square);
        j->job.head.next_stage = j->job.head.stage - 1u;
    }
}

/* Squared errors of a position, mm^2: across the surface and along it. */
typedef struct parts {
    float across, along;
} parts;

/* Returns the share of the process' variance across that visible vertices between a cloud's points have, the more the
 * fewer points there are, down to as many as are listed. */
static float between_points(const smr_judgement *j)
{
    const float listed = (float)j->field.n / (float)j->field.total;
    return j->by == SMR_BY_CLOUD ? SMR_BETWEEN_POINTS * listed * listed : 0.0f;
}

/* Returns variance along / variance across, both by noise: a cloud's as before smoothing, a mesh's as it is. */
static float noisy(const smr_judgement *j)
{
    const float smoothed = smr_noise_smoothed(&j->s->evolve.tangent_smooth, j->structure);
    return j->by == SMR_BY_CLOUD ? SMR_NOISE_ALONG * smoothed : 0.5f * (smoothed - 1.0f);
}

/* Returns v's squared errors from the process' variances. far2: squared distance to observations in kernel lengths. */
static parts weighed(const smr_judgement *j, uint32_t v, parts variance, float far2)
{
    const smr_normal_field *f = &j->field;
    const float least = SMR_ALONG_LEAST * smr_le_float(j->s->shared.model->edge_mm);
    const uint32_t marks = smr_judged_visible(j->s)[v], visible = marks & SMR_JUDGED_VISIBLE;
    const float between = between_points(j), grown2 = f->image_part ? 0.0f : far2;
    const float near = f->image_part ? SMR_UNSEEN_IMAGE : smr_max(SMR_UNSEEN_NEAR, between);
    const float open = marks & SMR_JUDGED_POINT ? 0.0f : between; /* a vertex at a point has the noise alone */
    const float across = visible ? open : near + SMR_UNSEEN_ACROSS * grown2;
    const float along = f->along + SMR_POINTS_ALONG * between + (visible ? 0.0f : SMR_UNSEEN_ALONG * grown2);
    const float marked = visible ? 0.0f : f->marked2; /* what landmarks do not meet, their places do not tell */
    return (parts){across * f->size2 * variance.across + f->across2 + marked * (1.0f / 3.0f),
                   along * f->size2 * variance.along + noisy(j) * f->across2 + least * least + marked * (2.0f / 3.0f)};
}

/* Variances and displacements of places, from the observations. */
typedef struct solved {
    smr_lanes left, across;  /* variance of all axes and across the surface / size2 */
    smr_lanes3 displacement; /* displacement by the variance of the motion from the start, mm */
    smr_lanes d2;            /* squared distance to the nearest observation, mm^2 */
} solved;

/* Computes what the observations leave open at places. */
static solved solve(const smr_normal_field *f, const places *p)
{
    smr_lanes3 known[SMR_OBSERVATIONS]; /* L^-1 of the covariances with the observations, for each axis */
    const smr_lanes motions = 1.0f + f->motions * (1.0f + smr_lanes3_dot(p->arm, p->arm)),
                    through = smr_lanes3_dot(p->motion, p->normal);
    solved k = {3.0f * motions + f->more * smr_lanes3_dot(p->motion, p->motion), motions + f->more * through * through,
                smr_lanes3_scale(p->motion, smr_lanes_of(f->again)), smr_lanes_of(SMR_FAR)};
    for (uint32_t i = 0; i < f->n; i++) {
        const float *const row = smr_factor_row(f->lower, i);
        smr_lanes d2;
        const smr_lanes3 with = with_observation(f, p, i, &d2);
        const smr_lanes3 one = smr_lanes3_scale(smr_lanes3_less(with, known, row, i), smr_lanes_of(1.0f / row[i]));
        known[i] = one;
        const smr_lanes along = smr_lanes3_dot(one, p->normal);
        k.left -= smr_lanes3_dot(one, one);
        k.across -= along * along;
        k.displacement = smr_lanes3_add(k.displacement, smr_lanes3_scale(with, smr_lanes_of(f->open[i])));
        for (uint32_t l = 0; l < SMR_LANES; l++)
            k.d2[l] = smr_min(k.d2[l], d2[l]);
    }
    return k;
}

/* Returns a factor of squared errors. In an image: the fewer vertices found a goal, the less sure are those found. */
static float unsure(const smr_judgement *j)
{
    const float matched = j->by == SMR_BY_IMAGE ? smr_mean_of(j->e.goals, -1.0f) : -1.0f;
    const float more = SMR_IMAGE_MATCHED / smr_max(matched, SMR_IMAGE_CHANCE);
    return matched < 0.0f ? 1.0f : more * more;
}

/* Returns the squared errors of stored vertex v in lane l; without a normal a third of the error counts as across. */
static parts errors_of(const smr_judgement *j, uint32_t v, const places *p, const solved *k, uint32_t l)
{
    const smr_vec normal = smr_lane(&p->normal, l), displacement = smr_lane(&k->displacement, l);
    const int has_normal = smr_dot(normal, normal) > 0.5f;
    const float left = smr_max(k->left[l], 0.0f);
    const float across = has_normal ? smr_clamp(k->across[l], 0.0f, left) : left * (1.0f / 3.0f);
    const float open = smr_dot(displacement, displacement), moved = smr_dot(displacement, normal);
    const float open_across = has_normal ? smr_min(moved * moved, open) : open * (1.0f / 3.0f);
    const parts e = weighed(j, v, (parts){across, left - across}, k->d2[l] * j->field.per_length2);
    const float factor = unsure(j);
    return (parts){factor * (e.across + open_across), factor * (e.along + open - open_across)};
}

/* Computes the squared errors of vertices first .. first + SMR_LANES - 1; lanes beyond the end get the last one. */
static void field_errors(const smr_judgement *j, uint32_t first, parts *errors)
{
    const smr_normal_field *f = &j->field;
    uint32_t v[SMR_LANES];
    places p;
    for (uint32_t l = 0; l < SMR_LANES; l++) {
        v[l] = smr_judged_vertex(j, smr_min_u32(first + l, smr_judged(j)->n_vertices - 1u));
        set_place(f, &p, l, smr_get3(j->s->shape.start, v[l]),
                  smr_pose_turn_back(&f->pose, smr_get3(j->s->shape.normal, v[l])));
    }
    const solved k = solve(f, &p);
    for (uint32_t l = 0; l < SMR_LANES; l++)
        errors[l] = errors_of(j, v[l], &p, &k, l);
}

uint32_t smr_errors_tasks(const void *job)
{
    const smr_judgement *j = job;
    return smr_knows_expected(j) ? 0u : smr_ceil_div(smr_judged(j)->n_vertices, SMR_LANES);
}

/* Computes the expected errors of SMR_LANES vertices; -1 where they are unknown. */
void smr_errors_find(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    const smr_judgement *j = job;
    const smr_piece piece = smr_piece_of(task, SMR_LANES, smr_judged(j)->n_vertices);
    const float residual = smr_mean_of(j->e.residual, 0.0f);
    const int by_landmarks = smr_follows_landmarks(j->s, j->structure);
    parts error[SMR_LANES];
    if (!by_landmarks && j->bend2 >= 0.0f)
        field_errors(j, piece.first, error);
    for (uint32_t i = piece.first; i < piece.last; i++) {
        const uint32_t v = smr_judged_vertex(j, i);
        float *const expected = smr_vertex_expected(j->s, v);
        expected[0] = expected[1] = expected[2] = -1.0f;
        if (j->bend2 < 0.0f)
            continue;
        const float axis2 = by_landmarks ? j->bend2 * smr_landmark_field_left(&j->through, v) : 0.0f;
        const parts p = by_landmarks ? (parts){axis2 + residual * residual, axis2 + axis2} : error[i - piece.first];
        expected[0] = SMR_SQRT(p.across + p.along);
        expected[1] = SMR_SQRT(p.across);
        expected[2] = SMR_SQRT(p.along);
    }
}

uint32_t smr_errors_add_tasks(const void *job)
{
    return smr_ceil_div(smr_judged((const smr_judgement *)job)->n_vertices, SMR_JUDGE_PIECE);
}

void smr_errors_add(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_judgement *j = job;
    smr_evidence *const e = &j->e;
    const smr_piece piece = smr_judged_vertices(j, task);
    if (task == 0u && j->bend2 >= 0.0f)
        smr_mean_add(&e->bend, SMR_SQRT(j->bend2), (float)smr_judged(j)->n_vertices);
    for (uint32_t i = piece.first; i < piece.last && j->bend2 >= 0.0f; i++) {
        const uint32_t v = smr_judged_vertex(j, i);
        const float *expected = smr_vertex_expected(j->s, v);
        smr_mean_add(&e->expected, expected[0], 1.0f);
        smr_mean_add(&e->across, expected[1], 1.0f);
        smr_mean_add(&e->along, expected[2], 1.0f);
        smr_mean_add(&e->on_visible, expected[0], (float)(smr_judged_visible(j->s)[v] & SMR_JUDGED_VISIBLE));
        if (SMR_HAS_IMAGE && e->n_invisible > 0u && !smr_image_shows(&j->s->forces.image, v))
            smr_mean_add(&e->hidden, expected[0], 1.0f);
    }
}
