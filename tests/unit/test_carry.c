/* test_carry.c: carried points: exact at vertices, exact for similarities, near the truth under a smooth deformation,
 * there and back, the same bits for any order and number of workers; sizes, statuses, degenerate shapes, frames.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include <string.h>
#include "carry/carry.h"
#include "unit_mesh.h"

#define POINTS 300u

typedef struct bound {
    void *memory; /* owned */
    smr_carry *carry;
} bound;

static bound bind_with(const unit_mesh *m, const float *points, uint32_t n, const smr_port *port)
{
    bound b = {NULL, NULL};
    size_t bytes = 0;
    assert_int_equal(smr_carry_bytes(m->nv, n, port != NULL ? port->n_workers : 1u, &bytes), SMR_OK);
    b.memory = rig_rough(bytes);
    assert_int_equal(smr_carry_fit(m->xyz, m->nv, points, n, port, b.memory, bytes, &b.carry), SMR_OK);
    return b;
}

/* A smooth map with a bend of some millimetres. */
static void bend(const float *p, float *q)
{
    q[0] = p[0] + 0.0005f * p[1] * p[1] + 12.0f;
    q[1] = 1.05f * p[1] - 0.00025f * p[0] * p[2];
    q[2] = 0.95f * p[2] + 0.0004f * p[0] * p[1] - 7.0f;
}

/* x' = 1.1 R x + t. */
static void similar(const float *p, float *q)
{
    const float x = p[0], y = p[1];
    q[0] = 1.1f * (0.8f * x - 0.6f * y) + 30.0f;
    q[1] = 1.1f * (0.6f * x + 0.8f * y) - 20.0f;
    q[2] = 1.1f * p[2] + 5.0f;
}

static void map_all(void (*map)(const float *, float *), const float *from, uint32_t n, float *to)
{
    for (uint32_t i = 0; i < n; i++)
        map(from + 3 * i, to + 3 * i);
}

static double farthest(const float *a, const float *b, uint32_t n)
{
    double worst = 0.0;
    for (uint32_t i = 0; i < n; i++) {
        double d2 = 0.0;
        for (uint32_t k = 0; k < 3u; k++)
            d2 += pow((double)a[3 * i + k] - (double)b[3 * i + k], 2);
        worst = fmax(worst, sqrt(d2));
    }
    return worst;
}

static void random_points(oracle_random *r, float half, uint32_t n, float *xyz)
{
    for (uint32_t i = 0; i < 3u * n; i++)
        xyz[i] = oracle_uniformf(r, -half, half);
}

TEST(vertices_are_exact)
{
    unit_mesh m = unit_sphere(4, 40.0f, 0.0f), now = unit_sphere(4, 40.0f, 0.0f);
    bound b = bind_with(&m, m.xyz, m.nv, NULL);
    float *out = rig_rough(12u * m.nv);
    map_all(bend, m.xyz, m.nv, now.xyz);
    assert_int_equal(smr_carry_apply(b.carry, now.xyz, out), SMR_OK);
    assert_true(oracle_within("carry: a vertex", farthest(out, now.xyz, m.nv), 1e-5));
    assert_int_equal(smr_carry_map(b.carry, now.xyz, 0, m.xyz, m.nv, out, NULL), SMR_OK);
    assert_true(oracle_within("carry: a vertex, not bound", farthest(out, now.xyz, m.nv), 1e-5));
}

static void follows(void (*map)(const float *, float *), float half, const char *what, double budget)
{
    oracle_random r = oracle_seed(71);
    unit_mesh m = unit_sphere(4, 40.0f, 0.0f), now = unit_sphere(4, 40.0f, 0.0f);
    float points[3 * POINTS], truth[3 * POINTS], out[3 * POINTS], back[3 * POINTS];
    smr_carry_fact facts[POINTS];
    random_points(&r, half, POINTS, points);
    for (uint32_t i = 0; i < POINTS && half < 40.0f; i++) { /* at most 15 mm under the surface */
        const float length = sqrtf(points[3 * i] * points[3 * i] + points[3 * i + 1] * points[3 * i + 1] +
                                   points[3 * i + 2] * points[3 * i + 2]);
        for (uint32_t k = 0; k < 3u; k++)
            points[3 * i + k] *= oracle_uniformf(&r, 25.0f, 40.0f) / (length + 1.0e-3f);
    }
    bound b = bind_with(&m, points, POINTS, NULL);
    map_all(map, m.xyz, m.nv, now.xyz);
    map_all(map, points, POINTS, truth);
    assert_int_equal(smr_carry_apply(b.carry, now.xyz, out), SMR_OK);
    assert_true(oracle_within(what, farthest(out, truth, POINTS), budget));
    assert_int_equal(smr_carry_map(b.carry, now.xyz, 0, points, POINTS, back, facts), SMR_OK);
    assert_true(oracle_within("carry: bound or not", farthest(out, back, POINTS), 1e-3));
    for (uint32_t i = 0; i < POINTS; i++)
        assert_true(facts[i].volume > 0.1f);
    assert_int_equal(smr_carry_map(b.carry, now.xyz, 1, out, POINTS, back, facts), SMR_OK);
    assert_true(oracle_within("carry: there and back", farthest(points, back, POINTS), 0.01));
    for (uint32_t i = 0; i < POINTS; i++)
        assert_true(facts[i].miss_mm < 0.01f);
    rig_free(b.memory);
    unit_mesh_free(&m);
    unit_mesh_free(&now);
}

TEST(similarities_are_exact) { follows(similar, 400.0f, "carry: a similarity", 2e-3); }

TEST(inside_is_near_the_truth) { follows(bend, 25.0f, "carry: a smooth bend", 1.0); }

/* The volume said is that of the map: compared with differences. */
TEST(volume_is_the_determinant)
{
    oracle_random r = oracle_seed(72);
    unit_mesh m = unit_sphere(4, 40.0f, 0.0f), now = unit_sphere(4, 40.0f, 0.0f);
    bound b = bind_with(&m, NULL, 0, NULL);
    const float h = 0.25f;
    double worst = 0.0;
    map_all(bend, m.xyz, m.nv, now.xyz);
    for (uint32_t i = 0; i < 40u; i++) {
        float p[3], q[18], out[18], at[3];
        double jacobian[9];
        smr_carry_fact fact;
        random_points(&r, 30.0f, 1, p);
        for (uint32_t k = 0; k < 18u; k++)
            q[k] = p[k % 3u] + (k / 6u == k % 3u ? (k / 3u % 2u ? -h : h) : 0.0f);
        assert_int_equal(smr_carry_map(b.carry, now.xyz, 0, q, 6, out, NULL), SMR_OK);
        assert_int_equal(smr_carry_map(b.carry, now.xyz, 0, p, 1, at, &fact), SMR_OK);
        for (uint32_t k = 0; k < 9u; k++)
            jacobian[k] =
                ((double)out[6u * (k % 3u) + k / 3u] - (double)out[6u * (k % 3u) + 3u + k / 3u]) / (2.0 * (double)h);
        worst = fmax(worst, fabs(oracle_determinant(jacobian) - (double)fact.volume));
    }
    assert_true(oracle_within("carry: volume", worst, 0.1));
}

/* Tasks from the last to the first, each on another worker. */
static void backwards(void *ctx, smr_task run, void *arg, uint32_t n_tasks)
{
    (void)ctx;
    for (uint32_t t = n_tasks; t-- > 0u;)
        run(arg, t, t % 3u);
}

/* ctx: the worker's number. */
static void one_worker(void *ctx, smr_task run, void *arg, uint32_t n_tasks)
{
    for (uint32_t t = 0; t < n_tasks; t++)
        run(arg, t, *(const uint32_t *)ctx);
}

TEST(any_order_gives_the_same_bits)
{
    uint32_t worker = 3;
    const smr_port reverse = {NULL, 3, backwards, NULL}, bad = {&worker, 3, one_worker, NULL};
    oracle_random r = oracle_seed(73);
    unit_mesh m = unit_sphere(3, 40.0f, 0.0f), now = unit_sphere(3, 40.0f, 0.0f);
    float points[3 * POINTS], a[3 * POINTS], c[3 * POINTS];
    size_t bytes = 0;
    smr_carry *carry = NULL;
    random_points(&r, 60.0f, POINTS, points);
    map_all(bend, m.xyz, m.nv, now.xyz);
    bound one = bind_with(&m, points, POINTS, NULL), three = bind_with(&m, points, POINTS, &reverse);
    assert_int_equal(smr_carry_apply(one.carry, now.xyz, a), SMR_OK);
    assert_int_equal(smr_carry_apply(three.carry, now.xyz, c), SMR_OK);
    assert_memory_equal(a, c, sizeof a);
    for (uint32_t inverse = 0; inverse < 2u; inverse++) {
        assert_int_equal(smr_carry_map(one.carry, now.xyz, inverse, points, POINTS, a, NULL), SMR_OK);
        assert_int_equal(smr_carry_map(three.carry, now.xyz, inverse, points, POINTS, c, NULL), SMR_OK);
        assert_memory_equal(a, c, sizeof a);
    }
    assert_int_equal(smr_carry_bytes(m.nv, POINTS, 3, &bytes), SMR_OK);
    void *memory = rig_rough(bytes);
    assert_int_equal(smr_carry_fit(m.xyz, m.nv, points, POINTS, &bad, memory, bytes, &carry), SMR_E_STATE);
    assert_null(carry);
    worker = 2;
    assert_int_equal(smr_carry_fit(m.xyz, m.nv, points, POINTS, &bad, memory, bytes, &carry), SMR_OK);
    assert_int_equal(smr_carry_apply(carry, now.xyz, c), SMR_OK);
    worker = 3; /* the port turns bad later */
    assert_int_equal(smr_carry_apply(carry, now.xyz, c), SMR_E_STATE);
    assert_int_equal(smr_carry_map(carry, now.xyz, 0, points, POINTS, c, NULL), SMR_E_STATE);
}

/* A solution changes the right-hand side of a site's vertices, without the first, and nothing behind it, however many
 * vertices there are. */
TEST(solves_within_a_site)
{
    static smr_carry_site s;
    for (s.n = 1; s.n <= SMR_CARRY_NEAR; s.n++) {
        float b[SMR_CARRY_NEAR + 1u];
        s.lower[0] = 7.0f;
        for (uint32_t i = 0; i <= SMR_CARRY_NEAR; i++)
            b[i] = 3.0f;
        for (uint32_t i = 0; i < SMR_CARRY_NEAR; i++)
            s.inverse[i] = 2.0f;
        smr_carry_solve(&s, b);
        for (uint32_t i = 0; i <= SMR_CARRY_NEAR; i++)
            assert_true(b[i] == (i > 0u && i < s.n ? 6.0f : 3.0f));
    }
}

/* Few vertices, all in one place, on a line, far away: finite, and where they should be. */
TEST(degenerate_shapes)
{
    oracle_random r = oracle_seed(74);
    for (uint32_t kind = 0; kind < 4u; kind++)
        for (uint32_t n = 1; n < 130u; n = n * 2u + 1u) {
            unit_mesh m = unit_points(&r, n, kind == 3u ? 9.0e4f : 0.0f, kind == 0u ? 0.0f : 50.0f);
            unit_mesh now = unit_points(&r, n, 0.0f, 50.0f);
            float p[9], out[9];
            smr_carry_fact facts[3];
            for (uint32_t i = 0; i < n && kind == 2u; i++)
                m.xyz[3 * i + 1] = m.xyz[3 * i + 2] = 0.0f;
            random_points(&r, 300.0f, 3, p);
            memcpy(p, m.xyz, 3u * sizeof *p);
            bound b = bind_with(&m, p, 3, NULL);
            assert_int_equal(smr_carry_apply(b.carry, now.xyz, out), SMR_OK);
            assert_true(unit_finite(out, 9, 1.0e6f));
            if (n == 1u)
                assert_true(farthest(out, now.xyz, 1) < 1e-5);
            for (uint32_t inverse = 0; inverse < 2u; inverse++) {
                assert_int_equal(smr_carry_map(b.carry, now.xyz, inverse, p, 3, out, facts), SMR_OK);
                assert_true(unit_finite(out, 9, 1.0e6f));
            }
            rig_free(b.memory);
            unit_mesh_free(&m);
            unit_mesh_free(&now);
        }
}

/* Where vertices went at random the map folds over: the way back may not be found in the steps that there are. */
TEST(crumpled_shapes_stay_finite)
{
    oracle_random r = oracle_seed(44);
    for (uint32_t k = 0; k < 4u; k++) {
        unit_mesh m = unit_sphere(3, 40.0f, 4.0f), now = unit_sphere(3, 40.0f, 4.0f);
        bound b = bind_with(&m, m.xyz, 1, NULL);
        float q[3 * 20], out[3 * 20];
        for (uint32_t i = 0; i < 3u * m.nv; i++)
            now.xyz[i] += oracle_uniformf(&r, -50, 50);
        random_points(&r, 60.0f, 20, q);
        assert_int_equal(smr_carry_map(b.carry, now.xyz, 1, q, 20, out, NULL), SMR_OK);
        assert_true(unit_finite(out, 3u * 20u, 4.0f * SMR_COORD_MAX));
        rig_free(b.memory);
        unit_mesh_free(&m);
        unit_mesh_free(&now);
    }
}

TEST(frames_turn)
{
    unit_mesh m = unit_sphere(4, 40.0f, 0.0f), now = unit_sphere(4, 40.0f, 0.0f);
    const float point[3] = {5.0f, -3.0f, 8.0f}, turned[9] = {0.8f, -0.6f, 0.0f, 0.6f, 0.8f, 0.0f, 0.0f, 0.0f, 1.0f};
    float rest[3 * SMR_FRAME_PLACES], out[3 * SMR_FRAME_PLACES], jacobian[9], normal[3] = {1.0f, 0.0f, 0.0f};
    smr_pose pose;
    map_all(similar, m.xyz, m.nv, now.xyz);
    assert_int_equal(smr_frame_places(point, 1, 10.0f, rest), SMR_OK);
    bound b = bind_with(&m, rest, SMR_FRAME_PLACES, NULL);
    assert_int_equal(smr_carry_apply(b.carry, now.xyz, out), SMR_OK);
    assert_int_equal(smr_frame_poses(rest, out, 1, &pose, jacobian), SMR_OK);
    for (uint32_t i = 0; i < 9u; i++) {
        assert_true(fabsf(pose.m[i / 3u][i % 3u] - turned[i]) < 1e-3f);
        assert_true(fabsf(jacobian[i] - 1.1f * turned[i]) < 1e-3f);
    }
    for (uint32_t k = 0; k < 3u; k++) {
        const float at = pose.m[k][0] * point[0] + pose.m[k][1] * point[1] + pose.m[k][2] * point[2] + pose.m[k][3];
        assert_true(fabsf(at - out[k]) < 1e-3f);
    }
    for (uint32_t i = 0; i < 9u; i++) /* a stretch and a shear: the plane x = 0 holds (1, 1, 0) then */
        jacobian[i] = i == 0u ? 2.0f : (i == 1u || i % 4u == 0u ? 1.0f : 0.0f);
    assert_int_equal(smr_frame_normals(jacobian, normal, 1), SMR_OK);
    assert_true(fabsf(normal[0] - 0.70710678f) < 1e-5f && fabsf(normal[0] + normal[1]) < 1e-5f);
}

TEST(wrong_calls_change_nothing)
{
    unit_mesh m = unit_sphere(2, 40.0f, 0.0f);
    float p[3] = {1.0f, 2.0f, 3.0f}, out[3] = {7.0f, 7.0f, 7.0f};
    const smr_port none = {NULL, 0, NULL, NULL};
    size_t bytes = 0;
    smr_carry *carry = NULL;
    assert_int_equal(smr_carry_bytes(0, 1, 1, &bytes), SMR_E_INPUT);
    assert_int_equal(smr_carry_bytes(1, SMR_VERTICES_MAX + 1u, 1, &bytes), SMR_E_INPUT);
    assert_int_equal(smr_carry_bytes(1, 1, SMR_WORKERS_MAX + 1u, &bytes), SMR_E_INPUT);
    assert_int_equal(smr_carry_bytes(m.nv, 1, 1, NULL), SMR_E_NULL);
    assert_int_equal(smr_carry_bytes(m.nv, 1, 1, &bytes), SMR_OK);
    unsigned char *memory = rig_rough(bytes), *copy = rig_rough(bytes);
    assert_int_equal(smr_carry_fit(m.xyz, m.nv, p, 1, NULL, memory, bytes - 1u, &carry), SMR_E_ARENA);
    assert_int_equal(smr_carry_fit(m.xyz, m.nv, p, 1, NULL, memory + 4, bytes, &carry), SMR_E_ALIGN);
    assert_int_equal(smr_carry_fit(m.xyz, m.nv, p, 1, NULL, NULL, bytes, &carry), SMR_E_NULL);
    assert_int_equal(smr_carry_fit(m.xyz, m.nv, NULL, 1, NULL, memory, bytes, &carry), SMR_E_NULL);
    assert_int_equal(smr_carry_fit(m.xyz, m.nv, p, 1, &none, memory, bytes, &carry), SMR_E_INPUT);
    p[1] = NAN;
    assert_int_equal(smr_carry_fit(m.xyz, m.nv, p, 1, NULL, memory, bytes, &carry), SMR_E_INPUT);
    assert_null(carry);
    p[1] = 2.0f;
    assert_int_equal(smr_carry_fit(m.xyz, m.nv, p, 1, NULL, memory, bytes, &carry), SMR_OK);
    memcpy(copy, memory, sizeof(struct smr_carry)); /* its first slot */
    assert_int_equal(smr_carry_apply((smr_carry *)(void *)copy, m.xyz, out), SMR_E_STATE);
    carry->magic ^= 1u;
    assert_int_equal(smr_carry_apply(carry, m.xyz, out), SMR_E_STATE);
    carry->magic ^= 1u;
    assert_int_equal(smr_carry_apply(carry, NULL, out), SMR_E_NULL);
    assert_int_equal(smr_carry_map(carry, m.xyz, 2, p, 1, out, NULL), SMR_E_INPUT);
    p[0] = 2.0f * SMR_COORD_MAX;
    assert_int_equal(smr_carry_map(carry, m.xyz, 1, p, 1, out, NULL), SMR_E_INPUT);
    assert_int_equal(smr_frame_places(p, 1, 1.0f, out), SMR_E_INPUT);
    m.xyz[5] = INFINITY;
    assert_int_equal(smr_carry_apply(carry, m.xyz, out), SMR_E_INPUT);
    assert_true(out[0] == 7.0f && out[1] == 7.0f && out[2] == 7.0f);
}

/* Of each argument of the calls about frames, a value that is refused. */
TEST(wrong_frames_change_nothing)
{
    unit_mesh m = unit_sphere(2, 40.0f, 0.0f);
    const bound b = bind_with(&m, m.xyz, 4, NULL);
    float p[3] = {1.0f, 2.0f, 3.0f}, rest[3 * SMR_FRAME_PLACES], now[3 * SMR_FRAME_PLACES], j[9], n[3] = {0, 0, 1};
    static const float sizes[] = {0.0f, -1.0f, NAN, 2.0f * SMR_COORD_MAX};
    smr_pose pose;
    for (uint32_t i = 0; i < 4u; i++)
        assert_int_equal(smr_frame_places(p, 1, sizes[i], rest), SMR_E_INPUT);
    assert_int_equal(smr_frame_places(NULL, 1, 1, rest), SMR_E_NULL);
    assert_int_equal(smr_frame_places(p, 1, 1, NULL), SMR_E_NULL);
    assert_int_equal(smr_frame_places(p, SMR_VERTICES_MAX + 1u, 1, rest), SMR_E_INPUT);
    assert_int_equal(smr_frame_places(p, 1, 1, rest), SMR_OK);
    memcpy(now, rest, sizeof now);
    assert_int_equal(smr_frame_poses(NULL, now, 1, &pose, j), SMR_E_NULL);
    assert_int_equal(smr_frame_poses(rest, NULL, 1, &pose, j), SMR_E_NULL);
    assert_int_equal(smr_frame_poses(rest, now, 1, NULL, NULL), SMR_E_NULL);
    assert_int_equal(smr_frame_poses(rest, now, SMR_VERTICES_MAX + 1u, &pose, j), SMR_E_INPUT);
    now[7] = NAN;
    assert_int_equal(smr_frame_poses(rest, now, 1, &pose, j), SMR_E_INPUT);
    assert_int_equal(smr_frame_poses(now, rest, 1, &pose, j), SMR_E_INPUT);
    assert_int_equal(smr_frame_poses(rest, rest, 1, &pose, NULL), SMR_OK);
    assert_int_equal(smr_frame_poses(rest, rest, 1, NULL, j), SMR_OK);
    for (uint32_t i = 0; i < 9u; i++) /* nothing has moved */
        assert_true(fabsf(j[i] - (i % 4u == 0u ? 1.0f : 0.0f)) < 1e-5f && fabsf(pose.m[i / 3u][i % 3u] - j[i]) < 1e-5f);
    memset(rest, 0, sizeof rest);
    assert_int_equal(smr_frame_poses(rest, rest, 1, &pose, j), SMR_OK); /* a frame without a size maps all to nothing */
    assert_true(j[0] == 0.0f && j[4] == 0.0f && pose.m[0][0] == 1.0f);
    assert_int_equal(smr_frame_normals(NULL, n, 1), SMR_E_NULL);
    assert_int_equal(smr_frame_normals(j, NULL, 1), SMR_E_NULL);
    j[8] = NAN;
    assert_int_equal(smr_frame_normals(j, n, 1), SMR_E_INPUT);
    j[8] = 1.0f;
    n[0] = 2.0e6f;
    assert_int_equal(smr_frame_normals(j, n, 1), SMR_E_INPUT);
    assert_int_equal(smr_carry_map(b.carry, m.xyz, 0, NULL, 1, p, NULL), SMR_E_NULL);
    assert_int_equal(smr_carry_map(b.carry, m.xyz, 0, p, 1, NULL, NULL), SMR_E_NULL);
    assert_int_equal(smr_carry_map(b.carry, m.xyz, 0, NULL, 0, NULL, NULL), SMR_OK); /* of no point */
    assert_int_equal(smr_carry_map(NULL, m.xyz, 0, p, 1, p, NULL), SMR_E_NULL);
    assert_int_equal(smr_carry_map(b.carry, m.xyz, 0, p, SMR_VERTICES_MAX + 1u, p, NULL), SMR_E_INPUT);
    assert_int_equal(smr_carry_apply(b.carry, m.xyz, NULL), SMR_E_NULL);
    assert_true(p[0] == 1.0f && p[1] == 2.0f && p[2] == 3.0f);
}

/* docs/SPEC.md, section 3. */
TEST(memory_is_as_stated)
{
    size_t one = 0, vertices = 0, points = 0, workers = 0;
    assert_int_equal(smr_carry_bytes(100000, 0, 1, &one), SMR_OK);
    assert_int_equal(smr_carry_bytes(200000, 0, 1, &vertices), SMR_OK);
    assert_int_equal(smr_carry_bytes(100000, 1000, 1, &points), SMR_OK);
    assert_int_equal(smr_carry_bytes(100000, 0, 2, &workers), SMR_OK);
    assert_true(fabs((double)(vertices - one) / 1.0e5 - 31.9) < 0.1);
    assert_true(fabs((double)(points - one) / 1.0e3 - 432.0) < 1.0);
    assert_int_equal(workers - one, 13312);
}
