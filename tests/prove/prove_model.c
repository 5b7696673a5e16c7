/* prove_model.c: smr_model_open() reads nothing outside the tables of a model, whatever their contents are, and what it
 * accepts is read and written within its counts. prove_contracts.c shows for all numbers that section() accepts only
 * tables within the model, so the tables lie here at legal places, each with uninitialised bytes behind it, reads of
 * which are alarms. Counts that a table states run through all small numbers, and all others in one case.
 * SPDX-License-Identifier: MIT */
#include "model/model_open.c"
#include "model/model_open_lists.c"
#include "model/model_view.c"
#include "prove.h"

#define PROVE_VERTICES 3u
#define PROVE_TRIANGLES 2u
#define PROVE_MODEL_BYTES 2600u

/* What the model states; all other bytes of its tables are any bytes. */
typedef struct stated {
    uint32_t structures[2][4]; /* of two structures: first vertex, vertices, first triangle, triangles */
    uint32_t n_levels, level_end[3];
    uint32_t bad_corner, bad_entry; /* a corner and an entry's vertex that do not exist; SMR_NONE: all exist */
    uint32_t width, samples, n_dihedrals, n_blocks, n_indexes, n_boundary, coarse_radii, n_sections, kind, bytes;
} stated;

static const stated usual = {
    {{0, 2, 0, 1}, {2, 1, 1, 1}}, 1, {3, 0, 0}, SMR_NONE, SMR_NONE, 2, 0, 1, 2, 2, 1, 0, 1, 1, 72};

uint32_t smr_crc32(SMR_UNUSED uint32_t crc, const void *data, size_t n)
{
    //@ assert \valid_read((const char *)data + (0 .. n - 1));
    return PROVE_ANY(0, UINT32_MAX);
}

/* The stages of base/job.c, one task after the other, but not smr_open_blocks(): Eva's states explode there. */
uint32_t smr_in_order(const void *job) { return (void)job, 1u; }
smr_job_head smr_job_begin(const smr_stage *all, uint32_t n_stages, SMR_UNUSED const smr_port *port)
{
    return (smr_job_head){.magic = SMR_JOB_MAGIC, .status = SMR_PARTIAL, .stages = all, .n_stages = n_stages};
}
smr_status smr_job_whole(smr_status begun, smr_job *job, SMR_UNUSED const smr_port *port)
{
    smr_job_head *const h = (smr_job_head *)(void *)job;
    if (begun != SMR_OK)
        return begun;
    for (h->stage = 0; h->stage < h->n_stages && h->status == SMR_PARTIAL; h->stage = h->next_stage) {
        const smr_stage *s = &h->stages[h->stage];
        const uint32_t n = s->n_tasks != NULL ? s->n_tasks(job) : 1u;
        h->next_stage = h->stage + 1u;
        for (uint32_t task = 0; task < n && s->run != smr_open_blocks; task++)
            s->run(job, task, 0);
    }
    return h->status == SMR_PARTIAL ? SMR_OK : h->status;
}

/* A table of any bytes behind *end. Tables are no multiples of SMR_ALIGN, so that bytes are left between them. */
static uint32_t table(unsigned char *memory, uint32_t *end, uint32_t bytes)
{
    const uint32_t at = (*end + SMR_ALIGN) / SMR_ALIGN * SMR_ALIGN;
    if (bytes > 0u)
        PROVE_HOSTILE(memory + at, bytes);
    *end = at + bytes;
    return at;
}

/* Vertices of a table, n of `width` bytes, `step` elements apart. The first that does not exist is `bad`. */
static void vertices(void *to, uint32_t width, uint32_t step, uint32_t n, uint32_t bad)
{
    const uint32_t most = width == 2u ? 65535u : UINT32_MAX;
    for (uint32_t i = 0; i < n; i++) {
        const uint32_t v = PROVE_ANY(i == bad ? PROVE_VERTICES : 0u, i < bad ? PROVE_VERTICES - 1u : most);
        if (width == 2u)
            ((uint16_t *)to)[step * i] = (uint16_t)v;
        else
            ((uint32_t *)to)[step * i] = v;
    }
}

static void radius(unsigned char *memory, uint32_t *end, const stated *t, smr_stored_radius *r)
{
    const uint32_t n = PROVE_VERTICES;
    r->n_blocks = t->n_blocks;
    r->n_indexes = t->n_indexes;
    r->n_boundary = t->n_boundary;
    r->at_blocks = table(memory, end, (smr_min_u32(t->n_blocks, n) + 1u) * (uint32_t)sizeof(smr_stored_block));
    r->at_entries = table(memory, end, n * 4u * t->width);
    vertices(memory + r->at_entries, t->width, 4, n, t->bad_entry);
    r->at_count = table(memory, end, n * t->width);
    r->at_indexes = table(memory, end, t->n_indexes * t->width);
    r->at_boundary = table(memory, end, t->n_boundary * (uint32_t)sizeof(smr_stored_boundary));
}

static void tables(unsigned char *memory, const stated *t)
{
    smr_model *m = (smr_model *)memory;
    const uint32_t n = PROVE_VERTICES;
    uint32_t end = sizeof *m;
    PROVE_HOSTILE(m, sizeof *m);
    memset(m->zero, 0, sizeof m->zero);
    m->n_vertices = n;
    m->n_triangles = PROVE_TRIANGLES;
    m->n_structures = 2;
    m->n_radii = 2;
    m->index_bytes = t->width;
    m->n_levels = t->n_levels;
    memcpy(m->level_end, t->level_end, sizeof t->level_end);
    m->coarse_radii = t->coarse_radii;
    m->profile_samples = t->samples;
    m->n_dihedrals = t->n_dihedrals;
    m->n_sections = t->n_sections;
    m->at_structures = table(memory, &end, 2u * sizeof(smr_stored_structure));
    smr_stored_structure *structure = (smr_stored_structure *)(memory + m->at_structures);
    for (uint32_t i = 0; i < 2u; i++)
        memcpy(&structure[i].first_vertex, t->structures[i], sizeof t->structures[i]);
    m->at_position = table(memory, &end, n * 4u);
    m->at_original = table(memory, &end, n * 4u);
    m->at_owner = table(memory, &end, n * 2u);
    m->at_rest = table(memory, &end, n * 12u);
    m->at_mass = table(memory, &end, n * 4u);
    m->at_triangles = table(memory, &end, PROVE_TRIANGLES * 12u);
    vertices(memory + m->at_triangles, 4, 1, 3u * PROVE_TRIANGLES, t->bad_corner);
    m->at_triangle_index = table(memory, &end, PROVE_TRIANGLES * 4u);
    m->at_along = table(memory, &end, n * 4u);
    m->at_profiles = table(memory, &end, n * t->samples);
    m->at_ranges = table(memory, &end, t->samples > 0u ? n * 8u : 0u);
    m->at_dihedrals = table(memory, &end, t->n_dihedrals * (uint32_t)sizeof(smr_stored_dihedral));
    m->at_radii = table(memory, &end, 2u * sizeof(smr_stored_radius));
    for (uint32_t i = 0; i < 2u; i++)
        radius(memory, &end, t, (smr_stored_radius *)(memory + m->at_radii) + i);
    m->at_sections = table(memory, &end, t->n_sections * (uint32_t)sizeof(smr_stored_section));
    if (t->n_sections > 0u) {
        smr_stored_section *s = (smr_stored_section *)(memory + m->at_sections);
        s->kind = t->kind;
        s->at = table(memory, &end, smr_min_u32(t->bytes, 108u));
        s->bytes = t->bytes;
    }
    m->bytes = end;
}

static void any(const stated *t)
{
    unsigned char memory[PROVE_MODEL_BYTES];
    float xyz[3u * PROVE_VERTICES];
    uint32_t triangle[3u * PROVE_TRIANGLES];
    const smr_model *m = (const smr_model *)memory; /* what smr_model_open() also gives */
    smr_model_info info;
    smr_structure_info structure;
    tables(memory, t);
    if (smr_model_open(memory, ((const smr_model *)memory)->bytes, &m) != SMR_OK)
        return;
    (void)smr_model_get_info(m, &info);
    for (uint32_t i = 0; i < 3u; i++) {
        (void)smr_model_structure(m, i, &structure);
        const uint32_t nv = i < 2u ? t->structures[i][1] : 0u, nt = i < 2u ? t->structures[i][3] : 0u;
        (void)smr_model_mesh(m, i, xyz + 3u * (PROVE_VERTICES - nv), triangle + 3u * (PROVE_TRIANGLES - nt));
    }
}

/* Sets one stated number to each of 0 .. few - 1, and to any other number. */
static void each(stated *t, uint32_t *number, uint32_t few)
{
    const uint32_t before = *number;
    for (uint32_t k = 0; k <= few; k++) {
        *number = PROVE_WORD(k, few);
        any(t);
    }
    *number = before;
}

/* Cases of one number that a table states, or two. */
static void numbers(stated t, uint32_t n)
{
    if (n < 8u)
        each(&t, &t.structures[n / 4u][n % 4u], n % 4u < 2u ? PROVE_VERTICES + 1u : PROVE_TRIANGLES + 1u);
    else if (n < 11u)
        for (t.n_levels = n - 8u, t.level_end[0] = 0; t.level_end[0] <= PROVE_VERTICES; t.level_end[0]++)
            each(&t, &t.level_end[1], PROVE_VERTICES + 1u);
    else if (n == 11u) {
        each(&t, &t.level_end[0], PROVE_VERTICES + 1u);
        t.n_levels = PROVE_ANY(SMR_LEVELS_MAX + 1u, UINT32_MAX);
        any(&t);
    } else {
        t.width = n < 16u ? 2u : 4u;
        t.n_indexes = n % 4u;
        each(&t, &t.n_blocks, PROVE_VERTICES + 1u);
    }
}

/* The other cases. */
static void others(stated t, uint32_t n)
{
    for (t.bad_corner = 0; t.bad_corner < 3u * PROVE_TRIANGLES && n == 20u; t.bad_corner++)
        any(&t);
    for (t = usual, t.width = 2; t.width <= 4u && n == 21u; t.width += 2u)
        for (t.bad_entry = 0; t.bad_entry < PROVE_VERTICES; t.bad_entry++)
            any(&t);
    for (t = usual; t.n_boundary <= 3u && n == 22u; t.n_boundary++)
        any(&t);
    for (t = usual, t.samples = 3; t.samples <= 5u && n == 23u; t.samples += 2u)
        any(&t);
    for (t = usual, t.n_dihedrals = 0; t.n_dihedrals <= 3u && n == 24u; t.n_dihedrals++)
        any(&t);
    for (t = usual, t.coarse_radii = 0; t.coarse_radii <= 2u && n == 25u; t.coarse_radii++)
        any(&t);
    for (t = usual, t.n_sections = 0; t.n_sections <= 1u && n == 26u; t.n_sections++)
        for (t.kind = 0; t.kind <= 2u; t.kind++)
            for (t.bytes = 0; t.bytes <= 108u; t.bytes += 36u)
                any(&t);
    t = usual;
    t.kind = SMR_SECTION_RELIEF;
    for (t.bytes = 2u * PROVE_VERTICES - 1u; t.bytes <= 2u * PROVE_VERTICES + 1u && n == 26u; t.bytes++)
        any(&t);
    t = usual;
    t.bytes = PROVE_ANY(109u, UINT32_MAX);
    if (n == 27u)
        any(&t);
}

/* Eva analyses each part by itself: in one run it would join their states. */
int main(void)
{
    if (PROVE_PART < 20u)
        numbers(usual, PROVE_PART);
    else
        others(usual, PROVE_PART);
    return 0;
}
