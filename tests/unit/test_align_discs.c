/* test_align_discs.c: pairs with discs are those of a search through all discs, from any pose, at any scale, in pieces,
 * with the pairs before as a guide, with fewer samples than discs, and none is farther than the range.
 * SPDX-License-Identifier: MIT */
#include "suite.h"

#include <math.h>
#include <string.h>

#include "start/align/align.h"
#include "unit_mesh.h"

#define N 400u /* samples of a side, more than discs */

typedef struct fixture {
    smr_align_work w;
    smr_coarse_place place[SMR_ALIGN_PLACES];
    smr_surface surface;
    smr_vec point[SMR_SIDES][N], normal[SMR_SIDES][N];
    smr_pair pair[SMR_SIDES][N];
} fixture;

static smr_vec drawn(oracle_random *r, double most)
{
    const float x = (float)oracle_uniform(r, -most, most), y = (float)oracle_uniform(r, -most, most);
    return smr_v(x, y, (float)oracle_uniform(r, -most, most));
}

/* Draws n samples of each side; of a bare side without normals. */
static void draw(fixture *f, oracle_random *r, uint32_t n, int bare)
{
    f->surface = (smr_surface){.area_mean = 4.0f};
    f->w.place = f->place;
    for (uint32_t s = 0; s < SMR_SIDES; s++) {
        f->w.aligner.side[s] = (smr_align_side){.surface = &f->surface,
                                                .kept = n,
                                                .n = n,
                                                .point = f->point[s],
                                                .normal = f->normal[s],
                                                .pair = f->pair[s],
                                                .bare = (uint32_t)bare,
                                                .outward = 1.0f};
        for (uint32_t i = 0; i < n; i++) {
            f->point[s][i] = drawn(r, 50.0);
            f->normal[s][i] = bare ? smr_v(0, 0, 0) : smr_unit(drawn(r, 1.0));
            f->pair[s][i].triangle = SMR_NONE;
        }
    }
    for (uint32_t task = 0; task < SMR_SIDES * SMR_DISC_TASKS; task++)
        smr_discs_make(&f->w, task);
}

/* The squared distance of the nearest disc's centre with an agreeing normal, by a search through all. */
static float nearest_of_all(const smr_discs *d, smr_vec p, smr_vec normal, int bare)
{
    float least = FLT_MAX;
    for (uint32_t i = 0; i < SMR_DISCS; i++) {
        const smr_vec off = smr_sub(p, smr_v(d->x[0][i], d->x[1][i], d->x[2][i]));
        if (bare || !(smr_dot(normal, smr_v(d->x[3][i], d->x[4][i], d->x[5][i])) < SMR_AGREE))
            least = fminf(least, smr_dot(off, off));
    }
    return least;
}

static void check(fixture *f, uint32_t side, const smr_pose *pose, int bare)
{
    const smr_align_side *from = &f->w.aligner.side[side];
    const smr_discs *d = &f->w.discs[side == SMR_MODEL ? SMR_TARGET : SMR_MODEL];
    const smr_pose move = side == SMR_MODEL ? *pose : smr_pose_invert(pose);
    const float scale = side == SMR_MODEL ? 1.0f : smr_pose_scale(pose), range2 = f->w.aligner.far2;
    uint32_t with = 0;
    for (uint32_t k = 0; k < from->n; k++) {
        const smr_pair *pair = &from->pair[k];
        const smr_vec p = smr_pose_apply(&move, from->point[k]);
        const smr_vec normal = smr_unit(smr_pose_turn(&move, from->normal[k]));
        const float least = nearest_of_all(d, p, normal, bare), far = sqrtf(range2) / scale + d->radius;
        assert_int_equal(pair->triangle != SMR_NONE, least < far * far);
        assert_true(pair->d2 <= range2);
        if (pair->triangle == SMR_NONE)
            continue;
        const uint32_t i = pair->triangle - SMR_DISC;
        const smr_vec centre = smr_v(d->x[0][i], d->x[1][i], d->x[2][i]), n = smr_v(d->x[3][i], d->x[4][i], d->x[5][i]);
        const smr_vec off = smr_sub(p, centre), on = smr_sub(pair->at, centre), left = smr_sub(p, pair->at);
        assert_float_equal(smr_dot(off, off), least, 1e-3f * least + 1e-3f);
        assert_true(smr_length(on) <= d->radius * 1.001f + 1e-4f && fabsf(smr_dot(on, n)) < 1e-3f);
        assert_float_equal(pair->d2, fminf(smr_dot(left, left) * scale * scale, range2), 1e-2f * range2);
        with++;
    }
    assert_true((with > 0u || from->n < N) && with < from->n); /* some of many, but not all, are in range */
}

static void run(uint32_t seed, uint32_t n, int bare)
{
    static fixture f;
    static smr_pair before[N];
    oracle_random r = oracle_seed(seed);
    draw(&f, &r, n, bare);
    for (uint32_t trial = 0; trial < 20u; trial++) {
        double turn[9];
        smr_pose pose;
        const float scale = (float)oracle_uniform(&r, 0.5, 2.0);
        oracle_rotation(&r, turn);
        for (uint32_t i = 0; i < 12u; i++)
            pose.m[i / 4u][i % 4u] =
                i % 4u < 3u ? scale * (float)turn[i / 4u * 3u + i % 4u] : (float)oracle_uniform(&r, -30.0, 30.0);
        f.w.aligner.used = n;
        f.w.aligner.far2 = 100.0f;
        for (uint32_t side = 0; side < SMR_SIDES; side++) {
            const smr_discs *d = &f.w.discs[side == SMR_MODEL ? SMR_TARGET : SMR_MODEL];
            smr_discs_find(&f.w.aligner, d, side, &pose, (smr_piece){0, n});
            check(&f, side, &pose, bare);
            memcpy(before, f.pair[side], sizeof before);
            for (uint32_t k = 0; k < n; k += 7u) /* the pairs before are the guide */
                smr_discs_find(&f.w.aligner, d, side, &pose, (smr_piece){k, smr_min_u32(k + 7u, n)});
            for (uint32_t k = 0; k < n; k++)
                assert_true(before[k].triangle == f.pair[side][k].triangle && before[k].d2 == f.pair[side][k].d2);
        }
    }
}

TEST(more_samples_than_discs) { run(1, N, 0); }
TEST(fewer_samples) { run(2, 37, 0); }
TEST(without_normals) { run(3, N, 1); }
