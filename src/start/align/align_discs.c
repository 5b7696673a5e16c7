/* align_discs.c: pairs of samples with discs: samples of the other side, each with the tangent plane around it up to a
 * radius. In the first rounds discs serve as well as the surface, and a pair takes a fifth of the time of a pair with
 * triangles, or less. Discs are numbered along a Hilbert curve, so that boxes around a few of them are small.
 * Bounds: SMR_DISCS + SMR_TREE_WIDTH distances for a pair.
 * SPDX-License-Identifier: MIT */
#include "geometry/box_tree/hilbert_curve.h"
#include "start/align/align.h"

#define SMR_DISC_RADIUS 1.5f /* radius of a disc / radius of a circle of the mean area around a disc's centre */
#define SMR_DISC_BEYOND 0.5f /* distance beyond the edge / radius above which the edge counts as a border */
#define SMR_PER_PI 0.318309886f

/* Writes the numbers of samples, and their places on the Hilbert curve, for a piece of the n discs. */
static void place_some(const smr_align_side *side, uint32_t n, smr_piece piece, uint32_t *key, uint32_t *item)
{
    smr_box box = smr_no_box();
    for (uint32_t k = 0; k < n; k++)
        smr_box_grow(&box, side->point[smr_sample(side, k, n)]);
    for (uint32_t k = piece.first; k < piece.last; k++) {
        item[k] = smr_sample(side, k, n);
        key[k] = smr_curve_key(box, side->point[item[k]]);
    }
}

/* Sets the boxes around centres. Places behind the last of n discs lie so far away that no search reaches them. */
static void box_centres(smr_discs *d, uint32_t n)
{
    for (uint32_t i = 0; i < 3u * SMR_DISCS / SMR_TREE_WIDTH; i++) {
        const uint32_t axis = i % 3u, b = i / 3u, k = b * SMR_TREE_WIDTH;
        float low = d->x[axis][k], high = low;
        for (uint32_t j = k; j < n && j < k + SMR_TREE_WIDTH; j++) {
            low = smr_min(low, d->x[axis][j]);
            high = smr_max(high, d->x[axis][j]);
        }
        d->block[b / SMR_TREE_WIDTH].lo[axis][b % SMR_TREE_WIDTH] = low;
        d->block[b / SMR_TREE_WIDTH].hi[axis][b % SMR_TREE_WIDTH] = high;
    }
}

void smr_discs_make(smr_align_work *w, uint32_t task)
{
    smr_discs *const d = &w->discs[task / SMR_DISC_TASKS];
    const smr_align_side *const side = &w->aligner.side[task / SMR_DISC_TASKS];
    const uint32_t n = smr_min_u32(side->n, SMR_DISCS);
    uint32_t *const key = (uint32_t *)(void *)w->place, *const item = key + SMR_DISCS; /* no pose is tried yet */
    _Static_assert(SMR_ALIGN_PLACES * sizeof *w->place >= 4u * SMR_DISCS * sizeof *key, "room for keys and items");
    const uint32_t step = task % SMR_DISC_TASKS;
    if (step < SMR_DISC_PLACES)
        place_some(side, n, smr_piece_of(step, SMR_DISC_PIECE, n), key, item);
    if (step == SMR_DISC_PLACES)
        smr_curve_sort(key, item, item + SMR_DISCS, n);
    if (step <= SMR_DISC_PLACES)
        return;
    for (uint32_t k = 0; k < SMR_DISCS; k++) {
        float v[6] = {SMR_FAR, SMR_FAR, SMR_FAR, 0, 0, 0};
        if (k < n) {
            smr_store(v, side->point[item[k]]);
            smr_store(v + 3, side->normal[item[k]]);
        }
        for (uint32_t j = 0; j < 6u; j++)
            d->x[j][k] = v[j];
    }
    box_centres(d, n);
    const uint32_t apart = smr_max_u32(smr_min_u32(n, side->kept), 1u); /* samples of fewer vertices repeat */
    d->radius = SMR_DISC_RADIUS * SMR_SQRT(SMR_PER_PI * side->surface->area_mean * (float)side->kept / (float)apart);
}

/* Tests the discs from `base` on, as many as lanes, with centres nearer to p, a position and a normal, than *d2, mm^2.
 * Returns the nearest one, and sets *d2; returns `best` if none is nearer. */
static uint32_t nearest_of(const smr_discs *d, const float p[6], uint32_t base, uint32_t best, float *d2)
{
    float lane[SMR_TREE_WIDTH];
    for (uint32_t l = 0; l < SMR_TREE_WIDTH; l++) {
        const uint32_t i = base + l;
        const float x = p[0] - d->x[0][i], y = p[1] - d->x[1][i], z = p[2] - d->x[2][i];
        const float cosine = p[3] * d->x[3][i] + p[4] * d->x[4][i] + p[5] * d->x[5][i];
        lane[l] = cosine < SMR_AGREE ? SMR_FAR : x * x + y * y + z * z;
    }
    for (uint32_t l = 0; l < SMR_TREE_WIDTH; l++)
        if (lane[l] < *d2) {
            *d2 = lane[l];
            best = base + l;
        }
    return best;
}

/* Returns the disc whose centre is nearest to p, within the squared distance d2, mm^2; SMR_NONE: there is none. first:
 * SMR_NONE, or a disc that may be near. */
static uint32_t nearest(const smr_discs *d, const float p[6], uint32_t first, float d2)
{
    float box2[SMR_TREE_WIDTH];
    uint32_t best = SMR_NONE;
    if (first != SMR_NONE)
        best = nearest_of(d, p, first / SMR_TREE_WIDTH * SMR_TREE_WIDTH, best, &d2);
    for (uint32_t h = 0; h < SMR_DISC_NODES; h++) {
        uint32_t near = smr_box_distances(&d->block[h], smr_load(p), d2, box2);
        for (; near != 0u; near &= near - 1u) {
            const uint32_t b = (uint32_t)__builtin_ctz(near);
            if (box2[b] < d2)
                best = nearest_of(d, p, (h * SMR_TREE_WIDTH + b) * SMR_TREE_WIDTH, best, &d2);
        }
    }
    return best;
}

static smr_vec normal_of(const smr_discs *d, uint32_t i) { return smr_v(d->x[3][i], d->x[4][i], d->x[5][i]); }

/* Returns the point of disc i that is closest to p. */
static smr_vec closest_on(const smr_discs *d, uint32_t i, smr_vec p)
{
    const smr_vec centre = smr_v(d->x[0][i], d->x[1][i], d->x[2][i]), n = normal_of(d, i);
    const smr_vec off = smr_sub(p, centre), along = smr_sub(off, smr_scale(n, smr_dot(off, n)));
    const float length = smr_length(along);
    return smr_add(centre, smr_scale(along, length > d->radius ? d->radius / length : 1.0f));
}

void smr_discs_find(const smr_aligner *a, const smr_discs *d, uint32_t side, const smr_pose *pose, smr_piece piece)
{
    const smr_align_side *const from = &a->side[side];
    const smr_pose move = side == SMR_MODEL ? *pose : smr_pose_invert(pose);
    const float scale = side == SMR_MODEL ? 1.0f : smr_pose_scale(pose); /* mm of the target in a mm of the discs */
    const float far = SMR_SQRT(a->far2) / scale + d->radius;
    for (uint32_t k = piece.first; k < piece.last; k++) {
        const uint32_t i = smr_sample(from, k, a->used);
        smr_pair *const pair = &from->pair[k];
        const smr_vec at = smr_pose_apply(&move, from->point[i]);
        const int is_disc = pair->triangle >= SMR_DISC && pair->triangle != SMR_NONE;
        float p[6];
        smr_store(p, at);
        smr_store(p + 3, smr_unit(smr_pose_turn(&move, from->normal[i])));
        const uint32_t found = nearest(d, p, is_disc ? pair->triangle - SMR_DISC : SMR_NONE, far * far);
        pair->d2 = a->far2;
        pair->border = 0;
        pair->triangle = SMR_NONE;
        if (found == SMR_NONE)
            continue;
        pair->at = closest_on(d, found, at);
        const smr_vec off = smr_sub(at, pair->at);
        const float d2 = smr_dot(off, off) * scale * scale, above = smr_dot(off, normal_of(d, found));
        if (!(d2 < a->far2))
            continue;
        pair->d2 = d2;
        pair->triangle = SMR_DISC + found;
        pair->border = smr_dot(off, off) - above * above > SMR_DISC_BEYOND * SMR_DISC_BEYOND * d->radius * d->radius;
    }
}
