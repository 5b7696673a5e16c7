/* test_articulated.c: start positions of one surface with a joint. A flat limb is bent by 50 and 70 degrees, and a
 * part of its end is cut off: vertices are found, with the same bits in pieces and with any scheduler; what nothing
 * joins stays. A limb that has not bent, that lies elsewhere, or that does not explain the target is left alone.
 * Accuracy, mean: 0.8 mm of a limb of 400 mm; 0.5 mm where the target shows nine tenths; without rigid bodies 1 to 2.
 * SPDX-License-Identifier: MIT */
#include "suite.h"

#include <fenv.h>
#include <math.h>
#include <string.h>

#include "rig_parts.h"

#define FOUND_MM 0.8f
#define CUT_MM 0.5f

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

/* The triangles of vertices that lie between z = low and top at rest. */
static smr_mesh between(const smr_mesh *mesh, const smr_mesh *rest, float low, float top)
{
    uint32_t *t = rig_alloc(12u * (size_t)mesh->n_triangles), n = 0;
    for (uint32_t k = 0; k < mesh->n_triangles; k++) {
        const uint32_t *from = rest->triangles + 3u * (size_t)k;
        int inside = 1;
        for (uint32_t i = 0; i < 3u; i++)
            inside &= rest->xyz[3u * from[i] + 2u] > low && rest->xyz[3u * from[i] + 2u] < top;
        if (inside)
            memcpy(t + 3u * (size_t)n++, from, 12u);
    }
    return (smr_mesh){mesh->xyz, t, mesh->n_vertices, n};
}

static uint32_t n_steps; /* calls of smr_job_step() by found() */

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
    (void)feclearexcept(FE_ALL_EXCEPT);
    for (n_steps = 0; status == SMR_PARTIAL; n_steps++)
        status = smr_job_step(&job, units, NULL, 0);
    assert_int_equal(0, fetestexcept(FE_DIVBYZERO | FE_INVALID | FE_OVERFLOW)); /* neither infinity nor NaN */
    assert_int_equal(SMR_OK, status);
    return is_bent;
}

TEST(test_bends)
{
    static const float degrees[][2] = {{0, 50}, {0, 70}, {170, 120}}; /* a hairpin, whose sides lie close */
    for (uint32_t i = 0; i < 3u; i++) {
        const smr_mesh straight = limb(), rest = bent(&straight, degrees[i][0]);
        const smr_mesh target = bent(&straight, degrees[i][1]), cut = between(&target, &straight, -300, 160);
        const smr_port port = rig_port(RIG_SHUFFLE, 3);
        float *at = rig_alloc(12u * (size_t)rest.n_vertices), *again = rig_alloc(12u * (size_t)rest.n_vertices);
        assert_true(found(&rest, &target, &here, 0, NULL, at) > 0u);
        assert_true(rig_mean_far(at, target.xyz, rest.n_vertices) < FOUND_MM);
        assert_true(found(&rest, &target, &here, 997u, &port, again) > 0u);
        assert_memory_equal(at, again, 12u * (size_t)rest.n_vertices);
        assert_true(found(&rest, &cut, &here, 0, NULL, at) > 0u);
        assert_true(rig_mean_far(at, target.xyz, rest.n_vertices) < CUT_MM);
        rig_free_all();
    }
}

/* A round limb: no place tells of turns about its length, which no body may follow. */
TEST(test_round)
{
    static const float stretch[9] = {1, 0, 0, 0, 1, 0, 0, 0, 10}, centre[3] = {0, 0, 0};
    const smr_mesh ball = rig_ball(20.0f, 80, 40, centre), rest = rig_moved(&ball, stretch, centre);
    float *at = rig_alloc(12u * (size_t)rest.n_vertices);
    for (float degrees = 30.0f; degrees < 60.0f; degrees += 20.0f) {
        const smr_mesh target = bent(&rest, degrees);
        assert_true(found(&rest, &target, &here, 0, NULL, at) > 0u);
        assert_true(rig_mean_far(at, target.xyz, rest.n_vertices) < FOUND_MM);
    }
    rig_free_all();
}

/* A limb, thicker on one side of its lower half, started in place and turned about its length: the least is right. */
TEST(test_tells_back_from_front)
{
    static const smr_pose back = {{{-1, 0, 0, 0}, {0, -1, 0, 0}, {0, 0, 1, 0}}};
    const smr_mesh rest = limb();
    float *xyz = (float *)(uintptr_t)rest.xyz, *at = rig_alloc(12u * (size_t)rest.n_vertices);
    for (uint32_t v = 0; v < rest.n_vertices; v++) {
        const float from = (xyz[3u * v + 2u] + 90.0f) / 50.0f;
        xyz[3u * v + 1u] *= xyz[3u * v + 1u] > 0.0f ? 1.0f + 0.5f / (1.0f + from * from) : 1.0f;
    }
    for (float degrees = 30.0f; degrees < 60.0f; degrees += 20.0f) {
        const smr_mesh target = bent(&rest, degrees);
        const uint32_t turned = found(&rest, &target, &back, 0, NULL, at);
        const uint32_t right = found(&rest, &target, &here, 0, NULL, at);
        assert_true(right > 0u && (turned == 0u || turned > 2u * right));
        assert_true(rig_mean_far(at, target.xyz, rest.n_vertices) < FOUND_MM);
    }
    rig_free_all();
}

/* A ball beside the limb, which no neighbour joins, and a needle without area, whose far corners are in no patch. */
TEST(test_keeps_the_rest)
{
    static const float beside[3] = {150, 0, 0};
    const smr_mesh rest = limb(), target = bent(&rest, 60.0f), ball = rig_ball(20, 20, 20, beside);
    const float *tip = rest.xyz,
                line[] = {tip[0], tip[1], tip[2], tip[0], tip[1], tip[2] - 64.0f, tip[0], tip[1], tip[2] - 128.0f};
    static const uint32_t ends[] = {0, 1, 2};
    const smr_mesh needle = {line, ends, 3, 1}, all[] = {rest, ball, needle}, model = rig_joined(all, 3);
    const uint32_t n = model.n_vertices - rest.n_vertices;
    float *at = rig_alloc(12u * (size_t)model.n_vertices);
    ((uint32_t *)(uintptr_t)model.triangles)[3u * model.n_triangles - 3u] = 0; /* begins at the limb's tip */
    assert_true(found(&model, &target, &here, 0, NULL, at) > 0u);
    assert_true(rig_mean_far(at, target.xyz, rest.n_vertices) < FOUND_MM);
    assert_true(rig_far(at + 3u * (size_t)rest.n_vertices, model.xyz + 3u * (size_t)rest.n_vertices, n) < 1.0e-3f);
    rig_free_all();
}

TEST(test_leaves_alone)
{
    static const float same[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, near[3] = {3, -2, 5}, far[3] = {90, 60, 0};
    static const float centre[3] = {0, 0, 0}, beside[3] = {150, 0, 0}, line[9] = {0, 0, 0, 5, 0, 0, 10, 0, 0};
    static const float across[9] = {-1, 0, 0, 0, 1, 0, 0, 0, 1};
    static const uint32_t flat[3] = {0, 1, 2};
    const smr_mesh rest = limb(), moved = rig_moved(&rest, same, near), away = rig_moved(&rest, same, far);
    const smr_mesh part = between(&rest, &rest, -300, 0), little = bent(&rest, 2.0f),
                   large = rig_ball(300, 80, 60, centre);
    const smr_mesh thin = {line, flat, 3, 1}, turned = bent(&rest, 60.0f), low = between(&turned, &rest, -300, 40);
    const smr_mesh high = between(&turned, &rest, 70, 300), gap = rig_joined((const smr_mesh[]){low, high}, 2);
    const smr_mesh more = rig_ball(32, 20, 20, beside), other = rig_moved(&more, across, centre);
    const smr_mesh with_more = rig_joined((const smr_mesh[]){rest, more}, 2),
                   with_other = rig_joined((const smr_mesh[]){turned, other}, 2);
    const smr_mesh *const pair[][2] = {{&rest, &rest}, {&rest, &moved},           {&rest, &away},
                                       {&rest, &part}, {&rest, &little},          {&rest, &large},
                                       {&thin, &rest}, {&with_more, &with_other}, {&rest, &gap}};
    float *at = rig_alloc(12u * (size_t)with_more.n_vertices);
    for (uint32_t i = 0; i < sizeof pair / sizeof pair[0]; i++) {
        assert_true(found(pair[i][0], pair[i][1], &here, 0, NULL, at) == 0u);
        for (uint32_t k = 0; k < 3u * pair[i][0]->n_vertices; k++)
            assert_true(at[k] == 0.0f);
    }
    rig_free_all();
}

/* A part of the limb and all of it: where the part shows the joint, the part bends; where it shows the limb's near half
 * and little more, another body could lie there, too. */
TEST(test_parts)
{
    static const struct {
        float degrees, low, top;
        int of_model, bends;
    } part[] = {{20, -300, 60, 1, 0}, {20, -60, 60, 1, 1}, {20, -60, 60, 0, 1}, {60, 0, 60, 0, 0}};
    const smr_mesh rest = limb();
    float *at = rig_alloc(12u * (size_t)rest.n_vertices);
    for (uint32_t i = 0; i < sizeof part / sizeof part[0]; i++) {
        const smr_mesh target = bent(&rest, part[i].degrees);
        const smr_mesh cut = between(part[i].of_model ? &rest : &target, &rest, part[i].low, part[i].top);
        const uint32_t n =
            part[i].of_model ? found(&cut, &target, &here, 0, NULL, at) : found(&rest, &cut, &here, 0, NULL, at);
        assert_int_equal(part[i].bends, n > 0u);
    }
    rig_free_all();
}

/* Onto a bent limb with bumps the call ends once half of the limb has joined. */
TEST(test_other_body)
{
    const smr_mesh rest = limb(), same = bent(&rest, 12.0f);
    const size_t bytes = 12u * (size_t)rest.n_vertices;
    float *at = rig_alloc(bytes), *xyz = rig_alloc(bytes);
    memcpy(xyz, same.xyz, bytes);
    for (uint32_t v = 0; v < rest.n_vertices; v++)
        xyz[3u * v + 1u] *= 1.0f + 0.3f * cosf(0.2f * rest.xyz[3u * v + 2u]);
    const smr_mesh other = {xyz, rest.triangles, rest.n_vertices, rest.n_triangles};
    assert_true(found(&rest, &same, &here, 1, NULL, at) > 0u);
    const uint32_t whole = n_steps;
    assert_int_equal(0, found(&rest, &other, &here, 1, NULL, at));
    assert_true(n_steps < whole - whole / 4u);
    rig_free_all();
}

/* A limb of so few vertices that all of it acts on each of its parts. */
TEST(test_few_vertices)
{
    static const float stretch[9] = {0.9f, 0, 0, 0, 1.4f, 0, 0, 0, 10}, centre[3] = {0, 0, 0};
    const smr_mesh ball = rig_ball(20.0f, 15, 4, centre), rest = rig_moved(&ball, stretch, centre), fine = limb();
    const smr_mesh target = bent(&fine, 20), truth = bent(&rest, 20);
    float *at = rig_alloc(12u * (size_t)rest.n_vertices);
    assert_true(found(&rest, &target, &here, 0, NULL, at) > 0u);
    assert_true(rig_mean_far(at, truth.xyz, rest.n_vertices) < FOUND_MM);
    rig_free_all();
}

/* Without area, or a twentieth of a millimetre in size: nothing is found, and nothing is divided by 0. */
TEST(test_hardly_surfaces)
{
    static const float line[] = {0, 0, 0, 1, 0, 0, 2, 0, 0, 3, 0, 0};
    static const uint32_t along[] = {0, 1, 2, 1, 2, 3};
    const smr_mesh rest = limb(), flat = {line, along, 4, 2}, target = bent(&rest, 50);
    const smr_pose tiny = {{{0.0011f, 0, 0, 0}, {0, 0.0011f, 0, 0}, {0, 0, 0.0011f, 0}}};
    float *at = rig_alloc(12u * (size_t)rest.n_vertices);
    assert_int_equal(0, found(&rest, &flat, &here, 0, NULL, at));
    assert_int_equal(0, found(&flat, &rest, &here, 0, NULL, at));
    assert_int_equal(0, found(&rest, &target, &tiny, 0, NULL, at));
}

/* Nothing is written beyond the memory, which ends with the last of the target's 128 vertices. */
TEST(test_keeps_to_its_memory)
{
    static const float centre[3] = {0, 0, 0};
    const smr_mesh ball = rig_ball(20.0f, 6, 21, centre);
    const smr_surface *s = rig_surface(&ball);
    uint32_t is_bent;
    size_t bytes;
    smr_job job;
    assert_int_equal(SMR_OK, smr_articulated_bytes(s, s, &bytes));
    unsigned char *const memory = rig_alloc(bytes + SMR_ALIGN);
    float *const xyz = rig_alloc(12u * (size_t)ball.n_vertices);
    memset(memory, 0x55, bytes + SMR_ALIGN);
    assert_int_equal(SMR_OK, smr_articulated_begin(s, s, &here, NULL, memory, bytes, xyz, &is_bent, &job));
    assert_int_equal(SMR_OK, smr_job_step(&job, UINT32_MAX, NULL, 0));
    for (size_t i = bytes; i < bytes + SMR_ALIGN; i++)
        assert_int_equal(0x55, memory[i]);
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
    assert_int_equal(SMR_OK, smr_surface_refit(s, rest.xyz)); /* only a change after the beginning counts */
    assert_int_equal(SMR_OK, smr_surface_step(s, 0, NULL, 0));
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
