/* thin_plate_spline.c: thin-plate-spline interpolation of landmarks (paper 3, iconic registration; Bookstein 1989; with
 * smoothing: Rohr et al. 1996, where each landmark has the number of its duplicates as weight).
 * Method: v(u) = A u + a + sum w_i K(|u - u_i|) with K(r) = -r. u is the point relative to the landmarks' centroid, in
 * units of a power of two near their spread. With this sign K + lambda I is definite on the allowed weights, so
 * smoothing always improves the condition. thin_plate_solve.c solves (K + lambda I) w + P a = goal, P^T w = 0. P's
 * columns are 1 and the principal coordinates scaled to unit spread, so that nearly coplanar landmarks lose no digits.
 * Coplanar landmarks get a scaled rigid transform, collinear ones (or two) a rigid transform, a single place a
 * translation. Landmarks closer than SMR_SAME_MM or SMR_SAME_SHARE are merged, at the first one's place with the mean
 * goal.
 * Accuracy without smoothing: 5e-4 mm at the landmarks of bodies of 600 mm with random displacements of 60 mm (the
 * worst case); 3e-4 mm for affine maps within twice the body's size.
 * Bounds: a fit solves n + 4 equations (thin_plate_solve.c); applying takes n square roots for each point.
 * SPDX-License-Identifier: MIT */
#include "base/arena.h"
#include "geometry/rotation/similarity_fit.h"
#include "geometry/linear_solve/eigen_jacobi.h"
#include "geometry/linear_solve/thin_plate_solve.h"

#define SMR_WARP_MAGIC 0x736d7257u
#define SMR_WARP_AFFINE 4u      /* number of columns of P: 1 and three coordinates */
#define SMR_SAME_MM 1.0e-4f     /* distance at or below which landmarks are merged, mm */
#define SMR_SAME_SHARE 2.0e-5f  /* distance of merged landmarks / extent of all; the larger distance counts */
#define SMR_LINE_SHARE 1.0e-3f  /* second variance / largest, at or below which landmarks are collinear */
#define SMR_PLANE_SHARE 1.0e-4f /* third variance / largest, at or below which landmarks are coplanar */
#define SMR_LAMBDA_MAX 1.0e9f   /* largest smoothing lambda, in units of u: above, floats lose the kernels' part */

struct smr_warp {
    uint32_t magic;   /* SMR_WARP_MAGIC marks a fitted warp */
    uint32_t n;       /* number of kernels; 0 unless the warp is a spline */
    smr_vec from, to; /* centroids of the landmarks and of their goals, mm */
    float per_mm;     /* units of u in a mm: u = (x - from) * per_mm */
    smr_pose affine;  /* affine part: matrix A and vector a, from u to mm from `to` */
    float *centre;    /* [n][3] centre u_i of each kernel: position of a distinct landmark */
    float *weight;    /* [n][3] weight w_i of each kernel, mm */
};

/* A fit in progress: the distinct landmarks and scratch. */
typedef struct job {
    smr_warp *warp;
    float *goal;       /* [n][3] goal of each distinct landmark, mm from warp->to: mean of duplicates */
    float *count;      /* [n] number of landmarks merged into each distinct one */
    smr_system system; /* the spline's n + 4 equations and scratch */
    smr_vec axis[3];   /* landmarks' principal directions, each divided by the spread along it */
    float variance[3]; /* landmarks' variances along their principal directions, u^2, largest first */
    float lambda;      /* smoothing parameter in units of u */
    uint32_t n;        /* number of distinct landmarks */
} job;

static void layout(smr_arena *a, uint32_t n, job *j, smr_warp *w)
{
    const size_t m = (size_t)n + SMR_WARP_AFFINE;
    j->warp = smr_arena_take(a, 1, sizeof *j->warp);
    w->centre = smr_arena_take(a, n, 3u * sizeof(float));
    w->weight = smr_arena_take(a, n, 3u * sizeof(float));
    j->goal = smr_arena_take(a, n, 3u * sizeof(float));
    j->count = smr_arena_take(a, n, sizeof(float));
    j->system.a = smr_arena_take(a, m * m, sizeof(float));
    j->system.b = smr_arena_take(a, m, SMR_SOLVE_SIDES * sizeof(float));
    j->system.x = smr_arena_take(a, m, SMR_SOLVE_SIDES * sizeof(float));
    j->system.lu = smr_arena_take(a, m * m, sizeof(float));
    j->system.residual = smr_arena_take(a, m, SMR_SOLVE_SIDES * sizeof(float));
    j->system.pivot = smr_arena_take(a, m, sizeof(uint32_t));
}

smr_status smr_warp_bytes(uint32_t n, size_t *bytes)
{
    if (bytes == NULL)
        return SMR_E_NULL;
    if (n == 0u || n > SMR_LANDMARKS_MAX)
        return SMR_E_INPUT;
    smr_arena a = smr_arena_measure();
    job j;
    smr_warp w;
    layout(&a, n, &j, &w);
    *bytes = a.used;
    return SMR_OK;
}

/* Returns the largest distance from the first of the points xyz[n][3] to another point. */
static float extent(const float *xyz, uint32_t n)
{
    float most = 0.0f;
    for (uint32_t i = 1; i < n; i++)
        most = smr_max(most, smr_length(smr_sub(smr_get3(xyz, i), smr_load(xyz))));
    return most;
}

/* Returns the mean of n points. The sum is relative to the first point, which keeps digits. */
static smr_vec mean(const float *xyz, uint32_t n)
{
    const smr_vec first = smr_load(xyz);
    smr_vec sum = smr_v(0, 0, 0);
    for (uint32_t i = 0; i < n; i++)
        sum = smr_add(sum, smr_sub(smr_get3(xyz, i), first));
    return smr_add(first, smr_scale(sum, 1.0f / (float)n));
}

/* Writes the distinct landmarks' centres, mm from w->from, mean goals and numbers of duplicates. */
static void merge(job *j, smr_warp *w, const float *from, const float *to, uint32_t n)
{
    const float same = smr_max(SMR_SAME_MM, SMR_SAME_SHARE * extent(from, n));
    w->from = mean(from, n);
    w->to = mean(to, n);
    j->n = 0;
    for (uint32_t i = 0; i < n; i++) {
        const smr_vec p = smr_sub(smr_get3(from, i), w->from), goal = smr_sub(smr_get3(to, i), w->to);
        uint32_t k = 0;
        while (k < j->n && smr_length(smr_sub(p, smr_get3(w->centre, k))) > same)
            k++;
        float *sum = j->goal + 3u * (size_t)k;
        const int known = k < j->n;
        if (!known)
            smr_put3(w->centre, k, p);
        smr_store(sum, known ? smr_add(smr_load(sum), goal) : goal);
        j->count[k] = known ? j->count[k] + 1.0f : 1.0f;
        j->n += !known;
    }
    for (uint32_t k = 0; k < j->n; k++)
        smr_put3(j->goal, k, smr_scale(smr_get3(j->goal, k), 1.0f / j->count[k]));
}

/* Scales the centres to lengths near 1, by a power of two. Writes their principal directions and variances to *j. */
static void normalise(job *j, smr_warp *w)
{
    float unit = 1.0f, c[6] = {0}, v[9], most = 0.0f;
    for (uint32_t k = 0; k < j->n; k++)
        most = smr_max(most, smr_length(smr_get3(w->centre, k)));
    most = smr_max(most, SMR_SAME_MM);
    while (unit < most) /* the loop ends, for SMR_SAME_MM <= most < 8 SMR_COORD_MAX */
        unit *= 2.0f;
    while (unit * 0.5f >= most)
        unit *= 0.5f;
    w->per_mm = 1.0f / unit;
    for (size_t i = 0; i < 3u * (size_t)j->n; i++)
        w->centre[i] *= w->per_mm;
    const smr_vec middle = mean(w->centre, j->n);
    for (uint32_t k = 0; k < j->n; k++)
        smr_add_square(c, 1.0f, smr_sub(smr_get3(w->centre, k), middle));
    for (int i = 0; i < 6; i++)
        c[i] /= (float)j->n;
    smr_eigen(c, j->variance, v);
    for (int k = 0; k < 3; k++)
        j->axis[k] = smr_scale(smr_axis(v, k), 1.0f / SMR_SQRT(smr_max(j->variance[k], 1.0e-12f)));
}

/* Returns the kind of warp (SMR_WARP_...) with the most freedom that the landmarks determine. */
static uint32_t choose_kind(const job *j)
{
    const float largest = j->variance[0];
    if (j->n < 2u)
        return SMR_WARP_TRANSLATION;
    if (j->n >= 4u && j->variance[2] > SMR_PLANE_SHARE * largest)
        return SMR_WARP_SPLINE;
    if (!(extent(j->goal, j->n) > SMR_SAME_MM))
        return SMR_WARP_TRANSLATION;
    return j->n >= 3u && j->variance[1] > SMR_LINE_SHARE * largest ? SMR_WARP_SCALED : SMR_WARP_RIGID;
}

/* Fills the matrix [(K + lambda I) / unit, P; P^T, 0], whose entries are near 1, and the right-hand sides. */
static void fill_equations(const job *j, const smr_warp *w, float unit)
{
    const size_t n = j->n, m = n + SMR_WARP_AFFINE;
    float *a = j->system.a, *b = j->system.b;
    memset(a, 0, m * m * sizeof *a);
    memset(b, 0, m * SMR_SOLVE_SIDES * sizeof *b);
    memcpy(b, j->goal, n * SMR_SOLVE_SIDES * sizeof *b);
    for (size_t i = 0; i < n; i++) {
        const smr_vec u = smr_load(w->centre + 3u * i);
        const float p[SMR_WARP_AFFINE] = {1.0f, smr_dot(j->axis[0], u), smr_dot(j->axis[1], u), smr_dot(j->axis[2], u)};
        for (size_t k = 0; k < i; k++)
            a[i * m + k] = a[k * m + i] = -smr_length(smr_sub(u, smr_load(w->centre + 3u * k))) / unit;
        a[i * m + i] = j->lambda / j->count[i] / unit;
        for (size_t k = 0; k < SMR_WARP_AFFINE; k++)
            a[i * m + n + k] = a[(n + k) * m + i] = p[k];
    }
}

/* Fits a spline to the landmarks and writes the spline to *w. Returns 0 when the equations are singular for floats. */
static int fit_spline(job *j, smr_warp *w)
{
    const float unit = smr_max(1.0f, j->lambda);
    const float *x = j->system.x, *affine = x + SMR_SOLVE_SIDES * (size_t)j->n;
    fill_equations(j, w, unit);
    j->system.n = j->n + SMR_WARP_AFFINE;
    if (!smr_system_solve(&j->system))
        return 0;
    w->n = j->n;
    for (size_t i = 0; i < 3u * (size_t)j->n; i++)
        w->weight[i] = x[i] / unit;
    for (int r = 0; r < 3; r++) {
        const smr_vec one = smr_scale(j->axis[0], affine[3 + r]), two = smr_scale(j->axis[1], affine[6 + r]);
        smr_store(w->affine.m[r], smr_add(smr_add(one, two), smr_scale(j->axis[2], affine[9 + r])));
        w->affine.m[r][3] = affine[r];
    }
    return 1;
}

/* Fits a translation, a rigid or a scaled transform to the landmarks by least squares. Writes the transform to *w. */
static void fit_pose(const job *j, smr_warp *w, uint32_t kind)
{
    const float unit = 1.0f / w->per_mm;
    smr_fit fit;
    smr_fit_start(&fit, smr_v(0, 0, 0), smr_v(0, 0, 0)); /* a fit without pairs maps centroid to centroid */
    for (uint32_t k = 0; kind != SMR_WARP_TRANSLATION && k < j->n; k++)
        smr_fit_add(&fit, smr_scale(smr_get3(w->centre, k), unit), smr_get3(j->goal, k), j->count[k]);
    smr_pose p = smr_fit_solve(&fit, kind == SMR_WARP_SCALED);
    for (uint32_t i = 0; i < 9u; i++)
        p.m[i / 3u][i % 3u] *= unit;
    w->affine = p;
    w->n = 0;
}

smr_status smr_warp_fit(const float *from, const float *to, uint32_t n, float smoothing, void *memory, size_t bytes,
                        smr_warp **warp, uint32_t *kind)
{
    smr_arena a;
    job j = {0};
    smr_warp w = {0};
    size_t needed;
    if (from == NULL || to == NULL || warp == NULL || kind == NULL)
        return SMR_E_NULL;
    SMR_TRY(smr_arena_start(&a, memory, bytes));
    SMR_TRY(smr_warp_bytes(n, &needed));
    if (!(smoothing >= 0.0f && smoothing <= FLT_MAX) || !smr_all_within(from, 3u * (size_t)n, SMR_COORD_MAX) ||
        !smr_all_within(to, 3u * (size_t)n, SMR_COORD_MAX))
        return SMR_E_INPUT;
    if (needed > bytes)
        return SMR_E_ARENA;
    smr_arena_release(memory, bytes);
    layout(&a, n, &j, &w);
    merge(&j, &w, from, to, n);
    normalise(&j, &w);
    j.lambda = smr_min(smoothing * w.per_mm, SMR_LAMBDA_MAX);
    uint32_t chosen = choose_kind(&j);
    if (chosen == SMR_WARP_SPLINE && !fit_spline(&j, &w))
        chosen = SMR_WARP_SCALED;
    if (chosen != SMR_WARP_SPLINE)
        fit_pose(&j, &w, chosen);
    w.magic = SMR_WARP_MAGIC;
    *j.warp = w;
    *warp = j.warp;
    *kind = chosen;
    return SMR_OK;
}

/* Moves the point p by the warp. Rounding errors of the kernels' sum are added at the end: large weights cancel. */
static void warp_point(const smr_warp *w, float *p)
{
    const smr_vec u = smr_scale(smr_sub(smr_load(p), w->from), w->per_mm);
    smr_vec bend = smr_v(0, 0, 0), error = bend;
    for (uint32_t k = 0; k < w->n; k++) {
        const float *weight = w->weight + 3u * (size_t)k;
        const float r = smr_length(smr_sub(u, smr_get3(w->centre, k)));
        smr_add_exact(-weight[0] * r, &bend.x, &error.x);
        smr_add_exact(-weight[1] * r, &bend.y, &error.y);
        smr_add_exact(-weight[2] * r, &bend.z, &error.z);
    }
    smr_store(p, smr_add(smr_add(smr_pose_apply(&w->affine, u), smr_add(bend, error)), w->to));
}

smr_status smr_warp_apply(const smr_warp *warp, float *xyz, uint32_t n)
{
    if (warp == NULL || xyz == NULL)
        return SMR_E_NULL;
    if (warp->magic != SMR_WARP_MAGIC)
        return SMR_E_STATE;
    if (!smr_all_within(xyz, 3u * (size_t)n, SMR_COORD_MAX))
        return SMR_E_INPUT;
    for (uint32_t i = 0; i < n; i++)
        warp_point(warp, xyz + 3u * (size_t)i);
    return SMR_OK;
}
