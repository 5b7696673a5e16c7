/* test_cluster_boundary.c: masses, centres and shares of clusters agree with double precision, with the fractional
 * weights of vertices near the boundary. Boundary pairs of a forged model overflow nothing, in dynamics with a pin
 * either.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include <string.h>
#include "property/rig_motion.h"
#include "registration/tick/iteration_steps.h"
#include "unit_exercise.h"

static const float none[3] = {0, 0, 0};

static double distance(const float *a, const float *b)
{
    double d2 = 0;
    for (uint32_t c = 0; c < 3u; c++)
        d2 += ((double)a[c] - (double)b[c]) * ((double)a[c] - (double)b[c]);
    return sqrt(d2);
}

/* A ball, and as radius the distance between two of its vertices that are no mesh neighbours. */
static smr *start(float shift, const smr_model **model)
{
    smr_mesh mesh = rig_ball(30, 9, 12, none);
    float *xyz = rig_alloc(3u * mesh.n_vertices * sizeof *xyz);
    memcpy(xyz, mesh.xyz, 3u * mesh.n_vertices * sizeof *xyz);
    const float radius = (float)distance(xyz + 3u * 20u, xyz + 3u * 50u);
    const smr_prepare_config radii = rig_radii(1, radius, 0, 0);
    const double length = distance(xyz + 3u * 20u, xyz + 3u * 50u);
    for (uint32_t c = 0; c < 3u; c++)
        xyz[3u * 50u + c] += (float)((double)shift * ((double)xyz[3u * 50u + c] - (double)xyz[3u * 20u + c]) / length);
    mesh.xyz = xyz;
    smr_config config = smr_config_default();
    config.motion.fold_guard = 0;
    *model = rig_model(&mesh, 1, &radii);
    return rig_init(*model, &config, NULL);
}

/* What pair i adds to a member's whole or nothing. */
static double added(const smr *s, uint32_t i)
{
    return (double)smr_le32(s->schedule.lists.boundary[i].share) / SMR_BOUNDARY_UNITS - 0.5;
}

static int between(const smr *s, uint32_t i, uint32_t a, uint32_t b)
{
    const uint32_t first = smr_le32(s->schedule.lists.boundary[i].first),
                   second = smr_le32(s->schedule.lists.boundary[i].second);
    return (first == a && second == b) || (first == b && second == a);
}

/* Mass, centre and share of each cluster, by distances and the boundary. */
TEST(test_reference)
{
    const smr_model *model;
    smr *s = start(0, &model);
    assert_int_equal(SMR_OK, smr_tick(s, 0, NULL)); /* without a target nothing moves */
    for (uint32_t v = 0; v < s->shared.n; v++) {
        double mass = 0, count = 0, centre[3] = {0, 0, 0};
        for (uint32_t w = 0; w < s->shared.n; w++) {
            const double d = distance(smr_at3(s->shape.x_ref, v), smr_at3(s->shape.x_ref, w));
            double part = d <= (double)s->schedule.lists.radius ? 1.0 : 0.0;
            for (uint32_t i = 0; i < s->schedule.lists.n_boundary; i++)
                if (between(s, i, v, w)) /* which side of the radius it lies on is in what is added, too */
                    part = added(s, i) < 0.0 ? 1.0 + added(s, i) : added(s, i);
            mass += part * (double)smr_mass(&s->shared, w);
            count += part;
            for (uint32_t c = 0; c < 3u; c++)
                centre[c] += part * (double)smr_mass(&s->shared, w) * (double)smr_at3(s->shape.x_ref, w)[c];
        }
        assert_true(fabs((double)s->reference.cluster_mass[v] - mass) < 1.0e-4 * mass);
        assert_true(fabs((double)s->reference.share[v] - 1.0 / count) < 1.0e-5);
        for (uint32_t c = 0; c < 3u; c++)
            assert_true(fabs((double)smr_at3(s->reference.centre, v)[c] - centre[c] / mass) < 1.0e-3);
    }
}

/* A copy with the caller's first vertices paired with its last, which are far away, and with clusters that reach
 * nowhere: what lies between the two is many more steps of rounding than in any cluster. */
static const smr_model *forged(const smr_model *model)
{
    const size_t bytes = smr_le32(model->bytes);
    const uint32_t n = smr_le32(model->n_vertices);
    const smr_model *opened = NULL;
    unsigned char *const copy = rig_alloc(bytes);
    memcpy(copy, model, bytes);
    smr_stored_radius *const r = (smr_stored_radius *)(void *)(copy + smr_le32(model->at_radii));
    smr_stored_boundary *const pair = (smr_stored_boundary *)(void *)(copy + smr_le32(r->at_boundary));
    r->reach = 0;
    assert_true(smr_le32(r->n_boundary) > n);
    for (uint32_t i = 0; i < smr_le32(r->n_boundary); i++) {
        pair[i].first = smr_le32(smr_model_position(model, i % n));
        pair[i].second = smr_le32(smr_model_position(model, n - 1u - i % n));
        pair[i].share = smr_le32(SMR_BOUNDARY_UNITS);
    }
    unit_repair(copy, bytes);
    assert_int_equal(SMR_OK, smr_model_open(copy, bytes, &opened));
    return opened;
}

/* A plate of 1.5 m, its first corner pinned: the heaviest that a vertex can be. The undefined behaviour sanitiser sees
 * what overflows; the sums say how far apart two vertices count. */
TEST(test_forged_pairs)
{
    const smr_prepare_config radius = rig_radii(1, 450, 0, 0);
    const smr_mesh plate = rig_plate(21, 75.0f);
    rig_motion m = rig_motion_make(&plate, &radius);
    for (uint32_t pinned = 0; pinned < 2u; pinned++) {
        m.mass[0] = pinned > 0u ? INFINITY : 1.0f;
        smr *s = rig_init(forged(m.model), &m.config, NULL);
        smr_reference *const r = &s->reference;
        assert_int_equal(SMR_OK, smr_set_motion(s, 0, m.mass, NULL));
        assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
        const uint32_t to = smr_model_position(m.model, 20), from = smr_model_position(m.model, 0);
        const int64_t units = (int64_t)(smr_mass(&s->shared, from) * s->shared.mass_unit);
        uint32_t *const w = s->sums.sum + SMR_WORDS * (size_t)to;
        memset(w, 0, SMR_WORDS * sizeof *w);
        smr_reference_add(r, to, from, 1);
        assert_int_equal(smr_boundary_part(-units * 32768), w[1]);
        assert_int_equal(smr_boundary_part(-units * 1073741824), w[10]);
        rig_steps(s, 2);
        assert_true(rig_finite(rig_positions(s, m.model), m.n));
    }
}

/* Points half a micrometre beyond the radius count half in the size of the largest cluster, rounded up. */
TEST(test_largest_cluster)
{
    const smr_prepare_config radii = rig_radii(1, 10, 0, 0);
    for (uint32_t outside = 1; outside <= 6u; outside++) {
        float xyz[3u * 7u] = {0};
        const smr_mesh points = {xyz, NULL, 1u + outside, 0};
        smr_model_info info;
        for (uint32_t i = 0; i < outside; i++) /* on the axes, far from each other */
            xyz[3u * (i + 1u) + i % 3u] = i < 3u ? 10.0005f : -10.0005f;
        assert_int_equal(SMR_OK, smr_model_get_info(rig_model(&points, 1, &radii), &info));
        assert_int_equal(1u + (outside + 1u) / 2u, info.largest_cluster[0]);
    }
}
