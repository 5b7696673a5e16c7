/* model_write.c: writes the sections of a model, little-endian (docs/SPEC.md has the table).
 * SPDX-License-Identifier: MIT */
#include "prepare/prepare_plan.h"

/* Writes the smr_stored_radius of one radius at offset `at`. l: the radius' lists, already complete. */
static void write_radius(smr_writer *w, size_t at, const smr_list_writer *l, const smr_plan *p, float radius,
                         uint32_t active_min)
{
    const int ring = smr_holds_neighbours(p, radius) && p->edge_max > radius;
    const float reach = ring ? p->edge_max : radius, mean = (float)l->n_members / (float)p->n;
    const uint32_t sizes[8] = {
        smr_float_bits(radius), smr_float_bits(reach), p->separate, l->n_blocks, l->largest, l->smallest,
        smr_float_bits(mean),   l->n_indexes};
    const uint64_t others[7] = {l->at_blocks, l->at_entries, l->at_count,   l->at_indexes,
                                active_min,   l->n_boundary, l->at_boundary};
    smr_put_words(w, at, sizes, 8);
    for (uint32_t i = 0; i < 7u; i++)
        smr_put32(w, at + 32u + 4u * i, (uint32_t)others[i]);
}

/* Writes the cluster lists of one radius. Blocks are parts of the curve with equal numbers of vertices, +- 1. */
static smr_status write_lists(smr_plan *p, smr_writer *w, size_t at, float radius, uint32_t index, uint32_t n_radii)
{
    const int forest = p->config->order == SMR_ORDER_FOREST;
    const uint32_t n_blocks = forest ? smr_ceil_div(p->n, p->block_size) : 1u;
    smr_list_writer l = {.w = w, .index_bytes = p->n <= 65535u ? 2u : 4u};
    l.at_blocks = smr_put_section(w, ((size_t)n_blocks + 1u) * sizeof(smr_stored_block));
    l.at_entries = smr_put_section(w, (size_t)p->n * 4u * l.index_bytes);
    l.at_count = smr_put_section(w, (size_t)p->n * l.index_bytes);
    l.at_indexes = smr_put_section(w, 0);
    if (forest) {
        for (uint32_t b = 0; b < n_blocks; b++) {
            const uint32_t first = (uint32_t)((uint64_t)b * p->n / n_blocks);
            const uint32_t last = (uint32_t)(((uint64_t)b + 1u) * p->n / n_blocks);
            smr_forest_block(p, &l, first, last, radius);
            if (p->failed)
                return SMR_E_STATE;
            if (p->config->progress != NULL &&
                p->config->progress(p->config->progress_ctx, index * n_blocks + b, n_radii * n_blocks) != 0)
                return SMR_E_ABORTED;
            if (w->used > UINT32_MAX)
                return SMR_E_INPUT;
        }
        p->forest.nearest_kind = 1u + smr_keeps_apart(p);
    } else {
        SMR_TRY(smr_breadth_first(p, &l, radius, index, n_radii));
    }
    smr_list_block(&l); /* one more block record, which marks the end of the last block */
    l.n_blocks = n_blocks;
    smr_write_boundary(p, &l, radius);
    write_radius(w, at, &l, p, radius, p->active_min[index]);
    return w->used > UINT32_MAX ? SMR_E_INPUT : SMR_OK;
}

static size_t write_structures(const smr_plan *p, smr_writer *w)
{
    const size_t at = smr_put_section(w, p->n_structures * sizeof(smr_stored_structure));
    uint32_t vertices = 0, triangles = 0;
    for (uint32_t s = 0; s < p->n_structures; s++) {
        const size_t to = at + s * sizeof(smr_stored_structure);
        const char *name = p->structures[s].name == NULL ? "" : p->structures[s].name;
        for (size_t i = 0; i + 1u < SMR_NAME_BYTES && name[i] != '\0'; i++)
            if (w->model != NULL && to + i < w->capacity)
                w->model[to + i] = (unsigned char)name[i];
        const smr_mesh *mesh = &p->structures[s].mesh;
        const uint32_t field[4] = {vertices, mesh->n_vertices, triangles, mesh->n_triangles};
        smr_put_words(w, to + SMR_NAME_BYTES, field, 4);
        vertices += mesh->n_vertices;
        triangles += mesh->n_triangles;
    }
    return at;
}

/* Writes a section of the n numbers value[table[i]]; table NULL: value[i]. Returns the section's offset. */
static uint32_t write_through(smr_writer *w, const uint32_t *value, const uint32_t *table, size_t n)
{
    const size_t at = smr_put_section(w, n * sizeof *value);
    for (size_t i = 0; i < n; i++)
        smr_put32(w, at + 4u * i, value[table == NULL ? i : table[i]]);
    return (uint32_t)at;
}

/* Writes a section with `width` floats for each vertex, in stored order. Returns the section's offset. */
static uint32_t write_floats(smr_writer *w, const smr_plan *p, const float *value, size_t width)
{
    const size_t at = smr_put_section(w, p->n * width * sizeof *value);
    for (size_t i = 0; i < p->n * width; i++)
        smr_put32(w, at + 4u * i, smr_float_bits(value[p->along[i / width] * width + i % width]));
    return (uint32_t)at;
}

/* Writes a section with `width` bytes for each vertex, in stored order. Returns the section's offset. */
static uint32_t write_bytes(smr_writer *w, const smr_plan *p, const uint8_t *value, size_t width)
{
    const size_t at = smr_put_section(w, p->n * width);
    for (size_t v = 0; v < p->n; v++)
        if (w->model != NULL && at + (v + 1u) * width <= w->capacity)
            memcpy(w->model + at + v * width, value + p->along[v] * width, width);
    return (uint32_t)at;
}

/* Writes the sections with values for each vertex, triangle or dihedral edge. */
static void write_mesh(smr_plan *p, smr_writer *w, struct smr_model *head)
{
    head->at_position = write_through(w, p->stored, p->position, p->n);
    head->at_original = write_through(w, p->original, p->along, p->n);
    head->at_along = write_through(w, p->along, NULL, p->n);
    head->at_owner = (uint32_t)smr_put_section(w, p->n * sizeof(uint16_t));
    for (uint32_t v = 0; v < p->n; v++)
        smr_put16(w, head->at_owner + 2u * (size_t)v, p->owner[p->along[v]]);
    head->at_rest = write_floats(w, p, p->xyz, 3);
    head->at_mass = write_floats(w, p, p->mass, 1);
    head->at_triangles = write_through(w, p->stored, p->triangle, 3u * (size_t)p->nt);
    head->at_triangle_index = write_through(w, p->triangle_index, NULL, p->nt);
    if (p->profile != NULL) {
        const uint32_t samples = p->config->profile_samples;
        head->profile_samples = samples;
        head->profile_inward = smr_profile_inward(p->config);
        head->profile_step = smr_float_bits(p->config->profile_step_mm);
        head->at_profiles = write_bytes(w, p, p->profile, samples);
        head->at_ranges = write_floats(w, p, p->range, 2);
    }
    head->n_dihedrals = p->n_dihedrals;
    head->at_dihedrals = write_through(w, &p->dihedral[0].first, NULL, 2u * (size_t)p->n_dihedrals);
}

/* Writes the additional sections behind a table of them. */
static void write_sections(const smr_plan *p, smr_writer *w, struct smr_model *head)
{
    const uint32_t shapes = p->config->also != NULL && p->config->also->n > 0u, relief = p->nt > 0u;
    uint32_t entry[2][4];
    head->n_sections = shapes + relief;
    if (head->n_sections == 0u)
        return;
    head->at_sections = (uint32_t)smr_put_section(w, head->n_sections * sizeof(smr_stored_section));
    if (shapes)
        smr_write_references(p, w, entry[0]);
    if (relief)
        smr_write_relief(p, w, entry[shapes]);
    smr_put_words(w, head->at_sections, entry[0], 4u * (size_t)head->n_sections);
}

smr_status smr_write_model(smr_plan *p, smr_writer *w, const float *radius, uint32_t n_radii, float separate_below)
{
    struct smr_model head = {.magic = SMR_MODEL_MAGIC,
                             .version = SMR_MODEL_VERSION,
                             .n_vertices = p->n,
                             .n_triangles = p->nt,
                             .n_structures = p->n_structures,
                             .n_radii = n_radii,
                             .index_bytes = p->n <= 65535u ? 2u : 4u,
                             .order = p->config->order,
                             .edge_mm = smr_float_bits(p->edge_mm),
                             .n_levels = p->n_levels,
                             .coarse_radii = p->coarse_radii,
                             .coarse_vertices = p->coarse_vertices};
    smr_put_section(w, sizeof head);
    memcpy(head.centre, p->centre, sizeof head.centre);
    memcpy(head.level_end, p->level_end, p->n_levels * sizeof head.level_end[0]);
    head.at_structures = (uint32_t)write_structures(p, w);
    write_mesh(p, w, &head);
    head.at_radii = (uint32_t)smr_put_section(w, n_radii * sizeof(smr_stored_radius));
    for (uint32_t i = 0; i < n_radii; i++) {
        p->separate = radius[i] < separate_below;
        smr_plan_members(p, i);
        SMR_TRY(write_lists(p, w, head.at_radii + i * sizeof(smr_stored_radius), radius[i], i, n_radii));
    }
    write_sections(p, w, &head);
    smr_put_section(w, 0);
    w->used = (w->used + SMR_ALIGN - 1u) / SMR_ALIGN * SMR_ALIGN;
    if (w->used > UINT32_MAX)
        return SMR_E_INPUT;
    head.bytes = (uint32_t)w->used;
    uint32_t words[sizeof head / 4u];
    memcpy(words, &head, sizeof words);
    smr_put_words(w, 0, words, sizeof words / sizeof words[0]);
    return SMR_OK;
}
