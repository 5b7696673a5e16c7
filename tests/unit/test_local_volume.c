/* test_local_volume.c: volumes around vertices against double precision: what is moved and scaled, bent, flat, or
 * without triangles. Asking changes no bit of what follows.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include <string.h>
#include "registration/registration.h"

static const float nowhere[3] = {40, -300, 120};

static smr *start(const smr_mesh *mesh, float radius)
{
    smr_prepare_config radii = rig_radii(2, radius, 0.5f * radius, 0);
    const smr_config config = smr_config_default();
    radii.ring = 0; /* clusters are what lies within the radius */
    return rig_init(rig_model(mesh, 1, &radii), &config, NULL);
}

/* Ratios after the vertices went to xyz. scale: of the whole from rest, or NULL. */
static const float *ratios(const smr_mesh *mesh, float radius, const float *xyz, double *scale)
{
    smr_verdict verdict;
    float *ratio = rig_alloc(mesh->n_vertices * sizeof *ratio);
    smr *s = start(mesh, radius);
    assert_int_equal(SMR_OK, smr_set_positions(s, 0, xyz));
    assert_int_equal(SMR_OK, smr_get_local_volume(s, 0, radius, ratio));
    assert_int_equal(SMR_OK, smr_get_verdict(s, SMR_ALL, &verdict));
    if (scale != NULL)
        *scale = (double)verdict.scale_rest;
    return ratio;
}

TEST(test_moved_and_scaled)
{
    const smr_mesh ball = rig_ball(30, 9, 12, nowhere);
    for (uint32_t k = 0; k < 4u; k++) {
        const float size = 0.7f + 0.4f * (float)k, t[3] = {7, 8, -200};
        float m[9];
        rig_rotation(1, 2, 3, 50.0f * (float)k, m);
        for (uint32_t i = 0; i < 9u; i++)
            m[i] *= size;
        const smr_mesh moved = rig_moved(&ball, m, t);
        for (float radius = 8.0f; radius < 100.0f; radius *= 2.0f) {
            const float *ratio = ratios(&ball, radius, moved.xyz, NULL);
            for (uint32_t v = 0; v < ball.n_vertices; v++)
                assert_true(fabsf(ratio[v] / (size * size * size) - 1.0f) < 1.0e-3f);
        }
    }
}

/* Of one vertex' cluster, in double: six volumes about the middle, two areas, and the length of the normals' sum. */
static void bulk(const smr_mesh *mesh, const float *at, uint32_t vertex, double radius, double out[3])
{
    double sum[8] = {0};
    for (uint32_t k = 0; k < mesh->n_triangles; k++)
        for (uint32_t c = 0; c < 3u; c++) { /* a third for each corner in the cluster */
            const uint32_t *t = mesh->triangles + 3u * k;
            double p[3][3], n[3], away = 0.0, area = 0.0;
            for (uint32_t a = 0; a < 3u; a++) {
                const double d = (double)mesh->xyz[3u * t[c] + a] - (double)mesh->xyz[3u * vertex + a];
                away += d * d;
                for (uint32_t i = 0; i < 3u; i++)
                    p[i][a] = (double)at[3u * t[i] + a];
            }
            if (away > radius * radius)
                continue;
            for (uint32_t a = 0; a < 3u; a++) {
                const uint32_t b = (a + 1u) % 3u, e = (a + 2u) % 3u;
                n[a] = ((p[1][b] - p[0][b]) * (p[2][e] - p[0][e]) - (p[1][e] - p[0][e]) * (p[2][b] - p[0][b])) / 3.0;
                area += n[a] * n[a];
            }
            area = sqrt(area);
            for (uint32_t a = 0; a < 3u; a++) {
                sum[0] += p[0][a] * n[a];
                sum[1u + a] += n[a];
                sum[4u + a] += area * (p[0][a] + p[1][a] + p[2][a]) / 3.0;
            }
            sum[7] += area;
        }
    out[0] = sum[0] - (sum[1] * sum[4] + sum[2] * sum[5] + sum[3] * sum[6]) / sum[7];
    out[1] = sum[7];
    out[2] = sqrt(sum[1] * sum[1] + sum[2] * sum[2] + sum[3] * sum[3]);
}

/* The layer is as thick as the whole is large. */
static double wanted(const smr_mesh *mesh, const float *xyz, uint32_t vertex, float radius, double scale)
{
    double now[3], rest[3];
    bulk(mesh, xyz, vertex, (double)radius, now);
    bulk(mesh, mesh->xyz, vertex, (double)radius, rest);
    const double open = rest[2] / rest[1], layer = sqrt(rest[1]) * (0.001 + open * open);
    return (now[0] + scale * layer * now[1]) / (fabs(rest[0]) + layer * rest[1]);
}

TEST(test_equals_double)
{
    const float odd = 16.37f, large = 33.11f; /* between all distances of vertices: shares of the boundary are 1 */
    const smr_mesh ball = rig_ball(30, 9, 12, nowhere);
    float *bent = rig_alloc(3u * ball.n_vertices * sizeof *bent);
    for (uint32_t v = 0; v < ball.n_vertices; v++) {
        const float z = ball.xyz[3u * v + 2u] - nowhere[2];
        bent[3u * v] = ball.xyz[3u * v] + 0.015f * z * z;
        bent[3u * v + 1u] = ball.xyz[3u * v + 1u];
        bent[3u * v + 2u] = nowhere[2] + z * (1.0f + 0.01f * z);
    }
    for (uint32_t k = 0; k < 2u; k++) {
        const float radius = k ? large : odd;
        double scale = 0.0;
        const float *ratio = ratios(&ball, radius, bent, &scale);
        float lo = 1.0f, hi = 1.0f;
        for (uint32_t v = 0; v < ball.n_vertices; v++) {
            assert_true(fabs((double)ratio[v] - wanted(&ball, bent, v, radius, scale)) < 1.0e-3);
            lo = fminf(lo, ratio[v]);
            hi = fmaxf(hi, ratio[v]);
        }
        assert_true(lo < 0.95f && hi > 1.15f);
    }
}

/* A sheet that is stretched along x and bent: the change is that of its area. Points without triangles: the whole's. */
TEST(test_sheets_and_points)
{
    enum { N = 15, CELLS = (N - 1) * (N - 1) };
    static float flat[3 * N * N], to[3 * N * N];
    static uint32_t triangle[2 * CELLS][3];
    for (uint32_t i = 0; i < N * N; i++) {
        const float x = 4.0f * (float)(i % N), z = 4.0f * (float)(i / N);
        const float p[3] = {x, 0, z}, q[3] = {1.5f * x, 60.0f * sinf(z / 60.0f), 60.0f * cosf(z / 60.0f)};
        memcpy(flat + 3u * i, p, sizeof p);
        memcpy(to + 3u * i, q, sizeof q);
    }
    for (uint32_t k = 0; k < 2u * CELLS; k++) {
        const uint32_t a = k / 2u / (N - 1u) * N + k / 2u % (N - 1u);
        const uint32_t t[3] = {k % 2u ? a + N + 1u : a, k % 2u ? a + N : a + 1u, k % 2u ? a + 1u : a + N};
        memcpy(triangle[k], t, sizeof t);
    }
    const smr_mesh sheet = {flat, &triangle[0][0], N * N, 2u * CELLS}, points = {flat, NULL, N * N, 0};
    double scale = 0.0;
    const float *ratio = ratios(&sheet, 20, to, &scale);
    for (uint32_t v = 0; v < N * N; v++)
        assert_true(fabs((double)ratio[v] / (1.5 * scale) - 1.0) < 0.06);
    ratio = ratios(&points, 20, to, NULL);
    for (uint32_t v = 0; v < N * N; v++)
        assert_true(ratio[v] == ratio[0] && ratio[v] > 1.0f && ratio[v] < 2.5f);
}

/* A body whose triangles face inwards has the ratios of the same body the right way round; one that a mirror has turned
 * has lost all of its volume, and more. */
TEST(test_inside_out)
{
    smr_mesh ball = rig_ball(30, 9, 12, nowhere);
    const float m[9] = {1.2f, 0, 0, 0, 1.1f, 0, 0, 0, 0.9f}, t[3] = {5, 0, 1}, mirror[9] = {-1, 0, 0, 0, 1, 0, 0, 0, 1};
    const smr_mesh moved = rig_moved(&ball, m, t), other = rig_moved(&ball, mirror, t);
    const float *right = ratios(&ball, 20, moved.xyz, NULL), *lost = ratios(&ball, 100, other.xyz, NULL);
    uint32_t *turned = rig_alloc(3u * sizeof *turned * ball.n_triangles);
    for (uint32_t i = 0; i < 3u * ball.n_triangles; i++)
        turned[i] = ball.triangles[3u * (i / 3u) + 2u - i % 3u];
    ball.triangles = turned;
    const float *inward = ratios(&ball, 20, moved.xyz, NULL), *gone = ratios(&ball, 100, other.xyz, NULL);
    for (uint32_t v = 0; v < ball.n_vertices; v++) {
        assert_true(fabsf(inward[v] - right[v]) < 1.0e-4f && right[v] > 1.0f);
        assert_true(lost[v] < -0.5f && fabsf(gone[v] - lost[v]) < 1.0e-4f);
    }
}

/* Ratios beyond 10^6 are that, with their sign. */
TEST(test_limit)
{
    const smr_mesh ball = rig_ball(30, 9, 12, nowhere);
    for (uint32_t k = 0; k < 2u; k++) {
        const float to = k == 0u ? 110.0f : -110.0f, m[9] = {to, 0, 0, 0, 110, 0, 0, 0, 110},
                    t[3] = {-40 * to, 33000, -13200};
        const float *ratio = ratios(&ball, 100, rig_moved(&ball, m, t).xyz, NULL);
        for (uint32_t v = 0; v < ball.n_vertices; v++)
            assert_true(k == 0u ? ratio[v] == 1.0e6f : ratio[v] < -1.0e4f && ratio[v] >= -1.0e6f);
    }
}

/* Nothing is made worse by asking between any two iterations, by any radius; and mistakes are refused. */
TEST(test_asking)
{
    const float off[3] = {44, -297, 118};
    const smr_mesh ball = rig_ball(30, 9, 12, nowhere), goal = rig_ball(35, 12, 16, off);
    const smr_surface *target = rig_surface(&goal);
    smr *s = start(&ball, 24), *twin = start(&ball, 24);
    float ratio[512], first[512];
    assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, target));
    assert_int_equal(SMR_OK, smr_set_surface(twin, SMR_ALL, target));
    for (uint32_t tick = 0; tick < 20u; tick++) {
        assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
        assert_int_equal(SMR_OK, smr_tick(twin, 0, NULL));
        assert_int_equal(SMR_OK, smr_get_local_volume(s, tick % 2u ? SMR_ALL : 0u, (float)(tick * 3u), ratio));
        assert_true(smr_state_hash(s) == smr_state_hash(twin));
    }
    assert_int_equal(SMR_OK, smr_get_local_volume(s, 0, 24, ratio));
    assert_int_equal(SMR_OK, smr_get_local_volume(twin, SMR_ALL, 24, first));
    assert_memory_equal(ratio, first, ball.n_vertices * sizeof *ratio);
    assert_int_equal(SMR_E_NULL, smr_get_local_volume(NULL, 0, 0, ratio));
    assert_int_equal(SMR_E_NULL, smr_get_local_volume(s, 0, 0, NULL));
    assert_int_equal(SMR_E_INPUT, smr_get_local_volume(s, 1, 0, ratio));
    const float bad[] = {-1.0f, NAN, INFINITY, 2.0f * SMR_COORD_MAX};
    for (uint32_t i = 0; i < 4u; i++)
        assert_int_equal(SMR_E_INPUT, smr_get_local_volume(s, 0, bad[i], ratio));
    twin->next_task = 1; /* an iteration is under way */
    smr_guard_close(twin);
    assert_int_equal(SMR_E_STATE, smr_get_local_volume(twin, 0, 0, ratio));
}
