/* test_fixture_bone.c: the generated pair is closed, oriented, manifold, free of folds and repeatable.
 * SPDX-License-Identifier: MIT */
#include "../suite.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "fixture_bone.h"

#define TEST_CELL 4000u
#define TEST_VERTICES FIXTURE_VERTICES(TEST_CELL)

static float test_xyz[2][3 * TEST_VERTICES];
static uint32_t test_triangles[2][6 * TEST_VERTICES];
static float test_scratch[FIXTURE_SCRATCH_WORDS(TEST_CELL)];
static const size_t test_words = sizeof test_scratch / sizeof test_scratch[0];

static fixture_mesh test_mesh(int i)
{
    fixture_mesh m = {test_xyz[i], test_triangles[i], TEST_VERTICES, 2 * TEST_VERTICES, 0, 0};
    return m;
}

static int compare_edges(const void *a, const void *b)
{
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return x < y ? -1 : x > y;
}

/* Every directed edge once, and its opposite once: closed, oriented, two triangles per edge. */
static void assert_closed(const fixture_mesh *m)
{
    static uint64_t edges[6 * TEST_VERTICES];
    size_t n = 0;
    for (uint32_t t = 0; t < m->n_triangles; t++)
        for (uint32_t k = 0; k < 3u; k++)
            edges[n++] = (uint64_t)m->triangles[3 * t + k] << 32 | m->triangles[3 * t + (k + 1) % 3];
    qsort(edges, n, sizeof edges[0], compare_edges);
    for (size_t i = 0; i < n; i++) {
        uint64_t opposite = edges[i] << 32 | edges[i] >> 32;
        assert_true(i == 0 || edges[i] != edges[i - 1]);
        assert_non_null(bsearch(&opposite, edges, n, sizeof edges[0], compare_edges));
    }
    assert_int_equal(2 * m->n_vertices - 4, m->n_triangles); /* one sphere: Euler's number is 2 */
}

static double signed_volume(const fixture_mesh *m)
{
    double volume = 0.0;
    for (uint32_t t = 0; t < m->n_triangles; t++) {
        const float *a = m->xyz + 3 * m->triangles[3 * t], *b = m->xyz + 3 * m->triangles[3 * t + 1];
        const float *c = m->xyz + 3 * m->triangles[3 * t + 2];
        volume += (double)a[0] * ((double)b[1] * (double)c[2] - (double)b[2] * (double)c[1]) +
                  (double)a[1] * ((double)b[2] * (double)c[0] - (double)b[0] * (double)c[2]) +
                  (double)a[2] * ((double)b[0] * (double)c[1] - (double)b[1] * (double)c[0]);
    }
    return volume / 6.0;
}

TEST(test_closed_at_every_resolution)
{
    for (uint32_t cell = 4200u; cell <= FIXTURE_CELL_MAX; cell += 371u) {
        for (int i = 0; i < 2; i++) {
            fixture_mesh m = test_mesh(i);
            fixture_grid grid = i == 0 ? fixture_grid_source(cell) : fixture_grid_target(cell);
            assert_int_equal(1, i == 0 ? fixture_bone_source(&grid, &m, test_scratch, test_words)
                                       : fixture_bone_target(&grid, 2.0f, &m, test_scratch, test_words));
            assert_closed(&m);
            assert_true(signed_volume(&m) > 4.5e5 && signed_volume(&m) < 1.1e6);
        }
    }
}

TEST(test_vertices_lie_on_the_surface)
{
    fixture_mesh m = test_mesh(0);
    fixture_grid grid = fixture_grid_source(FIXTURE_CELL_DEMO);
    assert_int_equal(1, fixture_bone_source(&grid, &m, test_scratch, test_words));
    assert_in_range(m.n_vertices, 2700, 3300);
    for (uint32_t i = 0; i < m.n_vertices; i++)
        assert_true(fabsf(fixture_bone_value(m.xyz + 3 * i)) < 0.05f);
}

TEST(test_displacement_follows_strength)
{
    fixture_mesh m = test_mesh(0);
    fixture_grid grid = fixture_grid_source(FIXTURE_CELL_DEMO);
    assert_int_equal(1, fixture_bone_source(&grid, &m, test_scratch, test_words));
    for (int strength = 0; strength <= 2; strength++) {
        double sum = 0.0, largest = 0.0;
        fixture_bone_truth((float)strength, m.xyz, m.n_vertices, test_xyz[1]);
        for (uint32_t i = 0; i < 3 * m.n_vertices; i += 3) {
            double x = (double)(test_xyz[1][i] - m.xyz[i]), y = (double)(test_xyz[1][i + 1] - m.xyz[i + 1]);
            double z = (double)(test_xyz[1][i + 2] - m.xyz[i + 2]), d = sqrt(x * x + y * y + z * z);
            sum += d;
            largest = d > largest ? d : largest;
        }
        assert_true(fabs(sum / m.n_vertices - 10.4 * strength) < 1.5);
        assert_true(fabs(largest - 24.5 * strength) < 2.0);
    }
}

/* The deformation keeps orientation everywhere near the bone, up to the largest strength. */
TEST(test_deformation_has_no_fold)
{
    for (float x = -48.0f; x <= 76.0f; x += 4.0f) {
        for (float y = -46.0f; y <= 34.0f; y += 4.0f) {
            for (float z = -4.0f; z <= 434.0f; z += 6.0f) {
                const float h = 0.5f;
                float p[12] = {x, y, z, x + h, y, z, x, y + h, z, x, y, z + h};
                double d[9], det;
                fixture_bone_truth(2.0f, p, 4, p);
                for (int i = 0; i < 9; i++)
                    d[i] = (double)((p[3 + i] - p[i % 3]) / h);
                det = d[0] * (d[4] * d[8] - d[5] * d[7]) - d[1] * (d[3] * d[8] - d[5] * d[6]) +
                      d[2] * (d[3] * d[7] - d[4] * d[6]);
                assert_true(det > 0.2);
            }
        }
    }
}

TEST(test_refuses_small_buffers)
{
    fixture_mesh m = test_mesh(0);
    fixture_grid grid = fixture_grid_source(8000u);
    assert_int_equal(1, fixture_bone_source(&grid, &m, test_scratch, test_words));
    uint32_t need = m.n_vertices;
    m.max_vertices = need - 1;
    assert_int_equal(0, fixture_bone_source(&grid, &m, test_scratch, test_words));
    m.max_vertices = need;
    m.max_triangles = 2 * need - 5;
    assert_int_equal(0, fixture_bone_source(&grid, &m, test_scratch, test_words));
    m.max_triangles = 2 * need - 4;
    assert_int_equal(0, fixture_bone_source(&grid, &m, test_scratch, 1000));
    assert_int_equal(1, fixture_bone_source(&grid, &m, test_scratch, test_words));
    grid.cell_um = 0;
    assert_int_equal(0, fixture_bone_source(&grid, &m, test_scratch, test_words));
    grid.cell_um = FIXTURE_CELL_MAX + 1u;
    assert_int_equal(0, fixture_bone_source(&grid, &m, test_scratch, test_words));
}
