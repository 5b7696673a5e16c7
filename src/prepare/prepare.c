/* prepare.c: smr_prepare(), the paper's preprocessing (2.2), makes a model from surfaces. In order: numbering along the
 * curve, masses, dihedral edges, profiles, radii, priority list S, stored order; for each radius clusters and order L.
 * SPDX-License-Identifier: MIT */
#include "base/settings.h"
#include "geometry/surface/mesh.h"
#include "image/intensity_profile.h"
#include "prepare/prepare_plan.h"

#define SMR_ROW_BYTES_MAX ((size_t)64u << 20) /* largest default size of the rows of bits of a block, bytes */
#define SMR_BLOCK_MIN 64u                     /* smallest default number of vertices in a block */
#define SMR_BLOCK_MAX 2048u                   /* largest default number of vertices in a block */

_Static_assert(SMR_PROFILE_MAX == 64u, "base/settings_prepare.def says so");

smr_prepare_config smr_prepare_config_default(void)
{
    smr_prepare_config config, *const c = &config;
    memset(c, 0, sizeof *c);
    c->cookie = SMR_COOKIE('P', smr_prepare_config);
#define SMR_GROUP(title)
#define SMR_SETTING(...) SMR_ROW_DEFAULT(__VA_ARGS__)
#include "base/settings_prepare.def"
    return config;
}

smr_prepare_config smr_prepare_config_paper(void)
{
    smr_prepare_config config = smr_prepare_config_default();
    config.n_radii = 1;
    config.radius_mm[0] = 30.0f;
    config.separate_below_mm = 0.0f;
    config.profile_samples = 30;
    config.profile_step_mm = 0.5f;
    config.profile_inward = 0.5f;
    config.ring = 0;
    config.order = SMR_ORDER_BREADTH_FIRST;
    return config;
}

static const smr_range ranges[] = {
#define SMR_GROUP(title)
#define SMR_SETTING(...) SMR_ROW_RANGE(smr_prepare_config, __VA_ARGS__)
#include "base/settings_prepare.def"
};

/* Returns 1 when the cookie is of this version, and values, radii and the port's workers are in range. */
static int is_legal(const smr_prepare_config *c)
{
    int legal = c->cookie == SMR_COOKIE('P', smr_prepare_config) &&
                smr_ranges_legal(c, ranges, sizeof ranges / sizeof ranges[0]);
    for (uint32_t i = 0; legal && i < c->n_radii; i++)
        legal = c->radius_mm[i] >= 1.0e-6f && c->radius_mm[i] <= SMR_COORD_MAX;
    if (legal && c->port != NULL)
        legal = c->port->n_workers >= 1u && c->port->n_workers <= SMR_WORKERS_MAX;
    return legal;
}

smr_status smr_plan_start(smr_plan *p, const smr_structure *structures, uint32_t n, const smr_prepare_config *config)
{
    memset(p, 0, sizeof *p);
    if (structures == NULL || config == NULL)
        return SMR_E_NULL;
    if (n == 0u || n > SMR_STRUCTURES_MAX)
        return SMR_E_INPUT;
    p->structures = structures;
    p->config = config;
    if (config->port != NULL && config->distance != SMR_DISTANCE_GEODESIC)
        p->port = *config->port;
    p->n_structures = n;
    for (uint32_t i = 0; i < n; i++) {
        const uint32_t nv = structures[i].mesh.n_vertices, nt = structures[i].mesh.n_triangles;
        if (nv == 0u || nv > SMR_VERTICES_MAX - p->n || nt > SMR_TRIANGLES_MAX - p->nt)
            return SMR_E_INPUT;
        p->n += nv;
        p->nt += nt;
    }
    p->words = smr_ceil_div(p->n, 64u);
    const size_t affordable = SMR_ROW_BYTES_MAX / (p->words * sizeof(uint64_t));
    const uint32_t wanted = smr_min_u32(smr_max_u32(p->n / 8u, 256u), SMR_BLOCK_MAX);
    const uint32_t block = smr_max_u32(affordable < wanted ? (uint32_t)affordable : wanted, SMR_BLOCK_MIN);
    p->block_size = smr_min_u32(config->block_vertices != 0u ? config->block_vertices : block, p->n);
    p->n_rows = smr_max_u32(p->block_size + 1u, 3u);
    return is_legal(config) ? SMR_OK : SMR_E_CONFIG;
}

void smr_plan_layout(smr_arena *a, smr_plan *p)
{
    const size_t n = p->n, nt = p->nt, u = sizeof(uint32_t);
    const size_t pairs = (size_t)p->block_size * (SMR_NEAREST + SMR_NEIGHBOURS_TRIED + 1u);
    size_t most = n > 6u * nt ? n : 6u * nt; /* items of the largest sort */
    most = most > pairs ? most : pairs;
    const int geodesic = p->config->distance == SMR_DISTANCE_GEODESIC;
    p->relief = smr_arena_take(a, n, sizeof(int16_t)); /* first: smr_prepare() has written it */
    p->xyz = smr_arena_take(a, n, 3u * sizeof(float));
    p->mass = smr_arena_take(a, n, sizeof(float));
    p->owner = smr_arena_take(a, n, sizeof(uint16_t));
    p->position = smr_arena_take(a, n, u);
    p->original = smr_arena_take(a, n, u);
    p->triangle = smr_arena_take(a, nt, 3u * u);
    p->triangle_index = smr_arena_take(a, nt, u);
    p->neighbour_start = smr_arena_take(a, n + 1u, u);
    p->neighbour = smr_arena_take(a, nt, 6u * u);
    p->dihedral = smr_arena_take(a, nt + (nt + 1u) / 2u, sizeof(smr_stored_dihedral));
    const int image = p->config->reference != NULL;
    p->profile = image ? smr_arena_take(a, n, p->config->profile_samples) : NULL;
    p->range = image ? smr_arena_take(a, n, 2u * sizeof(float)) : NULL;
    p->normal = image ? smr_arena_take(a, n, 3u * sizeof(float)) : NULL;
    smr_tree_shape(&p->points, p->n);
    p->points.node = smr_arena_take(a, smr_tree_nodes(p->n), sizeof(smr_node));
    p->priority.list = smr_arena_take(a, n, u);
    p->priority.place = smr_arena_take(a, n, u);
    p->priority.witness = smr_arena_take(a, n, u);
    p->priority.next = smr_arena_take(a, n, u);
    p->level = p->priority.next;
    p->touched = p->priority.bucket = smr_arena_take(a, n + 1u, u);
    p->stored = smr_arena_take(a, n, u);
    p->along = smr_arena_take(a, n, u);
    p->row = smr_arena_take(a, p->n_rows, (p->words + (size_t)1u) * sizeof(uint64_t));
    p->count = smr_arena_take(a, n, u);
    p->entry = smr_arena_take(a, n, u);
    p->n_outside = p->entry;
    p->triangle_centre = smr_arena_take(a, nt, 3u * sizeof(float));
    p->key = smr_arena_take(a, most, u);
    p->item = smr_arena_take(a, most, u);
    p->tmp = smr_arena_take(a, most, 2u * u);
    p->forest.nearest = smr_arena_take(a, n, SMR_NEAREST * u);
    p->forest.edge_a = smr_arena_take(a, pairs, u);
    p->forest.edge_b = smr_arena_take(a, pairs, u);
    p->forest.parent = smr_arena_take(a, (size_t)p->block_size + 1u, u);
    p->forest.link_start = smr_arena_take(a, (size_t)p->block_size + 2u, u);
    p->forest.link = smr_arena_take(a, (size_t)p->block_size + 1u, 2u * u);
    const size_t n_dense = smr_plan_thinned(p) < p->n ? n : 0u;
    p->few.node = smr_arena_take(a, n_dense > 0u ? smr_tree_nodes(p->n) : 0u, sizeof(smr_node));
    p->of_bit = smr_arena_take(a, n_dense, u);
    p->bit = smr_arena_take(a, n_dense, u);
    p->queue = smr_arena_take(a, n + 1u, u);
    p->geo_distance = geodesic ? smr_arena_take(a, n, u) : NULL;
    p->geo_heap = geodesic ? smr_arena_take(a, 6u * nt + 1u, sizeof(uint64_t)) : NULL;
}

smr_status smr_prepare_bytes(const smr_structure *structures, uint32_t n_structures, const smr_prepare_config *config,
                             size_t *scratch_bytes)
{
    smr_plan p;
    smr_arena a = smr_arena_measure();
    if (scratch_bytes == NULL)
        return SMR_E_NULL;
    SMR_TRY(smr_plan_start(&p, structures, n_structures, config));
    smr_plan_layout(&a, &p);
    *scratch_bytes = a.used;
    return a.used == SIZE_MAX ? SMR_E_INPUT : SMR_OK;
}

/* Returns the radius, mm, below which clusters hold one structure only; for images it is just above the finest one. */
static float separate_below(const smr_prepare_config *config, const float *radius, uint32_t n_radii)
{
    float largest = 0.0f, finest = SMR_FAR;
    for (uint32_t i = 0; i < n_radii; i++) {
        largest = smr_max(largest, radius[i]);
        finest = smr_min(finest, radius[i]);
    }
    if (config->separate_below_mm >= 0.0f)
        return config->separate_below_mm;
    if (config->reference == NULL)
        return largest / 3.0f;
    return finest < largest ? 1.01f * finest : 0.0f;
}

/* Checks all arguments of smr_prepare(), and starts the arena a on the scratch memory. */
static smr_status check_inputs(const smr_structure *structures, uint32_t n_structures, const smr_prepare_config *config,
                               void *scratch, size_t scratch_bytes, const void *model, smr_arena *a)
{
    size_t needed;
    SMR_TRY(smr_prepare_bytes(structures, n_structures, config, &needed));
    SMR_TRY(smr_arena_start(a, scratch, scratch_bytes));
    if ((uintptr_t)model % SMR_ALIGN != 0u)
        return SMR_E_ALIGN;
    size_t n = 0;
    for (uint32_t s = 0; s < n_structures; s++) {
        SMR_TRY(smr_mesh_check(&structures[s].mesh));
        n += structures[s].mesh.n_vertices;
    }
    const smr_subjects *also = config->also;
    if (also != NULL && also->n > 0u)
        SMR_TRY(also->xyz == NULL ? SMR_E_NULL : SMR_OK);
    if (also != NULL && (also->n >= SMR_REFERENCES_MAX || !smr_all_within(also->xyz, 3u * n * also->n, SMR_COORD_MAX)))
        return SMR_E_INPUT;
    return needed > scratch_bytes ? SMR_E_ARENA : SMR_OK;
}

/* Computes radii, the stored order and the clusters, and writes the model. */
static smr_status prepare_clusters(smr_plan *p, smr_writer *w)
{
    float radius[SMR_RADII_MAX];
    uint32_t n_radii = p->config->n_radii;
    memcpy(radius, p->config->radius_mm, sizeof radius);
    if (n_radii == 0u)
        n_radii = smr_choose_radii(p, radius);
    const float below = separate_below(p->config, radius, n_radii);
    p->progress_total = n_radii * (p->config->order == SMR_ORDER_FOREST ? smr_ceil_div(p->n, p->block_size) : 1u);
    /* S may stay empty: the size of a model whose clusters hold all vertices does not need S */
    const int empty = (w->model == NULL && smr_plan_thinned(p) == p->n) || !p->config->priority;
    SMR_TRY(smr_plan_priority(p, radius, n_radii, below, empty));
    smr_plan_levels(p, n_radii);
    smr_plan_coarse(p, radius, n_radii);
    return smr_write_model(p, w, radius, n_radii, below);
}

smr_status smr_prepare(const smr_structure *structures, uint32_t n_structures, const smr_prepare_config *config,
                       void *scratch, size_t scratch_bytes, void *model, size_t model_capacity, size_t *model_bytes)
{
    smr_plan p;
    smr_arena a;
    smr_writer w = {model, model == NULL ? 0u : model_capacity, 0};
    if (model_bytes == NULL)
        return SMR_E_NULL;
    SMR_TRY(check_inputs(structures, n_structures, config, scratch, scratch_bytes, model, &a));
    (void)smr_plan_start(&p, structures, n_structures, config);
    smr_arena_release(scratch, scratch_bytes);
    if (model != NULL) { /* first, while all memory behind relief[], the layout's first array, is free */
        smr_arena rest = a;
        p.relief = smr_arena_take(&rest, p.n, sizeof(int16_t));
        smr_plan_relief(&p, rest.base + rest.used, rest.capacity - rest.used);
        smr_arena_release(scratch, scratch_bytes);
    }
    smr_plan_layout(&a, &p);
    smr_plan_clear_rows(&p);
    smr_plan_order(&p);
    smr_plan_neighbours(&p);
    smr_plan_mass(&p);
    smr_plan_dihedrals(&p);
    smr_status status = smr_plan_profiles(&p);
    if (status == SMR_OK)
        status = prepare_clusters(&p, &w);
    smr_arena_release(scratch, scratch_bytes);
    SMR_TRY(status);
    *model_bytes = w.used;
    if (model == NULL)
        return SMR_OK;
    if (w.used > model_capacity)
        return SMR_E_ARENA;
    smr_put32(&w, 12u, smr_crc32(0, (const unsigned char *)model + SMR_MODEL_HEAD, w.used - SMR_MODEL_HEAD));
    return SMR_OK;
}
