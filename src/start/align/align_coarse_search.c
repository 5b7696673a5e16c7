/* align_coarse_search.c: the coarse search of start poses. Method: 192 rotations between the principal axes (those of a
 * cube, each also after 45 degrees about an axis and 60 about a diagonal) times 7 translations: centroid onto centroid,
 * and for each axis of the target the lower or the upper ends onto each other, without the part beyond the shorter
 * surface. About a joint: 343 rotations of the given pose. Parts of a surface have other axes and centroids than the
 * whole, but often share an end. In the cost of a pose each sample takes its best partner. The squared distance of a
 * pair has full weight across the target's surface and less along it, since samples are not opposite each other;
 * differing normals add to it. The target's samples are sorted along an axis, so that a sample of the model skips
 * slices that are too far away to match.
 * Bounds: 192 * 7 poses of SMR_COARSE squared pairs.
 * SPDX-License-Identifier: MIT */
#include "base/bytes.h"
#include "geometry/box_tree/hilbert_curve.h"
#include "start/align/align.h"
#include "geometry/rotation/rotation.h"

#define SMR_COARSE_LIMIT 0.15f /* distance beyond which samples do not match / smaller spread; above their spacing */
#define SMR_ALONG 0.3f         /* weight of the squared distance along the surface, where the distance across has 1 */
#define SMR_NO_MATCH 3.4f /* squared distance / squared limit above which no pair matches: 1 / SMR_ALONG and rounding */
#define SMR_EDGE 0.785398163f /* rad: 45 degrees, the angle of a further rotation about an axis */
#define SMR_DIAG 0.604599788f /* rad: each component of the rotation vector of 60 degrees about (1, 1, 1) */
#define SMR_TURN 0.523598776f /* rad: 30 degrees between rotation vectors about a joint, along each axis */
#define SMR_END_SLACK 0.01f   /* tolerance at the shorter surface's ends / its length, for rounding */

void smr_coarse_take(smr_coarse *c, const smr_aligner *a)
{
    c->faced = a->side[SMR_TARGET].bare || a->side[SMR_MODEL].bare ? 0.0f : 1.0f;
    c->limit = SMR_COARSE_LIMIT * smr_aligner_spread(a);
    for (uint32_t side = 0; side < SMR_SIDES; side++) {
        float all = 1.0e-6f;
        for (uint32_t k = 0; k < SMR_COARSE; k++) {
            const uint32_t i = smr_sample(&a->side[side], k, SMR_COARSE);
            float v[6];
            smr_store(v, a->side[side].point[i]);
            smr_store(v + 3, a->side[side].normal[i]);
            for (uint32_t j = 0; j < 6u; j++)
                c->x[side][j][k] = v[j];
            c->weight[side][k] = a->side[side].weight[i];
            all += c->weight[side][k];
        }
        for (uint32_t k = 0; k < SMR_COARSE; k++)
            c->weight[side][k] /= all;
    }
}

void smr_coarse_sort(smr_coarse *c)
{
    float(*const x)[SMR_COARSE] = c->x[SMR_TARGET];
    uint32_t key[SMR_COARSE], item[SMR_COARSE], tmp[2u * SMR_COARSE];
    float lo[3] = {FLT_MAX, FLT_MAX, FLT_MAX}, hi[3] = {-FLT_MAX, -FLT_MAX, -FLT_MAX};
    for (uint32_t i = 0; i < 3u * SMR_COARSE; i++) {
        lo[i % 3u] = smr_min(lo[i % 3u], x[i % 3u][i / 3u]);
        hi[i % 3u] = smr_max(hi[i % 3u], x[i % 3u][i / 3u]);
    }
    uint32_t axis = hi[1] - lo[1] > hi[0] - lo[0] ? 1u : 0u;
    if (hi[2] - lo[2] > hi[axis] - lo[axis])
        axis = 2u;
    for (uint32_t k = 0; k < SMR_COARSE; k++) {
        key[k] = smr_float_bits(x[axis][k] - lo[axis]); /* bits of floats >= 0 sort as floats */
        item[k] = k;
    }
    smr_curve_sort(key, item, tmp, SMR_COARSE);
    for (uint32_t a = 0; a < 6u; a++) {
        float row[SMR_COARSE];
        memcpy(row, x[a], sizeof row);
        for (uint32_t k = 0; k < SMR_COARSE; k++)
            x[a][k] = row[item[k]];
    }
    for (uint32_t k = 0; k < SMR_COARSE; k++)
        c->place[item[k]] = k;
    for (uint32_t i = 0; i < 3u * SMR_COARSE_BLOCKS; i++) {
        const uint32_t a = i / SMR_COARSE_BLOCKS, k = i % SMR_COARSE_BLOCKS * SMR_TREE_WIDTH;
        smr_node *const block = &c->block[i % SMR_COARSE_BLOCKS / SMR_TREE_WIDTH];
        float low = SMR_FAR, high = SMR_FAR; /* a block without samples is an empty box */
        for (uint32_t j = k; j < SMR_COARSE && j < k + SMR_TREE_WIDTH; j++) {
            low = j == k ? x[a][j] : smr_min(low, x[a][j]);
            high = j == k ? x[a][j] : smr_max(high, x[a][j]);
        }
        block->lo[a][i % SMR_TREE_WIDTH] = low;
        block->hi[a][i % SMR_TREE_WIDTH] = high;
    }
}

/* Returns the position of sample i of a side, mm; the pose rotates and scales, but does not shift, the model's. */
static smr_vec coarse_point(const smr_coarse *c, uint32_t side, uint32_t i, const smr_pose *pose)
{
    const uint32_t k = side == SMR_TARGET ? c->place[i] : i;
    const smr_vec p = smr_v(c->x[side][0][k], c->x[side][1][k], c->x[side][2][k]);
    return side == SMR_MODEL ? smr_pose_turn(pose, p) : p;
}

/* Compares p, a sample of the model moved by the pose, with the target's samples from `base` on, as many as lanes.
 * best[]: smallest cost of each target sample so far, mm^2; lane[]: of p. Lanes let compilers vectorise the loop. */
static inline void pair_with_some(const smr_coarse *c, const float p[6], uint32_t base, float best[SMR_COARSE],
                                  float lane[SMR_TREE_WIDTH])
{
    const float(*t)[SMR_COARSE] = c->x[SMR_TARGET];
    const float bend = c->limit * c->limit, faced = c->faced, blind = 1.0f - faced;
    for (uint32_t k = 0; k < SMR_TREE_WIDTH; k++) {
        const uint32_t i = base + k;
        const float x = p[0] - t[0][i], y = p[1] - t[1][i], z = p[2] - t[2][i];
        const float across = x * t[3][i] + y * t[4][i] + z * t[5][i];
        const float cosine = p[3] * t[3][i] + p[4] * t[4][i] + p[5] * t[5][i];
        const float d2 = x * x + y * y + z * z;
        const float cost = SMR_ALONG * d2 + (1.0f - SMR_ALONG) * across * across + bend * (faced - cosine) +
                           blind * (1.0f - SMR_ALONG) * d2;
        lane[k] = cost < lane[k] ? cost : lane[k];
        best[i] = cost < best[i] ? cost : best[i];
    }
}

/* Compares p with the target's samples near it. Returns the smallest cost of p, mm^2, or FLT_MAX: none is near. */
static float pair_with_near(const smr_coarse *c, const float p[6], float best[SMR_COARSE])
{
    float lane[SMR_TREE_WIDTH], d2[SMR_TREE_WIDTH], least = FLT_MAX;
    for (uint32_t k = 0; k < SMR_TREE_WIDTH; k++)
        lane[k] = FLT_MAX;
    for (uint32_t h = 0; h < SMR_COARSE_BLOCKS / SMR_TREE_WIDTH; h++) {
        uint32_t near = smr_box_distances(&c->block[h], smr_load(p), SMR_NO_MATCH * c->limit * c->limit, d2);
        for (; near != 0u; near &= near - 1u)
            pair_with_some(c, p, (h * SMR_TREE_WIDTH + (uint32_t)__builtin_ctz(near)) * SMR_TREE_WIDTH, best, lane);
    }
    for (uint32_t k = 0; k < SMR_TREE_WIDTH; k++)
        least = smr_min(least, lane[k]);
    return least;
}

/* Adds part `part` of the model's samples to the cost of the pose in *to. The last part sets the cost. */
static void add_part(const smr_coarse *c, uint32_t part, smr_coarse_place *to)
{
    const float(*m)[SMR_COARSE] = c->x[SMR_MODEL];
    const float most = c->limit * c->limit, unit = 1.0f / smr_pose_scale(&to->pose);
    const uint32_t n = SMR_COARSE / SMR_COARSE_PARTS;
    float sum = 0.0f;
    for (uint32_t i = 0; i < SMR_COARSE && part == 0u; i++)
        to->best[i] = most;
    to->sum = part == 0u ? 0.0f : to->sum;
    for (uint32_t i = part * n; i < (part + 1u) * n; i++) {
        float p[6];
        smr_store(p, smr_pose_apply(&to->pose, smr_v(m[0][i], m[1][i], m[2][i])));
        smr_store(p + 3, smr_scale(smr_pose_turn(&to->pose, smr_v(m[3][i], m[4][i], m[5][i])), unit));
        to->sum += c->weight[SMR_MODEL][i] * smr_min(pair_with_near(c, p, to->best), most);
    }
    for (uint32_t i = 0; i < SMR_COARSE && part + 1u == SMR_COARSE_PARTS; i++)
        sum += c->weight[SMR_TARGET][i] * to->best[c->place[i]];
    to->cost = smr_cost_of_sides(to->sum / most, sum / most);
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

/* Writes the smallest and the largest coordinate of a side's samples along a direction, mm. */
static void find_ends(const smr_coarse *c, uint32_t side, const smr_pose *pose, smr_vec along, float end[2])
{
    end[0] = FLT_MAX;
    end[1] = -FLT_MAX;
    for (uint32_t i = 0; i < SMR_COARSE; i++) {
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
    for (uint32_t i = 0; i < SMR_COARSE; i++) {
        const smr_vec p = coarse_point(c, side, i, pose);
        const float at = smr_dot(p, axis);
        if (at < lo || at > hi)
            continue;
        sum = smr_add(sum, p);
        n += 1.0f;
    }
    return smr_scale(sum, 1.0f / smr_max(n, 1.0f));
}

/* Sets the pose's translation: centroids onto each other (k = 0), or ends along the target's axis (k - 1) / 2. */
static void set_shift(const smr_aligner *a, const smr_coarse *c, uint32_t k, smr_pose *pose)
{
    const smr_align_side *target = &a->side[SMR_TARGET];
    if (k == 0u) {
        smr_pose_through(pose, a->side[SMR_MODEL].centre, target->centre);
        return;
    }
    const uint32_t axis = (k - 1u) / 2u, end = (k - 1u) % 2u;
    const smr_vec along = smr_v(target->axes[axis], target->axes[3u + axis], target->axes[6u + axis]);
    float m[2], t[2];
    find_ends(c, SMR_MODEL, pose, along, m);
    find_ends(c, SMR_TARGET, pose, along, t);
    const float by = t[end] - m[end], length = smr_min(m[1] - m[0], t[1] - t[0]), slack = SMR_END_SLACK * length;
    const float lo = (end ? t[1] - length : t[0]) - slack, hi = (end ? t[1] : t[0] + length) + slack;
    const smr_vec from = centre_between(c, SMR_MODEL, pose, along, lo - by, hi - by);
    const smr_vec move = smr_sub(centre_between(c, SMR_TARGET, pose, along, lo, hi), from);
    smr_pose_through(pose, smr_v(0, 0, 0), smr_add(move, smr_scale(along, by - smr_dot(move, along))));
}

/* Sets the pose to the given one after the k-th rotation about the joint: vectors on a cubic grid. */
static void set_turn(const smr_coarse_search *search, uint32_t k, smr_pose *pose)
{
    const uint32_t n = SMR_JOINT_STEPS, middle = n / 2u;
    const smr_vec by =
        smr_v((float)(k % n) - (float)middle, (float)(k / n % n) - (float)middle, (float)(k / (n * n)) - (float)middle);
    float given[9], turn[9], both[9];
    smr_rodrigues(smr_scale(by, SMR_TURN), turn); /* writes the rotation - I */
    for (uint32_t i = 0; i < 9u; i++) {
        given[i] = search->given.m[i / 3u][i % 3u];
        turn[i] += i % 4u == 0u ? 1.0f : 0.0f;
    }
    multiply(given, turn, both);
    for (uint32_t i = 0; i < 9u; i++)
        pose->m[i / 3u][i % 3u] = both[i];
    smr_pose_through(pose, search->joint, smr_pose_apply(&search->given, search->joint));
}

void smr_align_try(const smr_aligner *a, const smr_coarse *c, const smr_coarse_search *search, uint32_t number,
                   uint32_t part, smr_coarse_place *to)
{
    if (part == 0u && search->jointed) {
        set_turn(search, number, &to->pose);
    } else if (part == 0u) {
        set_rotation(a, number / search->n_shifts, search->scale, search->mirrored, &to->pose);
        set_shift(a, c, number % search->n_shifts, &to->pose);
    }
    add_part(c, part, to);
}

void smr_align_tried(smr_coarse_search *search, uint32_t number, const smr_coarse_place *tried, smr_pose_list *found)
{
    const uint32_t shift = number % search->n_shifts;
    if (shift == 0u)
        smr_list_start(&search->best, 2);
    smr_list_insert(&search->best, &tried->pose, tried->cost);
    for (uint32_t i = 0; i < search->best.n && shift + 1u == search->n_shifts; i++)
        smr_list_insert(found, &search->best.pose[i], search->best.cost[i]);
}
