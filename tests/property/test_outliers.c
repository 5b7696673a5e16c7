/* test_outliers.c: what a target holds beside the model: other bodies in the same mesh, and stray points in a cloud,
 * neither pull the model nor count against it.
 * SPDX-License-Identifier: MIT */
#include "suite.h"

#include <math.h>
#include <string.h>

#include "registration/registration.h"
#include "rig_cloud.h"
#include "rig_parts.h"
#include "unit/oracle.h"

static smr_mesh source, target;

/* The target, and n copies of it, each farther along x by `apart` mm. */
static smr_mesh with_copies(uint32_t n, float apart)
{
    smr_mesh all[41];
    for (uint32_t k = 0; k <= n; k++)
        all[k] =
            rig_moved(&target, (const float[9]){1, 0, 0, 0, 1, 0, 0, 0, 1}, (const float[3]){apart * (float)k, 0, 0});
    return rig_joined(all, n + 1u);
}

static smr *onto_mesh(const smr_mesh *mesh, smr_verdict *verdict)
{
    smr_config config = smr_config_default();
    if (mesh == &target)
        config.motion.settle_share *= 0.5f; /* as among other bodies */
    config.forces.curvature = 0.0f;         /* likewise: several bodies have no relief */
    config.basic.n_target_vertices = mesh->n_vertices;
    smr *s = rig_init(rig_model(&source, 1, NULL), &config, NULL);
    assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, rig_surface(mesh)));
    (void)rig_run(s, 1000);
    assert_int_equal(SMR_OK, smr_get_verdict(s, SMR_ALL, verdict));
    return s;
}

/* Mean distance between the vertices of two results, mm. */
static float apart(const smr *a, const smr *b)
{
    return rig_mean_far(rig_positions(a, a->shared.model), rig_positions(b, b->shared.model), source.n_vertices);
}

/* Bodies of one to five times the model's area beside it: the model ends where an equal schedule ends without them. */
TEST(test_other_bodies)
{
    smr_verdict verdict;
    const smr *alone = onto_mesh(&target, &verdict);
    assert_true(verdict.other_share == 0.0f && verdict.level == SMR_VERDICT_GOOD);
    for (uint32_t n = 1; n <= rig_times(5); n += 2u) {
        const smr_mesh scene = with_copies(n, 70.0f);
        smr *s = onto_mesh(&scene, &verdict);
        assert_true(s->forces.surface.target[0].others == 1u);
        assert_true(apart(s, alone) < 0.01f);
        assert_true(fabsf(verdict.other_share - (float)n / (float)(n + 1u)) < 0.01f);
        assert_true(verdict.level == SMR_VERDICT_GOOD && verdict.target_covered > 0.99f);
    }
}

/* A body that the model lies on in part only is no other body: the parts of a target all pull. */
TEST(test_parts_of_the_model)
{
    smr_verdict verdict;
    smr_mesh parts = target;
    uint32_t *kept = rig_alloc(3u * (size_t)target.n_triangles * sizeof *kept), n = 0;
    for (uint32_t k = 0; k < target.n_triangles; k++) {
        const uint32_t *t = target.triangles + 3u * (size_t)k;
        const float z = target.xyz[3u * t[0] + 2u];
        if (fabsf(z - 215.0f) > 40.0f) /* the middle is missing */
            memcpy(kept + 3u * n++, t, 3u * sizeof *t);
    }
    parts.triangles = kept;
    parts.n_triangles = n;
    smr *s = onto_mesh(&parts, &verdict);
    assert_true(s->forces.surface.goal[0].n_bodies >= 2u && s->forces.surface.target[0].others == 0u);
    assert_true(verdict.other_share < 0.01f);
}

/* A plate of triangles that are a hundred times as large as the model's, 40 mm off: a table under a scanned bone. */
TEST(test_coarse_plate)
{
    enum { SIDE = 6 };
    smr_verdict verdict;
    const uint32_t nv = target.n_vertices, nt = target.n_triangles;
    float *xyz = rig_alloc(3u * ((size_t)nv + SIDE * SIDE) * sizeof *xyz);
    uint32_t *t = rig_alloc(3u * ((size_t)nt + 2u * (SIDE - 1) * (SIDE - 1)) * sizeof *t), n = 3u * nt;
    memcpy(xyz, target.xyz, 3u * (size_t)nv * sizeof *xyz);
    memcpy(t, target.triangles, 3u * (size_t)nt * sizeof *t);
    for (uint32_t i = 0; i < SIDE * SIDE; i++) {
        const float p[3] = {130.0f, 100.0f * (float)(i % SIDE) - 250.0f, 100.0f * (float)(i / SIDE) - 50.0f};
        memcpy(xyz + 3u * ((size_t)nv + i), p, sizeof p);
    }
    for (uint32_t i = 0; i < SIDE * (SIDE - 1u); i++) {
        if (i % SIDE == SIDE - 1u)
            continue;
        const uint32_t a = nv + i, corner[6] = {a, a + 1u, a + SIDE, a + 1u, a + SIDE + 1u, a + SIDE};
        memcpy(t + n, corner, sizeof corner);
        n += 6u;
    }
    const smr_mesh scene = {.xyz = xyz, .n_vertices = nv + SIDE * SIDE, .triangles = t, .n_triangles = n / 3u};
    const smr *alone = onto_mesh(&target, &verdict);
    const float residual = verdict.residual_mm;
    smr *s = onto_mesh(&scene, &verdict);
    assert_true(apart(s, alone) < 1.5f); /* the plate is open, so the target counts as one that may lack parts */
    assert_true(verdict.residual_mm < 1.1f * residual + 0.02f && verdict.level == SMR_VERDICT_GOOD);
    assert_true(verdict.other_share > 0.5f && verdict.target_covered > 0.99f);
}

/* Returns the distance between p and the surface of a mesh with the vertices x, mm. */
static double surface_far(const float *p, const smr_mesh *mesh, const float *x)
{
    double least = 1.0e9, at[3], corner[3][3];
    oracle_widen(p, at, 3);
    for (uint32_t k = 0; k < mesh->n_triangles; k++) {
        for (uint32_t c = 0; c < 3u; c++)
            oracle_widen(x + 3u * (size_t)mesh->triangles[3u * k + c], corner[c], 3);
        least = fmin(least, oracle_triangle(at, corner[0], corner[1], corner[2])); /* squared */
    }
    return sqrt(least);
}

/* Single vertices that stand out of the target by 1.2 edges are tips, no outliers: the model nears them. */
TEST(test_tips)
{
    enum { EVERY = 97 };
    smr_verdict verdict;
    const smr_model *model = rig_model(&source, 1, NULL);
    const float high = 1.2f * smr_le_float(model->edge_mm);
    const smr_surface *const smooth = rig_surface(&target);
    float *xyz = rig_alloc(3u * (size_t)target.n_vertices * sizeof *xyz);
    double far = 0.0, n = 0.0;
    smr_mesh spiked = target;
    memcpy(xyz, target.xyz, 3u * (size_t)target.n_vertices * sizeof *xyz);
    for (uint32_t v = 0; v < target.n_vertices; v += EVERY)
        for (uint32_t c = 0; c < 3u; c++)
            xyz[3u * v + c] += high * smooth->normal[3u * v + c];
    spiked.xyz = xyz;
    const float *const x = rig_positions(onto_mesh(&spiked, &verdict), model);
    for (uint32_t v = 0; v < target.n_vertices; v += EVERY, n += 1.0)
        far += surface_far(xyz + 3u * v, &source, x);
    assert_true(far < 0.42 * n * (double)high); /* 0.51 where their weights do not grow */
}

/* Small triangles 1.2 edges above the target, a seventh of all and so no fragments, are strays, no tips. */
TEST(test_strays_are_no_tips)
{
    enum { EVERY = 3 };
    smr_verdict verdict;
    const float high = 1.2f * smr_le_float(rig_model(&source, 1, NULL)->edge_mm);
    const smr_surface *const smooth = rig_surface(&target);
    const uint32_t nv = target.n_vertices, n = nv / EVERY;
    float *xyz = rig_alloc(3u * ((size_t)nv + 3u * (size_t)n) * sizeof *xyz);
    uint32_t *t = rig_alloc(3u * ((size_t)target.n_triangles + n) * sizeof *t);
    memcpy(xyz, target.xyz, 3u * (size_t)nv * sizeof *xyz);
    memcpy(t, target.triangles, 3u * (size_t)target.n_triangles * sizeof *t);
    for (uint32_t k = 0; k < 3u * n; k++) {
        const uint32_t v = k / 3u * EVERY, at = 3u * (nv + k);
        for (uint32_t c = 0; c < 3u; c++)
            xyz[at + c] = target.xyz[3u * v + c] + high * smooth->normal[3u * v + c] + (c == k % 3u ? 2.0f : 0.0f);
        t[3u * target.n_triangles + k] = nv + k;
    }
    const smr_mesh strewn = {
        .xyz = xyz, .n_vertices = nv + 3u * n, .triangles = t, .n_triangles = target.n_triangles + n};
    const float *const x = rig_positions(onto_mesh(&strewn, &verdict), rig_model(&source, 1, NULL));
    double far = 0.0, n_far = 0.0;
    for (uint32_t v = 0; v < source.n_vertices; v += 50u, n_far += 1.0)
        far += surface_far(x + 3u * v, &target, target.xyz);
    assert_true(far < 0.45 * n_far); /* 0.30; 0.73 where they are taken for tips */
}

static smr *onto_points(double strays, smr_verdict *verdict)
{
    oracle_random r = oracle_seed(5);
    smr_config config = smr_config_default();
    const uint32_t n = target.n_vertices;
    smr_points *const cloud = rig_cloud(n);
    config.basic.n_target_vertices = n;
    for (uint32_t v = 0; v < n; v++) {
        float p[3];
        memcpy(p, target.xyz + 3u * (size_t)v, sizeof p);
        const int stray = oracle_uniform(&r, 0.0, 1.0) < strays;
        for (uint32_t c = 0; c < 3u; c++)
            p[c] += oracle_uniformf(&r, stray ? -40.0f : -0.5f, stray ? 40.0f : 0.5f);
        assert_int_equal(SMR_OK, smr_points_add(cloud, p, NULL, NULL, 1));
    }
    smr *s = rig_init(rig_model(&source, 1, NULL), &config, NULL);
    assert_int_equal(SMR_OK, smr_set_points(s, SMR_ALL, cloud));
    (void)rig_run(s, 1000);
    assert_int_equal(SMR_OK, smr_get_verdict(s, SMR_ALL, verdict));
    return s;
}

TEST(test_stray_points)
{
    static const double strays[] = {0.01, 0.05, 0.2};
    smr_verdict verdict;
    const smr *alone = onto_points(0.0, &verdict);
    assert_true(verdict.other_share < 0.01f);
    for (uint32_t k = 0; k < rig_times(3); k++) {
        smr *s = onto_points(strays[k], &verdict);
        assert_true(apart(s, alone) < (k < 2u ? 0.2f : 0.5f));
        assert_true(verdict.level == SMR_VERDICT_GOOD);
        assert_true(fabsf(verdict.other_share - (float)strays[k]) < 0.3f * (float)strays[k] + 0.01f);
    }
    (void)onto_points(0.7, &verdict);
    assert_true(verdict.level != SMR_VERDICT_GOOD);
}

/* More components than have numbers, with targets that share the room: every one is weighed or counts in full. */
TEST(test_many_components)
{
    smr_verdict verdict;
    const smr_mesh scene = with_copies(40, 9.0f);
    smr_config config = smr_config_default();
    smr_mesh two[2] = {source, source};
    config.basic.n_target_vertices = 2u * scene.n_vertices;
    smr *s = rig_init(rig_model(two, 2, NULL), &config, NULL);
    for (uint32_t i = 0; i < 2u; i++)
        assert_int_equal(SMR_OK, smr_set_surface(s, i, rig_surface(&scene)));
    for (uint32_t i = 0; i < 5u; i++)
        assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
    const smr_surface_goals *g = &s->forces.surface;
    assert_true(g->goal[1].first_body + g->goal[1].n_bodies + SMR_BODY_FIRST <= SMR_BODY_SLOTS(2u));
    assert_int_equal(SMR_OK, smr_get_verdict(s, SMR_ALL, &verdict));
}

BEFORE_ALL_TESTS() { rig_bone(9000, 1.0f, &source, &target); }
