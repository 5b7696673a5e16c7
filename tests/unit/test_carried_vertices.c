/* test_carried_vertices.c: vertices without triangles (nodes inside a volume mesh, landmarks) get no force and are
 * carried: inside a bone that is deformed by 10 mm in the mean they stay at their depth and end as near to their true
 * places as the bone's own vertices, in a structure of their own, too. Those of a target attract nothing.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "fixture_bone.h"
#include "registration/registration.h"

#define DEPTH 4.0f /* mm: of the outer of two layers of points; the inner one is twice as deep */

static smr_mesh bone, target;
static double alone; /* mm: mean error of the bone's vertices without points */

BEFORE_EACH_TEST() { rig_bone(FIXTURE_CELL_SMALL, 1.0f, &bone, &target); }

/* Below each vertex of the bone, `layers` points. */
static smr_mesh points_below(uint32_t layers)
{
    float *xyz = rig_alloc(layers * (size_t)bone.n_vertices * 3u * sizeof *xyz), *to = xyz;
    for (uint32_t k = 0; k < layers; k++)
        for (uint32_t i = 0; i < bone.n_vertices; i++, to += 3) {
            float out[3];
            (void)fixture_bone_gradient(bone.xyz + 3u * (size_t)i, out);
            for (uint32_t a = 0; a < 3u; a++)
                to[a] = bone.xyz[3u * (size_t)i + a] - DEPTH * (float)(k + 1u) * out[a];
        }
    return (smr_mesh){xyz, NULL, layers * bone.n_vertices, 0};
}

/* The mesh with further vertices behind its own. */
static smr_mesh with_points(const smr_mesh *mesh, const smr_mesh *points)
{
    const size_t own = 3u * (size_t)mesh->n_vertices, more = 3u * (size_t)points->n_vertices;
    float *xyz = rig_alloc((own + more) * sizeof *xyz);
    memcpy(xyz, mesh->xyz, own * sizeof *xyz);
    memcpy(xyz + own, points->xyz, more * sizeof *xyz);
    return (smr_mesh){xyz, mesh->triangles, mesh->n_vertices + points->n_vertices, mesh->n_triangles};
}

static smr *run(const smr_mesh *mesh, uint32_t n_structures, const smr_mesh *goal, uint32_t target_vertices,
                const smr_model **model)
{
    const smr_prepare_config prepare = smr_prepare_config_default();
    smr_config config = smr_config_default();
    config.basic.n_target_vertices = target_vertices;
    *model = rig_model(mesh, n_structures, &prepare);
    smr *s = rig_init(*model, &config, NULL);
    assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, rig_surface(goal)));
    assert_int_equal(1, rig_run(s, 1000).done);
    return s;
}

/* Mean distance of n points at x from where the deformation takes them from `from`. */
static double error_of(const float *x, const float *from, uint32_t n)
{
    float *truth = rig_alloc(3u * (size_t)n * sizeof *truth);
    double sum = 0.0;
    fixture_bone_truth(1.0f, from, n, truth);
    for (uint32_t i = 0; i < n; i++)
        sum +=
            sqrt(pow((double)(x[3u * i] - truth[3u * i]), 2) + pow((double)(x[3u * i + 1u] - truth[3u * i + 1u]), 2) +
                 pow((double)(x[3u * i + 2u] - truth[3u * i + 2u]), 2));
    return sum / n;
}

/* Mean difference of the first layer's depth below the target to DEPTH. */
static double depth_off(const float *x)
{
    const smr_surface *surface = rig_surface(&target);
    double sum = 0.0;
    for (uint32_t i = 0; i < bone.n_vertices; i++) {
        smr_closest hit;
        assert_int_equal(SMR_OK, smr_surface_closest(surface, x + 3u * (size_t)i, NULL, 0, 100.0f, &hit));
        sum += fabs((double)(hit.distance - DEPTH));
    }
    return sum / bone.n_vertices;
}

static void points_stay_inside(const smr *s, const smr_model *model, const smr_mesh *points)
{
    const float *x = rig_positions(s, model), *inner = x + 3u * (size_t)bone.n_vertices;
    const double surface = error_of(x, bone.xyz, bone.n_vertices);
    const double inside = error_of(inner, points->xyz, points->n_vertices), depth = depth_off(inner);
    (void)printf("error at vertices %.2f mm, at points inside %.2f mm; depth of 4 mm off by %.2f mm\n", surface, inside,
                 depth);
    assert_true(surface < 1.2 * alone); /* points hold little back: radii end at other iterations */
    assert_true(inside < 1.25 * surface);
    assert_true(depth < 0.5);
}

static void run_alone(void)
{
    const smr_model *model;
    const smr *s = run(&bone, 1, &target, target.n_vertices, &model);
    alone = error_of(rig_positions(s, model), bone.xyz, bone.n_vertices);
}

TEST(test_inner_nodes_keep_their_depth)
{
    run_alone();
    for (uint32_t layers = 1; layers <= 2u; layers++) {
        const smr_mesh points = points_below(layers), mesh = with_points(&bone, &points);
        const smr_model *model;
        smr_structure_report part;
        smr *s = run(&mesh, 1, &target, target.n_vertices, &model);
        assert_int_equal(SMR_OK, smr_get_structure_report(s, 0, &part));
        assert_int_equal(bone.n_vertices, part.n_forces + part.n_rejected);
        assert_int_equal(0, s->forces.surface.target[0].partial); /* what cannot be seen is not missing */
        points_stay_inside(s, model, &points);
    }
}

/* At small radii structures keep to themselves, but not from points. */
TEST(test_points_of_their_own)
{
    run_alone();
    const smr_mesh mesh[2] = {bone, points_below(1)};
    const smr_model *model;
    smr_structure_report part;
    smr_model_info info;
    smr *s = run(mesh, 2, &target, target.n_vertices, &model);
    assert_int_equal(SMR_OK, smr_model_get_info(model, &info));
    assert_true(info.separate[info.n_radii - 2u] && info.separate[info.n_radii - 3u]);
    assert_int_equal(SMR_OK, smr_get_structure_report(s, 1, &part));
    assert_int_equal(0, part.n_forces + part.n_rejected);
    assert_true(part.matched_share == -1.0f);
    points_stay_inside(s, model, &mesh[1]);
}

/* A corner of triangles without area looks for a goal all the same. */
TEST(test_degenerate_triangles_draw)
{
    const float beside[3] = {bone.xyz[0] + 2.0f, bone.xyz[1], bone.xyz[2]};
    const smr_mesh point = {beside, NULL, 1, 0};
    smr_mesh mesh = with_points(&bone, &point);
    uint32_t *triangles = rig_alloc(3u * ((size_t)mesh.n_triangles + 1u) * sizeof *triangles);
    const smr_model *model;
    smr_structure_report part;
    memcpy(triangles, mesh.triangles, 3u * (size_t)mesh.n_triangles * sizeof *triangles);
    for (uint32_t c = 0; c < 3u; c++)
        triangles[3u * (size_t)mesh.n_triangles + c] = bone.n_vertices;
    mesh.triangles = triangles;
    mesh.n_triangles++;
    smr *s = run(&mesh, 1, &target, target.n_vertices, &model);
    assert_int_equal(SMR_OK, smr_get_structure_report(s, 0, &part));
    assert_int_equal(mesh.n_vertices, part.n_forces + part.n_rejected);
}

/* Neither by pulling nor by what counts as the mean area: not a bit changes. */
TEST(test_target_points_attract_nothing)
{
    const smr_mesh points = points_below(2);
    smr_mesh goal = bone;
    const smr_model *model;
    float *xyz = rig_alloc(3u * (size_t)bone.n_vertices * sizeof *xyz);
    for (uint32_t i = 0; i < 3u * bone.n_vertices; i++)
        xyz[i] = 1.01f * bone.xyz[i];
    goal.xyz = xyz;
    const smr_mesh more = with_points(&goal, &points);
    const uint64_t plain = smr_state_hash(run(&bone, 1, &goal, more.n_vertices, &model));
    assert_true(plain == smr_state_hash(run(&bone, 1, &more, more.n_vertices, &model)));
}
