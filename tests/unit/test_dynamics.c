/* test_dynamics.c: a bone with mass, in time: it rests, falls, keeps its momentum and follows springs. How it swings
 * about pins: test_pendulum.c; its energy: test_step_energy.c.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include <string.h>
#include "property/rig_ball_image.h"
#include "property/rig_motion.h"
#include "options/dynamics/dynamics.h"
#include "registration/registration.h"

static smr_mesh bone;
static rig_motion e;

BEFORE_EACH_TEST()
{
    const smr_prepare_config radii = rig_radii(3, 600, 150, 60);
    rig_bone(12000, 1.0f, &bone, NULL);
    e = rig_motion_make(&bone, &radii);
    e.config.track.radius_mm = 150.0f;
}

static const float *at(uint32_t i) { return bone.xyz + 3u * (size_t)i; }

TEST(test_off_costs_nothing)
{
    size_t off, on, saved_off, saved_on;
    smr_config config = e.config;
    config.dynamics.mode = SMR_DYNAMICS_OFF;
    smr *s = rig_init(e.model, &config, NULL);
    smr_energy energy;
    assert_int_equal(SMR_OK, smr_arena_bytes(e.model, &config, &off));
    assert_int_equal(SMR_OK, smr_save_bytes(s, &saved_off));
    assert_null(s->shape.dynamics);
    assert_int_equal(SMR_E_ARENA, smr_set_motion(s, 0, e.mass, NULL));
    assert_int_equal(SMR_E_ARENA, smr_get_velocities(s, 0, e.speed));
    assert_int_equal(SMR_E_ARENA, smr_get_energy(s, &energy));
    assert_int_equal(SMR_OK, smr_arena_bytes(e.model, &e.config, &on));
    assert_int_equal(SMR_OK, smr_save_bytes(rig_init(e.model, &e.config, NULL), &saved_on));
    assert_true(on > off + 44u * e.n && on <= off + SMR_ARENA_DYNAMICS_BYTES(e.n, 1));
    assert_true(saved_on > saved_off + 40u * e.n && saved_on <= saved_off + SMR_SAVE_DYNAMICS_BYTES(e.n, 1));
}

TEST(test_refused)
{
    smr *s = rig_init(e.model, &e.config, NULL);
    smr_config config = e.config;
    smr_energy energy;
    size_t bytes;
    const float wrong[] = {0.0f, -1.0f, 0.9e-6f, 1.1e6f, NAN, -INFINITY};
    const float right[] = {1.0e-6f, 1.0e6f, INFINITY, 1.0f}; /* g: least and most, pinned */
    const uint64_t hash = smr_state_hash(s);
    assert_int_equal(SMR_E_NULL, smr_set_motion(NULL, 0, e.mass, NULL));
    assert_int_equal(SMR_E_NULL, smr_set_motion(s, 0, NULL, NULL));
    assert_int_equal(SMR_E_NULL, smr_get_velocities(s, 0, NULL));
    assert_int_equal(SMR_E_NULL, smr_get_energy(s, NULL));
    assert_int_equal(SMR_E_NULL, smr_get_energy(NULL, &energy));
    assert_int_equal(SMR_E_INPUT, smr_set_motion(s, 1, e.mass, NULL));
    assert_int_equal(SMR_E_INPUT, smr_get_velocities(s, SMR_ALL, e.speed));
    for (uint32_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        e.mass[e.n - 1u] = wrong[i];
        assert_int_equal(SMR_E_INPUT, smr_set_motion(s, 0, e.mass, NULL));
    }
    for (uint32_t i = 0; i < sizeof right / sizeof right[0]; i++) {
        e.mass[e.n - 1u] = right[i];
        assert_int_equal(SMR_OK, smr_set_motion(s, 0, e.mass, NULL));
    }
    e.speed[4] = INFINITY;
    assert_int_equal(SMR_E_INPUT, smr_set_motion(s, 0, NULL, e.speed));
    e.speed[4] = 0.0f;
    assert_true(hash == smr_state_hash(s) && rig_energy(s).kinetic_uj == 0.0f);
    config.track.mode = SMR_TRACK_REPORT;
    assert_int_equal(SMR_E_CONFIG, smr_arena_bytes(e.model, &config, &bytes));
    config = e.config;
    config.dynamics.gravity[2] = NAN;
    assert_int_equal(SMR_E_CONFIG, smr_arena_bytes(e.model, &config, &bytes));
    config = e.config;
    config.contact.volume = 0.5f;
    assert_int_equal(SMR_E_CONFIG, smr_arena_bytes(e.model, &config, &bytes));
    config = e.config;
    config.dynamics.gravity[2] = 1.1e6f;
    assert_int_equal(SMR_E_CONFIG, smr_arena_bytes(e.model, &config, &bytes));
}

/* Without forces nothing moves but by rounding; in a fall the centre goes as implicit Euler says, and back up with as
 * much energy. */
TEST(test_rests_and_falls)
{
    smr *s = rig_init(e.model, &e.config, NULL);
    const smr_energy before = rig_energy(s);
    rig_steps(s, 10);
    assert_true(rig_far(rig_positions(s, e.model), bone.xyz, e.n) < 1e-3f);
    e.config.dynamics.gravity[1] = -9810.0f;
    e.config.dynamics.damping = 0.0f;
    s = rig_init(e.model, &e.config, NULL);
    rig_steps(s, 20);
    const smr_energy after = rig_energy(s);
    const float way = 0.5f * 9810.0f * 1e-4f * 20.0f * 21.0f;
    assert_int_equal(20, after.steps);
    assert_int_equal(0, after.sweeps);
    assert_true(fabsf(before.centre[1] - after.centre[1] - way) < 0.01f &&
                fabsf(before.centre[0] - after.centre[0]) < 0.01f);
    assert_true(fabsf(after.gravity_uj + 0.001f * after.mass_g * 9810.0f * way) < 1e-3f * fabsf(after.gravity_uj));
    assert_true(after.elastic_uj < 1e-4f * after.kinetic_uj);
}

/* A damped fall and a damped throw are those of implicit Euler: v' = (v + h g) / (1 + h c), x' = x + h v'. */
TEST(test_damped_fall)
{
    e.config.dynamics.gravity[1] = -9810.0f;
    for (uint32_t i = 0; i < 6u; i++) {
        static const float rates[] = {1.0f, 20.0f, 300.0f};
        const double h = 1e-3 * (double)e.config.dynamics.step_ms, c = (double)rates[i % 3u];
        double x = 0.0, v = i < 3u ? 0.0 : 2000.0;
        e.config.dynamics.damping = rates[i % 3u];
        e.config.partial.coverage = i % 2u ? SMR_COVERAGE_WHOLE : SMR_COVERAGE_AUTO;
        smr *s = rig_init(e.model, &e.config, NULL);
        const smr_energy before = rig_energy(s);
        for (uint32_t k = 0; k < e.n; k++)
            e.speed[3u * k + 1u] = (float)v;
        assert_int_equal(SMR_OK, smr_set_motion(s, 0, NULL, e.speed));
        rig_steps(s, 43);
        for (uint32_t k = 0; k < 43u; k++) {
            v = (v - 9810.0 * h) / (1.0 + h * c);
            x += h * v;
        }
        const smr_energy after = rig_energy(s);
        assert_true(fabs((double)(after.centre[1] - before.centre[1]) - x) < 1e-4 * fabs(x) + 0.01);
        assert_true(fabs((double)after.kinetic_uj - 0.0005 * (double)after.mass_g * v * v) <
                    1e-3 * (double)after.kinetic_uj);
        assert_true(after.elastic_uj < 1e-3f * after.kinetic_uj);
        for (uint32_t k = 0; k < 3u * e.n; k++)
            e.speed[k] = 0.0f;
    }
}

/* How far a model hangs below its springs does not depend on the damping: g / (k stiffness). */
TEST(test_damping_leaves_the_sag)
{
    e.config.dynamics.gravity[1] = -9810.0f;
    e.config.caller.goals = 1;
    for (uint32_t i = 0; i < 3u; i++) {
        static const float rates[] = {20.0f, 90.0f, 400.0f};
        e.config.dynamics.damping = rates[i];
        smr *s = rig_init(e.model, &e.config, NULL);
        const float before = rig_energy(s).centre[1], k = e.config.dynamics.elastic * e.config.forces.stiffness;
        assert_int_equal(SMR_OK, smr_set_goals(s, 0, bone.xyz, NULL));
        rig_steps(s, 150);
        const float sag = before - rig_energy(s).centre[1];
        assert_true(fabsf(sag - 9810.0f / k) < 0.02f * 9810.0f / k);
    }
}

/* Linear and angular momentum about the origin, of masses as they count. */
static void momentum(const smr *s, double p[6])
{
    const smr_dynamics *d = s->shape.dynamics;
    memset(p, 0, 6u * sizeof *p);
    for (uint32_t v = 0; v < s->shared.n; v++) {
        const double m = (double)(d->weight[v] * d->members[v] * d->gram);
        double x[3], w[3];
        for (uint32_t c = 0; c < 3u; c++) {
            x[c] = (double)smr_at3(s->shape.x, v)[c];
            w[c] = (double)smr_at3(d->velocity, v)[c];
            p[c] += m * w[c];
        }
        for (uint32_t c = 0; c < 3u; c++)
            p[3u + c] += m * (x[(c + 1u) % 3u] * w[(c + 2u) % 3u] - x[(c + 2u) % 3u] * w[(c + 1u) % 3u]);
    }
}

/* New velocities abandon an iteration within its first step, and nothing of the iteration is left. */
TEST(test_abandoned)
{
    rig_clock clock;
    const smr_port port = rig_clock_port(&clock, RIG_CLOCK_STEADY, 1000);
    e.config.dynamics.gravity[1] = -9810.0f;
    smr *s = rig_init(e.model, &e.config, &port), *twin = rig_init(e.model, &e.config, NULL);
    rig_steps(s, 2);
    rig_steps(twin, 2);
    assert_int_equal(SMR_PARTIAL, smr_tick(s, 1, NULL));
    assert_true(s->step == 0u && s->next_task > 0u);
    e.speed[0] = 5.0f;
    assert_int_equal(SMR_OK, smr_set_motion(s, 0, NULL, e.speed));
    assert_int_equal(SMR_OK, smr_set_motion(twin, 0, NULL, e.speed));
    rig_steps(s, 2);
    rig_steps(twin, 2);
    assert_true(smr_state_hash(s) == smr_state_hash(twin));
}

TEST(test_keeps_momentum)
{
    e.config.dynamics.damping = 0.0f;
    for (uint32_t k = 0; k < 4u; k++) {
        double before[6], after[6];
        e.config.basic.method = k % 2u;
        e.config.dynamics.elastic = k < 2u ? 1e3f : 1e6f;
        smr *s = rig_init(e.model, &e.config, NULL);
        rig_throw(&e, &bone, rig_energy(s).centre, 1.0f, 200.0f);
        assert_int_equal(SMR_OK, smr_set_motion(s, 0, NULL, e.speed));
        momentum(s, before);
        const double size = sqrt(before[3] * before[3] + before[4] * before[4] + before[5] * before[5]);
        rig_steps(s, 20);
        momentum(s, after);
        for (uint32_t c = 0; c < 3u; c++) {
            assert_true(fabs(after[c] - before[c]) < 1e-4 * fabs(before[0]));
            assert_true(fabs(after[3u + c] - before[3u + c]) < 2e-2 * size);
        }
    }
}

/* Where no energy is too much, velocities are by what the vertices moved, to the last bit. */
TEST(test_velocities_are_displacements)
{
    smr *s = rig_init(e.model, &e.config, NULL);
    float *const before = rig_alloc(3u * (size_t)e.n * sizeof *before);
    rig_throw(&e, &bone, rig_energy(s).centre, 1.0f, 200.0f);
    assert_int_equal(SMR_OK, smr_set_motion(s, 0, NULL, e.speed));
    memcpy(before, s->shape.x, 3u * (size_t)e.n * sizeof *before);
    rig_steps(s, 1);
    for (uint32_t i = 0; i < 3u * e.n; i++)
        assert_true(s->shape.dynamics->velocity[i] == (s->shape.x[i] - before[i]) * (1.0f / s->shape.dynamics->step_s));
}

/* All that a cluster can have weigh eight clusters together, however many others are pinned elsewhere. */
TEST(test_pins_weigh)
{
    e.config.track.radius_mm = 60.0f;
    for (uint32_t n_pins = 1; n_pins < e.n; n_pins *= 3u) {
        for (uint32_t i = 0; i < e.n; i++)
            e.mass[i] = i < n_pins ? INFINITY : 1.0f;
        smr *s = rig_init(e.model, &e.config, NULL);
        assert_int_equal(SMR_OK, smr_set_motion(s, 0, e.mass, NULL));
        const smr_dynamics *d = s->shape.dynamics;
        const uint32_t largest = s->schedule.lists.largest, together = n_pins < largest ? n_pins : largest;
        assert_true(largest > 9u && largest < 400u);
        for (uint32_t v = 0; v < e.n; v++)
            if (!(d->mass[v] > 0.0f))
                assert_true(fabsf(d->weight[v] * (float)together / (8.0f * (float)largest) - 1.0f) < 0.02f);
    }
}

/* Pinned vertices with a velocity carry the others along; springs to goals bring the bone onto them. */
TEST(test_drawn)
{
    float *const goal = rig_alloc(3u * (size_t)e.n * sizeof *goal);
    for (uint32_t i = 0; i < e.n; i++)
        e.mass[i] = at(i)[2] < 60.0f ? INFINITY : 1.0f;
    for (uint32_t i = 0; i < e.n; i++)
        e.speed[3u * i] = e.mass[i] > 9.0f ? 50.0f : 0.0f;
    smr *s = rig_init(e.model, &e.config, NULL);
    assert_int_equal(SMR_OK, smr_set_motion(s, 0, e.mass, e.speed));
    rig_steps(s, 100);
    const float *xyz = rig_positions(s, e.model);
    for (uint32_t i = 0; i < e.n; i++)
        assert_true(fabsf(xyz[3u * i] - at(i)[0] - 50.0f) < (e.mass[i] > 9.0f ? 0.01f : 15.0f));
    e.config.caller.goals = 1;
    e.config.dynamics.damping = 20.0f;
    for (uint32_t i = 0; i < 3u * e.n; i++)
        goal[i] = bone.xyz[i] + (i % 3u == 1u ? 12.0f : 0.0f);
    s = rig_init(e.model, &e.config, NULL);
    assert_int_equal(SMR_OK, smr_set_goals(s, 0, goal, NULL));
    rig_steps(s, 4);
    assert_true(rig_energy(s).goals_uj > 1.0f);
    rig_steps(s, 60);
    assert_true(rig_far(rig_positions(s, e.model), goal, e.n) < 0.05f);
}

/* More structures than a record has words: members as in the clusters of an iteration; far structures are groups. */
TEST(test_many_structures)
{
    smr_mesh ball[35];
    const smr_prepare_config radii = rig_radii(2, 40, 12, 0);
    for (uint32_t i = 0; i < 35u; i++) { /* in pairs whose clusters overlap; each pair far from the next one */
        const float centre[3] = {100.0f * (float)(i / 2u), 9.0f * (float)(i % 2u), 0};
        ball[i] = rig_ball(4, 3, 4 + i % 3u, centre);
    }
    smr *s = rig_init(rig_model(ball, 35, &radii), &e.config, NULL);
    const smr_dynamics *d = s->shape.dynamics;
    for (uint32_t i = 0; i < 35u; i++)
        assert_int_equal(i - i % 2u, d->group[i]);
    assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
    for (uint32_t v = 0; v < s->shared.n; v++)
        assert_true(d->members[v] > 1.0f && fabsf(d->members[v] * s->reference.share[v] - 1.0f) < 1.0e-5f);
}

/* Where an image that has drawn the model is taken away, the model is at rest in the shape that it has by then. */
TEST(test_rests_without_its_image)
{
    const smr_volume own = rig_ball_image(RIG_BALL_MM, rig_nowhere), larger = rig_ball_image(34, rig_nowhere);
    e.model = rig_ball_model(&own);
    smr *s = rig_init(e.model, &e.config, NULL);
    const uint32_t n = s->shared.n;
    const float *const first = rig_positions(s, e.model);
    assert_int_equal(SMR_OK, smr_set_volume(s, &larger));
    rig_steps(s, 5);
    const float *const drawn = rig_positions(s, e.model);
    assert_int_equal(SMR_OK, smr_set_volume(s, NULL));
    assert_true(rig_far(first, drawn, n) > 1.0f);
    for (uint32_t i = 0; i < 2u * SMR_SWEEPS; i++) {
        assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
        assert_true(rig_far(drawn, rig_positions(s, e.model), n) < 1.0e-3f);
    }
}
