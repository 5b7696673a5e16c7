/* test_priority_list.c: the priority list S equals the paper's rule applied plainly to sets; active vertices keep
 * three members in every cluster, or all of a smaller one; the stored order follows S. Many random models, several
 * radii.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include <string.h>
#include "base/arena.h"
#include "prepare/prepare_plan.h"
#include "unit_lists.h"

/* member[r]: clusters as sets in the caller's numbers. */
typedef struct world {
    unit_mesh mesh[2];
    smr_structure structure[2];
    smr_prepare_config config;
    uint32_t n;
    unsigned char *member[SMR_RADII_MAX];
    uint32_t n_structures;
} world;

static world make(oracle_random *r, uint32_t round)
{
    world w;
    memset(&w, 0, sizeof w);
    w.n_structures = 2;
    w.mesh[0] = round % 3u == 0u ? unit_sphere(1u + round % 2u, 20.0f, 25.0f)
                                 : unit_points(r, 1u + oracle_below(r, 120u), 0.0f, 60.0f);
    w.mesh[1] =
        round % 3u == 1u ? unit_grid(3u + round % 5u, 6, 5.0f) : unit_soup(r, 1u + oracle_below(r, 40u), 50.0f, 1);
    w.config = smr_prepare_config_default();
    w.config.n_radii = 1u + oracle_below(r, 4u);
    for (uint32_t k = 0; k < w.config.n_radii; k++)
        w.config.radius_mm[k] = oracle_uniformf(r, 2.0f, k == 0u ? 60.0f : 30.0f);
    w.config.separate_below_mm = oracle_uniformf(r, 0.0f, 40.0f);
    w.config.distance = round % 7u == 6u ? SMR_DISTANCE_GEODESIC : SMR_DISTANCE_EUCLIDEAN;
    w.config.ring = round & 1u;
    for (uint32_t s = 0; s < 2u; s++)
        w.structure[s] = (smr_structure){"", unit_view(&w.mesh[s])};
    return w;
}

static void unmake(world *w)
{
    for (uint32_t k = 0; k < w->config.n_radii; k++)
        rig_free(w->member[k]);
    unit_mesh_free(&w->mesh[0]);
    unit_mesh_free(&w->mesh[1]);
}

/* Clusters of the image by looking at every pair, in the caller's numbers. */
static void find_members(world *w, const smr_model *m)
{
    smr_model_info info;
    assert_int_equal(smr_model_get_info(m, &info), SMR_OK);
    const uint32_t n = w->n = info.n_vertices;
    unsigned char *stored = rig_rough((size_t)n * n);
    for (uint32_t k = 0; k < info.n_radii; k++) {
        const unit_rule rule = {info.radius_mm[k], w->config.distance == SMR_DISTANCE_GEODESIC, (int)info.separate[k],
                                w->config.ring && info.radius_mm[k] >= info.edge_mm};
        unit_brute_sets(m, &rule, stored);
        w->member[k] = rig_rough((size_t)n * n);
        for (uint32_t a = 0; a < n; a++)
            for (uint32_t b = 0; b < n; b++)
                w->member[k][(size_t)smr_model_original(m, a) * n + smr_model_original(m, b)] =
                    stored[(size_t)a * n + b];
    }
    rig_free(stored);
}

/* |zeta_a| over the vertices whose `gone` is 0. */
static uint32_t left(const unsigned char *member, uint32_t n, uint32_t a, const unsigned char *gone)
{
    uint32_t count = 0;
    for (uint32_t b = 0; b < n; b++)
        count += member[(size_t)a * n + b] && !gone[b];
    return count;
}

/* The rule at one radius, every m_i anew at each step. Appends to list; returns its new length. */
static uint32_t plain_rule(const unsigned char *member, uint32_t n, unsigned char *gone, uint32_t *list,
                           uint32_t listed)
{
    uint32_t *size = rig_rough(4u * (size_t)n);
    for (;;) {
        uint32_t best = 0, best_m = 3;
        for (uint32_t a = 0; a < n; a++)
            size[a] = left(member, n, a, gone);
        for (uint32_t i = 0; i < n; i++) {
            uint32_t m = UINT32_MAX;
            for (uint32_t j = 0; j < n; j++)
                m = member[(size_t)i * n + j] && size[j] < m ? size[j] : m;
            if (!gone[i] && m > best_m) {
                best = i;
                best_m = m;
            }
        }
        if (best_m == 3u)
            break;
        gone[best] = 1;
        list[listed++] = best;
    }
    rig_free(size);
    return listed;
}

/* S as one list over all radii, and what each needs. */
static uint32_t plain_list(const world *w, uint32_t *list, uint32_t need[SMR_RADII_MAX], uint32_t *restored)
{
    const uint32_t n = w->n;
    uint32_t listed = 0, until[SMR_RADII_MAX] = {0}, kept = 0;
    unsigned char *gone = rig_rough(n), done[SMR_RADII_MAX] = {0};
    memset(gone, 0, n);
    for (uint32_t k = 0; k < w->config.n_radii; k++) {
        uint32_t f = SMR_NONE;
        for (uint32_t r = 0; r < w->config.n_radii; r++)
            if (!done[r] && (f == SMR_NONE || w->config.radius_mm[r] <= w->config.radius_mm[f]))
                f = r;
        done[f] = 1;
        for (uint32_t a = 0; a < n; a++) /* what a finer radius took away from clusters that were small there */
            for (uint32_t b = 0; b < n; b++)
                if (w->member[f][(size_t)a * n + b] && gone[b] && left(w->member[f], n, a, gone) < 3u)
                    gone[b] = 0, ++*restored;
        for (uint32_t i = 0; i < listed; i++)
            if (list[i] != SMR_NONE && !gone[list[i]])
                list[i] = SMR_NONE;
        listed = until[f] = plain_rule(w->member[f], n, gone, list, listed);
    }
    for (uint32_t r = 0; r < w->config.n_radii; r++) {
        need[r] = n;
        for (uint32_t i = 0; i < until[r]; i++)
            need[r] -= list[i] != SMR_NONE;
    }
    for (uint32_t i = 0; i < listed; i++)
        if (list[i] != SMR_NONE)
            list[kept++] = list[i];
    rig_free(gone);
    return kept;
}

/* The list itself, from the plan. */
static void check_list(const world *w, const uint32_t *list, uint32_t listed, const uint32_t *need)
{
    smr_plan p;
    smr_arena a;
    size_t bytes;
    assert_int_equal(smr_prepare_bytes(w->structure, w->n_structures, &w->config, &bytes), SMR_OK);
    void *scratch = rig_rough(bytes);
    assert_int_equal(smr_plan_start(&p, w->structure, w->n_structures, &w->config), SMR_OK);
    assert_int_equal(smr_arena_start(&a, scratch, bytes), SMR_OK);
    smr_plan_layout(&a, &p);
    memset(p.row, 0, p.n_rows * (p.words + 1u) * sizeof *p.row);
    smr_plan_order(&p);
    smr_plan_neighbours(&p);
    assert_int_equal(smr_plan_priority(&p, w->config.radius_mm, w->config.n_radii, w->config.separate_below_mm, 0),
                     SMR_OK);
    assert_int_equal(p.priority.n_listed, listed);
    for (uint32_t i = 0; i < listed; i++)
        assert_int_equal(p.original[p.priority.list[i]], list[i]);
    assert_memory_equal(p.active_min, need, w->config.n_radii * sizeof *need);
    smr_arena_release(scratch, bytes);
    rig_free(scratch);
}

/* Levels follow the list, and what a radius needs ends one. */
static void check_levels(const world *w, const smr_model *m, const uint32_t *list, uint32_t listed,
                         const uint32_t *need)
{
    smr_model_info info;
    assert_int_equal(smr_model_get_info(m, &info), SMR_OK);
    assert_in_range(info.n_levels, 1, SMR_LEVELS_MAX);
    assert_int_equal(info.level_end[info.n_levels - 1u], w->n);
    uint32_t *rank = rig_rough(4u * (size_t)w->n);
    memset(rank, 0, 4u * (size_t)w->n);
    for (uint32_t i = 0; i < listed; i++)
        rank[list[i]] = w->n - 1u - i;
    for (uint32_t v = 0, level = 0; v < w->n; v++) {
        level += v == info.level_end[level];
        assert_true(rank[smr_model_original(m, v)] < info.level_end[level]);
        assert_true(level == 0u || rank[smr_model_original(m, v)] >= info.level_end[level - 1u]);
        assert_true(v == 0u || v == (level > 0u ? info.level_end[level - 1u] : 0u) ||
                    smr_model_along(m, v) > smr_model_along(m, v - 1u));
    }
    for (uint32_t r = 0; r < info.n_radii; r++) {
        uint32_t ends = 0;
        assert_int_equal(info.active_min[r], need[r]);
        for (uint32_t k = 0; k < info.n_levels; k++)
            ends += info.level_end[k] == need[r];
        assert_int_equal(ends, 1);
    }
    rig_free(rank);
}

/* Any number of first stored vertices that is enough for a radius keeps three members of every cluster there, or all
 * of it. */
static void check_prefixes(const world *w, const smr_model *m, const uint32_t *need)
{
    unsigned char *gone = rig_rough(w->n), *none = rig_rough(w->n);
    memset(none, 0, w->n);
    for (uint32_t r = 0; r < w->config.n_radii; r++) {
        memset(gone, 1, w->n);
        for (uint32_t v = 0; v < w->n; v++) {
            gone[smr_model_original(m, v)] = 0;
            if (v + 1u < need[r] || (v + 1u > need[r] && v % 5u != 0u))
                continue;
            for (uint32_t a = 0; a < w->n; a++) {
                const uint32_t now = left(w->member[r], w->n, a, gone);
                assert_true(now >= 3u || now == left(w->member[r], w->n, a, none));
            }
        }
    }
    rig_free(gone);
    rig_free(none);
}

TEST(follows_the_rule)
{
    oracle_random r = oracle_seed(400);
    uint32_t restored = 0, more = 0;
    for (uint32_t round = 0; round < 400u; round++) {
        world w = make(&r, round);
        unit_image image = unit_prepare(w.structure, w.n_structures, &w.config);
        find_members(&w, image.model);
        uint32_t *list = rig_rough(4u * (size_t)w.n * SMR_RADII_MAX), need[SMR_RADII_MAX];
        const uint32_t listed = plain_list(&w, list, need, &restored);
        check_list(&w, list, listed, need);
        check_levels(&w, image.model, list, listed, need);
        check_prefixes(&w, image.model, need);
        more += listed > w.n / 2u;
        rig_free(list);
        unit_image_free(&image);
        unmake(&w);
    }
    assert_true(more > 0u && restored > 0u);
}

/* Vertices close together and few far off, with radii by default: the coarser radii take so many vertices off the list
 * again that the list with its gaps would be longer than the model. */
TEST(list_without_gaps)
{
    static const int16_t at[32][3] = {/* in 1/64 mm */
                                      {0, 0, 0},     {-1, -1, -1},    {0, -256, -1},   {-1, -1, -1},     {-1, -1, -37},
                                      {-1, -1, 255}, {0, 8, 0},       {-1, 24832, -1}, {255, 0, 0},      {0, 256, 0},
                                      {0, 0, -256},  {-1, -1, 255},   {0, -1, -1},     {-1, 12287, -1},  {-37, -1, -1},
                                      {-1, -1, 0},   {2048, 0, -256}, {-1, -1, -1},    {-1, -1025, 255}, {0, 0, -1},
                                      {-1, 0, 0},    {-1, -1, -210},  {255, 0, 2816},  {-1, 0, 0},       {0, -1, -1},
                                      {-1, -1, -1},  {255, 0, 0},     {-1, -1, 0},     {0, -1, -1},      {-210, 255, 0},
                                      {-256, -1, 0}, {0, 0, -1}};
    world w = {.config = smr_prepare_config_default(), .n_structures = 1};
    smr_model_info info;
    uint32_t *list, need[SMR_RADII_MAX], restored = 0;
    w.mesh[0] = unit_mesh_new(32, 31);
    memset(w.mesh[0].triangles, 0, 93u * sizeof(uint32_t));
    memcpy(w.mesh[0].triangles, (const uint32_t[]){31, 27, 31, 31, 31, 31, 0, 31, 6, 1}, 10u * sizeof(uint32_t));
    w.mesh[1] = unit_mesh_new(1, 0);
    for (uint32_t i = 0; i < 96u; i++)
        w.mesh[0].xyz[i] = (float)at[i / 3u][i % 3u] / 64.0f;
    w.structure[0] = (smr_structure){"", unit_view(&w.mesh[0])};
    unit_image image = unit_prepare(w.structure, w.n_structures, &w.config);
    assert_int_equal(SMR_OK, smr_model_get_info(image.model, &info));
    w.config.n_radii = info.n_radii;
    memcpy(w.config.radius_mm, info.radius_mm, sizeof info.radius_mm);
    find_members(&w, image.model);
    list = rig_rough(4u * (size_t)w.n * SMR_RADII_MAX);
    const uint32_t listed = plain_list(&w, list, need, &restored);
    check_list(&w, list, listed, need);
    assert_true(listed + restored > w.n);
    rig_free(list);
    unit_image_free(&image);
    unmake(&w);
}

/* Points closer and closer along a line, of whose levels there would be 25. */
TEST(levels_have_a_limit)
{
    enum { N = 26000 };
    unit_mesh row = unit_mesh_new(N, 0);
    const smr_structure one = {"row", unit_view(&row)};
    smr_prepare_config c = smr_prepare_config_default();
    memset(row.xyz, 0, 12u * N);
    for (uint32_t i = 0; i < N; i++)
        row.xyz[3u * i] = (float)(1000.0 * pow((double)i / (double)N, 3.0));
    c.n_radii = SMR_RADII_MAX;
    c.radius_mm[0] = 1000.0f;
    for (uint32_t k = 1; k < SMR_RADII_MAX; k++)
        c.radius_mm[k] = c.radius_mm[k - 1u] / 2.7f;
    unit_image image = unit_prepare(&one, 1, &c);
    const uint32_t *const end = image.model->level_end;
    assert_int_equal(SMR_LEVELS_MAX, smr_le32(image.model->n_levels));
    assert_int_equal(N, smr_le32(end[SMR_LEVELS_MAX - 1u]));
    for (uint32_t k = 1; k < SMR_LEVELS_MAX; k++)
        assert_true(smr_le32(end[k - 1u]) < smr_le32(end[k]));
    unit_image_free(&image);
    unit_mesh_free(&row);
}
