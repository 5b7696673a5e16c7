/* test_init.c: a registration's counts agree with model and port, and the configuration is copied.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include <string.h>
#include "registration/registration.h"

static const float none[3] = {0, 0, 0};

typedef struct slot {
    const void *at;
    size_t bytes;
} slot;

TEST(test_counts_and_parts)
{
    const float off[3] = {50, 0, 0};
    const smr_mesh mesh[3] = {
        rig_ball(20, 6, 30, none), rig_ball(20, 3, 5, off), {rig_ball(9, 2, 4, none).xyz, NULL, 10, 0}};
    const smr_prepare_config radii = rig_radii(2, 15, 8, 0);
    const smr_model *model = rig_model(mesh, 3, &radii);
    const smr_config config = smr_config_default();
    const smr *s = rig_init(model, &config, NULL);
    uint32_t vertices = 0, triangles = 0, leaves = 0;
    for (uint32_t i = 0; i < 3u; i++) {
        const smr_shape_structure *part = &s->shape.structure[i];
        assert_int_equal(vertices, part->first_vertex);
        assert_int_equal(triangles, part->first_triangle);
        assert_int_equal(leaves, part->first_leaf);
        assert_int_equal(mesh[i].n_vertices, part->n_vertices);
        assert_int_equal(mesh[i].n_triangles, part->tree.n_triangles);
        assert_null(s->forces.surface.target[i].surface);
        vertices += mesh[i].n_vertices;
        triangles += mesh[i].n_triangles;
        leaves += (mesh[i].n_triangles + SMR_TREE_WIDTH - 1u) / SMR_TREE_WIDTH;
    }
    assert_int_equal(vertices, s->shared.n);
    assert_int_equal(triangles, s->shared.n_triangles);
    assert_int_equal((vertices + SMR_CHUNK - 1u) / SMR_CHUNK, s->shared.n_tasks);
    for (size_t i = 0; i < 3u * (size_t)s->shared.n_triangles; i++)
        assert_true(s->shared.triangle[i] < s->shared.n);
}

TEST(test_copies)
{
    const smr_mesh mesh = rig_ball(20, 6, 9, none);
    const smr_prepare_config radii = rig_radii(1, 15, 0, 0);
    smr_config config = smr_config_default();
    smr_port port = rig_port(RIG_REVERSE, 3);
    config.basic.n_workers = 4;
    config.forces.normal_deg = 60.0f;
    smr *s = rig_init(rig_model(&mesh, 1, &radii), &config, &port);
    memset(&config, 0xff, sizeof config); /* both were copied */
    memset(&port, 0xff, sizeof port);
    assert_int_equal(4, s->shared.config.basic.n_workers);
    assert_int_equal(3, s->port.n_workers);
    assert_true(fabsf(s->shared.min_cos - 0.5f) < 1.0e-5f);
    assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
    assert_int_equal(SMR_OK, smr_tick(s, 1000, NULL)); /* no clock: the budget means nothing */
}

/* With a model that a fault changed after it was opened, so that a structure's triangles seem to end before them,
 * smr_init() ends all the same. */
TEST(test_faulty_owner)
{
    const float off[3] = {50, 0, 0};
    const smr_mesh mesh[2] = {rig_ball(20, 6, 9, none), rig_ball(20, 6, 9, off)};
    const smr_model *model = rig_model(mesh, 2, NULL);
    const smr_config config = smr_config_default();
    const smr *s = rig_init(model, &config, NULL);
    uint16_t *const owner = (uint16_t *)(uintptr_t)smr_at(model, model->at_owner);
    const uint32_t v = smr_model_triangle(&s->shared, mesh[0].n_triangles)[0];
    assert_int_equal(1, smr_model_owner(model, v));
    owner[v] = 0;
    assert_non_null(rig_init(model, &config, NULL));
}
