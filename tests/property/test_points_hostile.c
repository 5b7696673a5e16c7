/* test_points_hostile.c: any points are refused or keep every position finite; and the nearest of a cloud.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include <string.h>
#include "base/arena.h"
#include "property/rig_cloud.h"

enum { PARTS = RIG_PAIR, CAPACITY = RIG_CLOUD_ROOM };

static smr_mesh part[PARTS];
static const smr_model *model;

BEFORE_EACH_TEST()
{
    const rig_pair pair = rig_pair_make();
    memcpy(part, pair.part, sizeof part);
    model = pair.model;
}

typedef rig_point point;

static void add(smr_points *cloud, const point *p) { assert_int_equal(SMR_OK, rig_cloud_add(cloud, p)); }

/* ---- what is refused */

TEST(test_refused)
{
    static const float bad[] = {NAN, INFINITY, 1.1e5f, -2e5f};
    smr_points *cloud = rig_cloud(4), *out = cloud;
    smr_surface *surface = NULL;
    unsigned char *memory = rig_alloc(4096);
    point p = {{20, 2, 3}, {0, 0, 2}, 1};
    size_t bytes = 7;
    uint32_t n = 9;
    assert_int_equal(SMR_E_NULL, smr_points_bytes(1, NULL));
    assert_int_equal(SMR_E_INPUT, smr_points_bytes(0, &bytes));
    assert_int_equal(SMR_E_INPUT, smr_points_bytes(SMR_VERTICES_MAX + 1u, &bytes));
    assert_int_equal(7, bytes);
    assert_int_equal(SMR_E_NULL, smr_points_open(1, NULL, 4096, &out));
    assert_int_equal(SMR_E_NULL, smr_points_open(1, memory, 4096, NULL));
    assert_int_equal(SMR_E_ALIGN, smr_points_open(1, memory + 4, 4000, &out));
    assert_int_equal(SMR_E_INPUT, smr_points_open(0, memory, 4096, &out));
    assert_int_equal(SMR_OK, smr_points_bytes(8, &bytes));
    assert_int_equal(SMR_E_ARENA, smr_points_open(8, memory, bytes - 1u, &out));
    assert_ptr_equal(cloud, out);
    for (uint32_t i = 0; i < 7u; i++)
        for (uint32_t k = 0; k < 4u; k++) {
            point q = p;
            *(i < 3u ? &q.xyz[i] : i < 6u ? &q.normal[i - 3u] : &q.weight) = bad[k];
            assert_int_equal(SMR_E_INPUT, smr_points_add(cloud, q.xyz, q.normal, &q.weight, 1));
        }
    p.weight = -1.0f;
    assert_int_equal(SMR_E_INPUT, smr_points_add(cloud, p.xyz, NULL, &p.weight, 1));
    assert_int_equal(SMR_E_INPUT, smr_points_add(cloud, part[0].xyz, NULL, NULL, 5));
    assert_int_equal(SMR_E_NULL, smr_points_add(cloud, NULL, NULL, NULL, 1));
    assert_int_equal(SMR_OK, smr_points_add(cloud, NULL, NULL, NULL, 0));
    assert_int_equal(SMR_E_STATE, smr_points_add((smr_points *)(void *)memory, p.xyz, NULL, NULL, 1));
    assert_int_equal(SMR_OK, smr_points_count(cloud, &n));
    assert_int_equal(0, n);
    assert_int_equal(SMR_E_INPUT, smr_points_surface(cloud, memory, 4096, &surface)); /* empty */
}

/* What a registration refuses, and what it does with a cloud that has changed. */
TEST(test_set_points)
{
    smr_points *cloud = rig_cloud(4);
    smr_config c = smr_config_default();
    unsigned char *memory = rig_alloc(4096);
    smr_tick_report report;
    const point p = {{20, 2, 3}, {0, 0, 2}, 1};
    c.basic.n_target_vertices = 3;
    smr *s = rig_init(model, &c, NULL);
    assert_int_equal(SMR_E_ARENA, smr_set_points(s, SMR_ALL, cloud));
    assert_int_equal(SMR_E_INPUT, smr_set_points(s, PARTS, cloud));
    assert_int_equal(SMR_E_STATE, smr_set_points(s, 0, (const smr_points *)(const void *)memory));
    assert_int_equal(SMR_E_NULL, smr_set_points(NULL, 0, cloud));
    c.basic.n_target_vertices = 0;
    assert_int_equal(SMR_E_ARENA, smr_set_points(rig_init(model, &c, NULL), SMR_ALL, cloud));
    c.basic.n_target_vertices = 4;
    s = rig_init(model, &c, NULL);
    assert_int_equal(SMR_OK, smr_set_points(s, SMR_ALL, cloud));
    assert_int_equal(SMR_OK, smr_tick(s, 0, NULL)); /* an empty cloud shows nothing */
    assert_int_equal(SMR_OK, smr_points_add(cloud, p.xyz, NULL, NULL, 1));
    assert_int_equal(SMR_E_STATE, smr_tick(s, 0, NULL));
    assert_int_equal(SMR_OK, smr_set_points(s, SMR_ALL, cloud));
    assert_int_equal(SMR_OK, smr_tick(s, 0, &report));
    assert_true(report.n_forces > 0u);
    assert_int_equal(SMR_E_INPUT, smr_points_weigh(cloud, 1, 0.0f));
    assert_int_equal(SMR_E_INPUT, smr_points_weigh(cloud, 0, NAN));
    assert_int_equal(SMR_E_INPUT, smr_points_weigh(cloud, 0, 4.5f));
    assert_int_equal(SMR_E_NULL, smr_points_weigh(NULL, 0, 1.0f));
    assert_int_equal(SMR_OK, smr_points_weigh(cloud, 0, 0.0f)); /* a mistake: it pulls nothing */
    assert_int_equal(SMR_E_STATE, smr_tick(s, 0, NULL));
    assert_int_equal(SMR_OK, smr_set_points(s, SMR_ALL, cloud));
    assert_int_equal(SMR_OK, smr_tick(s, 0, &report));
    assert_int_equal(0, report.n_forces);
    assert_int_equal(SMR_OK, smr_points_clear(cloud));
    assert_int_equal(SMR_E_STATE, smr_tick(s, 0, NULL));
}

/* Any points, however they lie, keep every position finite. */
TEST(test_hostile_points)
{
    uint32_t seed = 77;
    for (uint32_t n = 0; n < 40u; n++) {
        const float size = n % 4u == 0u ? 1.0e5f : (n % 4u == 1u ? 1.0e-6f : 60.0f);
        smr_points *cloud = rig_cloud(CAPACITY);
        smr_config c = rig_cloud_config(&seed);
        c.basic.n_workers = 1;
        c.basic.search_mm = 1.0e5f;
        smr *s = rig_init(model, &c, NULL);
        for (uint32_t i = 0; i < 3u * CAPACITY; i++) {
            point p = {{0, 0, 0}, {0, 0, 0}, rig_between(&seed, 0, 4)};
            for (uint32_t k = 0; k < 3u; k++) {
                p.xyz[k] = rig_random(&seed, 5) ? rig_between(&seed, -size, size) : part[0].xyz[3u * (i % 50u) + k];
                p.normal[k] = rig_random(&seed, 3) ? rig_between(&seed, -1, 1) : 0.0f;
            }
            add(cloud, &p);
            if (i % 16u == 0u) {
                assert_int_equal(SMR_OK, smr_set_points(s, i % 32u ? SMR_ALL : 0u, i % 64u ? cloud : NULL));
                assert_int_equal(SMR_OK, smr_set_points(s, 1, cloud));
                if (i % 32u == 0u)
                    assert_int_equal(SMR_OK, smr_set_points(s, 0, cloud));
                assert_int_equal(SMR_OK, smr_tick(s, 0, NULL));
            }
        }
        assert_true(rig_finite(rig_positions(s, model), part[0].n_vertices + part[1].n_vertices));
    }
}

/* The copy of a cloud that is made in pieces has the bytes of one made at once, and is none until then, nor where the
 * cloud has changed. */
TEST(test_copy_in_pieces)
{
    smr_points *cloud = rig_cloud(CAPACITY);
    smr_surface *surface = NULL;
    smr_closest hit;
    uint32_t seed = 9, calls = 0;
    size_t bytes = 0;
    smr_status status = SMR_PARTIAL;
    const float p[3] = {1, 2, 3};
    for (uint32_t i = 0; i < CAPACITY; i++) {
        const point one = rig_cloud_point(&seed, 0, 20.0f, 5.0f);
        add(cloud, &one);
    }
    assert_int_equal(SMR_OK, smr_points_surface_bytes(CAPACITY, &bytes));
    unsigned char *memory = rig_alloc(bytes), *whole = rig_alloc(bytes);
    assert_int_equal(SMR_E_ARENA, smr_points_surface_begin(cloud, memory, bytes - 1u, &surface));
    assert_true(surface == NULL);
    memset(memory, 0x5a, bytes);
    assert_int_equal(SMR_OK, smr_points_surface(cloud, memory, bytes, &surface));
    smr_arena_release(memory, bytes);
    memcpy(whole, memory, bytes);
    memset(memory, 0x5a, bytes);
    assert_int_equal(SMR_OK, smr_points_surface_begin(cloud, memory, bytes, &surface));
    for (; status == SMR_PARTIAL; calls++) {
        assert_int_equal(SMR_E_STATE, smr_surface_closest(surface, p, NULL, 0, 100, &hit));
        status = smr_surface_step(surface, 1, NULL, 0);
    }
    assert_true(status == SMR_OK && calls >= 18u);
    assert_int_equal(SMR_OK, smr_surface_step(surface, 1, NULL, 0));
    assert_int_equal(SMR_E_STATE, smr_surface_refit(surface, p));
    smr_arena_release(memory, bytes);
    assert_memory_equal(whole, memory, bytes);
    assert_int_equal(SMR_OK, smr_points_surface_begin(cloud, memory, bytes, &surface));
    assert_int_equal(SMR_PARTIAL, smr_surface_step(surface, 2, NULL, 0));
    assert_int_equal(SMR_OK, smr_points_weigh(cloud, 0, 0.5f));
    assert_int_equal(SMR_E_INPUT, smr_surface_step(surface, 0, NULL, 0));
    assert_int_equal(SMR_E_STATE, smr_surface_step(surface, 0, NULL, 0));
}

/* The nearest of all points, and its normal. */
TEST(test_nearest_point)
{
    smr_points *cloud = rig_cloud(CAPACITY);
    smr_surface *surface = NULL;
    point all[CAPACITY];
    uint32_t seed = 4;
    size_t bytes = 0;
    for (uint32_t i = 0; i < CAPACITY; i++) {
        all[i] = rig_cloud_point(&seed, 0, 20.0f, 5.0f);
        add(cloud, &all[i]);
    }
    assert_int_equal(SMR_OK, smr_points_surface_bytes(CAPACITY, &bytes));
    assert_int_equal(SMR_E_ARENA, smr_points_surface(cloud, rig_alloc(bytes), bytes - 1u, &surface));
    assert_int_equal(SMR_OK, smr_points_surface(cloud, rig_alloc(bytes), bytes, &surface));
    for (uint32_t k = 0; k < 50u; k++) {
        const point q = rig_cloud_point(&seed, 0, 15.0f, 10.0f);
        float least = 1.0e9f;
        uint32_t best = 0;
        smr_closest hit;
        for (uint32_t i = 0; i < CAPACITY; i++) {
            const float d = rig_far(q.xyz, all[i].xyz, 1);
            best = d < least ? i : best;
            least = d < least ? d : least;
        }
        assert_int_equal(SMR_OK, smr_surface_closest(surface, q.xyz, NULL, -1.0f, 1000.0f, &hit));
        assert_true(hit.triangle == best && fabsf(hit.distance - least) < 1e-4f && hit.on_border == 0u);
    }
    smr_config c = smr_config_default();
    assert_int_equal(SMR_E_STATE, smr_set_surface(rig_init(model, &c, NULL), 0, surface));
}
