/* test_pendulum.c: a bone as a rigid pendulum: it swings about one pinned vertex, or about two or three on a line,
 * with the period of rigid mechanics, computed here in double precision; turned about them without gravity it loses
 * what damping takes. Bones of 600 vertices and of 3,700, single clusters or many. SMR_TEST_SHOW=1 prints what came
 * out.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "property/rig_motion.h"

static smr_mesh bone;
static float *xyz; /* the bone's */
static uint32_t pin[3];
static rig_motion e;

static const float *at(uint32_t i) { return bone.xyz + 3u * (size_t)i; }

/* The vertex nearest to a place. */
static uint32_t nearest(const float place[3])
{
    uint32_t best = 0;
    for (uint32_t i = 0; i < bone.n_vertices; i++)
        best = rig_far(at(i), place, 1) < rig_far(at(best), place, 1) ? i : best;
    return best;
}

/* Vertices to pin: the topmost; one that is 30 mm away; and one that is put in the middle between them. */
static void choose_pins(void)
{
    for (uint32_t i = 0; i < bone.n_vertices; i++)
        pin[0] = at(i)[2] > at(pin[0])[2] ? i : pin[0];
    const float *const top = at(pin[0]), beside[3] = {top[0] + 20.0f, top[1] + 20.0f, top[2] - 10.0f};
    pin[1] = nearest(beside);
    const float *const other = at(pin[1]);
    const float middle[3] = {0.5f * (top[0] + other[0]), 0.5f * (top[1] + other[1]), 0.5f * (top[2] + other[2])};
    pin[2] = nearest(middle);
    memcpy(xyz + 3u * (size_t)pin[2], middle, sizeof middle);
}

static void make_scene(uint32_t cell_um, uint32_t n_radii, float r0, float r1)
{
    const smr_prepare_config radii = rig_radii(n_radii, r0, r1, 0);
    rig_bone(cell_um, 1.0f, &bone, NULL);
    xyz = rig_alloc(3u * (size_t)bone.n_vertices * sizeof *xyz);
    memcpy(xyz, bone.xyz, 3u * (size_t)bone.n_vertices * sizeof *xyz);
    bone.xyz = xyz;
    choose_pins();
    e = rig_motion_make(&bone, &radii);
    e.config.dynamics.elastic = 1e6f;
}

typedef struct pendulum {
    double pivot[3], axis[3], down[3], side[3]; /* down: where it hangs at rest; side: where it swings */
    double period;                              /* s, of small swings */
} pendulum;

static double dot(const double *a, const double *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static void cross(const double *a, const double *b, double *c)
{
    for (uint32_t i = 0; i < 3u; i++)
        c[i] = a[(i + 1u) % 3u] * b[(i + 2u) % 3u] - a[(i + 2u) % 3u] * b[(i + 1u) % 3u];
}

static void unit(double *a)
{
    const double l = sqrt(dot(a, a));
    for (uint32_t i = 0; i < 3u; i++)
        a[i] /= l;
}

/* Inertia about the pivot between two directions. */
static double inertia(const pendulum *p, const double *a, const double *b)
{
    double sum = 0.0;
    for (uint32_t i = 0; i < e.n; i++) {
        double r[3];
        for (uint32_t c = 0; c < 3u; c++)
            r[c] = (double)at(i)[c] - p->pivot[c];
        sum += dot(r, r) * dot(a, b) - dot(r, a) * dot(r, b);
    }
    return sum;
}

/* The slower of the two ways to swing about a point: without spin about the line to the centre, and with the axis that
 * keeps it. Returns the inertia. */
static double swing_axis(pendulum *p)
{
    double first[3] = {1, 0, 0}, second[3], k[3];
    cross(p->down, first, second);
    unit(second);
    cross(second, p->down, first);
    const double spin = inertia(p, p->down, p->down), one = inertia(p, first, p->down),
                 two = inertia(p, second, p->down);
    k[0] = inertia(p, first, first) - one * one / spin;
    k[1] = inertia(p, first, second) - one * two / spin;
    k[2] = inertia(p, second, second) - two * two / spin;
    const double half = 0.5 * (k[0] + k[2]), most = half + sqrt(0.25 * (k[0] - k[2]) * (k[0] - k[2]) + k[1] * k[1]);
    for (uint32_t c = 0; c < 3u; c++)
        p->axis[c] = k[1] * first[c] + (most - k[0]) * second[c];
    unit(p->axis);
    return most;
}

/* About the first pin, or the line from it to the second. */
static void hang(pendulum *p, uint32_t n_pins)
{
    double mean[3] = {0, 0, 0};
    for (uint32_t c = 0; c < 3u; c++) {
        p->pivot[c] = (double)at(pin[0])[c];
        p->axis[c] = (double)at(pin[1])[c] - p->pivot[c];
    }
    unit(p->axis);
    for (uint32_t i = 0; i < 3u * e.n; i++)
        mean[i % 3u] += ((double)bone.xyz[i] - p->pivot[i % 3u]) / (double)(e.n - n_pins);
    const double along = n_pins > 1u ? dot(mean, p->axis) : 0.0;
    for (uint32_t c = 0; c < 3u; c++)
        mean[c] -= along * p->axis[c];
    memcpy(p->down, mean, sizeof mean);
    unit(p->down);
    const double most = n_pins > 1u ? inertia(p, p->axis, p->axis) : swing_axis(p);
    p->period = 2.0 * acos(-1.0) * sqrt(most / ((double)(e.n - n_pins) * 9810.0 * sqrt(dot(mean, mean))));
}

/* Turns the direction of gravity by 5 degrees about the axis. */
static void tilt(pendulum *p, float gravity[3])
{
    const double angle = acos(-1.0) / 36.0;
    double way[3];
    cross(p->axis, p->down, way);
    for (uint32_t c = 0; c < 3u; c++)
        p->down[c] = cos(angle) * p->down[c] + sin(angle) * way[c];
    cross(p->axis, p->down, p->side);
    for (uint32_t c = 0; c < 3u; c++)
        gravity[c] = (float)(9810.0 * p->down[c]);
}

/* The period between the first and the last passage of the centre below the pivot. */
static double swing(smr *s, const pendulum *p, double h, uint32_t n)
{
    double first = 0.0, last = 0.0, before = -1.0;
    uint32_t count = 0;
    for (uint32_t i = 0; i < n; i++) {
        double r[3];
        rig_steps(s, 1);
        const smr_energy now = rig_energy(s);
        for (uint32_t c = 0; c < 3u; c++)
            r[c] = (double)now.centre[c] - p->pivot[c];
        const double angle = atan2(dot(r, p->side), dot(r, p->down));
        if (i > 0u && before * angle < 0.0) {
            last = h * (i + before / (before - angle));
            first = count++ == 0u ? last : first;
        }
        before = angle;
    }
    return count > 1u ? 2.0 * (last - first) / (count - 1.0) : 0.0;
}

/* The period is that of rigid mechanics, and the pins stay. */
static void swings(const pendulum *hanging, uint32_t n_pins)
{
    pendulum p = *hanging;
    tilt(&p, e.config.dynamics.gravity);
    e.config.dynamics.damping = 0.0f;
    e.config.dynamics.step_ms = (float)(10.0 * p.period);
    smr *s = rig_init(e.model, &e.config, NULL);
    assert_int_equal(SMR_OK, smr_set_motion(s, 0, e.mass, NULL));
    assert_int_equal(n_pins, rig_energy(s).n_pinned);
    const double period = swing(s, &p, p.period / 100.0, 78);
    if (getenv("SMR_TEST_SHOW") != NULL)
        (void)printf("%u vertices, %u pins: %.4f s computed, %.4f s (%.2f %%)\n", e.n, n_pins, p.period, period,
                     100.0 * (period / p.period - 1.0));
    assert_true(fabs(period / p.period - 1.0) < 0.03);
    const float *const now = rig_positions(s, e.model);
    for (uint32_t k = 0; k < n_pins; k++)
        assert_true(rig_far(now + 3u * (size_t)pin[k], at(pin[k]), 1) < 1e-4f);
}

/* Turned about the pins without gravity it loses in each step what damping takes, and little more. */
static void slows_down(const pendulum *p, uint32_t n_pins, float step_ms)
{
    static const double any[3] = {1, 2, 3};
    const uint32_t n = 8;
    double turn[3], r[3], v[3], left[2];
    memset(e.config.dynamics.gravity, 0, sizeof e.config.dynamics.gravity);
    e.config.dynamics.damping = 1.0f;
    e.config.dynamics.step_ms = step_ms;
    for (uint32_t c = 0; c < 3u; c++)
        turn[c] = n_pins > 1u ? 3.0 * p->axis[c] : any[c];
    for (uint32_t i = 0; i < e.n; i++) {
        for (uint32_t c = 0; c < 3u; c++)
            r[c] = (double)at(i)[c] - p->pivot[c];
        cross(turn, r, v);
        for (uint32_t c = 0; c < 3u; c++)
            e.speed[3u * i + c] = e.mass[i] < 9.0f ? (float)v[c] : 0.0f;
    }
    smr *s = rig_init(e.model, &e.config, NULL);
    assert_int_equal(SMR_OK, smr_set_motion(s, 0, e.mass, e.speed));
    if (rig_falls(s, n, 0.0f, left) < n)
        fail_msg("%u vertices, %u pins, step %g ms: %g of the energy after %g", e.n, n_pins, (double)step_ms, left[0],
                 left[1]);
    const double damped = pow(1.0 + 0.001 * (double)step_ms, -2.0 * n);
    if (getenv("SMR_TEST_SHOW") != NULL)
        (void)printf("step %g ms: %.4f of the energy is left, %.4f by damping alone\n", (double)step_ms, left[0],
                     damped);
    assert_true(left[0] < damped && left[0] > (step_ms < 9.0f ? 0.95 : 0.85) * damped);
}

static void pendulum_swings(uint32_t cell_um)
{
    const uint32_t most = rig_times(20) < 20u ? 1u : 3u; /* instrumented builds take long */
    pendulum p;
    make_scene(cell_um, 1, 600, 0);
    for (uint32_t n_pins = 1; n_pins <= most; n_pins++) {
        e.mass[pin[n_pins - 1u]] = INFINITY;
        hang(&p, n_pins);
        swings(&p, n_pins);
        slows_down(&p, n_pins, 5.0f);
        slows_down(&p, n_pins, 20.0f);
    }
}

TEST(test_few_vertices) { pendulum_swings(12000); }

/* As many as a femur out of a CT has. */
TEST(test_many_vertices) { pendulum_swings(4950); }

/* Clusters smaller than the bone, which stretches where it hangs. */
TEST(test_clusters)
{
    pendulum p;
    make_scene(4950, 2, 150, 60);
    e.config.basic.method = SMR_METHOD_POLAR;
    e.mass[pin[0]] = INFINITY;
    hang(&p, 1);
    swings(&p, 1);
    e.config.track.radius_mm = 60.0f;
    slows_down(&p, 1, 20.0f);
}
