/* prepare.c: surfaces in, model image out (paper 2.2). The steps in order: stored order, masses, radii, and for each
 * radius its clusters and their forest. Allocates nothing; layout measures and places the scratch.
 * SPDX-License-Identifier: MIT */
#include "base/arena.h"
#include "geometry/mesh.h"
#include "geometry/profile.h"
#include "prepare/plan.h"

#define SMR_ROW_BYTES_MAX ((size_t)64u << 20) /* for a block's rows, unless the caller names a block size */
#define SMR_BLOCK_MIN 64u
#define SMR_BLOCK_MAX 2048u

smr_prepare_config smr_prepare_config_default(void)
{
    smr_prepare_config c;
    memset(&c, 0, sizeof c);
    c.cookie = SMR_COOKIE('P', smr_prepare_config);
    c.separate_below_mm = -1.0f;
    c.ring = 1;
    c.profile_samples = 30;
    c.profile_step_mm = 0.5f;
    c.profile_inward = 0.5f;
    return c;
}

static smr_status check_config(const smr_prepare_config *c)
{
    if (c->cookie != SMR_COOKIE('P', smr_prepare_config) || c->n_radii > SMR_RADII_MAX ||
        c->distance > SMR_DISTANCE_GEODESIC || c->mass > SMR_MASS_AREA || c->order > SMR_ORDER_BREADTH_FIRST ||
        c->ring > 1u || !smr_within(c->separate_below_mm, SMR_COORD_MAX) ||
        (c->block_vertices != 0u && (c->block_vertices < 16u || c->block_vertices > 65536u)))
        return SMR_E_CONFIG;
    if (c->profile_samples < 3u || c->profile_samples > SMR_PROFILE_MAX ||
        !(c->profile_step_mm > 1.0e-6f && c->profile_step_mm <= 100.0f) ||
        !(c->profile_inward >= 0.0f && c->profile_inward <= 1.0f))
        return SMR_E_CONFIG;
    for (uint32_t i = 0; i < c->n_radii; i++)
        if (!(c->radius_mm[i] > 0.0f && c->radius_mm[i] <= SMR_COORD_MAX))
            return SMR_E_CONFIG;
    return SMR_OK;
}

/* Counts only; the meshes' contents are looked at by smr_prepare(). */
static smr_status start_plan(smr_plan *p, const smr_structure *structures, uint32_t n, const smr_prepare_config *config)
{
    memset(p, 0, sizeof *p);
    if (structures == NULL || config == NULL)
        return SMR_E_NULL;
    if (n == 0u || n > SMR_STRUCTURES_MAX)
        return SMR_E_INPUT;
    p->structures = structures;
    p->config = config;
    p->n_structures = n;
    for (uint32_t i = 0; i < n; i++) {
        const smr_mesh *mesh = &structures[i].mesh;
        if (mesh->n_vertices == 0u || mesh->n_vertices > SMR_VERTICES_MAX - p->n ||
            mesh->n_triangles > SMR_TRIANGLES_MAX - p->nt)
            return SMR_E_INPUT;
        p->n += mesh->n_vertices;
        p->nt += mesh->n_triangles;
    }
    p->words = smr_ceil_div(p->n, 64u);
    const size_t affordable = SMR_ROW_BYTES_MAX / (p->words * sizeof(uint64_t));
    uint32_t block = smr_min_u32(smr_max_u32(p->n / 8u, 256u), SMR_BLOCK_MAX);
    block = (uint32_t)(affordable < block ? affordable : block);
    block = smr_max_u32(block, SMR_BLOCK_MIN);
    p->block = smr_min_u32(config->block_vertices != 0u ? config->block_vertices : block, p->n);
    p->n_rows = smr_max_u32(p->block + 1u, 3u);
    return check_config(config);
}

void smr_plan_layout(smr_arena *a, smr_plan *p)
{
    const size_t n = p->n, nt = p->nt, u = sizeof(uint32_t);
    const size_t pairs = (size_t)p->block * (SMR_NEAREST + SMR_RING_TRIED + 1u);
    size_t most = n > 6u * nt ? n : 6u * nt; /* a vertex' neighbours before they are thinned */
    most = most > pairs ? most : pairs;
    const int geodesic = p->config->distance == SMR_DISTANCE_GEODESIC;
    p->xyz = smr_arena_take(a, n, 3u * sizeof(float));
    p->mass = smr_arena_take(a, n, sizeof(float));
    p->owner = smr_arena_take(a, n, sizeof(uint16_t));
    p->position = smr_arena_take(a, n, u);
    p->original = smr_arena_take(a, n, u);
    p->triangle = smr_arena_take(a, nt, 3u * u);
    p->facet = smr_arena_take(a, nt, u);
    p->ring_start = smr_arena_take(a, n + 1u, u);
    p->ring = smr_arena_take(a, nt, 6u * u);
    p->hinge = smr_arena_take(a, nt + (nt + 1u) / 2u, sizeof(smr_image_hinge));
    const int image = p->config->reference != NULL;
    p->profile = image ? smr_arena_take(a, n, p->config->profile_samples) : NULL;
    p->range = image ? smr_arena_take(a, n, 2u * sizeof(float)) : NULL;
    p->normal = image ? smr_arena_take(a, n, 3u * sizeof(float)) : NULL;
    smr_tree_shape(&p->points, p->n);
    p->points.node = smr_arena_take(a, smr_tree_nodes(p->n), sizeof(smr_node));
    p->row = smr_arena_take(a, p->n_rows, p->words * sizeof(uint64_t));
    p->count = smr_arena_take(a, n, u);
    p->rank = smr_arena_take(a, n, u);
    p->middle = smr_arena_take(a, nt, 3u * sizeof(float));
    p->key = smr_arena_take(a, most, u);
    p->item = smr_arena_take(a, most, u);
    p->tmp = smr_arena_take(a, most, 2u * u);
    p->edge_a = smr_arena_take(a, pairs, u);
    p->edge_b = smr_arena_take(a, pairs, u);
    p->set = smr_arena_take(a, (size_t)p->block + 1u, u);
    p->link_start = smr_arena_take(a, (size_t)p->block + 2u, u);
    p->link = smr_arena_take(a, (size_t)p->block + 1u, 2u * u);
    p->queue = smr_arena_take(a, n + 1u, u);
    p->geo_distance = geodesic ? smr_arena_take(a, n, u) : NULL;
    p->geo_heap = geodesic ? smr_arena_take(a, 6u * nt + 1u, 2u * u) : NULL;
}

smr_status smr_prepare_bytes(const smr_structure *structures, uint32_t n_structures, const smr_prepare_config *config,
                             size_t *scratch_bytes)
{
    smr_plan p;
    if (scratch_bytes == NULL)
        return SMR_E_NULL;
    smr_status status = start_plan(&p, structures, n_structures, config);
    if (status != SMR_OK)
        return status;
    smr_arena a = smr_arena_measure();
    smr_plan_layout(&a, &p);
    *scratch_bytes = a.used;
    return a.used == SIZE_MAX ? SMR_E_INPUT : SMR_OK;
}

/* What smr_image_radius will say, while its lists are written behind it. */
static void write_radius(smr_writer *w, size_t at, const smr_list_writer *l, const smr_plan *p, float radius)
{
    const int ring = smr_uses_ring(p, radius) && p->edge_max > radius;
    const uint32_t field[12] = {smr_float_bits(radius),
                                smr_float_bits(ring ? p->edge_max : radius),
                                p->separate,
                                l->n_blocks,
                                l->largest,
                                l->smallest,
                                smr_float_bits((float)l->n_members / (float)p->n),
                                l->n_indexes,
                                (uint32_t)l->at_blocks,
                                (uint32_t)l->at_entries,
                                (uint32_t)l->at_count,
                                (uint32_t)l->at_indexes};
    for (uint32_t i = 0; i < 12u; i++)
        smr_put32(w, at + 4u * i, field[i]);
}

/* Blocks of the curve order, the same size but for one vertex. */
static smr_status write_lists(smr_plan *p, smr_writer *w, size_t at, float radius, uint32_t step, uint32_t steps)
{
    const int forest = p->config->order == SMR_ORDER_FOREST;
    const uint32_t n_blocks = forest ? smr_ceil_div(p->n, p->block) : 1u;
    smr_list_writer l;
    memset(&l, 0, sizeof l);
    l.w = w;
    l.index_bytes = p->n <= 65535u ? 2u : 4u;
    l.at_blocks = smr_put_section(w, ((size_t)n_blocks + 1u) * sizeof(smr_image_block));
    l.at_entries = smr_put_section(w, (size_t)p->n * 4u * l.index_bytes);
    l.at_count = smr_put_section(w, (size_t)p->n * l.index_bytes);
    l.at_indexes = smr_put_section(w, 0);
    if (forest) {
        for (uint32_t b = 0; b < n_blocks; b++) {
            const uint32_t first = (uint32_t)((uint64_t)b * p->n / n_blocks);
            const uint32_t last = (uint32_t)(((uint64_t)b + 1u) * p->n / n_blocks);
            smr_forest_block(p, &l, first, last, radius);
            if (p->config->progress != NULL &&
                p->config->progress(p->config->progress_ctx, step * n_blocks + b, steps * n_blocks) != 0)
                return SMR_E_ABORTED;
            if (w->used > UINT32_MAX)
                return SMR_E_INPUT;
        }
    } else {
        smr_status status = smr_breadth_first(p, &l, radius, step, steps);
        if (status != SMR_OK)
            return status;
    }
    const uint32_t n_written = l.n_blocks;
    smr_list_block(&l, p->n);
    l.n_blocks = n_written;
    write_radius(w, at, &l, p, radius);
    return w->used > UINT32_MAX ? SMR_E_INPUT : SMR_OK;
}

static size_t write_structures(const smr_plan *p, smr_writer *w)
{
    const size_t at = smr_put_section(w, p->n_structures * sizeof(smr_image_structure));
    uint32_t vertices = 0, triangles = 0;
    for (uint32_t s = 0; s < p->n_structures; s++) {
        const size_t to = at + s * sizeof(smr_image_structure);
        const char *name = p->structures[s].name == NULL ? "" : p->structures[s].name;
        for (size_t i = 0; i + 1u < SMR_NAME_BYTES && name[i] != '\0'; i++)
            if (w->image != NULL && to + i < w->capacity)
                w->image[to + i] = (unsigned char)name[i];
        smr_put32(w, to + SMR_NAME_BYTES, vertices);
        smr_put32(w, to + SMR_NAME_BYTES + 4u, p->structures[s].mesh.n_vertices);
        smr_put32(w, to + SMR_NAME_BYTES + 8u, triangles);
        smr_put32(w, to + SMR_NAME_BYTES + 12u, p->structures[s].mesh.n_triangles);
        vertices += p->structures[s].mesh.n_vertices;
        triangles += p->structures[s].mesh.n_triangles;
    }
    return at;
}

static uint32_t write_u32(smr_writer *w, const uint32_t *value, size_t n)
{
    const size_t at = smr_put_section(w, n * sizeof *value);
    for (size_t i = 0; i < n; i++)
        smr_put32(w, at + 4u * i, value[i]);
    return (uint32_t)at;
}

static uint32_t write_floats(smr_writer *w, const float *value, size_t n)
{
    const size_t at = smr_put_section(w, n * sizeof *value);
    for (size_t i = 0; i < n; i++)
        smr_put32(w, at + 4u * i, smr_float_bits(value[i]));
    return (uint32_t)at;
}

static uint32_t write_bytes(smr_writer *w, const uint8_t *value, size_t n)
{
    const size_t at = smr_put_section(w, n);
    if (w->image != NULL && at + n <= w->capacity)
        memcpy(w->image + at, value, n);
    return (uint32_t)at;
}

static uint32_t write_owner(smr_writer *w, const smr_plan *p)
{
    const size_t at = smr_put_section(w, p->n * sizeof(uint16_t));
    for (uint32_t v = 0; v < p->n; v++)
        smr_put16(w, at + 2u * (size_t)v, p->owner[v]);
    return (uint32_t)at;
}

/* The whole image but its first four words, which need its length and checksum. */
static smr_status write_image(smr_plan *p, smr_writer *w, const float *radius, uint32_t n_radii, float separate_below)
{
    struct smr_model head;
    memset(&head, 0, sizeof head);
    smr_put_section(w, sizeof head);
    head.n_vertices = p->n;
    head.n_triangles = p->nt;
    head.n_structures = p->n_structures;
    head.n_radii = n_radii;
    head.index_bytes = p->n <= 65535u ? 2u : 4u;
    head.order = p->config->order;
    for (uint32_t c = 0; c < 3u; c++)
        head.centre[c] = smr_float_bits(p->centre[c]);
    head.edge_mm = smr_float_bits(p->edge_mm);
    head.at_structures = (uint32_t)write_structures(p, w);
    head.at_position = write_u32(w, p->position, p->n);
    head.at_original = write_u32(w, p->original, p->n);
    head.at_owner = write_owner(w, p);
    head.at_rest = write_floats(w, p->xyz, 3u * (size_t)p->n);
    head.at_mass = write_floats(w, p->mass, p->n);
    head.at_triangles = write_u32(w, p->triangle, 3u * (size_t)p->nt);
    head.at_facets = write_u32(w, p->facet, p->nt);
    if (p->profile != NULL) {
        const uint32_t samples = p->config->profile_samples;
        head.profile_samples = samples;
        head.profile_inward = smr_min_u32((uint32_t)(p->config->profile_inward * (float)samples), samples - 1u);
        head.profile_step = smr_float_bits(p->config->profile_step_mm);
        head.at_profiles = write_bytes(w, p->profile, (size_t)p->n * samples);
        head.at_ranges = write_floats(w, p->range, 2u * (size_t)p->n);
    }
    head.n_hinges = p->n_hinges;
    head.at_hinges = write_u32(w, &p->hinge[0].first, 2u * (size_t)p->n_hinges);
    head.at_radii = (uint32_t)smr_put_section(w, n_radii * sizeof(smr_image_radius));
    for (uint32_t i = 0; i < n_radii; i++) {
        p->separate = radius[i] < separate_below;
        smr_status status =
            write_lists(p, w, head.at_radii + i * sizeof(smr_image_radius), radius[i], i, n_radii);
        if (status != SMR_OK)
            return status;
    }
    smr_put_section(w, 0);
    w->used = (w->used + SMR_ALIGN - 1u) / SMR_ALIGN * SMR_ALIGN;
    if (w->used > UINT32_MAX)
        return SMR_E_INPUT;
    head.magic = SMR_IMAGE_MAGIC;
    head.version = SMR_IMAGE_VERSION;
    head.bytes = (uint32_t)w->used;
    uint32_t words[sizeof head / 4u];
    memcpy(words, &head, sizeof words);
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++)
        smr_put32(w, 4u * i, words[i]);
    return SMR_OK;
}

smr_status smr_prepare(const smr_structure *structures, uint32_t n_structures, const smr_prepare_config *config,
                       void *scratch, size_t scratch_bytes, void *image, size_t image_capacity, size_t *image_bytes)
{
    smr_plan p;
    smr_arena a;
    size_t needed;
    if (image_bytes == NULL)
        return SMR_E_NULL;
    smr_status status = smr_prepare_bytes(structures, n_structures, config, &needed);
    if (status != SMR_OK)
        return status;
    status = smr_arena_start(&a, scratch, scratch_bytes);
    if (status == SMR_OK && (uintptr_t)image % SMR_ALIGN != 0u)
        status = SMR_E_ALIGN;
    for (uint32_t s = 0; status == SMR_OK && s < n_structures; s++)
        status = smr_mesh_check(&structures[s].mesh);
    if (status == SMR_OK && needed > scratch_bytes)
        status = SMR_E_ARENA;
    if (status != SMR_OK)
        return status;
    (void)start_plan(&p, structures, n_structures, config);
    smr_arena_release(scratch, scratch_bytes);
    smr_plan_layout(&a, &p);
    smr_plan_order(&p);
    smr_plan_mass(&p);
    smr_plan_hinges(&p);
    status = smr_plan_profiles(&p);
    if (status != SMR_OK) {
        smr_arena_release(scratch, scratch_bytes);
        return status;
    }
    float radius[SMR_RADII_MAX];
    uint32_t n_radii = config->n_radii;
    memcpy(radius, config->radius_mm, sizeof radius);
    if (n_radii == 0u)
        n_radii = smr_choose_radii(&p, radius);
    float largest = 0.0f;
    for (uint32_t i = 0; i < n_radii; i++)
        largest = smr_max(largest, radius[i]);
    const float below = config->separate_below_mm < 0.0f ? largest / 3.0f : config->separate_below_mm;
    smr_writer w = {image, image == NULL ? 0u : image_capacity, 0};
    status = write_image(&p, &w, radius, n_radii, below);
    smr_arena_release(scratch, scratch_bytes);
    if (status != SMR_OK)
        return status;
    *image_bytes = w.used;
    if (image == NULL)
        return SMR_OK;
    if (w.used > image_capacity)
        return SMR_E_ARENA;
    smr_put32(&w, 12u, smr_crc32(0, (const unsigned char *)image + SMR_IMAGE_HEAD, w.used - SMR_IMAGE_HEAD));
    return SMR_OK;
}
