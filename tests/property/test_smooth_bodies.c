/* test_smooth_bodies.c: bodies on which next to nothing tells one place from another. A part of a ball, a rod, a disc
 * or a bean is seen: what normals do not tell stays as the start has it, the rest is found, and nothing swings or
 * drifts away. Open sheets, of which borders alone tell the size: they keep to those.
 * Accuracy: of vertices to their true places, in mm, below.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include <string.h>
#include "rig_parts.h"

#define FARTHER 1.25f        /* than the start, at most: a rod may turn about its axis */
#define BODIES_MM 2.3f       /* in the mean over all views */
#define EXPECTED_LEAST 0.45f /* of what vertices are off: their expected errors, in the mean */
#define GROWS 1.5f           /* expected errors from one part of a cut rod to the next, farther from what is seen */
#define ON_SHAFT 0.35f       /* expected error across a visible shaft over that along it, at most */
#define SHEETS_MM 4.5f       /* each */

enum { RINGS = 22, AROUND = 32, GRID = 25 };

static const float nowhere[3] = {0, 0, 0};

typedef struct body {
    const char *name;
    float size[3]; /* mm, half */
    float power;   /* of its surface: 2 is an ellipsoid, more is boxier */
    float bend;    /* mm that its ends are off the x axis */
} body;

static const body bodies[] = {{"ball", {50, 50, 50}, 2, 0},
                              {"ellipsoid", {70, 45, 30}, 2, 0},
                              {"rod", {120, 15, 15}, 4, 0},
                              {"disc", {50, 50, 12}, 4, 0},
                              {"bean", {60, 30, 30}, 2, 18}};

/* The body, with the poles of its grid along x, y or z. */
static smr_mesh body_mesh(const body *b, uint32_t rings, uint32_t around, uint32_t axis)
{
    const smr_mesh ball = rig_ball(1.0f, rings, around, nowhere);
    float *xyz = rig_alloc(12u * (size_t)ball.n_vertices);
    for (uint32_t v = 0; v < ball.n_vertices; v++) {
        float sum = 0.0f, u[3];
        for (uint32_t c = 0; c < 3u; c++) {
            u[c] = ball.xyz[3u * v + (c + axis) % 3u];
            sum += powf(fabsf(u[c]) / b->size[c], b->power);
        }
        for (uint32_t c = 0; c < 3u; c++)
            xyz[3u * v + c] = u[c] * powf(sum, -1.0f / b->power);
        xyz[3u * v + 1u] += b->bend * (xyz[3u * v] / b->size[0]) * (xyz[3u * v] / b->size[0]);
    }
    return (smr_mesh){xyz, ball.triangles, ball.n_vertices, ball.n_triangles};
}

/* Smooth displacements of some 5 mm. */
static void bend(float *xyz, uint32_t n)
{
    static const float centre[3][3] = {{40, 20, 30}, {-50, -20, 10}, {0, 40, -40}};
    static const float way[3][3] = {{3, -4, 2}, {-2, 3, 4}, {4, 2, -3}};
    for (uint32_t v = 0; v < n; v++) {
        float *x = xyz + 3u * (size_t)v, d[3] = {0, 0, 0};
        for (uint32_t k = 0; k < 3u; k++) {
            float r2 = 0.0f;
            for (uint32_t c = 0; c < 3u; c++)
                r2 += (x[c] - centre[k][c]) * (x[c] - centre[k][c]);
            for (uint32_t c = 0; c < 3u; c++)
                d[c] += way[k][c] * expf(-r2 / (2.0f * 70.0f * 70.0f));
        }
        for (uint32_t c = 0; c < 3u; c++)
            x[c] += d[c];
    }
}

/* Registers with the defaults from where they are: the mean distance of vertices to their true places. */
static float registered(const smr_mesh *mesh, const smr_mesh *target, const float *truth, float *expected)
{
    const smr_model *model = rig_model(mesh, 1, NULL);
    smr_config config = smr_config_default();
    config.basic.n_target_vertices = target->n_vertices;
    smr *s = rig_init(model, &config, NULL);
    assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, rig_surface(target)));
    (void)rig_run(s, 1000);
    if (expected != NULL) {
        float *each = rig_alloc(4u * (size_t)mesh->n_vertices);
        assert_int_equal(SMR_OK, smr_get_expected_error(s, 0, each));
        for (uint32_t v = 0; v < mesh->n_vertices; v++)
            *expected += each[v] / (float)mesh->n_vertices;
    }
    return rig_mean_far(rig_positions(s, model), truth, mesh->n_vertices);
}

/* The mean of values over the vertices whose x lies within low..high, mm. */
static float mean_between(const smr_mesh *mesh, const float *value, float low, float high)
{
    float sum = 0.0f, n = 0.0f;
    for (uint32_t v = 0; v < mesh->n_vertices; v++)
        if (mesh->xyz[3u * v] >= low && mesh->xyz[3u * v] < high) {
            sum += value[v];
            n += 1.0f;
        }
    return sum / n;
}

/* A bent rod of which the half at negative x is seen: the error grows with the distance to that half, and the shaft
 * that is seen may slide along itself, but lies on the target. */
TEST(cut_rod)
{
    const smr_mesh mesh = body_mesh(&bodies[2], RINGS, 2 * AROUND, 2);
    smr_mesh half = body_mesh(&bodies[2], RINGS + 3, 2 * AROUND + 10, 2);
    float *xyz = rig_alloc(12u * (size_t)half.n_vertices), *mm = rig_alloc(12u * (size_t)mesh.n_vertices);
    float *const across = mm + mesh.n_vertices, *const along = across + mesh.n_vertices;
    uint32_t *t = rig_alloc(12u * (size_t)half.n_triangles), n = 0;
    smr_config config = smr_config_default();
    smr_verdict v;
    for (uint32_t i = 0; i < half.n_triangles; i++) {
        const uint32_t *from = half.triangles + 3u * (size_t)i;
        if (half.xyz[3u * from[0]] < 0.0f)
            memcpy(t + 3u * (size_t)n++, from, 12u);
    }
    memcpy(xyz, half.xyz, 12u * (size_t)half.n_vertices);
    bend(xyz, half.n_vertices);
    half = (smr_mesh){xyz, t, half.n_vertices, n};
    config.basic.n_target_vertices = half.n_vertices;
    smr *s = rig_init(rig_model(&mesh, 1, NULL), &config, NULL);
    assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, rig_surface(&half)));
    (void)rig_run(s, 1000);
    assert_int_equal(SMR_OK, smr_get_expected_error(s, 0, mm));
    assert_int_equal(SMR_OK, smr_get_expected_parts(s, 0, across, along));
    assert_int_equal(SMR_OK, smr_get_verdict(s, 0, &v));
    for (uint32_t i = 0; i < mesh.n_vertices; i++)
        assert_float_equal(mm[i] * mm[i], across[i] * across[i] + along[i] * along[i], 1.0e-3f * mm[i] * mm[i]);
    for (uint32_t k = 0; k < 3u; k++) {
        const float *const each = mm + k * mesh.n_vertices;
        assert_true(mean_between(&mesh, each, 90, 121) > GROWS * mean_between(&mesh, each, 30, 60));
        assert_true(mean_between(&mesh, each, 30, 60) > GROWS * mean_between(&mesh, each, -90, -30));
    }
    assert_true(mean_between(&mesh, across, -90, -30) < ON_SHAFT * mean_between(&mesh, along, -90, -30));
    assert_float_equal(v.expected_across_mm, mean_between(&mesh, across, -121, 121), 1.0e-3f);
    assert_float_equal(v.expected_along_mm, mean_between(&mesh, along, -121, 121), 1.0e-3f);
    assert_true(v.expected_visible_mm < v.expected_error_mm);
}

TEST(parts_of_bodies)
{
    static const float towards[3][3] = {{0, 0, 1}, {0.505f, 0.808f, 0.303f}, {0.990f, 0.099f, 0.099f}};
    float sum = 0.0f, expected = 0.0f, n = 0.0f;
    for (uint32_t i = 0; i < sizeof bodies / sizeof bodies[0]; i++) {
        const smr_mesh mesh = body_mesh(&bodies[i], RINGS, AROUND, 0);
        smr_mesh whole = body_mesh(&bodies[i], RINGS + 3, AROUND + 5, 1);
        float *truth = rig_alloc(12u * (size_t)mesh.n_vertices), *xyz = rig_alloc(12u * (size_t)whole.n_vertices);
        memcpy(truth, mesh.xyz, 12u * (size_t)mesh.n_vertices);
        memcpy(xyz, whole.xyz, 12u * (size_t)whole.n_vertices);
        bend(truth, mesh.n_vertices);
        bend(xyz, whole.n_vertices);
        whole.xyz = xyz;
        for (uint32_t k = 0; k < rig_times(3); k++) {
            const smr_mesh part = rig_seen_from(&whole, towards[k]);
            const float start = rig_mean_far(mesh.xyz, truth, mesh.n_vertices),
                        off = registered(&mesh, &part, truth, &expected);
            if (!(off <= FARTHER * start))
                fail_msg("%s, view %u: %g mm off, %g at the start", bodies[i].name, k, (double)off, (double)start);
            sum += off;
            n += 1.0f;
        }
        rig_free_all();
    }
    if (!(sum < BODIES_MM * n && expected > EXPECTED_LEAST * sum) && rig_times(3) == 3u) /* means over all views */
        fail_msg("%g mm off in the mean, expected %g", (double)(sum / n), (double)(expected / n));
}

enum { CAP, CYLINDER, SADDLE, SHEETS };

/* A place of a sheet of some 100 mm that turns by `angle`; larger > 1: of the target, which is bent besides. */
static void sheet_place(uint32_t kind, float angle, float u, float v, float larger, float p[3])
{
    const float more = larger > 1.0f ? 1.0f : 0.0f, r = (kind == CAP ? 50.0f : 40.0f) + 2.0f * more;
    const float across = angle * u, along = angle * v;
    p[0] = r * larger * sinf(across) * (kind == CAP ? cosf(0.7f * along) : 1.0f);
    p[1] = kind == CAP ? r * larger * sinf(along) + 4.0f * more * sinf(3.0f * u) : 100.0f * larger * v;
    p[2] = r * cosf(across) * (kind == CAP ? cosf(along) : 1.0f) + 8.0f * more * v * v;
    if (kind == SADDLE) {
        p[0] = 100.0f * larger * u;
        p[2] = 28.0f * angle * (1.0f + 0.2f * more) * (u * u - v * v) + 12.0f * more * u * v;
    }
}

static smr_mesh sheet(uint32_t kind, float angle, uint32_t n, float larger)
{
    float *xyz = rig_alloc(12u * (size_t)n * n);
    uint32_t *t = rig_alloc(24u * (size_t)n * n), n_triangles = 0;
    for (uint32_t i = 0; i < n * n; i++) {
        const float u = (float)(i % n) / (float)(n - 1u) - 0.5f, v = (float)(i / n) / (float)(n - 1u) - 0.5f;
        sheet_place(kind, angle, u, v, larger, xyz + 3u * (size_t)i);
        if (i % n + 1u == n || i / n + 1u == n)
            continue;
        const uint32_t quad[6] = {i, i + 1u, i + n, i + n + 1u, i + n, i + 1u};
        memcpy(t + 3u * (size_t)n_triangles, quad, sizeof quad);
        n_triangles += 2u;
    }
    return (smr_mesh){xyz, t, n * n, n_triangles};
}

TEST(sheets_keep_to_borders)
{
    static const float degrees[] = {20, 80, 100, 140};
    for (uint32_t k = 0; k < SHEETS * 4u; k += rig_times(20) < 20u ? 3u : 1u) {
        const float angle = degrees[k % 4u] * 0.01745329f;
        const smr_mesh mesh = sheet(k / 4u, angle, GRID, 1.0f), target = sheet(k / 4u, angle, GRID + 6, 1.03f);
        const smr_mesh truth = sheet(k / 4u, angle, GRID, 1.03f);
        const float off = registered(&mesh, &target, truth.xyz, NULL);
        if (!(off < SHEETS_MM))
            fail_msg("sheet %u of %g degrees: %g mm off", k / 4u, (double)degrees[k % 4u], (double)off);
        rig_free_all();
    }
}
