/* test_stability.c: no input and no legal configuration makes a position non-finite or ends a run other than by its
 * schedule: degenerate models, hostile targets, and random pairs of both with random configurations.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include <string.h>

static const float none[3] = {0, 0, 0};

static smr_mesh mesh_of(const float *xyz, uint32_t nv, const uint32_t *triangles, uint32_t nt)
{
    return (smr_mesh){xyz, triangles, nv, nt};
}

/* 200 iterations: everything that can be read is finite, and positions stay within a few times the inputs' size. */
static void run_and_check(const smr_model *model, const smr_config *config, const smr_surface *target, const char *what)
{
    smr_model_info info;
    smr_structure_report part;
    smr_tick_report report = {0};
    const uint32_t n_ticks = rig_times(200);
    assert_int_equal(SMR_OK, smr_model_get_info(model, &info));
    smr *s = rig_init(model, config, NULL);
    if (target != NULL)
        assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, target));
    if (target != NULL && config->contact.n_fixed > 0u)
        assert_int_equal(SMR_OK, smr_set_fixed(s, 0, target));
    for (uint32_t tick = 0; tick < n_ticks && !report.done; tick++) {
        assert_int_equal(SMR_OK, smr_tick(s, 0, &report));
        const float shown[] = {report.residual_mean_mm, report.details.residual_rms_mm, report.details.residual_max_mm,
                               report.displacement_max_mm, report.progress};
        for (uint32_t i = 0; i < 5u; i++)
            if (!isfinite(shown[i]) || (shown[i] < 0.0f && !(i < 3u && shown[i] == -1.0f))) /* not measured */
                fail_msg("%s: figure %u of the report is %g in iteration %u", what, i, (double)shown[i], tick);
        assert_true(report.progress <= 1.0f);
        assert_true(report.n_forces + report.details.n_rejected <= info.n_vertices);
    }
    const float *x = rig_positions(s, model);
    for (size_t i = 0; i < 3u * (size_t)info.n_vertices; i++)
        if (!(x[i] >= -1.0e6f && x[i] <= 1.0e6f))
            fail_msg("%s: coordinate %zu is %g", what, i, (double)x[i]);
    float *normal = rig_alloc(info.n_vertices * 3u * sizeof *normal);
    for (uint32_t i = 0; i < info.n_structures; i++) {
        assert_int_equal(SMR_OK, smr_get_normals(s, i, normal));
        assert_int_equal(SMR_OK, smr_get_structure_report(s, i, &part));
        assert_int_equal(SMR_OK, smr_get_local_volume(s, SMR_ALL, 3.0f * (float)i, normal));
        for (uint32_t v = 0; v < info.n_vertices; v++)
            if (!(normal[v] >= -1.0e6f && normal[v] <= 1.0e6f))
                fail_msg("%s: a local volume of %g", what, (double)normal[v]);
        assert_int_equal(SMR_OK, smr_get_normals(s, i, normal));
        smr_structure_info structure;
        assert_int_equal(SMR_OK, smr_model_structure(model, i, &structure));
        for (uint32_t v = 0; v < structure.n_vertices; v++) {
            const float *n = normal + 3u * (size_t)v;
            const float length = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
            if (!(length == 0.0f || (length > 0.99f && length < 1.01f)))
                fail_msg("%s: a normal of length %g", what, (double)length);
        }
        assert_true(isfinite(part.residual_mean_mm) && isfinite(part.moved_max_mm));
    }
}

static void both_methods(const smr_mesh *source, const smr_mesh *target, float radius, const char *what)
{
    const smr_prepare_config radii = rig_radii(2, radius, radius * 0.3f, 0);
    const smr_prepare_config standard = smr_prepare_config_default();
    const smr_surface *surface = target == NULL ? NULL : rig_surface(target);
    for (uint32_t k = 0; k < 8u; k++) {
        const smr_model *model = rig_model(source, 1, k & 4u ? &standard : &radii);
        smr_config config = smr_config_default();
        config.basic.method = k & 1u;
        config.basic.n_target_vertices = k & 2u ? 1000 : 0;
        config.basic.search_mm = SMR_COORD_MAX;
        config.motion.fusing = (k ^ k >> 1) & 1u;
        config.contact.volume = k & 1u ? 1.0f : 0.0f;
        config.contact.smooth = k & 2u ? 1.0f : 0.0f;
        config.contact.share = (float)(k >> 1 & 1u);
        config.contact.n_fixed = k >> 2 & 1u;
        config.forces.search_radii = 1.0e6f;
        config.motion.settle_um = 0.0f;
        config.basic.iterations_last = 1000;
        run_and_check(model, &config, surface, what);
    }
}

TEST(test_hostile_targets)
{
    const smr_mesh ball = rig_ball(30, 6, 9, none);
    static const float flat[] = {0, 0, 0, 10, 0, 0, 20, 0, 0, 5, 0, 0},
                       far[] = {1e5f, 1e5f, 1e5f, 1e5f, 9e4f, 1e5f, 9e4f, 1e5f, 1e5f},
                       one[] = {5, 5, 5, 5, 6, 5, 6, 5, 5}, huge[] = {1e5f, 1e5f, 0, -1e5f, 1e5f, 0, 0, -1e5f, 1},
                       point[] = {3, 3, 3, 3, 3, 3, 3, 3, 3}, needle[] = {-1e5f, 0, 0, 1e5f, 0, 0, 0, 1e-6f, 0};
    static const uint32_t t1[] = {0, 1, 2}, t2[] = {0, 1, 2, 1, 2, 3}, same[] = {1, 1, 1, 0, 0, 1};
    const smr_mesh targets[] = {mesh_of(flat, 4, t2, 2), mesh_of(far, 3, t1, 1),   mesh_of(one, 3, t1, 1),
                                mesh_of(huge, 3, t1, 1), mesh_of(point, 3, t1, 1), mesh_of(needle, 3, t1, 1),
                                mesh_of(one, 3, same, 2)};
    static const char *const name[] = {"collinear target",
                                       "target in the corner",
                                       "one triangle",
                                       "a triangle of 200 m",
                                       "a point",
                                       "a needle",
                                       "triangles that name a vertex twice"};
    for (uint32_t i = 0; i < sizeof targets / sizeof targets[0]; i++)
        both_methods(&ball, &targets[i], 25, name[i]);
}

TEST(test_odd_shapes)
{
    static const float turn_over[9] = {-1, 0, 0, 0, 1, 0, 0, 0, 1};
    static const float corner[3] = {9.99e4f, -9.99e4f, 9.99e4f};
    const smr_mesh ball = rig_ball(30, 6, 9, none), small = rig_ball(0.01f, 6, 9, none),
                   large = rig_ball(9.0e4f, 6, 9, none);
    const smr_mesh away = rig_ball(30, 6, 9, corner);
    const smr_mesh mirrored = rig_moved(&ball, turn_over, none);
    smr_mesh inside_out = mirrored;
    inside_out.xyz = ball.xyz; /* the mirrored one's triangles: every normal looks inwards */
    both_methods(&ball, &inside_out, 25, "inverted normals");
    both_methods(&ball, &mirrored, 25, "mirrored");
    both_methods(&ball, &small, 25, "tiny target");
    both_methods(&ball, &large, 25, "large target");
    both_methods(&large, &small, 5.0e4f, "large model, tiny target");
    both_methods(&small, &large, 0.01f, "tiny model, large target");
    both_methods(&ball, &away, 25, "target in a far corner");
    both_methods(&away, &ball, 25, "model in a far corner");
    both_methods(&away, &large, 25, "model in a far corner, large target");
    both_methods(&ball, NULL, 25, "no target");
}

TEST(test_degenerate_models)
{
    static float xyz[3 * 20], line[3 * 20], plane[3 * 20];
    static const uint32_t fan[] = {0, 1, 2, 0, 2, 3, 0, 3, 4, 5, 5, 5, 6, 7, 6};
    const smr_mesh ball = rig_ball(30, 6, 9, none);
    for (uint32_t i = 0; i < 20u; i++) {
        xyz[3u * i] = xyz[3u * i + 1u] = xyz[3u * i + 2u] = 7.25f;
        line[3u * i] = 2.0f * (float)i;
        line[3u * i + 1u] = (float)i;
        line[3u * i + 2u] = -(float)i;
        plane[3u * i] = (float)(i % 5u) * 3.0f;
        plane[3u * i + 1u] = (float)(i / 5u) * 3.0f;
    }
    for (uint32_t targets = 0; targets < 2u; targets++) {
        const smr_mesh *target = targets ? &ball : NULL;
        for (uint32_t faces = 0; faces <= 5u; faces += 5u) {
            const smr_mesh coincident = mesh_of(xyz, 20, fan, faces), collinear = mesh_of(line, 20, fan, faces),
                           planar = mesh_of(plane, 20, fan, faces);
            both_methods(&coincident, target, 10, "all coincident");
            both_methods(&collinear, target, 10, "collinear");
            both_methods(&planar, target, 10, "planar");
        }
        for (uint32_t n = 1; n <= 4u; n++) {
            const smr_mesh few = mesh_of(line, n, NULL, 0), stacked = mesh_of(xyz, n, NULL, 0);
            both_methods(&few, target, 10, "few vertices, no triangles");
            both_methods(&few, target, 0.5f, "single-vertex clusters");
            both_methods(&stacked, target, 10, "few coincident vertices");
        }
        const smr_mesh cloud = mesh_of(ball.xyz, ball.n_vertices, NULL, 0);
        both_methods(&cloud, target, 25, "no triangles");
    }
}

/* ---- random */

static float pick(uint32_t *seed, float lo, float hi, float a, float b)
{
    const uint32_t k = rig_random(seed, 6);
    return k == 0u ? a : k == 1u ? b : rig_between(seed, lo, hi);
}

static smr_config random_config(uint32_t *seed, uint32_t n_radii)
{
    smr_config c = smr_config_default();
    c.basic.n_target_vertices = rig_random(seed, 2) * 2000u;
    c.forces.stiffness = pick(seed, 0.01f, 1.0f, 1.0e-30f, 1.0f);
    c.basic.attraction = pick(seed, 0.0f, 1.0f, 0.0f, 1.0f);
    c.basic.slide = pick(seed, 0.0f, 1.0f, 0.0f, 1.0f);
    c.basic.even = pick(seed, 0.0f, 1.0f, 0.0f, 1.0f);
    c.basic.search_mm = pick(seed, 0.1f, 200.0f, 1.0e-30f, SMR_COORD_MAX);
    c.forces.search_radii = pick(seed, 0.1f, 20.0f, 1.0e-30f, 1.0e6f);
    c.forces.normal_deg = pick(seed, 5.0f, 180.0f, 1.0e-30f, 180.0f);
    c.forces.reject_deviations = pick(seed, 0.0f, 4.0f, 0.0f, 1.0e-30f);
    c.forces.reject_border = rig_random(seed, 2);
    c.forces.use_box = rig_random(seed, 4) == 0u;
    for (uint32_t i = 0; i < 3u; i++) {
        c.forces.box_min[i] = rig_between(seed, -80, 0);
        c.forces.box_max[i] = c.forces.box_min[i] + rig_between(seed, 0, 150);
    }
    c.forces.node_budget = 8u + rig_random(seed, 600);
    c.basic.method = rig_random(seed, 2);
    c.motion.relaxation = pick(seed, 0.05f, 1.0f, 1.0e-30f, 1.0f);
    c.motion.momentum = pick(seed, 0.0f, 0.99f, 0.0f, 0.99f);
    c.motion.plastic_um = pick(seed, 0.0f, 200.0f, 0.0f, 1.0e8f);
    c.motion.settle_um = pick(seed, 0.0f, 20.0f, 0.0f, 0.0f);
    c.motion.plastic_every = rig_random(seed, 4);
    c.motion.fold_guard = rig_random(seed, 2);
    c.motion.normals = rig_random(seed, 2);
    c.schedule.radius_first = rig_random(seed, n_radii);
    c.schedule.radius_last = rig_random(seed, 2)
                                 ? SMR_FINEST
                                 : c.schedule.radius_first + rig_random(seed, n_radii - c.schedule.radius_first);
    c.basic.iterations = 1u + rig_random(seed, 10);
    c.basic.iterations_last = 1u + rig_random(seed, 60);
    c.motion.fusing = *seed >> 10 & 1u;
    c.contact.volume = *seed >> 11 & 1u ? 1.0f : 0.0f;
    c.contact.smooth = *seed >> 12 & 1u ? 0.7f : 0.0f;
    c.dynamics.mode = c.track.mode == SMR_TRACK_OFF && c.contact.volume == 0.0f && c.contact.smooth == 0.0f &&
                      (*seed >> 12 & 3u) == 0u;
    c.dynamics.gravity[1] = -9810.0f;
    c.dynamics.step_ms = (float)(1u + (*seed >> 14 & 63u));
    return c;
}

static smr_mesh random_mesh(uint32_t *seed, int needs_triangle)
{
    const float size = rig_between(seed, 0, 1) < 0.9f ? rig_between(seed, 5, 60) : 3.0e4f;
    float at[3];
    rig_within(seed, -40, 40, at);
    const uint32_t rings = 2u + rig_random(seed, 6);
    smr_mesh mesh = rig_ball(size, rings, 3u + rig_random(seed, 9), at);
    float *xyz = rig_alloc(mesh.n_vertices * 3u * sizeof *xyz);
    uint32_t *t = rig_alloc(mesh.n_triangles * 3u * sizeof *t);
    memcpy(xyz, mesh.xyz, mesh.n_vertices * 3u * sizeof *xyz);
    memcpy(t, mesh.triangles, mesh.n_triangles * 3u * sizeof *t);
    const uint32_t kind = rig_random(seed, 5);
    for (uint32_t i = 0; i < 3u * mesh.n_vertices; i++) {
        xyz[i] += kind > 0u ? rig_between(seed, -0.1f, 0.1f) * size : 0.0f;
        xyz[i] = kind == 2u && i % 3u == 2u ? at[2] : xyz[i]; /* flat */
    }
    for (uint32_t i = 0; kind >= 3u && i < 3u * mesh.n_triangles; i++) /* some triangles of any three vertices */
        t[i] = rig_random(seed, 12) == 0u ? rig_random(seed, mesh.n_vertices) : t[i];
    const uint32_t nt = kind == 4u ? rig_random(seed, mesh.n_triangles) + (uint32_t)needs_triangle : mesh.n_triangles;
    return (smr_mesh){xyz, t, mesh.n_vertices, nt};
}

TEST(test_random_configurations)
{
    for (uint32_t run = 0; run < rig_times(400); run++) {
        uint32_t seed = 1000u + 77u * run;
        smr_mesh part[3];
        const uint32_t n_parts = 1u + rig_random(&seed, 3);
        for (uint32_t i = 0; i < n_parts; i++)
            part[i] = random_mesh(&seed, 0);
        const smr_mesh target = random_mesh(&seed, 1);
        smr_prepare_config prepare = rig_radii(rig_random(&seed, 4), 0, 0, 0);
        prepare.radius_mm[0] = rig_between(&seed, 10, 80);
        prepare.radius_mm[1] = rig_between(&seed, 3, 30);
        prepare.radius_mm[2] = rig_between(&seed, 0.1f, 10);
        prepare.separate_below_mm = pick(&seed, 0, 60, -1, 0);
        prepare.distance = rig_random(&seed, 2);
        prepare.mass = rig_random(&seed, 2);
        prepare.order = rig_random(&seed, 2);
        prepare.ring = rig_random(&seed, 2);
        if (rig_random(&seed, 2) != 0u)
            prepare.block_vertices = 16u + rig_random(&seed, 100);
        const smr_model *model = rig_model(part, n_parts, &prepare);
        smr_model_info info;
        assert_int_equal(SMR_OK, smr_model_get_info(model, &info));
        const smr_config config = random_config(&seed, info.n_radii);
        char what[32] = "random run 000";
        for (uint32_t i = 0, k = run; i < 3u; i++, k /= 10u)
            what[13u - i] = (char)('0' + k % 10u);
        run_and_check(model, &config, rig_surface(&target), what);
        rig_free_all();
    }
}
