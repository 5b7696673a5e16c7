/* test_model_open.c: smr_model_open() trusts nothing: models cut at every length, and with every byte changed and the
 * checksum repaired, are refused or harmless in use.
 * SPDX-License-Identifier: MIT */
#include "cmocka_first.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "model/model.h"
#include "unit_exercise.h"

typedef struct small_world {
    unit_mesh a, b;
    smr_surface *target;
    unit_image image;
} small_world;

static small_world make(uint32_t order)
{
    small_world w;
    w.a = unit_sphere(0, 4.0f, 1.0f);
    w.b = unit_grid(2, 2, 3.0f);
    unit_mesh t = unit_sphere(1, 5.0f, 2.0f);
    w.target = unit_surface(&t);
    unit_mesh_free(&t);
    const smr_structure two[2] = {{"ball", unit_view(&w.a)}, {"sheet", unit_view(&w.b)}};
    smr_prepare_config c = smr_prepare_config_default();
    c.n_radii = 2;
    c.radius_mm[0] = 4.2426407f; /* some vertices are as far apart: there is a boundary */
    c.radius_mm[1] = 2.5f;
    c.order = order;
    w.image = unit_prepare(two, 2, &c);
    return w;
}

static void unmake(small_world *w)
{
    unit_free(w->target);
    unit_image_free(&w->image);
    unit_mesh_free(&w->a);
    unit_mesh_free(&w->b);
}

/* Opens the changed copy; when that works, it must be harmless. Returns 1 when it opened. */
static uint32_t try_image(const small_world *w, const unsigned char *bytes, size_t size, const char *what, size_t at)
{
    const smr_model *model = NULL;
    const smr_status status = smr_model_open(bytes, size, &model);
    if (status == SMR_E_MODEL) {
        assert_null(model);
        return 0u;
    }
    assert_int_equal(status, SMR_OK);
    const char *wrong = unit_exercise(model, w->target, 18, at % 4u == 0u);
    if (wrong != NULL)
        fail_msg("%s at byte %zu: %s", what, at, wrong);
    return 1u;
}

static void a_sound_image_works(void **state)
{
    (void)state;
    for (uint32_t order = 0; order < 2u; order++) {
        small_world w = make(order);
        assert_null(unit_exercise(w.image.model, w.target, 18, 1));
        unmake(&w);
    }
}

static void null_and_misaligned(void **state)
{
    small_world w = make(0);
    const smr_model *model = NULL;
    unsigned char *copy = unit_memory(w.image.size + SMR_ALIGN);
    (void)state;
    assert_int_equal(smr_model_open(NULL, w.image.size, &model), SMR_E_NULL);
    assert_int_equal(smr_model_open(w.image.bytes, w.image.size, NULL), SMR_E_NULL);
    for (size_t off = 1; off < SMR_ALIGN; off++) {
        memcpy(copy + off, w.image.bytes, w.image.size);
        assert_int_equal(smr_model_open(copy + off, w.image.size, &model), SMR_E_ALIGN);
    }
    assert_null(model);
    memcpy(copy, w.image.bytes, w.image.size);
    assert_int_equal(smr_model_open(copy, w.image.size + SMR_ALIGN, &model), SMR_OK); /* more memory than image */
    unit_free(copy);
    unmake(&w);
}

/* Memory exactly as long as the cut image: the address sanitiser sees every byte read beyond it. */
static void cut_at_every_length(void **state)
{
    small_world w = make(0);
    const smr_stored_radius *last = (const smr_stored_radius *)smr_at(w.image.model, w.image.model->at_radii) + 1;
    const size_t end = smr_le32(last->at_boundary) + sizeof(smr_stored_boundary) * (size_t)smr_le32(last->n_boundary);
    (void)state;
    for (size_t size = 0; size < w.image.size; size++) {
        unsigned char *cut = unit_memory(size);
        const smr_model *model = NULL;
        memcpy(cut, w.image.bytes, size);
        assert_int_equal(smr_model_open(cut, size, &model), SMR_E_MODEL);
        if (size % 4u == 0u || size < 200u) { /* now with the shorter length in the head, and a checksum to it */
            unit_repair(cut, size);
            assert_int_equal(try_image(&w, cut, size, "cut", size), size >= end); /* behind the last list is nothing */
        }
        unit_free(cut);
    }
    unmake(&w);
}

/* Without a repaired checksum every single bit counts. */
static void the_checksum_sees_every_bit(void **state)
{
    small_world w = make(0);
    unsigned char *copy = unit_memory(w.image.size);
    const smr_model *model = NULL;
    (void)state;
    memcpy(copy, w.image.bytes, w.image.size);
    for (size_t i = 0; i < w.image.size; i++) {
        copy[i] ^= (unsigned char)(1u << i % 8u);
        assert_int_equal(smr_model_open(copy, w.image.size, &model), SMR_E_MODEL);
        copy[i] ^= (unsigned char)(1u << i % 8u);
    }
    assert_int_equal(smr_model_open(copy, w.image.size, &model), SMR_OK);
    unit_free(copy);
    unmake(&w);
}

static void every_byte_changed(void **state)
{
    static const unsigned char flip[] = {0xff, 0x01, 0x80, 0x10};
    (void)state;
    for (uint32_t order = 0; order < 2u; order++) {
        small_world w = make(order);
        unsigned char *copy = unit_memory(w.image.size);
        uint32_t opened = 0;
        memcpy(copy, w.image.bytes, w.image.size);
        for (size_t i = 0; i < w.image.size; i++) {
            for (size_t k = 0; k < sizeof flip; k++) {
                copy[i] ^= flip[k];
                unit_repair(copy, w.image.size);
                opened += try_image(&w, copy, w.image.size, "flipped", i);
                copy[i] ^= flip[k];
            }
        }
        assert_true(opened > 0u); /* rest positions, for example */
        unit_free(copy);
        unmake(&w);
    }
}

/* Whole words: counts and offsets at their limits, floats that are none. */
static void every_word_replaced(void **state)
{
    static const uint32_t word[] = {0u,
                                    1u,
                                    2u,
                                    16u,
                                    64u,
                                    0x7fffffffu,
                                    0x80000000u,
                                    0xffffffffu,
                                    0xffffffc0u,
                                    0x00ffffffu,
                                    0x7fc00000u /* NaN */,
                                    0x7f800000u /* infinity */,
                                    0x7149f2cau /* 1e30 */,
                                    0x00000001u,
                                    0x47c35000u /* 1e5 */,
                                    0xc7c35000u};
    small_world w = make(0);
    unsigned char *copy = unit_memory(w.image.size);
    (void)state;
    memcpy(copy, w.image.bytes, w.image.size);
    for (size_t i = 0; i + 4u <= w.image.size; i += 4u) {
        for (size_t k = 0; k < sizeof word / sizeof word[0]; k++) {
            const uint32_t v = smr_le32(word[k]);
            unsigned char was[4];
            memcpy(was, copy + i, 4);
            memcpy(copy + i, &v, 4);
            unit_repair(copy, w.image.size);
            (void)try_image(&w, copy, w.image.size, "word", i);
            memcpy(copy + i, was, 4);
        }
    }
    unit_free(copy);
    unmake(&w);
}

/* Several bytes at once, at random. */
static void random_damage(void **state)
{
    oracle_random r = oracle_seed(190);
    small_world w = make(0);
    unsigned char *copy = unit_memory(w.image.size);
    (void)state;
    for (uint32_t i = 0; i < 3000u; i++) {
        memcpy(copy, w.image.bytes, w.image.size);
        for (uint32_t k = 1u + oracle_below(&r, 4u); k > 0u; k--)
            copy[oracle_below(&r, (uint32_t)w.image.size)] = (unsigned char)oracle_next(&r);
        unit_repair(copy, w.image.size);
        (void)try_image(&w, copy, w.image.size, "random damage", i);
    }
    unit_free(copy);
    unmake(&w);
}

/* Writes a word of the image, repairs the checksum and opens it; then everything is as before. */
static smr_status open_with(small_world *w, const uint32_t *word, uint32_t value)
{
    unsigned char *const at =
        (unsigned char *)w->image.bytes + ((const unsigned char *)word - (const unsigned char *)w->image.bytes);
    const uint32_t was = *word, stored = smr_le32(value);
    const smr_model *model;
    memcpy(at, &stored, sizeof stored);
    unit_repair(w->image.bytes, w->image.size);
    const smr_status status = smr_model_open(w->image.bytes, w->image.size, &model);
    memcpy(at, &was, sizeof was);
    unit_repair(w->image.bytes, w->image.size);
    return status;
}

/* The stored order: levels that do not follow each other, places along the curve twice or out of order. */
static void forged_levels(void **state)
{
    (void)state;
    for (uint32_t order = 0; order < 2u; order++) {
        small_world w = make(order);
        const smr_model *m = w.image.model;
        const uint32_t n = smr_le32(m->n_vertices), n_levels = smr_le32(m->n_levels);
        const uint32_t *along = smr_at(m, m->at_along);
        const smr_stored_radius *r = smr_at(m, m->at_radii);
        assert_true(n_levels >= 2u && n_levels < SMR_LEVELS_MAX);
        assert_int_equal(open_with(&w, &m->n_levels, n_levels), SMR_OK);
        const uint32_t bad[] = {0u, n_levels - 1u, n_levels + 1u, SMR_LEVELS_MAX + 1u, SMR_ALL};
        for (uint32_t i = 0; i < 5u; i++)
            assert_int_equal(open_with(&w, &m->n_levels, bad[i]), SMR_E_MODEL);
        for (uint32_t i = 0; i < n_levels; i++) {
            const uint32_t end[] = {0u, n + 1u, SMR_ALL, smr_le32(m->level_end[i > 0u ? i - 1u : n_levels - 1u])};
            for (uint32_t k = 0; k < (i > 0u || n_levels > 1u ? 4u : 3u); k++)
                assert_int_equal(open_with(&w, &m->level_end[i], end[k]), SMR_E_MODEL);
        }
        for (uint32_t v = 0; v < n; v++) {
            assert_int_equal(open_with(&w, &along[v], smr_le32(along[(v + 1u) % n])), SMR_E_MODEL);
            assert_int_equal(open_with(&w, &along[v], n), SMR_E_MODEL);
        }
        for (uint32_t k = 0; k < 2u; k++) {
            assert_int_equal(open_with(&w, &r[k].active_min, 0u), SMR_E_MODEL);
            assert_int_equal(open_with(&w, &r[k].active_min, n + 1u), SMR_E_MODEL);
            assert_int_equal(open_with(&w, &r[k].active_min, 1u), SMR_OK); /* too few, but harmless */
        }
        unmake(&w);
    }
}

/* Radii that share their lists' bytes: a few bytes, checked over and over. */
static void shared_lists(void **state)
{
    (void)state;
    for (uint32_t order = 0; order < 2u; order++) {
        small_world w = make(order);
        smr_stored_radius *r =
            (smr_stored_radius *)(void *)((unsigned char *)w.image.bytes + smr_le32(w.image.model->at_radii));
        const smr_stored_radius own = r[1];
        const smr_model *model;
        r[1] = r[0]; /* sound lists, but those of the other radius */
        unit_repair(w.image.bytes, w.image.size);
        assert_int_equal(smr_model_open(w.image.bytes, w.image.size, &model), SMR_E_MODEL);
        r[1] = own;
        assert_int_equal(open_with(&w, &r[1].at_count, smr_le32(r[0].at_count)), SMR_E_MODEL);
        assert_int_equal(open_with(&w, &r[1].at_indexes, smr_le32(r[0].at_indexes)), SMR_E_MODEL);
        assert_int_equal(open_with(&w, &r[1].at_boundary, smr_le32(r[0].at_indexes)), SMR_E_MODEL);
        assert_int_equal(open_with(&w, &r[1].n_boundary, SMR_ALL), SMR_E_MODEL);
        assert_int_equal(open_with(&w, &r[1].at_count, smr_le32(own.at_count)), SMR_OK);
        const smr_stored_boundary *boundary = smr_at(w.image.model, r[0].at_boundary);
        assert_true(smr_le32(r[0].n_boundary) > 0u);
        for (uint32_t i = 0; i < smr_le32(r[0].n_boundary); i++) {
            assert_int_equal(open_with(&w, &boundary[i].first, smr_le32(w.image.model->n_vertices)), SMR_E_MODEL);
            assert_int_equal(open_with(&w, &boundary[i].second, SMR_ALL), SMR_E_MODEL);
            assert_int_equal(open_with(&w, &boundary[i].share, SMR_BOUNDARY_UNITS + 1u), SMR_E_MODEL);
            assert_int_equal(open_with(&w, &boundary[i].share, 0u), SMR_OK);
        }
        unmake(&w);
    }
}

static void views_refuse_politely(void **state)
{
    small_world w = make(0);
    smr_structure_info one;
    smr_model_info info;
    (void)state;
    assert_int_equal(smr_model_get_info(NULL, &info), SMR_E_NULL);
    assert_int_equal(smr_model_get_info(w.image.model, NULL), SMR_E_NULL);
    assert_int_equal(smr_model_structure(NULL, 0, &one), SMR_E_NULL);
    assert_int_equal(smr_model_structure(w.image.model, 0, NULL), SMR_E_NULL);
    assert_int_equal(smr_model_structure(w.image.model, 2, &one), SMR_E_INPUT);
    assert_int_equal(smr_model_structure(w.image.model, SMR_ALL, &one), SMR_E_INPUT);
    assert_int_equal(smr_model_mesh(NULL, 0, NULL, NULL), SMR_E_NULL);
    assert_int_equal(smr_model_mesh(w.image.model, 2, NULL, NULL), SMR_E_INPUT);
    assert_int_equal(smr_model_get_info(w.image.model, &info), SMR_OK);
    assert_int_equal(info.bytes, w.image.size);
    assert_int_equal(info.n_vertices, w.a.nv + w.b.nv);
    assert_int_equal(info.n_triangles, w.a.nt + w.b.nt);
    unmake(&w);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_sound_image_works), cmocka_unit_test(null_and_misaligned),
        cmocka_unit_test(cut_at_every_length), cmocka_unit_test(the_checksum_sees_every_bit),
        cmocka_unit_test(every_byte_changed),  cmocka_unit_test(every_word_replaced),
        cmocka_unit_test(random_damage),       cmocka_unit_test(forged_levels),
        cmocka_unit_test(shared_lists),        cmocka_unit_test(views_refuse_politely),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
