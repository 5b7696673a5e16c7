/* test_image_goal.c: a ball follows its computed image; what an image must not change; volumes that are refused.
 * SPDX-License-Identifier: MIT */
#include "cmocka_first.h"

#include <math.h>
#include <string.h>

#include "property/rig.h"
#include "runtime/registration.h"

#define SIDE 76u     /* voxels */
#define SPACING 1.5f /* mm */
#define RADIUS 30.0f /* mm */

static const float none[3] = {0, 0, 0};
static const float shift[3] = {2, -1, 2}; /* 3 mm */

static int tidy(void **state)
{
    (void)state;
    rig_free_all();
    return 0;
}

/* The image of a ball: bright inside, dark outside, with an edge some millimetres wide. */
static smr_volume image(float radius, const float centre[3])
{
    float *voxels;
    const smr_volume v = rig_cube(SIDE, SPACING, &voxels);
    for (uint32_t i = 0; i < SIDE * SIDE * SIDE; i++) {
        const uint32_t at[3] = {i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE};
        double d2 = 0.0;
        for (uint32_t a = 0; a < 3u; a++) {
            const double d = (double)(v.origin[a] + SPACING * (float)at[a] - centre[a]);
            d2 += d * d;
        }
        voxels[i] = (float)(500.0 + 400.0 * tanh(((double)radius - sqrt(d2)) / 2.0));
    }
    return v;
}

/* A model of the ball that was prepared with its own image, or without any. */
static const smr_model *ball_model(const smr_volume *reference)
{
    const smr_mesh mesh = rig_ball(RADIUS, 13, 20, none);
    smr_prepare_config c = rig_radii(2, 20, 10, 0);
    c.reference = reference;
    return rig_model(&mesh, 1, &c);
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
    const smr_volume reference = image(RADIUS, none);
    const smr_volume noise = rig_cube(SIDE, SPACING, &voxels);
    const smr_model *model = ball_model(&reference);
    const smr_config config = smr_config_default_image();
    smr *s = rig_init(model, &config, NULL);
    smr_verdict v;
    (void)state;
    for (uint32_t i = 0; i < SIDE * SIDE * SIDE; i++)
        voxels[i] = rig_between(&seed, 100.0f, 900.0f);
    assert_int_equal(SMR_OK, smr_set_volume(s, &noise));
    const smr_tick_report last = rig_run(s, 200);
    assert_int_equal(SMR_OK, smr_get_verdict(s, 0, &v));
    assert_int_equal(SMR_VERDICT_FAILED, v.level);
    assert_true((v.reasons & SMR_REASON_LIKENESS) != 0u && v.likeness < 0.5f);
    assert_true(last.done == 1u && last.matched_share > 0.3f);
}

static void test_follows_image(void **state)
{
    const smr_volume reference = image(RADIUS, none), target = image(RADIUS + 2.0f, shift);
    const smr_model *model = ball_model(&reference);
    (void)state;
    for (uint32_t similarity = 0; similarity <= SMR_SIMILARITY_CONCORDANCE; similarity++) {
        smr_config c = smr_config_default();
        c.similarity = similarity;
        smr *s = rig_init(model, &c, NULL);
        assert_int_equal(SMR_OK, smr_set_volume(s, &target));
        assert_true(off_ball(s, model, (double)RADIUS + 2.0, shift) > 1.5);
        smr_tick_report r = rig_run(s, 1);
        assert_true(r.n_active > 0u && r.n_active <= s->shared.n); /* at large radii not every vertex takes part */
        assert_true(r.n_forces > r.n_active / 2u);
        r = rig_run(s, 10000);
        assert_int_equal(1, r.done);
        const double off = off_ball(s, model, (double)RADIUS + 2.0, shift);
        if (!(off < 0.3))
            print_error("similarity %u: %f mm off in the mean\n", similarity, off);
        assert_true(off < 0.3);
        assert_true(rig_finite(rig_positions(s, model), s->shared.n));
    }
}

/* The image of a ball with waves inside and outside, turned about z: only the waves tell by how much. */
static smr_volume turned_image(double angle)
{
    smr_volume v = image(RADIUS, none);
    float *voxels = rig_alloc(SIDE * SIDE * SIDE * sizeof *voxels);
    memcpy(voxels, v.voxels, SIDE * SIDE * SIDE * sizeof *voxels);
    for (uint32_t i = 0; i < SIDE * SIDE * SIDE; i++) {
        const double x = (double)(v.origin[0] + SPACING * (float)(i % SIDE));
        const double y = (double)(v.origin[1] + SPACING * (float)(i / SIDE % SIDE));
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
    const smr_model *model = ball_model(&reference);
    (void)state;
    for (uint32_t k = 0; k < 4u; k++) {
        double off[3] = {0.0, 0.0, 0.0}, start = 0.0;
        for (uint32_t i = 0; i < 3u; i++) {
            smr_config c = smr_config_default_image();
            smr_volume target = turned_image(i < 2u ? angle : 0.0);
            float *voxels = rig_alloc(SIDE * SIDE * SIDE * sizeof *voxels);
            for (uint32_t v = 0; v < SIDE * SIDE * SIDE; v++)
                voxels[v] = gain[k] * ((const float *)target.voxels)[v] + brighter[k];
            target.voxels = voxels;
            c.sideways = i == 0u ? 0.0f : 0.5f;
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

/* Whatever a volume may hold, the model that is prepared with it can be opened. */
static void test_extreme_reference(void **state)
{
    (void)state;
    for (uint32_t k = 0; k < 2u; k++) {
        const smr_volume source = image(RADIUS, none);
        float *voxels = rig_alloc(SIDE * SIDE * SIDE * sizeof *voxels);
        smr_volume reference = source;
        for (uint32_t i = 0; i < SIDE * SIDE * SIDE; i++) /* -0.99 .. 0.99 of the limit, and next to nothing */
            voxels[i] = (((const float *)source.voxels)[i] - 500.0f) / 400.0f * (k == 0u ? 0.99e30f : 1.0e-37f);
        reference.voxels = voxels;
        const smr_model *model = ball_model(&reference); /* ends the program when it cannot be opened */
        const smr_config c = smr_config_default();
        smr *s = rig_init(model, &c, NULL);
        assert_int_equal(SMR_OK, smr_set_volume(s, &reference));
        (void)rig_run(s, 10000);
        assert_true(rig_finite(rig_positions(s, model), s->shared.n));
    }
}

static void test_needs_profiles(void **state)
{
    const smr_volume target = image(RADIUS, none);
    const smr_model *model = ball_model(NULL);
    const smr_config c = smr_config_default();
    smr *s = rig_init(model, &c, NULL);
    const uint64_t hash = smr_state_hash(s);
    (void)state;
    assert_int_equal(SMR_E_STATE, smr_set_volume(s, &target));
    assert_int_equal(SMR_OK, smr_set_volume(s, NULL));
    assert_int_equal(SMR_E_NULL, smr_set_volume(NULL, &target));
    assert_int_equal(SMR_E_NULL, smr_set_volume(NULL, NULL));
    assert_true(hash == smr_state_hash(s));
    assert_int_equal(0, s->forces.image.has_image);
    assert_int_equal(0, rig_run(s, 1).n_active);
    s->magic = 0;
    assert_int_equal(SMR_E_STATE, smr_set_volume(s, &target));
    assert_int_equal(SMR_E_STATE, smr_set_volume(s, NULL));
}

static void refuse_all(smr *s, const smr_volume *good)
{
    static const float bad[] = {0.0f, -1.0f, (float)NAN, (float)INFINITY};
    smr_volume v = *good;
    v.voxels = NULL;
    assert_int_equal(SMR_E_NULL, smr_set_volume(s, &v));
    v = *good;
    v.voxels = (const char *)good->voxels + 2;
    assert_int_equal(SMR_E_INPUT, smr_set_volume(s, &v));
    v = *good;
    v.type = SMR_VOXEL_FLOAT + 1u;
    assert_int_equal(SMR_E_INPUT, smr_set_volume(s, &v));
    v = *good;
    memset(v.direction, 0, sizeof v.direction);
    assert_int_equal(SMR_E_INPUT, smr_set_volume(s, &v));
    for (uint32_t a = 0; a < 3u; a++) {
        v = *good;
        v.size[a] = 0;
        assert_int_equal(SMR_E_INPUT, smr_set_volume(s, &v));
        v.size[a] = 65537;
        assert_int_equal(SMR_E_INPUT, smr_set_volume(s, &v));
        v = *good;
        v.origin[a] = (float)NAN;
        assert_int_equal(SMR_E_INPUT, smr_set_volume(s, &v));
        for (uint32_t k = 0; k < 4u; k++) {
            v = *good;
            v.spacing[a] = bad[k];
            assert_int_equal(SMR_E_INPUT, smr_set_volume(s, &v));
        }
    }
}

/* A refused volume leaves positions, schedule and the image in use as they were. */
static void test_refused(void **state)
{
    const smr_volume reference = image(RADIUS, none), target = image(RADIUS + 2.0f, shift);
    const smr_model *model = ball_model(&reference);
    const smr_config c = smr_config_default();
    uint64_t end[2];
    (void)state;
    for (uint32_t refused = 0; refused < 2u; refused++) {
        smr *s = rig_init(model, &c, NULL);
        if (refused) {
            refuse_all(s, &target);
            assert_int_equal(0, s->forces.image.has_image);
        }
        assert_int_equal(SMR_OK, smr_set_volume(s, &target));
        const smr_tick_report before = rig_run(s, 5);
        if (refused) {
            const uint64_t hash = smr_state_hash(s);
            refuse_all(s, &target);
            assert_true(hash == smr_state_hash(s));
            assert_int_equal(1, s->forces.image.has_image);
        }
        const smr_tick_report after = rig_run(s, 5);
        assert_int_equal(before.iteration + 5u, after.iteration);
        end[refused] = smr_state_hash(s);
    }
    assert_true(end[0] == end[1]);
}

/* Another volume in the midst of an iteration: how far that had come does not matter. */
static void test_abandoned(void **state)
{
    const smr_volume reference = image(RADIUS, none), first = image(RADIUS + 2.0f, shift),
                     second = image(RADIUS - 1.0f, shift);
    const smr_model *model = ball_model(&reference);
    uint32_t n_partial = 0;
    (void)state;
    for (uint32_t method = 0; method < 2u; method++) {
        uint64_t undisturbed = 0;
        smr_status status = SMR_PARTIAL;
        for (uint32_t cut = 0; cut < 2000u && status == SMR_PARTIAL; cut++) {
            rig_clock clock;
            smr_config c = smr_config_default();
            smr_tick_report report;
            c.method = method;
            c.iterations = c.iterations_last = 3;
            const smr_port port = rig_clock_port(&clock, RIG_CLOCK_STEADY, 1000);
            smr *s = rig_init(model, &c, &port);
            assert_int_equal(SMR_OK, smr_set_volume(s, &first));
            assert_int_equal(SMR_OK, smr_tick(s, 0, &report));
            if (cut > 0u)
                status = smr_tick(s, 1000u * (uint64_t)cut, &report);
            assert_int_equal(SMR_OK, smr_set_volume(s, &second));
            (void)rig_run(s, 100);
            if (cut == 0u)
                undisturbed = smr_state_hash(s);
            assert_true(status != SMR_PARTIAL || smr_state_hash(s) == undisturbed);
            n_partial += cut > 0u && status == SMR_PARTIAL;
        }
        assert_int_equal(SMR_OK, status); /* every place to stop at was tried */
    }
    assert_true(n_partial > 20u);
}

static void test_image_elsewhere(void **state)
{
    const smr_volume reference = image(RADIUS, none);
    smr_volume target = image(RADIUS, none);
    const smr_model *model = ball_model(&reference);
    const smr_config c = smr_config_default();
    smr *s = rig_init(model, &c, NULL);
    (void)state;
    target.origin[0] += 5000.0f;
    const float *before = rig_positions(s, model);
    assert_int_equal(SMR_OK, smr_set_volume(s, &target));
    const smr_tick_report r = rig_run(s, 12);
    assert_int_equal(0, r.n_forces);
    assert_true(r.n_active > 0u);
    assert_int_equal(r.n_active, r.n_rejected);
    const smr_tick_report end = rig_run(s, 10000);
    assert_int_equal(1, end.done);
    assert_true(rig_far(before, rig_positions(s, model), s->shared.n) < 1.0e-3f);
}

static void test_equal_bits(void **state)
{
    const smr_volume reference = image(RADIUS, none), target = image(RADIUS + 2.0f, shift);
    const smr_model *model = ball_model(&reference);
    uint64_t hash = 0;
    (void)state;
    for (uint32_t k = 0; k <= RIG_SCHEDULERS; k++) {
        smr_config c = smr_config_default();
        c.n_workers = k == 0u ? 1u : 4u;
        const smr_port port = rig_port(k == 0u ? RIG_PLAIN : k - 1u, c.n_workers);
        smr *s = rig_init(model, &c, &port);
        assert_int_equal(SMR_OK, smr_set_volume(s, &target));
        const smr_tick_report r = rig_run(s, 12);
        assert_true(r.n_forces > 0u);
        hash = k == 0u ? smr_state_hash(s) : hash;
        assert_true(hash == smr_state_hash(s));
    }
}

/* Taking away an image that is not there changes nothing, not even the schedule; one that is there is taken away. */
static void test_take_away(void **state)
{
    const smr_volume reference = image(RADIUS, none), target = image(RADIUS + 2.0f, shift);
    const smr_mesh goal = rig_ball(RADIUS + 2.0f, 15, 22, shift);
    const smr_surface *surface = rig_surface(&goal);
    const smr_model *model = ball_model(&reference);
    const smr_config c = smr_config_default();
    uint64_t end[2];
    (void)state;
    for (uint32_t asked = 0; asked < 2u; asked++) {
        smr *s = rig_init(model, &c, NULL);
        assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, surface));
        const uint32_t before = rig_run(s, 3).iteration;
        if (asked) {
            const uint64_t hash = smr_state_hash(s);
            assert_int_equal(SMR_OK, smr_set_volume(s, NULL));
            assert_true(hash == smr_state_hash(s));
        }
        const smr_tick_report r = rig_run(s, 3);
        assert_int_equal(before + 3u, r.iteration);
        end[asked] = smr_state_hash(s);
    }
    assert_true(end[0] == end[1]);
    smr *s = rig_init(model, &c, NULL);
    assert_int_equal(SMR_OK, smr_set_volume(s, &target));
    assert_true(rig_run(s, 2).n_forces > 0u);
    assert_int_equal(SMR_OK, smr_set_volume(s, NULL));
    const smr_tick_report r = rig_run(s, 1);
    assert_int_equal(0, r.n_active);
    assert_int_equal(0, r.n_forces);
}

/* A structure with a surface follows the surface, not the image. */
static void test_surface_first(void **state)
{
    const smr_volume reference = image(RADIUS, none), target = image(RADIUS + 4.0f, shift);
    const smr_mesh goal = rig_ball(RADIUS - 2.0f, 15, 22, none);
    const smr_surface *surface = rig_surface(&goal);
    const smr_model *model = ball_model(&reference);
    const smr_config c = smr_config_default();
    (void)state;
    smr *s = rig_init(model, &c, NULL);
    assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, surface));
    assert_int_equal(SMR_OK, smr_set_volume(s, &target));
    assert_int_equal(1, rig_run(s, 10000).done);
    assert_true(off_ball(s, model, (double)RADIUS - 2.0, none) < 0.5);
}

/* Forces fade to 0 where the schedule ends, and vertices without a goal are smoothed: a structure's residuals are the
 * distances to goals all the same. */
static void test_structure_report(void **state)
{
    const smr_volume reference = image(RADIUS, none);
    smr_volume target = image(RADIUS + 2.0f, shift);
    const smr_model *model = ball_model(&reference);
    const smr_config c = smr_config_default_image();
    smr_structure_report part;
    smr_tick_report r = {0};
    (void)state;
    uint32_t rejected = 0;
    float *voxels = rig_alloc(SIDE * SIDE * SIDE * sizeof *voxels);
    memcpy(voxels, target.voxels, SIDE * SIDE * SIDE * sizeof *voxels);
    for (uint32_t i = SIDE * SIDE * (SIDE / 2u + 5u); i < SIDE * SIDE * SIDE; i++)
        voxels[i] = (float)(i % SIDE); /* no goal where this is */
    target.voxels = voxels;
    smr *s = rig_init(model, &c, NULL);
    assert_int_equal(SMR_OK, smr_set_volume(s, &target));
    while (r.done == 0u) {
        r = rig_run(s, 1);
        rejected += r.n_rejected;
        assert_int_equal(SMR_OK, smr_get_structure_report(s, 0, &part));
        assert_true(part.n_forces == r.n_forces && part.n_rejected == r.n_rejected);
        assert_true(fabsf(part.residual_mean_mm - r.residual_mean_mm) < 1.0e-4f);
        assert_true(fabsf(part.residual_max_mm - r.residual_max_mm) < 1.0e-4f);
    }
    assert_true(rejected > 0u && r.n_forces > 0u && part.residual_mean_mm > 0.0f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_teardown(test_noise_fails, tidy),     cmocka_unit_test_teardown(test_follows_image, tidy),
        cmocka_unit_test_teardown(test_turns, tidy),           cmocka_unit_test_teardown(test_extreme_reference, tidy),
        cmocka_unit_test_teardown(test_needs_profiles, tidy),  cmocka_unit_test_teardown(test_refused, tidy),
        cmocka_unit_test_teardown(test_image_elsewhere, tidy), cmocka_unit_test_teardown(test_equal_bits, tidy),
        cmocka_unit_test_teardown(test_take_away, tidy),       cmocka_unit_test_teardown(test_surface_first, tidy),
        cmocka_unit_test_teardown(test_abandoned, tidy),       cmocka_unit_test_teardown(test_structure_report, tidy),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
