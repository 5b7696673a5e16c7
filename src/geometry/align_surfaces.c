/* align_surfaces.c: the start pose from two surfaces, without landmarks.
 * Method: centroids and principal axes are matched in all 24 combinations of axes and signs. Each start is refined by
 * 8 iterations of iterative closest point in both directions (ICP, Besl and McKay 1992, with agreeing normals), the
 * best 4 by 24 iterations, and the best one by config.iterations.
 * Bounds: 24 * 8 + 4 * 24 + config.iterations ICP iterations over 2 * config.samples points.
 * SPDX-License-Identifier: MIT */
#include "geometry/transform_fit.h"
#include "geometry/jacobi.h"
#include "geometry/surface.h"

#define SMR_CASES 24u /* combinations of principal axes and signs */
#define SMR_FINALISTS 4u
#define SMR_STEADY 12u     /* iterations before a refinement may end early: the end depends on rounding */
#define SMR_STANDS 0.9995f /* it ends when an iteration leaves more than this part of the mean square distance */
#define SMR_MISS_MM 100.0f /* distance that a point without any agreeing triangle counts as */

smr_align_config smr_align_config_default(void)
{
    smr_align_config c;
    memset(&c, 0, sizeof c);
    c.cookie = SMR_COOKIE('A', smr_align_config);
    c.scaled = 1;
    c.iterations = 60;
    c.samples = 600;
    return c;
}

/* Area-weighted centroid (mm), principal axes (columns, longest first) and spread (standard deviation, mm) of a
 * surface. */
static void principal(const smr_surface *s, smr_vec *centre, float axes[9], float *spread)
{
    smr_vec sum = smr_v(0, 0, 0);
    float weight = 0.0f;
    const smr_vec origin = smr_load(s->xyz);
    for (uint32_t i = 0; i < s->n_vertices; i++) {
        sum = smr_add(sum, smr_scale(smr_sub(smr_load(s->xyz + 3u * (size_t)i), origin), s->area[i]));
        weight += s->area[i];
    }
    const float inverse = weight > 0.0f ? 1.0f / weight : 0.0f;
    *centre = smr_add(origin, smr_scale(sum, inverse));
    float c[6] = {0}, value[3];
    for (uint32_t i = 0; i < s->n_vertices; i++) {
        const smr_vec d = smr_sub(smr_load(s->xyz + 3u * (size_t)i), *centre);
        const float w = s->area[i] * inverse;
        c[SMR_XX] += w * d.x * d.x;
        c[SMR_XY] += w * d.x * d.y;
        c[SMR_XZ] += w * d.x * d.z;
        c[SMR_YY] += w * d.y * d.y;
        c[SMR_YZ] += w * d.y * d.z;
        c[SMR_ZZ] += w * d.z * d.z;
    }
    *spread = SMR_SQRT(c[SMR_XX] + c[SMR_YY] + c[SMR_ZZ]);
    smr_eigen(c, value, axes);
}

/* The k-th of the 24 rotations of a cube: axis permutations with signs whose determinant is 1. */
static void cube_rotation(uint32_t k, float g[9])
{
    static const unsigned char permutation[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
    const unsigned char *p = permutation[k / 4u];
    const float odd = k / 4u >= 3u ? -1.0f : 1.0f;
    const float a = k & 1u ? -1.0f : 1.0f, b = k & 2u ? -1.0f : 1.0f;
    memset(g, 0, 9u * sizeof *g);
    g[p[0]] = a;
    g[3 + p[1]] = b;
    g[6 + p[2]] = a * b * odd;
}

/* a turned and scaled by the pose, without its translation. */
static smr_vec turn(const smr_pose *p, smr_vec a)
{
    return smr_v(p->m[0][0] * a.x + p->m[0][1] * a.y + p->m[0][2] * a.z,
                 p->m[1][0] * a.x + p->m[1][1] * a.y + p->m[1][2] * a.z,
                 p->m[2][0] * a.x + p->m[2][1] * a.y + p->m[2][2] * a.z);
}

/* The inverse of a rigid or scaled pose. */
static smr_pose invert(const smr_pose *p)
{
    const float s2 = p->m[0][0] * p->m[0][0] + p->m[1][0] * p->m[1][0] + p->m[2][0] * p->m[2][0];
    smr_pose q;
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++)
            q.m[r][c] = p->m[c][r] / s2;
    q.m[0][3] = q.m[1][3] = q.m[2][3] = 0.0f;
    const smr_vec t = turn(&q, smr_v(p->m[0][3], p->m[1][3], p->m[2][3]));
    q.m[0][3] = -t.x;
    q.m[1][3] = -t.y;
    q.m[2][3] = -t.z;
    return q;
}

/* Finds the closest point on `to` for at most `samples` vertices of `from` moved by `pose`, and adds the pairs to the
 * fit, the model's point first. Returns the mean square distance times scale^2, mm^2. */
static float collect(const smr_surface *from, const smr_surface *to, const smr_pose *pose, uint32_t samples,
                     int from_is_model, float scale, smr_fit *fit)
{
    const uint32_t n = smr_min_u32(samples, from->n_vertices);
    float sum = 0.0f;
    for (uint32_t k = 0; k < n; k++) {
        const uint32_t i = (uint32_t)(((uint64_t)2u * k + 1u) * from->n_vertices / (2u * (uint64_t)n));
        const smr_vec p = smr_load(from->xyz + 3u * (size_t)i);
        const smr_query q = {smr_pose_apply(pose, p), smr_unit(turn(pose, smr_load(from->normal + 3u * (size_t)i))),
                             0.1f, UINT32_MAX, SMR_NONE};
        smr_hit hit = {1.0e12f, SMR_NONE, {0, 0, 0}};
        smr_tree_closest(&to->facets, &q, &hit);
        if (hit.triangle == SMR_NONE) {
            sum += SMR_MISS_MM * SMR_MISS_MM;
            continue;
        }
        const smr_vec at = smr_facet_point(&to->facets, hit.triangle, hit.weight);
        smr_fit_add(fit, from_is_model ? p : at, from_is_model ? at : p, 1.0f);
        sum += hit.d2 * scale * scale;
    }
    return sum / (float)n;
}

/* Iterative closest point from *pose. Returns the last mean square distance, the sum of both directions, mm^2; FLT_MAX
 * when it fails. */
static float refine(const smr_surface *model, const smr_surface *target, uint32_t samples, uint32_t iterations,
                    int scaled, smr_pose *pose)
{
    float last = FLT_MAX;
    for (uint32_t i = 0; i < iterations; i++) {
        const smr_pose back = invert(pose);
        const float scale = smr_length(smr_v(pose->m[0][0], pose->m[1][0], pose->m[2][0]));
        smr_fit fit;
        smr_fit_start(&fit, smr_v(0, 0, 0), smr_v(0, 0, 0));
        float mean = collect(model, target, pose, samples, 1, 1.0f, &fit);
        mean += collect(target, model, &back, samples, 0, scale, &fit);
        if (!(fit.weight >= 3.0f))
            return FLT_MAX;
        if (i >= SMR_STEADY && mean > last * SMR_STANDS)
            return last;
        last = smr_min(last, mean);
        const smr_pose next = smr_fit_solve(&fit, scaled);
        const float size = smr_length(smr_v(next.m[0][0], next.m[1][0], next.m[2][0]));
        if (!(size > 0.1f && size < 10.0f))
            return FLT_MAX; /* the scale collapses onto a small area of the target */
        *pose = next;
    }
    return last;
}

/* Start pose k of 24: centroid onto centroid, principal axes onto principal axes. */
static smr_pose start(const smr_surface *model, const smr_surface *target, uint32_t k, int scaled)
{
    smr_vec from, to;
    float a[9], b[9], g[9], size_a, size_b, ga[9], r[9];
    principal(model, &from, a, &size_a);
    principal(target, &to, b, &size_b);
    cube_rotation(k, g);
    const float scale = scaled && size_a > 1.0e-6f ? smr_clamp(size_b / size_a, 0.2f, 5.0f) : 1.0f;
    for (int i = 0; i < 9; i++) /* G A^T, with G the k-th cube rotation, A and B the axes of model and target */
        ga[i] = g[i / 3 * 3] * a[i % 3 * 3] + g[i / 3 * 3 + 1] * a[i % 3 * 3 + 1] + g[i / 3 * 3 + 2] * a[i % 3 * 3 + 2];
    for (int i = 0; i < 9; i++) /* B G A^T */
        r[i] = b[i / 3 * 3] * ga[i % 3] + b[i / 3 * 3 + 1] * ga[3 + i % 3] + b[i / 3 * 3 + 2] * ga[6 + i % 3];
    const smr_vec moved = smr_scale(smr_mul(r, from), scale);
    const float t[3] = {to.x - moved.x, to.y - moved.y, to.z - moved.z};
    smr_pose pose;
    for (int i = 0; i < 3; i++) {
        for (int c = 0; c < 3; c++)
            pose.m[i][c] = r[3 * i + c] * scale;
        pose.m[i][3] = t[i];
    }
    return pose;
}

/* The best refined start poses so far, best first. */
typedef struct finalists {
    smr_pose pose[SMR_FINALISTS];
    float mean2[SMR_FINALISTS]; /* mean square distance, mm^2 */
    uint32_t n;
} finalists;

/* Inserts a pose at its place; the worst one drops out of a full list. */
static void insert_finalist(finalists *f, const smr_pose *pose, float mean2)
{
    uint32_t at = f->n < SMR_FINALISTS ? f->n++ : SMR_FINALISTS;
    for (; at > 0u && f->mean2[at - 1u] > mean2; at--) {
        if (at < SMR_FINALISTS) {
            f->mean2[at] = f->mean2[at - 1u];
            f->pose[at] = f->pose[at - 1u];
        }
    }
    if (at < SMR_FINALISTS) {
        f->mean2[at] = mean2;
        f->pose[at] = *pose;
    }
}

/* Refines all 24 starts shortly and the best of them longer. Returns the pose with the smallest distance. */
static smr_pose best_start(const smr_surface *model, const smr_surface *target, uint32_t samples, int scaled)
{
    finalists f;
    f.n = 0;
    for (uint32_t k = 0; k < SMR_CASES; k++) {
        smr_pose p = start(model, target, k, scaled);
        const float mean2 = refine(model, target, samples / 6u + 8u, 8, 0, &p);
        insert_finalist(&f, &p, mean2);
    }
    uint32_t best = 0;
    for (uint32_t i = 0; i < f.n; i++) {
        f.mean2[i] = refine(model, target, samples / 3u + 8u, 24, scaled, &f.pose[i]);
        if (f.mean2[i] < f.mean2[best])
            best = i;
    }
    return f.pose[best];
}

smr_status smr_align(const smr_surface *model, const smr_surface *target, const smr_align_config *config,
                     smr_pose *pose, float *rms_mm)
{
    if (model == NULL || target == NULL || config == NULL || pose == NULL)
        return SMR_E_NULL;
    if (!smr_surface_valid(model) || !smr_surface_valid(target))
        return SMR_E_STATE;
    if (config->cookie != SMR_COOKIE('A', smr_align_config) || config->scaled > 1u || config->iterations < 1u ||
        config->iterations > 1000u || config->samples < 16u || config->samples > 100000u)
        return SMR_E_CONFIG;
    const int scaled = config->scaled != 0u;
    smr_pose p = best_start(model, target, config->samples, scaled);
    const float mean = refine(model, target, config->samples, config->iterations, scaled, &p);
    if (!(mean < FLT_MAX))
        return SMR_E_INPUT;
    /* p is between coordinates relative to the two surfaces' origins */
    const smr_vec shift = smr_sub(target->origin, turn(&p, model->origin));
    p.m[0][3] += shift.x;
    p.m[1][3] += shift.y;
    p.m[2][3] += shift.z;
    *pose = p;
    if (rms_mm != NULL)
        *rms_mm = SMR_SQRT(mean * 0.5f);
    return SMR_OK;
}
