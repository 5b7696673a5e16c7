/* test_articulated.c: start positions of one surface with a joint. A flat limb is bent by 50 and 70 degrees, and a
 * part of its end is cut off: vertices are found, with the same bits in pieces and with any scheduler. A limb that has
 * not bent, or that lies elsewhere, is left alone.
 * Accuracy, mean: 2 mm of a limb of 400 mm; 3 mm where the target shows nine tenths.
 * SPDX-License-Identifier: MIT */
#include "suite.h"

#include <math.h>
#include <string.h>

#include "rig.h"

#define FOUND_MM 2.0f
#define CUT_MM 3.0f

static const smr_pose here = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};

static smr_mesh limb(void)
{
    static const float stretch[9] = {0.9f, 0, 0, 0, 1.4f, 0, 0, 0, 10}, centre[3] = {0, 0, 0};
    const smr_mesh ball = rig_ball(20.0f, 80, 40, centre);
    return rig_moved(&ball, stretch, centre);
}

/* Bends what lies above z = 20 about the y axis, within 30 mm. */
static smr_mesh bent(const smr_mesh *rest, float degrees)
{
    float *xyz = rig_alloc(12u * (size_t)rest->n_vertices);
    for (uint32_t v = 0; v < rest->n_vertices; v++) {
        const float *p = rest->xyz + 3u * (size_t)v, z = p[2] - 20.0f;
        const float t = fminf(fmaxf(0.5f + z / 60.0f, 0.0f), 1.0f), a = degrees * t * t * (3 - 2 * t) * 0.01745329f;
        xyz[3u * v] = p[0] * cosf(a) + z * sinf(a);
        xyz[3u * v + 1u] = p[1];
        xyz[3u * v + 2u] = 20.0f + z * cosf(a) - p[0] * sinf(a);
    }
    return (smr_mesh){xyz, rest->triangles, rest->n_vertices, rest->n_triangles};
}

/* The triangles of vertices that lie below z = `top` at rest. */
static smr_mesh below(const smr_mesh *mesh, const smr_mesh *rest, float top)
{
    uint32_t *t = rig_alloc(12u * (size_t)mesh->n_triangles), n = 0;
    for (uint32_t k = 0; k < mesh->n_triangles; k++) {
        const uint32_t *from = rest->triangles + 3u * (size_t)k;
        if (rest->xyz[3u * from[0] + 2u] < top && rest->xyz[3u * from[1] + 2u] < top &&
            rest->xyz[3u * from[2] + 2u] < top)
            memcpy(t + 3u * (size_t)n++, from, 12u);
    }
    return (smr_mesh){mesh->xyz, t, mesh->n_vertices, n};
}

static uint32_t found(const smr_mesh *model, const smr_mesh *target, const smr_pose *start, uint32_t units,
                      const smr_port *port, float *xyz)
{
    const smr_surface *a = rig_surface(model), *b = rig_surface(target);
    uint32_t is_bent = 7;
    size_t bytes;
    smr_job job;
    memset(xyz, 0, 12u * (size_t)model->n_vertices);
    assert_int_equal(SMR_OK, smr_articulated_bytes(a, b, &bytes));
    assert_int_equal(SMR_OK, smr_articulated_begin(a, b, start, port, rig_rough(bytes), bytes, xyz, &is_bent, &job));
    smr_status status = SMR_PARTIAL;
    while (status == SMR_PARTIAL)
        status = smr_job_step(&job, units, NULL, 0);
    assert_int_equal(SMR_OK, status);
    return is_bent;
}

static float mean_far(const float *a, const float *b, uint32_t n)
{
    float sum = 0.0f;
    for (uint32_t v = 0; v < n; v++)
        sum += rig_far(a + 3u * (size_t)v, b + 3u * (size_t)v, 1);
    return sum / (float)n;
}

TEST(test_bends)
{
    for (uint32_t i = 0; i < 2u; i++) {
        const smr_mesh rest = limb(), target = bent(&rest, i == 0u ? 50.0f : 70.0f),
                       cut = below(&target, &rest, 160.0f);
        const smr_port port = rig_port(RIG_SHUFFLE, 3);
        float *at = rig_alloc(12u * (size_t)rest.n_vertices), *again = rig_alloc(12u * (size_t)rest.n_vertices);
        assert_true(found(&rest, &target, &here, 0, NULL, at) == 1u);
        assert_true(mean_far(at, target.xyz, rest.n_vertices) < FOUND_MM);
        assert_true(found(&rest, &target, &here, 997u, &port, again) == 1u);
        assert_memory_equal(at, again, 12u * (size_t)rest.n_vertices);
        assert_true(found(&rest, &cut, &here, 0, NULL, at) == 1u);
        assert_true(mean_far(at, target.xyz, rest.n_vertices) < CUT_MM);
        rig_free_all();
    }
}

TEST(test_leaves_alone)
{
    static const float same[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, near[3] = {3, -2, 5}, far[3] = {90, 60, 0};
    const smr_mesh rest = limb(), moved = rig_moved(&rest, same, near), away = rig_moved(&rest, same, far);
    const smr_mesh part = below(&rest, &rest, 0.0f), little = bent(&rest, 5.0f);
    const smr_mesh *const target[] = {&rest, &moved, &away, &part, &little};
    float *at = rig_alloc(12u * (size_t)rest.n_vertices);
    for (uint32_t i = 0; i < sizeof target / sizeof target[0]; i++) {
        assert_true(found(&rest, target[i], &here, 0, NULL, at) == 0u);
        for (uint32_t k = 0; k < 3u * rest.n_vertices; k++)
            assert_true(at[k] == 0.0f);
    }
    rig_free_all();
}

TEST(test_articulated_refusals)
{
    const smr_mesh rest = limb();
    smr_surface *s = rig_surface(&rest);
    smr_pose flat = here;
    float *at = rig_alloc(12u * (size_t)rest.n_vertices);
    uint32_t is_bent;
    size_t bytes;
    smr_job job;
    flat.m[2][2] = 0.0f;
    assert_int_equal(SMR_E_NULL, smr_articulated_bytes(s, NULL, &bytes));
    assert_int_equal(SMR_OK, smr_articulated_bytes(s, s, &bytes));
    char *memory = rig_alloc(bytes + 1u);
    assert_int_equal(SMR_E_NULL, smr_articulated_begin(s, s, &here, NULL, NULL, bytes, at, &is_bent, &job));
    assert_int_equal(SMR_E_NULL, smr_articulated_begin(s, s, &here, NULL, memory, bytes, NULL, &is_bent, &job));
    assert_int_equal(SMR_E_INPUT, smr_articulated_begin(s, s, &flat, NULL, memory, bytes, at, &is_bent, &job));
    assert_int_equal(SMR_E_ALIGN, smr_articulated_begin(s, s, &here, NULL, memory + 1, bytes, at, &is_bent, &job));
    assert_int_equal(SMR_E_ARENA, smr_articulated_begin(s, s, &here, NULL, memory, bytes - 1u, at, &is_bent, &job));
    assert_int_equal(SMR_OK, smr_articulated_begin(s, s, &here, NULL, memory, bytes, at, &is_bent, &job));
    assert_int_equal(SMR_PARTIAL, smr_job_step(&job, 5, NULL, 0));
    assert_int_equal(SMR_OK, smr_surface_refit(s, rest.xyz));
    assert_int_equal(SMR_E_STATE, smr_job_step(&job, 5, NULL, 0));
    rig_free_all();
}
