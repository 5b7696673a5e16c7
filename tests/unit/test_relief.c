/* test_relief.c: the relief of a mesh depends on shape alone, and leads ridges onto ridges.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include "geometry/surface/surface.h"
#include "model/model.h"
#include "unit_exercise.h"

/* A ball of 40 mm with smooth hills, as large as `scale`, turned by this angle about z. */
static unit_mesh hilly(uint32_t levels, float scale, float degrees)
{
    unit_mesh m = unit_sphere(levels, 40, 0);
    float turn[9];
    rig_rotation(0, 0, 1, degrees, turn);
    for (uint32_t v = 0; v < m.nv; v++) {
        const smr_vec u = smr_scale(smr_get3(m.xyz, v), 1.0f / 40.0f);
        const float hill = sinf(4.0f * u.x + 1.0f) * sinf(5.0f * u.y) + 0.6f * sinf(6.0f * u.z + 2.0f * u.x);
        const smr_vec p = smr_scale(u, scale * (40.0f + 4.0f * hill));
        smr_put3(m.xyz, v, smr_v(turn[0] * p.x + turn[1] * p.y, turn[3] * p.x + turn[4] * p.y, p.z));
    }
    return m;
}

/* Vertices of a coarse sphere are the first ones of a finer sphere. */
static float apart(const smr_surface *a, const smr_surface *b)
{
    float sum = 0.0f;
    for (uint32_t v = 0; v < a->n_vertices; v++)
        sum += fabsf(a->relief[v] - b->relief[v]);
    return sum / (float)a->n_vertices;
}

TEST(relief_depends_on_shape_alone)
{
    const unit_mesh m[] = {hilly(4, 1, 0), hilly(4, 8, 0), hilly(4, 1, 77), hilly(5, 1, 0), hilly(6, 1, 0)};
    smr_surface *s[5];
    float least = 0.0f, most = 0.0f, far = 0.0f;
    for (uint32_t i = 0; i < 5u; i++)
        assert_non_null((s[i] = unit_surface(&m[i]))->relief);
    for (uint32_t v = 0; v < m[0].nv; v++) {
        least = fminf(least, s[0]->relief[v]);
        most = fmaxf(most, s[0]->relief[v]);
    }
    assert_true(least > -1.0f && least < -0.6f && most < 1.0f && most > 0.6f);
    assert_true(apart(s[0], s[1]) < 1.0e-5f && apart(s[0], s[2]) < 1.0e-3f);
    assert_true((far = apart(s[0], s[3])) < 0.03f && apart(s[3], s[4]) < 0.03f);
    assert_true(far > 0.0f);
}

/* What is left of a ball is its triangulation, of a plane its rounding. */
TEST(balls_and_planes_have_none)
{
    static const float nowhere[3] = {0, 0, 0};
    const unit_mesh ball = unit_sphere(5, 30, 7);
    unit_mesh plane = unit_grid(30, 20, 1);
    const smr_mesh globe = rig_ball(30, 40, 60, nowhere); /* with fans at the poles */
    for (uint32_t v = 0; v < plane.nv; v++)
        plane.xyz[3u * v + 2u] = 0.3f * plane.xyz[3u * v];
    assert_null(unit_surface(&ball)->relief);
    assert_null(unit_surface(&plane)->relief);
    assert_null(rig_surface(&globe)->relief);
}

/* Ridges are above 0, hollows below. */
TEST(ridges_are_above_0)
{
    unit_mesh grid = unit_grid(40, 40, 1);
    for (uint32_t v = 0; v < grid.nv; v++)
        grid.xyz[3u * v + 2u] = 2.0f * cosf(0.3f * grid.xyz[3u * v]);
    const smr_surface *s = unit_surface(&grid);
    for (uint32_t v = 0; v < grid.nv; v++) {
        const float x = grid.xyz[3u * v], y = grid.xyz[3u * v + 1u], height = grid.xyz[3u * v + 2u];
        if (x > 6.0f && x < 34.0f && y > 6.0f && y < 34.0f && fabsf(height) > 1.9f)
            assert_true(s->relief[v] * height * s->normal[3u * v + 2u] > 0.4f);
    }
}

TEST(who_has_none)
{
    unit_mesh noisy = hilly(4, 1, 0), two = unit_mesh_new(2u * noisy.nv, 2u * noisy.nt);
    for (uint32_t i = 0; i < 2u; i++) {
        for (uint32_t k = 0; k < 3u * noisy.nv; k++)
            two.xyz[3u * i * noisy.nv + k] = noisy.xyz[k] + 100.0f * (float)i;
        for (uint32_t k = 0; k < 3u * noisy.nt; k++)
            two.triangles[3u * i * noisy.nt + k] = noisy.triangles[k] + i * noisy.nv;
    }
    assert_non_null(unit_surface(&noisy)->relief);
    assert_null(unit_surface(&two)->relief); /* the mean of two bodies is none's */
    oracle_random r = oracle_seed(1);
    for (uint32_t k = 0; k < 3u * noisy.nv; k++)
        noisy.xyz[k] += oracle_uniformf(&r, -2, 2);
    assert_null(unit_surface(&noisy)->relief);
    unit_mesh many = unit_mesh_new(4u * 300u, 4u * 300u); /* so many bodies that none is a large one */
    static const uint32_t corner[12] = {0, 1, 2, 0, 2, 3, 0, 3, 1, 1, 3, 2};
    for (uint32_t i = 0; i < 300u; i++)
        for (uint32_t k = 0; k < 12u; k++) {
            many.xyz[12u * i + k] = (float)(k * k % 7u) + 20.0f * (float)(k % 3u == 0u ? i : 0u);
            many.triangles[12u * i + k] = 4u * i + corner[k];
        }
    assert_null(unit_surface(&many)->relief);
}

/* A model holds what a surface of each structure would have; a structure without triangles has none. */
TEST(models_hold_it)
{
    unit_mesh hills = hilly(3, 1, 0), larger = hilly(4, 2, 30);
    oracle_random r = oracle_seed(2);
    unit_mesh points = unit_points(&r, 30, 0, 20);
    const smr_structure three[] = {
        {"hills", unit_view(&hills)}, {"points", unit_view(&points)}, {"larger", unit_view(&larger)}};
    const smr_prepare_config usual = smr_prepare_config_default();
    const unit_image image = unit_prepare(three, 3, &usual);
    const smr_stored_section *section = smr_model_section(image.model, SMR_SECTION_RELIEF);
    assert_non_null(section);
    assert_int_equal(smr_le32(section->bytes), 2u * (hills.nv + points.nv + larger.nv));
    const uint16_t *const relief = smr_at(image.model, section->at);
    const float *of[] = {unit_surface(&hills)->relief, NULL, unit_surface(&larger)->relief};
    for (uint32_t i = 0, at = 0; i < 3u; at += three[i++].mesh.n_vertices)
        for (uint32_t v = 0; v < three[i].mesh.n_vertices; v++) {
            const int stored = (int16_t)smr_le16(relief[smr_model_position(image.model, at + v)]);
            assert_true(of[i] == NULL ? stored == SMR_RELIEF_NONE
                                      : fabsf((float)stored - SMR_RELIEF_ONE * of[i][v]) < 1.0f);
        }
    const unit_image cloud = unit_prepare(&three[1], 1, &usual);
    assert_null(smr_model_section(cloud.model, SMR_SECTION_RELIEF));
}

/* Registers hills onto hills turned by 6 degrees, or onto their inside. Returns how far vertices are from where they
 * belong, mm in the mean. */
static float slipped(const smr_model *model, float curvature, int inside, uint64_t *hash)
{
    const unit_mesh from = hilly(4, 1, 0), where = hilly(4, 1, 6);
    unit_mesh onto = hilly(5, 1, 6);
    smr_config config = smr_config_default();
    config.basic.n_target_vertices = onto.nv;
    config.forces.curvature = curvature;
    config.forces.normal_deg = inside ? 180.0f : config.forces.normal_deg;
    for (uint32_t k = 0; k < onto.nt && inside; k++) {
        const uint32_t last = onto.triangles[3u * k + 2u];
        onto.triangles[3u * k + 2u] = onto.triangles[3u * k + 1u];
        onto.triangles[3u * k + 1u] = last;
    }
    smr *s = rig_init(model, &config, NULL);
    assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, unit_surface(&onto)));
    (void)rig_run(s, 1000);
    const float *x = rig_positions(s, model);
    float sum = 0.0f;
    for (uint32_t v = 0; v < from.nv; v++)
        sum += smr_length(smr_sub(smr_get3(x, v), smr_get3(where.xyz, v)));
    *hash = smr_state_hash(s);
    return sum / (float)from.nv;
}

/* A refit moves ridges and measures none: the surface has no relief from then on. */
TEST(refitted_surfaces_have_none)
{
    const unit_mesh from = hilly(4, 1, 0), turned = hilly(4, 1, 90);
    smr_surface *s = unit_surface(&from);
    assert_non_null(s->relief);
    assert_int_equal(SMR_OK, smr_surface_refit(s, turned.xyz));
    assert_int_equal(SMR_OK, smr_surface_step(s, 0, NULL, 0));
    assert_null(s->relief);
}

TEST(ridges_go_onto_ridges)
{
    const unit_mesh from = hilly(4, 1, 0);
    const smr_prepare_config usual = smr_prepare_config_default();
    const unit_image image = unit_prepare_mesh(&from, &usual);
    uint64_t hash, other;
    const float without = slipped(image.model, 0.0f, 0, &hash);
    assert_true(slipped(image.model, 0.05f, 0, &hash) < 0.95f * without);
    assert_true(slipped(image.model, 0.3f, 0, &other) < 0.5f * without && other != hash);
    /* the inside of a surface bulges the other way: no vertex follows it */
    assert_true(slipped(image.model, 0.3f, 1, &hash) == slipped(image.model, 0.0f, 1, &hash));
    smr_model *head = image.bytes; /* as models were before: without the section */
    head->n_sections = head->at_sections = 0;
    unit_repair(image.bytes, image.size);
    assert_true(slipped(image.model, 0.3f, 0, &hash) == without);
}
