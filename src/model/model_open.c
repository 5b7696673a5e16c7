/* model_open.c: smr_model_open() and its checks, after which every count, offset and index of a model is safe to use. A
 * job (base/job.h) of stages that check arrays in pieces; a stage relies on the counts and sections checked before it.
 * Work: one pass over the bytes, and over each radius' entries once per 4,096 vertices of a block.
 * SPDX-License-Identifier: MIT */
#include "image/intensity_profile.h"
#include "model/model_open.h"

#define SMR_RANGE_MAX 2.0e30f /* largest range or absolute low of a profile: twice the largest voxel value */
#define SMR_DIFFERENCE_MAX (8.0f * SMR_COORD_MAX) /* mm: largest difference of a reference from the mean shape */

/* Checks that a section of count * size bytes at a stored offset lies inside the model. */
SMR_SHARED static int section(const smr_model *m, uint32_t stored_offset, uint64_t count, uint64_t size)
{
    uint64_t at = smr_le32(stored_offset), bytes = smr_le32(m->bytes);
    return at % SMR_ALIGN == 0u && at >= sizeof *m && count <= bytes && at + count * size <= bytes;
}

static int check_structures(const smr_model *m)
{
    const uint32_t n = smr_le32(m->n_structures);
    uint64_t vertices = 0, triangles = 0;
    if (!section(m, m->at_structures, n, sizeof(smr_stored_structure)))
        return 0;
    for (uint32_t i = 0; i < n; i++) {
        const smr_stored_structure *r = smr_model_record(m, i);
        if (smr_le32(r->first_vertex) != vertices || smr_le32(r->first_triangle) != triangles ||
            r->name[SMR_NAME_BYTES - 1u] != '\0')
            return 0;
        vertices += smr_le32(r->n_vertices);
        triangles += smr_le32(r->n_triangles);
    }
    return vertices == smr_le32(m->n_vertices) && triangles == smr_le32(m->n_triangles);
}

uint32_t smr_open_vertex_tasks(const void *job) { return smr_open_pieces(smr_le32(smr_opened(job)->n_vertices)); }

/* Checks rest positions, masses and ranges of profiles, that position and original are inverse to each other, and that
 * owner agrees with the structures. */
SMR_SELDOM static void check_vertices(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_opening *j = job;
    const smr_model *m = j->m;
    const uint32_t n = smr_le32(m->n_vertices), *rest = smr_at(m, m->at_rest);
    const smr_piece p = smr_piece_of(task, SMR_OPEN_PIECE, n);
    const size_t first = p.first, count = p.last - p.first;
    int legal = smr_floats_within(rest + 3u * first, 3u * count, -2.0f * SMR_COORD_MAX, 2.0f * SMR_COORD_MAX) &&
                smr_floats_within((const uint32_t *)smr_at(m, m->at_mass) + first, count, 1.0f / SMR_MASS_UNITS,
                                  SMR_MASS_MAX) &&
                (m->profile_samples == 0u || smr_floats_within((const uint32_t *)smr_at(m, m->at_ranges) + 2u * first,
                                                               2u * count, -SMR_RANGE_MAX, SMR_RANGE_MAX));
    for (size_t i = 3u * first; i < 3u * (size_t)p.last; i++)
        legal &= smr_within(smr_le_float(rest[i]) + smr_le_float(m->centre[i % 3u]), SMR_COORD_MAX + 1.0f);
    j->k = task == 0u ? 0u : j->k;
    for (uint32_t i = p.first; i < p.last && legal; i++) {
        const smr_stored_structure *r = smr_model_record(m, j->k);
        while (i >= smr_le32(r->first_vertex) + smr_le32(r->n_vertices))
            r = smr_model_record(m, ++j->k);
        const uint32_t v = smr_word_at(m, m->at_position, i);
        legal = v < n && smr_word_at(m, m->at_original, v) == i && smr_model_owner(m, v) == j->k;
    }
    smr_open_require(j, legal);
}

/* Checks that levels are ranges of stored vertices, in order. */
static int check_level_table(const smr_model *m)
{
    const uint32_t n = smr_le32(m->n_vertices), n_levels = smr_le32(m->n_levels);
    uint32_t begin = 0;
    if (n_levels == 0u || n_levels > SMR_LEVELS_MAX || !section(m, m->at_along, n, 4))
        return 0;
    for (uint32_t i = 0; i < n_levels; i++) {
        if (smr_le32(m->level_end[i]) <= begin || smr_le32(m->level_end[i]) > n)
            return 0;
        begin = smr_le32(m->level_end[i]);
    }
    return begin == n;
}

/* Checks that curve positions ascend in each level, and are 0 .. n - 1 in all, each once. */
static void check_levels(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_opening *j = job;
    const smr_model *m = j->m;
    const uint32_t n_levels = smr_le32(m->n_levels);
    const smr_piece p = smr_piece_of(task, SMR_OPEN_PIECE, smr_le32(m->n_vertices));
    for (uint32_t i = 0; i < n_levels && task == 0u; i++)
        j->next[i] = i == 0u ? 0u : smr_le32(m->level_end[i - 1u]);
    for (uint32_t place = p.first; place < p.last; place++) {
        uint32_t i = 0;
        while (i < n_levels && (j->next[i] == smr_le32(m->level_end[i]) || smr_model_along(m, j->next[i]) != place))
            i++;
        if (i == n_levels) {
            smr_open_require(j, 0);
            return;
        }
        j->next[i]++;
    }
}

static int check_vertex_table(const smr_model *m)
{
    const uint32_t n = smr_le32(m->n_vertices), nt = smr_le32(m->n_triangles);
    return section(m, m->at_position, n, 4) && section(m, m->at_original, n, 4) && section(m, m->at_owner, n, 2) &&
           section(m, m->at_rest, n, 12) && section(m, m->at_mass, n, 4) && section(m, m->at_triangles, nt, 12) &&
           section(m, m->at_triangle_index, nt, 4) && check_level_table(m) &&
           section(m, m->at_dihedrals, smr_le32(m->n_dihedrals), sizeof(smr_stored_dihedral)) &&
           smr_floats_within(m->centre, 3, -SMR_COORD_MAX, SMR_COORD_MAX) &&
           smr_floats_within(&m->edge_mm, 1, 0.0f, 4.0f * SMR_COORD_MAX);
}

static uint32_t dihedral_tasks(const void *job) { return smr_open_pieces(smr_le32(smr_opened(job)->n_dihedrals)); }

static void check_dihedrals(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    const smr_model *m = smr_opened(job);
    const smr_piece p = smr_piece_of(task, SMR_OPEN_PIECE, smr_le32(m->n_dihedrals));
    const uint32_t nt = smr_le32(m->n_triangles);
    const smr_stored_dihedral *h = smr_at(m, m->at_dihedrals);
    int legal = 1;
    for (uint32_t i = p.first; i < p.last; i++)
        legal &= smr_le32(h[i].first) < nt && (smr_le32(h[i].bend) & SMR_DIHEDRAL_MASK) < nt;
    smr_open_require(job, legal);
}

static int check_profile_table(const smr_model *m)
{
    const uint32_t n = smr_le32(m->n_vertices), samples = smr_le32(m->profile_samples);
    return samples == 0u || (samples >= 3u && samples <= SMR_PROFILE_MAX && smr_le32(m->profile_inward) < samples &&
                             smr_floats_within(&m->profile_step, 1, 1.0e-6f, 100.0f) &&
                             section(m, m->at_profiles, n, samples) && section(m, m->at_ranges, n, 8));
}

static uint32_t triangle_tasks(const void *job) { return smr_open_pieces(smr_le32(smr_opened(job)->n_triangles)); }

/* Checks that the corners and the caller's index of each triangle belong to the triangle's structure. */
SMR_SELDOM static void check_triangles(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_opening *j = job;
    const smr_model *m = j->m;
    const uint32_t *triangle_index = smr_at(m, m->at_triangle_index), *corner = smr_at(m, m->at_triangles);
    const smr_piece p = smr_piece_of(task, SMR_OPEN_PIECE, smr_le32(m->n_triangles));
    int legal =
        smr_all_below(corner + 3u * (size_t)p.first, 4, 3u * (size_t)(p.last - p.first), smr_le32(m->n_vertices));
    j->k = task == 0u ? 0u : j->k;
    for (uint32_t i = p.first; i < p.last && legal; i++) {
        const smr_stored_structure *r = smr_model_record(m, j->k);
        while (i >= smr_le32(r->first_triangle) + smr_le32(r->n_triangles))
            r = smr_model_record(m, ++j->k);
        legal = smr_le32(triangle_index[i]) < smr_le32(r->n_triangles);
        for (size_t c = 3u * (size_t)i; c < 3u * (size_t)i + 3u; c++)
            legal &= smr_model_owner(m, smr_le32(corner[c])) == j->k;
    }
    smr_open_require(j, legal);
}

/* Checks that a radius' sections lie in the model, in order, from offset *end on. Sets *end to the last one's end. */
static int check_sections_of(const smr_model *m, const smr_stored_radius *r, uint64_t *end)
{
    const uint64_t n = smr_le32(m->n_vertices), width = smr_le32(m->index_bytes);
    const uint32_t at[5] = {r->at_blocks, r->at_entries, r->at_count, r->at_indexes, r->at_boundary};
    const uint64_t bytes[5] = {((uint64_t)smr_le32(r->n_blocks) + 1u) * sizeof(smr_stored_block), n * 4u * width,
                               n * width, (uint64_t)smr_le32(r->n_indexes) * width,
                               (uint64_t)smr_le32(r->n_boundary) * sizeof(smr_stored_boundary)};
    for (uint32_t i = 0; i < 5u; i++) {
        if (smr_le32(at[i]) < *end || !section(m, at[i], bytes[i], 1))
            return 0;
        *end = smr_le32(at[i]) + bytes[i];
    }
    return 1;
}

/* Checks the size of the differences of several shapes. */
static int check_references(const smr_model *m, const smr_stored_section *s)
{
    const uint32_t n = smr_reference_count(m, s);
    const size_t floats = 3u * (size_t)n * smr_le32(m->n_vertices);
    return n >= 2u && n <= SMR_REFERENCES_MAX && smr_le32(s->bytes) == sizeof(float) * floats;
}

static uint32_t reference_tasks(const void *job)
{
    const smr_stored_section *s = smr_model_references(smr_opened(job));
    return s == NULL ? 0u : smr_ceil_div(smr_le32(s->bytes) / 4u, SMR_OPEN_WORDS);
}

static void check_differences(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    const smr_stored_section *s = smr_model_references(smr_opened(job));
    const smr_piece p = smr_piece_of(task, SMR_OPEN_WORDS, smr_le32(s->bytes) / 4u);
    const uint32_t *from = smr_at(smr_opened(job), s->at);
    smr_open_require(job, smr_floats_within(from + p.first, p.last - p.first, -SMR_DIFFERENCE_MAX, SMR_DIFFERENCE_MAX));
}

/* Checks that additional sections follow each other. Required sections (flags) of unknown kinds are refused. */
static int check_sections(const smr_model *m)
{
    const uint32_t n = smr_le32(m->n_sections);
    uint64_t end = sizeof *m;
    for (uint32_t i = 0; i < sizeof m->zero / sizeof m->zero[0]; i++)
        if (m->zero[i] != 0u)
            return 0;
    if (n == 0u)
        return m->at_sections == 0u;
    if (n > SMR_SECTIONS_MAX || !section(m, m->at_sections, n, sizeof(smr_stored_section)))
        return 0;
    const smr_stored_section *s = smr_at(m, m->at_sections);
    for (uint32_t i = 0; i < n; i++) {
        if (s[i].kind == 0u || s[i].flags != 0u || !section(m, s[i].at, smr_le32(s[i].bytes), 1) ||
            smr_le32(s[i].at) < end || (smr_le32(s[i].kind) == SMR_SECTION_REFERENCES && !check_references(m, &s[i])) ||
            (smr_le32(s[i].kind) == SMR_SECTION_RELIEF && smr_le32(s[i].bytes) != 2u * smr_le32(m->n_vertices)))
            return 0;
        for (uint32_t k = 0; k < i; k++)
            if (s[k].kind == s[i].kind)
                return 0;
        end = (uint64_t)smr_le32(s[i].at) + smr_le32(s[i].bytes);
    }
    return 1;
}

int smr_model_known(const smr_model *m)
{
    if ((uintptr_t)m % SMR_ALIGN != 0u)
        return 0; /* no word is read from there */
    const uint32_t n = smr_le32(m->n_vertices), width = smr_le32(m->index_bytes);
    return smr_le32(m->magic) == SMR_MODEL_MAGIC && smr_le32(m->version) == SMR_MODEL_VERSION &&
           smr_le32(m->bytes) >= sizeof *m && n >= 1u && n <= SMR_VERTICES_MAX &&
           smr_le32(m->n_triangles) <= SMR_TRIANGLES_MAX && smr_le32(m->n_structures) >= 1u &&
           smr_le32(m->n_structures) <= SMR_STRUCTURES_MAX && smr_le32(m->n_radii) >= 1u &&
           smr_le32(m->n_radii) <= SMR_RADII_MAX && (width == 4u || (width == 2u && n <= 65535u)) &&
           smr_le32(m->coarse_radii) < smr_le32(m->n_radii) && (m->coarse_radii == 0u) == (m->coarse_vertices == 0u);
}

static uint32_t byte_tasks(const void *job)
{
    return smr_ceil_div(smr_le32(smr_opened(job)->bytes) - SMR_MODEL_HEAD, SMR_OPEN_BYTES);
}

static void sum_bytes(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_opening *j = job;
    const smr_piece p = smr_piece_of(task, SMR_OPEN_BYTES, smr_le32(j->m->bytes) - SMR_MODEL_HEAD);
    j->crc = smr_crc32(j->crc, (const unsigned char *)j->m + SMR_MODEL_HEAD + p.first, p.last - p.first);
    if (task + 1u == byte_tasks(j))
        smr_open_require(j, j->crc == smr_le32(j->m->checksum));
}

SMR_SELDOM static void check_tables(void *job, SMR_UNUSED uint32_t task, SMR_UNUSED uint32_t worker)
{
    const smr_model *m = smr_opened(job);
    int legal = check_sections(m) && check_structures(m) && check_vertex_table(m) && check_profile_table(m) &&
                section(m, m->at_radii, smr_le32(m->n_radii), sizeof(smr_stored_radius));
    uint64_t end = sizeof *m;
    for (uint32_t i = 0; i < smr_le32(m->n_radii) && legal; i++)
        legal = check_sections_of(m, smr_model_radius(m, i), &end);
    smr_open_require(job, legal);
}

static void first_radius(void *job, SMR_UNUSED uint32_t task, SMR_UNUSED uint32_t worker)
{
    ((smr_opening *)job)->k = 0;
}

static void next_radius(void *job, SMR_UNUSED uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_opening *j = job;
    if (++j->k < smr_le32(j->m->n_radii))
        j->head.next_stage = j->head.stage - 5u;
    else
        *j->out = j->m;
}

static const smr_stage stages[] = {
    {byte_tasks, sum_bytes, smr_in_order, NULL},
    {NULL, check_tables, NULL, NULL},
    {smr_open_vertex_tasks, check_vertices, smr_in_order, NULL},
    {smr_open_vertex_tasks, check_levels, smr_in_order, NULL},
    {triangle_tasks, check_triangles, smr_in_order, NULL},
    {dihedral_tasks, check_dihedrals, smr_in_order, NULL},
    {reference_tasks, check_differences, smr_in_order, NULL},
    {NULL, first_radius, NULL, NULL},
    {NULL, smr_open_radius, NULL, NULL},
    {smr_open_boundary_tasks, smr_open_boundary, smr_in_order, NULL},
    {smr_open_index_tasks, smr_open_indexes, smr_in_order, NULL},
    {smr_open_vertex_tasks, smr_open_counts, smr_in_order, NULL},
    {NULL, smr_open_blocks, NULL, NULL}, /* comes back for each piece */
    {NULL, next_radius, NULL, NULL},     /* back to smr_open_radius */
};

smr_status smr_model_open_begin(const void *memory, size_t bytes, const smr_model **model, smr_job *job)
{
    smr_opening *const j = (smr_opening *)(void *)job;
    if (memory == NULL || model == NULL || job == NULL)
        return SMR_E_NULL;
    if ((uintptr_t)memory % SMR_ALIGN != 0u)
        return SMR_E_ALIGN;
    const smr_model *m = memory;
    if (bytes < sizeof *m || !smr_model_known(m) || smr_le32(m->bytes) > bytes)
        return SMR_E_MODEL;
    memset(j, 0, sizeof *j);
    j->head = smr_job_begin(stages, sizeof stages / sizeof stages[0], NULL);
    j->m = m;
    j->out = model;
    return SMR_OK;
}

smr_status smr_model_open(const void *memory, size_t bytes, const smr_model **model)
{
    smr_job job;
    return smr_job_whole(smr_model_open_begin(memory, bytes, model, &job), &job, NULL);
}
