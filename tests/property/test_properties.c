/* test_properties.c: what holds for any registration to a micrometre: moving or mirroring all inputs moves or mirrors
 * the result, and the order of points does not matter. test_equal_bits.c has what holds to the last bit.
 * SMR_TEST_SHOW=1 prints the figures.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "property/rig_data.h"

#define TOLERANCE_MM 1.0e-3f
/* About 900 vertices. */
#define CELL 10000u

static int no_momentum; /* 1: without it small differences do not grow from iteration to iteration */

static const float identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, nowhere[3] = {0, 0, 0};

static void show(const char *what, float mm)
{
    if (getenv("SMR_TEST_SHOW") != NULL)
        printf("%-44s %.3g mm%s\n", what, (double)mm, no_momentum ? ", no momentum" : "");
}

/* A whole default registration; positions in the caller's order. */
static float *registered(const smr_mesh *source, const smr_mesh *target)
{
    smr_config config = smr_config_default();
    config.basic.n_target_vertices = target->n_vertices;
    config.motion.momentum = no_momentum ? 0.0f : config.motion.momentum;
    const smr_model *model = rig_model(source, 1, NULL);
    smr *s = rig_init(model, &config, NULL);
    assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, rig_surface(target)));
    const smr_tick_report report = rig_run(s, 2000);
    assert_int_equal(1, report.done);
    return rig_positions(s, model);
}

/* How far two results lie apart. */
typedef struct apart {
    float mean, worst;
    float share; /* of the vertices, further apart than the tolerance */
} apart;

static void compare(const float *a, const float *b, uint32_t n, apart *most)
{
    float sum = 0.0f, beyond = 0.0f;
    for (uint32_t v = 0; v < n; v++) {
        const float far = rig_far(a + 3u * (size_t)v, b + 3u * (size_t)v, 1);
        sum += far;
        beyond += far > TOLERANCE_MM ? 1.0f : 0.0f;
        most->worst = fmaxf(most->worst, far);
    }
    most->mean = fmaxf(most->mean, sum / (float)n);
    most->share = fmaxf(most->share, beyond / (float)n);
}

static void tell(const char *what, const apart *a)
{
    printf("%-44s mean %.3g mm, largest %.3g mm, %.2f %% beyond the tolerance%s\n", what, (double)a->mean,
           (double)a->worst, 100.0 * (double)a->share, no_momentum ? ", no momentum" : "");
}

static void assert_moves_along(const char *what, const apart *a)
{
    if (getenv("SMR_TEST_SHOW") != NULL)
        tell(what, a);
    assert_true(a->worst <= TOLERANCE_MM);
}

static void moved_difference(const smr_mesh *source, const smr_mesh *target, const float *plain, const float m[9],
                             const float t[3], apart *most)
{
    const smr_mesh source2 = rig_moved(source, m, t), target2 = rig_moved(target, m, t);
    const smr_mesh result = {plain, NULL, source->n_vertices, 0};
    const smr_mesh expected = rig_moved(&result, m, t);
    compare(expected.xyz, registered(&source2, &target2), source->n_vertices, most);
}

/* The bone pair with coordinates in whole 1/1024 mm: moved by whole millimetres, or turned by exchanging axes, the
 * coordinates stay exact. What the result differs by is then the library's own doing. */
static void exact_bone(smr_mesh *source, smr_mesh *target)
{
    smr_mesh *both[2] = {source, target};
    rig_bone(CELL, 1.0f, source, target);
    for (int k = 0; k < 2; k++) {
        float *xyz = rig_alloc(both[k]->n_vertices * 3u * sizeof *xyz);
        for (uint32_t i = 0; i < 3u * both[k]->n_vertices; i++)
            xyz[i] = roundf(both[k]->xyz[i] * 1024.0f) / 1024.0f;
        both[k]->xyz = xyz;
    }
}

TEST(test_translation)
{
    static const float by[][3] = {{600, 0, 0}, {-600, 600, 0}, {0, -1, 600}, {-3, 5, 7}, {346, -346, 346}};
    smr_mesh source, target;
    apart most = {0, 0, 0};
    exact_bone(&source, &target);
    const float *plain = registered(&source, &target);
    for (size_t i = 0; i < rig_times(sizeof by / sizeof by[0]); i++)
        moved_difference(&source, &target, plain, identity, by[i], &most);
    show("translated inputs", most.worst);
    assert_true(most.worst <= TOLERANCE_MM);
}

TEST(test_rotation)
{
    static const struct {
        float m[9], t[3];
    } turn[] = {{{0, -1, 0, 1, 0, 0, 0, 0, 1}, {0, 0, 0}},
                {{1, 0, 0, 0, 0, -1, 0, 1, 0}, {600, 0, 0}},
                {{0, 0, 1, 1, 0, 0, 0, 1, 0}, {-600, 600, 0}},
                {{-1, 0, 0, 0, -1, 0, 0, 0, 1}, {0, 0, 600}},
                {{0, 0, -1, 0, -1, 0, -1, 0, 0}, {100, 200, -300}}};
    smr_mesh source, target;
    apart most = {0, 0, 0};
    exact_bone(&source, &target);
    const float *plain = registered(&source, &target);
    for (size_t i = 0; i < rig_times(sizeof turn / sizeof turn[0]); i++)
        moved_difference(&source, &target, plain, turn[i].m, turn[i].t, &most);
    assert_moves_along("rotated and translated inputs", &most);
}

/* Any rotation and 600 mm: the inputs themselves are then rounded, to 3e-5 mm. */
TEST(test_rounded_inputs)
{
    static const float turn[][7] = {/* axis, degrees, translation */
                                    {1, 2, 3, 37, 0, 0, 0},
                                    {3, -1, 1, 120, -600, 0, 0},
                                    {-1, 1, 2, 180, 0, 0, 600},
                                    {1, 0, 0, 5, 100, 200, -300},
                                    {1, 0, 0, 0, 0.1f, 0.3f, 0.7f}};
    smr_mesh source, target;
    apart most = {0, 0, 0};
    rig_bone(CELL, 1.0f, &source, &target);
    const float *plain = registered(&source, &target);
    for (size_t i = 0; i < rig_times(sizeof turn / sizeof turn[0]); i++) {
        float m[9];
        rig_rotation(turn[i][0], turn[i][1], turn[i][2], turn[i][3], m);
        moved_difference(&source, &target, plain, m, turn[i] + 4, &most);
    }
    assert_moves_along("rounded moved inputs", &most);
}

/* One person's femur onto another's, from the start that smr_align finds, when the data lie beside the repository. */
static float *aligned(const smr_mesh *source, const smr_mesh *target)
{
    smr_config config = smr_config_default();
    const smr_align_config how = smr_align_config_default();
    const smr_model *model = rig_model(source, 1, NULL);
    const smr_surface *to = rig_surface(target);
    smr_pose pose;
    size_t bytes = 0;
    config.basic.n_target_vertices = target->n_vertices;
    smr *s = rig_init(model, &config, NULL);
    assert_int_equal(SMR_OK, smr_align_bytes(&how, &bytes));
    assert_int_equal(SMR_OK, smr_align(rig_surface(source), to, &how, rig_alloc(bytes), bytes, &pose, NULL));
    assert_int_equal(SMR_OK, smr_set_pose(s, &pose));
    assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, to));
    assert_int_equal(1, rig_run(s, 2000).done);
    return rig_positions(s, model);
}

static apart femurs_moved(const smr_mesh *source, const smr_mesh *target)
{
    static const float turn[][7] = {/* axis, degrees, translation */
                                    {0, 0, 1, 90, 600, 0, 0},
                                    {1, 1, 1, 120, -600, 600, 0},
                                    {1, 0, 0, 5, 100, 200, -300},
                                    {-1, 1, 2, 180, 0, 0, 600},
                                    {1, 0, 0, 0, 0.1f, 0.3f, 0.7f}};
    apart most = {0, 0, 0};
    const float *plain = aligned(source, target);
    for (size_t i = 0; i < rig_times(sizeof turn / sizeof turn[0]); i++) {
        float m[9];
        rig_rotation(turn[i][0], turn[i][1], turn[i][2], turn[i][3], m);
        const smr_mesh source2 = rig_moved(source, m, turn[i] + 4), target2 = rig_moved(target, m, turn[i] + 4);
        const smr_mesh result = {plain, NULL, source->n_vertices, 0};
        const smr_mesh expected = rig_moved(&result, m, turn[i] + 4);
        compare(expected.xyz, aligned(&source2, &target2), source->n_vertices, &most);
    }
    return most;
}

/* A surface of the folder; a mirrored one is turned over. Returns 0 without the data. */
static int femur(const char *part_of_name, int mirrored, smr_mesh *found)
{
    static const float across[9] = {-1, 0, 0, 0, 1, 0, 0, 0, 1};
    smr_mesh mesh[RIG_STRUCTURES_MAX];
    char name[RIG_STRUCTURES_MAX][SMR_NAME_BYTES];
    const uint32_t n = rig_folder("femurs", mesh, name);
    for (uint32_t i = 0; i < n; i++) {
        if (strstr(name[i], part_of_name) != NULL) {
            *found = mirrored ? rig_moved(&mesh[i], across, nowhere) : mesh[i];
            return 1;
        }
    }
    return 0;
}

TEST(test_femurs)
{
    smr_mesh source, target;
    if (!femur("2008_0019_left_3k", 0, &source) || !femur("2007_5028_left_3k", 0, &target))
        skip();
    apart most = femurs_moved(&source, &target);
    assert_moves_along("femurs", &most);
    if (rig_times(20) < 20u) /* instrumented */
        return;
    most = femurs_moved(&target, &source);
    assert_moves_along("femurs, the other way round", &most);
}

/* A dense mesh with slivers onto a coarse one: the fold guard acts throughout the last radius, and carries the rounding
 * of moved inputs farther at single vertices. */
TEST(test_slivers)
{
    smr_mesh source, target;
    if (!femur("vhm_left", 1, &source) || !femur("m_right", 0, &target))
        skip();
    const apart most = femurs_moved(&source, &target);
    if (getenv("SMR_TEST_SHOW") != NULL)
        tell("slivers", &most);
    assert_true(most.share < 0.001f && most.worst <= 2.0f * TOLERANCE_MM);
}

TEST(test_mirror)
{
    smr_mesh source, target;
    apart most = {0, 0, 0};
    rig_bone(CELL, 1.0f, &source, &target);
    const float *plain = registered(&source, &target);
    for (uint32_t axis = 0; axis < 3u; axis++) {
        float m[9];
        memcpy(m, identity, sizeof m);
        m[4u * axis] = -1.0f;
        moved_difference(&source, &target, plain, m, nowhere, &most);
    }
    assert_moves_along("mirrored inputs", &most);
}

/* The same mesh with its vertices, triangles and corners in another order. new_of[old vertex]. */
static smr_mesh shuffled(const smr_mesh *mesh, uint32_t *seed, uint32_t *new_of)
{
    float *xyz = rig_alloc(mesh->n_vertices * 3u * sizeof *xyz);
    uint32_t *t = rig_alloc(mesh->n_triangles * 3u * sizeof *t);
    for (uint32_t i = 0; i < mesh->n_vertices; i++) {
        const uint32_t j = rig_random(seed, i + 1u);
        new_of[i] = new_of[j];
        new_of[j] = i;
    }
    for (uint32_t i = 0; i < mesh->n_vertices; i++)
        memcpy(xyz + 3u * (size_t)new_of[i], mesh->xyz + 3u * (size_t)i, 3u * sizeof *xyz);
    for (uint32_t i = 0; i < mesh->n_triangles; i++) {
        const uint32_t j = rig_random(seed, i + 1u), turn = rig_random(seed, 3);
        memcpy(t + 3u * (size_t)i, t + 3u * (size_t)j, 3u * sizeof *t);
        for (uint32_t c = 0; c < 3u; c++)
            t[3u * (size_t)j + c] = new_of[mesh->triangles[3u * (size_t)i + (c + turn) % 3u]];
    }
    return (smr_mesh){xyz, t, mesh->n_vertices, mesh->n_triangles};
}

TEST(test_order_of_inputs)
{
    smr_mesh source, target;
    uint32_t seed = 5;
    apart most = {0, 0, 0};
    rig_bone(CELL, 1.0f, &source, &target);
    const float *plain = registered(&source, &target);
    uint32_t *new_of = rig_alloc(source.n_vertices * sizeof *new_of);
    uint32_t *target_of = rig_alloc(target.n_vertices * sizeof *target_of);
    float *expected = rig_alloc(source.n_vertices * 3u * sizeof *expected);
    for (uint32_t round = 0; round < 3u; round++) {
        const smr_mesh source2 = shuffled(&source, &seed, new_of), target2 = shuffled(&target, &seed, target_of);
        const float *other = registered(&source2, &target2);
        for (uint32_t i = 0; i < source.n_vertices; i++)
            memcpy(expected + 3u * (size_t)new_of[i], plain + 3u * (size_t)i, 3u * sizeof *expected);
        compare(expected, other, source.n_vertices, &most);
    }
    assert_moves_along("vertices and triangles in another order", &most);
}

/* One iteration of every kind from the same start: no history in which small differences could grow. */
TEST(test_one_iteration_moves_along)
{
    static const float turn[][7] = {{1, 2, 3, 37, 0, 0, 0}, {3, -1, 1, 120, -600, 0, 0}, {-1, 1, 2, 180, 0, 0, 600}};
    smr_mesh source, target;
    float worst = 0.0f;
    rig_bone(CELL, 1.0f, &source, &target);
    for (uint32_t k = 0; k < 6u; k++) {
        float m[9], *x[2];
        rig_rotation(turn[k / 2u][0], turn[k / 2u][1], turn[k / 2u][2], turn[k / 2u][3], m);
        const smr_mesh from[2] = {source, rig_moved(&source, m, turn[k / 2u] + 4)};
        const smr_mesh to[2] = {target, rig_moved(&target, m, turn[k / 2u] + 4)};
        const smr_prepare_config radii = rig_radii(1, 60.0f + 7.13f * (float)k, 0, 0);
        for (uint32_t i = 0; i < 2u; i++) {
            smr_config config = smr_config_default();
            config.basic.method = k % 2u;
            const smr_model *model = rig_model(&from[i], 1, &radii);
            smr *s = rig_init(model, &config, NULL);
            assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, rig_surface(&to[i])));
            (void)rig_run(s, 1);
            x[i] = rig_positions(s, model);
        }
        const smr_mesh result = {x[0], NULL, source.n_vertices, 0};
        const smr_mesh expected = rig_moved(&result, m, turn[k / 2u] + 4);
        worst = fmaxf(worst, rig_far(expected.xyz, x[1], source.n_vertices));
    }
    show("one iteration, rotated and translated", worst);
    assert_true(worst <= TOLERANCE_MM);
}

static void without_momentum(CMUnitTestFunction test)
{
    no_momentum = 1;
    test(NULL);
    no_momentum = 0;
}

TEST(test_translation_without_momentum) { without_momentum(test_translation); }
TEST(test_order_without_momentum) { without_momentum(test_order_of_inputs); }
