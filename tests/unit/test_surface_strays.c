/* test_surface_strays.c: scraps of a surface: which pieces are, that registration passes them by, and that who
 * measures finds them.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include <string.h>
#include "start/align/align.h"
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
    rig_free(s);
    return n;
}

TEST(which_pieces_are_scraps)
{
    unit_mesh ball = unit_sphere(4, 40, 0), few = unit_sphere(1, 40, 0), island = unit_sphere(0, 2, 0);
    unit_mesh sheet = unit_grid(2, 2, 1), large = unit_grid(5, 5, 1);
    oracle_random r = oracle_seed(9);
    unit_mesh soup = unit_soup(&r, 2000, 5, 0);
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
TEST(scraps_show_nothing)
{
    unit_mesh ball = unit_sphere(4, 40, 0), spoilt = with_scraps(&ball, 100);
    smr_surface *s = unit_surface(&spoilt), *clean = unit_surface(&ball);
    float area = 0.0f, sum = 0.0f;
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
        smr_surface_search(s, NULL, &q, &hit);
        assert_true(s->area[i] == 0.0f && hit.triangle != SMR_NONE);
        assert_true(s->original[hit.triangle] < ball.nt);
        assert_int_equal(SMR_OK, smr_surface_closest(s, spoilt.xyz + 3u * i, NULL, 0, 1000, &found));
        assert_true(found.distance < 1.0e-3f);
    }
}

/* Nor does the verdict on a registration onto it: what scraps are left out is not missed. */
TEST(no_verdict_asks_for_scraps)
{
    const unit_mesh ball = unit_sphere(3, 40, 0), goals[2] = {ball, with_scraps(&ball, 20)};
    const smr_mesh view = unit_view(&ball);
    const smr_model *model = rig_model(&view, 1, NULL);
    smr_config c = smr_config_default();
    smr_verdict verdict;
    c.basic.n_target_vertices = goals[1].nv;
    for (uint32_t k = 0; k < 2u; k++) {
        smr *s = rig_init(model, &c, NULL);
        assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, unit_surface(&goals[k])));
        (void)rig_run(s, 20);
        assert_int_equal(SMR_OK, smr_get_verdict(s, SMR_ALL, &verdict));
        assert_true(verdict.target_covered > 0.999f && verdict.visible_share > 0.99f);
    }
}

/* A vertex without triangles changes nothing; with a stray triangle a surface is not closed. */
TEST(contact_needs_a_closed_surface)
{
    const smr_mesh ball = rig_ball(20, 24, 40, (const float[3]){0, 0, 0});
    const uint32_t n = ball.n_vertices, nt = ball.n_triangles;
    float *xyz = rig_alloc(3u * sizeof *xyz * (n + 4u));
    uint32_t *t = rig_alloc(3u * sizeof *t * (nt + 1u));
    smr_contact_report r[3];
    memcpy(xyz, ball.xyz, 3u * sizeof *xyz * n);
    memcpy(t, ball.triangles, 3u * sizeof *t * nt);
    for (uint32_t i = 0; i < 3u; i++) {
        t[3u * nt + i] = n + 1u + i;
        xyz[3u * (n + 1u + i) + i] = 5.0f;
    }
    for (uint32_t k = 0; k < 3u; k++) {
        const smr_mesh mesh = {xyz, t, n + (k == 2u ? 4u : k), nt + (k == 2u)};
        const smr_mesh other =
            rig_moved(&ball, (const float[9]){1, 0, 0, 0, 1, 0, 0, 0, 1}, (const float[3]){38, 1, 0});
        assert_int_equal(SMR_OK, smr_surface_contact(rig_surface(&mesh), rig_surface(&other), 0.2f, &r[k]));
    }
    assert_true(r[0].volume_mm3 > 50.0f && memcmp(&r[0], &r[1], sizeof r[0]) == 0);
    assert_true(r[2].deepest_mm == 0.0f && r[2].volume_mm3 == 0.0f && r[2].area_mm2 == 0.0f);
}

/* New positions do not make scraps part of the surface. */
TEST(a_refit_knows_them)
{
    unit_mesh ball = unit_sphere(4, 40, 0), spoilt = with_scraps(&ball, 100);
    smr_surface *s = unit_surface(&spoilt);
    const float before = s->area_mean;
    assert_int_equal(SMR_OK, smr_surface_refit(s, spoilt.xyz));
    assert_int_equal(SMR_OK, smr_surface_step(s, 0, NULL, 0));
    assert_true(s->area_mean == before && s->n_fragment == 100u && s->n_fragment_vertices == 300u && s->open == 0u);
    assert_true(s->area[ball.nv] == 0.0f);
}

static void make_side(smr_align_side *side, const smr_surface *s, uint32_t n)
{
    smr_side_work work;
    side->surface = s;
    side->n = n;
    for (uint32_t task = 0; task < smr_align_side_tasks(side); task++)
        smr_align_side_make(side, &work, task);
}

/* The start pose looks at the places that it looks at without scraps. */
TEST(samples_are_the_same)
{
    enum { SAMPLES = 100 };
    static smr_vec point[2][SAMPLES], normal[SAMPLES];
    static float weight[SAMPLES];
    static smr_pair pair[SAMPLES];
    unit_mesh bone = unit_bone(0), spoilt = with_scraps(&bone, bone.nt / 16u);
    const unit_mesh *const mesh[2] = {&bone, &spoilt};
    smr_vec at[2][SAMPLES];
    assert_true(bone.nt >= 512u);
    for (uint32_t i = 0; i < 2u; i++) {
        smr_surface *s = unit_surface(mesh[i]);
        smr_align_side side = {.point = point[i], .normal = normal, .weight = weight, .pair = pair};
        assert_int_equal(s->n_fragment, i == 0u ? 0u : bone.nt / 16u);
        make_side(&side, s, SAMPLES);
        for (uint32_t k = 0; k < SAMPLES; k++)
            at[i][k] = smr_add(point[i][k], s->origin);
        rig_free(s);
    }
    for (uint32_t k = 0; k < SAMPLES; k++)
        assert_true(smr_length(smr_sub(at[0][k], at[1][k])) < 1.0e-3f);
}

/* Samples of a surface are vertices at even steps, of those that are not on scraps, wherever scraps are numbered; the
 * normals of a closed surface that is inside out are turned. */
TEST(samples_pass_scraps_by)
{
    enum { SAMPLES = 41 };
    static smr_vec point[SAMPLES], normal[SAMPLES];
    static float weight[SAMPLES];
    static smr_pair pair[SAMPLES];
    unit_mesh ball = unit_sphere(4, 40, 0), some = with_scraps(&ball, 30);
    for (uint32_t k = 0; k < 4u; k++) { /* scraps behind or before the ball, as it is or inside out */
        smr_align_side side = {.point = point, .normal = normal, .weight = weight, .pair = pair};
        const uint32_t first = k % 2u == 0u ? 0u : some.nv - ball.nv;
        unit_mesh mesh = unit_mesh_new(some.nv + 1u, some.nt); /* the last vertex has no triangle */
        for (uint32_t i = 0; i < some.nv; i++)
            memcpy(mesh.xyz + 3u * ((i + first) % some.nv), some.xyz + 3u * i, 3u * sizeof *some.xyz);
        for (uint32_t i = 0; i < 3u * some.nt; i++)
            mesh.triangles[i] = (some.triangles[k < 2u ? i : i / 3u * 3u + 2u - i % 3u] + first) % some.nv;
        smr_surface *s = unit_surface(&mesh);
        make_side(&side, s, SAMPLES);
        assert_int_equal(90, s->n_fragment_vertices);
        assert_true(side.outward == (k < 2u ? 1.0f : -1.0f) && side.bare == 0u);
        for (uint32_t i = 0; i < SAMPLES; i++) {
            const uint32_t v = first + (2u * i + 1u) * (ball.nv + 1u) / (2u * SAMPLES);
            assert_memory_equal(&point[i], s->xyz + 3u * v, sizeof point[i]);
            assert_true(smr_dot(normal[i], smr_unit(smr_load(mesh.xyz + 3u * v))) > 0.95f);
            assert_true(weight[i] > 0.3f && weight[i] < 3.0f && pair[i].triangle == SMR_NONE);
        }
    }
}
