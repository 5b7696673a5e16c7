/* test_surface_distances.c: distances integrate over the area: the quadrature is exact for cubics, points on shared
 * edges and corners count once, and what is masked, or belongs to no triangle, does not count. Tolerance 1e-6 relative.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "measure/surface_distances.h"

/* A square of 10 x 10 mm as two triangles, and a vertex of no triangle. */
static const float square_xyz[] = {0, 0, 0, 10, 0, 0, 10, 10, 0, 0, 10, 0, 500, 500, 500};
static const uint32_t square_triangles[] = {0, 1, 2, 0, 2, 3};
static const smr_mesh square = {square_xyz, square_triangles, 5, 2};

static double integral(const smr_mesh *mesh, const unsigned char *seen, int px, int py)
{
    host_samples s;
    double sum = 0.0;
    float *weight = NULL;
    assert_int_equal(host_samples_make(mesh, &s), 0);
    weight = test_malloc(s.n * sizeof *weight);
    host_samples_weigh(&s, mesh, seen, weight);
    for (size_t i = 0; i < s.n; i++)
        if (weight[i] >= 0.0f)
            sum += (double)weight[i] * pow((double)s.xyz[3u * i], px) * pow((double)s.xyz[3u * i + 1u], py);
    test_free(weight);
    host_samples_free(&s);
    return sum;
}

TEST(integrates_cubics_exactly)
{
    for (int px = 0; px <= 3; px++)
        for (int py = 0; px + py <= 3; py++) {
            const double exact = pow(10.0, px + 1) / (px + 1) * pow(10.0, py + 1) / (py + 1);
            const double found = integral(&square, NULL, px, py);
            assert_true(fabs(found - exact) <= 1e-6 * exact);
        }
    assert_true(fabs(integral(&square, NULL, 4, 0) - 20000.0) > 1.0); /* the test can fail */
}

TEST(shares_edges_and_corners)
{
    host_samples s;
    assert_int_equal(host_samples_make(&square, &s), 0);
    assert_int_equal(s.n_vertices, 5);
    assert_int_equal(s.n, 5 + 5 + 2); /* two triangles share one of their edges */
    assert_int_equal(s.middle[2], s.middle[3]);
    host_samples_free(&s);
}

TEST(leaves_out_what_is_masked)
{
    static const unsigned char all_but_one[] = {1, 1, 1, 0, 1}, none[] = {1, 0, 1, 0, 1};
    assert_true(fabs(integral(&square, all_but_one, 0, 0) - 50.0) <= 1e-5);
    assert_true(fabs(integral(&square, all_but_one, 0, 1) - 50.0 * 10.0 / 3.0) <= 1e-4); /* the lower triangle */
    assert_true(!(integral(&square, none, 0, 0) > 0.0));
}

/* A mesh at z = 0 and its distances to a surface 2 mm below, which ends 3 mm before the square does. */
typedef struct scene {
    void *memory;
    host_query query;
} scene;

static scene make_scene(const smr_mesh *from)
{
    static const float xyz[] = {0, 0, -2, 20, 0, -2, 0, 20, -2, 7, 10, -2, 7, 0, -2};
    static const uint32_t triangles[] = {0, 4, 3, 0, 3, 2}; /* x up to 7 mm */
    static const smr_mesh below = {xyz, triangles, 5, 2};
    const smr_port one_thread = {0};
    scene s;
    memset(&s, 0, sizeof s);
    s.query.surface = host_surface_make(&below, &s.memory);
    s.query.mesh = *from;
    assert_non_null(s.query.surface);
    assert_int_equal(host_distances(&one_thread, &s.query, 1), 0);
    return s;
}

static void free_scene(scene *s)
{
    host_queries_free(&s->query, 1);
    free(s->memory);
}

TEST(tells_area_from_vertices)
{
    static const unsigned char left[] = {1, 0, 1, 1, 1}, *const mask[] = {left};
    scene s = make_scene(&square);
    host_stats area, vertices, masked;
    const double far = sqrt(13.0);
    assert_int_equal(host_area_stats(&s.query, 1, NULL, &area), 0);
    assert_int_equal(host_vertex_stats(&s.query, 1, NULL, &vertices), 0);
    assert_int_equal(host_area_stats(&s.query, 1, mask, &masked), 0);
    assert_int_equal(vertices.n, 4);
    assert_int_equal(area.n, 11);
    assert_int_equal(masked.n, 7);
    assert_true(fabs(vertices.mean - (2.0 + far) / 2.0) < 1e-6);
    assert_true(fabs(vertices.max - far) < 1e-6 && fabs(area.max - far) < 1e-6);
    assert_true(fabs(area.weight - 100.0) < 1e-4 && fabs(masked.weight - 50.0) < 1e-4 && vertices.weight == 4.0);
    assert_true(area.mean > 2.0 && area.mean < vertices.mean && masked.mean < area.mean);
    assert_true(vertices.rms > vertices.mean && area.p95 <= area.max);
    free_scene(&s);
}

TEST(counts_points_alike)
{
    const smr_mesh points = {square_xyz, NULL, 4, 0};
    scene s = make_scene(&points);
    host_stats area, vertices;
    assert_int_equal(host_area_stats(&s.query, 1, NULL, &area), 0);
    assert_int_equal(host_vertex_stats(&s.query, 1, NULL, &vertices), 0);
    assert_int_equal(area.n, 4);
    assert_memory_equal(&area, &vertices, sizeof area);
    free_scene(&s);
}

TEST(weighs_percentiles)
{
    host_weighted light[] = {{9.0f, 1.0f}, {1.0f, 95.0f}, {5.0f, 4.0f}};
    host_weighted heavy[] = {{9.0f, 1.0f}, {1.0f, 94.0f}, {5.0f, 5.0f}};
    const host_stats a = host_stats_of(light, 3), b = host_stats_of(heavy, 3), none = host_stats_of(light, 0);
    assert_true(fabs(a.p95 - 1.0) < 1e-9 && fabs(b.p95 - 5.0) < 1e-9);
    assert_true(fabs(a.mean - 1.24) < 1e-9 && fabs(a.max - 9.0) < 1e-9);
    assert_int_equal(none.n, 0);
}

/* The square folded along its diagonal, one half with a smaller height: 3 mm over the diagonal. */
TEST(tells_how_deep_folds_are)
{
    const float h = 3.0f * (float)sqrt(0.5), x = 5.0f + h, y = 5.0f - h;
    const float folded[] = {0, 0, 0, 10, 0, 0, 10, 10, 0, x, y, 0.1f, 500, 500, 500};
    const smr_mesh mesh = {folded, square_triangles, 5, 2};
    host_folds folds;
    assert_int_equal(host_count_folds(&mesh, square_xyz, &folds), 0);
    assert_true(folds.n == 1 && folds.all == 1 && fabs(folds.deepest_mm - 3.0) < 0.01);
    assert_int_equal(host_count_folds(&mesh, folded, &folds), 0);
    assert_true(folds.n == 0 && folds.all == 1 && folds.deepest_mm == 0.0);
}
