/* test_align_surfaces.c: the start pose without landmarks: known rigid and scaled poses of the fixture's bone are
 * found from 50 random rotations. Accuracy: vertices within 0.02 mm of their true place when source and target are
 * the same mesh, and the rms agrees; 0.25 mm for two meshes of one bone with edges of 12 mm, rms below 1.5 mm.
 * SPDX-License-Identifier: MIT */
#include "suite.h"

#include <math.h>
#include <string.h>

#include "unit_mesh.h"

typedef struct planted {
    double turn[9], scale, shift[3];
} planted;

static void move(const planted *p, const float x[3], double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = p->scale * (p->turn[3 * k] * (double)x[0] + p->turn[3 * k + 1] * (double)x[1] +
                             p->turn[3 * k + 2] * (double)x[2]) +
                 p->shift[k];
}

/* Plants a pose, aligns, and returns the mean distance between where vertices land and where they should. */
static double find(oracle_random *r, const unit_mesh *model, const smr_surface *s, const unit_mesh *other, int scaled,
                   float *rms)
{
    planted p;
    oracle_rotation(r, p.turn);
    p.scale = scaled ? oracle_uniform(r, 0.6, 1.6) : 1.0;
    for (int k = 0; k < 3; k++)
        p.shift[k] = oracle_uniform(r, -700, 700);
    unit_mesh t = unit_mesh_new(other->nv, other->nt);
    memcpy(t.triangles, other->triangles, 12u * (size_t)t.nt);
    for (uint32_t i = 0; i < t.nv; i++) {
        double x[3];
        move(&p, other->xyz + 3u * (size_t)i, x);
        for (int k = 0; k < 3; k++)
            t.xyz[3u * i + (uint32_t)k] = (float)x[k];
    }
    smr_surface *target = unit_surface(&t);
    smr_align_config c = smr_align_config_default();
    c.scaled = (uint32_t)scaled;
    c.samples = 120;
    c.iterations = 100;
    smr_pose pose;
    smr_align_report report;
    assert_int_equal(unit_align(s, target, &c, &pose, &report), SMR_OK);
    assert_true(fabs((double)report.scale - p.scale) < 0.01 && report.n_alike == 1u && !report.given);
    assert_true(report.model_share > 0.95f && report.target_share > 0.95f);
    *rms = report.rms_mm;
    double sum = 0.0;
    for (uint32_t i = 0; i < model->nv; i++) {
        double x[3], d2 = 0.0;
        const float *v = model->xyz + 3u * (size_t)i;
        move(&p, v, x);
        for (int k = 0; k < 3; k++) {
            const double got = (double)pose.m[k][0] * (double)v[0] + (double)pose.m[k][1] * (double)v[1] +
                               (double)pose.m[k][2] * (double)v[2] + (double)pose.m[k][3];
            d2 += (got - x[k]) * (got - x[k]);
        }
        sum += sqrt(d2) / p.scale;
    }
    rig_free(target);
    unit_mesh_free(&t);
    return sum / (double)model->nv;
}

static void run(uint32_t seed, int scaled, uint32_t n, int other_mesh, double budget)
{
    oracle_random r = oracle_seed(seed);
    unit_mesh bone = unit_bone(0), other = unit_bone(other_mesh);
    smr_surface *s = unit_surface(&bone);
    double worst = 0.0, worst_rms = 0.0;
    for (uint32_t i = 0; i < n; i++) {
        float rms = -1.0f;
        worst = fmax(worst, find(&r, &bone, s, &other, scaled, &rms));
        assert_true(rms >= 0.0f);
        worst_rms = fmax(worst_rms, (double)rms);
    }
    assert_true(oracle_within(scaled ? "align: scaled, mm" : "align: rigid, mm", worst, budget));
    assert_true(oracle_within("align: rms it says, mm", worst_rms, other_mesh ? 1.5 : budget));
    rig_free(s);
    unit_mesh_free(&bone);
    unit_mesh_free(&other);
}

TEST(similarity_poses) { run(111, 1, rig_times(12), 0, 0.02); }

TEST(two_meshes_of_one_bone) { run(112, 0, 4, 1, 0.25); }

static void refused_configurations(const smr_surface *s)
{
    static const uint32_t bad[][3] = {{2, 60, 600}, {1, 0, 600}, {1, 1001, 600}, {1, 60, 15}, {1, 60, 100001}};
    smr_align_config c = smr_align_config_default();
    unsigned char none;
    size_t bytes = 7;
    smr_pose pose;
    c.cookie ^= 1u;
    assert_int_equal(smr_align(s, s, &c, &none, 1, &pose, NULL), SMR_E_CONFIG);
    assert_int_equal(smr_align_bytes(&c, &bytes), SMR_E_CONFIG);
    for (size_t i = 0; i < 5u; i++) {
        c = smr_align_config_default();
        c.scaled = bad[i][0];
        c.iterations = bad[i][1];
        c.samples = bad[i][2];
        assert_int_equal(smr_align(s, s, &c, &none, 1, &pose, NULL), SMR_E_CONFIG);
        assert_int_equal(smr_align_bytes(&c, &bytes), SMR_E_CONFIG);
    }
    assert_int_equal(bytes, 7);
}

/* Poses that are no rotation with a scale: sheared, mirrored, flat, not finite, too large. */
static void refused_poses(const smr_surface *s, void *memory, size_t bytes)
{
    static const smr_pose bad[] = {
        {{{1, 0.1f, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}}, {{{-1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}},
        {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 0, 0}}},    {{{1, 0, 0, NAN}, {0, 1, 0, 0}, {0, 0, 1, 0}}},
        {{{NAN, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}},  {{{2e3f, 0, 0, 0}, {0, 2e3f, 0, 0}, {0, 0, 2e3f, 0}}}};
    smr_align_config c = smr_align_config_default();
    smr_pose pose;
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        c.given = &bad[i];
        assert_int_equal(smr_align(s, s, &c, memory, bytes, &pose, NULL), SMR_E_INPUT);
    }
}

TEST(refusals)
{
    unit_mesh m = unit_sphere(1, 5.0f, 0.0f);
    smr_surface *s = unit_surface(&m);
    const smr_align_config c = smr_align_config_default();
    size_t bytes = 0;
    smr_pose pose, mark;
    assert_int_equal(smr_align_bytes(NULL, &bytes), SMR_E_NULL);
    assert_int_equal(smr_align_bytes(&c, NULL), SMR_E_NULL);
    assert_int_equal(smr_align_bytes(&c, &bytes), SMR_OK);
    unsigned char *memory = rig_rough(bytes + SMR_ALIGN);
    memset(&mark, 0x55, sizeof mark);
    pose = mark;
    assert_int_equal(smr_align(NULL, s, &c, memory, bytes, &pose, NULL), SMR_E_NULL);
    assert_int_equal(smr_align(s, NULL, &c, memory, bytes, &pose, NULL), SMR_E_NULL);
    assert_int_equal(smr_align(s, s, NULL, memory, bytes, &pose, NULL), SMR_E_NULL);
    assert_int_equal(smr_align(s, s, &c, NULL, bytes, &pose, NULL), SMR_E_NULL);
    assert_int_equal(smr_align(s, s, &c, memory, bytes, NULL, NULL), SMR_E_NULL);
    assert_int_equal(smr_align(s, s, &c, memory, bytes - 1u, &pose, NULL), SMR_E_ARENA);
    assert_int_equal(smr_align(s, s, &c, memory + 4, bytes, &pose, NULL), SMR_E_ALIGN);
    refused_configurations(s);
    refused_poses(s, memory, bytes);
    assert_memory_equal(&pose, &mark, sizeof pose);
    assert_int_equal(smr_align(s, s, &c, memory, bytes, &pose, NULL), SMR_OK); /* report may be NULL */
}

/* A cloud of a surface's own vertices, with and without normals, as the target and as the model. */
TEST(clouds)
{
    unit_mesh m = unit_sphere(3, 20.0f, 3.0f);
    smr_surface *s = unit_surface(&m), *cloud;
    smr_points *points;
    const smr_align_config c = smr_align_config_default();
    float *const normal = rig_alloc(12u * (size_t)m.nv);
    for (uint32_t i = 0; i < 3u * m.nv; i++)
        normal[i] = m.xyz[i] / 20.0f;
    for (uint32_t k = 0; k < 4u; k++) {
        size_t bytes;
        smr_pose pose;
        smr_align_report report;
        assert_int_equal(smr_points_bytes(m.nv, &bytes), SMR_OK);
        assert_int_equal(smr_points_open(m.nv, rig_alloc(bytes), bytes, &points), SMR_OK);
        assert_int_equal(smr_points_add(points, m.xyz, k % 2u ? normal : NULL, NULL, m.nv), SMR_OK);
        assert_int_equal(smr_points_surface_bytes(m.nv, &bytes), SMR_OK);
        assert_int_equal(smr_points_surface(points, rig_alloc(bytes), bytes, &cloud), SMR_OK);
        assert_int_equal(unit_align(k < 2u ? s : cloud, k < 2u ? cloud : s, &c, &pose, &report), SMR_OK);
        assert_true(report.rms_mm < 1.0f);
    }
    unit_mesh_free(&m);
}

/* A segment, a point, a single triangle, a flat square: an answer or a refusal, always finite. */
TEST(degenerate_surfaces)
{
    static const float xyz[4][9] = {{0, 0, 0, 5, 0, 0, 10, 0, 0},
                                    {1, 1, 1, 1, 1, 1, 1, 1, 1},
                                    {0, 0, 0, 9, 0, 0, 0, 7, 0},
                                    {0, 0, 0, 1e5f, 0, 0, -1e5f, 1e5f, 9e4f}};
    static const uint32_t t[3] = {0, 1, 2};
    unit_mesh ball = unit_sphere(2, 20.0f, 3.0f);
    smr_surface *round = unit_surface(&ball);
    const smr_align_config c = smr_align_config_default();
    for (size_t i = 0; i < 4u; i++) {
        unit_mesh m = unit_mesh_new(3, 1);
        memcpy(m.xyz, xyz[i], sizeof xyz[i]);
        memcpy(m.triangles, t, sizeof t);
        smr_surface *s = unit_surface(&m), *pair[4] = {s, round, s, s};
        for (size_t k = 0; k < 3u; k++) {
            smr_pose pose;
            smr_align_report report;
            const smr_status status = unit_align(pair[k], pair[k + 1u], &c, &pose, &report);
            assert_true(status == SMR_OK || status == SMR_E_INPUT);
            if (status == SMR_OK)
                assert_true(unit_finite(&pose.m[0][0], 12, 1e8f) && unit_finite(&report.rms_mm, 6, 1e8f));
        }
        rig_free(s);
        unit_mesh_free(&m);
    }
}
