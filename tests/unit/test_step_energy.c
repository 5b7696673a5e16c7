/* test_step_energy.c: energy of a bone with mass, thrown, bent, pinned, hung up, or beside another: it falls in each
 * step, for any stiffness and step, and nothing is held for a gain that is none.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include <string.h>
#include "property/rig_motion.h"

static smr_mesh bone;
static rig_motion e;

static void set_up(void)
{
    const smr_prepare_config radii = rig_radii(3, 600, 150, 60);
    rig_bone(12000, 1.0f, &bone, NULL);
    e = rig_motion_make(&bone, &radii);
    e.config.track.radius_mm = 150.0f;
}

static const float *at(uint32_t i) { return bone.xyz + 3u * (size_t)i; }

static void energy_falls(uint32_t steps)
{
    const uint32_t n = rig_times(steps);
    double left[2];
    smr *s = rig_init(e.model, &e.config, NULL);
    rig_throw(&e, &bone, rig_energy(s).centre, 2.0f, 200.0f);
    assert_int_equal(SMR_OK, smr_set_motion(s, 0, e.mass, e.speed));
    if (rig_falls(s, n, 1e-6f, left) < n)
        fail_msg("radius %g, stiffness %g, step %g ms: %g of the energy after %g", (double)e.config.track.radius_mm,
                 (double)e.config.dynamics.elastic, (double)e.config.dynamics.step_ms, left[0], left[1]);
    assert_true(rig_finite(rig_positions(s, e.model), e.n));
}

/* Stiffness over six decades, steps from 1 to 100 ms: the energy falls in each step. */
static void falls(uint32_t k)
{
    e.config.dynamics.elastic = powf(10.0f, (float)(k / 3u * 2u + 1u));
    e.config.dynamics.step_ms = powf(10.0f, (float)(k % 3u));
    energy_falls(20);
}

TEST(test_energy_falls)
{
    set_up();
    for (uint32_t k = 0; k < 12u; k++)
        falls(k);
}

/* Also where clusters turn far against each other, and some against pins, by polar decomposition. */
TEST(test_energy_falls_in_small_clusters)
{
    set_up();
    e.config.track.radius_mm = 60.0f;
    e.config.basic.method = SMR_METHOD_POLAR;
    for (uint32_t pinned = 0; pinned < 2u; pinned++) {
        for (uint32_t i = 0; i < e.n; i++)
            e.mass[i] = pinned > 0u && at(i)[2] < 20.0f ? INFINITY : 1.0f;
        for (uint32_t k = 2u * pinned; k < 12u; k += 1u + 2u * pinned) /* with pins long steps only */
            falls(k);
    }
}

/* A bone hung up by its topmost vertex, in clusters smaller than it: however its parts swing, all energy together is
 * never more than at the start. The fits alone would come to many times as much by rigid-body kinematics. */
TEST(test_hung_up)
{
    set_up();
    uint32_t top = 0;
    for (uint32_t i = 0; i < e.n; i++)
        top = at(i)[2] > at(top)[2] ? i : top;
    e.mass[top] = INFINITY;
    e.config.track.radius_mm = 60.0f;
    e.config.dynamics.damping = 0.0f;
    e.config.dynamics.gravity[1] = 3000.0f;
    e.config.dynamics.gravity[2] = -9810.0f;
    for (uint32_t k = 0; k < 6u; k++) {
        e.config.basic.method = k % 2u;
        e.config.dynamics.elastic = k < 4u ? 1e4f : 1e6f;
        e.config.dynamics.step_ms = k < 2u ? 5.0f : 10.0f;
        smr *s = rig_init(e.model, &e.config, NULL);
        float least = 0.0f;
        assert_int_equal(SMR_OK, smr_set_motion(s, 0, e.mass, NULL));
        for (uint32_t i = 0; i < rig_times(30); i++) {
            rig_steps(s, 1);
            assert_int_equal(SMR_OK, smr_set_motion(s, 0, e.mass, NULL)); /* the same again: no new energy */
            const smr_energy now = rig_energy(s);
            least = fminf(least, now.gravity_uj);
            assert_true(now.kinetic_uj + now.elastic_uj + now.gravity_uj <= -1e-5f * least);
        }
        assert_true(rig_finite(rig_positions(s, e.model), e.n));
    }
}

/* Clamped at one end, or hung up by three vertices 20 mm apart, and thrown: kinetic and reported elastic energy never
 * grow, from step to step, also where the elastic energy wavers. */
TEST(test_energy_falls_about_pins)
{
    set_up();
    for (uint32_t k = 0; k < 12u; k++) {
        const float top = k % 2u ? 190.0f : 1e6f, bottom = k % 2u ? -1e6f : 45.0f;
        for (uint32_t i = 0; i < e.n; i++)
            e.mass[i] = at(i)[2] < bottom || at(i)[2] > top ? INFINITY : 1.0f;
        e.config.basic.method = k / 2u % 2u;
        e.config.track.radius_mm = k < 4u ? 600.0f : 60.0f;
        e.config.dynamics.elastic = k < 8u ? 1e4f : 10.0f;
        e.config.dynamics.step_ms = 100.0f;
        energy_falls(15);
        e.config.dynamics.step_ms = 10.0f;
        energy_falls(15);
    }
}

/* Heavier masses have more elastic energy at once: that is not taken from the velocities. */
TEST(test_masses_change_under_way)
{
    set_up();
    smr_energy now;
    for (uint32_t i = 0; i < e.n; i++) {
        e.mass[i] = at(i)[2] < 60.0f ? INFINITY : 1.0f;
        e.speed[3u * i] = e.mass[i] < 9.0f ? 500.0f : 0.0f;
    }
    e.config.dynamics.damping = 0.0f;
    e.config.dynamics.step_ms = 1.0f;
    e.config.basic.method = SMR_METHOD_POLAR;
    smr *s = rig_init(e.model, &e.config, NULL);
    assert_int_equal(SMR_OK, smr_set_motion(s, 0, e.mass, e.speed));
    do {
        rig_steps(s, 1);
        now = rig_energy(s);
        assert_true(now.steps < 100u);
    } while (now.kinetic_uj > 2.0f * now.elastic_uj);
    for (uint32_t i = 0; i < e.n; i++)
        e.mass[i] *= 10.0f;
    assert_int_equal(SMR_OK, smr_set_motion(s, 0, e.mass, NULL));
    rig_steps(s, 1);
    assert_true(rig_energy(s).kinetic_uj > 8.0f * now.kinetic_uj);
}

/* A bone that nothing pins, thrown so that it bends, stores as elastic energy most of what it loses of its motion. */
TEST(test_a_loose_one_stores_energy)
{
    set_up();
    e.config.dynamics.damping = 0.0f;
    e.config.dynamics.step_ms = 1.0f;
    e.config.basic.method = SMR_METHOD_POLAR;
    smr *s = rig_init(e.model, &e.config, NULL);
    rig_throw(&e, &bone, rig_energy(s).centre, 0.0f, 500.0f);
    assert_int_equal(SMR_OK, smr_set_motion(s, 0, e.mass, e.speed));
    const float first = rig_energy(s).kinetic_uj;
    rig_steps(s, 10);
    const smr_energy now = rig_energy(s);
    assert_true(now.elastic_uj > 0.7f * (first - now.kinetic_uj) && now.kinetic_uj < 0.95f * first);
}

/* Where a ball that hangs on its pole is after 60 steps, with another beside it that flies by, or rests. */
static float swung(float loose_mass, float loose_speed)
{
    static const float here[3] = {0, 0, 0}, there[3] = {400, 0, 0};
    const smr_mesh balls[2] = {rig_ball(50, 12, 16, here), rig_ball(50, 12, 16, there)};
    const uint32_t n = balls[0].n_vertices;
    const smr_prepare_config radii = rig_radii(1, 150, 0, 0);
    const smr_model *model = rig_model(balls, 2, &radii);
    smr_config config = smr_config_default();
    config.dynamics.mode = SMR_DYNAMICS_ON;
    config.track.radius_mm = 150.0f;
    config.dynamics.elastic = 1.0e5f;
    config.dynamics.damping = 1.0f;
    smr *s = rig_init(model, &config, NULL);
    float *mass = rig_alloc(4u * (size_t)n), *speed = rig_alloc(12u * (size_t)n);
    for (uint32_t i = 0; i < n; i++) {
        mass[i] = loose_mass;
        speed[3u * i] = loose_speed;
    }
    assert_int_equal(SMR_OK, smr_set_motion(s, 1, mass, speed));
    for (uint32_t i = 0; i < n; i++) {
        mass[i] = i == 0u ? INFINITY : 1.0f;
        speed[3u * i] = i == 0u ? 0.0f : 3.0f * (50.0f - balls[0].xyz[3u * i + 2u]);
    }
    assert_int_equal(SMR_OK, smr_set_motion(s, 0, mass, speed));
    rig_steps(s, 60);
    return rig_positions(s, model)[3u * (n - 1u)];
}

/* Two balls in clusters that hold both turn about a pin of the first as one: the second's energy is not held for a gain
 * of the first, and what both have falls with damping only. */
TEST(test_one_draws_the_other)
{
    static const float here[3] = {0, 0, 0}, there[3] = {0, 0, -110};
    const smr_mesh balls[2] = {rig_ball(50, 12, 16, here), rig_ball(50, 12, 16, there)};
    const smr_prepare_config radii = rig_radii(1, 400, 0, 0);
    const smr_model *model = rig_model(balls, 2, &radii);
    const uint32_t n = balls[0].n_vertices;
    float *mass = rig_alloc(4u * (size_t)n), *speed = rig_alloc(12u * (size_t)n), before;
    for (uint32_t method = 0; method < 2u; method++) {
        smr_config config = smr_config_default();
        config.dynamics.mode = SMR_DYNAMICS_ON;
        config.track.radius_mm = 400.0f;
        config.dynamics.elastic = 1e6f;
        config.dynamics.damping = 1.0f;
        config.basic.method = method;
        smr *s = rig_init(model, &config, NULL);
        for (uint32_t i = 0; i < n; i++) {
            mass[i] = i == 0u ? INFINITY : 1.0f;
            speed[3u * i] = 3.0f * (50.0f - balls[1].xyz[3u * i + 2u]);
        }
        assert_int_equal(SMR_OK, smr_set_motion(s, 0, mass, NULL));
        assert_int_equal(SMR_OK, smr_set_motion(s, 1, NULL, speed));
        rig_steps(s, 1);
        before = rig_energy(s).kinetic_uj;
        const float first = before;
        for (uint32_t k = 0; k < rig_times(40); k++) {
            rig_steps(s, 1);
            const smr_energy now = rig_energy(s);
            assert_true(now.kinetic_uj + now.elastic_uj < before);
            before = now.kinetic_uj + now.elastic_uj;
        }
        const double damped = (double)first * pow(1.01, -2.0 * rig_times(40));
        if (!((double)before > 0.8 * damped))
            fail_msg("%g uJ, then %g, by damping %g", (double)first, (double)before, damped);
    }
}

/* Two pairs of balls, each pair in clusters that hold both, 1 m apart: what one does is nothing to the other. */
TEST(test_strangers)
{
    static const float place[4][3] = {{0, 0, 0}, {0, 0, -110}, {0, 1000, 0}, {0, 1000, -110}};
    const smr_prepare_config radii = rig_radii(1, 60, 0, 0);
    smr_config config = smr_config_default();
    smr_mesh balls[4];
    for (uint32_t i = 0; i < 4u; i++)
        balls[i] = rig_ball(50, 12, 16, place[i]);
    const smr_model *model = rig_model(balls, 4, &radii);
    const uint32_t n = balls[0].n_vertices;
    float *mass = rig_alloc(4u * (size_t)n), *speed = rig_alloc(12u * (size_t)n);
    config.dynamics.mode = SMR_DYNAMICS_ON;
    config.track.radius_mm = 60.0f;
    config.dynamics.elastic = 1e5f;
    config.dynamics.damping = 0.0f;
    config.basic.method = SMR_METHOD_POLAR;
    smr *s = rig_init(model, &config, NULL);
    for (uint32_t k = 0; k < 4u; k++) {
        for (uint32_t i = 0; i < n; i++) {
            const float fast[3] = {3000, k == 0u ? 3000.0f : 0.0f, 0}, slow[3] = {0, 20, 0};
            mass[i] = k < 2u ? 50.0f : 1.0f;
            memcpy(speed + 3u * (size_t)i, k < 2u ? fast : slow, sizeof fast);
        }
        assert_int_equal(SMR_OK, smr_set_motion(s, k, mass, speed));
    }
    rig_steps(s, rig_times(60));
    assert_int_equal(SMR_OK, smr_get_velocities(s, 2, speed));
    double mean = 0.0;
    for (uint32_t i = 0; i < n; i++)
        mean += (double)speed[3u * i + 1u] / n;
    if (!(fabs(mean - 20.0) < 2.0))
        fail_msg("%g mm/s instead of 20", mean);
}

/* Two balls that spin as one, in small clusters: what is too much is not taken from their angular momentum. */
TEST(test_keeps_spinning)
{
    static const float place[2][3] = {{0, 0, 0}, {0, 0, -110}};
    const smr_mesh balls[2] = {rig_ball(50, 12, 16, place[0]), rig_ball(50, 12, 16, place[1])};
    const smr_prepare_config radii = rig_radii(1, 60, 0, 0);
    const smr_model *model = rig_model(balls, 2, &radii);
    const uint32_t n = balls[0].n_vertices, many = rig_times(300);
    smr_config config = smr_config_default();
    float *const speed = rig_alloc(12u * (size_t)n), *const at_end = rig_alloc(12u * (size_t)n);
    double spin[2] = {0.0, 0.0};
    config.dynamics.mode = SMR_DYNAMICS_ON;
    config.track.radius_mm = 60.0f;
    config.dynamics.elastic = 1e6f;
    config.dynamics.damping = 0.0f;
    config.dynamics.step_ms = 1.0f;
    config.basic.method = SMR_METHOD_POLAR;
    smr *s = rig_init(model, &config, NULL);
    for (uint32_t k = 0; k < 2u; k++) {
        for (uint32_t i = 0; i < n; i++) {
            const float *const x = balls[k].xyz + 3u * (size_t)i;
            const float z = x[2] + 55.0f, turned[3] = {10.0f * z, 0, -10.0f * x[0]};
            memcpy(speed + 3u * (size_t)i, turned, sizeof turned);
            spin[0] += (double)(z * turned[0] - x[0] * turned[2]);
        }
        assert_int_equal(SMR_OK, smr_set_motion(s, k, NULL, speed));
    }
    rig_steps(s, many);
    for (uint32_t k = 0; k < 2u; k++) {
        assert_int_equal(SMR_OK, smr_get_positions(s, k, at_end));
        assert_int_equal(SMR_OK, smr_get_velocities(s, k, speed));
        for (uint32_t i = 0; i < 3u * n; i += 3u)
            spin[1] += (double)((at_end[i + 2u] + 55.0f) * speed[i] - at_end[i] * speed[i + 2u]);
    }
    if (!(spin[1] > 0.98 * spin[0]))
        fail_msg("%g of the spin is left", spin[1] / spin[0]);
}

/* What is pinned shares no sum of energies with what flies fast: rounding there would slow it down here. */
TEST(test_a_loose_one_flies_by)
{
    const float alone = swung(1.0f, 0.0f), beside = swung(50.0f, 3000.0f);
    if (!(alone > 80.0f && fabsf(alone - beside) < 0.1f))
        fail_msg("the tip went %g mm, beside a loose one %g", (double)alone, (double)beside);
}

/* Of two equal balls that hang on their poles far apart, the second swings as the first does: energy is counted of the
 * one as of the other. */
TEST(test_twins)
{
    static const float place[2][3] = {{0, 0, 0}, {400, 0, 0}};
    const smr_mesh balls[2] = {rig_ball(50, 12, 16, place[0]), rig_ball(50, 12, 16, place[1])};
    const smr_prepare_config radii = rig_radii(1, 60, 0, 0);
    const smr_model *model = rig_model(balls, 2, &radii);
    rig_motion m = rig_motion_make(&balls[0], &radii);
    m.config.dynamics.elastic = 1e4f;
    m.config.dynamics.damping = 0.0f;
    m.mass[0] = INFINITY;
    for (uint32_t i = 1; i < m.n; i++)
        m.speed[3u * i] = 30.0f * (50.0f - balls[0].xyz[3u * i + 2u]);
    smr *s = rig_init(model, &m.config, NULL);
    for (uint32_t k = 0; k < 2u; k++)
        assert_int_equal(SMR_OK, smr_set_motion(s, k, m.mass, m.speed));
    rig_steps(s, 12);
    const float *const x = rig_positions(s, model);
    float apart = 0.0f;
    for (uint32_t i = 0; i < 3u * m.n; i++)
        apart = fmaxf(apart, fabsf(x[3u * m.n + i] - x[i] - (i % 3u == 0u ? 400.0f : 0.0f)));
    assert_true(apart < 0.05f && rig_far(x, balls[0].xyz, m.n) > 50.0f && rig_energy(s).kinetic_uj > 1e4f);
}
