/* test_prepare.c: the limits of smr_prepare(): every refusal, exact memory, progress and abort, unusual meshes, and
 * the same model every time.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include <string.h>
#include "unit_exercise.h"

typedef struct bench {
    unit_mesh mesh;
    smr_structure one;
    smr_prepare_config config;
    size_t scratch_bytes, image_bytes;
    unsigned char *scratch, *image; /* exact */
} bench;

static bench set_up_with(const smr_volume *reference)
{
    bench b;
    b.mesh = unit_grid(9, 8, 3.0f);
    b.one.name = "sheet";
    b.one.mesh = unit_view(&b.mesh);
    b.config = smr_prepare_config_default();
    b.config.n_radii = 2;
    b.config.radius_mm[0] = 12.0f;
    b.config.radius_mm[1] = 5.0f;
    b.config.block_vertices = 16;
    b.config.reference = reference;
    assert_int_equal(smr_prepare_bytes(&b.one, 1, &b.config, &b.scratch_bytes), SMR_OK);
    b.scratch = rig_rough(b.scratch_bytes);
    assert_int_equal(smr_prepare(&b.one, 1, &b.config, b.scratch, b.scratch_bytes, NULL, 0, &b.image_bytes), SMR_OK);
    b.image = rig_rough(b.image_bytes);
    return b;
}

static bench set_up(void) { return set_up_with(NULL); }

static smr_status prepare(const bench *b)
{
    size_t bytes = 12345;
    const smr_status s =
        smr_prepare(&b->one, 1, &b->config, b->scratch, b->scratch_bytes, b->image, b->image_bytes, &bytes);
    assert_int_equal(bytes, s == SMR_OK ? b->image_bytes : 12345); /* untouched by a refusal */
    return s;
}

static void tear_down(bench *b)
{
    rig_free(b->scratch);
    rig_free(b->image);
    unit_mesh_free(&b->mesh);
}

TEST(null_everywhere)
{
    bench b = set_up();
    size_t bytes;
    assert_int_equal(smr_prepare_bytes(NULL, 1, &b.config, &bytes), SMR_E_NULL);
    assert_int_equal(smr_prepare_bytes(&b.one, 1, NULL, &bytes), SMR_E_NULL);
    assert_int_equal(smr_prepare_bytes(&b.one, 1, &b.config, NULL), SMR_E_NULL);
    assert_int_equal(smr_prepare(NULL, 1, &b.config, b.scratch, b.scratch_bytes, NULL, 0, &bytes), SMR_E_NULL);
    assert_int_equal(smr_prepare(&b.one, 1, NULL, b.scratch, b.scratch_bytes, NULL, 0, &bytes), SMR_E_NULL);
    assert_int_equal(smr_prepare(&b.one, 1, &b.config, NULL, b.scratch_bytes, NULL, 0, &bytes), SMR_E_NULL);
    assert_int_equal(smr_prepare(&b.one, 1, &b.config, b.scratch, b.scratch_bytes, NULL, 0, NULL), SMR_E_NULL);
    b.one.mesh.xyz = NULL;
    assert_int_equal(prepare(&b), SMR_E_NULL);
    b.one.mesh = unit_view(&b.mesh);
    b.one.mesh.triangles = NULL;
    assert_int_equal(prepare(&b), SMR_E_NULL);
    b.one.mesh = unit_view(&b.mesh);
    b.one.name = NULL;
    assert_int_equal(prepare(&b), SMR_OK);
}

TEST(configurations_out_of_range)
{
    static const float bad[] = {0.0f, -0.0f, -1.0f, NAN, INFINITY, -INFINITY, 1.1e5f};
    bench b = set_up();
    const smr_prepare_config good = b.config;
    size_t bytes = 77;
    for (uint32_t bit = 0; bit < 32u; bit++) {
        b.config.cookie = good.cookie ^ 1u << bit;
        assert_int_equal(prepare(&b), SMR_E_CONFIG);
        assert_int_equal(smr_prepare_bytes(&b.one, 1, &b.config, &bytes), SMR_E_CONFIG);
    }
    b.config = good;
    b.config.n_radii = SMR_RADII_MAX + 1u;
    assert_int_equal(prepare(&b), SMR_E_CONFIG);
    b.config.n_radii = SMR_ALL;
    assert_int_equal(prepare(&b), SMR_E_CONFIG);
    for (size_t k = 0; k < sizeof bad / sizeof bad[0]; k++) {
        for (uint32_t i = 0; i < 2u; i++) {
            b.config = good;
            b.config.radius_mm[i] = bad[k];
            assert_int_equal(prepare(&b), SMR_E_CONFIG);
        }
        b.config = good;
        b.config.radius_mm[2] = bad[k]; /* beyond n_radii: not looked at */
        assert_int_equal(prepare(&b), SMR_OK);
        b.config.separate_below_mm = bad[k];
        assert_int_equal(prepare(&b), k < 3u ? SMR_OK : SMR_E_CONFIG);
    }
    for (uint32_t field = 0; field < 6u; field++) {
        b.config = good;
        uint32_t *at[6] = {&b.config.distance, &b.config.mass,           &b.config.order,
                           &b.config.ring,     &b.config.block_vertices, &b.config.block_vertices};
        *at[field] = field == 4u ? 15u : (field == 5u ? 65537u : 2u);
        assert_int_equal(prepare(&b), SMR_E_CONFIG);
        *at[field] = SMR_ALL;
        assert_int_equal(prepare(&b), SMR_E_CONFIG);
    }
    assert_int_equal(bytes, 77);
}

static void check_memory(const smr_volume *reference)
{
    bench b = set_up_with(reference);
    assert_int_equal(prepare(&b), SMR_OK);
    size_t bytes = 4711;
    assert_int_equal(smr_prepare(&b.one, 1, &b.config, b.scratch, b.scratch_bytes - 1u, b.image, b.image_bytes, &bytes),
                     SMR_E_ARENA);
    assert_int_equal(smr_prepare(&b.one, 1, &b.config, b.scratch, 0, b.image, b.image_bytes, &bytes), SMR_E_ARENA);
    for (size_t short_by = 1; short_by <= b.image_bytes; short_by += short_by < 70u ? 1u : 333u) {
        const size_t capacity = b.image_bytes - short_by;
        unsigned char *image = rig_rough(capacity); /* exact: nothing is written beyond it */
        const smr_model *model = NULL;
        bytes = 0;
        assert_int_equal(smr_prepare(&b.one, 1, &b.config, b.scratch, b.scratch_bytes, image, capacity, &bytes),
                         SMR_E_ARENA);
        assert_int_equal(bytes, b.image_bytes);
        assert_int_equal(smr_model_open(image, capacity, &model), SMR_E_MODEL); /* nothing useful */
        rig_free(image);
    }
    for (size_t off = 1; off < SMR_ALIGN; off += 7u) {
        assert_int_equal(smr_prepare(&b.one, 1, &b.config, b.scratch + off, b.scratch_bytes, NULL, 0, &bytes),
                         SMR_E_ALIGN);
        assert_int_equal(smr_prepare(&b.one, 1, &b.config, b.scratch, b.scratch_bytes, b.image + off, 0, &bytes),
                         SMR_E_ALIGN);
    }
}

TEST(memory_to_the_byte)
{
    float *voxels;
    smr_volume image = rig_cube(20, 2, &voxels);
    check_memory(NULL);
    check_memory(&image);
    bench b = set_up_with(&image);
    image.spacing[1] = 0.0f; /* no image any more */
    assert_int_equal(prepare(&b), SMR_E_INPUT);
    tear_down(&b);
}

/* The same bytes twice, with dirty scratch and dirty image memory, and in more memory than needed. */
TEST(the_same_image_every_time)
{
    for (uint32_t i = 0; i < 8u; i++) {
        bench b = set_up();
        b.config.order = i & 1u;
        b.config.distance = i >> 1 & 1u;
        b.config.mass = i >> 2 & 1u;
        unit_image first = unit_prepare(&b.one, 1, &b.config);
        size_t scratch_bytes, bytes;
        assert_int_equal(smr_prepare_bytes(&b.one, 1, &b.config, &scratch_bytes), SMR_OK);
        unsigned char *scratch = rig_rough(scratch_bytes + 640u), *image = rig_rough(first.size + 640u);
        memset(scratch, (int)i * 31, scratch_bytes + 640u);
        memset(image, (int)i * 17 + 1, first.size + 640u);
        assert_int_equal(
            smr_prepare(&b.one, 1, &b.config, scratch, scratch_bytes + 640u, image, first.size + 640u, &bytes), SMR_OK);
        assert_int_equal(bytes, first.size);
        assert_memory_equal(image, first.bytes, bytes);
        for (size_t k = bytes; k < first.size + 640u; k++)
            assert_int_equal(image[k], i * 17u + 1u); /* nothing behind the image */
        rig_free(scratch);
        rig_free(image);
        unit_image_free(&first);
        tear_down(&b);
    }
}

/* The workers and the order of tasks are the port's own affair. */
TEST(the_same_image_whoever_works)
{
    for (uint32_t i = 0; i < 4u; i++) {
        bench b = set_up();
        unit_mesh_free(&b.mesh);
        b.mesh = unit_grid(40, 25, 3.0f);
        const smr_structure two[2] = {{"a", unit_view(&b.mesh)}, {"b", unit_view(&b.mesh)}};
        b.config.block_vertices = 700; /* many tasks a block, the last ones not full */
        b.config.n_radii = 3;
        b.config.radius_mm[2] = 4.0f;
        b.config.separate_below_mm = 10.0f; /* the first radius shares clusters, the others do not */
        b.config.order = i & 1u;
        b.config.distance = i >> 1 & 1u;
        const unit_image alone = unit_prepare(two, 2, &b.config);
        for (uint32_t scheduler = 0; scheduler < RIG_SCHEDULERS; scheduler++) {
            const smr_port port = rig_port(scheduler, 3);
            b.config.port = &port;
            unit_image shared = unit_prepare(two, 2, &b.config);
            assert_int_equal(shared.size, alone.size);
            assert_memory_equal(shared.bytes, alone.bytes, alone.size);
            unit_image_free(&shared);
        }
        unit_image first = alone;
        unit_image_free(&first);
        rig_free_all();
        tear_down(&b);
    }
}

typedef struct watch {
    uint32_t calls, stop_at, last, total, early;
} watch;

static int on_progress(void *ctx, uint32_t done, uint32_t total)
{
    watch *w = ctx;
    assert_true(total > 0u && done <= total);
    assert_true(w->calls == 0u || (done >= w->last && total == w->total));
    w->last = done;
    w->total = total;
    w->early += done == 0u;
    return ++w->calls == w->stop_at;
}

TEST(progress_and_abort)
{
    for (uint32_t order = 0; order < 2u; order++) {
        bench b = set_up();
        watch all = {0};
        unit_mesh_free(&b.mesh); /* breadth-first reports every 1,024 vertices */
        b.mesh = unit_grid(order ? 50u : 20u, order ? 45u : 20u, 3.0f);
        b.one.mesh = unit_view(&b.mesh);
        b.config.order = order;
        b.config.progress = on_progress;
        b.config.progress_ctx = &all;
        rig_free(b.scratch);
        assert_int_equal(smr_prepare_bytes(&b.one, 1, &b.config, &b.scratch_bytes), SMR_OK);
        b.scratch = rig_rough(b.scratch_bytes);
        size_t bytes = 99, most;
        assert_int_equal(smr_prepare(&b.one, 1, &b.config, b.scratch, b.scratch_bytes, NULL, 0, &most), SMR_OK);
        void *const image = rig_rough(most);
        all = (watch){0};
        assert_int_equal(smr_prepare(&b.one, 1, &b.config, b.scratch, b.scratch_bytes, image, most, &bytes), SMR_OK);
        assert_true(all.calls > 1u && (order || all.early > 1u)); /* also while the priority list is made */
        for (uint32_t stop = 1; stop <= all.calls; stop++) {
            watch w = {.stop_at = stop};
            b.config.progress_ctx = &w;
            bytes = 99;
            assert_int_equal(smr_prepare(&b.one, 1, &b.config, b.scratch, b.scratch_bytes, image, most, &bytes),
                             SMR_E_ABORTED);
            assert_int_equal(w.calls, stop); /* not asked again */
            assert_int_equal(bytes, 99);
        }
        rig_free(image);
        tear_down(&b);
    }
}

/* Breadth first, each radius reports every 1,024 vertices, and fewer vertices report nothing. */
TEST(progress_breadth_first)
{
    for (uint32_t side = 31; side < 50u; side += side < 32u ? 1u : 14u) {
        bench b = set_up();
        watch all = {0};
        unit_mesh_free(&b.mesh);
        b.mesh = unit_grid(side, side, 3.0f);
        b.one.mesh = unit_view(&b.mesh);
        b.config.order = SMR_ORDER_BREADTH_FIRST;
        b.config.priority = 0;
        b.config.progress = on_progress;
        b.config.progress_ctx = &all;
        rig_free(b.scratch);
        assert_int_equal(smr_prepare_bytes(&b.one, 1, &b.config, &b.scratch_bytes), SMR_OK);
        b.scratch = rig_rough(b.scratch_bytes);
        assert_int_equal(smr_prepare(&b.one, 1, &b.config, b.scratch, b.scratch_bytes, NULL, 0, &b.image_bytes),
                         SMR_OK);
        assert_int_equal(b.config.n_radii * (b.mesh.nv / 1024u), all.calls);
        tear_down(&b);
    }
}

/* With an image the finest of several radii keeps structures apart; a single radius does not, however small it is. */
TEST(radii_that_keep_apart_with_an_image)
{
    float *voxels;
    const smr_volume image = rig_cube(20, 2, &voxels);
    for (uint32_t n = 1; n < 3u; n++) {
        bench b = set_up_with(&image);
        smr_model_info info;
        b.config.n_radii = n;
        b.config.radius_mm[0] = 0.75f;
        b.config.radius_mm[1] = 0.5f;
        unit_image made = unit_prepare(&b.one, 1, &b.config);
        assert_int_equal(SMR_OK, smr_model_get_info(made.model, &info));
        assert_true(info.separate[0] == 0u && info.separate[n - 1u] == n - 1u);
        unit_image_free(&made);
        tear_down(&b);
    }
}

TEST(bad_coordinates_and_indexes)
{
    static const float bad[] = {NAN, INFINITY, -INFINITY, 1e30f, -1e30f, 100001.0f};
    bench b = set_up();
    for (uint32_t i = 0; i < 3u * b.mesh.nv; i += 5u) {
        const float was = b.mesh.xyz[i];
        for (size_t k = 0; k < sizeof bad / sizeof bad[0]; k++) {
            b.mesh.xyz[i] = bad[k];
            assert_int_equal(prepare(&b), SMR_E_INPUT);
        }
        b.mesh.xyz[i] = was;
    }
    for (uint32_t i = 0; i < 3u * b.mesh.nt; i += 5u) {
        const uint32_t was = b.mesh.triangles[i];
        b.mesh.triangles[i] = b.mesh.nv;
        assert_int_equal(prepare(&b), SMR_E_INPUT);
        b.mesh.triangles[i] = SMR_ALL;
        assert_int_equal(prepare(&b), SMR_E_INPUT);
        b.mesh.triangles[i] = was;
    }
    assert_int_equal(prepare(&b), SMR_OK);
}

TEST(counts_out_of_range)
{
    bench b = set_up();
    size_t bytes = 5;
    smr_structure two[2] = {b.one, b.one};
    assert_int_equal(smr_prepare_bytes(&b.one, 0, &b.config, &bytes), SMR_E_INPUT);
    assert_int_equal(smr_prepare_bytes(&b.one, SMR_STRUCTURES_MAX + 1u, &b.config, &bytes), SMR_E_INPUT);
    b.one.mesh.n_vertices = 0;
    assert_int_equal(prepare(&b), SMR_E_INPUT);
    b.one.mesh.n_vertices = SMR_VERTICES_MAX + 1u;
    assert_int_equal(prepare(&b), SMR_E_INPUT);
    b.one.mesh.n_vertices = SMR_ALL;
    assert_int_equal(prepare(&b), SMR_E_INPUT);
    b.one.mesh = unit_view(&b.mesh);
    b.one.mesh.n_triangles = SMR_TRIANGLES_MAX + 1u;
    assert_int_equal(prepare(&b), SMR_E_INPUT);
    two[0].mesh.n_vertices = SMR_VERTICES_MAX; /* too many together */
    assert_int_equal(smr_prepare_bytes(two, 2, &b.config, &bytes), SMR_E_INPUT);
    two[0].mesh = two[1].mesh;
    two[1].mesh.n_triangles = SMR_TRIANGLES_MAX;
    assert_int_equal(smr_prepare_bytes(two, 2, &b.config, &bytes), SMR_E_INPUT);
    assert_int_equal(bytes, 5);
}

/* Prepares with both orders and distances, opens, and runs. */
static void must_work(const smr_structure *structures, uint32_t n, const smr_surface *target)
{
    for (uint32_t i = 0; i < 16u; i++) {
        smr_prepare_config c = smr_prepare_config_default();
        c.order = i & 1u;
        c.distance = i >> 1 & 1u;
        c.mass = i >> 2 & 1u;
        c.n_radii = i >> 3 & 1u;
        c.radius_mm[0] = 4.0f;
        unit_image image = unit_prepare(structures, n, &c);
        const char *wrong = unit_exercise(image.model, target, 66, UNIT_JUDGED + (i & 1u));
        if (wrong != NULL)
            fail_msg("configuration %u: %s", i, wrong);
        unit_image_free(&image);
    }
}

TEST(odd_meshes_work)
{
    static const float xyz[] = {0, 0, 0, 3, 0, 0, 0, 3, 0, 0, 0, 3, 3, 0, 0, 9, 9, 9, 3, 0, 0, -0.0f, 0, 0};
    static const float far_away[] = {1e5f, 1e5f, 1e5f, -1e5f, -1e5f, -1e5f, 1e5f, -1e5f, 0};
    static const uint32_t t[][9] = {{0, 1, 2, 0, 2, 3, 0, 3, 4},  /* vertex 5 isolated, 4 and 6 copies of 1 */
                                    {0, 0, 0, 1, 1, 4, 1, 4, 6},  /* nothing but zero area */
                                    {0, 1, 2, 0, 1, 2, 2, 1, 0},  /* thrice the same */
                                    {0, 1, 2, 0, 1, 3, 0, 1, 5}}; /* an edge with three triangles */
    unit_mesh ball = unit_sphere(2, 5.0f, 1.0f);
    smr_surface *target = unit_surface(&ball);
    for (size_t i = 0; i < 4u; i++) {
        const smr_structure s = {"odd", {xyz, t[i], 8, 3}};
        must_work(&s, 1, target);
    }
    const smr_structure several[4] = {{"point", {xyz, NULL, 1, 0}},
                                      {"two", {xyz + 3, NULL, 2, 0}},
                                      {"cloud", {xyz, NULL, 8, 0}},
                                      {"far", {far_away, t[0], 3, 1}}};
    for (uint32_t i = 0; i < 4u; i++)
        must_work(several + i, 1, target);
    must_work(several, 4, target);
    must_work(several, 3, NULL);
}
