/* test_paper_config.c: settings with which the paper does otherwise, on and off, and the paper's configurations.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include <string.h>
#include "geometry/rotation/rotation.h"
#include "image/intensity_profile.h"
#include "registration/registration.h"

#define SIDE 76u     /* voxels */
#define SPACING 1.5f /* mm */
#define RADIUS 30.0f /* mm */

static const float none[3] = {0, 0, 0};

/* Brightness by the distance from the surface of a ball, outwards positive, mm. */
typedef double (*shells)(double out);

static smr_volume image(shells brightness)
{
    float *voxels;
    const smr_volume v = rig_cube(SIDE, SPACING, &voxels);
    for (uint32_t i = 0; i < SIDE * SIDE * SIDE; i++) {
        const uint32_t at[3] = {i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE};
        double d2 = 0.0;
        for (uint32_t a = 0; a < 3u; a++) {
            const double d = (double)(v.origin[a] + SPACING * (float)at[a]);
            d2 += d * d;
        }
        voxels[i] = (float)brightness(sqrt(d2) - (double)RADIUS);
    }
    return v;
}

/* Bright inside, dark outside. */
static double edge(double out) { return 500.0 - 200.0 * tanh(out / 2.0); }

/* The same, and 4 mm outwards a steeper edge of the other polarity. */
static double two_edges(double out) { return edge(out) + 500.0 * tanh((out - 4.0) / 1.0); }

/* No edge at all. */
static double level(double out) { return (void)out, 300.0; }

static const smr_model *ball_model(const smr_volume *reference, uint32_t samples)
{
    const smr_mesh mesh = rig_ball(RADIUS, 13, 20, none);
    smr_prepare_config c = rig_radii(1, 20, 0, 0);
    c.profile_inward = 0.5f;
    c.profile_samples = samples;
    c.reference = reference;
    return rig_model(&mesh, 1, &c);
}

/* Goals as the paper has them, but for what is under test. */
static smr_config goals(float profile_mm, float gradient_mm)
{
    smr_config c = smr_config_paper();
    c.image.profile_mm = c.image.profile_end_mm = profile_mm;
    c.image.gradient_mm = c.image.gradient_end_mm = gradient_mm;
    c.schedule.active_first = c.forces.stiffness = 1.0f;
    return c;
}

/* Ways to the goals of the first iteration, mm outwards, into way[n]; how many there are. */
static uint32_t ways(const smr_model *model, const smr_config *config, const smr_volume *target, float *way)
{
    smr_tick_report report;
    smr *s = rig_init(model, config, NULL);
    assert_int_equal(SMR_OK, smr_set_volume(s, target));
    float normal[3u * 512u];
    assert_true(s->shared.n <= 512u);
    memcpy(normal, s->shape.normal, 3u * (size_t)s->shared.n * sizeof *normal);
    assert_int_equal(SMR_OK, smr_tick(s, 0, &report));
    for (uint32_t v = 0; v < s->shared.n; v++)
        way[v] = smr_dot(smr_load(normal + 3u * (size_t)v), smr_load(smr_at3(s->forces.force, v)));
    return report.n_forces;
}

static float mean_of(const float *value, uint32_t n)
{
    float sum = 0.0f;
    for (uint32_t i = 0; i < n; i++)
        sum += value[i];
    return sum / (float)n;
}

/* The reference's own edge, or the steepest, which is another one. */
TEST(test_edge)
{
    const smr_volume reference = image(edge), target = image(two_edges);
    const smr_model *model = ball_model(&reference, 20);
    smr_config c = goals(0.0f, 8.0f);
    float way[512];
    const uint32_t n = ways(model, &c, &target, way);
    assert_true(n > 200u);
    assert_true(fabsf(mean_of(way, n) - 4.0f) < 0.3f);
    c.image.edge = SMR_EDGE_REFERENCE;
    assert_int_equal(n, ways(model, &c, &target, way));
    assert_true(fabsf(mean_of(way, n)) < 1.5f);
    const smr_volume flat = image(level);
    assert_int_equal(0, ways(model, &c, &flat, way));
    c = goals(30.0f, 0.0f); /* a long search with few samples */
    assert_true(ways(ball_model(&reference, 4), &c, &reference, way) > 200u && fabsf(mean_of(way, n)) < 1.5f);
}

/* Plainly averaged, a goal is the middle of both; by confidence it is not, and a doubtful profile is none. */
TEST(test_blend)
{
    const smr_volume reference = image(edge), target = image(two_edges);
    const smr_model *model = ball_model(&reference, 20);
    smr_config both = goals(6.0f, 8.0f);
    const smr_config profile = goals(6.0f, 0.0f), gradient = goals(0.0f, 8.0f);
    float of_both[512], of_profile[512], of_gradient[512], apart = 0.0f;
    const uint32_t n = ways(model, &both, &target, of_both);
    assert_int_equal(n, ways(model, &profile, &target, of_profile));
    assert_int_equal(n, ways(model, &gradient, &target, of_gradient));
    assert_true(fabsf(mean_of(of_profile, n) - mean_of(of_gradient, n)) > 1.0f);
    for (uint32_t v = 0; v < n; v++)
        assert_true(fabsf(of_both[v] - 0.5f * (of_profile[v] + of_gradient[v])) < 1.0e-4f);
    both.image.blend = SMR_BLEND_CONFIDENCE;
    assert_int_equal(n, ways(model, &both, &target, of_both));
    for (uint32_t v = 0; v < n; v++)
        apart = fmaxf(apart, fabsf(of_both[v] - 0.5f * (of_profile[v] + of_gradient[v])));
    assert_true(apart > 0.05f);
    /* a profile that fits nowhere well counts in full all the same */
    float *voxels;
    uint32_t seed = 5;
    const smr_volume noise = rig_cube(SIDE, SPACING, &voxels);
    for (uint32_t i = 0; i < SIDE * SIDE * SIDE; i++)
        voxels[i] = rig_between(&seed, 0, 900);
    smr_config doubtful = goals(2.0f, 0.0f);
    doubtful.image.confidence = 0.3f;
    const uint32_t plain = ways(model, &doubtful, &noise, of_both);
    doubtful.image.blend = SMR_BLEND_CONFIDENCE;
    const uint32_t sure = ways(model, &doubtful, &noise, of_both);
    assert_true(plain > n * 3u / 4u && sure < plain * 3u / 4u);
}

/* The place of the steepest samples, whatever the sign; none where nothing changes or nothing is inside. */
TEST(test_steepest)
{
    float line[64];
    unsigned char inside[64];
    memset(inside, 1, sizeof inside);
    for (uint32_t place = 20; place < 44u; place++) {
        for (uint32_t k = 0; k < 64u; k++)
            line[k] = (place % 2u ? 3.0f : -3.0f) * tanhf(0.7f * ((float)k - (float)place - 0.25f)) +
                      tanhf(0.7f * ((float)k - 32.0f));
        const smr_peak peak = smr_steepest(line, inside, 64, 32, 8);
        if (place > 24u && place < 40u)
            assert_true(peak.confidence == 1.0f && fabsf(peak.at - (float)place - 0.25f) < 0.6f);
        inside[place] = 0; /* an edge outside the image is none */
        assert_true(fabsf(smr_steepest(line, inside, 64, 32, 8).at - (float)place) > 2.0f);
        inside[place] = 1;
    }
    for (uint32_t k = 0; k < 64u; k++)
        line[k] = 7.0f;
    assert_true(smr_steepest(line, inside, 64, 32, 8).confidence == 0.0f);
    line[32] = INFINITY;
    assert_true(isfinite(smr_steepest(line, inside, 64, 32, 8).at));
    for (uint32_t m = 0; m < 6u; m++) /* a line that is too short */
        assert_true(smr_steepest(line, inside, m, 2, 8).at <= (float)m);
}

/* Both configurations are legal and do what they say on the paper's kind of data. */
TEST(test_registers)
{
    const float off[3] = {2, -1, 2};
    smr_prepare_config prepare = smr_prepare_config_paper();
    smr_config c = smr_config_paper();
    const smr_volume reference = image(edge);
    const smr_mesh mesh = rig_ball(RADIUS, 13, 20, none);
    float start[3u * 512u], *x;
    assert_true(prepare.n_radii == 1u && prepare.radius_mm[0] == 30.0f && prepare.profile_samples == 30u);
    prepare.reference = &reference;
    const smr_model *model = rig_model(&mesh, 1, &prepare);
    smr *s = rig_init(model, &c, NULL);
    assert_true(mesh.n_vertices <= 512u);
    for (uint32_t i = 0; i < 3u * mesh.n_vertices; i++)
        start[i] = 1.02f * mesh.xyz[i] + off[i % 3u];
    assert_int_equal(SMR_OK, smr_set_positions(s, 0, start));
    assert_int_equal(SMR_OK, smr_set_volume(s, &reference));
    const smr_tick_report report = rig_run(s, 1000);
    assert_true(report.done && report.iteration == 120u && report.details.plastic_updates > 0u);
    x = rig_positions(s, model);
    double worst = 0.0;
    for (uint32_t v = 0; v < mesh.n_vertices; v++)
        worst = fmax(worst, fabs((double)smr_length(smr_load(x + 3u * v)) - (double)RADIUS));
    assert_true(worst < 0.5);
}
