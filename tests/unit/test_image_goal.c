/* test_image_goal.c: a ball follows its computed image, and nothing that is not there.
 * SPDX-License-Identifier: MIT */
#include "suite.h"

#include <math.h>
#include <string.h>

#include "property/rig_ball_image.h"
#include "registration/registration.h"

static double off_ball(const smr *s, const smr_model *model, double radius, const float centre[3])
{
    smr_model_info info;
    double sum = 0.0;
    (void)smr_model_get_info(model, &info);
    const float *x = rig_positions(s, model);
    for (uint32_t i = 0; i < info.n_vertices; i++) {
        double d2 = 0.0;
        for (uint32_t a = 0; a < 3u; a++) {
            const double d = (double)x[3u * i + a] - (double)centre[a];
            d2 += d * d;
        }
        sum += fabs(sqrt(d2) - radius);
    }
    return sum / info.n_vertices;
}

/* Means over samples leave few goals in noise, too few to move the model, and no profile fits better in its place than
 * beside it. */
TEST(test_noise_fails)
{
    float *voxels;
    uint32_t seed = 5;
    const smr_volume reference = rig_ball_image(RIG_BALL_MM, rig_nowhere);
    const smr_volume noise = rig_cube(RIG_BALL_SIDE, RIG_BALL_SPACING, &voxels);
    const smr_model *model = rig_ball_model(&reference);
    const smr_config config = smr_config_default_image();
    smr *s = rig_init(model, &config, NULL);
    smr_verdict v;
    for (uint32_t i = 0; i < RIG_BALL_SIDE * RIG_BALL_SIDE * RIG_BALL_SIDE; i++)
        voxels[i] = rig_between(&seed, 100.0f, 900.0f);
    assert_int_equal(SMR_OK, smr_set_volume(s, &noise));
    const smr_tick_report last = rig_run(s, 200);
    assert_int_equal(SMR_OK, smr_get_verdict(s, 0, &v));
    assert_int_equal(SMR_VERDICT_FAILED, v.level);
    assert_true((v.reasons & SMR_REASON_SIMILARITY) != 0u && v.image_similarity < 0.5f);
    assert_true(last.done == 1u && last.details.matched_share < 0.3f);
    assert_true(off_ball(s, model, (double)RIG_BALL_MM, rig_nowhere) < 0.2);
}

/* How like the reference an image is, of values first + by * reference, where the model is `off` mm from its place. */
static float similarity_of(float first, float by, float off)
{
    const uint32_t n = RIG_BALL_SIDE * RIG_BALL_SIDE * RIG_BALL_SIDE;
    const smr_volume reference = rig_ball_image(RIG_BALL_MM, rig_nowhere);
    const smr_pose pose = {{{1, 0, 0, off}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    const smr_config config = smr_config_default_image();
    smr_volume image = reference;
    smr_verdict v;
    float *voxels = rig_alloc(n * sizeof *voxels);
    for (uint32_t i = 0; i < n; i++)
        voxels[i] = first + by * ((const float *)reference.voxels)[i];
    image.voxels = voxels;
    smr *s = rig_init(rig_ball_model(&reference), &config, NULL);
    assert_int_equal(SMR_OK, smr_set_volume(s, &image));
    assert_int_equal(SMR_OK, smr_set_pose(s, &pose));
    assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
    assert_int_equal(SMR_OK, smr_get_verdict(s, 0, &v));
    return v.image_similarity;
}

/* Brightness and contrast do not count where the model is in its place; the negative of an image is unlike it. */
TEST(test_similarity)
{
    static const struct {
        float first, by, off, least, most;
    } all[] = {{0, 1, 0, 0.99f, 1},       {300, 1, 0, 0.99f, 1},        {0, 0.3f, 0, 0.99f, 1},
               {300, 1, 10, 0.99f, 1},    {0, 1, 15, 0.9f, 0.99f},      {0, 0.3f, 15, 0.6f, 0.9f},
               {1000, -1, 0, -1, -0.98f}, {1000, -1, 15, -0.9f, -0.6f}, {500, 0, 0, -0.01f, 0.01f}};
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
        const float similarity = similarity_of(all[i].first, all[i].by, all[i].off);
        if (!(similarity >= all[i].least && similarity <= all[i].most))
            fail_msg("row %zu: %g", i, (double)similarity);
    }
}

TEST(test_follows_image)
{
    const smr_volume reference = rig_ball_image(RIG_BALL_MM, rig_nowhere),
                     target = rig_ball_image(RIG_BALL_MM + 2.0f, rig_shift);
    const smr_model *model = rig_ball_model(&reference);
    for (uint32_t similarity = 0; similarity <= SMR_SIMILARITY_CONCORDANCE; similarity++) {
        smr_config c = smr_config_default();
        c.image.similarity = similarity;
        smr *s = rig_init(model, &c, NULL);
        assert_int_equal(SMR_OK, smr_set_volume(s, &target));
        assert_true(off_ball(s, model, (double)RIG_BALL_MM + 2.0, rig_shift) > 1.5);
        smr_tick_report r = rig_run(s, 1);
        assert_true(r.details.n_active > 0u &&
                    r.details.n_active <= s->shared.n); /* at large radii not every vertex takes part */
        assert_true(r.n_forces > r.details.n_active / 2u);
        r = rig_run(s, 10000);
        assert_int_equal(1, r.done);
        const double off = off_ball(s, model, (double)RIG_BALL_MM + 2.0, rig_shift);
        if (!(off < 0.3))
            fail_msg("similarity %u: %f mm off in the mean", similarity, off);
        assert_true(rig_finite(rig_positions(s, model), s->shared.n));
    }
}

/* Forces fade to 0 where the schedule ends, and vertices without a goal are smoothed: a structure's residuals are the
 * distances to goals all the same. */
TEST(test_structure_report)
{
    const smr_volume reference = rig_ball_image(RIG_BALL_MM, rig_nowhere);
    smr_volume target = rig_ball_image(RIG_BALL_MM + 2.0f, rig_shift);
    const smr_model *model = rig_ball_model(&reference);
    const smr_config c = smr_config_default_image();
    smr_structure_report part;
    smr_tick_report r = {0};
    uint32_t rejected = 0;
    float *voxels = rig_alloc(RIG_BALL_SIDE * RIG_BALL_SIDE * RIG_BALL_SIDE * sizeof *voxels);
    memcpy(voxels, target.voxels, RIG_BALL_SIDE * RIG_BALL_SIDE * RIG_BALL_SIDE * sizeof *voxels);
    for (uint32_t i = RIG_BALL_SIDE * RIG_BALL_SIDE * (RIG_BALL_SIDE / 2u + 5u);
         i < RIG_BALL_SIDE * RIG_BALL_SIDE * RIG_BALL_SIDE; i++)
        voxels[i] = (float)(i % RIG_BALL_SIDE); /* no goal where this is */
    target.voxels = voxels;
    smr *s = rig_init(model, &c, NULL);
    assert_int_equal(SMR_OK, smr_set_volume(s, &target));
    while (r.done == 0u) {
        r = rig_run(s, 1);
        rejected += r.details.n_rejected;
        assert_int_equal(SMR_OK, smr_get_structure_report(s, 0, &part));
        assert_true(part.n_forces == r.n_forces && part.n_rejected == r.details.n_rejected);
        assert_true(fabsf(part.residual_mean_mm - r.residual_mean_mm) < 1.0e-4f);
        assert_true(fabsf(part.residual_max_mm - r.details.residual_max_mm) < 1.0e-4f);
    }
    assert_true(rejected > 0u && r.n_forces > 0u && part.residual_mean_mm > 0.0f);
}

/* The model rests in its place when its image turns to one brightness. Vertices keep their goals for image.rest
 * iterations, but search at once in an image that is set. */
TEST(test_rest)
{
    const uint32_t n = RIG_BALL_SIDE * RIG_BALL_SIDE * RIG_BALL_SIDE;
    for (uint32_t row = 0; row < 6u; row++) {
        const uint32_t rest = row % 3u, again = row / 3u;
        const smr_volume reference = rig_ball_image(RIG_BALL_MM, rig_nowhere);
        smr_volume image = reference;
        smr_config c = smr_config_default_image();
        c.image.rest = rest;
        smr *s = rig_init(rig_ball_model(&reference), &c, NULL);
        float *voxels = rig_alloc(n * sizeof *voxels);
        memcpy(voxels, reference.voxels, n * sizeof *voxels);
        image.voxels = voxels;
        assert_int_equal(SMR_OK, smr_set_volume(s, &image));
        const uint32_t before = rig_run(s, 1).n_forces;
        assert_true(before > 0u);
        memset(voxels, 0, n * sizeof *voxels);
        if (again)
            assert_int_equal(SMR_OK, smr_set_volume(s, &image));
        for (uint32_t k = 1; k <= 3u; k++) {
            const uint32_t goals = rig_run(s, 1).n_forces;
            if ((k <= rest && !again) ? goals < before / 8u : goals > 0u)
                fail_msg("row %u: %u of %u goals in iteration %u", row, goals, before, k);
        }
    }
}

/* Vertices that take part again after 256 iterations, the number that the iteration of a search is stored modulo, keep
 * no goals of an image that turned to one brightness meanwhile. */
TEST(test_rest_of_inactive)
{
    const size_t bytes = (size_t)RIG_BALL_SIDE * RIG_BALL_SIDE * RIG_BALL_SIDE * sizeof(float);
    smr_volume image = rig_ball_image(RIG_BALL_MM, rig_nowhere);
    const smr_model *model = rig_ball_model(&image);
    smr_config c = smr_config_default_image();
    c.basic.iterations = c.basic.iterations_last = 1000;
    c.motion.settle_um = 0.0f;
    smr *s = rig_init(model, &c, NULL);
    float *voxels = rig_alloc(bytes);
    memcpy(voxels, image.voxels, bytes);
    image.voxels = voxels;
    assert_int_equal(SMR_OK, smr_set_volume(s, &image));
    assert_true(rig_run(s, 1).n_forces > 0u);
    memset(voxels, 0, bytes);
    assert_int_equal(SMR_OK, smr_set_active(s, 1));
    assert_true(rig_run(s, 256).iteration == 257u);
    assert_int_equal(SMR_OK, smr_set_active(s, UINT32_MAX));
    assert_int_equal(0, rig_run(s, 1).n_forces);
}

/* The macros bound the arena of a large structure, and of many small ones, with profiles and without. */
TEST(test_arena_macros)
{
    smr_mesh mesh[100];
    const float *const at = rig_nowhere;
    const smr_volume reference = rig_ball_image(RIG_BALL_MM, at);
    for (uint32_t row = 0; row < 8u; row++) {
        const uint32_t n = row % 2u ? 100u : 1u, rest = row & 2u;
        smr_prepare_config radii = rig_radii(1, 15.0f, 15.0f, 0);
        smr_config c = smr_config_default_image();
        smr_model_info info;
        size_t bytes = 0;
        for (uint32_t i = 0; i < n; i++)
            mesh[i] = rig_ball(RIG_BALL_MM, n > 1u ? 5 : 40, n > 1u ? 6 : 60, at);
        radii.reference = row < 4u ? &reference : NULL;
        c.image.rest = rest;
        const smr_model *model = rig_model(mesh, n, &radii);
        assert_int_equal(SMR_OK, smr_model_get_info(model, &info));
        assert_int_equal(SMR_OK, smr_arena_bytes(model, &c, &bytes));
        const size_t image = row < 4u ? SMR_ARENA_IMAGE_BYTES(info.n_vertices) : 0u;
        const size_t most = SMR_ARENA_BYTES(info.n_vertices, info.n_triangles, n, 1, 0, SMR_METHOD_RIGID) + image;
        if (bytes > most || (rest > 0u && most > bytes + 8192u))
            fail_msg("row %u: %zu bytes, the macros say %zu", row, bytes, most);
    }
}

/* A surface that says 29 mm and an image that says 31: the image counts as far as it may. */
TEST(test_beside_a_surface)
{
    static const float shares[] = {0.0f, 0.5f, 1.0f};
    const smr_volume reference = rig_ball_image(RIG_BALL_MM, rig_nowhere),
                     target = rig_ball_image(RIG_BALL_MM + 1.0f, rig_nowhere);
    const smr_model *model = rig_ball_model(&reference);
    const smr_mesh ball = rig_ball(RIG_BALL_MM - 1.0f, 13, 20, rig_nowhere);
    const smr_surface *surface = rig_surface(&ball);
    double off[3];
    uint64_t hash = 0;
    for (uint32_t i = 0; i < 3u; i++) {
        smr_config c = smr_config_default();
        c.image.beside = shares[i];
        c.image.profile_end_mm = 5.0f; /* seeks to the end */
        smr *s = rig_init(model, &c, NULL);
        assert_int_equal(SMR_OK, smr_set_surface(s, 0, surface));
        assert_int_equal(SMR_OK, smr_set_volume(s, &target));
        (void)rig_run(s, 12); /* before image forces ease */
        off[i] = off_ball(s, model, (double)RIG_BALL_MM - 1.0, rig_nowhere);
        if (i == 0u)
            hash = smr_state_hash(s);
    }
    smr_config c = smr_config_default(); /* without the setting */
    c.image.profile_end_mm = 5.0f;
    smr *s = rig_init(model, &c, NULL);
    assert_int_equal(SMR_OK, smr_set_surface(s, 0, surface));
    assert_int_equal(SMR_OK, smr_set_volume(s, &target));
    (void)rig_run(s, 12);
    assert_true(smr_state_hash(s) == hash);
    if (!(off[0] < 0.2 && off[1] > off[0] + 0.2 && off[2] > off[1] + 0.1 && off[2] < 1.5))
        fail_msg("off by %g %g %g", off[0], off[1], off[2]);
}

/* The slices of an image above its middle. */
static smr_volume upper_half(smr_volume image)
{
    const uint32_t below = image.size[2] / 2u;
    image.voxels = (const float *)image.voxels + (size_t)image.size[0] * image.size[1] * below;
    image.origin[2] += image.spacing[2] * (float)below;
    image.size[2] -= below;
    return image;
}

/* The search for an edge reads two samples beyond its distance to both sides: only where one of these lies outside the
 * image it is undecided whether there is a goal. */
TEST(test_search_beyond_the_image)
{
    enum { REACH = 22 };
    const smr_volume reference = rig_ball_image(RIG_BALL_MM, rig_nowhere);
    const smr_config c = smr_config_default_image();
    float *voxels;
    smr_volume image = rig_cube(RIG_BALL_SIDE, RIG_BALL_SPACING, &voxels);
    smr *s = rig_init(rig_ball_model(&reference), &c, NULL);
    const float step = smr_le_float(s->shared.model->profile_step), deep = RIG_BALL_SPACING * (RIG_BALL_SIDE - 1u);
    smr_vec displacement;
    uint32_t top = 0;
    for (uint32_t k = 0; k < RIG_BALL_SIDE * RIG_BALL_SIDE * RIG_BALL_SIDE; k++)
        voxels[k] = 500.0f + 1.0e-6f * (float)k; /* no edge */
    while (smr_get3(s->shape.x, top).z < RIG_BALL_MM - 1.0e-3f)
        top++;
    for (uint32_t i = 0; i < 4u; i++) {
        const float way = (REACH + (i % 2u ? 2.5f : 1.5f)) * step;
        image.origin[2] = i < 2u ? RIG_BALL_MM - way : RIG_BALL_MM + way - deep;
        assert_int_equal(SMR_OK, smr_set_volume(s, &image));
        s->schedule.profile_mm = 0.0f;
        s->schedule.gradient_mm = REACH * step;
        smr_guard_close(s);
        const int found = s->forces.image.calls->goal(&s->forces.image, top, &displacement);
        assert_int_equal(i % 2u ? SMR_NO_GOAL : SMR_UNDECIDED, found);
    }
}

/* Half of a ball lies in the target image, or in the reference image: the other half follows, is no failure of the
 * image, and the verdict tells how much is visible. */
TEST(test_half_in_image)
{
    const smr_volume reference = rig_ball_image(RIG_BALL_MM, rig_nowhere),
                     target = rig_ball_image(RIG_BALL_MM + 2.0f, rig_shift);
    const smr_volume half[2] = {upper_half(reference), upper_half(target)};
    const smr_config c = smr_config_default_image();
    for (uint32_t i = 0; i < 2u; i++) {
        const smr_model *model = rig_ball_model(i == 0u ? &half[0] : &reference);
        smr *s = rig_init(model, &c, NULL);
        smr_verdict v;
        smr_tick_report r = {0};
        assert_int_equal(SMR_OK, smr_set_volume(s, i == 0u ? &target : &half[1]));
        for (uint32_t k = 0; r.done == 0u && k < 400u; k++) {
            r = rig_run(s, 1);
            assert_true(r.details.n_active < s->shared.n); /* invisible vertices have no target */
        }
        assert_int_equal(SMR_OK, smr_get_verdict(s, 0, &v));
        const double off = off_ball(s, model, (double)RIG_BALL_MM + 2.0, rig_shift);
        if (!(off < 0.6 && v.goals_share > 0.95f && v.image_similarity > 0.9f))
            fail_msg("%u: %f mm off, goals %f, similarity %f", i, off, (double)v.goals_share,
                     (double)v.image_similarity);
        assert_true(v.visible_share > 0.3f && v.visible_share < 0.6f && v.level != SMR_VERDICT_FAILED);
        assert_true((v.reasons & SMR_REASON_GOALS) == 0u);
    }
}
