/* test_model_sections.c: further sections of a model: unknown optional ones are skipped, unknown required ones are
 * refused, and no record is trusted.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <string.h>
#include "model/model.h"
#include "unit_exercise.h"

enum { SECTIONS = 3, SECTION_BYTES = 100 };

/* A model with a table of three optional sections, and the sections, behind what it has. */
typedef struct world {
    unit_mesh ball;
    smr_surface *target;
    unit_image plain;
    unsigned char *bytes; /* [size] */
    size_t size;
    smr_model *head;           /* at bytes */
    smr_stored_section *table; /* in bytes */
} world;

static world make(void)
{
    world w;
    smr_prepare_config c = smr_prepare_config_default();
    unit_mesh t = unit_sphere(1, 5.0f, 2.0f);
    w.target = unit_surface(&t);
    unit_mesh_free(&t);
    w.ball = unit_sphere(0, 4.0f, 1.0f);
    const smr_structure one = {"ball", unit_view(&w.ball)};
    c.n_radii = 1;
    c.radius_mm[0] = 3.0f;
    w.plain = unit_prepare(&one, 1, &c);
    const size_t first = w.plain.size + SMR_ALIGN; /* the table takes one slot */
    w.size = first + SECTIONS * 2u * SMR_ALIGN;
    w.bytes = rig_rough(w.size);
    memset(w.bytes, 0x5a, w.size);
    memcpy(w.bytes, w.plain.bytes, w.plain.size);
    w.head = (smr_model *)(void *)w.bytes;
    w.head->n_sections = smr_le32(SECTIONS);
    w.head->at_sections = smr_le32((uint32_t)w.plain.size);
    w.table = (smr_stored_section *)(void *)(w.bytes + w.plain.size);
    for (uint32_t i = 0; i < SECTIONS; i++) {
        w.table[i].kind = smr_le32(0x1000u + i);
        w.table[i].flags = 0;
        w.table[i].at = smr_le32((uint32_t)(first + i * 2u * SMR_ALIGN));
        w.table[i].bytes = smr_le32(SECTION_BYTES);
    }
    return w;
}

static smr_status open_now(const world *w, const smr_model **model)
{
    *model = NULL;
    unit_repair(w->bytes, w->size);
    return smr_model_open(w->bytes, w->size, model);
}

/* Opens with one stored word changed for the call. */
static smr_status open_with(const world *w, uint32_t *word, uint32_t value)
{
    const uint32_t was = *word;
    const smr_model *model;
    *word = smr_le32(value);
    const smr_status status = open_now(w, &model);
    *word = was;
    return status;
}

TEST(todays_models_have_one)
{
    world w = make();
    const smr_model *const m = w.plain.bytes;
    const smr_stored_section *const s = smr_at(m, m->at_sections);
    assert_int_equal(sizeof(smr_model), 256);
    assert_int_equal(smr_le32(m->n_sections), 1);
    assert_int_equal(smr_le32(s->kind), SMR_SECTION_RELIEF);
    for (size_t i = 232; i < 256u; i++)
        assert_int_equal(((const unsigned char *)w.plain.bytes)[i], 0);
}

/* A relief has two bytes for each vertex, of any value. */
TEST(a_relief_of_another_size_is_refused)
{
    world w = make();
    const uint32_t n = 2u * w.ball.nv;
    const smr_model *model;
    w.table[1].kind = smr_le32(SMR_SECTION_RELIEF);
    assert_int_equal(open_with(&w, &w.table[1].bytes, n), SMR_OK);
    w.table[1].bytes = smr_le32(n);
    assert_int_equal(open_now(&w, &model), SMR_OK);
    assert_null(unit_exercise(model, w.target, 18, UNIT_ALL));
    const uint32_t size[] = {0, n - 1u, n + 1u, 4u * n};
    for (uint32_t i = 0; i < 4u; i++)
        assert_int_equal(open_with(&w, &w.table[1].bytes, size[i]), SMR_E_MODEL);
}

TEST(unknown_optional_ones_are_skipped)
{
    world w = make();
    const smr_model *model;
    assert_int_equal(open_now(&w, &model), SMR_OK);
    assert_null(unit_exercise(model, w.target, 18, UNIT_ALL));
    assert_int_equal(open_with(&w, &w.table[1].bytes, 0), SMR_OK);
}

TEST(unknown_required_ones_are_refused)
{
    world w = make();
    for (uint32_t i = 0; i < SECTIONS; i++)
        assert_int_equal(open_with(&w, &w.table[i].flags, SMR_SECTION_REQUIRED), SMR_E_MODEL);
}

TEST(hostile_values_are_refused)
{
    world w = make();
    const uint32_t size = (uint32_t)w.size, first = smr_le32(w.table[0].at), second = smr_le32(w.table[1].at);
    const uint32_t at[] = {0, 64, 192, first + 1u, first + 32u, size, size + 64u, 0x7fffffc0u, 0xffffffc0u};
    const uint32_t bytes[] = {size - first + 1u, size, 0x7fffffffu, 0xffffffc0u, 0xffffffffu};
    const uint32_t count[] = {0, 65, 1000, 0x10000000u, 0xffffffffu};
    const smr_model *model;
    for (size_t k = 0; k < sizeof at / sizeof at[0]; k++) {
        assert_int_equal(open_with(&w, &w.table[0].at, at[k]), SMR_E_MODEL);
        assert_int_equal(open_with(&w, &w.head->at_sections, at[k]), SMR_E_MODEL);
    }
    for (size_t k = 0; k < sizeof bytes / sizeof bytes[0]; k++)
        assert_int_equal(open_with(&w, &w.table[0].bytes, bytes[k]), SMR_E_MODEL);
    for (size_t k = 0; k < sizeof count / sizeof count[0]; k++)
        assert_int_equal(open_with(&w, &w.head->n_sections, count[k]), SMR_E_MODEL);
    assert_int_equal(open_with(&w, &w.table[0].bytes, second - first + 1u), SMR_E_MODEL); /* into the next one */
    assert_int_equal(open_with(&w, &w.table[2].at, first), SMR_E_MODEL);                  /* not behind the last */
    assert_int_equal(open_with(&w, &w.table[2].kind, 0), SMR_E_MODEL);
    assert_int_equal(open_with(&w, &w.table[2].kind, smr_le32(w.table[0].kind)), SMR_E_MODEL);
    assert_int_equal(open_with(&w, &w.table[1].flags, 2), SMR_E_MODEL);
    assert_int_equal(open_with(&w, &w.table[1].flags, 0x80000000u), SMR_E_MODEL);
    for (uint32_t i = 0; i < 4u; i++)
        assert_int_equal(open_with(&w, &w.head->zero[i], 1), SMR_E_MODEL);
    assert_int_equal(open_with(&w, &w.head->coarse_radii, 1), SMR_E_MODEL); /* no vertex in clusters */
    assert_int_equal(open_with(&w, &w.head->coarse_vertices, 1), SMR_E_MODEL);
    assert_int_equal(open_now(&w, &model), SMR_OK); /* it was the change each time */
}

/* Every byte of the table changed: refused, or as good as before. */
TEST(any_byte_of_the_table)
{
    static const unsigned char value[] = {0, 1, 2, 0x40, 0x80, 0xff};
    world w = make();
    unsigned char *table = (unsigned char *)w.table;
    const smr_model *model;
    uint32_t opened = 0;
    for (size_t i = 0; i < SECTIONS * sizeof(smr_stored_section); i++) {
        for (size_t k = 0; k < sizeof value; k++) {
            const unsigned char was = table[i];
            table[i] = value[k];
            const smr_status status = open_now(&w, &model);
            assert_true(status == SMR_OK || (status == SMR_E_MODEL && model == NULL));
            opened += status == SMR_OK;
            table[i] = was;
        }
    }
    assert_true(opened > 20u); /* other kinds, shorter sections */
}
