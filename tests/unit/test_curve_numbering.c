/* test_curve_numbering.c: masses, edges and the caller's mesh are recovered from a model. Accuracy against double
 * precision: mean edge 1e-5 relative; positions one unit in the last place of the coordinate; area masses 1/32.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include <string.h>
#include "geometry/box_tree/hilbert_curve.h"
#include "unit_lists.h"

/* What was given comes back: the same triangles, positions to the last digit or the one before. */
TEST(the_callers_mesh_comes_back)
{
    oracle_random r = oracle_seed(161);
    double worst = 0.0;
    for (uint32_t round = 0; round < 8u; round++) {
        unit_mesh m[2] = {unit_soup(&r, 1u + oracle_below(&r, 200u), round % 2u ? 80.0f : 1e5f, 1),
                          unit_grid(7, 5, 3.0f)};
        const smr_structure two[2] = {{"first", unit_view(&m[0])}, {NULL, unit_view(&m[1])}};
        smr_prepare_config c = smr_prepare_config_default();
        c.n_radii = 1;
        c.radius_mm[0] = 10.0f;
        unit_image image = unit_prepare(two, 2, &c);
        for (uint32_t s = 0; s < 2u; s++) {
            smr_structure_info info;
            assert_int_equal(smr_model_structure(image.model, s, &info), SMR_OK);
            assert_string_equal(info.name, s == 0u ? "first" : "");
            assert_int_equal(info.n_vertices, m[s].nv);
            assert_int_equal(info.n_triangles, m[s].nt);
            float *xyz = rig_rough(12u * (size_t)m[s].nv);
            uint32_t *t = rig_rough(12u * (size_t)m[s].nt);
            assert_int_equal(smr_model_mesh(image.model, s, xyz, t), SMR_OK);
            assert_memory_equal(t, m[s].triangles, 12u * (size_t)m[s].nt);
            for (uint32_t i = 0; i < 3u * m[s].nv; i++) {
                const double size = fmax(1.0, fmax(fabs((double)xyz[i]), round % 2u ? 80.0 : 1e5));
                worst = fmax(worst, fabs((double)xyz[i] - (double)m[s].xyz[i]) / size);
            }
            assert_int_equal(smr_model_mesh(image.model, s, NULL, NULL), SMR_OK);
            rig_free(xyz);
            rig_free(t);
        }
        unit_image_free(&image);
        unit_mesh_free(&m[0]);
        unit_mesh_free(&m[1]);
    }
    assert_true(oracle_within("order: positions come back, relative", worst, 1.2e-7));
}

TEST(edges_and_masses)
{
    oracle_random r = oracle_seed(162);
    double worst_edge = 0.0, worst_mass = 0.0;
    for (uint32_t round = 0; round < 6u; round++) {
        unit_mesh m = round % 2u ? unit_grid(13, 9, 3.0f) : unit_sphere(3, 40.0f, -7.0f);
        for (uint32_t i = 0; i < 3u * m.nv; i++)
            m.xyz[i] += oracle_uniformf(&r, -0.5f, 0.5f);
        smr_prepare_config c = smr_prepare_config_default();
        c.mass = round % 3u ? SMR_MASS_AREA : SMR_MASS_UNIT;
        unit_image image = unit_prepare_mesh(&m, &c);
        double sum = 0.0, total = 0.0;
        uint32_t edges = 0;
        double *area = rig_rough(8u * (size_t)m.nv);
        for (uint32_t i = 0; i < m.nv; i++)
            area[i] = 0.0;
        for (uint32_t k = 0; k < m.nt; k++) {
            const uint32_t *t = m.triangles + 3u * k;
            double e[3], half = 0.0;
            for (uint32_t j = 0; j < 3u; j++) {
                double d2 = 0.0;
                for (uint32_t x = 0; x < 3u; x++)
                    d2 += pow((double)m.xyz[3u * t[j] + x] - (double)m.xyz[3u * t[(j + 1u) % 3u] + x], 2.0);
                e[j] = sqrt(d2);
                half += 0.5 * e[j];
                int twin = 0; /* count an edge once, at the first triangle that has it */
                for (uint32_t o = 0; o < 3u * k; o++)
                    twin |= m.triangles[o] == t[(j + 1u) % 3u] && m.triangles[o / 3u * 3u + (o % 3u + 1u) % 3u] == t[j];
                sum += twin ? 0.0 : e[j];
                edges += !twin;
            }
            const double a = sqrt(half * (half - e[0]) * (half - e[1]) * (half - e[2])); /* Heron */
            for (uint32_t j = 0; j < 3u; j++)
                area[t[j]] += a / 3.0;
            total += a;
        }
        worst_edge = fmax(worst_edge, fabs((double)smr_le_float(image.model->edge_mm) / (sum / edges) - 1.0));
        const uint32_t *mass = smr_at(image.model, image.model->at_mass);
        for (uint32_t v = 0; v < m.nv; v++) {
            const double got = (double)smr_le_float(mass[v]);
            assert_true(got * 16.0 == floor(got * 16.0) && got >= 1.0 / 16.0 && got <= 64.0);
            const double want = c.mass == SMR_MASS_UNIT ? 1.0 : area[smr_model_original(image.model, v)] * m.nv / total;
            worst_mass = fmax(worst_mass, fabs(got - fmax(want, 1.0 / 16.0)));
        }
        rig_free(area);
        unit_image_free(&image);
        unit_mesh_free(&m);
    }
    assert_true(oracle_within("order: mean edge, relative", worst_edge, 1e-5));
    assert_true(oracle_within("order: masses", worst_mass, 0.5 / 16.0 + 1e-4));
}

/* Names are cut to what fits, with the closing NUL. */
TEST(long_names_are_cut)
{
    char name[200];
    unit_mesh m = unit_grid(1, 1, 1.0f);
    smr_prepare_config c = smr_prepare_config_default();
    memset(name, 'x', sizeof name);
    for (size_t length = 0; length < sizeof name; length += length < 60u ? 20u : 1u) {
        if (length > 70u)
            length = sizeof name - 1u;
        name[length] = '\0';
        const smr_structure one = {name, unit_view(&m)};
        unit_image image = unit_prepare(&one, 1, &c);
        smr_structure_info info;
        assert_int_equal(smr_model_structure(image.model, 0, &info), SMR_OK);
        assert_int_equal(strlen(info.name), length < SMR_NAME_BYTES ? length : SMR_NAME_BYTES - 1u);
        unit_image_free(&image);
        name[length] = 'x';
    }
}
