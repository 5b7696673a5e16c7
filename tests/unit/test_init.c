/* test_init.c: the arena's slots are aligned, do not overlap, lie within it, and agree with model and port.
 * SPDX-License-Identifier: MIT */
#include "cmocka_first.h"

#include <math.h>
#include <string.h>

#include "property/rig.h"
#include "registration/registration.h"

static int tidy(void **state)
{
    (void)state;
    rig_free_all();
    return 0;
}

static const float none[3] = {0, 0, 0};

typedef struct slot {
    const void *at;
    size_t bytes;
} slot;

static void check_slots(const smr *s, size_t bytes)
{
    const size_t n = s->shared.n, v3 = 3u * n * sizeof(float), pulls = s->shared.config.basic.n_target_vertices;
    const slot slots[] = {
        {s, sizeof *s},
        {s->shape.structure, s->shared.n_structures * sizeof *s->shape.structure},
        {s->forces.surface.target, s->shared.n_structures * sizeof *s->forces.surface.target},
        {s->forces.image.structure, s->shared.n_structures * sizeof *s->forces.image.structure},
        {s->folds.folding, s->shared.n_structures * sizeof *s->folds.folding},
        {s->forces.surface.goal, s->shared.n_structures * sizeof *s->forces.surface.goal},
        {s->shape.x, v3},
        {s->shape.x_next, v3},
        {s->shape.x_ref, v3},
        {s->shape.normal, v3},
        {s->shape.normal_ref, v3},
        {s->shape.start, v3},
        {s->forces.force, v3},
        {s->reference.centre, v3},
        {s->reference.spread, 2u * v3},
        {s->reference.cluster_mass, n * sizeof(float)},
        {s->forces.surface.warm, n * sizeof(uint32_t)},
        {s->forces.surface.warm_next, n * sizeof(uint32_t)},
        {s->forces.found, n},
        {s->forces.found_last, n},
        {s->overlay.record, n * SMR_WORDS * sizeof(uint32_t)},
        {s->sums.sum, n * SMR_WORDS * sizeof(uint32_t)},
        {s->match.transform, 4u * v3},
        {s->match.eigen, s->match.eigen == NULL ? 0u : 3u * v3},
        {s->overlay.tally,
         (s->shared.n_tasks > s->folds.n_dihedral_tasks ? s->shared.n_tasks : s->folds.n_dihedral_tasks) *
             sizeof *s->overlay.tally},
        {s->shape.triangle_normal, 3u * (size_t)s->shared.n_triangles * sizeof(float)},
        {s->forces.surface.target_warm, pulls * sizeof(uint32_t)},
        {s->forces.surface.pull, pulls == 0u ? 0u : s->shared.config.basic.n_workers * n * 4u * sizeof(int64_t)},
        {s->shape.node, pulls == 0u ? 0u : s->shape.n_nodes * sizeof(smr_node)},
    };
    const unsigned char *base = (const unsigned char *)s;
    for (size_t i = 0; i < sizeof slots / sizeof slots[0]; i++) {
        const unsigned char *a = slots[i].at;
        if (slots[i].bytes == 0u)
            continue;
        assert_non_null(a);
        assert_int_equal(0, (uintptr_t)a % SMR_ALIGN);
        assert_true(a >= base && a + slots[i].bytes <= base + bytes);
        for (size_t k = 0; k < i; k++) {
            const unsigned char *b = slots[k].at;
            assert_true(slots[k].bytes == 0u || a + slots[i].bytes <= b || b + slots[k].bytes <= a);
        }
    }
}

static void test_layout(void **state)
{
    const float off[3] = {50, 0, 0};
    const smr_mesh mesh[2] = {rig_ball(20, 6, 30, none), rig_ball(20, 3, 5, off)};
    const smr_prepare_config radii = rig_radii(2, 15, 8, 0);
    const smr_model *model = rig_model(mesh, 2, &radii);
    (void)state;
    for (uint32_t k = 0; k < 8u; k++) {
        smr_config config = smr_config_default();
        size_t bytes = 0;
        config.basic.method = k & 1u;
        config.basic.n_workers = k & 2u ? 5 : 1;
        config.basic.n_target_vertices = k & 4u ? 77 : 0;
        assert_int_equal(SMR_OK, smr_arena_bytes(model, &config, &bytes));
        const smr *s = rig_init(model, &config, NULL);
        check_slots(s, bytes);
        assert_int_equal(k & 1u, s->match.eigen != NULL);
        assert_int_equal(k >> 2u, s->forces.surface.pull != NULL && s->shape.node != NULL &&
                                      s->forces.surface.target_warm != NULL);
    }
}

static void test_counts_and_parts(void **state)
{
    const float off[3] = {50, 0, 0};
    const smr_mesh mesh[3] = {
        rig_ball(20, 6, 30, none), rig_ball(20, 3, 5, off), {rig_ball(9, 2, 4, none).xyz, NULL, 10, 0}};
    const smr_prepare_config radii = rig_radii(2, 15, 8, 0);
    const smr_model *model = rig_model(mesh, 3, &radii);
    const smr_config config = smr_config_default();
    const smr *s = rig_init(model, &config, NULL);
    uint32_t vertices = 0, triangles = 0, leaves = 0;
    (void)state;
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

static void test_masses(void **state)
{
    const smr_mesh mesh = rig_ball(20, 6, 9, none);
    (void)state;
    for (uint32_t area = 0; area < 2u; area++) {
        smr_prepare_config prepare = rig_radii(1, 15, 0, 0);
        const smr_config config = smr_config_default();
        float largest = 0.0f;
        prepare.mass = area;
        const smr *s = rig_init(rig_model(&mesh, 1, &prepare), &config, NULL);
        for (uint32_t v = 0; v < s->shared.n; v++) {
            const float units = smr_mass(&s->shared, v) * s->shared.mass_unit;
            largest = fmaxf(largest, smr_mass(&s->shared, v));
            assert_true(units >= 1.0f && units == floorf(units)); /* whole multiples */
        }
        assert_true(s->shared.mass_max == largest);
        assert_true(area || (s->shared.mass_unit == 1.0f && largest == 1.0f));
    }
}

static void test_copies(void **state)
{
    const smr_mesh mesh = rig_ball(20, 6, 9, none);
    const smr_prepare_config radii = rig_radii(1, 15, 0, 0);
    smr_config config = smr_config_default();
    smr_port port = rig_port(RIG_REVERSE, 3);
    (void)state;
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_teardown(test_layout, tidy),
        cmocka_unit_test_teardown(test_counts_and_parts, tidy),
        cmocka_unit_test_teardown(test_masses, tidy),
        cmocka_unit_test_teardown(test_copies, tidy),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
