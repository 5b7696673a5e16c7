/* model_open.c: smr_model_open() and its checks, after which every count, offset and index of a model is safe to use. A
 * job (base/job.h) of stages that check arrays in pieces; a stage relies on the counts and sections checked before it.
 * Work: one pass over the bytes, and over each radius' entries once per 4,096 vertices of a block.
 * SPDX-License-Identifier: MIT */
#include "base/job.h"
#include "image/intensity_profile.h"
#include "model/model.h"

#define SMR_RANGE_MAX 2.0e30f /* most of a profile's range or absolute low: twice the largest absolute voxel value */
#define SMR_DIFFERENCE_MAX (8.0f * SMR_COORD_MAX) /* mm: largest difference of a reference from the mean shape */
#define SMR_WINDOW 4096u /* vertices checked at a time for having one entry each, a bit each on the stack */

#define SMR_OPEN_PIECE 512u  /* vertices, triangles, entries or indexes checked in a task */
#define SMR_OPEN_BYTES 8192u /* bytes in a task that sums them */

/* A model whose checks are under way. */
typedef struct opening {
    smr_job_head head;
    const smr_model *m;
    const smr_model **out;
    uint32_t crc, k;                    /* checksum of the bytes so far; radius that is checked now */
    uint32_t block, lo, i;              /* block of that radius; first vertex of the window; entry, from the block's first on */
    uint64_t used;                      /* number of indexes of the block's entries so far */
    uint32_t next[SMR_LEVELS_MAX];      /* next vertex of each level */
    uint32_t visited[SMR_WINDOW / 32u]; /* a bit for each vertex of the window */
} opening;

_Static_assert(sizeof(opening) <= SMR_JOB_BYTES, "checks in progress lie in the caller's job");

static const smr_model *m_of(const void *job) { return ((const opening *)job)->m; }
static void require(void *job, int legal)
{
    if (!legal)
        ((opening *)job)->head.status = SMR_E_MODEL;
}

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

SMR_SHARED static int floats_within(const uint32_t *stored, size_t n, float lo, float hi)
{
    int legal = 1;
    for (size_t i = 0; i < n; i++)
        legal &= smr_le_float(stored[i]) >= lo && smr_le_float(stored[i]) <= hi;
    return legal;
}

/* Returns 1 when all n indexes of the list, each `width` bytes wide, are below `limit`. */
SMR_SHARED static int all_below(const void *list, uint32_t width, size_t n, uint32_t limit)
{
    int legal = 1;
    for (size_t i = 0; i < n; i++)
        legal &= smr_index_at(list, width, i) < limit;
    return legal;
}

/* Checks that position and original are inverse to each other, and that owner agrees with the structures. */
static int check_numbering(const smr_model *m)
{
    const uint32_t n = smr_le32(m->n_vertices);
    for (uint32_t s = 0; s < smr_le32(m->n_structures); s++) {
        const uint32_t first = smr_le32(smr_model_record(m, s)->first_vertex);
        const uint32_t last = first + smr_le32(smr_model_record(m, s)->n_vertices);
        for (uint32_t i = first; i < last; i++) {
            const uint32_t v = smr_word_at(m, m->at_position, i);
            if (v >= n || smr_word_at(m, m->at_original, v) != i || smr_model_owner(m, v) != s)
                return 0;
        }
    }
    return 1;
}

/* Checks that levels are ranges of stored vertices in which curve positions ascend, 0 .. n - 1 in all, each once. */
static int check_levels(const smr_model *m)
{
    const uint32_t n = smr_le32(m->n_vertices), n_levels = smr_le32(m->n_levels);
    uint32_t at[SMR_LEVELS_MAX], begin = 0;
    if (n_levels == 0u || n_levels > SMR_LEVELS_MAX || !section(m, m->at_along, n, 4))
        return 0;
    for (uint32_t i = 0; i < n_levels; i++) {
        at[i] = begin;
        if (smr_le32(m->level_end[i]) <= begin || smr_le32(m->level_end[i]) > n)
            return 0;
        begin = smr_le32(m->level_end[i]);
    }
    if (begin != n)
        return 0;
    for (uint32_t place = 0; place < n; place++) {
        uint32_t i = 0;
        while (i < n_levels && (at[i] == smr_le32(m->level_end[i]) || smr_model_along(m, at[i]) != place))
            i++;
        if (i == n_levels)
            return 0;
        at[i]++;
    }
    return 1;
}

static int rest_within(const smr_model *m)
{
    const uint32_t *rest = smr_at(m, m->at_rest);
    int legal = 1;
    for (size_t i = 0; i < 3u * (size_t)smr_le32(m->n_vertices); i++)
        legal &= smr_within(smr_le_float(rest[i]) + smr_le_float(m->centre[i % 3u]), SMR_COORD_MAX + 1.0f);
    return legal;
}

static int check_vertices(const smr_model *m)
{
    const uint32_t n = smr_le32(m->n_vertices), nt = smr_le32(m->n_triangles);
    return section(m, m->at_position, n, 4) && section(m, m->at_original, n, 4) && section(m, m->at_owner, n, 2) &&
           section(m, m->at_rest, n, 12) && section(m, m->at_mass, n, 4) && section(m, m->at_triangles, nt, 12) &&
           section(m, m->at_triangle_index, nt, 4) && check_numbering(m) && check_levels(m) &&
           floats_within(m->centre, 3, -SMR_COORD_MAX, SMR_COORD_MAX) &&
           floats_within(&m->edge_mm, 1, 0.0f, 4.0f * SMR_COORD_MAX) &&
           floats_within(smr_at(m, m->at_rest), 3u * (size_t)n, -2.0f * SMR_COORD_MAX, 2.0f * SMR_COORD_MAX) &&
           rest_within(m) && floats_within(smr_at(m, m->at_mass), n, 1.0f / SMR_MASS_UNITS, SMR_MASS_MAX) &&
           all_below(smr_at(m, m->at_triangles), 4, 3u * (size_t)nt, n);
}

static int check_dihedrals(const smr_model *m)
{
    const uint32_t n = smr_le32(m->n_dihedrals), nt = smr_le32(m->n_triangles);
    if (!section(m, m->at_dihedrals, n, sizeof(smr_stored_dihedral)))
        return 0;
    const smr_stored_dihedral *h = smr_at(m, m->at_dihedrals);
    int legal = 1;
    for (uint32_t i = 0; i < n; i++)
        legal &= smr_le32(h[i].first) < nt && (smr_le32(h[i].bend) & SMR_DIHEDRAL_MASK) < nt;
    return legal;
}

static int check_profiles(const smr_model *m)
{
    const uint32_t n = smr_le32(m->n_vertices), samples = smr_le32(m->profile_samples);
    if (samples == 0u)
        return 1;
    return samples >= 3u && samples <= SMR_PROFILE_MAX && smr_le32(m->profile_inward) < samples &&
           floats_within(&m->profile_step, 1, 1.0e-6f, 100.0f) && section(m, m->at_profiles, n, samples) &&
           section(m, m->at_ranges, n, 8) &&
           floats_within(smr_at(m, m->at_ranges), 2u * (size_t)n, -SMR_RANGE_MAX, SMR_RANGE_MAX);
}

/* Checks that the corners and the caller's index of each triangle belong to the triangle's structure. */
static int check_triangle_indexes(const smr_model *m)
{
    const uint32_t *triangle_index = smr_at(m, m->at_triangle_index), *corner = smr_at(m, m->at_triangles);
    for (uint32_t s = 0; s < smr_le32(m->n_structures); s++) {
        const uint32_t first = smr_le32(smr_model_record(m, s)->first_triangle);
        const uint32_t n = smr_le32(smr_model_record(m, s)->n_triangles);
        if (!all_below(triangle_index + first, 4, n, n))
            return 0;
        for (size_t i = 3u * (size_t)first; i < 3u * ((size_t)first + n); i++)
            if (smr_model_owner(m, smr_le32(corner[i])) != s)
                return 0;
    }
    return 1;
}

static smr_entry32 entry_at(const smr_lists *l, uint32_t i)
{
    const uint32_t width = l->index_bytes;
    const size_t at = 4u * (size_t)i;
    return (smr_entry32){smr_index_at(l->entry, width, at), smr_index_at(l->entry, width, at + 1u),
                         smr_index_at(l->entry, width, at + 2u), smr_index_at(l->entry, width, at + 3u)};
}

/* Checks that each vertex of a block, first .. last-1 along the curve, has exactly one entry. */
static int each_once(const smr_model *m, const smr_lists *l, uint32_t first, uint32_t last)
{
    for (uint32_t lo = first; lo < last; lo += SMR_WINDOW) {
        uint32_t visited[SMR_WINDOW / 32u] = {0};
        for (uint32_t i = first; i < last; i++) {
            uint32_t v = smr_model_along(m, entry_at(l, i).vertex) - lo;
            if (v >= SMR_WINDOW)
                continue;
            if (visited[v / 32u] >> (v % 32u) & 1u)
                return 0;
            visited[v / 32u] |= 1u << (v % 32u);
        }
    }
    return 1;
}

static int check_block(const smr_model *m, const smr_lists *l, uint32_t first, uint32_t last, uint64_t n_indexes)
{
    const uint32_t n = smr_le32(m->n_vertices);
    uint64_t used = 0;
    for (uint32_t i = first; i < last; i++) {
        const smr_entry32 e = entry_at(l, i);
        if (e.vertex >= n || smr_model_along(m, e.vertex) - first >= last - first || e.parent > i - first)
            return 0;
        used += (uint64_t)e.n_plus + e.n_minus;
    }
    return used == n_indexes && each_once(m, l, first, last);
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

static int check_boundary(const smr_model *m, const smr_stored_radius *r)
{
    const uint32_t n = smr_le32(m->n_vertices);
    const smr_stored_boundary *b = smr_at(m, r->at_boundary);
    int legal = 1;
    for (uint32_t i = 0; i < smr_le32(r->n_boundary); i++)
        legal &= smr_le32(b[i].first) < n && smr_le32(b[i].second) < n && smr_le32(b[i].share) <= SMR_BOUNDARY_UNITS;
    return legal;
}

static int check_radius(const smr_model *m, const smr_stored_radius *r, uint32_t index)
{
    const uint32_t n = smr_le32(m->n_vertices), n_blocks = smr_le32(r->n_blocks), width = smr_le32(m->index_bytes);
    const uint32_t n_indexes = smr_le32(r->n_indexes);
    if (n_blocks == 0u || n_blocks > n || !check_boundary(m, r) ||
        !floats_within(&r->radius, 1, FLT_MIN, SMR_COORD_MAX) ||
        !floats_within(&r->reach, 1, 0.0f, 4.0f * SMR_COORD_MAX) || !floats_within(&r->mean, 1, 0.0f, 1.0e7f) ||
        smr_le32(r->largest) == 0u || smr_le32(r->largest) > n || smr_le32(r->active_min) == 0u ||
        smr_le32(r->active_min) > n)
        return 0;
    const smr_lists l = smr_model_lists(m, index);
    if (l.members > n || l.active_min > l.members || !all_below(l.index, width, n_indexes, l.members))
        return 0;
    for (uint32_t v = 0; v < n; v++)
        if (smr_list_count(&l, v) == 0u || smr_list_count(&l, v) > smr_le32(r->largest))
            return 0;
    if (smr_le32(l.block[0].first) != 0u || smr_le32(l.block[0].first_index) != 0u ||
        smr_le32(l.block[n_blocks].first) != n || smr_le32(l.block[n_blocks].first_index) != n_indexes)
        return 0;
    for (uint32_t b = 0; b < n_blocks; b++) {
        uint32_t first = smr_le32(l.block[b].first), last = smr_le32(l.block[b + 1u].first);
        uint32_t from = smr_le32(l.block[b].first_index), to = smr_le32(l.block[b + 1u].first_index);
        if (first >= last || last > n || from > to || to > n_indexes || !check_block(m, &l, first, last, to - from))
            return 0;
    }
    return 1;
}

/* Checks the differences of several shapes. */
static int check_references(const smr_model *m, const smr_stored_section *s)
{
    const uint32_t n = smr_reference_count(m, s);
    const size_t floats = 3u * (size_t)n * smr_le32(m->n_vertices);
    return n >= 2u && n <= SMR_REFERENCES_MAX && smr_le32(s->bytes) == sizeof(float) * floats &&
           floats_within(smr_at(m, s->at), floats, -SMR_DIFFERENCE_MAX, SMR_DIFFERENCE_MAX);
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
            smr_le32(s[i].at) < end || (smr_le32(s[i].kind) == SMR_SECTION_REFERENCES && !check_references(m, &s[i])))
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

static int check_header(const smr_model *m, size_t bytes)
{
    const uint32_t size = smr_le32(m->bytes);
    return smr_model_known(m) && size <= bytes &&
           smr_crc32(0, (const unsigned char *)m + SMR_MODEL_HEAD, size - SMR_MODEL_HEAD) == smr_le32(m->checksum);
}

smr_status smr_model_open(const void *memory, size_t bytes, const smr_model **model)
{
    if (memory == NULL || model == NULL)
        return SMR_E_NULL;
    if ((uintptr_t)memory % SMR_ALIGN != 0u)
        return SMR_E_ALIGN;
    const smr_model *m = memory;
    if (bytes < sizeof *m || !check_header(m, bytes) || !check_sections(m) || !check_structures(m) ||
        !check_vertices(m) || !check_triangle_indexes(m) || !check_dihedrals(m) || !check_profiles(m) ||
        !section(m, m->at_radii, smr_le32(m->n_radii), sizeof(smr_stored_radius)))
        return SMR_E_MODEL;
    uint64_t end = sizeof *m;
    for (uint32_t i = 0; i < smr_le32(m->n_radii); i++)
        if (!check_sections_of(m, smr_model_radius(m, i), &end) || !check_radius(m, smr_model_radius(m, i), i))
            return SMR_E_MODEL;
    *model = m;
    return SMR_OK;
}
