/* test_surface_strays.c: scraps of a surface: which pieces are, that registration passes them by, and that who measures
 * finds them.
 * SPDX-License-Identifier: MIT */
#include "cmocka_first.h"

#include <math.h>
#include <string.h>

#include "start/align/align_side.h"
#include "geometry/surface/surface.h"
#include "unit_mesh.h"

/* A mesh, and behind it `n` single triangles of 2 mm somewhere within 100 mm. */
static unit_mesh with_scraps(const unit_mesh *m, uint32_t n)
{
    unit_mesh all = unit_mesh_new(m->nv + 3u * n, m->nt + n);
    oracle_random r = oracle_seed(3);
    memcpy(all.xyz, m->xyz, 3u * (size_t)m->nv * sizeof *m->xyz);
    memcpy(all.triangles, m->triangles, 3u * (size_t)m->nt * sizeof *m->triangles);
    for (uint32_t k = 0; k < n; k++) {
        float p[3];
        for (uint32_t c = 0; c < 3u; c++)
            p[c] = oracle_uniformf(&r, -100, 100);
        for (uint32_t i = 0; i < 3u; i++)
            for (uint32_t c = 0; c < 3u; c++)
                all.xyz[3u * (m->nv + 3u * k + i) + c] = p[c] + oracle_uniformf(&r, -2, 2);
        for (uint32_t c = 0; c < 3u; c++)
            all.triangles[3u * (m->nt + k) + c] = m->nv + 3u * k + c;
    }
    return all;
}

/* Two meshes side by side, the second shifted along x. */
static unit_mesh beside(const unit_mesh *a, const unit_mesh *b, float shift)
{
    unit_mesh all = unit_mesh_new(a->nv + b->nv, a->nt + b->nt);
    memcpy(all.xyz, a->xyz, 3u * (size_t)a->nv * sizeof *a->xyz);
    memcpy(all.triangles, a->triangles, 3u * (size_t)a->nt * sizeof *a->triangles);
    for (uint32_t i = 0; i < 3u * b->nv; i++)
        all.xyz[3u * a->nv + i] = b->xyz[i] + (i % 3u == 0u ? shift : 0.0f);
    for (uint32_t i = 0; i < 3u * b->nt; i++)
        all.triangles[3u * a->nt + i] = b->triangles[i] + a->nv;
    return all;
}

static uint32_t strays(const unit_mesh *m)
{
    smr_surface *s = unit_surface(m);
    const uint32_t n = s->n_fragment;
    unit_free(s);
    return n;
}

static void which_pieces_are_scraps(void **state)
{
    unit_mesh ball = unit_sphere(4, 40, 0), few = unit_sphere(1, 40, 0), island = unit_sphere(0, 2, 0);
    unit_mesh sheet = unit_grid(2, 2, 1), large = unit_grid(5, 5, 1);
    oracle_random r = oracle_seed(9);
    unit_mesh soup = unit_soup(&r, 2000, 5, 0);
    (void)state;
    unit_mesh some = with_scraps(&ball, 100), coarse = with_scraps(&few, 3), many = with_scraps(&ball, 500);
    unit_mesh isle = beside(&ball, &island, 60), patch = beside(&ball, &sheet, 60), wide = beside(&ball, &large, 60);
    assert_true(ball.nt == 2048u && island.nt == 8u);
    assert_int_equal(strays(&ball), 0);
    assert_int_equal(strays(&some), 100);
    assert_int_equal(strays(&coarse), 0); /* 32 triangles: each shows a part */
    assert_int_equal(strays(&many), 0);   /* a fifth of all: it comes in pieces */
    assert_int_equal(strays(&soup), 0);
    assert_int_equal(strays(&isle), 0); /* closed */
    assert_int_equal(strays(&patch), sheet.nt);
    assert_int_equal(strays(&wide), 0); /* 50 triangles of 2098 */
    unit_mesh *const all[] = {&ball, &few, &island, &sheet, &large, &soup, &some, &coarse, &many, &isle, &patch, &wide};
    for (uint32_t i = 0; i < sizeof all / sizeof all[0]; i++)
        unit_mesh_free(all[i]);
}

/* The surface is closed, with the areas of the ball alone; the search of goals passes scraps by, measuring does not. */
static void scraps_show_nothing(void **state)
{
    unit_mesh ball = unit_sphere(4, 40, 0), spoilt = with_scraps(&ball, 100);
    smr_surface *s = unit_surface(&spoilt), *clean = unit_surface(&ball);
    float area = 0.0f, sum = 0.0f;
    (void)state;
    assert_int_equal(s->open, 0);
    assert_int_equal(s->n_used, clean->n_used);
    assert_int_equal(s->n_fragment_vertices, 300);
    assert_true(fabsf(s->area_mean / clean->area_mean - 1.0f) < 1.0e-4f);
    for (uint32_t i = 0; i < ball.nv; i++) {
        area += clean->area[i];
        sum += s->area[i];
    }
    assert_true(fabsf(sum / area - 1.0f) < 1.0e-5f);
    for (uint32_t i = ball.nv; i < spoilt.nv; i++) {
        const smr_vec p = smr_load(spoilt.xyz + 3u * i);
        const smr_query q = {smr_sub(p, s->origin), {0, 0, 0}, -2.0f, UINT32_MAX, SMR_NONE};
        smr_hit hit = {1.0e9f, SMR_NONE, {0, 0, 0}};
        smr_closest found;
        smr_surface_search(s, &q, &hit);
        assert_true(s->area[i] == 0.0f && hit.triangle != SMR_NONE);
        assert_true(s->original[hit.triangle] < ball.nt);
        assert_int_equal(SMR_OK, smr_surface_closest(s, spoilt.xyz + 3u * i, NULL, 0, 1000, &found));
        assert_true(found.distance < 1.0e-3f);
    }
    unit_free(s);
    unit_free(clean);
    unit_mesh_free(&ball);
    unit_mesh_free(&spoilt);
}

/* New positions do not make scraps part of the surface. */
static void a_refit_knows_them(void **state)
{
    unit_mesh ball = unit_sphere(4, 40, 0), spoilt = with_scraps(&ball, 100);
    smr_surface *s = unit_surface(&spoilt);
    const float before = s->area_mean;
    (void)state;
    assert_int_equal(SMR_OK, smr_surface_refit(s, spoilt.xyz));
    assert_int_equal(SMR_OK, smr_surface_step(s, 0, NULL, 0));
    assert_true(s->area_mean == before && s->n_fragment == 100u && s->n_fragment_vertices == 300u && s->open == 0u);
    assert_true(s->area[ball.nv] == 0.0f);
    unit_free(s);
    unit_mesh_free(&ball);
    unit_mesh_free(&spoilt);
}

/* The start pose looks at the places that it looks at without scraps. */
static void samples_are_the_same(void **state)
{
    enum { SAMPLES = 100 };
    static smr_vec point[2][SAMPLES], normal[SAMPLES];
    static float weight[SAMPLES];
    static smr_pair pair[SAMPLES];
    unit_mesh bone = unit_bone(0), spoilt = with_scraps(&bone, bone.nt / 16u);
    const unit_mesh *const mesh[2] = {&bone, &spoilt};
    smr_vec at[2][SAMPLES];
    (void)state;
    assert_true(bone.nt >= 512u);
    for (uint32_t i = 0; i < 2u; i++) {
        smr_surface *s = unit_surface(mesh[i]);
        smr_align_side side = {.point = point[i], .normal = normal, .weight = weight, .pair = pair};
        assert_int_equal(s->n_fragment, i == 0u ? 0u : bone.nt / 16u);
        smr_align_side_make(&side, s, SAMPLES);
        for (uint32_t k = 0; k < SAMPLES; k++)
            at[i][k] = smr_add(point[i][k], s->origin);
        unit_free(s);
    }
    for (uint32_t k = 0; k < SAMPLES; k++)
        assert_true(smr_length(smr_sub(at[0][k], at[1][k])) < 1.0e-3f);
    unit_mesh_free(&bone);
    unit_mesh_free(&spoilt);
}

/* `n` single triangles in a row along x, in tree order; behind them others that join the last to the one before, that
 * to the one before it, and so on: the newest piece is always the one to be joined, the largest never is. */
static unit_mesh backwards(uint32_t n)
{
    unit_mesh m = unit_mesh_new(3u * n + n - 1u, 2u * n - 1u);
    for (uint32_t i = 0; i < 3u * n; i++) {
        m.triangles[i] = i;
        for (uint32_t c = 0; c < 3u; c++)
            m.xyz[3u * i + c] = (c == 0u ? (float)(i / 3u) : 0.0f) + (i % 3u == c ? 0.25f : 0.0f);
    }
    for (uint32_t k = 0; k + 1u < n; k++) {
        uint32_t *t = m.triangles + 3u * (n + k);
        t[0] = 3u * (n - 1u - k);
        t[1] = 3u * (n - 2u - k);
        t[2] = 3u * n + k;
        for (uint32_t c = 0; c < 3u; c++) /* the centre is the next one of the row */
            m.xyz[3u * t[2] + c] =
                (c == 0u ? 3.0f * (float)(n + k) : 0.0f) - m.xyz[3u * t[0] + c] - m.xyz[3u * t[1] + c];
    }
    return m;
}

/* Steps from a triangle up to its piece's root, at most. */
static uint32_t longest_way(const smr_surface *s)
{
    uint32_t most = 0;
    for (uint32_t k = 0; k < s->tree.n_triangles; k++) {
        uint32_t steps = 0;
        for (uint32_t at = k; s->work.key[at] != at; at = s->work.key[at])
            steps++;
        most = steps > most ? steps : most;
    }
    return most;
}

/* However triangles are joined, no search of a piece's root takes longer than the logarithm of their number. */
static void ways_up_stay_short(void **state)
{
    unit_mesh m = backwards(1000);
    smr_surface *s = unit_surface(&m);
    uint32_t roots = 0;
    (void)state;
    for (uint32_t k = 0; k < m.nt; k++)
        assert_int_equal(s->original[k], k);
    smr_fragments_forget(s, 0, s->n_vertices);
    smr_fragments_join(s, 0, s->tree.n_triangles);
    assert_in_range(longest_way(s), 1, 10); /* 2^11 > 1999 */
    for (uint32_t k = 0; k < m.nt; k++)
        roots += s->work.key[k] == k;
    assert_int_equal(roots, 1);
    unit_free(s);
    unit_mesh_free(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(which_pieces_are_scraps), cmocka_unit_test(scraps_show_nothing),
        cmocka_unit_test(a_refit_knows_them),      cmocka_unit_test(samples_are_the_same),
        cmocka_unit_test(ways_up_stay_short),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
