/* test_forces.c: external forces: the exact closest point, and every reason for having no force.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include <string.h>
#include "registration/registration.h"

static const float none[3] = {0, 0, 0};

typedef struct setting {
    smr *s;
    const smr_model *model;
    const smr_surface *surface;
    smr_mesh goal;
} setting;

static smr_config plain(void)
{
    smr_config c = smr_config_default();
    c.motion.momentum = 0.0f;
    c.motion.fold_guard = 0; /* no repairing iterations without forces */
    c.forces.node_budget = 1000000;
    c.forces.search_radii = 1.0e6f;
    c.forces.normal_deg = 180.0f;
    c.basic.slide = 1.0f;
    return c;
}

static setting start(const smr_config *config, const smr_mesh *goal)
{
    setting t;
    const smr_mesh mesh = rig_ball(30, 9, 12, none);
    const smr_prepare_config radii = rig_radii(1, 18, 0, 0);
    t.goal = *goal;
    t.model = rig_model(&mesh, 1, &radii);
    t.surface = rig_surface(goal);
    t.s = rig_init(t.model, config, NULL);
    assert_int_equal(SMR_OK, smr_set_surface(t.s, SMR_ALL, t.surface));
    return t;
}

static void search(smr *s)
{
    for (uint32_t i = 0; i < smr_forces_tasks(&s->forces); i++)
        smr_forces_search(&s->forces, i, 0);
    for (uint32_t i = 0; i < s->shared.n_tasks; i++)
        smr_forces_take(&s->forces, i, 0);
    smr_forces_end(&s->forces);
}

static smr_vec place_of(const smr *s, uint32_t v) { return smr_add(smr_load(smr_at3(s->shape.x, v)), s->shape.origin); }

TEST(test_closest_point)
{
    static const float degrees[] = {180, 75, 40}, reach[] = {1.0e5f, 5.0f, 2.0f};
    const float off[3] = {4, -3, 2};
    const smr_mesh goal = rig_ball(32, 11, 15, off);
    for (uint32_t k = 0; k < 9u; k++) {
        smr_config c = plain();
        c.forces.normal_deg = degrees[k % 3u];
        c.basic.search_mm = reach[k / 3u];
        c.forces.stiffness = 0.25f + 0.25f * (float)(k % 4u);
        const setting t = start(&c, &goal);
        uint32_t n_forces = 0;
        double sum = 0.0, largest = 0.0;
        search(t.s);
        for (uint32_t v = 0; v < t.s->shared.n; v++) {
            const smr_vec p = place_of(t.s, v), n = smr_load(smr_at3(t.s->shape.normal, v));
            const float point[3] = {p.x, p.y, p.z}, normal[3] = {n.x, n.y, n.z};
            const float *f = smr_at3(t.s->forces.force, v);
            smr_closest hit;
            (void)smr_surface_closest(t.surface, point, normal, t.s->shared.min_cos, c.basic.search_mm, &hit);
            const int found = hit.triangle != SMR_NONE;
            n_forces += (uint32_t)found;
            sum += found ? (double)hit.distance : 0.0;
            largest = fmax(largest, found ? (double)hit.distance : 0.0);
            for (uint32_t a = 0; a < 3u; a++) {
                const float want = found ? c.forces.stiffness * (hit.point[a] - point[a]) : 0.0f;
                assert_true(fabsf(f[a] - want) < 2.0e-5f);
            }
        }
        assert_int_equal(n_forces, t.s->forces.totals.n_forces);
        assert_int_equal(t.s->shared.n - n_forces, t.s->forces.totals.n_rejected);
        assert_int_equal(t.s->shared.n, t.s->forces.totals.n_with_target);
        assert_true(fabs(largest - (double)t.s->forces.totals.max) < 1.0e-4);
        assert_true(n_forces == 0u || fabs(sum / n_forces - (double)t.s->forces.totals.mean) < 1.0e-4);
        assert_true(t.s->forces.totals.rms >= t.s->forces.totals.mean * 0.9999f);
        assert_true(k > 0u || n_forces == t.s->shared.n);
        assert_true(k < 6u || n_forces < t.s->shared.n);
    }
}

TEST(test_box)
{
    const float off[3] = {4, -3, 2};
    const smr_mesh goal = rig_ball(32, 11, 15, off);
    smr_config c = plain();
    uint32_t inside = 0;
    c.forces.use_box = 1;
    for (uint32_t a = 0; a < 3u; a++) {
        c.forces.box_min[a] = -100;
        c.forces.box_max[a] = 100;
    }
    c.forces.box_min[0] = 0;
    const setting t = start(&c, &goal);
    search(t.s);
    for (uint32_t v = 0; v < t.s->shared.n; v++) {
        const smr_vec p = place_of(t.s, v), f = smr_load(smr_at3(t.s->forces.force, v));
        if (smr_length(f) > 0.0f) {
            inside++;
            assert_true(p.x >= -1.0e-4f && p.x + f.x / c.forces.stiffness >= -1.0e-4f);
        }
    }
    assert_true(inside > t.s->shared.n / 4u && inside < t.s->shared.n * 3u / 4u);
}

TEST(test_border)
{
    smr_mesh half = rig_ball(32, 11, 15, none);
    smr_config c = plain();
    half.n_triangles /= 2u; /* an open surface */
    c.partial.coverage = SMR_COVERAGE_WHOLE;
    const setting all = start(&c, &half);
    search(all.s);
    assert_int_equal(all.s->shared.n, all.s->forces.totals.n_forces);
    c.forces.reject_border = 1;
    const setting t = start(&c, &half);
    search(t.s);
    assert_true(t.s->forces.totals.n_rejected > t.s->shared.n / 5u && t.s->forces.totals.n_forces > t.s->shared.n / 5u);
    for (uint32_t v = 0; v < t.s->shared.n; v++) {
        const smr_vec p = place_of(t.s, v);
        const float point[3] = {p.x, p.y, p.z};
        smr_closest hit;
        (void)smr_surface_closest(t.surface, point, NULL, -2.0f, 1.0e5f, &hit);
        assert_int_equal(hit.on_border == 0u, smr_length(smr_load(smr_at3(t.s->forces.force, v))) > 0.0f);
    }
}

TEST(test_outliers)
{
    smr_mesh goal = rig_ball(31, 11, 15, none);
    smr_config c = plain();
    float *xyz = rig_alloc(3u * goal.n_vertices * sizeof *xyz);
    memcpy(xyz, goal.xyz, 3u * goal.n_vertices * sizeof *xyz);
    for (uint32_t i = 0; i < 3u; i++)
        xyz[3u * (goal.n_vertices - 2u) + i] *= 3.0f; /* a spike at the pole */
    goal.xyz = xyz;
    c.forces.reject_deviations = 2.0f;
    const setting t = start(&c, &goal);
    search(t.s);
    assert_int_equal(0, t.s->forces.totals.n_rejected);                             /* nothing is known yet */
    const float limit = t.s->forces.surface.limit = t.s->forces.surface.limit_next; /* as of a complete iteration */
    assert_true(limit > t.s->forces.totals.goal_mean && limit < t.s->forces.totals.max);
    search(t.s);
    assert_true(t.s->forces.totals.n_rejected > 0u && t.s->forces.totals.n_rejected < t.s->shared.n / 4u);
    assert_true(t.s->forces.totals.max <= limit);
}
