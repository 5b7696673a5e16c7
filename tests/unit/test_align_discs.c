/* test_align_discs.c: pairs with discs are those of a search through all discs, from any pose, at any scale, in pieces,
 * with the pairs before as a guide, with fewer samples than discs, and none is farther than the range; where the region
 * of a part ends.
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

/* Draws n samples of each side. */
static void draw(fixture *f, oracle_random *r, uint32_t n)
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
                                                .outward = 1.0f};
        for (uint32_t i = 0; i < n; i++) {
            f->point[s][i] = drawn(r, 50.0);
            f->normal[s][i] = smr_unit(drawn(r, 1.0));
            f->pair[s][i].triangle = SMR_NONE;
        }
    }
    for (uint32_t task = 0; task < SMR_SIDES * SMR_DISC_TASKS; task++)
        smr_discs_make(&f->w, task);
}

/* The disc whose centre is nearest, with an agreeing normal, by a search through all; SMR_NONE: none agrees. */
static uint32_t nearest_of_all(const smr_discs *d, smr_vec p, smr_vec normal)
{
    float least = SMR_FAR;
    uint32_t best = SMR_NONE;
    for (uint32_t i = 0; i < SMR_DISCS; i++) {
        const smr_vec off = smr_sub(p, smr_v(d->x[0][i], d->x[1][i], d->x[2][i]));
        if (!(smr_dot(normal, smr_v(d->x[3][i], d->x[4][i], d->x[5][i])) < SMR_AGREE) && smr_dot(off, off) < least) {
            least = smr_dot(off, off);
            best = i;
        }
    }
    return best;
}

static void check(fixture *f, uint32_t side, const smr_pose *pose)
{
    const smr_align_side *from = &f->w.aligner.side[side];
    const smr_discs *d = &f->w.discs[side == SMR_MODEL ? SMR_TARGET : SMR_MODEL];
    const smr_pose move = side == SMR_MODEL ? *pose : smr_pose_invert(pose);
    const float scale = side == SMR_MODEL ? 1.0f : smr_pose_scale(pose), range = sqrtf(f->w.aligner.far2);
    uint32_t with = 0, beyond = 0;
    for (uint32_t k = 0; k < from->n; k++) {
        const smr_pair *pair = &from->pair[k];
        const smr_vec p = smr_pose_apply(&move, from->point[k]);
        const uint32_t i = nearest_of_all(d, p, smr_unit(smr_pose_turn(&move, from->normal[k])));
        float at = SMR_FAR, along = 0.0f; /* distance of the disc, and from its centre along its plane */
        if (i != SMR_NONE) {
            const smr_vec n = smr_v(d->x[3][i], d->x[4][i], d->x[5][i]);
            const smr_vec off = smr_sub(p, smr_v(d->x[0][i], d->x[1][i], d->x[2][i]));
            const float above = smr_dot(off, n),
                        out = fmaxf(0.0f, (along = sqrtf(smr_dot(off, off) - above * above)) - d->radius);
            at = scale * sqrtf(above * above + out * out);
        }
        if (fabsf(at - range) > 1e-3f)
            assert_int_equal(pair->triangle, at < range ? SMR_DISC + i : SMR_NONE);
        assert_float_equal(pair->d2, fminf(at * at, range * range), 2e-3f * range * range);
        if (pair->triangle == SMR_NONE)
            continue;
        assert_float_equal(scale * smr_length(smr_sub(p, pair->at)), at, 1e-2f);
        if (fabsf(along - 1.5f * d->radius) > 1e-2f)
            assert_int_equal(pair->border, along > 1.5f * d->radius);
        beyond += pair->border;
        with++;
    }
    assert_true((with > 0u || from->n < N) && with < from->n &&
                beyond <= with); /* some of many, not all, are in range */
}

static void run(uint32_t seed, uint32_t n)
{
    static fixture f;
    static smr_pair before[N];
    oracle_random r = oracle_seed(seed);
    draw(&f, &r, n);
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
            check(&f, side, &pose);
            memcpy(before, f.pair[side], sizeof before);
            for (uint32_t k = 0; k < n; k += 7u) /* the pairs before are the guide */
                smr_discs_find(&f.w.aligner, d, side, &pose, (smr_piece){k, smr_min_u32(k + 7u, n)});
            for (uint32_t k = 0; k < n; k++)
                assert_true(before[k].triangle == f.pair[side][k].triangle && before[k].d2 == f.pair[side][k].d2);
        }
    }
}

TEST(more_samples_than_discs) { run(1, N); }
TEST(fewer_samples) { run(2, 37); }

/* Each rotation about a joint leaves the joint where the given pose has it, from the first part of its comparison on;
 * the middle one is the given pose. */
TEST(turns_about_a_joint)
{
    static const smr_aligner a;
    static smr_coarse c = {.limit = 1.0f}; /* without samples of the target */
    static const smr_coarse_search search = {.scale = 1.0f,
                                             .n_shifts = 1,
                                             .jointed = 1,
                                             .given = {{{0, -1, 0, 5}, {1, 0, 0, -7}, {0, 0, 1, 3}}},
                                             .joint = {30, -20, 10}};
    static smr_coarse_place to;
    const uint32_t middle = SMR_JOINT_STEPS * SMR_JOINT_STEPS * SMR_JOINT_STEPS / 2u;
    for (uint32_t i = 0; i < 3u * SMR_COARSE_BLOCKS; i++) {
        smr_node *const block = &c.block[i / 3u / SMR_TREE_WIDTH];
        block->lo[i % 3u][i / 3u % SMR_TREE_WIDTH] = block->hi[i % 3u][i / 3u % SMR_TREE_WIDTH] = SMR_FAR;
    }
    for (uint32_t number = 0; number <= middle; number++) {
        smr_align_try(&a, &c, &search, number, 0, &to);
        const smr_vec at = smr_pose_apply(&to.pose, search.joint), had = smr_pose_apply(&search.given, search.joint);
        assert_true(smr_length(smr_sub(at, had)) < 1.0e-3f);
        assert_int_equal(number == middle, memcmp(&to.pose, &search.given, sizeof to.pose) == 0);
    }
}

/* The region of a target that a part shares holds points up to the part's reach, that distance included. */
TEST(a_region_ends_at_the_reach)
{
    const smr_align_mask mask = {.centre = smr_v(1, 2, 3), .reach2 = 25.0f};
    const smr_vec up = smr_v(0, 0, 1);
    assert_true(smr_mask_holds(&mask, NULL, smr_v(4, 6, 3), up) && smr_mask_holds(&mask, NULL, mask.centre, up));
    assert_false(smr_mask_holds(&mask, NULL, smr_v(4, 6.001f, 3), up));
}
