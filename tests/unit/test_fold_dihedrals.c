/* test_fold_dihedrals.c: passes over dihedral edges, triangles and vertices, and what they may skip.
 * SPDX-License-Identifier: MIT */
#include "suite.h"

#include <string.h>

#include "property/rig.h"
#include "registration/folds/folds.h"
#include "registration/registration.h"

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
