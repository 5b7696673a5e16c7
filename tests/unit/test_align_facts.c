/* test_align_facts.c: what smr_align says about a start pose: symmetric things have several poses alike, closed
 * meshes that are inside out are named and aligned all the same, a good pose as given is kept to the bit, parts are
 * laid onto the parts they are, wholly explained by the whole, the mirror image is farther away, and inputs that are
 * moved together move the pose. Accuracy: parts of the fixture's bone within 3 mm and 3 degrees; moved poses within
 * 0.01 mm.
 * SPDX-License-Identifier: MIT */
#include "suite.h"

#include <math.h>
#include <string.h>

#include "unit_mesh.h"

static unit_mesh moved(const unit_mesh *m, const smr_pose *p)
{
    unit_mesh r = unit_mesh_new(m->nv, m->nt);
    memcpy(r.triangles, m->triangles, 12u * (size_t)m->nt);
    for (uint32_t i = 0; i < 3u * m->nv; i++) {
        const float *x = m->xyz + i / 3u * 3u, *row = p->m[i % 3u];
        r.xyz[i] = row[0] * x[0] + row[1] * x[1] + row[2] * x[2] + row[3];
    }
    return r;
}

/* A random rotation and 300 mm. */
static smr_pose random_pose(oracle_random *r)
{
    double turn[9];
    smr_pose p;
    oracle_rotation(r, turn);
    for (uint32_t i = 0; i < 9u; i++)
        p.m[i / 3u][i % 3u] = (float)turn[i];
    for (uint32_t i = 0; i < 3u; i++)
        p.m[i][3] = (float)oracle_uniform(r, -300, 300);
    return p;
}

static void turn_inside_out(unit_mesh *m)
{
    for (uint32_t i = 0; i < m->nt; i++) {
        const uint32_t first = m->triangles[3u * i];
        m->triangles[3u * i] = m->triangles[3u * i + 1u];
        m->triangles[3u * i + 1u] = first;
    }
}

/* The triangles whose centres have x in a range of the bone's length, 0 .. 1: an open part, with all vertices. */
static unit_mesh part_of(const unit_mesh *m, uint32_t axis, float from, float to)
{
    unit_mesh r = unit_mesh_new(m->nv, m->nt);
    float lo = 1e9f, hi = -1e9f;
    uint32_t n = 0;
    for (uint32_t i = 0; i < m->nv; i++) {
        lo = fminf(lo, m->xyz[3u * i + axis]);
        hi = fmaxf(hi, m->xyz[3u * i + axis]);
    }
    memcpy(r.xyz, m->xyz, 12u * (size_t)m->nv);
    for (uint32_t i = 0; i < m->nt; i++) {
        const uint32_t *t = m->triangles + 3u * (size_t)i;
        const float at = (m->xyz[3u * t[0] + axis] + m->xyz[3u * t[1] + axis] + m->xyz[3u * t[2] + axis]) / 3.0f;
        if (at >= lo + from * (hi - lo) && at <= lo + to * (hi - lo))
            memcpy(r.triangles + 3u * (size_t)n++, t, 12u);
    }
    r.nt = n;
    return r;
}

static smr_align_report align(const unit_mesh *model, const unit_mesh *target, const smr_align_config *config,
                              smr_pose *pose)
{
    smr_surface *a = unit_surface(model), *b = unit_surface(target);
    smr_align_report report;
    assert_int_equal(unit_align(a, b, config, pose, &report), SMR_OK);
    rig_free(a);
    rig_free(b);
    return report;
}

/* The largest distance between where two poses put vertices of the mesh. */
static double apart(const unit_mesh *m, const smr_pose *p, const smr_pose *q)
{
    const unit_mesh a = moved(m, p), b = moved(m, q);
    double most = 0.0;
    for (uint32_t i = 0; i < m->nv; i++)
        most = fmax(most, hypot(hypot((double)(a.xyz[3u * i] - b.xyz[3u * i]),
                                      (double)(a.xyz[3u * i + 1u] - b.xyz[3u * i + 1u])),
                                (double)(a.xyz[3u * i + 2u] - b.xyz[3u * i + 2u])));
    unit_mesh gone[2] = {a, b};
    unit_mesh_free(&gone[0]);
    unit_mesh_free(&gone[1]);
    return most;
}

/* The sphere of unit_sphere() stretched to an ellipsoid with two axes alike. */
TEST(symmetric_things)
{
    oracle_random r = oracle_seed(31);
    const smr_align_config c = smr_align_config_default();
    for (uint32_t k = 0; k < 2u; k++) {
        unit_mesh m = unit_sphere(3, 30.0f, 0.0f);
        for (uint32_t i = 0; i < m.nv; i++)
            m.xyz[3u * i] *= k == 0u ? 1.0f : 3.0f;
        const smr_pose p = random_pose(&r);
        unit_mesh t = moved(&m, &p);
        smr_pose pose;
        const smr_align_report report = align(&m, &t, &c, &pose);
        assert_true(report.n_alike > 1u);
        assert_true(report.mirrored_rms_mm < 0.7f && report.second_rms_mm < 0.7f);
        unit_mesh_free(&m);
        unit_mesh_free(&t);
    }
}

TEST(inside_out)
{
    oracle_random r = oracle_seed(32);
    const smr_align_config c = smr_align_config_default();
    for (uint32_t k = 0; k < 4u; k++) {
        unit_mesh m = unit_bone(0);
        const smr_pose p = random_pose(&r);
        unit_mesh t = moved(&m, &p);
        smr_pose pose;
        if (k & 1u)
            turn_inside_out(&m);
        if (k & 2u)
            turn_inside_out(&t);
        const smr_align_report report = align(&m, &t, &c, &pose);
        assert_int_equal(report.model_inside_out, k & 1u);
        assert_int_equal(report.target_inside_out, k >> 1);
        assert_true(oracle_within("align: inside out, mm", apart(&m, &pose, &p), 0.05));
        unit_mesh_free(&m);
        unit_mesh_free(&t);
    }
}

/* The true pose as given is kept to the bit; one that is a little off is left; without one the identity is. */
TEST(given_pose)
{
    oracle_random r = oracle_seed(33);
    smr_align_config c = smr_align_config_default();
    unit_mesh m = unit_bone(0), other = unit_bone(1);
    const smr_pose p = random_pose(&r);
    static const smr_pose identity = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    unit_mesh t = moved(&other, &p);
    smr_pose off = p, pose;
    c.scaled = 0;
    assert_int_equal(align(&m, &other, &c, &pose).given, 1);
    assert_memory_equal(&pose, &identity, sizeof pose);
    assert_int_equal(align(&m, &t, &c, &pose).given, 0);
    c.given = &p;
    assert_int_equal(align(&m, &t, &c, &pose).given, 1);
    assert_memory_equal(&pose, &p, sizeof pose);
    off.m[0][3] += 8.0f;
    c.given = &off;
    const smr_align_report report = align(&m, &t, &c, &pose);
    assert_int_equal(report.given, 0);
    assert_true(report.rms_mm < 1.5f && report.mirrored_rms_mm > 1.5f * report.rms_mm);
    assert_true(apart(&m, &pose, &p) < 2.0);
}

/* The scale of a given pose that is kept is reported, not that of the pose found. */
TEST(scale_of_a_given_pose)
{
    const smr_pose p = {{{1.002f, 0, 0, 0}, {0, 1.002f, 0, 0}, {0, 0, 1.002f, 0}}};
    smr_align_config c = smr_align_config_default();
    const unit_mesh m = unit_bone(0), other = unit_bone(1);
    smr_pose pose;
    c.given = &p;
    const smr_align_report report = align(&m, &other, &c, &pose);
    assert_int_equal(1, report.given);
    assert_float_equal(1.002f, report.scale, 1.0e-6f);
}

/* Each end of the bone, and the bone without it, as the target and as the model; with a scale it stays about 1. */
TEST(parts)
{
    oracle_random r = oracle_seed(34);
    smr_align_config c = smr_align_config_default();
    static const float range[4][2] = {{0, 0.5f}, {0.5f, 1}, {0, 0.7f}, {0.3f, 1}};
    unit_mesh m = unit_bone(0);
    /* of the sixteen each range, side and scaling */
    for (uint32_t k = 0; k < 16u; k += 3u) {
        unit_mesh part = part_of(&m, 2, range[k % 4u][0], range[k % 4u][1]);
        const smr_pose p = random_pose(&r);
        const uint32_t whole_model = k / 4u % 2u;
        unit_mesh t = moved(whole_model ? &part : &m, &p);
        smr_pose pose;
        c.scaled = k / 8u;
        const smr_align_report report = align(whole_model ? &m : &part, &t, &c, &pose);
        assert_true(oracle_within("align: parts, mm", apart(&part, &pose, &p), 3.0));
        const float all = whole_model ? report.target_share : report.model_share;
        const float some = whole_model ? report.model_share : report.target_share;
        assert_true(all > 0.97f && some < 0.85f && some > 0.35f);
        assert_true(fabsf(report.scale - 1.0f) < 0.02f && report.n_alike == 1u);
        unit_mesh_free(&part);
        unit_mesh_free(&t);
    }
}

/* q = p after both inputs are moved by M is M p M^-1: both put M's model to the same places. */
TEST(moved_inputs)
{
    oracle_random r = oracle_seed(35);
    const smr_align_config c = smr_align_config_default();
    unit_mesh m = unit_bone(0), whole = unit_bone(1);
    unit_mesh part = part_of(&whole, 2, 0.2f, 1);
    const smr_pose away = random_pose(&r);
    unit_mesh t = moved(&part, &away);
    smr_pose p, q;
    (void)align(&m, &t, &c, &p);
    unit_mesh laid = moved(&m, &p);
    for (uint32_t k = 0; k < 5u; k++) {
        const smr_pose by = random_pose(&r);
        unit_mesh m2 = moved(&m, &by), t2 = moved(&t, &by), expected = moved(&laid, &by);
        (void)align(&m2, &t2, &c, &q);
        unit_mesh found = moved(&m2, &q);
        double most = 0.0;
        for (uint32_t i = 0; i < 3u * m.nv; i++)
            most = fmax(most, fabs((double)(found.xyz[i] - expected.xyz[i])));
        assert_true(oracle_within("align: moved inputs, mm", most, 0.01));
        unit_mesh_free(&m2);
        unit_mesh_free(&t2);
        unit_mesh_free(&expected);
        unit_mesh_free(&found);
    }
}
