/* test_image_goal.c: a ball follows its computed image, and nothing that is not there.
 * SPDX-License-Identifier: MIT */
#include "cmocka_first.h"

#include <math.h>
#include <string.h>

#include "property/rig_ball_image.h"
#include "registration/registration.h"

static int tidy(void **state)
{
    (void)state;
    rig_free_all();
    return 0;
}

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

/* Nearly every vertex finds a goal in noise, but no profile fits better in its place than beside it. */
static void test_noise_fails(void **state)
{
    float *voxels;
    uint32_t seed = 5;
    const smr_volume reference = rig_ball_image(RIG_BALL_MM, rig_nowhere);
    const smr_volume noise = rig_cube(RIG_BALL_SIDE, RIG_BALL_SPACING, &voxels);
    const smr_model *model = rig_ball_model(&reference);
    const smr_config config = smr_config_default_image();
    smr *s = rig_init(model, &config, NULL);
    smr_verdict v;
    (void)state;
    for (uint32_t i = 0; i < RIG_BALL_SIDE * RIG_BALL_SIDE * RIG_BALL_SIDE; i++)
        voxels[i] = rig_between(&seed, 100.0f, 900.0f);
    assert_int_equal(SMR_OK, smr_set_volume(s, &noise));
    const smr_tick_report last = rig_run(s, 200);
    assert_int_equal(SMR_OK, smr_get_verdict(s, 0, &v));
    assert_int_equal(SMR_VERDICT_FAILED, v.level);
    assert_true((v.reasons & SMR_REASON_SIMILARITY) != 0u && v.image_similarity < 0.5f);
    assert_true(last.done == 1u && last.details.matched_share > 0.3f);
}

static void test_follows_image(void **state)
{
    const smr_volume reference = rig_ball_image(RIG_BALL_MM, rig_nowhere),
                     target = rig_ball_image(RIG_BALL_MM + 2.0f, rig_shift);
    const smr_model *model = rig_ball_model(&reference);
    (void)state;
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
            print_error("similarity %u: %f mm off in the mean\n", similarity, off);
        assert_true(off < 0.3);
        assert_true(rig_finite(rig_positions(s, model), s->shared.n));
    }
}

/* The image of a ball with waves inside and outside, turned about z: only the waves tell by how much. */
static smr_volume turned_image(double angle)
{
    smr_volume v = rig_ball_image(RIG_BALL_MM, rig_nowhere);
    float *voxels = rig_alloc(RIG_BALL_SIDE * RIG_BALL_SIDE * RIG_BALL_SIDE * sizeof *voxels);
    memcpy(voxels, v.voxels, RIG_BALL_SIDE * RIG_BALL_SIDE * RIG_BALL_SIDE * sizeof *voxels);
    for (uint32_t i = 0; i < RIG_BALL_SIDE * RIG_BALL_SIDE * RIG_BALL_SIDE; i++) {
        const double x = (double)(v.origin[0] + RIG_BALL_SPACING * (float)(i % RIG_BALL_SIDE));
        const double y = (double)(v.origin[1] + RIG_BALL_SPACING * (float)(i / RIG_BALL_SIDE % RIG_BALL_SIDE));
        const double back_x = cos(angle) * x + sin(angle) * y, back_y = cos(angle) * y - sin(angle) * x;
        voxels[i] += (float)(250.0 * (sin(0.15 * back_x) + cos(0.17 * back_y)));
    }
    v.voxels = voxels;
    return v;
}

/* Mean distance of the vertices from where they would be if the model had turned, too. */
static double off_turned(const smr *s, const smr_model *model, const float *before, double angle)
{
    const float *x = rig_positions(s, model);
    double sum = 0.0;
    for (uint32_t i = 0; i < s->shared.n; i++) {
        const double to[3] = {cos(angle) * (double)before[3u * i] - sin(angle) * (double)before[3u * i + 1u],
                              sin(angle) * (double)before[3u * i] + cos(angle) * (double)before[3u * i + 1u],
                              (double)before[3u * i + 2u]};
        double d2 = 0.0;
        for (uint32_t a = 0; a < 3u; a++)
            d2 += ((double)x[3u * i + a] - to[a]) * ((double)x[3u * i + a] - to[a]);
        sum += sqrt(d2);
    }
    return sum / s->shared.n;
}

/* A ball that turned: along its normals the turn is invisible. It must not turn far either where the image has not
 * turned, whatever its contrast and brightness: half as much contrast again, taken for a displacement, would be 8
 * mm. */
static void test_turns(void **state)
{
    static const double angle = 0.12; /* 3.6 mm at the equator */
    static const float gain[4] = {1.0f, 0.8f, 1.5f, 1.0f}, brighter[4] = {0.0f, 0.0f, 0.0f, 100.0f};
    const smr_volume reference = turned_image(0.0);
    const smr_model *model = rig_ball_model(&reference);
    (void)state;
    for (uint32_t k = 0; k < 4u; k++) {
        double off[3] = {0.0, 0.0, 0.0}, start = 0.0;
        for (uint32_t i = 0; i < 3u; i++) {
            smr_config c = smr_config_default_image();
            smr_volume target = turned_image(i < 2u ? angle : 0.0);
            float *voxels = rig_alloc(RIG_BALL_SIDE * RIG_BALL_SIDE * RIG_BALL_SIDE * sizeof *voxels);
            for (uint32_t v = 0; v < RIG_BALL_SIDE * RIG_BALL_SIDE * RIG_BALL_SIDE; v++)
                voxels[v] = gain[k] * ((const float *)target.voxels)[v] + brighter[k];
            target.voxels = voxels;
            c.image.sideways = i == 0u ? 0.0f : 0.5f;
            smr *s = rig_init(model, &c, NULL);
            const float *before = rig_positions(s, model);
            start = i < 2u ? off_turned(s, model, before, angle) : start;
            assert_int_equal(SMR_OK, smr_set_volume(s, &target));
            assert_int_equal(1, rig_run(s, 10000).done);
            off[i] = off_turned(s, model, before, i < 2u ? angle : 0.0);
        }
        if (!(off[0] > 0.9 * start && off[1] < 0.6 * start && off[2] < 0.6 * start)) {
            print_error("case %u: %f mm off at the start, %f without sideways goals, %f with them; not turned: %f\n", k,
                        start, off[0], off[1], off[2]);
        }
        assert_true(off[0] > 0.9 * start && off[1] < 0.6 * start && off[2] < 0.6 * start);
    }
}

static void test_image_elsewhere(void **state)
{
    const smr_volume reference = rig_ball_image(RIG_BALL_MM, rig_nowhere);
    smr_volume target = rig_ball_image(RIG_BALL_MM, rig_nowhere);
    const smr_model *model = rig_ball_model(&reference);
    const smr_config c = smr_config_default();
    smr *s = rig_init(model, &c, NULL);
    (void)state;
    target.origin[0] += 5000.0f;
    const float *before = rig_positions(s, model);
    assert_int_equal(SMR_OK, smr_set_volume(s, &target));
    const smr_tick_report r = rig_run(s, 12);
    assert_int_equal(0, r.n_forces);
    assert_true(r.details.n_active > 0u);
    assert_int_equal(r.details.n_active, r.details.n_rejected);
    const smr_tick_report end = rig_run(s, 10000);
    assert_int_equal(1, end.done);
    assert_true(rig_far(before, rig_positions(s, model), s->shared.n) < 1.0e-3f);
}

static void test_equal_bits(void **state)
{
    const smr_volume reference = rig_ball_image(RIG_BALL_MM, rig_nowhere),
                     target = rig_ball_image(RIG_BALL_MM + 2.0f, rig_shift);
    const smr_model *model = rig_ball_model(&reference);
    uint64_t hash = 0;
    (void)state;
    for (uint32_t k = 0; k <= RIG_SCHEDULERS; k++) {
        smr_config c = smr_config_default();
        c.basic.n_workers = k == 0u ? 1u : 4u;
        const smr_port port = rig_port(k == 0u ? RIG_PLAIN : k - 1u, c.basic.n_workers);
        smr *s = rig_init(model, &c, &port);
        assert_int_equal(SMR_OK, smr_set_volume(s, &target));
        const smr_tick_report r = rig_run(s, 12);
        assert_true(r.n_forces > 0u);
        hash = k == 0u ? smr_state_hash(s) : hash;
        assert_true(hash == smr_state_hash(s));
    }
}

/* A structure with a surface follows the surface, not the image. */
static void test_surface_first(void **state)
{
    const smr_volume reference = rig_ball_image(RIG_BALL_MM, rig_nowhere),
                     target = rig_ball_image(RIG_BALL_MM + 4.0f, rig_shift);
    const smr_mesh goal = rig_ball(RIG_BALL_MM - 2.0f, 15, 22, rig_nowhere);
    const smr_surface *surface = rig_surface(&goal);
    const smr_model *model = rig_ball_model(&reference);
    const smr_config c = smr_config_default();
    (void)state;
    smr *s = rig_init(model, &c, NULL);
    assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, surface));
    assert_int_equal(SMR_OK, smr_set_volume(s, &target));
    assert_int_equal(1, rig_run(s, 10000).done);
    assert_true(off_ball(s, model, (double)RIG_BALL_MM - 2.0, rig_nowhere) < 0.5);
}

/* Forces fade to 0 where the schedule ends, and vertices without a goal are smoothed: a structure's residuals are the
 * distances to goals all the same. */
static void test_structure_report(void **state)
{
    const smr_volume reference = rig_ball_image(RIG_BALL_MM, rig_nowhere);
    smr_volume target = rig_ball_image(RIG_BALL_MM + 2.0f, rig_shift);
    const smr_model *model = rig_ball_model(&reference);
    const smr_config c = smr_config_default_image();
    smr_structure_report part;
    smr_tick_report r = {0};
    (void)state;
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

/* A surface that says 29 mm and an image that says 31: the image counts as far as it may. */
static void test_beside_a_surface(void **state)
{
    static const float shares[] = {0.0f, 0.5f, 1.0f};
    const smr_volume reference = rig_ball_image(RIG_BALL_MM, rig_nowhere),
                     target = rig_ball_image(RIG_BALL_MM + 1.0f, rig_nowhere);
    const smr_model *model = rig_ball_model(&reference);
    const smr_mesh ball = rig_ball(RIG_BALL_MM - 1.0f, 13, 20, rig_nowhere);
    const smr_surface *surface = rig_surface(&ball);
    double off[3];
    uint64_t hash = 0;
    (void)state;
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
        print_error("off by %g %g %g\n", off[0], off[1], off[2]);
    assert_true(off[0] < 0.2 && off[1] > off[0] + 0.2 && off[2] > off[1] + 0.1 && off[2] < 1.5);
}

/* An image of a ball that is 3 mm larger below: its upper half is that of the model. */
static smr_volume larger_below(void)
{
    const smr_volume large = rig_ball_image(RIG_BALL_MM + 3.0f, rig_nowhere);
    smr_volume both = rig_ball_image(RIG_BALL_MM, rig_nowhere);
    float *voxels = rig_alloc(RIG_BALL_SIDE * RIG_BALL_SIDE * RIG_BALL_SIDE * sizeof *voxels);
    memcpy(voxels, both.voxels, RIG_BALL_SIDE * RIG_BALL_SIDE * RIG_BALL_SIDE * sizeof *voxels);
    memcpy(voxels, large.voxels, RIG_BALL_SIDE * RIG_BALL_SIDE * (RIG_BALL_SIDE / 2u) * sizeof *voxels);
    both.voxels = voxels;
    return both;
}

/* The mean distance from the middle, of vertices above or below a height. */
static double mean_radius(const smr *s, const smr_model *model, double side)
{
    const float *x = rig_positions(s, model);
    double sum = 0.0, n = 0.0;
    for (uint32_t v = 0; v < s->shared.n; v++)
        if (side * (double)x[3u * v + 2u] > 10.0) {
            sum += (double)smr_length(smr_load(x + 3u * (size_t)v));
            n += 1.0;
        }
    return sum / n;
}

/* A surface shows the upper third of what the image shows in whole: the image shows the rest. Without it the
 * rest stays as it was. */
static void test_rest_of_a_part(void **state)
{
    const smr_volume reference = rig_ball_image(RIG_BALL_MM, rig_nowhere), target = larger_below();
    const smr_model *model = rig_ball_model(&reference);
    smr_mesh cap = rig_ball(RIG_BALL_MM, 13, 20, rig_nowhere);
    uint32_t *t = rig_alloc(3u * (size_t)cap.n_triangles * sizeof *t), n = 0;
    double below[2];
    (void)state;
    for (uint32_t k = 0; k < cap.n_triangles; k++) {
        const uint32_t *corner = cap.triangles + 3u * (size_t)k;
        if (cap.xyz[3u * corner[0] + 2u] > 10.0f && cap.xyz[3u * corner[1] + 2u] > 10.0f &&
            cap.xyz[3u * corner[2] + 2u] > 10.0f)
            memcpy(t + 3u * (size_t)n++, corner, 3u * sizeof *t);
    }
    cap.triangles = t;
    cap.n_triangles = n;
    const smr_surface *surface = rig_surface(&cap);
    for (uint32_t alone = 0; alone < 2u; alone++) {
        const smr_config c = smr_config_default_image();
        smr *s = rig_init(model, &c, NULL);
        assert_int_equal(SMR_OK, smr_set_surface(s, 0, surface));
        assert_int_equal(SMR_OK, alone ? SMR_OK : smr_set_volume(s, &target));
        assert_int_equal(1, rig_run(s, 10000).done);
        below[alone] = mean_radius(s, model, -1.0) - (double)RIG_BALL_MM;
        const double above = mean_radius(s, model, 1.0) - (double)RIG_BALL_MM;
        if (!(fabs(above) < 0.3))
            print_error("alone %u: %g above, %g below\n", alone, above, below[alone]);
        assert_true(fabs(above) < 0.3);
    }
    if (!(below[0] > 2.3 && below[1] < 0.5))
        print_error("below: %g, without the image %g\n", below[0], below[1]);
    assert_true(below[0] > 2.3 && below[1] < 0.5);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_teardown(test_noise_fails, tidy),
        cmocka_unit_test_teardown(test_follows_image, tidy),
        cmocka_unit_test_teardown(test_turns, tidy),
        cmocka_unit_test_teardown(test_image_elsewhere, tidy),
        cmocka_unit_test_teardown(test_equal_bits, tidy),
        cmocka_unit_test_teardown(test_surface_first, tidy),
        cmocka_unit_test_teardown(test_structure_report, tidy),
        cmocka_unit_test_teardown(test_beside_a_surface, tidy),
        cmocka_unit_test_teardown(test_rest_of_a_part, tidy),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
