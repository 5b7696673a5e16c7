/* test_surface_steps.c: a surface built in pieces has the bytes of one built at once, however it is cut; a refitted
 * one finds what one built of the new positions finds; what is not complete is refused, and so is a tick on it.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include <string.h>
#include "base/arena.h"
#include "geometry/surface/surface.h"
#include "unit_mesh.h"

/* Builds in pieces of `units`, 0: at once. Returns how many calls that took. */
static uint32_t build(const smr_mesh *mesh, unsigned char *memory, size_t bytes, uint32_t units, smr_surface **surface)
{
    smr_status status = SMR_PARTIAL;
    uint32_t calls = 0;
    smr_arena_release(memory, bytes); /* red zones, which an instrumented build has */
    memset(memory, 0x5a, bytes);
    assert_int_equal(SMR_OK, smr_surface_begin(mesh, memory, bytes, surface));
    for (; status == SMR_PARTIAL; calls++) {
        smr_closest hit;
        const float p[3] = {0, 0, 0};
        assert_int_equal(SMR_E_STATE, smr_surface_closest(*surface, p, NULL, 0, 1, &hit));
        assert_int_equal(SMR_E_STATE, smr_surface_refit(*surface, mesh->xyz));
        status = smr_surface_step(*surface, units, NULL, 0);
    }
    assert_int_equal(SMR_OK, status);
    assert_int_equal(SMR_OK, smr_surface_step(*surface, units, NULL, 0)); /* and stays so */
    return calls;
}

/* A piece is about 256 vertices or triangles of work: their number grows with the mesh and no faster. */
TEST(test_pieces)
{
    smr_surface *surface;
    rig_clock clock = {0};
    smr_mesh mesh, other;
    size_t bytes;
    rig_bone(5000, 1.0f, &mesh, &other);
    assert_int_equal(SMR_OK, smr_surface_bytes(mesh.n_vertices, mesh.n_triangles, &bytes));
    unsigned char *memory = rig_alloc(bytes);
    const uint32_t calls = build(&mesh, memory, bytes, 1, &surface);
    assert_true(calls > mesh.n_triangles / 256u * 20u && calls < mesh.n_triangles / 256u * 200u);
    /* by a clock: as many pieces as fit, and one at least */
    const smr_port port = rig_clock_port(&clock, RIG_CLOCK_STEADY, 1000);
    uint32_t slices = 0, most = 0;
    assert_int_equal(SMR_OK, smr_surface_begin(&mesh, memory, bytes, &surface));
    for (smr_status status = SMR_PARTIAL; status == SMR_PARTIAL; slices++) {
        const uint64_t before = clock.readings;
        status = smr_surface_step(surface, 0, &port, 10000);
        most = (uint32_t)(clock.readings - before) > most ? (uint32_t)(clock.readings - before) : most;
    }
    assert_true(most == 11u && slices >= calls / 11u && slices <= calls / 10u + 1u);
    assert_int_equal(SMR_OK, smr_surface_begin(&mesh, memory, bytes, &surface));
    assert_int_equal(SMR_PARTIAL, smr_surface_step(surface, 0, &port, 1));
}

static smr_mesh bent(const smr_mesh *mesh)
{
    const float t[3] = {31, -12, 5};
    float m[9];
    rig_rotation(1, 0.3f, 2, 35, m);
    const smr_mesh moved = rig_moved(mesh, m, t);
    float *xyz = rig_alloc(3u * (size_t)mesh->n_vertices * sizeof *xyz);
    memcpy(xyz, moved.xyz, 3u * (size_t)mesh->n_vertices * sizeof *xyz);
    for (uint32_t i = 0; i < mesh->n_vertices; i++)
        xyz[3u * i] += 1.0e-3f * xyz[3u * i + 2u] * xyz[3u * i + 2u];
    return (smr_mesh){xyz, mesh->triangles, mesh->n_vertices, mesh->n_triangles};
}

static smr_status refit(smr_surface *surface, const float *xyz, uint32_t units)
{
    smr_status status = smr_surface_refit(surface, xyz);
    while (status == SMR_OK || status == SMR_PARTIAL) {
        status = smr_surface_step(surface, units, NULL, 0);
        if (status == SMR_OK)
            break;
    }
    return status;
}

TEST(test_refit)
{
    smr_mesh mesh, other;
    uint32_t seed = 5;
    rig_bone(8000, 1.0f, &mesh, &other);
    const smr_mesh next = bent(&mesh);
    smr_surface *refitted = rig_surface(&mesh), *again = rig_surface(&mesh);
    const smr_surface *built = rig_surface(&next);
    assert_int_equal(SMR_OK, refit(refitted, next.xyz, 0));
    assert_int_equal(SMR_OK, refit(again, mesh.xyz, 2)); /* there and back, and there */
    assert_int_equal(SMR_OK, refit(again, next.xyz, 1));
    assert_memory_equal(refitted->tree.node, again->tree.node, smr_tree_nodes(mesh.n_triangles) * sizeof(smr_node));
    assert_true(refitted->area_mean == again->area_mean &&
                fabsf(refitted->area_mean / built->area_mean - 1.0f) < 1e-5f);
    for (uint32_t i = 0; i < 300u; i++) {
        smr_closest a, b;
        float p[3];
        rig_within(&seed, -150, 150, p);
        assert_int_equal(SMR_OK, smr_surface_closest(refitted, p, NULL, 0, 1000, &a));
        assert_int_equal(SMR_OK, smr_surface_closest(built, p, NULL, 0, 1000, &b));
        assert_true(a.triangle == b.triangle && a.distance == b.distance);
    }
}

TEST(test_refused)
{
    smr_mesh mesh, other;
    smr_closest before, after;
    const float p[3] = {1, 2, 3};
    rig_bone(12000, 1.0f, &mesh, &other);
    smr_surface *s = rig_surface(&mesh);
    float *xyz = rig_alloc(3u * (size_t)mesh.n_vertices * sizeof *xyz);
    memcpy(xyz, mesh.xyz, 3u * (size_t)mesh.n_vertices * sizeof *xyz);
    xyz[3u * (mesh.n_vertices - 1u)] = NAN;
    assert_int_equal(SMR_OK, smr_surface_closest(s, p, NULL, 0, 1000, &before));
    assert_int_equal(SMR_E_INPUT, refit(s, xyz, 1));
    assert_int_equal(SMR_OK, smr_surface_closest(s, p, NULL, 0, 1000, &after));
    assert_memory_equal(&before, &after, sizeof before);
    assert_int_equal(0, s->changes);
    assert_int_equal(SMR_E_NULL, smr_surface_refit(NULL, xyz));
    assert_int_equal(SMR_E_NULL, smr_surface_refit(s, NULL));
    assert_int_equal(SMR_E_NULL, smr_surface_step(NULL, 0, NULL, 0));
    s->magic = 0;
    assert_int_equal(SMR_E_STATE, smr_surface_step(s, 0, NULL, 0));
    /* what was to be built is none */
    size_t bytes;
    assert_int_equal(SMR_OK, smr_surface_bytes(mesh.n_vertices, mesh.n_triangles, &bytes));
    unsigned char *memory = rig_alloc(bytes);
    mesh.xyz = xyz;
    assert_int_equal(SMR_OK, smr_surface_begin(&mesh, memory, bytes, &s));
    assert_int_equal(SMR_E_INPUT, smr_surface_step(s, 0, NULL, 0));
    assert_int_equal(SMR_E_STATE, smr_surface_step(s, 0, NULL, 0));
    assert_int_equal(SMR_E_STATE, smr_surface_closest(s, p, NULL, 0, 1000, &after));
}

/* A registration does not tick on a surface that changed under it, until it is set again. */
TEST(test_ticks)
{
    const smr_prepare_config radii = rig_radii(2, 110, 60, 0);
    smr_config config = smr_config_default();
    smr_mesh source, target;
    rig_bone(12000, 1.0f, &source, &target);
    config.basic.n_target_vertices = target.n_vertices;
    smr *s = rig_init(rig_model(&source, 1, &radii), &config, NULL);
    smr_surface *surface = rig_surface(&target);
    const smr_mesh next = bent(&target);
    assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, surface));
    assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
    const float nowhere = NAN;
    float *wrong = rig_alloc(3u * (size_t)target.n_vertices * sizeof *wrong);
    memcpy(wrong, next.xyz, 3u * (size_t)target.n_vertices * sizeof *wrong);
    memcpy(wrong + 3u * (target.n_vertices - 1u), &nowhere, sizeof nowhere);
    assert_int_equal(SMR_OK, smr_surface_refit(surface, wrong));
    assert_int_equal(SMR_E_STATE, smr_tick(s, 0, NULL));
    assert_int_equal(SMR_E_INPUT, smr_surface_step(surface, 0, NULL, 0));
    assert_int_equal(SMR_OK, smr_tick(s, 0, NULL)); /* it is as it was */
    assert_int_equal(SMR_OK, smr_surface_refit(surface, next.xyz));
    do {
        assert_int_equal(SMR_E_STATE, smr_tick(s, 0, NULL));
        assert_int_equal(SMR_E_STATE, smr_set_surface(s, SMR_ALL, surface));
        assert_int_equal(SMR_E_STATE, smr_surface_refit(surface, next.xyz));
    } while (smr_surface_step(surface, 1, NULL, 0) == SMR_PARTIAL);
    assert_int_equal(SMR_E_STATE, smr_tick(s, 0, NULL));
    assert_int_equal(SMR_OK, smr_set_surface(s, SMR_ALL, surface));
    assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
}
