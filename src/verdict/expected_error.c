/* expected_error.c: the expected error of each vertex, across the surface and along it, given the visible vertices or
 * the landmarks. A surface determines positions along normals only. The displacement from the start is a Gaussian
 * process (Rasmussen and Williams 2006, chapter 2) with covariance size2 / (1 + d^2 / l^2) for each axis, plus the
 * motions of a similarity; visible vertices show n . displacement with noise, from which size2 follows.
 * The noise is measured: how much vertices stick out from their neighbours, and the residual. Across the surface, a
 * visible vertex has the noise alone as error, and the error of an invisible one grows with the distance to the
 * visible ones: near them a body's thickness changes less, and far from them its shape more, than the process says.
 * The error of the start is unknown. With a partial target the registration keeps the start where normals determine
 * little. If the observed part moved far, the rest may lack the same motion. Therefore the motion from the start has a
 * variance of its own, and the displacement that it would add counts as error, too.
 * Bounds: SMR_OBSERVATIONS^2 / 2 multiplications for each vertex and axis; SMR_OBSERVATIONS^3 / 6 for each of
 * SMR_NOISE_ROUNDS + 2 factors; a pass over triangles. Landmarks: SMR_LANDMARKS_MAX^3 / 6, its square / 2 a vertex.
 * SPDX-License-Identifier: MIT */
#include "base/lanes.h"
#include "geometry/gaussian_process/gaussian_process.h"
#include "verdict/verdict_measures.h"

#define SMR_OBSERVATIONS 64u      /* most observations: visible vertices that the field is fitted to */
#define SMR_OBSERVATIONS_LEAST 6u /* fewest observations: a rigid pose alone has six unknowns */
#define SMR_NORMAL_LENGTH 0.5f    /* kernel length divided by the diagonal of the structure's box */
#define SMR_NORMAL_NOISE 0.01f    /* assumed noise variance / field's variance, for the bend and the first size2 */
#define SMR_NOISE_LEAST 0.002f    /* share of the field's variance that is finer than its kernel and counts as noise */
#define SMR_NOISE_MOST 0.25f      /* largest noise variance / field's variance: a coarse residual is not all noise */
#define SMR_NOISE_ROUNDS 5u       /* rounds that find size2 with the measured noise */
#define SMR_NOISE_SHARE 0.64f     /* (mean absolute error)^2 / mean square error of normal noise: 2 / pi */
#define SMR_UNSEEN_NEAR 0.06f     /* variance across / process' variance, at invisible vertices near visible ones */
#define SMR_UNSEEN_IMAGE 0.75f    /* variance across / process' variance, invisible vertices of a partly shown model */
#define SMR_UNSEEN_ACROSS 2.2f    /* growth of variance across / process' variance, a kernel length from the visible */
#define SMR_UNSEEN_ALONG 2.5f     /* growth of variance along / process' variance, a kernel length from the visible */
#define SMR_PARTIAL_ALONG 0.22f   /* variance along / process' variance where a regression limits sliding */
#define SMR_ALONG_LEAST 0.05f     /* smallest error along the surface, in mean edge lengths: vertices slide that far */
#define SMR_NORMAL_MOTIONS 8.0f   /* variance of shift, turn, scale (at a kernel length) / field's variance */
#define SMR_NORMAL_MORE 0.5f      /* variance of the motion from the start / square of that motion */
#define SMR_NORMAL_MOST 4.0e3f    /* largest variance of the motion from the start / field's; beyond: rounding errors */
#define SMR_NORMAL_TURN 0.1f      /* smallest 1 + trace of a rotation in a divisor (4: no turn): limits half turns */

/* Terms of an observation in its covariances with other positions. */
typedef struct terms {
    smr_vec turn; /* vector from the middle, in kernel lengths, cross normal */
    float scale;  /* that vector . normal */
    float more;   /* normal_field.more times the motion from the start . normal */
} terms;

/* Positions whose covariances with the observations are computed at once. */
typedef struct places {
    smr_lanes3 at;     /* start position, mm */
    smr_lanes3 normal; /* in the start's frame */
    smr_lanes3 arm;    /* vector from the middle, in kernel lengths */
    smr_lanes3 motion; /* displacement by the motion from the start, mm */
} places;

/* The displacement from the start as a Gaussian process, observed along normals. */
typedef struct normal_field {
    const smr *s;
    smr_lanes3 *known; /* [n] for each axis of SMR_LANES positions: L^-1 of the covariances with the observations */
    terms *term;       /* [n] in the memory of records behind the expected errors */
    float *at;         /* [n][3] start positions of the observed vertices, mm */
    float *normal;     /* [n][3] normals of the observed vertices in the start's frame */
    float *moved;      /* [n] observed displacement along the normal, mm */
    float *open;       /* [n] change of the coefficients by the variance of the motion from the start */
    float *lower;      /* Cholesky factor of the observations' covariance, row by row */
    uint32_t n;        /* number of observations; 0: too few */
    float noise;       /* noise variance along a normal / size2 */
    float along;       /* variance along the surface / process' variance */
    float across2;     /* variance by noise across the surface, mm^2 */
    smr_pose pose;     /* rigid pose that moves the start onto all visible vertices */
    int image_part;    /* 1: an image shows a part of the structure */
    smr_vec middle;    /* middle of the structure's box at the start, mm */
    float motions;     /* variance of shift, turn and scale / variance of the displacement */
    float per_length2; /* 1 / l^2 of the kernel length l, 1 / mm^2 */
    float size2;       /* variance of the displacement along an axis, mm^2 */
    smr_vec shift;     /* motion from the start to the pose of all visible vertices: shift of the middle, mm */
    smr_vec turn;      /* motion from the start to that pose: rotation about the middle, mm at a kernel length */
    float more;        /* variance of a factor on the motion from the start / size2; 0: not used */
    float again;       /* factor on the motion from the start, as the observations give it */
} normal_field;

/* Places arrays in the memory of sums and records. Returns the number of observations for which there is room. */
static uint32_t place(normal_field *f, const smr *s)
{
    const uint32_t words = smr_min_u32(s->shared.n, 4u * SMR_OBSERVATIONS) * SMR_WORDS;
    uint32_t most = SMR_OBSERVATIONS;
    while (most > 0u && (most * (most + 1u) / 2u + 8u * most > words || 12u * most + 3u > 5u * s->shared.n))
        most--;
    f->at = (float *)s->overlay.sum;
    f->normal = f->at + 3u * (size_t)most;
    f->moved = f->normal + 3u * (size_t)most;
    f->open = f->moved + most;
    f->lower = f->open + most;
    f->known = (smr_lanes3 *)(void *)(s->overlay.record + smr_ceil_div(2u * s->shared.n, 4u) * 4u); /* 16-byte place */
    f->term = (terms *)smr_vertex_expected(s, s->shared.n);
    return most;
}

/* Returns 1 for a visible vertex with a normal. */
static int is_observed(const smr *s, uint32_t v)
{
    const smr_vec n = smr_get3(s->shape.normal, v);
    return smr_vertex_visible(s, v) && smr_dot(n, n) > 0.5f;
}

/* Lists at most `most` visible vertices, evenly in stored order, as observations; adds all visible ones to the fit. */
static void choose(normal_field *f, uint32_t structure, uint32_t most, smr_fit *fit)
{
    const smr *s = f->s;
    const smr_shape_structure *one = &s->shape.structure[structure];
    uint32_t total = 0, met = 0;
    smr_box box = {{SMR_FAR, SMR_FAR, SMR_FAR}, {-SMR_FAR, -SMR_FAR, -SMR_FAR}};
    for (uint32_t i = 0; i < one->n_vertices; i++)
        total += (uint32_t)is_observed(s, smr_model_position(s->shared.model, one->first_vertex + i));
    const uint32_t wanted = smr_min_u32(total, most);
    for (uint32_t v = 0; v < s->shared.n; v++) {
        if (smr_model_owner(s->shared.model, v) != structure)
            continue;
        const smr_vec p = smr_get3(s->shape.start, v);
        box = (smr_box){smr_low(box.lo, p), smr_high(box.hi, p)};
        if (!is_observed(s, v))
            continue;
        if (met == 0u)
            smr_fit_start(fit, p, smr_get3(s->shape.x, v));
        smr_fit_add(fit, p, smr_get3(s->shape.x, v), 1.0f);
        if (f->n < wanted && (uint64_t)met * wanted >= (uint64_t)f->n * total) {
            smr_put3(f->at, f->n, p);
            smr_put3(f->normal, f->n, smr_get3(s->shape.normal, v));
            smr_put3(f->lower, f->n++, smr_get3(s->shape.x, v)); /* positions, until the factor needs the memory */
        }
        met++;
    }
    const float length = smr_max(SMR_NORMAL_LENGTH * smr_length(smr_sub(box.hi, box.lo)), 1.0e-6f);
    f->per_length2 = 1.0f / (length * length);
    f->middle = smr_scale(smr_add(box.lo, box.hi), 0.5f);
}

/* Returns the vector from the middle of the structure's box to a position, in kernel lengths. */
static smr_vec arm_of(const normal_field *f, smr_vec at)
{
    return smr_scale(smr_sub(at, f->middle), SMR_SQRT(f->per_length2));
}

/* Returns the displacement, mm, by the motion from the start at an arm of arm_of(). */
static smr_vec motion_at(const normal_field *f, smr_vec arm) { return smr_add(f->shift, smr_cross(f->turn, arm)); }

/* Sets lane l of the places to a start position and its normal. */
static void set_place(const normal_field *f, places *p, uint32_t l, smr_vec at, smr_vec normal)
{
    const smr_vec arm = arm_of(f, at);
    smr_lane_set(&p->at, l, at);
    smr_lane_set(&p->normal, l, normal);
    smr_lane_set(&p->arm, l, arm);
    smr_lane_set(&p->motion, l, motion_at(f, arm));
}

/* Returns the covariances of the displacements at places with observation i, divided by size2. Sets *d2 to the squared
 * distances. */
static inline smr_lanes3 with_observation(const normal_field *f, const places *p, uint32_t i, smr_lanes *d2)
{
    const terms *t = &f->term[i];
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

/* Computes the Cholesky factor of the observations' covariance. */
static void factor(normal_field *f)
{
    places p;
    smr_lanes d2;
    for (uint32_t i = 0; i < f->n; i++) {
        const smr_vec other = arm_of(f, smr_get3(f->at, i)), n = smr_get3(f->normal, i);
        f->term[i] = (terms){smr_cross(other, n), smr_dot(other, n), f->more * smr_dot(motion_at(f, other), n)};
    }
    for (uint32_t first = 0; first < f->n; first += SMR_LANES) {
        const uint32_t rows = smr_min_u32(f->n - first, SMR_LANES);
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
}

/* Sets size2 to its most likely value, y K^-1 y / n. y: observed displacements. K: covariance of the observations. */
static void find_size(normal_field *f)
{
    factor(f);
    memcpy(f->open, f->moved, f->n * sizeof *f->open);
    smr_solve_forward(f->lower, f->n, f->open);
    f->size2 = 0.0f;
    for (uint32_t i = 0; i < f->n; i++)
        f->size2 += f->open[i] * f->open[i] / (float)f->n;
    memset(f->open, 0, f->n * sizeof *f->open);
}

/* Finds size2 for a noise of this variance, mm^2. Returns size2 for the assumed noise. */
static float find_sizes(normal_field *f, float noise2)
{
    f->noise = SMR_NORMAL_NOISE;
    find_size(f);
    const float assumed = f->size2;
    for (uint32_t i = 0; i < SMR_NOISE_ROUNDS; i++) {
        f->noise = SMR_NOISE_LEAST + (noise2 < SMR_NOISE_MOST * f->size2 ? noise2 / f->size2 : SMR_NOISE_MOST);
        find_size(f);
    }
    return assumed;
}

/* Returns the noise variance of visible vertices, mm^2: squared difference, along the normal, of a vertex' displacement
 * from the posed start and the mean of its neighbours'. Six neighbours add a sixth of the variance. */
static float noise_of(const normal_field *f, uint32_t structure)
{
    const smr *s = f->s;
    const smr_shape_structure *one = &s->shape.structure[structure];
    const smr_rings *rings = &s->overlay.rings;
    smr_mean noise = {0, 0};
    memset(rings->sum, 0, 4u * sizeof *rings->sum * s->shared.n); /* clears the sums, and the weights behind them */
    for (uint32_t v = 0; v < s->shared.n; v++)
        smr_put3(rings->displacement, v,
                 smr_sub(smr_get3(s->shape.x, v), smr_pose_apply(&f->pose, smr_get3(s->shape.start, v))));
    for (uint32_t k = 0; k < one->tree.n_triangles; k++)
        smr_ring_add(rings, smr_model_triangle(&s->shared, one->first_triangle + k), rings->displacement);
    for (uint32_t v = 0; v < s->shared.n; v++) {
        if (!(rings->weight[v] > 0.0f) || !is_observed(s, v))
            continue;
        const smr_vec mean = smr_scale(smr_get3(rings->sum, v), 1.0f / rings->weight[v]);
        const float out = smr_dot(smr_sub(smr_get3(rings->displacement, v), mean), smr_get3(s->shape.normal, v));
        smr_mean_add(&noise, out * out * (6.0f / 7.0f), 1.0f);
    }
    return smr_mean_of(noise, 0.0f);
}

/* Sets shift and turn to the motion from the start to the pose. */
static void find_motion(normal_field *f, const smr_pose *p)
{
    const float trace = p->m[0][0] + p->m[1][1] + p->m[2][2];
    const smr_vec axis = smr_v(p->m[2][1] - p->m[1][2], p->m[0][2] - p->m[2][0], p->m[1][0] - p->m[0][1]);
    const float per = 2.0f / (SMR_SQRT(f->per_length2) * smr_max(1.0f + trace, SMR_NORMAL_TURN));
    f->turn = smr_scale(axis, per);
    f->shift = smr_pose_turn_back(p, smr_sub(smr_pose_apply(p, f->middle), f->middle));
}

/* Sets `open` to the change of the coefficients when the motion from the start has a variance. */
static void open_motion(normal_field *f)
{
    const float square = smr_dot(f->shift, f->shift) + smr_dot(f->turn, f->turn);
    const float most = SMR_NORMAL_MOST * f->size2;
    memcpy(f->open, f->moved, f->n * sizeof *f->open);
    smr_solve_forward(f->lower, f->n, f->open);
    smr_solve_back(f->lower, f->n, f->open);
    f->more = SMR_NORMAL_MORE * square < most ? SMR_NORMAL_MORE / f->size2 : SMR_NORMAL_MOST / square;
    factor(f);
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

/* Solves the field of a structure in the memory of sums, which is free between iterations. Returns size2 for the
 * assumed noise, the square of the bend. */
static float solve_field(normal_field *f, const smr *s, uint32_t structure, float residual)
{
    smr_fit fit = {.weight = 0.0f};
    *f = (normal_field){.s = s};
    f->motions = s->forces.occluded.sheet ? 0.0f : SMR_NORMAL_MOTIONS; /* a sheet's borders determine its motion */
    choose(f, structure, place(f, s), &fit);
    if (f->n < SMR_OBSERVATIONS_LEAST) {
        f->n = 0;
        return 0.0f;
    }
    f->pose = smr_fit_solve(&fit, 0);
    for (uint32_t i = 0; i < f->n; i++) {
        const smr_vec posed = smr_pose_apply(&f->pose, smr_get3(f->at, i)), normal = smr_get3(f->normal, i);
        f->moved[i] = smr_dot(smr_sub(smr_get3(f->lower, i), posed), normal);
        smr_put3(f->normal, i, smr_pose_turn_back(&f->pose, normal));
    }
    const float noise2 = noise_of(f, structure) + residual * residual, assumed = find_sizes(f, noise2);
    f->across2 = SMR_NOISE_SHARE * noise2;
    find_motion(f, &f->pose);
    for (uint32_t i = 0; i < f->n; i++) /* adds the observed motion along the normals */
        f->moved[i] += smr_dot(motion_at(f, arm_of(f, smr_get3(f->at, i))), smr_get3(f->normal, i));
    const int keeps = keeps_to_start(s, structure);
    f->along = keeps ? SMR_PARTIAL_ALONG : 1.0f;
    if (keeps && smr_dot(f->shift, f->shift) + smr_dot(f->turn, f->turn) > 0.0f)
        open_motion(f);
    return assumed;
}

/* Squared errors of a position, mm^2: across the surface and along it. */
typedef struct parts {
    float across, along;
} parts;

/* Returns v's squared errors from the process' variances. far2: squared distance to observations in kernel lengths. */
static parts weighed(const normal_field *f, uint32_t v, parts variance, float far2)
{
    const float least = SMR_ALONG_LEAST * smr_le_float(f->s->shared.model->edge_mm);
    const int visible = smr_vertex_visible(f->s, v);
    const float near = f->image_part ? SMR_UNSEEN_IMAGE : SMR_UNSEEN_NEAR, grown2 = f->image_part ? 0.0f : far2;
    const float across = visible ? 0.0f : near + SMR_UNSEEN_ACROSS * grown2;
    const float along = f->along + (visible ? 0.0f : SMR_UNSEEN_ALONG * grown2);
    return (parts){across * f->size2 * variance.across + f->across2, along * f->size2 * variance.along + least * least};
}

/* Variances and displacements of places, from the observations. */
typedef struct solved {
    smr_lanes left, across;  /* variance of all axes and across the surface / size2 */
    smr_lanes3 displacement; /* by the variance of the motion from the start, mm */
    smr_lanes d2;            /* squared distance to the nearest observation, mm^2 */
} solved;

/* Computes what the observations leave open at places. */
static solved solve(const normal_field *f, const places *p)
{
    const smr_lanes motions = 1.0f + f->motions * (1.0f + smr_lanes3_dot(p->arm, p->arm)),
                    through = smr_lanes3_dot(p->motion, p->normal);
    solved k = {3.0f * motions + f->more * smr_lanes3_dot(p->motion, p->motion), motions + f->more * through * through,
                smr_lanes3_scale(p->motion, smr_lanes_of(f->again)), smr_lanes_of(SMR_FAR)};
    for (uint32_t i = 0; i < f->n; i++) {
        const float *const row = smr_factor_row(f->lower, i);
        smr_lanes d2;
        const smr_lanes3 with = with_observation(f, p, i, &d2);
        smr_lanes3 one = with;
        for (uint32_t j = 0; j < i; j++) {
            one.x -= f->known[j].x * row[j];
            one.y -= f->known[j].y * row[j];
            one.z -= f->known[j].z * row[j];
        }
        f->known[i] = one = smr_lanes3_scale(one, smr_lanes_of(1.0f / row[i]));
        const smr_lanes along = smr_lanes3_dot(one, p->normal);
        k.left -= smr_lanes3_dot(one, one);
        k.across -= along * along;
        k.displacement = smr_lanes3_add(k.displacement, smr_lanes3_scale(with, smr_lanes_of(f->open[i])));
        for (uint32_t l = 0; l < SMR_LANES; l++)
            k.d2[l] = smr_min(k.d2[l], d2[l]);
    }
    return k;
}

/* Returns the squared errors of stored vertex v in lane l; without a normal a third of the error counts as across. */
static parts errors_of(const normal_field *f, uint32_t v, const places *p, const solved *k, uint32_t l)
{
    const smr_vec normal = smr_lane(&p->normal, l), displacement = smr_lane(&k->displacement, l);
    const int has_normal = smr_dot(normal, normal) > 0.5f;
    const float left = smr_max(k->left[l], 0.0f);
    const float across = has_normal ? smr_clamp(k->across[l], 0.0f, left) : left * (1.0f / 3.0f);
    const float open = smr_dot(displacement, displacement), moved = smr_dot(displacement, normal);
    const float open_across = has_normal ? smr_min(moved * moved, open) : open * (1.0f / 3.0f);
    const parts e = weighed(f, v, (parts){across, left - across}, k->d2[l] * f->per_length2);
    return (parts){e.across + open_across, e.along + open - open_across};
}

/* Computes the squared errors of a structure's vertices from `first` on; lanes beyond its end get the last one. */
static void field_errors(const normal_field *f, const smr_shape_structure *one, uint32_t first, parts *errors)
{
    uint32_t v[SMR_LANES];
    places p;
    for (uint32_t l = 0; l < SMR_LANES; l++) {
        const uint32_t i = one->first_vertex + smr_min_u32(first + l, one->n_vertices - 1u);
        v[l] = smr_model_position(f->s->shared.model, i);
        set_place(f, &p, l, smr_get3(f->s->shape.start, v[l]),
                  smr_pose_turn_back(&f->pose, smr_get3(f->s->shape.normal, v[l])));
    }
    const solved k = solve(f, &p);
    for (uint32_t l = 0; l < SMR_LANES; l++)
        errors[l] = errors_of(f, v[l], &p, &k, l);
}

void smr_measure_expected(const smr *s, uint32_t structure, smr_evidence *e)
{
    const smr_shape_structure *one = &s->shape.structure[structure];
    const float residual = smr_mean_of(e->residual, 0.0f);
    const int by_landmarks = smr_follows_landmarks(s, structure);
    smr_occluded_field through = s->forces.occluded; /* a copy: the field's memory is free, and the original stays */
    normal_field field = {.n = 0};
    parts error[SMR_LANES];
    const float size2 = by_landmarks ? smr_landmark_field_solve(&through) : solve_field(&field, s, structure, residual);
    const int known = by_landmarks ? size2 >= 0.0f : field.n > 0u;
    field.image_part = e->n_invisible > 0u;
    if (known)
        smr_mean_add(&e->bend, SMR_SQRT(size2), (float)one->n_vertices);
    for (uint32_t i = 0; i < one->n_vertices; i++) {
        const uint32_t v = smr_model_position(s->shared.model, one->first_vertex + i);
        float *const expected = smr_vertex_expected(s, v);
        expected[0] = expected[1] = expected[2] = -1.0f;
        if (!known)
            continue;
        if (!by_landmarks && i % SMR_LANES == 0u)
            field_errors(&field, one, i, error);
        const float axis2 = by_landmarks ? size2 * smr_landmark_field_left(&through, v) : 0.0f;
        const parts p = by_landmarks ? (parts){axis2 + residual * residual, axis2 + axis2} : error[i % SMR_LANES];
        expected[0] = SMR_SQRT(p.across + p.along);
        expected[1] = SMR_SQRT(p.across);
        expected[2] = SMR_SQRT(p.along);
        smr_mean_add(&e->expected, expected[0], 1.0f);
        smr_mean_add(&e->across, expected[1], 1.0f);
        smr_mean_add(&e->along, expected[2], 1.0f);
        smr_mean_add(&e->on_visible, expected[0], (float)smr_vertex_visible(s, v));
        if (SMR_HAS_IMAGE && e->n_invisible > 0u && !smr_image_shows(&s->forces.image, v))
            smr_mean_add(&e->hidden, expected[0], 1.0f);
    }
}
