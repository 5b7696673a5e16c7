/* test_overlap.c: how well an open target shows each vertex: beyond its border, with normals that disagree, where the
 * target's closest points lie elsewhere; and which targets are taken as whole.
 * SPDX-License-Identifier: MIT */
#include "cmocka_first.h"

#include <math.h>
#include <string.h>

#include "property/rig.h"
#include "registration/registration.h"

#define STEP 5.0f    /* mm, of the sheets */
#define RADIUS 20.0f /* mm, of the clusters */
#define APART 4.0f   /* mm, of the sheets */

enum { SIDE = 21, ROUNDED = 3 };

static int tidy(void **state)
{
    (void)state;
    rig_free_all();
    return 0;
}

/* A flat sheet from x = 0 to `width`, y = 0 to 100, at z. */
static smr_mesh sheet(float width, float z)
{
    const uint32_t nv = SIDE * SIDE, nt = 2u * (SIDE - 1u) * (SIDE - 1u);
    float *xyz = rig_alloc(3u * nv * sizeof *xyz);
    uint32_t *t = rig_alloc(3u * nt * sizeof *t);
    for (uint32_t i = 0; i < nv; i++) {
        xyz[3u * i] = width * (float)(i % SIDE) / (float)(SIDE - 1u);
        xyz[3u * i + 1u] = STEP * (float)(i / SIDE);
        xyz[3u * i + 2u] = z;
    }
    for (uint32_t k = 0; k < nt; k++) {
        const uint32_t a = k / 2u / (SIDE - 1u) * SIDE + k / 2u % (SIDE - 1u);
        const uint32_t corner[2][3] = {{a, a + 1u, a + SIDE}, {a + SIDE + 1u, a + SIDE, a + 1u}};
        memcpy(t + 3u * k, corner[k % 2u], sizeof corner[0]);
    }
    return (smr_mesh){xyz, t, nv, nt};
}

/* The sheet of 100 x 100 mm after one iteration towards a narrower one above it: judged at its start. */
static smr *judged(float width, uint32_t coverage)
{
    const smr_mesh mesh = sheet(100.0f, 0.0f), goal = sheet(width, APART);
    const smr_prepare_config radii = rig_radii(1, RADIUS, 0, 0);
    smr_config c = smr_config_default();
    c.partial.coverage = coverage;
    c.basic.n_target_vertices = goal.n_vertices;
    smr *s = rig_init(rig_model(&mesh, 1, &radii), &c, NULL);
    assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, rig_surface(&goal)));
    (void)rig_run(s, 1);
    return s;
}

static uint32_t stored(const smr *s, uint32_t column, uint32_t row)
{
    return smr_model_position(s->shared.model, row * SIDE + column);
}

static float tolerance(const smr *s) { return 0.5f * smr_le_float(s->shared.model->edge_mm) + 0.1f * RADIUS; }

/* What is left this far beyond a border: the border's own share, and that of closest points as far apart. */
static float share_beyond(const smr *s, float beyond)
{
    const float at = tolerance(s), mutual = 1.5f - beyond / (at + 0.2f * APART);
    return smr_clamp(1.0f - beyond / at, 0.0f, 1.0f) * smr_clamp(mutual, 0.0f, 1.0f);
}

static void falls_off_beyond_a_border(void **state)
{
    uint32_t between = 0;
    (void)state;
    for (float width = 44.0f; width <= 50.0f; width += 0.5f) {
        const smr *s = judged(width, SMR_COVERAGE_AUTO);
        for (uint32_t column = 0; column < SIDE; column++) {
            const float expected = 255.0f * share_beyond(s, smr_max(STEP * (float)column - width, 0.0f));
            const float seen = (float)s->forces.surface.visibility[stored(s, column, 10)];
            if (!(fabsf(seen - expected) <= (expected > 8.0f ? ROUNDED : 8.0f)))
                print_error("width %g, column %u: %g, not %g\n", (double)width, column, (double)seen, (double)expected);
            assert_true(fabsf(seen - expected) <= (expected > 8.0f ? ROUNDED : 8.0f));
            between += seen > 0.0f && seen < 255.0f;
        }
    }
    assert_true(between >= 6u);
}

/* Judges a vertex in the middle of the seen part again, its goal right above it. */
static float judge_again(smr *s, uint32_t before)
{
    smr_surface_goals *g = &s->forces.surface;
    const smr_surface *target = g->target[0].surface;
    const uint32_t v = stored(s, 4, 10);
    const smr_vec p = smr_add(smr_load(s->shape.x + 3u * (size_t)v), smr_sub(s->shape.origin, target->origin));
    const smr_query q = {p, smr_v(0, 0, 0), -2.0f, UINT32_MAX, SMR_NONE};
    smr_hit hit = {1.0e6f, SMR_NONE, {0, 0, 0}};
    smr_tree_closest(&target->tree, &q, &hit);
    g->visibility[v] = (uint8_t)before;
    smr_visibility_judge(g, v, target, &hit, smr_sub(smr_triangle_point(&target->tree, hit.triangle, hit.weight), p));
    return (float)g->visibility_next[v];
}

static void normals_that_disagree(void **state)
{
    smr *s = judged(50.0f, SMR_COVERAGE_AUTO);
    const float least = smr_min(s->shared.min_cos, 0.5f);
    float *normal = s->shape.normal + 3u * (size_t)stored(s, 4, 10);
    uint32_t between = 0;
    (void)state;
    for (float deg = 0.0f; deg < 180.0f; deg += 3.0f) {
        const float c = cosf(deg * 0.01745329f), expected = 255.0f * smr_clamp((c - least) / (0.6f - least), 0, 1);
        smr_store(normal, smr_v(sinf(deg * 0.01745329f), 0, c));
        const float seen = judge_again(s, expected > 128.0f ? 0u : 255u);
        assert_true(fabsf(seen - expected) <= ROUNDED);
        between += seen > 0.0f && seen < 255.0f;
    }
    assert_true(between >= 2u);
}

/* Where the target's corners find another place of the model, a goal counts less the farther that is. */
static void not_mutual(void **state)
{
    smr *s = judged(50.0f, SMR_COVERAGE_AUTO);
    smr_surface_goals *g = &s->forces.surface;
    const uint32_t n = g->target[0].surface->n_vertices;
    const uint32_t v = stored(s, 4, 10);
    float before = 255.0f;
    (void)state;
    assert_true(judge_again(s, 0) == 255.0f);
    const float x = s->shape.x[3u * (size_t)v];
    for (float off = 0.0f; off < 12.0f; off += 0.5f) { /* the vertex moves away along the sheet, its goal does not */
        const smr_surface *target = g->target[0].surface;
        const smr_vec p = smr_add(smr_load(s->shape.x + 3u * (size_t)v), smr_sub(s->shape.origin, target->origin));
        const smr_query q = {p, smr_v(0, 0, 0), -2.0f, UINT32_MAX, SMR_NONE};
        smr_hit hit = {1.0e6f, SMR_NONE, {0, 0, 0}};
        smr_tree_closest(&target->tree, &q, &hit);
        s->shape.x[3u * (size_t)v + 1u] += off;
        g->visibility[v] = 0;
        smr_visibility_judge(g, v, target, &hit, smr_v(0, 0, APART));
        s->shape.x[3u * (size_t)v + 1u] -= off;
        const float seen = (float)g->visibility_next[v];
        assert_true(seen <= before);
        assert_true(off > 0.4f * tolerance(s) || seen > 250.0f);
        assert_true(off < 2.5f * tolerance(s) || seen == 0.0f);
        before = seen;
    }
    assert_true(before == 0.0f && s->shape.x[3u * (size_t)v] == x);
    for (uint32_t j = 0; j < n; j++)
        g->target_warm[j] = SMR_NONE; /* no corner finds anything */
    assert_true(judge_again(s, 0) == 0.0f);
}

/* Corners that find nothing of this structure have no say, unless they are most of the goal. */
static void corners_that_find_nothing(void **state)
{
    smr *s = judged(50.0f, SMR_COVERAGE_AUTO);
    smr_surface_goals *g = &s->forces.surface;
    const smr_surface *target = g->target[0].surface;
    const uint32_t v = stored(s, 4, 10), found = g->warm[v];
    (void)state;
    for (uint32_t c = 0; c < 3u; c++)
        for (uint32_t most = 0; most < 2u; most++) {
            smr_hit hit = {APART * APART, found, {0, 0, 0}};
            const uint32_t silent = target->triangle[3u * (size_t)found + (c + 1u) % 3u];
            const uint32_t kept = g->target_warm[silent];
            hit.weight[c] = most ? 0.4f : 0.6f;
            hit.weight[(c + 1u) % 3u] = 1.0f - hit.weight[c];
            g->target_warm[silent] = SMR_NONE;
            g->visibility[v] = 128;
            smr_visibility_judge(g, v, target, &hit, smr_v(0, 0, APART));
            g->target_warm[silent] = kept;
            assert_true(most ? g->visibility_next[v] == 0u : g->visibility_next[v] > 60u);
        }
}

/* Goals come to rest: a share that hardly changed stays. */
static void small_changes_are_none(void **state)
{
    smr *s = judged(50.0f, SMR_COVERAGE_AUTO);
    (void)state;
    for (uint32_t before = 230; before < 256u; before++)
        assert_true(judge_again(s, before) == (before >= 247u ? (float)before : 255.0f));
}

/* An open target is seen in part; not so when it is said to be whole, nor a closed one that is covered. */
static void which_targets_are_partial(void **state)
{
    static const float centre[3] = {0, 0, 0}, aside[3] = {20, 0, 0};
    (void)state;
    smr *s = judged(50.0f, SMR_COVERAGE_AUTO);
    assert_int_equal(s->forces.surface.partial, 1);
    s = judged(50.0f, SMR_COVERAGE_WHOLE);
    assert_null(s->forces.surface.visibility);
    assert_int_equal(s->forces.surface.partial, 0);
    for (uint32_t k = 0; k < 3u; k++) {
        const smr_mesh ball = rig_ball(30.0f, 13, 20, centre), goal = rig_ball(30.0f, 15, 22, k == 1u ? aside : centre);
        const smr_prepare_config radii = rig_radii(1, RADIUS, 0, 0);
        smr_config c = smr_config_default();
        c.partial.coverage = k == 2u ? SMR_COVERAGE_PARTIAL : SMR_COVERAGE_AUTO;
        c.basic.n_target_vertices = goal.n_vertices;
        s = rig_init(rig_model(&ball, 1, &radii), &c, NULL);
        assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, rig_surface(&goal)));
        (void)rig_run(s, 1);
        assert_int_equal(s->forces.surface.partial, k > 0u); /* aside, not all of it finds mutual goals */
        assert_true(s->forces.surface.target[0].n_judged == ball.n_vertices);
        assert_true((s->forces.surface.target[0].n_visible > 9u * ball.n_vertices / 10u) == (k != 1u));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_teardown(falls_off_beyond_a_border, tidy),
        cmocka_unit_test_teardown(normals_that_disagree, tidy),
        cmocka_unit_test_teardown(not_mutual, tidy),
        cmocka_unit_test_teardown(corners_that_find_nothing, tidy),
        cmocka_unit_test_teardown(small_changes_are_none, tidy),
        cmocka_unit_test_teardown(which_targets_are_partial, tidy),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
