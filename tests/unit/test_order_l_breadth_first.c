/* test_order_l_breadth_first.c: the paper's own order L equals a plain breadth-first search written here: one-rings of
 * radius s_min, seeds with the largest one-ring first, members in ascending order along the curve.
 * SPDX-License-Identifier: MIT */
#include "cmocka_first.h"

#include <math.h>
#include <string.h>

#include "unit_lists.h"

/* near[a * n + b]: b is in the one-ring of a; at: [n] the stored vertex at each place of the curve. */
static void one_rings(const smr_model *m, const uint32_t *at, int separate, unsigned char *near)
{
    const uint32_t n = smr_le32(m->n_vertices);
    float *xyz = unit_stored(m), s_min2 = 0.0f;
    for (int pass = 0; pass < 2; pass++) {
        const float s_min = sqrtf(s_min2) * 1.000001f;
        for (uint32_t a = 0; a < n; a++) {
            float nearest = -1.0f;
            for (uint32_t b = 0; b < n; b++) {
                const float *p = xyz + 3u * (size_t)at[a], *q = xyz + 3u * (size_t)at[b];
                const float x = p[0] - q[0], y = p[1] - q[1], z = p[2] - q[2], d2 = x * x + y * y + z * z;
                const int apart = separate && unit_kept_apart(m, at[a], at[b]);
                if (a != b && !apart && (nearest < 0.0f || d2 < nearest))
                    nearest = d2;
                near[(size_t)a * n + b] = !apart && d2 <= s_min * s_min;
            }
            s_min2 = fmaxf(s_min2, nearest);
        }
    }
    unit_free(xyz);
}

static void plain_walk(const unsigned char *near, uint32_t n, uint32_t *vertex, uint32_t *parent)
{
    uint32_t *size = unit_memory(4u * (size_t)n), tail = 0, head = 0;
    unsigned char *seen = unit_memory(n);
    memset(seen, 0, n);
    for (uint32_t a = 0; a < n; a++) {
        size[a] = 0;
        for (uint32_t b = 0; b < n; b++)
            size[a] += near[(size_t)a * n + b];
    }
    while (head < n) {
        if (head == tail) {
            uint32_t seed = SMR_NONE;
            for (uint32_t a = 0; a < n; a++)
                if (!seen[a] && (seed == SMR_NONE || size[a] > size[seed]))
                    seed = a;
            seen[seed] = 1;
            parent[tail] = seed;
            vertex[tail++] = seed;
        }
        const uint32_t v = vertex[head++];
        for (uint32_t b = 0; b < n; b++)
            if (near[(size_t)v * n + b] && !seen[b]) {
                seen[b] = 1;
                parent[tail] = v;
                vertex[tail++] = b;
            }
    }
    unit_free(size);
    unit_free(seen);
}

static void check(const smr_structure *structures, uint32_t n_structures, const smr_prepare_config *c)
{
    unit_image image = unit_prepare(structures, n_structures, c);
    const uint32_t n = smr_le32(image.model->n_vertices);
    uint32_t *v = unit_memory(20u * (size_t)n), *up = v + n, *want = up + n, *want_up = want + n, *at = want_up + n;
    unsigned char *near = unit_memory((size_t)n * n);
    for (uint32_t i = 0; i < n; i++)
        at[smr_model_along(image.model, i)] = i;
    for (uint32_t k = 0; k < c->n_radii; k++) {
        smr_model_info info;
        assert_int_equal(smr_model_get_info(image.model, &info), SMR_OK);
        assert_int_equal(info.n_blocks[k], 1);
        assert_int_equal(info.order, SMR_ORDER_BREADTH_FIRST);
        one_rings(image.model, at, (int)info.separate[k], near);
        plain_walk(near, n, want, want_up);
        unit_chain_order(image.model, k, v, up);
        for (uint32_t i = 0; i < n; i++) {
            want[i] = at[want[i]];
            want_up[i] = at[want_up[i]];
        }
        assert_memory_equal(v, want, 4u * (size_t)n);
        assert_memory_equal(up, want_up, 4u * (size_t)n);
    }
    unit_free(v);
    unit_free(near);
    unit_image_free(&image);
}

static void equals_a_plain_walk(void **state)
{
    oracle_random r = oracle_seed(150);
    (void)state;
    for (uint32_t i = 0; i < 10u; i++) {
        unit_mesh a = i % 2u ? unit_points(&r, 1u + oracle_below(&r, 250u), 0.0f, 50.0f) : unit_sphere(2, 20.0f, 25.0f);
        unit_mesh b = unit_grid(6, 1u + i, 5.0f);
        const smr_structure two[2] = {{"a", unit_view(&a)}, {"b", unit_view(&b)}};
        smr_prepare_config c = smr_prepare_config_default();
        c.order = SMR_ORDER_BREADTH_FIRST;
        c.n_radii = 2;
        c.radius_mm[0] = 25.0f;
        c.radius_mm[1] = 6.0f; /* separate */
        check(two, 2, &c);
        check(two, 1, &c);
        unit_mesh_free(&a);
        unit_mesh_free(&b);
    }
}

/* Far islands: each is a tree of its own once s_min is small. */
static void islands_have_a_seed_each(void **state)
{
    unit_mesh m = unit_mesh_new(60, 0);
    smr_prepare_config c = smr_prepare_config_default();
    (void)state;
    for (uint32_t i = 0; i < 60u; i++) {
        m.xyz[3u * i] = (float)(i % 20u);
        m.xyz[3u * i + 1u] = 1000.0f * (float)(i / 20u);
        m.xyz[3u * i + 2u] = 0.0f;
    }
    c.order = SMR_ORDER_BREADTH_FIRST;
    c.n_radii = 1;
    c.radius_mm[0] = 3.0f;
    const smr_structure one = {"islands", unit_view(&m)};
    check(&one, 1, &c);
    unit_image image = unit_prepare_mesh(&m, &c);
    uint32_t v[60], up[60], roots = 0;
    unit_chain_order(image.model, 0, v, up);
    for (int i = 0; i < 60; i++)
        roots += v[i] == up[i];
    assert_int_equal(roots, 3);
    unit_image_free(&image);
    unit_mesh_free(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(equals_a_plain_walk),
        cmocka_unit_test(islands_have_a_seed_each),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
