/* test_model_open.c: smr_model_open() trusts nothing: models cut at every length, and with every byte changed and the
 * checksum repaired, are refused or harmless in use.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <string.h>
#include "image/intensity_profile.h"
#include "model/model.h"
#include "property/rig_ball_image.h"
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
    rig_free(w->target);
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
    const char *wrong = unit_exercise(model, w->target, 18, UNIT_JUDGED + (at % 4u == 0u));
    if (wrong != NULL)
        fail_msg("%s at byte %zu: %s", what, at, wrong);
    return 1u;
}

TEST(null_and_misaligned)
{
    small_world w = make(0);
    const smr_model *model = NULL;
    unsigned char *copy = rig_rough(w.image.size + SMR_ALIGN);
    assert_int_equal(smr_model_open(NULL, w.image.size, &model), SMR_E_NULL);
    assert_int_equal(smr_model_open(w.image.bytes, w.image.size, NULL), SMR_E_NULL);
    for (size_t off = 1; off < SMR_ALIGN; off++) {
        memcpy(copy + off, w.image.bytes, w.image.size);
        assert_int_equal(smr_model_open(copy + off, w.image.size, &model), SMR_E_ALIGN);
    }
    assert_null(model);
    memcpy(copy, w.image.bytes, w.image.size);
    assert_int_equal(smr_model_open(copy, w.image.size + SMR_ALIGN, &model), SMR_OK); /* more memory than image */
}

/* Memory exactly as long as the cut image: the address sanitiser sees every byte read beyond it. */
TEST(cut_at_every_length)
{
    small_world w = make(0);
    const smr_stored_section *last = smr_model_section(w.image.model, SMR_SECTION_RELIEF);
    const size_t end = (size_t)smr_le32(last->at) + smr_le32(last->bytes);
    for (size_t size = 0; size < w.image.size; size++) {
        unsigned char *cut = rig_rough(size);
        const smr_model *model = NULL;
        memcpy(cut, w.image.bytes, size);
        assert_int_equal(smr_model_open(cut, size, &model), SMR_E_MODEL);
        if (size % 4u == 0u || size < 200u) { /* now with the shorter length in the head, and a checksum to it */
            unit_repair(cut, size);
            assert_int_equal(try_image(&w, cut, size, "cut", size),
                             size >= end); /* behind the last section is nothing */
        }
        rig_free(cut);
    }
}

/* Without a repaired checksum every single bit counts. */
TEST(the_checksum_sees_every_bit)
{
    small_world w = make(0);
    unsigned char *copy = rig_rough(w.image.size);
    const smr_model *model = NULL;
    memcpy(copy, w.image.bytes, w.image.size);
    for (size_t i = 0; i < w.image.size; i++) {
        copy[i] ^= (unsigned char)(1u << i % 8u);
        assert_int_equal(smr_model_open(copy, w.image.size, &model), SMR_E_MODEL);
        copy[i] ^= (unsigned char)(1u << i % 8u);
    }
    assert_int_equal(smr_model_open(copy, w.image.size, &model), SMR_OK);
}

TEST(every_byte_changed)
{
    static const unsigned char flip[] = {0xff, 0x01, 0x80, 0x10};
    for (uint32_t order = 0; order < 2u; order++) {
        small_world w = make(order);
        unsigned char *copy = rig_rough(w.image.size);
        uint32_t opened = 0;
        memcpy(copy, w.image.bytes, w.image.size);
        for (size_t i = 0; i < w.image.size; i++) {
            for (size_t k = 0; k < rig_times(sizeof flip); k++) {
                copy[i] ^= flip[k];
                unit_repair(copy, w.image.size);
                opened += try_image(&w, copy, w.image.size, "flipped", i);
                copy[i] ^= flip[k];
            }
        }
        assert_true(opened > 0u); /* rest positions, for example */
        rig_free(copy);
        unmake(&w);
    }
}

/* Several bytes at once, at random. */
TEST(random_damage)
{
    oracle_random r = oracle_seed(190);
    small_world w = make(0);
    unsigned char *copy = rig_rough(w.image.size);
    for (uint32_t i = 0; i < rig_times(3000); i++) {
        memcpy(copy, w.image.bytes, w.image.size);
        for (uint32_t k = 1u + oracle_below(&r, 4u); k > 0u; k--)
            copy[oracle_below(&r, (uint32_t)w.image.size)] = (unsigned char)oracle_next(&r);
        unit_repair(copy, w.image.size);
        (void)try_image(&w, copy, w.image.size, "random damage", i);
    }
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
TEST(forged_levels)
{
    for (uint32_t order = 0; order < 2u; order++) {
        small_world w = make(order);
        const smr_model *m = w.image.model;
        const uint32_t n = smr_le32(m->n_vertices), n_levels = smr_le32(m->n_levels);
        const uint32_t *along = smr_at(m, m->at_along);
        const smr_stored_radius *r = smr_at(m, m->at_radii);
        uint32_t *const coarse = (uint32_t *)(uintptr_t)&m->coarse_radii;
        assert_true(n_levels >= 2u && n_levels < SMR_LEVELS_MAX && smr_le32(r[0].active_min) > 1u);
        *coarse = smr_le32(1); /* clusters of the first radius hold too many vertices, or fewer than are active */
        assert_int_equal(open_with(&w, &m->coarse_vertices, n + 1u), SMR_E_MODEL);
        assert_int_equal(open_with(&w, &m->coarse_vertices, 1u), SMR_E_MODEL);
        *coarse = 0;
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
            assert_int_equal(open_with(&w, &r[k].largest, 0u), SMR_E_MODEL);
            assert_int_equal(open_with(&w, &r[k].largest, n + 1u), SMR_E_MODEL);
            assert_int_equal(open_with(&w, &r[k].n_blocks, n + 1u), SMR_E_MODEL);
        }
        unmake(&w);
    }
}

/* Radii that share their lists' bytes: a few bytes, checked over and over. */
TEST(shared_lists)
{
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

/* A block of more vertices than are checked at a time: each vertex has one entry, also those on both sides of 4,096. */
TEST(each_vertex_once)
{
    static const uint32_t place[] = {0, 1, 31, 32, 4094, 4095, 4096, 4097};
    unit_mesh ball = unit_sphere(5, 20.0f, 0.0f);
    smr_prepare_config c = rig_radii(1, 2, 0, 0);
    c.block_vertices = 8192;
    unit_image image = unit_prepare_mesh(&ball, &c);
    const smr_model *model;
    const smr_stored_radius *r = smr_at(image.model, image.model->at_radii);
    uint16_t *const entry = (uint16_t *)(void *)((unsigned char *)image.bytes + smr_le32(r->at_entries)),
                    *at[8] = {NULL};
    const uint32_t n = smr_le32(image.model->n_vertices);
    assert_true(n == 4098u && smr_le32(r->n_blocks) == 1u && smr_le32(image.model->index_bytes) == 2u);
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t k = 0; k < 8u; k++)
            if (smr_model_along(image.model, smr_index_at(entry, 2, 4u * (size_t)i)) == place[k])
                at[k] = entry + 4u * (size_t)i;
    for (uint32_t i = 0; i < 64u; i++) {
        const uint16_t was = *at[i / 8u];
        *at[i / 8u] = *at[i % 8u];
        unit_repair(image.bytes, image.size);
        assert_int_equal(smr_model_open(image.bytes, image.size, &model), i / 8u == i % 8u ? SMR_OK : SMR_E_MODEL);
        *at[i / 8u] = was;
    }
    unit_image_free(&image);
    unit_mesh_free(&ball);
}

/* Lists of several blocks: blocks that are empty, overlap or end beyond the vertices, the same of their indexes. */
TEST(forged_blocks)
{
    unit_mesh ball = unit_sphere(3, 20.0f, 0.0f);
    smr_prepare_config c = rig_radii(1, 9, 0, 0);
    c.block_vertices = 64;
    small_world w = {.image = unit_prepare_mesh(&ball, &c)};
    const smr_model *m = w.image.model;
    const smr_stored_radius *r = smr_at(m, m->at_radii);
    const smr_stored_block *b = smr_at(m, r->at_blocks);
    const uint32_t n = smr_le32(m->n_vertices), n_blocks = smr_le32(r->n_blocks), n_indexes = smr_le32(r->n_indexes);
    assert_true(n_blocks >= 3u);
    const uint32_t counts[] = {0, n_blocks - 1u, n_blocks + 1u, n + 1u, SMR_ALL};
    for (uint32_t i = 0; i < 5u; i++)
        assert_int_equal(open_with(&w, &r->n_blocks, counts[i]), SMR_E_MODEL);
    const uint32_t *const entry = smr_at(m, r->at_entries); /* of 16 bits: vertex and parent, numbers of indexes */
    const uint32_t first = smr_le32(entry[0]), other = smr_le32(entry[2u * (n - 1u)]) & 0xffffu; /* in another block */
    assert_int_equal(open_with(&w, &entry[0], (first & 0xffff0000u) | other), SMR_E_MODEL);
    for (uint32_t k = 0; k <= n_blocks; k++) {
        const uint32_t before = k > 0u ? smr_le32(b[k - 1u].first) : 1u;
        const uint32_t from = k > 0u && smr_le32(b[k - 1u].first_index) > 0u ? 0u : 1u;
        const uint32_t begin[] = {before, n + 1u, SMR_ALL}, index[] = {from, n_indexes + 1u, SMR_ALL};
        for (uint32_t i = 0; i < 3u; i++) {
            assert_int_equal(open_with(&w, &b[k].first, begin[i]), SMR_E_MODEL);
            assert_int_equal(open_with(&w, &b[k].first_index, index[i]), SMR_E_MODEL);
        }
    }
    unit_mesh few = unit_mesh_new(4, 0); /* behind the blocks is room for two more than there are vertices */
    memcpy(few.xyz, (const float[12]){0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, 12u * sizeof *few.xyz);
    small_world small = {.image = unit_prepare_mesh(&few, &c)};
    r = smr_at(small.image.model, small.image.model->at_radii);
    assert_int_equal(open_with(&small, &r->n_blocks, 1u), SMR_OK);
    assert_int_equal(open_with(&small, &r->n_blocks, 5u), SMR_E_MODEL);
    unit_image_free(&small.image);
    unit_mesh_free(&few);
    unit_image_free(&w.image);
    unit_mesh_free(&ball);
}

/* Profiles: their numbers of samples, spacing, sections and ranges of intensity. */
TEST(forged_profiles)
{
    const smr_volume image = rig_ball_image(RIG_BALL_MM, rig_nowhere);
    const smr_model *m = rig_ball_model(&image);
    smr_model_info info;
    assert_int_equal(smr_model_get_info(m, &info), SMR_OK);
    small_world w = {.image = {.bytes = (void *)(uintptr_t)m, .size = info.bytes, .model = m}};
    const uint32_t *range = smr_at(m, m->at_ranges), samples = smr_le32(m->profile_samples);
    const uint32_t nan = 0x7fc00000u, huge = 0x7f000000u, far = 0xffffffc0u;
    const struct {
        const uint32_t *word;
        uint32_t value;
    } bad[] = {{&m->profile_samples, 2},
               {&m->profile_samples, SMR_PROFILE_MAX + 1u},
               {&m->profile_samples, SMR_ALL},
               {&m->profile_inward, samples},
               {&m->profile_step, 0},
               {&m->profile_step, nan},
               {&m->at_profiles, far},
               {&m->at_ranges, far},
               {&range[0], nan},
               {&range[5], huge},
               {smr_at(m, m->at_mass), 0},
               {smr_at(m, m->at_mass), nan},
               {smr_at(m, m->at_rest), nan},
               {smr_at(m, m->at_rest), huge}};
    assert_int_equal(open_with(&w, &m->profile_inward, smr_le32(m->profile_inward)), SMR_OK);
    for (uint32_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
        assert_int_equal(open_with(&w, bad[i].word, bad[i].value), SMR_E_MODEL);
}

/* A structure to which nothing belongs any more: harmless in use. */
TEST(an_empty_structure)
{
    small_world w = make(0);
    smr_stored_structure *r = (smr_stored_structure *)(uintptr_t)smr_model_record(w.image.model, 0);
    r[0].n_vertices = r[1].first_vertex = w.image.model->n_vertices;
    r[0].n_triangles = r[1].first_triangle = w.image.model->n_triangles;
    r[1].n_vertices = r[1].n_triangles = 0;
    memset((void *)(uintptr_t)smr_at(w.image.model, w.image.model->at_owner), 0, 2u * smr_le32(r[1].first_vertex));
    unit_repair(w.image.bytes, w.image.size);
    assert_int_equal(1, try_image(&w, w.image.bytes, w.image.size, "no vertex", 0));
    unmake(&w);
}

TEST(views_refuse_politely)
{
    small_world w = make(0);
    smr_structure_info one;
    smr_model_info info;
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
    const smr_config config = smr_config_default();
    size_t bytes;
    assert_int_equal(smr_arena_bytes(w.image.model, &config, &bytes), SMR_OK);
    *(uint32_t *)(uintptr_t)&w.image.model->bytes = smr_le32(8); /* of a model that was open */
    assert_int_equal(smr_arena_bytes(w.image.model, &config, &bytes), SMR_E_MODEL);
}
