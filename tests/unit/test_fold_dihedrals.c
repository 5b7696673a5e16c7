/* test_fold_dihedrals.c: passes over dihedral edges, triangles and vertices, and what they may skip.
 * SPDX-License-Identifier: MIT */
#include "suite.h"

#include <string.h>

#include "property/rig.h"
#include "registration/folds/folds.h"
#include "registration/schedule_radius.h"
#include "registration/tick/iteration_steps.h"

static smr *balls(uint32_t n)
{
    const smr_mesh ball = rig_ball(30, 40, 60, (const float[3]){0, 0, 0}), three[3] = {ball, ball, ball};
    const smr_prepare_config radii = rig_radii(1, 6, 0, 0);
    const smr_config c = smr_config_default();
    return rig_init(rig_model(three, n, &radii), &c, NULL);
}

/* Touched triangles lead to every edge with a marked corner. */
TEST(test_touched_triangles)
{
    uint32_t n_found = 0, next = 0;
    smr *s = balls(1);
    smr_folds *f = &s->folds;
    const uint32_t n = s->shared.n_dihedrals;
    memset(f->touched, 0, (f->shared->n_triangles + 63u) / 64u * 8u);
    for (uint32_t i = 0, seed = 5; i < 10u; i++)
        f->marked[rig_random(&seed, s->shared.n)] = 1;
    for (uint32_t k = 0; k < s->shared.n_triangles; k++)
        if (smr_any_marked(f, k))
            smr_triangle_touch(f, k);
    for (uint32_t i = 0; i < n; i++) {
        const smr_stored_dihedral *h = smr_edge_at(f, i);
        if (!smr_any_marked(f, smr_edge_first(f, h)) && !smr_any_marked(f, smr_edge_second(f, h)))
            continue;
        assert_int_equal(i, smr_next_touched(f, next, n));
        next = i + 1u;
        n_found++;
    }
    assert_int_equal(n, smr_next_touched(f, next, n));
    assert_true(n_found > 90u);
}

/* A chunk of edges is looked at when a vertex of any of its structures was marked since. */
TEST(test_marked_since)
{
    smr *s = balls(3);
    smr_folds *f = &s->folds;
    s->schedule.repairing = 0;
    for (uint32_t task = 0; task < f->n_dihedral_tasks; task++)
        smr_fold_find(f, task, 0);
    for (uint32_t k = 0; k < 3u; k++) {
        memset(f->folding, 0, 3u * sizeof *f->folding);
        f->folding[k] = 7;
        for (uint32_t i = 0; i < s->shared.n_dihedrals; i++) {
            const smr_tally *tally = &f->tally[i / SMR_DIHEDRAL_CHUNK];
            const uint32_t v = smr_corners(f, smr_edge_first(f, smr_edge_at(f, i)))[0];
            assert_true(smr_model_owner(s->shared.model, v) != k || smr_marked_since(f, tally, 6));
            assert_int_equal(0, smr_marked_since(f, tally, 7));
        }
    }
    assert_int_equal(0, smr_marked_since(f, &f->tally[0], 6)); /* of the last structure: edges are by structure */
}

/* The items of a pass, each once: all dihedral edges, the triangles or vertices of the pass' structure, or a list. */
static uint32_t n_seen, seen[64];

static void see(smr_folds *f, uint32_t from, uint32_t to)
{
    (void)f;
    for (uint32_t i = from; i < to; i++, n_seen++)
        seen[i % 64u]++;
}

TEST(test_passes)
{
    smr_shape_structure structure[2] = {
        {.first_triangle = 0, .tree.n_triangles = 13, .n_vertices = 9},
        {.first_triangle = 13, .tree.n_triangles = 11, .first_vertex = 9, .n_vertices = 7}};
    const smr_shared shared = {.n_dihedrals = 50, .n = 16};
    const smr_shape shape = {.structure = structure};
    smr_folds f = {.shared = &shared, .shape = &shape, .limit.n_listed = 5};
    static const uint32_t first[] = {0, 13, 9, 0}, n[] = {50, 11, 7, 5};
    for (uint32_t over = 0; over < 4u; over++) {
        const smr_fold_stage stage = {over, 3, see};
        smr_fold_pass pass = {.structure = 1};
        n_seen = 0;
        memset(seen, 0, sizeof seen);
        while (!smr_fold_run(&f, &pass, &stage)) {
        }
        assert_int_equal(n[over], n_seen);
        assert_int_equal((n[over] + 2u) / 3u, pass.n_done);
        for (uint32_t i = 0; i < 64u; i++)
            assert_int_equal(i >= first[over] && i < first[over] + n[over], seen[i]);
    }
}

/* Vertices of balls moved at random, so that triangles fold; then the steps of folds. all: chunks are only
 * skipped where no structure has folds. Writes the next positions; returns the number of skipped chunks of edges. */
static uint32_t folded(uint32_t seed, int all, float *xyz)
{
    smr *s = balls(3);
    smr_folds *f = &s->folds;
    uint32_t n_skipped = 0;
    s->schedule.repairing = 0;
    s->schedule.radius = smr_last_radius(&s->shared);
    memcpy(s->shape.x_next, s->shape.x, 3u * s->shared.n * sizeof(float));
    for (uint32_t i = 0; i < 60u; i++) { /* in two of the three balls */
        const uint32_t v = rig_random(&seed, s->shared.n);
        if (smr_model_owner(s->shared.model, v) != 1u)
            s->shape.x_next[3u * v + i % 3u] += 4.0f + (float)i * 0.5f;
    }
    smr_triangles_follow(&s->shape, s->shape.x_next);
    for (uint32_t task = 0; task < smr_triangles_tasks(&s->shape); task++)
        smr_triangles_refit(&s->shape, task, 0);
    for (uint32_t task = 0; task < f->n_dihedral_tasks; task++) {
        smr_fold_find(f, task, 0);
        f->tally[task].folds.first = all ? 0u : f->tally[task].folds.first;
        f->tally[task].folds.last = all ? 2u : f->tally[task].folds.last;
    }
    smr_fold_find_end(f);
    for (uint32_t task = 0; task < smr_fold_limit_tasks(f); task++) {
        for (uint32_t k = 0; k < f->n_dihedral_tasks && all; k++)
            f->tally[k].folds.quiet = 0;
        smr_fold_limit_pass(f, task, 0);
    }
    for (uint32_t i = 0; i < s->shared.n_dihedrals; i++) { /* the limit leaves no new fold */
        const smr_stored_dihedral *h = smr_edge_at(f, i);
        assert_true(!(smr_dihedral_cosine(f, s->shape.x_next, h) < smr_edge_limit(h)) ||
                    smr_dihedral_cosine(f, s->shape.x, h) < smr_edge_limit(h));
    }
    for (uint32_t task = 0; task < f->n_dihedral_tasks; task++)
        n_skipped += !smr_marked_since(f, &f->tally[task], 0);
    for (uint32_t task = 0; task < smr_fold_open_tasks(f); task++)
        smr_fold_open_pass(f, task, 0);
    memcpy(xyz, s->shape.x_next, 3u * s->shared.n * sizeof(float));
    return n_skipped;
}

TEST(test_chunks_are_skipped)
{
    const size_t bytes = 3u * (size_t)balls(3)->shared.n * sizeof(float);
    float *const some = rig_alloc(bytes), *const every = rig_alloc(bytes);
    for (uint32_t seed = 1; seed <= 20u; seed++) {
        assert_true(folded(seed, 0, some) > 0u);
        assert_int_equal(0, folded(seed, 1, every));
        assert_memory_equal(some, every, bytes);
    }
}
