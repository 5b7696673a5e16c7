/* test_fold_hinges.c: hinges are exactly the edges with two triangles, except those folded flat back at rest.
 * SPDX-License-Identifier: MIT */
#include "cmocka_first.h"

#include <math.h>
#include <string.h>

#include "unit_lists.h"

static void unit_normal(const float *xyz, const uint32_t *t, double n[3])
{
    double u[3], v[3];
    for (int c = 0; c < 3; c++) {
        u[c] = (double)xyz[3u * t[1] + (uint32_t)c] - (double)xyz[3u * t[0] + (uint32_t)c];
        v[c] = (double)xyz[3u * t[2] + (uint32_t)c] - (double)xyz[3u * t[0] + (uint32_t)c];
    }
    for (int c = 0; c < 3; c++)
        n[c] = u[(c + 1) % 3] * v[(c + 2) % 3] - u[(c + 2) % 3] * v[(c + 1) % 3];
    const double l = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (int c = 0; c < 3; c++)
        n[c] = l > 0.0 ? n[c] / l : 0.0;
}

/* want[a * nt + b]: edges that triangles a < b have and nobody else, counted as often as triangles name them. */
static void shared_edges(const uint32_t *t, uint32_t nt, uint32_t *want)
{
    memset(want, 0, 4u * (size_t)nt * nt);
    for (uint32_t i = 0; i < 3u * nt; i++) {
        const uint32_t v = t[i], w = t[i / 3u * 3u + (i % 3u + 1u) % 3u];
        uint32_t count = 0, first = SMR_NONE, other = 0;
        for (uint32_t k = 0; k < 3u * nt; k++) {
            const uint32_t x = t[k], y = t[k / 3u * 3u + (k % 3u + 1u) % 3u];
            if ((x == v && y == w) || (x == w && y == v)) {
                count++;
                first = first == SMR_NONE ? k : first;
                other = k / 3u;
            }
        }
        if (v != w && count == 2u && first == i && other != i / 3u)
            want[i / 3u * nt + other]++;
    }
}

/* Hinges are those edges, but for triangles turned back on each other at rest. Returns the number of hinges. */
static uint32_t check(const unit_mesh *mesh)
{
    smr_prepare_config c = smr_prepare_config_default();
    c.n_radii = 1;
    c.radius_mm[0] = 5.0f;
    unit_image image = unit_prepare_mesh(mesh, &c);
    const smr_model *m = image.model;
    const uint32_t nt = smr_le32(m->n_triangles), n = smr_le32(m->n_dihedrals);
    const smr_stored_dihedral *h = smr_at(m, m->at_dihedrals);
    uint32_t *t = unit_memory(12u * (size_t)nt), *want = unit_memory(4u * (size_t)nt * nt);
    uint32_t *got = unit_memory(4u * (size_t)nt * nt);
    for (uint32_t i = 0; i < 3u * nt; i++)
        t[i] = smr_le32(((const uint32_t *)smr_at(m, m->at_triangles))[i]);
    float *xyz = unit_stored(m);
    shared_edges(t, nt, want);
    memset(got, 0, 4u * (size_t)nt * nt);
    for (uint32_t i = 0; i < n; i++) {
        const uint32_t a = smr_le32(h[i].first), b = smr_le32(h[i].bend) & SMR_DIHEDRAL_MASK;
        assert_true(a < nt && b < nt && a != b);
        got[(a < b ? a : b) * nt + (a < b ? b : a)]++;
        double na[3], nb[3];
        unit_normal(xyz, t + 3u * (size_t)a, na);
        unit_normal(xyz, t + 3u * (size_t)b, nb);
        const double rest = na[0] * nb[0] + na[1] * nb[1] + na[2] * nb[2];
        const double limit = (double)smr_dihedral_limit(smr_le32(h[i].bend));
        assert_true(limit <= rest + 1e-6 && limit >= -1.0); /* at rest nothing counts as bent */
    }
    for (uint32_t a = 0; a < nt; a++) {
        for (uint32_t b = a; b < nt; b++) {
            double na[3], nb[3];
            unit_normal(xyz, t + 3u * (size_t)a, na);
            unit_normal(xyz, t + 3u * (size_t)b, nb);
            const double rest = na[0] * nb[0] + na[1] * nb[1] + na[2] * nb[2];
            if (got[a * nt + b] != 0u || rest >= 0.0)
                assert_int_equal(got[a * nt + b], want[a * nt + b]);
        }
    }
    unit_free(t);
    unit_free(xyz);
    unit_free(want);
    unit_free(got);
    unit_image_free(&image);
    return n;
}

static void surfaces(void **state)
{
    unit_mesh ball = unit_sphere(3, 20.0f, 4.0f), grid = unit_grid(9, 6, 2.0f);
    (void)state;
    for (uint32_t i = 0; i < grid.nv; i++)
        grid.xyz[3u * i + 2u] = 0.0f;
    assert_int_equal(check(&ball), 3u * ball.nt / 2u);              /* closed: every edge */
    assert_int_equal(check(&grid), (3u * grid.nt - 2u * 15u) / 2u); /* all but the boundary */
    unit_mesh_free(&ball);
    unit_mesh_free(&grid);
}

static void tangles(void **state)
{
    oracle_random r = oracle_seed(170);
    (void)state;
    for (uint32_t i = 0; i < 40u; i++) {
        unit_mesh m = unit_soup(&r, 1u + oracle_below(&r, 60u), 30.0f, 1);
        for (uint32_t k = 0; k < 3u * m.nt; k++) /* few vertices: many edges meet, some three times and more */
            m.triangles[k] %= 4u + m.nv / 3u;
        (void)check(&m);
        unit_mesh_free(&m);
    }
}

/* A triangle that names a vertex twice has the same edge twice: that is no hinge. */
static void a_triangle_is_no_hinge_with_itself(void **state)
{
    static const uint32_t t[3][3] = {{0, 1, 1}, {0, 0, 1}, {1, 0, 1}};
    (void)state;
    for (int i = 0; i < 3; i++) {
        unit_mesh m = unit_mesh_new(2, 1);
        const float xyz[6] = {0, 0, 0, 3, 2, 1};
        memcpy(m.xyz, xyz, sizeof xyz);
        memcpy(m.triangles, t[i], sizeof t[i]);
        assert_int_equal(check(&m), 0);
        unit_mesh_free(&m);
    }
}

/* A book with its covers flat on each other is not guarded, one with three pages has no hinge. */
static void books(void **state)
{
    unit_mesh m = unit_mesh_new(5, 3);
    const float xyz[15] = {0, 0, 0, 0, 10, 0, 5, 5, 0, 5, 5, 0.1f, -5, 5, 0};
    const uint32_t t[9] = {0, 1, 2, 1, 0, 3, 0, 1, 4};
    (void)state;
    memcpy(m.xyz, xyz, sizeof xyz);
    memcpy(m.triangles, t, sizeof t);
    assert_int_equal(check(&m), 0);
    m.nt = 2;
    assert_int_equal(check(&m), 0);
    memcpy(m.xyz + 9, xyz + 12, 3u * sizeof(float)); /* open flat */
    assert_int_equal(check(&m), 1);
    unit_mesh_free(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(surfaces),
        cmocka_unit_test(tangles),
        cmocka_unit_test(a_triangle_is_no_hinge_with_itself),
        cmocka_unit_test(books),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
