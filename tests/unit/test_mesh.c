/* test_mesh.c: validation of meshes, normals and areas, closed meshes. Accuracy against double precision: vertex
 * normals 2e-6 in each component, areas 2e-6 relative.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include <string.h>
#include "geometry/surface/mesh.h"
#include "unit_mesh.h"

TEST(refuses_bad_meshes)
{
    static const float bad[] = {NAN, INFINITY, -INFINITY, 1e30f, -1e30f, 100001.0f, -100001.0f};
    unit_mesh m = unit_grid(3, 3, 2.0f);
    smr_mesh v = unit_view(&m);
    assert_int_equal(smr_mesh_check(&v), SMR_OK);
    assert_int_equal(smr_mesh_check(NULL), SMR_E_NULL);
    v.xyz = NULL;
    assert_int_equal(smr_mesh_check(&v), SMR_E_NULL);
    v = unit_view(&m);
    v.triangles = NULL;
    assert_int_equal(smr_mesh_check(&v), SMR_E_NULL);
    v.n_triangles = 0;
    assert_int_equal(smr_mesh_check(&v), SMR_OK);
    v = unit_view(&m);
    v.n_vertices = 0;
    assert_int_equal(smr_mesh_check(&v), SMR_E_INPUT);
    v.n_vertices = SMR_VERTICES_MAX + 1u; /* refused before anything is read */
    assert_int_equal(smr_mesh_check(&v), SMR_E_INPUT);
    v = unit_view(&m);
    v.n_triangles = SMR_TRIANGLES_MAX + 1u;
    assert_int_equal(smr_mesh_check(&v), SMR_E_INPUT);
    v = unit_view(&m);
    for (uint32_t i = 0; i < 3u * m.nv; i++) {
        const float was = m.xyz[i];
        for (size_t k = 0; k < sizeof bad / sizeof bad[0]; k++) {
            m.xyz[i] = bad[k];
            assert_int_equal(smr_mesh_check(&v), SMR_E_INPUT);
        }
        m.xyz[i] = i % 2u ? SMR_COORD_MAX : -SMR_COORD_MAX;
        assert_int_equal(smr_mesh_check(&v), SMR_OK);
        m.xyz[i] = was;
    }
    for (uint32_t i = 0; i < 3u * m.nt; i++) {
        const uint32_t was = m.triangles[i];
        m.triangles[i] = m.nv;
        assert_int_equal(smr_mesh_check(&v), SMR_E_INPUT);
        m.triangles[i] = SMR_ALL;
        assert_int_equal(smr_mesh_check(&v), SMR_E_INPUT);
        m.triangles[i] = was;
    }
}

TEST(normals_and_areas)
{
    oracle_random r = oracle_seed(80);
    double worst = 0.0, worst_area = 0.0;
    for (uint32_t round = 0; round < 20u; round++) {
        unit_mesh m = round % 2u ? unit_grid(20, 15, 3.0f) : unit_sphere(3, 40.0f, 10.0f);
        for (uint32_t i = 0; i < 3u * m.nv; i++)
            m.xyz[i] += oracle_uniformf(&r, -0.3f, 0.3f);
        const smr_mesh v = unit_view(&m);
        float *normal = rig_rough(12u * (size_t)m.nv), *area = rig_rough(4u * (size_t)m.nv);
        double *want = rig_rough(32u * (size_t)m.nv);
        for (uint32_t i = 0; i < 4u * m.nv; i++)
            want[i] = 0.0;
        for (uint32_t k = 0; k < m.nt; k++) {
            double e[2][3], n[3];
            const uint32_t *t = m.triangles + 3u * k;
            for (int c = 0; c < 3; c++)
                for (int j = 0; j < 2; j++)
                    e[j][c] = (double)m.xyz[3u * t[j + 1] + (uint32_t)c] - (double)m.xyz[3u * t[0] + (uint32_t)c];
            for (int c = 0; c < 3; c++)
                n[c] = e[0][(c + 1) % 3] * e[1][(c + 2) % 3] - e[0][(c + 2) % 3] * e[1][(c + 1) % 3];
            for (int c = 0; c < 3; c++) {
                for (int j = 0; j < 3; j++)
                    want[4u * t[c] + (uint32_t)j] += n[j];
                want[4u * t[c] + 3u] += sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]) / 6.0;
            }
        }
        smr_mesh_normals(&v, normal, area);
        for (uint32_t i = 0; i < m.nv; i++) {
            const double *n = want + 4u * i, l = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
            for (uint32_t c = 0; c < 3u; c++)
                worst = fmax(worst, fabs((double)normal[3u * i + c] - n[c] / l));
            worst_area = fmax(worst_area, fabs((double)area[i] / n[3] - 1.0));
        }
        rig_free(normal);
        rig_free(area);
        rig_free(want);
        unit_mesh_free(&m);
    }
    assert_true(oracle_within("mesh: vertex normals", worst, 2e-6));
    assert_true(oracle_within("mesh: areas, relative", worst_area, 2e-6));
}

/* Isolated vertices and vertices of zero-area triangles have no normal and no area; area may be NULL. */
TEST(vertices_without_area)
{
    const float xyz[] = {0, 0, 0, 1, 0, 0, 2, 0, 0, 5, 5, 5, 7, 7, 7};
    const uint32_t t[] = {0, 1, 2, 4, 4, 4, 0, 1, 1};
    const smr_mesh m = {xyz, t, 5, 3};
    float normal[15], area[5];
    smr_mesh_normals(&m, normal, area);
    for (int i = 0; i < 15; i++)
        assert_true(normal[i] == 0.0f);
    for (int i = 0; i < 5; i++)
        assert_true(area[i] == 0.0f);
    smr_mesh_normals(&m, normal, NULL);
}

/* A mesh is closed unless a triangle is missing or turned over. */
TEST(closed_or_not)
{
    static const float none[3] = {0, 0, 0};
    const smr_mesh ball = rig_ball(20, 6, 10, none);
    uint32_t *turned = rig_alloc(12u * (size_t)ball.n_triangles);
    memcpy(turned, ball.triangles, 12u * (size_t)ball.n_triangles);
    assert_true(smr_mesh_edges(turned, ball.n_triangles) == 0u);
    assert_true(smr_mesh_edges(turned, ball.n_triangles - 1u) != 0u);
    turned[0] = ball.triangles[1];
    turned[1] = ball.triangles[0];
    assert_true(smr_mesh_edges(turned, ball.n_triangles) != 0u);
}
