/* test_surface.c: target surfaces: sizes and refusals; closest points with normals and search distance against a
 * search of all triangles in double precision (2e-5 mm on a mesh of 100 mm); borders of open meshes.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include <string.h>
#include "geometry/surface/surface_sweep.h"
#include "unit_mesh.h"

TEST(refuses_and_leaves_alone)
{
    unit_mesh m = unit_grid(5, 4, 2.0f);
    smr_mesh v = unit_view(&m);
    size_t bytes = 0;
    assert_int_equal(smr_surface_bytes(m.nv, m.nt, &bytes), SMR_OK);
    unsigned char *memory = rig_rough(bytes + SMR_ALIGN);
    smr_surface mark, *s = &mark;
    assert_int_equal(smr_surface_build(&v, NULL, bytes, &s), SMR_E_NULL);
    assert_int_equal(smr_surface_build(NULL, memory, bytes, &s), SMR_E_NULL);
    assert_int_equal(smr_surface_build(&v, memory, bytes, NULL), SMR_E_NULL);
    for (size_t off = 1; off < SMR_ALIGN; off++)
        assert_int_equal(smr_surface_build(&v, memory + off, bytes, &s), SMR_E_ALIGN);
    assert_int_equal(smr_surface_build(&v, memory, bytes - 1u, &s), SMR_E_ARENA);
    assert_int_equal(smr_surface_build(&v, memory, 0, &s), SMR_E_ARENA);
    v.n_triangles = 0;
    assert_int_equal(smr_surface_build(&v, memory, bytes, &s), SMR_E_INPUT);
    v = unit_view(&m);
    v.triangles = NULL;
    assert_int_equal(smr_surface_build(&v, memory, bytes, &s), SMR_E_NULL);
    v = unit_view(&m);
    v.n_vertices = 0;
    assert_int_equal(smr_surface_build(&v, memory, bytes, &s), SMR_E_INPUT);
    v.n_vertices = m.nv - 1u; /* the last corner is out of range now */
    assert_int_equal(smr_surface_build(&v, memory, bytes, &s), SMR_E_INPUT);
    v = unit_view(&m);
    m.xyz[17] = NAN;
    assert_int_equal(smr_surface_build(&v, memory, bytes, &s), SMR_E_INPUT);
    m.xyz[17] = 1e30f;
    assert_int_equal(smr_surface_build(&v, memory, bytes, &s), SMR_E_INPUT);
    assert_ptr_equal(s, &mark);
    for (size_t i = 0; i < bytes; i++) /* no refused call wrote anything */
        assert_int_equal(memory[i], 0xa5);
    m.xyz[17] = 1.0f;
    assert_int_equal(smr_surface_build(&v, memory, bytes, &s), SMR_OK);
    assert_int_equal(smr_surface_build(&v, memory, bytes, &s), SMR_OK); /* the same memory again */
}

TEST(sizes)
{
    size_t bytes = 77;
    assert_int_equal(smr_surface_bytes(0, 1, &bytes), SMR_E_INPUT);
    assert_int_equal(smr_surface_bytes(3, 0, &bytes), SMR_E_INPUT);
    assert_int_equal(smr_surface_bytes(SMR_VERTICES_MAX + 1u, 1, &bytes), SMR_E_INPUT);
    assert_int_equal(smr_surface_bytes(3, SMR_TRIANGLES_MAX + 1u, &bytes), SMR_E_INPUT);
    assert_int_equal(smr_surface_bytes(3, 1, NULL), SMR_E_NULL);
    assert_int_equal(bytes, 77);
    assert_int_equal(smr_surface_bytes(SMR_VERTICES_MAX, SMR_TRIANGLES_MAX, &bytes), SMR_OK);
    assert_true(bytes > (size_t)400u << 20);
    for (uint32_t nt = 1; nt < 70u; nt++) { /* the mesh may go, odd sizes fit exactly */
        oracle_random r = oracle_seed(nt);
        unit_mesh m = unit_soup(&r, nt, 9.0f, (int)(nt % 2u));
        smr_surface *s = unit_surface(&m);
        unit_mesh_free(&m);
        smr_closest hit;
        const float p[3] = {20, 20, 20};
        assert_int_equal(smr_surface_closest(s, p, NULL, 0, 1e5f, &hit), SMR_OK);
        assert_true(hit.triangle < nt && hit.distance > 10.0f);
        rig_free(s);
    }
}

TEST(query_refusals)
{
    static const float bad[] = {NAN, INFINITY, -INFINITY, 1.1e5f, -1e30f};
    unit_mesh m = unit_grid(2, 2, 2.0f);
    smr_surface *s = unit_surface(&m);
    float p[3] = {1, 1, 1}, n[3] = {0, 0, 1};
    smr_closest mark;
    memset(&mark, 0x77, sizeof mark);
    smr_closest hit = mark;
    assert_int_equal(smr_surface_closest(NULL, p, NULL, 0, 1, &hit), SMR_E_NULL);
    assert_int_equal(smr_surface_closest(s, NULL, NULL, 0, 1, &hit), SMR_E_NULL);
    assert_int_equal(smr_surface_closest(s, p, NULL, 0, 1, NULL), SMR_E_NULL);
    for (size_t k = 0; k < sizeof bad / sizeof bad[0]; k++) {
        for (int c = 0; c < 3; c++) {
            const float was = p[c], turn = n[c];
            p[c] = bad[k];
            assert_int_equal(smr_surface_closest(s, p, NULL, 0, 1, &hit), SMR_E_INPUT);
            p[c] = was;
            n[c] = bad[k];
            assert_int_equal(smr_surface_closest(s, p, n, 0, 1, &hit), SMR_E_INPUT);
            n[c] = turn;
        }
        assert_int_equal(smr_surface_closest(s, p, n, bad[k], 1, &hit), SMR_E_INPUT);
    }
    assert_int_equal(smr_surface_closest(s, p, NULL, 0, NAN, &hit), SMR_E_INPUT);
    assert_int_equal(smr_surface_closest(s, p, NULL, 0, -1.0f, &hit), SMR_E_INPUT);
    assert_memory_equal(&hit, &mark, sizeof hit);
    assert_int_equal(smr_surface_closest(s, p, NULL, NAN, INFINITY, &hit), SMR_OK); /* min_cos unused, any reach */
    assert_true(hit.triangle != SMR_NONE);
    smr_surface *nothing = rig_rough(sizeof *nothing);
    memset(nothing, 0, sizeof *nothing);
    assert_int_equal(smr_surface_closest(nothing, p, NULL, 0, 1, &hit), SMR_E_STATE);
}

static void corners(const unit_mesh *m, uint32_t k, double c[9])
{
    for (uint32_t j = 0; j < 9u; j++)
        c[j] = (double)m->xyz[3u * (size_t)m->triangles[3u * (size_t)k + j / 3u] + j % 3u];
}

static double cosine(const double c[9], const float n[3])
{
    const double u[3] = {c[3] - c[0], c[4] - c[1], c[5] - c[2]}, v[3] = {c[6] - c[0], c[7] - c[1], c[8] - c[2]};
    const double x = u[1] * v[2] - u[2] * v[1], y = u[2] * v[0] - u[0] * v[2], z = u[0] * v[1] - u[1] * v[0];
    return (x * (double)n[0] + y * (double)n[1] + z * (double)n[2]) / sqrt(x * x + y * y + z * z);
}

/* Of neighbours on a path and of points far apart, with the bits of single searches. */
TEST(distances_are_those_of_single_searches)
{
    oracle_random r = oracle_seed(102);
    unit_mesh m = unit_sphere(4, 50.0f, 3.0f);
    smr_surface *s = unit_surface(&m);
    float p[999][3], mm[999];
    for (uint32_t i = 0; i < 999u; i++) {
        oracle_within_box(&r, -80, 120, p[i]);
        for (uint32_t c = 0; c < 3u && i > 0u && i < 700u; c++)
            p[i][c] = p[i - 1u][c] + 0.02f * (p[i][c] - p[i - 1u][c]);
    }
    assert_int_equal(smr_surface_distances(s, p[0], 999, mm), SMR_OK);
    for (uint32_t i = 0; i < 999u; i++) {
        smr_closest hit;
        assert_int_equal(smr_surface_closest(s, p[i], NULL, 0, 1e5f, &hit), SMR_OK);
        assert_memory_equal(&mm[i], &hit.distance, sizeof mm[i]);
    }
    assert_int_equal(smr_surface_distances(NULL, p[0], 1, mm), SMR_E_NULL);
    assert_int_equal(smr_surface_distances(s, p[0], 1, NULL), SMR_E_NULL);
    p[1][2] = NAN;
    assert_int_equal(smr_surface_distances(s, p[0], 2, mm), SMR_E_INPUT);
    rig_free(s);
    unit_mesh_free(&m);
}

/* With and without a normal, with every kind of reach. */
TEST(equals_double)
{
    oracle_random r = oracle_seed(101);
    double worst = 0.0;
    for (uint32_t round = 0; round < 2u; round++) {
        unit_mesh m = round ? unit_grid(17, 16, 6.0f) : unit_sphere(3, 50.0f, 0.0f);
        smr_surface *s = unit_surface(&m);
        for (uint32_t i = 0; i < 700u; i++) {
            float p[3];
            oracle_within_box(&r, -80, 120, p);
            double turn[9], c[9], want = HUGE_VAL, near_edge = HUGE_VAL;
            const double q[3] = {(double)p[0], (double)p[1], (double)p[2]};
            oracle_rotation(&r, turn);
            const float n[3] = {(float)turn[0], (float)turn[1], (float)turn[2]};
            const float min_cos = oracle_uniformf(&r, -0.5f, 0.9f), reach = i % 4u ? 300.0f : 20.0f;
            const int any = i % 3u == 0u;
            for (uint32_t k = 0; k < m.nt; k++) {
                corners(&m, k, c);
                const double agree = any ? 2.0 : cosine(c, n) - (double)min_cos;
                if (agree < 0.0)
                    continue;
                want = fmin(want, sqrt(oracle_triangle(q, c, c + 3, c + 6)));
                near_edge = fmin(near_edge, agree);
            }
            smr_closest hit;
            assert_int_equal(smr_surface_closest(s, p, any ? NULL : n, min_cos, reach, &hit), SMR_OK);
            if (near_edge < 1e-5 || fabs(want - (double)reach) < 1e-3)
                continue; /* too near a decision for floats */
            if (want > (double)reach) {
                assert_int_equal(hit.triangle, SMR_NONE);
                continue;
            }
            assert_true(hit.triangle < m.nt);
            worst = fmax(worst, fabs((double)hit.distance - want));
            corners(&m, hit.triangle, c); /* the caller's index and the caller's weights */
            assert_true(any || cosine(c, n) >= (double)min_cos - 1e-6);
            assert_true(cosine(c, hit.normal) > 0.99999);
            double d2 = 0.0;
            for (int k = 0; k < 3; k++) {
                const double at =
                    c[k] * (double)hit.weight[0] + c[3 + k] * (double)hit.weight[1] + c[6 + k] * (double)hit.weight[2];
                worst = fmax(worst, fabs(at - (double)hit.point[k]));
                d2 += ((double)hit.point[k] - q[k]) * ((double)hit.point[k] - q[k]);
            }
            worst = fmax(worst, fabs(sqrt(d2) - want));
        }
        rig_free(s);
        unit_mesh_free(&m);
    }
    assert_true(oracle_within("surface: closest point, mm", worst, 2e-5));
}

/* Border bits against a count over all triangles, on tangled soups: an edge with one triangle only. */
TEST(border_bits_against_a_count)
{
    oracle_random r = oracle_seed(103);
    for (uint32_t round = 0; round < 12u; round++) {
        unit_mesh m = round % 3u ? unit_soup(&r, 1u + oracle_below(&r, 120u), 9.0f, 1) : unit_grid(1u + round, 3, 1.0f);
        smr_surface *s = unit_surface(&m);
        for (uint32_t k = 0; k < m.nt; k++) {
            const uint32_t *t = s->triangle + 3u * (size_t)k;
            assert_memory_equal(t, m.triangles + 3u * (size_t)s->original[k], 12u);
            for (uint32_t e = 0; e < 3u; e++) {
                uint32_t count = 0;
                const uint32_t a = t[e], b = t[(e + 1u) % 3u];
                if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0])
                    continue; /* what an edge of such a triangle is, nobody says */
                for (uint32_t j = 0; j < m.nt; j++) {
                    const uint32_t *o = m.triangles + 3u * (size_t)j;
                    count += (o[0] == a || o[1] == a || o[2] == a) && (o[0] == b || o[1] == b || o[2] == b);
                }
                assert_int_equal((uint32_t)s->border[k] >> e & 1u, count == 1u);
            }
        }
        rig_free(s);
        unit_mesh_free(&m);
    }
}

/* The constant for static storage is never too small, and close for surfaces of a usual size. */
TEST(the_macro_bounds_the_size)
{
    static const uint32_t vertices[] = {1, 3, 100, 3000, 40000, SMR_VERTICES_MAX};
    for (size_t i = 0; i < sizeof vertices / sizeof vertices[0]; i++) {
        for (uint32_t nt = 1; nt < SMR_TRIANGLES_MAX / 2u; nt = nt + nt / 3u + 1u) {
            size_t bytes = 0;
            assert_int_equal(smr_surface_bytes(vertices[i], nt, &bytes), SMR_OK);
            const size_t bound = SMR_SURFACE_BYTES(vertices[i], nt);
            if (bytes > bound || (nt >= 1000u && (double)bound > 1.03 * (double)bytes))
                fail_msg("%u vertices, %u triangles: %zu bytes, bound %zu", vertices[i], nt, bytes, bound);
        }
        for (uint32_t nt = SMR_TRIANGLES_MAX; nt > SMR_TRIANGLES_MAX - 600u; nt--) {
            size_t bytes = 0;
            assert_int_equal(smr_surface_bytes(vertices[i], nt, &bytes), SMR_OK);
            assert_true(bytes <= SMR_SURFACE_BYTES(vertices[i], nt));
        }
    }
}

/* Boxes, each from x, y, z to x, y, z, as one mesh. */
static smr_mesh boxes(const float (*box)[6], uint32_t n)
{
    static const uint32_t face[36] = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                                      2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
    float *xyz = rig_alloc(96u * n);
    uint32_t *t = rig_alloc(144u * n);
    for (uint32_t i = 0; i < 24u * n; i++)
        xyz[i] = box[i / 24u][i % 3u + (i / 3u >> i % 3u & 1u) * 3u];
    for (uint32_t i = 0; i < 36u * n; i++)
        t[i] = face[i % 36u] + 8u * (i / 36u);
    return (smr_mesh){xyz, t, 8u * n, 12u * n};
}

/* Low boxes between towers reach up to no box that hangs over all. What lies far within a box that is inside out is not
 * deep in it. */
TEST(contact_of_boxes)
{
    static const float over[6] = {0, 0, 10, 10, 20, 50};
    static const float large[6] = {-50, -50, -50, 50, 50, 50}, small[6] = {-1, -1, -1, 1, 1, 1};
    float town[10][6];
    for (uint32_t i = 0; i < 10u; i++) {
        const float one[6] = {0, 2.0f * (float)i, 0, 10, 2.0f * (float)i + 1.9f, i % 2u ? 5.0f : 40.0f};
        memcpy(town[i], one, sizeof one);
    }
    const smr_mesh a = boxes((const float(*)[6])town, 10), b = boxes(&over, 1), in = boxes(&small, 1);
    smr_mesh out = boxes(&large, 1);
    smr_contact_report r;
    for (uint32_t k = 0; k < 2u; k++) {
        const smr_surface *const one = rig_surface(k ? &b : &a), *const other = rig_surface(k ? &a : &b);
        assert_int_equal(SMR_OK, smr_surface_contact(one, other, 0.1f, &r));
        assert_true(fabsf(r.volume_mm3 - 2850.0f) < 90.0f);
    }
    uint32_t *const t = rig_alloc(144);
    for (uint32_t i = 0; i < 36u; i++)
        t[i] = out.triangles[i - i % 3u + (3u - i % 3u) % 3u];
    for (uint32_t k = 0; k < 2u; k++) {
        assert_int_equal(SMR_OK, smr_surface_contact(rig_surface(&in), rig_surface(&out), 0.1f, &r));
        assert_true(fabsf(r.volume_mm3 - 8.0f) < 0.1f && fabsf(r.deepest_mm - (k ? 0.0f : 49.0f)) < 0.1f);
        out.triangles = t;
    }
}

/* A ball of four leaves beside a body of one takes a unit for each leaf, for four places of each triangle that a leaf
 * has room for, for three vertices, and for five steps between: none for a leaf behind the last. */
TEST(contact_in_units)
{
    static const float corner[4][3] = {{10.05f, 0, 0}, {20, 9, 0}, {20, -9, 9}, {20, -9, -9}};
    static const uint32_t face[4][3] = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}};
    const unit_mesh ball = unit_sphere(1, 10.0f, 0.0f);
    const smr_mesh a = unit_view(&ball), b = {corner[0], face[0], 4, 4};
    const uint32_t units = 5u + 4u * 8u * 5u + (6u + 2u) + 5u;
    smr_contact_report r;
    smr_job job;
    assert_true(a.n_vertices == 18u && a.n_triangles == 32u);
    assert_int_equal(SMR_OK, smr_surface_contact_begin(rig_surface(&a), rig_surface(&b), 0.1f, &r, &job));
    assert_int_equal(SMR_PARTIAL, smr_job_step(&job, units - 1u, NULL, 0));
    assert_int_equal(SMR_OK, smr_job_step(&job, 1, NULL, 0));
}

/* A triangle within a box, from a place that is said to be far from the box, and from one of unknown distance. */
TEST(sweep_from_an_unknown_place)
{
    static const float large[6] = {-50, -50, -50, 50, 50, 50}, small[6] = {-1, -1, -1, 1, 1, 1};
    const smr_mesh in = boxes(&small, 1), out = boxes(&large, 1);
    const smr_surface *const a = rig_surface(&in), *const b = rig_surface(&out);
    const smr_sweep_found none = {smr_sweep_no_box, 0.0f, 0.0f};
    const smr_sweep s = {a, b, smr_sub(b->origin, a->origin), smr_sweep_box(b), 0.1f, none};
    for (uint32_t k = 0; k < 2u; k++) {
        smr_sweep_place last = {smr_v(0, 0, 0), k ? SMR_FAR : 99.0f, SMR_NONE, 0};
        smr_sweep_found found = none;
        const float third = smr_sweep_triangle(&s, 0, &last, &found).third;
        assert_true(k ? fabsf(third - 2.0f / 3.0f) < 1.0e-4f && fabsf(last.side + 49.0f) < 1.0e-3f : third == 0.0f);
    }
}

/* A needle from the middle of one of two boxes is as deep as its tip. Its corner beyond the boxes, in front of one
 * between them, tells nothing about that one. */
TEST(contact_of_a_needle)
{
    static const float two[2][6] = {{0, 0, 0, 100, 100, 100}, {400, 400, 400, 500, 500, 500}};
    static const float corner[4][3] = {{50, 50, 50}, {250, -10, 50}, {250, 10, 50}, {250, 0, 60}};
    static const uint32_t face[4][3] = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}};
    const smr_mesh needle = {corner[0], face[0], 4, 4}, both = boxes(two, 2);
    smr_contact_report r;
    assert_int_equal(SMR_OK, smr_surface_contact(rig_surface(&needle), rig_surface(&both), 0.1f, &r));
    assert_true(fabsf(r.a_in_b_mm - 50.0f) < 1.0e-3f && r.deepest_mm == r.a_in_b_mm);
}
