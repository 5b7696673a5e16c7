/* test_cluster_radii.c: the radii chosen when the caller names none run from coarse to fine, from within the model's
 * size to its edge length, and scale with the model. No tuned value is tested.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include <string.h>
#include "model/model.h"
#include "property/rig_ball_image.h"
#include "unit_mesh.h"

static smr_model_info info_of(const unit_mesh *m)
{
    const smr_prepare_config c = smr_prepare_config_default();
    unit_image image = unit_prepare_mesh(m, &c);
    smr_model_info info;
    assert_int_equal(smr_model_get_info(image.model, &info), SMR_OK);
    unit_image_free(&image);
    return info;
}

static double diagonal(const unit_mesh *m)
{
    double d2 = 0.0;
    for (uint32_t c = 0; c < 3u; c++) {
        double lo = HUGE_VAL, hi = -HUGE_VAL;
        for (uint32_t i = 0; i < m->nv; i++) {
            lo = fmin(lo, (double)m->xyz[3u * i + c]);
            hi = fmax(hi, (double)m->xyz[3u * i + c]);
        }
        d2 += (hi - lo) * (hi - lo);
    }
    return sqrt(d2);
}

static void check(const unit_mesh *m, const smr_model_info *info)
{
    assert_in_range(info->n_radii, 1, SMR_RADII_MAX);
    for (uint32_t k = 0; k < info->n_radii; k++) {
        assert_true(info->radius_mm[k] > 0.0f && info->radius_mm[k] <= SMR_COORD_MAX);
        assert_true(k == 0u || info->radius_mm[k] < info->radius_mm[k - 1u]);
    }
    if (m->nv > 1u && diagonal(m) > 0.01)
        assert_true((double)info->radius_mm[0] < diagonal(m));
    if (info->edge_mm > 0.0f && info->n_radii > 2u)
        assert_true(info->radius_mm[info->n_radii - 1u] < 4.0f * info->edge_mm ||
                    (double)info->radius_mm[info->n_radii - 1u] < 0.01 * diagonal(m));
}

TEST(models_of_every_kind)
{
    oracle_random r = oracle_seed(180);
    unit_mesh m[11] = {unit_bone(0),
                       unit_sphere(0, 1.0f, 0.0f),
                       unit_sphere(4, 60000.0f, 0.0f),
                       unit_grid(1, 1, 0.01f),
                       unit_grid(30, 30, 2.0f),
                       unit_soup(&r, 300, 100.0f, 0),
                       unit_points(&r, 1, 5.0f, 1.0f),
                       unit_points(&r, 2, 5.0f, 1e-4f),
                       unit_points(&r, 500, 5.0f, 100.0f),
                       unit_points(&r, 30, 0.0f, 0.0f),
                       unit_points(&r, 2000, 0.001f, 0.0f)};
    m[10].xyz[0] = 90000.0f; /* all in one place but one: clusters hold as many, however small the radius */
    for (size_t i = 0; i < sizeof m / sizeof m[0]; i++) {
        const smr_model_info info = info_of(&m[i]);
        check(&m[i], &info);
        unit_mesh_free(&m[i]);
    }
}

TEST(scale_and_place_do_not_matter)
{
    unit_mesh m = unit_bone(0);
    const smr_model_info was = info_of(&m);
    for (int i = 0; i < 3; i++) {
        const float scale = i == 0 ? 0.03125f : (i == 1 ? 8.0f : 1.0f), shift = i == 2 ? 512.0f : 0.0f;
        unit_mesh other = unit_mesh_new(m.nv, m.nt);
        memcpy(other.triangles, m.triangles, 12u * (size_t)m.nt);
        for (uint32_t k = 0; k < 3u * m.nv; k++)
            other.xyz[k] = m.xyz[k] * scale + shift;
        const smr_model_info now = info_of(&other);
        check(&other, &now);
        assert_int_equal(now.n_radii, was.n_radii);
        for (uint32_t k = 0; k < was.n_radii; k++)
            assert_true(fabsf(now.radius_mm[k] / (scale * was.radius_mm[k]) - 1.0f) < 2e-3f);
        unit_mesh_free(&other);
    }
}

/* n points along a line of this length: no triangles. */
static unit_mesh rod(uint32_t n, float length)
{
    unit_mesh m = unit_mesh_new(n, 0);
    for (uint32_t i = 0; i < n; i++) {
        m.xyz[3u * i] = m.xyz[3u * i + 1u] = 0.0f;
        m.xyz[3u * i + 2u] = length * ((float)i / (float)(n - 1u) - 0.5f);
    }
    return m;
}

/* In an image one long structure gets radii of its length and a third of it before those that all models have. */
TEST(images_have_radii_of_the_whole)
{
    const smr_volume reference = rig_ball_image(RIG_BALL_MM, rig_nowhere);
    static const float length[] = {30, 150, 450};
    uint32_t n[3][2];
    for (uint32_t k = 0; k < 3u; k++)
        for (uint32_t more = 0; more < 2u; more++) {
            unit_mesh m = rod(60, length[k]);
            const smr_structure parts[2] = {{"one", unit_view(&m)}, {"two", unit_view(&m)}};
            smr_prepare_config c = smr_prepare_config_default();
            smr_model_info info;
            c.reference = &reference;
            unit_image image = unit_prepare(parts, 1u + more, &c);
            assert_int_equal(smr_model_get_info(image.model, &info), SMR_OK);
            n[k][more] = info.n_radii;
            assert_true(more == 1u || k == 0u || fabsf(info.radius_mm[0] / length[k] - 1.0f) < 0.05f);
            assert_true(more == 1u || k < 2u || fabsf(info.radius_mm[1] / length[k] - 1.0f / 3.0f) < 0.02f);
            unit_image_free(&image);
            unit_mesh_free(&m);
        }
    assert_true(n[0][0] == n[0][1] && n[1][1] == n[0][1] && n[2][1] == n[0][1]);
    assert_true(n[1][0] == n[0][0] + 1u && n[2][0] == n[0][0] + 2u);
}

/* What scratch memory holds beforehand does not matter: models of few points are the same, bit by bit. */
TEST(scratch_does_not_matter)
{
    static _Alignas(SMR_ALIGN) unsigned char model[2][1u << 16];
    const smr_prepare_config c = smr_prepare_config_default();
    for (uint32_t n = 2; n < 40u; n++) {
        unit_mesh m = rod(n, 300);
        const smr_structure one = {"rod", unit_view(&m)};
        size_t bytes[2], room;
        assert_int_equal(SMR_OK, smr_prepare_bytes(&one, 1, &c, &room));
        for (uint32_t k = 0; k < 2u; k++) {
            void *const scratch = rig_rough(room);
            memset(scratch, k ? 0x4b : 0, room); /* 0, or floats of 13 million */
            assert_int_equal(SMR_OK, smr_prepare(&one, 1, &c, scratch, room, model[k], sizeof model[k], &bytes[k]));
            rig_free(scratch);
        }
        assert_int_equal(bytes[0], bytes[1]);
        assert_memory_equal(model[0], model[1], bytes[0]);
        unit_mesh_free(&m);
    }
}

/* Of a dense model the coarsest clusters are smaller. */
TEST(clusters_have_a_limit)
{
    unit_mesh thin = rod(800, 300), dense = rod(5000, 300);
    const smr_model_info few = info_of(&thin), many = info_of(&dense);
    assert_true(few.radius_mm[0] > 70.0f && few.radius_mm[0] < 80.0f);
    assert_in_range(many.largest_cluster[0], 1300, 1800);
    assert_true(many.radius_mm[0] < 55.0f);
}

/* The radii of a dense structure are those of a thinner one, and clusters hold no more vertices. */
TEST(density_does_not_matter)
{
    unit_mesh thin = unit_sphere(5, 60.0f, 0.0f), dense = unit_sphere(6, 60.0f, 0.0f);
    const smr_model_info few = info_of(&thin), many = info_of(&dense);
    assert_true(fabsf(many.radius_mm[0] / few.radius_mm[0] - 1.0f) < 0.1f);
    assert_true(many.largest_cluster[0] < few.largest_cluster[0] * 3u / 2u);
    unit_mesh_free(&thin);
    unit_mesh_free(&dense);
}

/* Points that crowd in a corner, and a triangle with edges of this length: clusters of coarse radii hold some vertices
 * alone, up to the last radius but one, or up to one that needs more vertices. */
TEST(coarse_clusters_of_crowded_points)
{
    for (uint32_t k = 0; k < 2u; k++) {
        oracle_random r = oracle_seed(181);
        unit_mesh m = unit_mesh_new(8100, 1);
        const smr_prepare_config c = smr_prepare_config_default();
        for (uint32_t i = 0; i < 3u * m.nv; i++)
            m.xyz[i] = i < 9u ? (i == 3u || i == 7u ? (k ? 4.0f : 0.3f) : 0.0f)
                              : 100.0f * (float)pow(oracle_uniform(&r, 0, 1), 8.0);
        for (uint32_t i = 0; i < 3u; i++)
            m.triangles[i] = i;
        unit_image image = unit_prepare_mesh(&m, &c);
        const smr_model *const model = image.model;
        const uint32_t n = smr_le32(model->n_radii), coarse = smr_le32(model->coarse_radii);
        const uint32_t members = smr_le32(model->coarse_vertices);
        assert_true(coarse > 0u && smr_le32(smr_model_radius(model, coarse - 1u)->active_min) <= members);
        assert_true(k == 1u ? coarse == n - 1u
                            : coarse < n - 1u && smr_le32(smr_model_radius(model, coarse)->active_min) > members);
        unit_image_free(&image);
        unit_mesh_free(&m);
    }
}
