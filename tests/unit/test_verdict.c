/* test_verdict.c: what is measured of a result, and what is judged from it.
 * SPDX-License-Identifier: MIT */
#include "suite.h"

#include <math.h>
#include <string.h>

#include "property/rig_parts.h"
#include "registration/registration.h"
#include "verdict/verdict_measures.h"

static const float none[3] = {0, 0, 0};

/* A ball of 20 mm and its target, a larger one; the first n triangles of it. */
static smr *start_to(float radius, uint32_t n_triangles, int inside_out, const smr_model **model)
{
    smr_config config = smr_config_default();
    const smr_mesh ball = rig_ball(20, 14, 20, none);
    smr_mesh goal = rig_ball(radius, 18, 26, none);
    uint32_t *const t = rig_alloc(3u * sizeof *t * goal.n_triangles);
    for (uint32_t i = 0; i < 3u * goal.n_triangles; i++)
        t[i] = goal.triangles[inside_out ? i - i % 3u + (3u - i % 3u) % 3u : i];
    goal.triangles = t;
    goal.n_triangles = n_triangles < goal.n_triangles ? n_triangles : goal.n_triangles;
    config.basic.n_target_vertices = goal.n_vertices;
    *model = rig_model(&ball, 1, NULL);
    smr *s = rig_init(*model, &config, NULL);
    assert_int_equal(SMR_OK, smr_set_surface(s, 0, rig_surface(&goal)));
    return s;
}

static smr *start(uint32_t n_triangles, int inside_out, const smr_model **model)
{
    return start_to(21, n_triangles, inside_out, model);
}

TEST(test_refusals)
{
    const smr_model *model;
    smr *s = start(100000, 0, &model);
    smr_verdict v;
    float mm[2000];
    unsigned char seen[2000];
    assert_int_equal(SMR_E_NULL, smr_get_verdict(NULL, 0, &v));
    assert_int_equal(SMR_E_NULL, smr_get_verdict(s, 0, NULL));
    assert_int_equal(SMR_E_NULL, smr_get_visible(s, 0, NULL));
    assert_int_equal(SMR_E_NULL, smr_get_expected_error(s, 0, NULL));
    assert_int_equal(SMR_E_INPUT, smr_get_verdict(s, 1, &v));
    assert_int_equal(SMR_E_INPUT, smr_get_visible(s, SMR_ALL, seen));
    assert_int_equal(SMR_E_INPUT, smr_get_expected_error(s, SMR_ALL, mm));
    s->next_task = 1; /* as if an iteration were under way */
    smr_guard_close(s);
    assert_int_equal(SMR_E_STATE, smr_get_verdict(s, 0, &v));
    assert_int_equal(SMR_E_STATE, smr_get_expected_error(s, 0, mm));
    assert_int_equal(SMR_OK, smr_get_visible(s, 0, seen));
    s->next_task = 0;
    smr_guard_close(s);
    assert_int_equal(SMR_OK, smr_get_verdict(s, SMR_ALL, &v));
    assert_int_equal(SMR_VERDICT_FAILED, v.level); /* nothing has been looked at yet */
    assert_true((v.reasons & SMR_REASON_NOTHING_VISIBLE) != 0u);
}

TEST(test_good)
{
    const smr_model *model;
    smr *s = start(100000, 0, &model);
    smr_verdict v, all;
    (void)rig_run(s, 400);
    assert_int_equal(SMR_OK, smr_get_verdict(s, 0, &v));
    assert_int_equal(SMR_OK, smr_get_verdict(s, SMR_ALL, &all));
    assert_memory_equal(&v, &all, sizeof v);
    assert_int_equal(0, v.reasons);
    assert_int_equal(SMR_VERDICT_GOOD, v.level);
    assert_true(v.target_covered > 0.99f && v.visible_share > 0.99f && v.normals_agree > 0.99f);
    assert_true(v.scale > 1.03f && v.scale < 1.07f && v.strain < 0.1f && v.rotation_deg < 10.0f);
    assert_true(v.volume_ratio > 0.95f && v.volume_ratio < 1.05f);
    assert_true(v.image_similarity < -0.5f && v.goals_share < -0.5f); /* of images */
}

/* What the target does not show is expected to be farther off, and said to be unseen; and a part does not tell by how
 * much the whole is larger. */
TEST(test_half)
{
    const smr_model *model;
    smr *s = start_to(22, 468, 0, &model);
    float mm[2000], sum[2] = {0, 0}, n[2] = {0, 0};
    unsigned char seen[2000];
    smr_structure_info info;
    (void)rig_run(s, 400);
    assert_int_equal(SMR_OK, smr_model_structure(model, 0, &info));
    assert_int_equal(SMR_OK, smr_get_visible(s, 0, seen));
    assert_int_equal(SMR_OK, smr_get_expected_error(s, 0, mm));
    for (uint32_t i = 0; i < info.n_vertices; i++) {
        assert_true(isfinite(mm[i]) && mm[i] >= 0.0f && seen[i] <= 1u);
        sum[seen[i]] += mm[i];
        n[seen[i]] += 1.0f;
    }
    assert_true(n[0] > 20.0f && n[1] > 20.0f);
    assert_true(sum[0] / n[0] > sum[1] / n[1]);
    smr_verdict v;
    assert_int_equal(SMR_OK, smr_get_verdict(s, 0, &v));
    assert_true(v.visible_share > 0.3f && v.visible_share < 0.8f && v.scale > 1.07f && v.scale < 1.2f);
    assert_int_equal(SMR_VERDICT_LOOK, v.level);
    assert_true((v.reasons & SMR_REASON_SCALE) != 0u);
    assert_float_equal(v.expected_error_mm, (sum[0] + sum[1]) / (n[0] + n[1]), 1.0e-3f);
    assert_float_equal(v.expected_visible_mm, sum[1] / n[1], 1.0e-3f);
}

/* An ellipsoid, turned about z. */
static smr_mesh ellipsoid(uint32_t rings, uint32_t around, float degrees)
{
    smr_mesh mesh = rig_ball(1, rings, around, none);
    float *const xyz = rig_alloc(3u * sizeof *xyz * mesh.n_vertices);
    const float c = cosf(degrees * 0.0174532925f), s = sinf(degrees * 0.0174532925f);
    for (uint32_t i = 0; i < mesh.n_vertices; i++) {
        const smr_vec p = smr_load(mesh.xyz + 3u * (size_t)i);
        smr_store(xyz + 3u * (size_t)i, smr_v(70 * c * p.x - 45 * s * p.y, 70 * s * p.x + 45 * c * p.y, 30 * p.z));
    }
    mesh.xyz = xyz;
    return mesh;
}

/* Two balls along z in one structure. The upper one turns about z, the other back by `back` of that. */
static smr *twisted(float degrees, float back)
{
    const float at[2][3] = {{0, 0, 60}, {0, 0, -60}};
    const smr_mesh one = rig_ball(20, 9, 12, none);
    const smr_config config = smr_config_default();
    smr_mesh put[2], turned[2];
    for (uint32_t k = 0; k < 2u; k++) {
        float m[9];
        rig_rotation(0, 0, 1, k == 0u ? degrees : -back * degrees, m);
        put[k] = rig_ball(20, 9, 12, at[k]);
        turned[k] = rig_moved(&one, m, at[k]);
    }
    const smr_mesh mesh = rig_joined(put, 2);
    smr *s = rig_init(rig_model(&mesh, 1, NULL), &config, NULL);
    assert_int_equal(SMR_OK, smr_set_positions(s, 0, rig_joined(turned, 2).xyz));
    return s;
}

/* A part's rotation is that against the whole: of parts that turn by as much to both sides the whole has none. The
 * whole's is that from the start. */
TEST(test_rotations)
{
    static const float degrees[] = {0.0f, 1.0f, 10.0f, 30.0f, 60.0f, 80.0f, 135.0f, 179.0f};
    smr_verdict v;
    for (uint32_t k = 0; k < 8u; k++) {
        smr *s = twisted(0.0f, 1.0f);
        float m[9];
        rig_rotation(1, 2, -2, degrees[k], m);
        for (uint32_t i = 0; i < s->shared.n; i++)
            smr_put3(s->shape.x, i, smr_mul(m, smr_get3(s->shape.start, i)));
        assert_int_equal(SMR_OK, smr_get_verdict(s, 0, &v));
        assert_true(fabsf(v.turned_deg - degrees[k]) < 0.05f && v.rotation_deg < 0.1f);
        if (degrees[k] > 80.0f)
            continue;
        for (uint32_t i = 0; i < 2u; i++) {
            assert_int_equal(SMR_OK, smr_get_verdict(twisted((float)(2u - i) * degrees[k], (float)i), SMR_ALL, &v));
            assert_true(fabsf(v.rotation_deg - degrees[k]) < 0.1f && v.turned_deg < 0.1f);
        }
    }
}

/* The mean expected error, mm, of a registration with one side of itself from a turned start. */
static float expected_of_turned(float degrees)
{
    smr_config config = smr_config_default();
    const smr_mesh mesh = ellipsoid(18, 26, degrees);
    const smr_mesh all = ellipsoid(60, 80, 0), goal = rig_seen_from(&all, (const float[3]){0.0f, 0.98f, 0.17f});
    smr_verdict v;
    config.basic.n_target_vertices = goal.n_vertices;
    smr *s = rig_init(rig_model(&mesh, 1, NULL), &config, NULL);
    assert_int_equal(SMR_OK, smr_set_surface(s, 0, rig_surface(&goal)));
    (void)rig_run(s, 400);
    assert_int_equal(SMR_OK, smr_get_verdict(s, 0, &v));
    return v.expected_error_mm;
}

/* From a start that is far off more is expected: 0.6 and 4.5 mm, where 0.3 and 5.1 are true. */
TEST(test_turned)
{
    assert_in_range((long)(1000.0f * expected_of_turned(0)), 300, 650);
    assert_in_range((long)(1000.0f * expected_of_turned(20)), 3500, 6500); /* 0.9 mm by what is seen alone */
}

/* What is measured of a run that is all right, of a model with edges of 4 mm. */
static smr_verdict fair(float seen, float expected)
{
    smr_verdict v = {.expected_error_mm = expected, .visible_share = seen, .target_covered = 1.0f};
    v.residual_mm = 0.2f;
    v.normals_agree = 1.0f;
    v.image_similarity = v.goals_share = -1.0f;
    v.strain = v.stretch = 0.02f;
    v.volume_ratio = v.scale = v.scale_rest = 1.0f;
    v.bend_mm = 8.0f;
    return v;
}

/* The same expected error is much where the rest of the model is a guess, and not where all of it was seen; landmarks
 * alone, which see single vertices, follow this rule, too, images do not. A part's size has a limit of its own. */
TEST(test_part)
{
    smr_verdict v;
    for (uint32_t k = 0; k < 4u; k++) { /* part or whole, little or more expected */
        v = fair(k < 2u ? 0.7f : 0.9f, k % 2u == 0u ? 2.2f : 2.7f);
        for (int whole = 0; whole < 2; whole++) {
            smr_judge(&v, 4.0f, whole, 0.0f, 1.0f);
            assert_int_equal(k == 1u ? SMR_VERDICT_LOOK : SMR_VERDICT_GOOD, v.level);
            assert_int_equal(k == 1u ? SMR_REASON_LITTLE_VISIBLE : 0u, v.reasons);
        }
    }
    v = fair(0.02f, 2.7f);
    v.target_covered = v.normals_agree = -1.0f;
    smr_judge(&v, 4.0f, 1, 0.0f, 1.0f);
    assert_int_equal(SMR_VERDICT_LOOK, v.level); /* landmarks alone */
    assert_int_equal(SMR_REASON_LITTLE_VISIBLE, v.reasons);
    v.expected_error_mm = 2.2f;
    smr_judge(&v, 4.0f, 1, 0.0f, 1.0f);
    assert_int_equal(SMR_VERDICT_GOOD, v.level);
    v = fair(0.9f, -1.0f); /* a surface of which too little is visible for an estimate */
    smr_judge(&v, 4.0f, 1, -1.0f, 1.0f);
    assert_int_equal(SMR_VERDICT_LOOK, v.level);
    v = fair(0.7f, 2.7f);
    v.target_covered = v.normals_agree = -1.0f;
    v.goals_share = v.image_similarity = 0.95f;
    smr_judge(&v, 4.0f, 1, 0.0f, 1.0f);
    assert_int_equal(SMR_VERDICT_GOOD, v.level); /* an image */
    for (uint32_t k = 0; k < 4u; k++) {
        v = fair(k < 2u ? 0.7f : 0.9f, 1.0f);
        v.scale = k % 2u == 0u ? 1.05f : 1.07f;
        smr_judge(&v, 4.0f, 1, 0.0f, 1.0f);
        assert_int_equal(k == 1u ? SMR_REASON_SCALE : 0u, v.reasons);
    }
}

/* What is noise in a residual gives no doubt. */
TEST(test_residual_of_noise)
{
    for (uint32_t k = 0; k < 2u; k++) {
        smr_verdict v = fair(0.99f, 1.0f);
        v.residual_mm = 1.6f;
        smr_judge(&v, 4.0f, 1, 0.0f, k == 0u ? 1.0f : 0.5f);
        assert_int_equal(k == 0u ? SMR_REASON_RESIDUAL : 0u, v.reasons);
    }
}

/* Low coverage alone is no reason. Five reasons, or large expected errors, fail. A whole target has wider limits. */
TEST(test_together)
{
    smr_verdict v;
    for (uint32_t k = 0; k < 4u; k++) { /* all or part visible, alone or beside another reason */
        v = fair(k < 2u ? 0.99f : 0.9f, 1.0f);
        v.target_covered = 0.6f;
        v.rotation_deg = k % 2u == 0u ? 0.0f : 16.0f;
        smr_judge(&v, 4.0f, 1, 0.0f, 1.0f);
        assert_int_equal(k == 0u ? SMR_VERDICT_GOOD : SMR_VERDICT_LOOK, v.level);
        assert_int_equal((k == 0u ? 0u : SMR_REASON_UNCOVERED) | (k % 2u == 0u ? 0u : SMR_REASON_ROTATION), v.reasons);
    }
    for (uint32_t k = 0; k < 4u; k++) { /* elsewhere; bent from one body to another; a part of a larger target */
        v = fair(0.99f, 1.0f);
        v.target_covered = k == 0u ? 0.3f : k == 3u ? 0.8f : 0.66f;
        v.bend_mm = k % 2u == 0u ? 8.0f : 12.3f;
        smr_judge(&v, 4.0f, 1, 0.0f, 1.0f);
        assert_int_equal(k < 2u ? SMR_VERDICT_LOOK : SMR_VERDICT_GOOD, v.level);
    }
    for (uint32_t k = 0; k < 2u; k++) { /* four reasons, or five */
        v = fair(0.9f, 1.0f);
        v.rotation_deg = 16.0f;
        v.stretch = 0.06f;
        v.volume_ratio = 1.3f;
        v.bend_mm = 21.0f;
        v.scale = k == 0u ? 1.0f : 1.3f;
        smr_judge(&v, 4.0f, 1, 0.0f, 1.0f);
        assert_int_equal(k == 0u ? SMR_VERDICT_LOOK : SMR_VERDICT_FAILED, v.level);
    }
    for (uint32_t k = 0; k < 4u; k++) { /* on a surface or in an image that is like the reference, or in another */
        v = fair(0.9f, k == 0u ? 11.0f : 12.1f);
        v.bend_mm = 15.0f;
        if (k >= 2u) {
            v.target_covered = v.normals_agree = -1.0f;
            v.goals_share = 0.95f;
            v.image_similarity = k == 2u ? 0.9f : 0.7f;
        }
        smr_judge(&v, 4.0f, 1, 0.0f, 1.0f);
        assert_int_equal(k == 0u ? SMR_VERDICT_LOOK : k == 2u ? SMR_VERDICT_GOOD : SMR_VERDICT_FAILED, v.level);
    }
    for (uint32_t k = 0; k < 2u; k++) { /* the whole target, or the most of it */
        v = fair(k == 0u ? 0.99f : 0.97f, 1.0f);
        v.rotation_deg = 16.0f;
        v.stretch = 0.048f;
        v.volume_ratio = 0.76f;
        smr_judge(&v, 4.0f, 1, 0.0f, 1.0f);
        assert_int_equal(k == 0u ? SMR_VERDICT_GOOD : SMR_VERDICT_LOOK, v.level);
    }
}

/* Edges of a surface that lies close on its target have not changed by noise; landmarks have a limit for all. */
TEST(test_strain)
{
    static const struct {
        float residual_mm, strain;
        int surface;
        uint32_t reasons;
    } all[] = {{0.05f, 0.14f, 1, 0}, {0.05f, 0.16f, 1, SMR_REASON_STRAIN},
               {0.2f, 0.17f, 1, 0},  {0.2f, 0.19f, 1, SMR_REASON_STRAIN},
               {0.9f, 0.24f, 1, 0},  {0.9f, 0.26f, 1, SMR_REASON_STRAIN},
               {0.05f, 0.24f, 0, 0}, {0.05f, 0.26f, 0, SMR_REASON_STRAIN}};
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
        smr_verdict v = fair(0.9f, 1.0f);
        v.residual_mm = all[i].residual_mm;
        v.strain = all[i].strain;
        if (!all[i].surface)
            v.target_covered = v.normals_agree = -1.0f;
        smr_judge(&v, 4.0f, 1, 0.0f, 1.0f);
        assert_int_equal(all[i].reasons, v.reasons);
    }
}

/* Each measure alone: a value that is good, one that leaves doubt and one that fails the run, far from the limits.
 * kind: a surface, an image, or landmarks. A failed value of 0 is none. */
TEST(test_each_measure)
{
    enum { SURFACE, IMAGE, MARKS };
#define AT(field) offsetof(smr_verdict, field)
    static const struct {
        size_t at;
        uint32_t kind, reason;
        float good, look, failed;
    } all[] = {{AT(scale), SURFACE, SMR_REASON_SCALE, 1.15f, 1.4f, 0},
               {AT(scale), MARKS, SMR_REASON_SCALE, 0.85f, 0.7f, 0},
               {AT(stretch), SURFACE, SMR_REASON_STRAIN, 0.03f, 0.08f, 0.6f},
               {AT(strain), MARKS, SMR_REASON_STRAIN, 0.2f, 0.4f, 0},
               {AT(volume_ratio), SURFACE, SMR_REASON_VOLUME, 1.15f, 1.5f, 6},
               {AT(volume_ratio), MARKS, SMR_REASON_VOLUME, 0.87f, 0.7f, -1},
               {AT(rotation_deg), SURFACE, SMR_REASON_ROTATION, 8, 25, 60},
               {AT(bend_mm), MARKS, SMR_REASON_BEND, 12, 30, 0},
               {AT(visible_share), SURFACE, SMR_REASON_LITTLE_VISIBLE, 0.5f, 0.05f, 0},
               {AT(target_covered), SURFACE, SMR_REASON_UNCOVERED, 0.98f, 0.3f, 0},
               {AT(normals_agree), SURFACE, SMR_REASON_NORMALS, 0.95f, 0.7f, 0.3f},
               {AT(residual_mm), SURFACE, SMR_REASON_RESIDUAL, 0.5f, 2, 0},
               {AT(residual_mm), MARKS, SMR_REASON_RESIDUAL, 2.5f, 4, 0},
               {AT(expected_error_mm), MARKS, SMR_REASON_LITTLE_VISIBLE, 1, -1, 0},
               {AT(image_similarity), IMAGE, SMR_REASON_SIMILARITY, 0.92f, 0.7f, 0.2f},
               {AT(goals_share), IMAGE, SMR_REASON_GOALS, 0.92f, 0.6f, 0.1f}};
#undef AT
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++)
        for (uint32_t level = SMR_VERDICT_GOOD; level <= SMR_VERDICT_FAILED; level++) {
            const float value = level == SMR_VERDICT_GOOD   ? all[i].good
                                : level == SMR_VERDICT_LOOK ? all[i].look
                                                            : all[i].failed;
            smr_verdict v = fair(0.9f, 1.0f);
            if (level == SMR_VERDICT_FAILED && value == 0.0f)
                continue;
            if (all[i].kind != SURFACE)
                v.target_covered = v.normals_agree = -1.0f;
            if (all[i].kind == IMAGE)
                v.goals_share = v.image_similarity = 0.95f;
            memcpy((unsigned char *)&v + all[i].at, &value, sizeof value);
            smr_judge(&v, 4.0f, 1, 0.0f, 1.0f);
            if (v.level != level || v.reasons != (level == SMR_VERDICT_GOOD ? 0u : all[i].reason))
                fail_msg("row %zu: %g is level %u for %x", i, (double)value, v.level, v.reasons);
        }
}

/* The level follows from the probability, and a worse measure never makes the result more probable. Doubts add up: some
 * measures short of their limits are a reason together, and then the largest are named. */
TEST(test_probability)
{
    static const struct {
        size_t at;
        float best, worst;
    } all[] = {{offsetof(smr_verdict, expected_error_mm), 0.5f, 40.0f},
               {offsetof(smr_verdict, residual_mm), 0.1f, 20.0f},
               {offsetof(smr_verdict, visible_share), 1.0f, 0.01f},
               {offsetof(smr_verdict, target_covered), 1.0f, 0.0f},
               {offsetof(smr_verdict, normals_agree), 1.0f, 0.0f},
               {offsetof(smr_verdict, scale), 1.0f, 9.0f},
               {offsetof(smr_verdict, strain), 0.01f, 2.0f},
               {offsetof(smr_verdict, stretch), 0.01f, 1.0f},
               {offsetof(smr_verdict, volume_ratio), 1.0f, 0.01f},
               {offsetof(smr_verdict, rotation_deg), 0.0f, 180.0f},
               {offsetof(smr_verdict, bend_mm), 8.0f, 200.0f}};
    smr_verdict v;
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
        float before = 1.0f;
        for (uint32_t k = 0; k <= 50u; k++) {
            v = fair(1.0f, 0.5f);
            const float measure = all[i].best + (all[i].worst - all[i].best) * (float)k / 50.0f;
            memcpy((char *)&v + all[i].at, &measure, sizeof measure);
            smr_judge(&v, 4.0f, 1, 0.0f, 1.0f);
            assert_true(v.probability >= 0.0f && v.probability <= before && (k > 0u || v.probability > 0.9f));
            assert_int_equal(v.probability > SMR_PROBABILITY_GOOD, v.level == SMR_VERDICT_GOOD);
            assert_int_equal(v.probability < SMR_PROBABILITY_FAILED, v.level == SMR_VERDICT_FAILED);
            assert_int_equal(v.level == SMR_VERDICT_GOOD, v.reasons == 0u);
            before = v.probability;
        }
        assert_true(before < SMR_PROBABILITY_GOOD);
    }
    v = fair(0.9f, 1.0f);
    v.residual_mm = NAN;
    smr_judge(&v, 4.0f, 1, 0.0f, 1.0f);
    assert_true(v.level == SMR_VERDICT_FAILED && v.reasons == SMR_REASON_RESIDUAL);
    v = fair(0.9f, 5.0f);
    v.rotation_deg = 14.5f;
    smr_judge(&v, 4.0f, 1, 0.0f, 1.0f);
    assert_int_equal(SMR_VERDICT_LOOK, v.level);
    assert_true((v.reasons & SMR_REASON_ROTATION) != 0u && v.probability < SMR_PROBABILITY_GOOD);
}

TEST(test_reasons)
{
    for (uint32_t k = 0; k < 32u; k++)
        assert_int_equal(1u << k <= SMR_REASON_SUBJECTS, smr_reason_text(1u << k)[0] != '\0');
    assert_int_equal('\0', smr_reason_text(0)[0]);
    assert_int_equal('\0', smr_reason_text(3)[0]);
}
