/* align_coarse_search.c: the coarse search of start poses. Method: 192 rotations between the principal axes (those of a
 * cube, each also after 45 degrees about an axis and 60 about a diagonal) times 7 translations: centroid onto centroid,
 * and for each axis of the target the lower or the upper ends onto each other, without the part beyond the shorter
 * surface. Parts of a surface have other axes and centroids than the whole, but often share an end. In the cost of a
 * pose each sample takes its best partner. The squared distance of a pair has full weight across the target's surface
 * and less along it, since samples are not opposite each other; differing normals add to it.
 * The cost by all samples is computed only where the cost by the first few promises one of the best poses.
 * Bounds: 192 * 7 poses of SMR_COARSE_FEW squared + SMR_COARSE squared pairs.
 * SPDX-License-Identifier: MIT */
#include "base/bytes.h"
#include "geometry/rotation/rotation.h"
#include "start/align/align.h"

#define SMR_COARSE_WIDE 8.0f   /* squared outlier limit of the first round of a coarse refinement / that of the last */
#define SMR_COARSE_LEAST 0.05f /* smallest sum of weights of a coarse refinement; a side's sum is 1 */
#define SMR_ROUGH 0.05f        /* largest difference assumed between costs by the first few and by all samples */
#define SMR_TAG 127u           /* bits of a cost that hold the number of a sample */
#define SMR_COARSE_LIMIT 0.15f /* distance beyond which samples do not match / smaller spread; above their spacing */
#define SMR_ALONG 0.3f         /* weight of the squared distance along the surface, where the distance across has 1 */
#define SMR_ACROSS 0.83666003f /* sqrt(1 - SMR_ALONG) */
#define SMR_CUBE 24u           /* number of rotations of a cube */
#define SMR_TURNS 8u           /* number of further rotations; each is combined with all rotations of the cube */
#define SMR_EDGE 0.785398163f  /* rad: 45 degrees, the angle of a further rotation about an axis */
#define SMR_DIAG 0.604599788f  /* rad: each component of the rotation vector of 60 degrees about (1, 1, 1) */
#define SMR_END_SLACK 0.01f    /* tolerance at the shorter surface's ends / its length, for rounding */

/* Computes the weights of a side's first n coarse samples: the area of the samples that are nearest to each. */
static void weigh(smr_coarse *c, const smr_align_side *s, uint32_t side, uint32_t n)
{
    float *const weight = c->weight[n == SMR_COARSE][side], all = 1.0e-6f;
    memset(weight, 0, n * sizeof *weight);
    for (uint32_t i = 0; i < s->n; i++) {
        weight[s->pair[i].border] += s->weight[i];
        all += s->weight[i];
    }
    for (uint32_t k = 0; k < n; k++)
        weight[k] /= all;
}

/* Chooses the coarse samples of a side: the sample farthest from the centroid, then always the sample farthest from all
 * chosen ones. pair[i].d2 and border: squared distance to the nearest chosen sample, mm^2, and its number. */
static void choose(smr_coarse *c, const smr_align_side *s, uint32_t side)
{
    smr_vec at = s->centre;
    for (uint32_t i = 0; i < s->n; i++)
        s->pair[i].d2 = FLT_MAX;
    for (uint32_t k = 0, next = 0; k <= SMR_COARSE; k++) {
        for (uint32_t i = 0; i < s->n; i++) {
            const smr_vec d = smr_sub(s->point[i], at);
            const float d2 = smr_dot(d, d);
            if (k == 1u || d2 < s->pair[i].d2) {
                s->pair[i].d2 = d2;
                s->pair[i].border = k == 0u ? 0u : k - 1u;
            }
            next = i == 0u || s->pair[i].d2 > s->pair[next].d2 ? i : next;
        }
        if (k == SMR_COARSE_FEW || k == SMR_COARSE)
            weigh(c, s, side, k);
        if (k < SMR_COARSE) {
            c->point[side][k] = at = s->point[next];
            c->normal[side][k] = s->normal[next];
        }
    }
}

void smr_coarse_take(smr_coarse *c, const smr_aligner *a)
{
    const float limit = SMR_COARSE_LIMIT * smr_aligner_spread(a);
    const int faced = !a->side[SMR_TARGET].bare && !a->side[SMR_MODEL].bare;
    c->bend = limit * limit;
    c->along = faced ? SMR_ALONG : 1.0f;
    for (uint32_t side = 0; side < SMR_SIDES; side++)
        choose(c, &a->side[side], side);
    /* cost of samples p and t with normals m and n: along |p - t|^2 + (1 - along) (n (p - t))^2 + bend (1 - m n) */
    for (uint32_t k = 0; k < SMR_COARSE; k++) {
        const smr_vec p = c->point[SMR_TARGET][k], n = smr_scale(c->normal[SMR_TARGET][k], faced ? SMR_ACROSS : 0.0f);
        const float term[8] = {c->along * smr_dot(p, p) + (faced ? c->bend : 0.0f),
                               -2.0f * c->along * p.x,
                               -2.0f * c->along * p.y,
                               -2.0f * c->along * p.z,
                               smr_dot(n, p),
                               n.x,
                               n.y,
                               n.z};
        for (uint32_t j = 0; j < 8u; j++)
            c->term[k / SMR_COARSE_LANES][j][k % SMR_COARSE_LANES] = term[j];
    }
}

/* Returns the position of sample i of a side, mm; the pose rotates and scales, but does not shift, the model's. */
static smr_vec coarse_point(const smr_coarse *c, uint32_t side, uint32_t i, const smr_pose *pose)
{
    return side == SMR_MODEL ? smr_pose_turn(pose, c->point[side][i]) : c->point[side][i];
}

/* Returns a cost with the number of a sample in its lowest bits, so that the least cost names the sample. */
static inline float tagged(float cost, uint32_t number)
{
    return smr_float_of((smr_float_bits(cost) & ~SMR_TAG) | number);
}

/* Compares p, a sample of the model moved by the pose, with n samples of the target. number: that of p. best[]: least
 * tagged cost of each target sample so far, mm^2. Returns the least tagged cost of p. */
static float pair_with_all(const smr_coarse *c, uint32_t n, uint32_t number, smr_vec p, smr_vec normal,
                           float *restrict best)
{
    const float own = c->along * smr_dot(p, p);
    const smr_vec turned = smr_scale(normal, c->bend / SMR_ACROSS);
    float lane[SMR_COARSE_LANES], least = FLT_MAX;
    for (uint32_t k = 0; k < SMR_COARSE_LANES; k++)
        lane[k] = FLT_MAX;
    for (uint32_t base = 0; base < n; base += SMR_COARSE_LANES) {
        const float(*const t)[SMR_COARSE_LANES] = c->term[base / SMR_COARSE_LANES];
        for (uint32_t k = 0; k < SMR_COARSE_LANES; k++) {
            const float across = p.x * t[5][k] + p.y * t[6][k] + p.z * t[7][k] - t[4][k];
            const float facing = turned.x * t[5][k] + turned.y * t[6][k] + turned.z * t[7][k];
            const float along = p.x * t[1][k] + p.y * t[2][k] + p.z * t[3][k] + (t[0][k] + own);
            const float cost = along - facing + across * across;
            const float mine = tagged(cost, base + k), other = tagged(cost, number);
            lane[k] = mine < lane[k] ? mine : lane[k];
            best[base + k] = other < best[base + k] ? other : best[base + k];
        }
    }
    for (uint32_t k = 0; k < SMR_COARSE_LANES; k++)
        least = smr_min(least, lane[k]);
    return least;
}

/* Returns the cost of a pose by n coarse samples, 0 .. 1.5. 0: all samples match; 1.5: none does. best[]: the least
 * tagged cost of each sample, mm^2; moved[]: positions of the model's samples under the pose. */
static float coarse_cost(const smr_coarse *c, uint32_t n, const smr_pose *pose, float best[SMR_SIDES][SMR_COARSE],
                         smr_vec moved[SMR_COARSE])
{
    const float unit = 1.0f / smr_pose_scale(pose), (*weight)[SMR_COARSE] = c->weight[n == SMR_COARSE];
    float sum[SMR_SIDES] = {0.0f, 0.0f};
    for (uint32_t i = 0; i < n; i++)
        best[SMR_TARGET][i] = FLT_MAX;
    for (uint32_t i = 0; i < n; i++) {
        moved[i] = smr_pose_apply(pose, c->point[SMR_MODEL][i]);
        const smr_vec normal = smr_scale(smr_pose_turn(pose, c->normal[SMR_MODEL][i]), unit);
        best[SMR_MODEL][i] = pair_with_all(c, n, i, moved[i], normal, best[SMR_TARGET]);
    }
    for (uint32_t side = 0; side < SMR_SIDES; side++)
        for (uint32_t i = 0; i < n; i++)
            sum[side] += weight[side][i] * smr_min(best[side][i], c->bend);
    return smr_cost_of_sides(sum[SMR_MODEL] / c->bend, sum[SMR_TARGET] / c->bend);
}

/* Adds the pairs of a side to the fit from model to target, with Tukey's weights up to the squared limit, mm^2. A pair
 * moves the model's sample by the steepest descent of the pair's cost: across the target's surface, less along it. */
static void add_pairs(const smr_coarse *c, uint32_t side, const float *best, const smr_vec *moved, float limit2,
                      int mirrored, smr_fit *fit)
{
    for (uint32_t i = 0; i < SMR_COARSE; i++) {
        const uint32_t other = smr_float_bits(best[i]) & SMR_TAG;
        const uint32_t m = side == SMR_MODEL ? i : other, t = side == SMR_MODEL ? other : i;
        const float left = 1.0f - best[i] / limit2, weight = c->weight[1][side][i];
        if (!(left * weight > 0.0f))
            continue;
        const smr_vec d = smr_sub(c->point[SMR_TARGET][t], moved[m]), n = c->normal[SMR_TARGET][t];
        const smr_vec way = smr_add(smr_scale(d, c->along), smr_scale(n, (1.0f - c->along) * smr_dot(d, n)));
        smr_vec x = c->point[SMR_MODEL][m];
        x.x = mirrored ? -x.x : x.x;
        smr_fit_add(fit, x, smr_add(moved[m], way), left * left * weight);
    }
}

int smr_coarse_refine(const smr_coarse *c, smr_pose *pose, float *cost)
{
    float best[SMR_SIDES][SMR_COARSE];
    smr_vec moved[SMR_COARSE];
    for (float wide = SMR_COARSE_WIDE; wide >= 1.0f; wide *= 0.5f) {
        smr_fit fit;
        smr_fit_start(&fit, smr_v(0, 0, 0), smr_v(0, 0, 0));
        (void)coarse_cost(c, SMR_COARSE, pose, best, moved);
        for (uint32_t side = 0; side < SMR_SIDES; side++)
            add_pairs(c, side, best[side], moved, wide * c->bend, smr_pose_mirrors(pose), &fit);
        if (!(fit.weight > SMR_COARSE_LEAST) || !smr_pose_fit(&fit, 0, pose))
            return 0;
    }
    *cost = coarse_cost(c, SMR_COARSE, pose, best, moved);
    return 1;
}

/* Writes the k-th of the 24 rotations of a cube: a permutation of axes with signs whose determinant is 1. */
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

/* Writes the product a b of two row-major matrices to out. */
static void multiply(const float a[9], const float b[9], float out[9])
{
    for (uint32_t i = 0; i < 9u; i++) {
        const float *row = a + i / 3u * 3u, *column = b + i % 3u;
        out[i] = row[0] * column[0] + row[1] * column[3] + row[2] * column[6];
    }
}

/* Sets the k-th rotation of the search, B C T A^T: A and B are the axes of model and target, C a cube's rotation, T the
 * further rotation, which for the mirror image also reflects the model's longest axis. */
static void set_rotation(const smr_aligner *a, uint32_t k, float scale, int mirrored, smr_pose *pose)
{
    static const float turn[3][SMR_TURNS] = {
        {0, SMR_EDGE, 0, 0, SMR_DIAG, -SMR_DIAG, SMR_DIAG, SMR_DIAG},
        {0, 0, SMR_EDGE, 0, SMR_DIAG, SMR_DIAG, -SMR_DIAG, SMR_DIAG},
        {0, 0, 0, SMR_EDGE, SMR_DIAG, SMR_DIAG, SMR_DIAG, -SMR_DIAG}}; /* x, y, z of rotation vectors, radians */
    const float *from = a->side[SMR_MODEL].axes;
    const float back[9] = {from[0], from[3], from[6], from[1], from[4], from[7], from[2], from[5], from[8]};
    float c[9], t[9], ct[9], bct[9], r[9];
    cube_rotation(k % SMR_CUBE, c);
    const uint32_t further = k / SMR_CUBE;
    smr_rodrigues(smr_v(turn[0][further], turn[1][further], turn[2][further]), t); /* writes T - I to t */
    for (uint32_t i = 0; i < 3u; i++) {
        t[4u * i] += 1.0f;
        t[3u * i] = mirrored ? -t[3u * i] : t[3u * i];
    }
    multiply(c, t, ct);
    multiply(a->side[SMR_TARGET].axes, ct, bct);
    multiply(bct, back, r);
    for (uint32_t i = 0; i < 9u; i++)
        pose->m[i / 3u][i % 3u] = r[i] * scale;
}

/* Returns the direction of a principal axis of the target, 0 the longest. */
static smr_vec target_axis(const smr_aligner *a, uint32_t axis)
{
    const float *const m = a->side[SMR_TARGET].axes;
    return smr_v(m[axis], m[3u + axis], m[6u + axis]);
}

/* Writes the smallest and the largest coordinate of a side's samples along a direction, mm. */
static void find_ends(const smr_coarse *c, uint32_t side, const smr_pose *pose, smr_vec along, float end[2])
{
    end[0] = FLT_MAX;
    end[1] = -FLT_MAX;
    for (uint32_t i = 0; i < SMR_COARSE_FEW; i++) {
        const float at = smr_dot(coarse_point(c, side, i, pose), along);
        end[0] = smr_min(end[0], at);
        end[1] = smr_max(end[1], at);
    }
}

/* Returns the mean of those samples of a side whose coordinate along `axis` lies between lo and hi, mm. */
static smr_vec centre_between(const smr_coarse *c, uint32_t side, const smr_pose *pose, smr_vec axis, float lo,
                              float hi)
{
    smr_vec sum = smr_v(0, 0, 0);
    float n = 0.0f;
    for (uint32_t i = 0; i < SMR_COARSE_FEW; i++) {
        const smr_vec p = coarse_point(c, side, i, pose);
        const float at = smr_dot(p, axis);
        if (at < lo || at > hi)
            continue;
        sum = smr_add(sum, p);
        n += 1.0f;
    }
    return smr_scale(sum, 1.0f / smr_max(n, 1.0f));
}

/* Sets the pose's translation: centroids onto each other (k = 0), or ends along the target's axis (k - 1) / 2. end[]:
 * both ends of both sides along the axis, mm; the model's are written here with the first of the axis' two ends. */
static void set_shift(const smr_aligner *a, const smr_coarse *c, uint32_t k, float end[SMR_SIDES][2], smr_pose *pose)
{
    if (k == 0u) {
        smr_pose_through(pose, a->side[SMR_MODEL].centre, a->side[SMR_TARGET].centre);
        return;
    }
    const smr_vec along = target_axis(a, (k - 1u) / 2u);
    const uint32_t upper = (k - 1u) % 2u;
    if (!upper)
        find_ends(c, SMR_MODEL, pose, along, end[SMR_MODEL]);
    const float *const m = end[SMR_MODEL], *const t = end[SMR_TARGET];
    const float by = t[upper] - m[upper], length = smr_min(m[1] - m[0], t[1] - t[0]), slack = SMR_END_SLACK * length;
    const float lo = (upper ? t[1] - length : t[0]) - slack, hi = (upper ? t[1] : t[0] + length) + slack;
    const smr_vec from = centre_between(c, SMR_MODEL, pose, along, lo - by, hi - by);
    const smr_vec move = smr_sub(centre_between(c, SMR_TARGET, pose, along, lo, hi), from);
    smr_pose_through(pose, smr_v(0, 0, 0), smr_add(move, smr_scale(along, by - smr_dot(move, along))));
}

void smr_align_search(const smr_aligner *a, const smr_coarse *c, float scale, uint32_t n_shifts, int mirrored,
                      smr_pose_list *found)
{
    float least[SMR_SIDES][SMR_COARSE], end[3][SMR_SIDES][2];
    smr_vec moved[SMR_COARSE];
    for (uint32_t axis = 0; axis < 3u; axis++)
        find_ends(c, SMR_TARGET, NULL, target_axis(a, axis), end[axis][SMR_TARGET]);
    for (uint32_t k = 0; k < SMR_CUBE * SMR_TURNS; k++) {
        smr_pose pose;
        smr_pose_list best;
        smr_list_start(&best, 2);
        set_rotation(a, k, scale, mirrored, &pose);
        for (uint32_t s = 0; s < n_shifts; s++) {
            set_shift(a, c, s, end[s > 0u ? (s - 1u) / 2u : 0u], &pose);
            const float rough = coarse_cost(c, SMR_COARSE_FEW, &pose, least, moved);
            if (found->n < found->most || rough < found->cost[found->n - 1u] + SMR_ROUGH)
                smr_list_insert(&best, &pose, coarse_cost(c, SMR_COARSE, &pose, least, moved));
        }
        for (uint32_t i = 0; i < best.n; i++)
            smr_list_insert(found, &best.pose[i], best.cost[i]);
    }
}
